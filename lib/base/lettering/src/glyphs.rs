//! The letters: along which lines the pen goes.

/// A move of the pen, to a place between the left and right (0 to 1) and the lower and upper (0 to 1) middle
/// of the outermost strokes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Step {
    /// Straight; the first step of a stroke is where it begins.
    Line(f64, f64),
    /// Along a quarter of an ellipse that leaves sideways and arrives upright.
    BowX(f64, f64),
    /// One that leaves upright and arrives sideways.
    BowY(f64, f64),
}

/// A letter.
pub(crate) struct Glyph {
    /// In heights.
    pub(crate) width: f64,
    pub(crate) strokes: &'static [&'static [Step]],
}

use Step::{BowX, BowY, Line};

const fn glyph_of(width: f64, strokes: &'static [&'static [Step]]) -> Glyph {
    Glyph { width, strokes }
}

/// Two wheels, a frame, a saddle and handlebars; it rides to the left.
#[rustfmt::skip]
pub(crate) const BICYCLE: Glyph = glyph_of(1.6, &[
    &[Line(0.0, 0.27), BowY(0.21, 0.54), BowX(0.42, 0.27), BowY(0.21, 0.0), BowX(0.0, 0.27)],
    &[Line(0.58, 0.27), BowY(0.79, 0.54), BowX(1.0, 0.27), BowY(0.79, 0.0), BowX(0.58, 0.27)],
    &[Line(0.21, 0.27), Line(0.30, 0.94), Line(0.18, 1.0)],
    &[Line(0.28, 0.72), Line(0.62, 0.72)],
    &[Line(0.28, 0.72), Line(0.52, 0.27), Line(0.79, 0.27)],
    &[Line(0.52, 0.27), Line(0.66, 0.90)],
    &[Line(0.62, 0.72), Line(0.79, 0.27)],
    &[Line(0.56, 0.92), Line(0.76, 0.92)],
]);

