//! The typeface of everything that people read: Inter, as outlines and as a style sheet.
//!
//! ```
//! let line = typeface::write("Lidar, 160 m", 20.0, typeface::Weight::Regular);
//! assert!(line.length_px > 100.0 && line.length_px < 140.0);
//! ```

use std::fmt::Write as _;
use std::sync::LazyLock;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use ttf_parser::{Face, GlyphId, OutlineBuilder};

/// Name of the family in style sheets.
pub const FAMILY: &str = "Inter";

/// Curves are drawn as straight pieces, none of which is farther off than this, pixels.
const OFF_PX: f64 = 0.03;
/// A curve has no more pieces than this.
const MOST_PIECES: f64 = 24.0;

/// How heavy letters are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Weight {
    /// Plain.
    Regular,
    /// For headings and names.
    Bold,
}

impl Weight {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Regular, Self::Bold];

    /// The TrueType file.
    #[must_use]
    pub fn file(self) -> &'static [u8] {
        match self {
            Self::Regular => include_bytes!("../fonts/Inter-Regular.ttf"),
            Self::Bold => include_bytes!("../fonts/Inter-SemiBold.ttf"),
        }
    }

    /// Its number in style sheets.
    #[must_use]
    pub fn css(self) -> u16 {
        match self {
            Self::Regular => 400,
            Self::Bold => 600,
        }
    }

    fn face(self) -> &'static Face<'static> {
        static FACES: LazyLock<[Face<'static>; 2]> = LazyLock::new(|| {
            Weight::ALL
                .map(|weight| Face::parse(weight.file(), 0).expect("the file that is built in is sound"))
        });
        &FACES[self as usize]
    }
}

/// A line of text.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Line {
    /// Closed outlines, to be filled where their winding number is not zero: points from the beginning of the
    /// baseline, pixels, x to the right, y down.
    pub rings: Vec<Vec<[f64; 2]>>,
    /// How far the line reaches, pixels.
    pub length_px: f64,
}

/// Writes a line in a font size, pixels: capitals are 0.73 of it high. Characters that the typeface has not
/// are empty boxes.
#[must_use]
pub fn write(text: &str, size_px: f64, weight: Weight) -> Line {
    let face = weight.face();
    let scale = size_px / f64::from(face.units_per_em());
    let mut pen = Pen { scale, left: 0.0, rings: Vec::new() };
    for glyph in glyphs(face, text) {
        face.outline_glyph(glyph, &mut pen);
        pen.left += advance(face, glyph) * scale;
    }
    Line { rings: pen.rings, length_px: pen.left }
}

/// How far a line reaches, pixels.
#[must_use]
pub fn length_px(text: &str, size_px: f64, weight: Weight) -> f64 {
    let face = weight.face();
    let units: f64 = glyphs(face, text).map(|glyph| advance(face, glyph)).sum();
    units * size_px / f64::from(face.units_per_em())
}

/// `@font-face` rules with both files in them, so that a page needs no other file.
#[must_use]
pub fn css() -> String {
    let mut rules = String::new();
    for weight in Weight::ALL {
        let file = STANDARD.encode(weight.file());
        let _ = writeln!(
            rules,
            "@font-face {{ font-family: {FAMILY}; font-weight: {}; src: url(data:font/ttf;base64,{file}); }}",
            weight.css()
        );
    }
    rules
}

fn glyphs<'t>(face: &'t Face<'_>, text: &'t str) -> impl Iterator<Item = GlyphId> + 't {
    text.chars().map(|c| face.glyph_index(c).unwrap_or_default())
}

fn advance(face: &Face<'_>, glyph: GlyphId) -> f64 {
    f64::from(face.glyph_hor_advance(glyph).unwrap_or_default())
}

/// Turns outlines into points.
struct Pen {
    scale: f64,
    left: f64,
    rings: Vec<Vec<[f64; 2]>>,
}

impl Pen {
    fn at(&self, x: f32, y: f32) -> [f64; 2] {
        [self.left + f64::from(x) * self.scale, -f64::from(y) * self.scale]
    }

    /// Adds a curve from the last point on; `bend_px` is how far its control points are from even steps.
    fn curve(&mut self, bend_px: f64, along: impl Fn([f64; 2], f64) -> [f64; 2]) {
        let Some(ring) = self.rings.last_mut() else { return };
        let Some(&from) = ring.last() else { return };
        // A quadratic curve in n pieces is bend / (4 n^2) off.
        let pieces = (0.25 * bend_px / OFF_PX).sqrt().ceil().clamp(1.0, MOST_PIECES) as u32;
        ring.extend((1..=pieces).map(|i| along(from, f64::from(i) / f64::from(pieces))));
    }
}

