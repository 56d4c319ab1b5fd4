//! Curves on common axes, one a class, say.

use super::scale::Scale;
use super::svg::{Anchor, Svg, text_width};
use crate::text::short;

const HEIGHT: f64 = 340.0;
const TOP: f64 = 28.0;
const BOTTOM: f64 = 42.0;
const FONT: f64 = 11.0;

/// A curve.
pub(super) struct Curve {
    pub(super) label: String,
    /// Red, green, blue.
    pub(super) rgb: [u8; 3],
    /// x and y, ascending x.
    pub(super) points: Vec<[f64; 2]>,
}

/// Curves with a common axis.
pub(super) struct Curves<'a> {
    pub(super) title: &'a str,
    pub(super) x_label: &'a str,
    pub(super) y_label: &'a str,
    /// The end of the axis, and in how many steps it is reached.
    pub(super) x_max: f64,
    pub(super) x_steps: u32,
    pub(super) scale: Scale,
    pub(super) width: f64,
    pub(super) curves: Vec<Curve>,
}

impl Curves<'_> {
    pub(super) fn draw(&self) -> String {
        let Self { scale, width, .. } = self;
        let mut svg = Svg::new(*width, HEIGHT, self.title);
        let names = self.curves.iter().map(|c| text_width(&c.label, FONT)).fold(0.0, f64::max);
        let (left, right) = (52.0, width - names - 32.0);
        let base = HEIGHT - BOTTOM;
        let x = |value: f64| left + (right - left) * value / self.x_max;
        let y = |value: f64| base - (base - TOP) * scale.position(value);
        for &tick in &scale.ticks {
            svg.line([left, y(tick)], [right, y(tick)], scale.ticks.first() == Some(&tick));
            svg.text([left - 5.0, y(tick) + 4.0], Anchor::End, 10.0, &short(tick));
        }
        for tick in (0..=self.x_steps).map(|i| f64::from(i) * self.x_max / f64::from(self.x_steps)) {
            svg.line([x(tick), base], [x(tick), base + 3.0], true);
            svg.text([x(tick), base + 15.0], Anchor::Middle, 10.0, &short(tick));
        }
        for (i, curve) in self.curves.iter().enumerate() {
            let path: Vec<[f64; 2]> = curve.points.iter().map(|p| [x(p[0]), y(p[1])]).collect();
            svg.curve(&path, curve.rgb);
            let at = TOP + 8.0 + 18.0 * i as f64;
            svg.curve(&[[right + 8.0, at], [right + 22.0, at]], curve.rgb);
            svg.text([right + 26.0, at + 4.0], Anchor::Start, FONT, &curve.label);
        }
        svg.text([0.5 * (left + right), HEIGHT - 8.0], Anchor::Middle, FONT, self.x_label);
        svg.text_up([12.0, 0.5 * (TOP + base)], Anchor::Middle, FONT, self.y_label);
        svg.finish()
    }
}