/// How a character is written; none of those that are neither capitals nor digits.
#[rustfmt::skip]
pub(crate) fn glyph(character: char) -> Option<Glyph> {
    Some(match character {
        'A' => glyph_of(0.68, &[&[Line(0.0, 0.0), Line(0.5, 1.0), Line(1.0, 0.0)], &[Line(0.15, 0.3), Line(0.85, 0.3)]]),
        'B' => glyph_of(0.60, &[
            &[Line(0.0, 0.53), Line(0.0, 1.0), Line(0.5, 1.0), BowX(0.92, 0.765), BowY(0.5, 0.53), Line(0.0, 0.53)],
            &[Line(0.0, 0.53), Line(0.55, 0.53), BowX(1.0, 0.265), BowY(0.55, 0.0), Line(0.0, 0.0), Line(0.0, 0.53)],
        ]),
        'C' => glyph_of(0.60, &[&[Line(1.0, 0.74), BowY(0.5, 1.0), BowX(0.0, 0.65), Line(0.0, 0.35), BowY(0.5, 0.0), BowX(1.0, 0.26)]]),
        'D' => glyph_of(0.62, &[&[Line(0.0, 0.0), Line(0.0, 1.0), Line(0.4, 1.0), BowX(1.0, 0.6), Line(1.0, 0.4), BowY(0.4, 0.0), Line(0.0, 0.0)]]),
        'E' => glyph_of(0.54, &[&[Line(1.0, 1.0), Line(0.0, 1.0), Line(0.0, 0.0), Line(1.0, 0.0)], &[Line(0.0, 0.52), Line(0.85, 0.52)]]),
        'F' => glyph_of(0.52, &[&[Line(1.0, 1.0), Line(0.0, 1.0), Line(0.0, 0.0)], &[Line(0.0, 0.5), Line(0.85, 0.5)]]),
        'G' => glyph_of(0.62, &[&[Line(1.0, 0.76), BowY(0.5, 1.0), BowX(0.0, 0.65), Line(0.0, 0.35), BowY(0.5, 0.0), BowX(1.0, 0.3), Line(1.0, 0.48), Line(0.6, 0.48)]]),
        'H' => glyph_of(0.62, &[&[Line(0.0, 0.0), Line(0.0, 1.0)], &[Line(1.0, 0.0), Line(1.0, 1.0)], &[Line(0.0, 0.52), Line(1.0, 0.52)]]),
        'I' => glyph_of(0.17, &[&[Line(0.0, 0.0), Line(0.0, 1.0)]]),
        'J' => glyph_of(0.52, &[&[Line(1.0, 1.0), Line(1.0, 0.3), BowY(0.5, 0.0), BowX(0.0, 0.28)]]),
        'K' => glyph_of(0.62, &[&[Line(0.0, 0.0), Line(0.0, 1.0)], &[Line(1.0, 1.0), Line(0.04, 0.4)], &[Line(0.36, 0.6), Line(1.0, 0.0)]]),
        'L' => glyph_of(0.52, &[&[Line(0.0, 1.0), Line(0.0, 0.0), Line(1.0, 0.0)]]),
        'M' => glyph_of(0.76, &[&[Line(0.0, 0.0), Line(0.0, 1.0), Line(0.5, 0.35), Line(1.0, 1.0), Line(1.0, 0.0)]]),
        'N' => glyph_of(0.64, &[&[Line(0.0, 0.0), Line(0.0, 1.0), Line(1.0, 0.0), Line(1.0, 1.0)]]),
        'O' | '0' => glyph_of(0.62, &[&[Line(0.0, 0.35), Line(0.0, 0.65), BowY(0.5, 1.0), BowX(1.0, 0.65), Line(1.0, 0.35), BowY(0.5, 0.0), BowX(0.0, 0.35)]]),
        'P' => glyph_of(0.60, &[&[Line(0.0, 0.0), Line(0.0, 1.0)], &[Line(0.0, 1.0), Line(0.5, 1.0), BowX(1.0, 0.735), BowY(0.5, 0.47), Line(0.0, 0.47)]]),
        'Q' => glyph_of(0.62, &[
            &[Line(0.0, 0.35), Line(0.0, 0.65), BowY(0.5, 1.0), BowX(1.0, 0.65), Line(1.0, 0.35), BowY(0.5, 0.0), BowX(0.0, 0.35)],
            &[Line(0.55, 0.3), Line(0.95, 0.02)],
        ]),
        'R' => glyph_of(0.62, &[&[Line(0.0, 0.0), Line(0.0, 1.0)], &[Line(0.0, 1.0), Line(0.5, 1.0), BowX(1.0, 0.735), BowY(0.5, 0.47), Line(0.0, 0.47)], &[Line(0.5, 0.47), Line(1.0, 0.0)]]),
        'S' => glyph_of(0.60, &[&[Line(1.0, 0.76), BowY(0.5, 1.0), BowX(0.0, 0.76), BowY(0.5, 0.52), BowX(1.0, 0.26), BowY(0.5, 0.0), BowX(0.0, 0.24)]]),
        'T' => glyph_of(0.60, &[&[Line(0.0, 1.0), Line(1.0, 1.0)], &[Line(0.5, 1.0), Line(0.5, 0.0)]]),
        'U' => glyph_of(0.62, &[&[Line(0.0, 1.0), Line(0.0, 0.32), BowY(0.5, 0.0), BowX(1.0, 0.32), Line(1.0, 1.0)]]),
        'V' => glyph_of(0.66, &[&[Line(0.0, 1.0), Line(0.5, 0.0), Line(1.0, 1.0)]]),
        'W' => glyph_of(0.88, &[&[Line(0.0, 1.0), Line(0.25, 0.0), Line(0.5, 0.75), Line(0.75, 0.0), Line(1.0, 1.0)]]),
        'X' => glyph_of(0.64, &[&[Line(0.0, 0.0), Line(1.0, 1.0)], &[Line(0.0, 1.0), Line(1.0, 0.0)]]),
        'Y' => glyph_of(0.64, &[&[Line(0.0, 1.0), Line(0.5, 0.46), Line(1.0, 1.0)], &[Line(0.5, 0.5), Line(0.5, 0.0)]]),
        'Z' => glyph_of(0.58, &[&[Line(0.0, 1.0), Line(1.0, 1.0), Line(0.0, 0.0), Line(1.0, 0.0)]]),
        '1' => glyph_of(0.40, &[&[Line(0.0, 0.76), Line(1.0, 1.0), Line(1.0, 0.0)]]),
        '2' => glyph_of(0.58, &[&[Line(0.0, 0.72), BowY(0.5, 1.0), BowX(1.0, 0.71), Line(0.92, 0.55), Line(0.0, 0.0), Line(1.0, 0.0)]]),
        '3' => glyph_of(0.58, &[
            &[Line(0.0, 0.78), BowY(0.48, 1.0), BowX(0.95, 0.765), BowY(0.48, 0.53), Line(0.3, 0.53)],
            &[Line(0.3, 0.53), Line(0.48, 0.53), BowX(1.0, 0.265), BowY(0.48, 0.0), BowX(0.0, 0.22)],
        ]),
        '4' => glyph_of(0.62, &[&[Line(0.74, 0.0), Line(0.74, 1.0)], &[Line(0.74, 1.0), Line(0.0, 0.26), Line(1.0, 0.26)]]),
        '5' => glyph_of(0.58, &[&[Line(0.92, 1.0), Line(0.1, 1.0), Line(0.06, 0.52)], &[Line(0.06, 0.5), BowY(0.5, 0.62), BowX(1.0, 0.32), BowY(0.48, 0.0), BowX(0.0, 0.2)]]),
        '6' => glyph_of(0.60, &[
            &[Line(0.94, 0.82), BowY(0.54, 1.0), BowX(0.0, 0.56), Line(0.0, 0.3)],
            &[Line(0.0, 0.3), BowY(0.5, 0.6), BowX(1.0, 0.3), BowY(0.5, 0.0), BowX(0.0, 0.3)],
        ]),
        '7' => glyph_of(0.56, &[&[Line(0.0, 1.0), Line(1.0, 1.0), Line(0.3, 0.0)]]),
        '8' => glyph_of(0.60, &[
            &[Line(0.06, 0.765), BowY(0.5, 1.0), BowX(0.94, 0.765), BowY(0.5, 0.53), BowX(0.06, 0.765)],
            &[Line(0.0, 0.265), BowY(0.5, 0.53), BowX(1.0, 0.265), BowY(0.5, 0.0), BowX(0.0, 0.265)],
        ]),
        '9' => glyph_of(0.60, &[
            &[Line(0.06, 0.18), BowY(0.46, 0.0), BowX(1.0, 0.44), Line(1.0, 0.7)],
            &[Line(1.0, 0.7), BowY(0.5, 0.4), BowX(0.0, 0.7), BowY(0.5, 1.0), BowX(1.0, 0.7)],
        ]),
        _ => return None,
    })
}
