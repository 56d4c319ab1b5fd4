//! Two lying bars a class: ours and another's.

use super::scale::Scale;
use super::svg::{Anchor, Svg, text_width};
use crate::text::short;

const WIDTH: f64 = 620.0;
const PITCH: f64 = 26.0;
const BAR: f64 = 9.0;
const FONT: f64 = 11.0;
const STRENGTHS: [f64; 2] = [0.95, 0.35];

/// A chart of pairs.
pub(super) struct Pairs<'a> {
    pub(super) title: &'a str,
    /// Names of the two.
    pub(super) names: [&'a str; 2],
    pub(super) labels: &'a [String],
    pub(super) values: [&'a [Option<f64>]; 2],
    pub(super) decimals: usize,
}

impl Pairs<'_> {
    pub(super) fn draw(&self) -> String {
        let top = 48.0;
        let base = top + PITCH * self.labels.len() as f64;
        let mut svg = Svg::new(WIDTH, base + 28.0, self.title);
        let left = 10.0 + self.labels.iter().map(|label| text_width(label, FONT)).fold(0.0, f64::max);
        let number = |value: f64| format!("{value:.*}", self.decimals);
        let all = || self.values.iter().flat_map(|values| values.iter()).flatten().copied();
        let widest = all().map(|value| text_width(&number(value), FONT)).fold(0.0, f64::max);
        let plot_width = WIDTH - left - widest - 14.0;
        // Shares are small: an axis of whole numbers would not show them.
        let largest = all().fold(f64::MIN_POSITIVE, f64::max);
        let unit = if largest < 5.0 { 0.01 } else { 1.0 };
        let scale = Scale::linear(largest / unit);
        let mut x = left;
        for (name, strength) in self.names.iter().zip(STRENGTHS) {
            svg.rect([x, 26.0], [10.0, 10.0], strength);
            svg.text([x + 14.0, 35.0], Anchor::Start, FONT, name);
            x += 34.0 + text_width(name, FONT);
        }
        for &tick in &scale.ticks {
            let x = left + plot_width * scale.position(tick);
            svg.line([x, top], [x, base], tick == 0.0);
            svg.text([x, base + 14.0], Anchor::Middle, 10.0, &short(tick * unit));
        }
        for (i, label) in self.labels.iter().enumerate() {
            let y = top + PITCH * i as f64 + 0.5 * (PITCH - 2.0 * BAR);
            svg.text([left - 6.0, y + BAR + 4.0], Anchor::End, FONT, label);
            for (k, values) in self.values.iter().enumerate() {
                let Some(value) = values.get(i).copied().flatten() else { continue };
                let length = plot_width * scale.position(value / unit);
                let y = y + BAR * k as f64;
                if length > 0.0 {
                    svg.rect([left, y], [length, BAR - 1.0], STRENGTHS[k]);
                }
                svg.text([left + length + 5.0, y + BAR - 1.0], Anchor::Start, 9.0, &number(value));
            }
        }
        svg.finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bars_are_as_long_as_their_values() {
        let labels = ["car".to_owned()];
        let svg = Pairs {
            title: "t",
            names: ["ours", "published"],
            labels: &labels,
            values: [&[Some(20.0)], &[Some(40.0)]],
            decimals: 1,
        };
        let drawn = svg.draw();
        let lines = drawn.lines().filter(|line| line.starts_with("<rect"));
        let widths: Vec<f64> =
            lines.filter_map(|line| line.split("width=\"").nth(1)?.split('"').next()?.parse().ok()).collect();
        // Two of the legend, then the bars.
        assert_eq!(widths.len(), 4);
        assert!((2.0 * widths[2] - widths[3]).abs() < 0.02, "{widths:?}");
    }
}
