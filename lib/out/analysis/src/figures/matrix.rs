//! A square matrix of shares as a heat map.

use super::svg::{Anchor, Svg, text_width};
use crate::text::grouped;

const CELL: [f64; 2] = [76.0, 40.0];
const FONT: f64 = 11.0;

/// Transitions from rows to columns, row by row.
pub(super) struct Matrix<'a> {
    pub(super) title: String,
    pub(super) labels: &'a [&'a str],
    pub(super) counts: &'a [u64],
    pub(super) fractions: &'a [Option<f64>],
}

impl Matrix<'_> {
    pub(super) fn draw(&self) -> String {
        let n = self.labels.len();
        let left = 30.0 + self.labels.iter().map(|label| text_width(label, FONT)).fold(0.0, f64::max);
        let top = 56.0;
        let (width, height) = (left + CELL[0] * n as f64 + 4.0, top + CELL[1] * n as f64 + 4.0);
        let mut svg = Svg::new(width, height, &self.title);
        svg.text([left + 0.5 * CELL[0] * n as f64, 34.0], Anchor::Middle, FONT, "final");
        svg.text_up([12.0, top + 0.5 * CELL[1] * n as f64], Anchor::Middle, FONT, "initial");
        let largest = self.fractions.iter().flatten().copied().fold(f64::MIN_POSITIVE, f64::max);
        for (i, label) in self.labels.iter().enumerate() {
            let offset = i as f64 + 0.5;
            svg.text([left + CELL[0] * offset, top - 6.0], Anchor::Middle, FONT, label);
            svg.text([left - 6.0, top + CELL[1] * offset + 4.0], Anchor::End, FONT, label);
        }
        for (i, (count, fraction)) in self.counts.iter().zip(self.fractions).enumerate() {
            let (x, y) = (left + CELL[0] * (i % n) as f64, top + CELL[1] * (i / n) as f64);
            let fraction = fraction.unwrap_or(0.0);
            // At most 0.75, so that text of the page's colour stays readable on it.
            svg.rect([x + 1.0, y + 1.0], [CELL[0] - 2.0, CELL[1] - 2.0], 0.06 + 0.69 * fraction / largest);
            let middle = x + 0.5 * CELL[0];
            svg.text([middle, y + 18.0], Anchor::Middle, 12.0, &format!("{fraction:.4}"));
            svg.text([middle, y + 32.0], Anchor::Middle, 10.0, &grouped(&count.to_string()));
        }
        svg.finish()
    }
}
