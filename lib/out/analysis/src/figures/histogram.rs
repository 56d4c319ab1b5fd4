//! Upright bars, one a bin.

use super::scale::Scale;
use super::svg::{Anchor, Svg, text_width};
use crate::text::short;

const HEIGHT: f64 = 200.0;
const TOP: f64 = 28.0;
const BOTTOM: f64 = 42.0;
const RIGHT: f64 = 18.0;
const FONT: f64 = 10.0;
/// Widest bar of whole bins, pixels.
const WIDEST: f64 = 56.0;

/// A histogram: as many labels as values.
pub(super) struct Histogram {
    pub(super) title: String,
    pub(super) x_label: String,
    pub(super) y_label: String,
    /// Names of the bins; those that have no room are left out.
    pub(super) labels: Vec<String>,
    pub(super) values: Vec<f64>,
    /// Values that are drawn as a line of steps over the bars; none, or as many.
    pub(super) line: Vec<f64>,
    /// Whether a name is the bin's lower edge and stands there, or names the whole bin. Names of open bins
    /// (`<0`, `40+`) always stand in the middle.
    pub(super) edges: bool,
    /// Every how many bins one is named, where not all have room: the first of these that keeps names apart.
    pub(super) steps: &'static [usize],
    /// Width of the picture, pixels.
    pub(super) width: f64,
}

impl Histogram {
    pub(super) fn draw(&self) -> String {
        let scale = Scale::linear(self.values.iter().chain(&self.line).copied().fold(0.0, f64::max));
        let mut svg = Svg::new(self.width, HEIGHT, &self.title);
        let tick_texts: Vec<String> = scale.ticks.iter().map(|&tick| short(tick)).collect();
        let tick_width = tick_texts.iter().map(|text| text_width(text, FONT)).fold(0.0, f64::max);
        let left = 20.0 + tick_width;
        let (plot_width, plot_height) = (self.width - left - RIGHT, HEIGHT - TOP - BOTTOM);
        let base = TOP + plot_height;
        for (&tick, text) in scale.ticks.iter().zip(&tick_texts) {
            let y = base - plot_height * scale.position(tick);
            svg.line([left, y], [left + plot_width, y], tick == 0.0);
            svg.text([left - 4.0, y + 3.5], Anchor::End, FONT, text);
        }
        let pitch = plot_width / self.values.len().max(1) as f64;
        for (i, &value) in self.values.iter().enumerate() {
            let height = plot_height * scale.position(value);
            if height > 0.0 {
                // A gap between bars as long as they are not hair lines; few bars are no walls.
                let gap = (0.12 * pitch).min(4.0).max(if self.edges { 0.0 } else { pitch - WIDEST });
                svg.rect([left + pitch * i as f64 + 0.5 * gap, base - height], [pitch - gap, height], 0.9);
            }
        }
        let height = |value: f64| base - plot_height * scale.position(value);
        let edges = self.line.iter().enumerate().flat_map(|(i, &value)| {
            let x = left + pitch * i as f64;
            [[x, height(value)], [x + pitch, height(value)]]
        });
        if !self.line.is_empty() {
            svg.outline(&edges.collect::<Vec<_>>());
        }
        for i in self.label_places(pitch) {
            let label = &self.labels[i];
            let x = left + pitch * (i as f64 + self.label_offset(i));
            svg.line([x, base], [x, base + 3.0], true);
            svg.text([x, base + 14.0], Anchor::Middle, FONT, label);
        }
        svg.text([left + 0.5 * plot_width, HEIGHT - 8.0], Anchor::Middle, 11.0, &self.x_label);
        svg.text_up([12.0, TOP + 0.5 * plot_height], Anchor::Middle, 11.0, &self.y_label);
        svg.finish()
    }

    /// Where in its bin a name stands, in bins.
    fn label_offset(&self, i: usize) -> f64 {
        let open = self.labels[i].starts_with('<') || self.labels[i].ends_with('+');
        if self.edges && !open { 0.0 } else { 0.5 }
    }

    /// Bins whose names are written: every first, second, fifth, ... so that they keep apart, and the last
    /// where it names an open bin.
    fn label_places(&self, pitch: f64) -> Vec<usize> {
        let width = |i: usize| text_width(&self.labels[i], FONT) + 5.0;
        let at = |i: usize| (i as f64 + self.label_offset(i)) * pitch;
        let apart = |a: usize, b: usize| at(b) - at(a) >= 0.5 * (width(a) + width(b));
        let n = self.labels.len();
        let fits = |every: &usize| {
            (0..n).step_by(*every).zip((0..n).step_by(*every).skip(1)).all(|(a, b)| apart(a, b))
        };
        let every = self.steps.iter().copied().find(fits).unwrap_or(n.max(1));
        // Steps count from a round name, so that edges of -50, 0, 50 are named rather than -55, -5, 45.
        let round = usize::from(self.labels.first().is_some_and(|label| label.starts_with('<')));
        let mut places: Vec<usize> = (round..n).step_by(every).collect();
        if let Some(last) = n.checked_sub(1).filter(|&last| self.labels[last].ends_with('+')) {
            while places.last().is_some_and(|&place| place != last && !apart(place, last)) {
                places.pop();
            }
            if places.last() != Some(&last) {
                places.push(last);
            }
        }
        places
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn histogram(labels: Vec<String>) -> Histogram {
        let values = (0..labels.len()).map(|i| i as f64).collect();
        let [title, x_label, y_label] = ["t", "x", "y"].map(str::to_owned);
        Histogram {
            title,
            x_label,
            y_label,
            labels,
            values,
            line: Vec::new(),
            edges: false,
            steps: &[1, 2, 5, 10, 20],
            width: 320.0,
        }
    }

    #[test]
    fn names_of_bins_keep_apart() {
        for n in [1, 2, 7, 21, 41, 64] {
            let mut labels: Vec<String> = (0..n).map(|i| (i * 20).to_string()).collect();
            labels.push("4000+".into());
            let histogram = histogram(labels);
            let pitch = 280.0 / (n + 1) as f64;
            let places = histogram.label_places(pitch);
            assert_eq!(places.last(), Some(&n), "the open bin is named");
            for pair in places.windows(2) {
                let widths = pair.iter().map(|&i| text_width(&histogram.labels[i], FONT)).sum::<f64>();
                assert!((pair[1] - pair[0]) as f64 * pitch >= 0.5 * widths);
            }
        }
    }

    #[test]
    fn bars_are_as_high_as_their_values() {
        let svg = histogram(vec!["0".into(), "1".into(), "2".into()]).draw();
        // The axis ends at 2, the plot is 130 high: bars of 65 and 130, none for 0.
        assert_eq!(svg.matches("<rect").count(), 2);
        assert!(svg.contains("height=\"65.00\"") && svg.contains("height=\"130.00\""), "{svg}");
    }

    #[test]
    fn a_line_has_a_step_a_value() {
        let mut histogram = histogram(vec!["0".into(), "1".into()]);
        histogram.line = vec![1.0, 0.5];
        let svg = histogram.draw();
        // The bars reach 1, the axis ends there: from the top at 28 to the middle of the 130 below it.
        let path = svg.split(" d=\"").nth(1).and_then(|rest| rest.split('"').next()).expect("a line");
        let ys: Vec<&str> =
            path.split(['M', 'L']).skip(1).filter_map(|point| point.split(' ').nth(1)).collect();
        assert_eq!(ys, ["28.00", "28.00", "93.00", "93.00"]);
    }
}
