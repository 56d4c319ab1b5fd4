//! Lying bars, one a class, with their numbers beside them.

use super::scale::Scale;
use super::svg::{Anchor, Svg, text_width};
use crate::text::{grouped, short, size};

const WIDTH: f64 = 620.0;
const PITCH: f64 = 20.0;
const FONT: f64 = 11.0;
const OUTER: f64 = 0.4;
const INNER: f64 = 0.95;

/// One class.
pub(super) struct Bar {
    pub(super) label: String,
    /// Length of the bar.
    pub(super) outer: u64,
    /// A part of it, drawn inside.
    pub(super) inner: Option<u64>,
    /// Text after the number.
    pub(super) note: String,
}

/// A bar chart.
pub(super) struct Bars {
    pub(super) title: String,
    pub(super) axis: String,
    /// Names of the outer and inner bars.
    pub(super) legend: Option<[&'static str; 2]>,
    pub(super) bars: Vec<Bar>,
    pub(super) scale: Scale,
    /// What is counted is bytes.
    pub(super) is_size: bool,
}

impl Bars {
    pub(super) fn draw(&self) -> String {
        let Self { title, axis, legend, bars, scale, is_size } = self;
        let top = if legend.is_some() { 48.0 } else { 28.0 };
        let base = top + PITCH * bars.len() as f64;
        let mut svg = Svg::new(WIDTH, base + 40.0, title);
        let said = |n: u64| if *is_size { size(n) } else { grouped(&n.to_string()) };
        let numbers: Vec<String> = bars.iter().map(|bar| said(bar.outer) + &bar.note).collect();
        let widest = |texts: &mut dyn Iterator<Item = &String>| {
            texts.map(|text| text_width(text, FONT)).fold(0.0, f64::max)
        };
        let left = 10.0 + widest(&mut bars.iter().map(|bar| &bar.label));
        // Numbers have their own column on the right, so that none runs into a bar or out of the picture.
        let plot_width = (WIDTH - left - widest(&mut numbers.iter()) - 10.0).max(80.0);

        if let Some(names) = legend {
            let mut x = left;
            for (name, opacity) in names.iter().zip([OUTER, INNER]) {
                svg.rect([x, 26.0], [10.0, 10.0], opacity);
                svg.text([x + 14.0, 35.0], Anchor::Start, FONT, name);
                x += 34.0 + text_width(name, FONT);
            }
        }
        let mut free_from = f64::NEG_INFINITY;
        for &tick in &scale.ticks {
            let x = left + plot_width * scale.position(tick);
            // `200M` and `B` are 200 MB.
            let text = if *is_size { format!("{}B", short(tick)) } else { short(tick) };
            let half = 0.5 * text_width(&text, 10.0);
            svg.line([x, top], [x, base], false);
            if x - half >= free_from {
                svg.text([x, base + 14.0], Anchor::Middle, 10.0, &text);
                free_from = x + half + 6.0;
            }
        }
        for (i, (bar, number)) in bars.iter().zip(&numbers).enumerate() {
            let y = top + PITCH * i as f64;
            let text_y = y + 0.5 * PITCH + 4.0;
            svg.text([left - 6.0, text_y], Anchor::End, FONT, &bar.label);
            let length = |value: u64| plot_width * scale.position(value as f64);
            // Without a part of it, the bar itself is the strong one.
            let strength = if bar.inner.is_some() { OUTER } else { INNER };
            if length(bar.outer) > 0.0 {
                svg.rect([left, y + 3.0], [length(bar.outer), PITCH - 6.0], strength);
            }
            if let Some(inner) = bar.inner.filter(|&inner| length(inner) > 0.0) {
                svg.rect([left, y + 6.0], [length(inner), PITCH - 12.0], INNER);
            }
            svg.text([left + plot_width + 8.0, text_y], Anchor::Start, FONT, number);
        }
        svg.line([left, top], [left, base], true);
        svg.text([left + 0.5 * plot_width, base + 32.0], Anchor::Middle, FONT, axis);
        svg.finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_inner_bar_is_its_share_of_the_outer_one() {
        let bar = Bar { label: "car".into(), outer: 100, inner: Some(50), note: String::new() };
        let chart = Bars {
            title: "t".into(),
            axis: "n".into(),
            legend: None,
            bars: vec![bar],
            scale: Scale::linear(100.0),
            is_size: false,
        };
        let widths: Vec<f64> = chart
            .draw()
            .lines()
            .filter(|line| line.starts_with("<rect"))
            .filter_map(|line| line.split("width=\"").nth(1)?.split('"').next()?.parse().ok())
            .collect();
        assert_eq!(widths.len(), 2);
        assert!((widths[0] - 2.0 * widths[1]).abs() < 0.02);
    }
}
