//! How predictions fared.

use super::bars::{Bar, Bars};
use super::curves::{Curve, Curves};
use super::largest;
use super::scale::Scale;
use crate::text::grouped;

/// From the strictest to the most lenient threshold.
const COLOURS: [[u8; 3]; 4] = [[205, 84, 70], [196, 144, 42], [74, 150, 92], [69, 132, 182]];

/// Precision over recall of a class.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PrecisionCurves {
    /// The class.
    pub title: String,
    /// A name and points (recall, precision), ascending recall, for each threshold.
    pub curves: Vec<(String, Vec<[f64; 2]>)>,
}

/// What was found of some targets.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct FoundBar {
    /// Which targets.
    pub label: String,
    /// How many there are.
    pub targets: u64,
    /// How many of them were found.
    pub found: u64,
    /// How many predictions were of nothing.
    pub wrong: u64,
}

/// Precision over recall, a curve a threshold.
pub(crate) fn precision_figure(of: &PrecisionCurves) -> String {
    let curves = of.curves.iter().zip(COLOURS.into_iter().cycle());
    let curves =
        curves.map(|((label, points), rgb)| Curve { label: label.clone(), rgb, points: points.clone() });
    let figure = Curves {
        title: &of.title,
        x_label: "recall",
        y_label: "precision",
        x_max: 1.0,
        x_steps: 5,
        scale: Scale::unit(),
        width: 500.0,
        curves: curves.collect(),
    };
    figure.draw()
}

/// Targets and what was found of them, with what was wrong.
pub(crate) fn found_figure(title: &str, bars: &[FoundBar]) -> String {
    let bar = |of: &FoundBar| Bar {
        label: of.label.clone(),
        outer: of.targets,
        inner: Some(of.found),
        note: format!(", {} found, {} false", grouped(&of.found.to_string()), grouped(&of.wrong.to_string())),
    };
    let bars: Vec<Bar> = bars.iter().map(bar).collect();
    let scale = Scale::linear(largest(&bars));
    let (title, axis) = (title.to_owned(), "targets".into());
    Bars { title, axis, legend: Some(["targets", "found"]), bars, scale, is_size: false }.draw()
}
