//! Heat maps: values on a grid of equal rectangles, in colour by their logarithm.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use codecs::images::{Pixels, PngStyle, encode_png};
use frames::math::{ln, log10, pow};

use super::svg::{Anchor, Svg};
use crate::text::short;

const TOP: f64 = 24.0;
const BOTTOM: f64 = 36.0;
const LEFT: f64 = 44.0;
const RIGHT: f64 = 66.0;
const FONT: f64 = 10.0;
/// Width of the colour bar and how far it stands from the plot.
const BAR: f64 = 9.0;
const BAR_GAP: f64 = 8.0;
/// Values below this part of the largest one have the faintest colour.
const RANGE: f64 = 1e4;
/// From rare to frequent: evenly spaced colours of the map viridis, by Stéfan van der Walt and Nathaniel
/// Smith (CC0).
const COLOURS: [[u8; 3]; 9] = [
    [68, 1, 84],
    [71, 44, 122],
    [59, 81, 139],
    [44, 113, 142],
    [33, 144, 141],
    [39, 173, 129],
    [92, 200, 99],
    [170, 220, 50],
    [253, 231, 37],
];

/// An axis of the plot.
pub(super) struct Axis<'a> {
    pub(super) name: &'a str,
    /// Values at its start (left or bottom) and end.
    pub(super) ends: [f64; 2],
    pub(super) ticks: Vec<f64>,
    /// Whether the values are powers of ten of what is named.
    pub(super) log: bool,
}

/// A heat map.
pub(super) struct Density<'a> {
    pub(super) title: &'a str,
    /// Columns and rows.
    pub(super) grid: [usize; 2],
    /// Row by row from the top left; nothing where 0.
    pub(super) values: &'a [f64],
    /// Width and height of the plot, pixels.
    pub(super) plot: [f64; 2],
    pub(super) x: Axis<'a>,
    pub(super) y: Axis<'a>,
    /// Radii of circles around the origin of both axes.
    pub(super) circles: &'a [f64],
}

impl Density<'_> {
    pub(super) fn draw(&self) -> String {
        let [width, height] = self.plot;
        let mut svg = Svg::new(LEFT + width + RIGHT, TOP + height + BOTTOM, self.title);
        let [low, high] = self.limits();
        let levels: Vec<u8> = self.values.iter().map(|&value| level(value, [low, high])).collect();
        svg.image([LEFT, TOP], self.plot, &picture(self.grid, &levels));
        let x = |value: f64| LEFT + width * share(value, self.x.ends);
        let y = |value: f64| TOP + height * (1.0 - share(value, self.y.ends));
        for radius in self.circles {
            svg.circle([x(0.0), y(0.0)], (x(*radius) - x(0.0)).abs());
        }
        let base = TOP + height;
        svg.line([LEFT, base], [LEFT + width, base], true);
        svg.line([LEFT, TOP], [LEFT, base], true);
        for &tick in &self.x.ticks {
            svg.line([x(tick), base], [x(tick), base + 3.0], true);
            svg.text([x(tick), base + 14.0], Anchor::Middle, FONT, &self.x.text(tick));
        }
        for &tick in &self.y.ticks {
            svg.line([LEFT - 3.0, y(tick)], [LEFT, y(tick)], true);
            svg.text([LEFT - 5.0, y(tick) + 3.5], Anchor::End, FONT, &self.y.text(tick));
        }
        svg.text([LEFT + 0.5 * width, base + 29.0], Anchor::Middle, FONT, self.x.name);
        svg.text_up([11.0, TOP + 0.5 * height], Anchor::Middle, FONT, self.y.name);
        self.draw_bar(&mut svg, [low, high]);
        svg.finish()
    }

    /// The colours and what they stand for.
    fn draw_bar(&self, svg: &mut Svg, [low, high]: [f64; 2]) {
        let [width, height] = self.plot;
        let left = LEFT + width + BAR_GAP;
        let column: Vec<u8> = (1..=255).rev().collect();
        svg.image([left, TOP], [BAR, height], &picture([1, 255], &column));
        let y = |value: f64| TOP + height * (1.0 - ln(value / low) / ln(high / low));
        let mut ends = vec![TOP];
        svg.text([left + BAR + 4.0, TOP + 7.0], Anchor::Start, FONT, &brief(high));
        // A colour that stands for everything below it says so; one that nothing has stands for nothing.
        let there = || self.values.iter().filter(|value| **value > 0.0);
        let lowest = if there().any(|&value| value < low) {
            format!("\u{2264} {}", brief(low))
        } else if there().any(|&value| value < high) {
            brief(low)
        } else {
            return;
        };
        svg.text([left + BAR + 4.0, TOP + height], Anchor::Start, FONT, &lowest);
        ends.push(TOP + height);
        let first = log10(low).ceil() as i32;
        for power in (first..=first + 4).map(|n| pow(10.0, f64::from(n))).filter(|power| *power < high) {
            let at = y(power);
            if ends.iter().all(|end| (at - end).abs() > 16.0) {
                svg.text([left + BAR + 4.0, at + 3.5], Anchor::Start, FONT, &brief(power));
            }
        }
    }

    /// Values of the first and the last colour.
    fn limits(&self) -> [f64; 2] {
        let there = || self.values.iter().copied().filter(|value| *value > 0.0 && value.is_finite());
        let high = there().fold(0.0, f64::max);
        if high == 0.0 {
            return [0.1, 1.0];
        }
        let low = there().fold(high, f64::min).max(high / RANGE);
        // One value alone has the last colour.
        [if low < high { low } else { high / 10.0 }, high]
    }
}

