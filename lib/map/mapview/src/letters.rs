//! A stroke font for pictures without a font file.
//!
//! No `ab_glyph`: it is four crates and needs a font of some 700 kB, and those that come in a crate (DejaVu,
//! Ubuntu) have licences of their own. Names of maps, numbers and the legend read well in capitals.

use crate::picture::{Anchor, Paint, Shape, Text};

/// Height of capitals as a share of the font size.
const CAPITALS: f64 = 0.70;
/// Grid units in the height of a capital, and between two letters.
const HEIGHT: f64 = 6.0;
const GAP: f64 = 1.7;
/// Small letters are small capitals.
const SMALL: f64 = 0.78;
/// Width of strokes as a share of the font size, of plain and bold text.
const WEIGHT: f64 = 0.085;
const BOLD: f64 = 0.12;

/// Lines of a letter: pairs of digits are points on a grid four wide and six high, x before y, y up.
fn glyph(letter: char) -> &'static str {
    match letter {
        'A' => "00 26 40|12 32",
        'B' => "00 06 36 45 44 33 03|33 42 41 30 00",
        'C' => "45 36 16 05 01 10 30 41",
        'D' => "00 06 26 44 42 20 00",
        'E' => "46 06 00 40|03 33",
        'F' => "46 06 00|03 33",
        'G' => "45 36 16 05 01 10 30 41 43 23",
        'H' => "00 06|40 46|03 43",
        'I' => "00 06",
        'J' => "36 31 20 10 01",
        'K' => "00 06|46 03 40",
        'L' => "06 00 40",
        'M' => "00 06 23 46 40",
        'N' => "00 06 40 46",
        'O' | '0' => "16 05 01 10 30 41 45 36 16",
        'P' => "00 06 36 45 44 33 03",
        'Q' => "16 05 01 10 30 41 45 36 16|22 40",
        'R' => "00 06 36 45 44 33 03|23 40",
        'S' => "45 36 16 05 04 13 33 42 41 30 10 01",
        'T' => "06 46|26 20",
        'U' => "06 01 10 30 41 46",
        'V' => "06 20 46",
        'W' => "06 10 24 30 46",
        'X' => "00 46|06 40",
        'Y' => "06 23 46|23 20",
        'Z' => "06 46 00 40",
        '1' => "05 16 10",
        '2' => "05 16 36 45 44 00 40",
        '3' => "06 46 23 33 42 41 30 10 01",
        '4' => "30 36 02 42",
        '5' => "46 06 03 33 42 41 30 10 01",
        '6' => "45 36 16 05 01 10 30 41 42 33 13 02",
        '7' => "06 46 10",
        '8' => "13 04 05 16 36 45 44 33 13 02 01 10 30 41 42 33",
        '9' => "01 10 30 41 45 36 16 05 04 13 33 44",
        '.' => "00 01",
        ',' => "11 00",
        ':' => "00 01|03 04",
        '-' | '\u{2013}' => "03 33",
        '_' => "00 40",
        '+' => "03 43|25 21",
        '/' => "00 46",
        '(' => "16 04 02 10",
        ')' => "06 14 12 00",
        '\'' => "06 05",
        '=' => "02 42|04 44",
        '%' => "00 46|06 16 15 05 06|30 40 41 31 30",
        '<' => "35 03 31",
        '>' => "05 33 01",
        '#' => "10 26|20 36|02 42|04 44",
        _ => "",
    }
}

/// Chains of a letter on its grid, and its width.
fn lines_of(letter: char) -> (Vec<Vec<[f64; 2]>>, f64) {
    let digit = |b: u8| f64::from(b.saturating_sub(b'0'));
    let chains: Vec<Vec<[f64; 2]>> = glyph(letter)
        .split('|')
        .map(|line| {
            line.split(' ')
                .filter_map(|p| Some([digit(*p.as_bytes().first()?), digit(*p.as_bytes().get(1)?)]))
        })
        .map(Iterator::collect)
        .collect();
    let width = chains.iter().flatten().map(|p| p[0]).fold(0.0, f64::max);
    (chains, if letter == ' ' { 1.5 } else { width })
}

/// A line of text as strokes, for crates that draw pictures of their own. Letters are capitals, small ones
/// smaller.
#[derive(Clone, Debug, PartialEq)]
pub struct Lettering {
    /// The strokes: points from the beginning of the baseline, pixels, x to the right, y down.
    pub strokes: Vec<Vec<[f64; 2]>>,
    /// Length of the line, pixels.
    pub length_px: f64,
    /// Width of the strokes of plain text, pixels.
    pub weight_px: f64,
}

impl Lettering {
    /// The strokes of a text of a font size, pixels. Characters that the font has not are left blank.
    #[must_use]
    pub fn new(text: &str, size_px: f64) -> Self {
        let unit = CAPITALS * size_px / HEIGHT;
        let mut strokes = Vec::new();
        let mut pen = 0.0;
        for c in text.chars() {
            let scale = if c.is_lowercase() { SMALL * unit } else { unit };
            let (lines, width) = lines_of(c.to_ascii_uppercase());
            strokes.extend(
                lines
                    .iter()
                    .map(|line| line.iter().map(|p| [pen + p[0] * scale, -p[1] * scale]).collect::<Vec<_>>()),
            );
            pen += (width + GAP) * scale;
        }
        Self { strokes, length_px: (pen - GAP * unit).max(0.0), weight_px: WEIGHT * size_px }
    }
}

/// A text as lines.
pub(crate) fn strokes(text: &Text) -> Shape {
    let Lettering { strokes: mut chains, length_px, weight_px } = Lettering::new(&text.text, text.size_px);
    let shift = match text.anchor {
        Anchor::Start => 0.0,
        Anchor::Middle => 0.5 * length_px,
        Anchor::End => length_px,
    };
    for point in chains.iter_mut().flatten() {
        *point = [text.at[0] + point[0] - shift, text.at[1] + point[1]];
    }
    let width = if text.bold { BOLD * text.size_px } else { weight_px };
    Shape { chains, closed: false, paint: Paint::round_line(text.colour, width) }
}
