//! Capitals and digits of one weight, of our own design: for the faces of signs and for words on roads.
//!
//! A letter is drawn with a broad pen along a few lines and quarters of ellipses ([`glyphs`](self)); what
//! comes out are the outlines of these strokes. Heights of capitals are 1: callers scale them, for a
//! road along the lane.
//!
//! ```
//! let word = lettering::write("STOP").unwrap();
//! assert!(word.width > 2.0 && word.width < 3.2);
//! assert!(lettering::write("Straße").is_none(), "capitals and digits alone");
//! ```

mod glyphs;
mod stroke;

use glyphs::glyph;
pub use stroke::Point;
use stroke::outlines;

/// Breadth of the pen.
const PEN: f64 = 0.17;
/// Free space between letters, and what a space between words takes.
const GAP: f64 = 0.15;
/// See [`GAP`].
const SPACE: f64 = 0.42;

/// What was written: it stands on the line of height 0 and begins at 0 to the right.
#[derive(Clone, Debug, PartialEq)]
pub struct Lettering {
    /// Outlines of its strokes: simple polygons, which may overlap where strokes meet.
    pub outlines: Vec<Vec<Point>>,
    /// How far it reaches to the right.
    pub width: f64,
}

/// Writes capitals, digits and spaces; none where there is another character, or nothing but spaces.
#[must_use]
pub fn write(text: &str) -> Option<Lettering> {
    let mut all = Vec::new();
    let mut at = 0.0;
    for character in text.chars() {
        if character == ' ' {
            at += SPACE;
            continue;
        }
        let glyph = glyph(character)?;
        let free = glyph.width - PEN;
        let place = |[x, y]: Point| [at + 0.5 * PEN + x * free, 0.5 * PEN + y * (1.0 - PEN)];
        let inside = |[x, y]: Point| [x.clamp(at, at + glyph.width), y.clamp(0.0, 1.0)];
        for stroke in glyph.strokes {
            let rings = outlines(stroke, place, PEN).into_iter();
            // The ends of slanting strokes are cut along the lines that letters stand between.
            all.extend(rings.map(|ring| ring.into_iter().map(inside).collect::<Vec<Point>>()));
        }
        at += glyph.width + GAP;
    }
    (!all.is_empty()).then_some(Lettering { outlines: all, width: at - GAP })
}