impl Axis<'_> {
    fn text(&self, tick: f64) -> String {
        short(if self.log { pow(10.0, tick).round() } else { tick })
    }
}

fn share(value: f64, [start, end]: [f64; 2]) -> f64 {
    (value - start) / (end - start)
}

/// A number of two digits.
fn brief(value: f64) -> String {
    short(two_digits(value))
}

/// Rounded to two digits.
fn two_digits(value: f64) -> f64 {
    let step = pow(10.0, log10(value).floor() - 1.0);
    // Division by a whole number keeps 0.07 from becoming 0.07000000000000001.
    if step < 1.0 { (value / step).round() / (1.0 / step).round() } else { (value / step).round() * step }
}

/// The colour of a value, from 1 to 255; 0 where there is nothing.
fn level(value: f64, [low, high]: [f64; 2]) -> u8 {
    if !(value > 0.0 && value.is_finite()) {
        return 0;
    }
    let share = ln(value.max(low) / low) / ln(high / low);
    1 + (254.0 * share.clamp(0.0, 1.0)).round() as u8
}

/// Levels as the address of a picture: a PNG within it.
fn picture([columns, rows]: [usize; 2], levels: &[u8]) -> String {
    let palette: Vec<u8> = std::iter::once([0; 3]).chain((0..255).map(colour)).flatten().collect();
    let pixels = Pixels::Indexed(levels, &palette);
    let png = encode_png([columns as u32, rows as u32], &pixels, PngStyle::INDEXED);
    let png = png.expect("memory takes every picture of as many levels as it has places");
    format!("data:image/png;base64,{}", STANDARD.encode(png))
}

/// The colour of a level, the first being 0.
fn colour(level: u8) -> [u8; 3] {
    let place = f64::from(level) / 254.0 * (COLOURS.len() - 1) as f64;
    let first = (place.floor() as usize).min(COLOURS.len() - 2);
    let (from, to, part) = (COLOURS[first], COLOURS[first + 1], place - first as f64);
    std::array::from_fn(|k| (f64::from(from[k]) * (1.0 - part) + f64::from(to[k]) * part).round() as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_follow_the_logarithm() {
        assert_eq!(level(0.0, [1.0, 100.0]), 0);
        assert_eq!([1.0, 10.0, 100.0, 0.5, f64::NAN].map(|v| level(v, [1.0, 100.0])), [1, 128, 255, 1, 0]);
        assert_eq!((colour(0), colour(254)), (COLOURS[0], COLOURS[8]));
        assert_eq!([12.6, 0.0349, 990.0, 1234.0, 0.07].map(two_digits), [13.0, 0.035, 990.0, 1200.0, 0.07]);
    }

    #[test]
    fn pictures_hold_their_levels() {
        let levels = [0, 1, 255, 7, 0, 128];
        let address = picture([3, 2], &levels);
        let bytes = address.strip_prefix("data:image/png;base64,").map(|text| STANDARD.decode(text));
        let bytes = bytes.expect("a PNG").expect("base64");
        let mut decoder = png::Decoder::new(std::io::Cursor::new(bytes));
        decoder.set_transformations(png::Transformations::IDENTITY);
        let mut reader = decoder.read_info().expect("a head");
        let mut found = vec![0; reader.output_buffer_size().expect("fits")];
        reader.next_frame(&mut found).expect("levels");
        assert_eq!((reader.info().width, reader.info().height, found), (3, 2, levels.to_vec()));
        assert_eq!(reader.info().trns.as_deref(), Some(&[0][..]));
    }

    #[test]
    fn limits_hold_what_is_there() {
        let density = |values: &[f64]| {
            let axis = || Axis { name: "x", ends: [0.0, 1.0], ticks: Vec::new(), log: false };
            let (x, y) = (axis(), axis());
            let grid = [values.len(), 1];
            Density { title: "t", grid, values, plot: [9.0; 2], x, y, circles: &[] }.limits()
        };
        assert_eq!(density(&[0.0, 2.0, 50.0]), [2.0, 50.0]);
        assert_eq!(density(&[0.0, 5.0]), [0.5, 5.0]);
        assert_eq!(density(&[1e-9, 100.0]), [0.01, 100.0]);
        assert_eq!(density(&[0.0]), [0.1, 1.0]);
    }
}