impl OutlineBuilder for Pen {
    fn move_to(&mut self, x: f32, y: f32) {
        let at = self.at(x, y);
        self.rings.push(vec![at]);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        let at = self.at(x, y);
        self.rings.last_mut().into_iter().for_each(|ring| ring.push(at));
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        let (by, to) = (self.at(x1, y1), self.at(x, y));
        let from = self.rings.last().and_then(|ring| ring.last()).copied().unwrap_or(to);
        let [dx, dy] = [0, 1].map(|k| from[k] - 2.0 * by[k] + to[k]);
        self.curve(dx.abs() + dy.abs(), |from, t| {
            let s = 1.0 - t;
            [0, 1].map(|k| s * s * from[k] + 2.0 * s * t * by[k] + t * t * to[k])
        });
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        let (a, b, to) = (self.at(x1, y1), self.at(x2, y2), self.at(x, y));
        let bend = [0, 1].map(|k| (a[k] - b[k]).abs() + (b[k] - to[k]).abs());
        self.curve(bend[0] + bend[1], |from, t| {
            let s = 1.0 - t;
            [0, 1].map(|k| {
                s * s * s * from[k] + 3.0 * s * s * t * a[k] + 3.0 * s * t * t * b[k] + t * t * t * to[k]
            })
        });
    }

    fn close(&mut self) {}
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Twice the area between the rings and the baseline: what is inside of holes counts against it.
    fn area(line: &Line) -> f64 {
        let ring = |ring: &Vec<[f64; 2]>| -> f64 {
            let next = ring.iter().cycle().skip(1);
            ring.iter().zip(next).map(|(a, b)| a[0] * b[1] - a[1] * b[0]).sum()
        };
        0.5 * line.rings.iter().map(ring).sum::<f64>().abs()
    }

    fn range(line: &Line, k: usize) -> [f64; 2] {
        let all = || line.rings.iter().flatten().map(|p| p[k]);
        [all().fold(f64::INFINITY, f64::min), all().fold(f64::NEG_INFINITY, f64::max)]
    }

    #[test]
    fn capitals_stand_on_the_baseline_and_are_as_high_as_the_file_says() {
        for weight in Weight::ALL {
            let line = write("H", 2048.0, weight);
            let [top, base] = range(&line, 1);
            assert_eq!([top, base], [-1490.0, 0.0], "cap height of Inter");
            let [left, right] = range(&line, 0);
            assert!(left > 0.0 && right < line.length_px);
        }
        // The descender of a p is below, and bold is heavier than plain.
        assert!(range(&write("p", 100.0, Weight::Regular), 1)[1] > 10.0);
        let [plain, bold] = Weight::ALL.map(|weight| area(&write("Convoy", 100.0, weight)));
        assert!(bold > 1.15 * plain, "{plain} {bold}");
    }

    #[test]
    fn a_line_is_as_long_as_its_letters_together() {
        for weight in Weight::ALL {
            let of = |text: &str| length_px(text, 30.0, weight);
            assert!(
                (of("Town 07") - "Town 07".chars().map(|c| of(&c.to_string())).sum::<f64>()).abs() < 1e-9
            );
            assert_eq!(write("Town 07", 30.0, weight).length_px, of("Town 07"));
            assert_eq!(of(""), 0.0);
            assert!(of("i") < 0.5 * of("m"));
        }
    }

    #[test]
    fn curves_are_as_round_as_finer_ones() {
        // The area of an O in straight pieces against that of one drawn 40 times as large.
        let [small, large] = [20.0, 800.0].map(|size| area(&write("O", size, Weight::Regular)));
        assert!((1600.0 * small / large - 1.0).abs() < 0.01, "{small} {large}");
        let pieces: usize = write("O", 20.0, Weight::Regular).rings.iter().map(Vec::len).sum();
        assert!(pieces < 120, "{pieces}");
    }

    #[test]
    fn what_people_write_is_there_and_what_is_not_is_a_box() {
        let missing = |c: char| Weight::ALL.iter().any(|weight| weight.face().glyph_index(c).is_none());
        let needed = (' '..='~').chain("°±²³µ·×÷äöüßéèñçøåÄÖÜ–—‘’“”•…€−".chars());
        assert_eq!(needed.filter(|c| missing(*c)).collect::<String>(), "");
        let bare = write("\u{4e2d}", 20.0, Weight::Regular);
        assert!(!bare.rings.is_empty() && bare.length_px > 0.0);
    }

    #[test]
    fn style_sheets_hold_the_files() {
        let css = css();
        let files: Vec<Vec<u8>> = css
            .split("base64,")
            .skip(1)
            .filter_map(|rest| STANDARD.decode(rest.split(')').next()?).ok())
            .collect();
        assert_eq!(files, Weight::ALL.map(|weight| weight.file().to_vec()));
        assert!(css.len() < 50_000, "{} bytes in every page", css.len());
    }
}