/// A bicycle from its side, as it stands on lanes for bicycles: 1 high.
#[must_use]
pub fn bicycle() -> Lettering {
    const THIN: f64 = 0.09;
    let glyph = glyphs::BICYCLE;
    let place = |[x, y]: Point| [0.5 * THIN + x * (glyph.width - THIN), 0.5 * THIN + y * (1.0 - THIN)];
    let all = glyph.strokes.iter().flat_map(|stroke| outlines(stroke, place, THIN));
    Lettering { outlines: all.collect(), width: glyph.width }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: &str = "ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789";

    fn cross(o: Point, a: Point, b: Point) -> f64 {
        (a[0] - o[0]) * (b[1] - o[1]) - (a[1] - o[1]) * (b[0] - o[0])
    }

    fn contains(ring: &[Point], [x, y]: Point) -> bool {
        let mut inside = false;
        for (a, b) in ring.iter().zip(ring.iter().cycle().skip(1)) {
            if (a[1] > y) != (b[1] > y) && x < a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]) {
                inside = !inside;
            }
        }
        inside
    }

    fn inked(word: &Lettering, at: Point) -> bool {
        word.outlines.iter().any(|ring| contains(ring, at))
    }

    #[test]
    fn letters_stay_within_their_line_and_beside_one_another() {
        for character in ALL.chars() {
            let word = write(&character.to_string()).expect("is known");
            let points = || word.outlines.iter().flatten();
            assert!(points().all(|[x, y]| *x > -0.02 && *x < word.width + 0.02 && *y > -0.02 && *y < 1.02));
            let highest = points().map(|p| p[1]).fold(0.0, f64::max);
            let lowest = points().map(|p| p[1]).fold(1.0, f64::min);
            assert!(lowest < 0.02 && highest > 0.98, "{character} fills its height: {lowest} {highest}");
        }
        let pair = write("HH").expect("is known");
        let one = write("H").expect("is known");
        assert!((pair.width - 2.0 * one.width - GAP).abs() < 1e-9);
    }

    #[test]
    fn outlines_are_simple() {
        for character in ALL.chars().chain([' ']) {
            let word = if character == ' ' { Some(bicycle()) } else { write(&character.to_string()) };
            for ring in word.expect("is known").outlines {
                let n = ring.len();
                let area: f64 = (0..n).map(|i| cross([0.0; 2], ring[i], ring[(i + 1) % n])).sum();
                assert!(area > 1e-3, "{character}: {area}, counter-clockwise");
                for i in 0..n {
                    for k in i + 2..n {
                        if (i, k) == (0, n - 1) {
                            continue;
                        }
                        let (a, b, c, d) = (ring[i], ring[i + 1], ring[k], ring[(k + 1) % n]);
                        let split = cross(a, b, c) * cross(a, b, d) < -1e-12
                            && cross(c, d, a) * cross(c, d, b) < -1e-12;
                        assert!(!split, "{character}: edges {i} and {k} of {ring:?} meet");
                    }
                }
            }
        }
    }

    #[test]
    fn no_two_letters_look_alike() {
        let seen = |c: char| -> Vec<bool> {
            let word = write(&c.to_string()).expect("is known");
            (0..400)
                .map(|i| {
                    inked(
                        &word,
                        [word.width * (0.025 + 0.05 * f64::from(i % 20)), 0.025 + 0.05 * f64::from(i / 20)],
                    )
                })
                .collect()
        };
        let all: Vec<Vec<bool>> = ALL.chars().map(seen).collect();
        for (i, a) in ALL.chars().enumerate() {
            for (k, b) in ALL.chars().enumerate().skip(i + 1) {
                let differ = all[i].iter().zip(&all[k]).filter(|(a, b)| a != b).count();
                // A zero is an O, as on number plates.
                assert!(differ >= 12 || (a, b) == ('O', '0'), "{a} and {b}: {differ} of 400");
            }
        }
    }

    /// Read by a few places where ink must be and must not be.
    #[test]
    fn letters_are_themselves() {
        type Probe<'a> = (&'a str, &'a [Point], &'a [Point]);
        let probes: [Probe<'_>; 5] = [
            // As shares of the width, and heights.
            ("L", &[[0.1, 0.9], [0.1, 0.1], [0.9, 0.08]], &[[0.6, 0.6], [0.9, 0.9]]),
            ("P", &[[0.1, 0.1], [0.5, 0.92], [0.9, 0.75]], &[[0.9, 0.2], [0.5, 0.1], [0.5, 0.73]]),
            ("T", &[[0.5, 0.1], [0.1, 0.92], [0.9, 0.92]], &[[0.1, 0.5], [0.9, 0.5]]),
            ("0", &[[0.1, 0.5], [0.9, 0.5], [0.5, 0.92], [0.5, 0.08]], &[[0.5, 0.5], [0.01, 0.01]]),
            ("7", &[[0.1, 0.92], [0.9, 0.92]], &[[0.1, 0.5], [0.9, 0.1], [0.1, 0.1]]),
        ];
        for (text, ink, none) in probes {
            let word = write(text).expect("is known");
            let at = |[x, y]: [f64; 2]| [x * word.width, y];
            assert!(ink.iter().all(|p| inked(&word, at(*p))), "{text}");
            assert!(!none.iter().any(|p| inked(&word, at(*p))), "{text}");
        }
        assert!(write("  ").is_none() && write("a").is_none() && write("").is_none());
    }
}
