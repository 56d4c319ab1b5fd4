//! What lies across a road over its superelevated plane: crossfall, lateral shape, lanes that stay level.

use frames::math::tan;

use super::widths::outer_border;
use super::{between, record_at, value_and_slope};
use crate::model::{Cubic, Lane, Road, RoadSide, Shape};

/// The cross-section of a road over its superelevated plane. Empty for nearly all roads.
#[derive(Debug, Default)]
pub(super) struct Lateral {
    shape: Vec<Shape>,
    /// Angles by s: left of the reference line, right of it.
    crossfall: [Vec<Cubic>; 2],
    /// Where lanes stay level; empty unless there is something that they stay level against.
    level: Vec<LevelSection>,
    lane_offset: Vec<Cubic>,
}

/// A lane section with level lanes: the lanes inside of the first one, on the left and on the right.
#[derive(Debug)]
struct LevelSection {
    s: f64,
    inside: [Option<Vec<Lane>>; 2],
}

impl Lateral {
    /// `banked`: whether the road has superelevation.
    pub(super) fn new(road: &Road, banked: bool) -> Self {
        // "Record present" does not mean "not flat": all-zero records are common.
        let shaped = !road.shape.iter().all(|s| s.cubic_of_t.is_zero());
        let mut lateral = Self::default();
        if shaped {
            lateral.shape = road.shape.clone();
        }
        for (list, other) in lateral.crossfall.iter_mut().zip([RoadSide::Right, RoadSide::Left]) {
            *list = road.crossfall.iter().filter(|c| c.side != other).map(|c| c.angle_rad).collect();
            if list.iter().all(Cubic::is_zero) {
                list.clear();
            }
        }
        if banked || !lateral.is_flat() {
            lateral.level = level_sections(road);
            if lateral.level.iter().any(|s| s.inside.iter().any(Option::is_some)) {
                lateral.lane_offset = road.lane_offset.clone();
            } else {
                lateral.level.clear();
            }
        }
        lateral
    }

    /// Whether the superelevated plane is the surface.
    pub(super) fn is_flat(&self) -> bool {
        self.shape.is_empty() && self.crossfall.iter().all(Vec::is_empty) && self.level.is_empty()
    }

    /// Every s between two places at which some record begins.
    pub(super) fn breaks(&self, from: f64, to: f64) -> impl Iterator<Item = f64> {
        let crossfall = self.crossfall.iter().flat_map(move |list| between(list, from, to, |c| c.s));
        between(&self.shape, from, to, |r| r.s).chain(crossfall)
    }

    /// Height over the superelevated plane, metres along its normal, of the surface that level lanes leave.
    pub(super) fn height(&self, s: f64, t: f64) -> f64 {
        // Crossfall is an angle from the t axis, positive where the road falls to the outside (OpenDRIVE 1.3,
        // 5.3.4.2).
        let crossfall = &self.crossfall[usize::from(t < 0.0)];
        let fall = if crossfall.is_empty() { 0.0 } else { t.abs() * tan(value_and_slope(crossfall, s).0) };
        self.shape_height(s, t) - fall
    }

    fn shape_height(&self, s: f64, t: f64) -> f64 {
        if self.shape.is_empty() {
            return 0.0;
        }
        let profile = |station: f64| {
            let from = self.shape.partition_point(|r| r.s < station);
            let to = self.shape.partition_point(|r| r.s <= station);
            let records = &self.shape[from..to];
            // Left of the first record there is no profile; its own start value continues.
            match record_at(records, t, |r| r.cubic_of_t.s).or(records.first()) {
                Some(r) => r.cubic_of_t.derivatives((t - r.cubic_of_t.s).max(0.0)).0,
                None => 0.0,
            }
        };
        let after = self.shape.partition_point(|r| r.s <= s);
        let before = after.checked_sub(1).map(|i| self.shape[i].s);
        match (before, self.shape.get(after).map(|r| r.s)) {
            (Some(a), Some(b)) => {
                let part = (s - a) / (b - a);
                profile(a) * (1.0 - part) + profile(b) * part
            }
            (Some(a), None) => profile(a),
            (None, Some(b)) => profile(b),
            (None, None) => 0.0,
        }
    }

    /// The border beyond which the surface is level at (s, t), if t lies beyond it: t of that border.
    pub(super) fn level_from(&self, s: f64, t: f64) -> Option<f64> {
        let section = record_at(&self.level, s, |section| section.s).or(self.level.first())?;
        let offset = value_and_slope(&self.lane_offset, s).0;
        let [left, right] = &section.inside;
        let border = |lanes: &[Lane]| outer_border(lanes, s - section.s).0;
        match (left, right) {
            (Some(lanes), _) if t > offset && t > offset + border(lanes) => Some(offset + border(lanes)),
            (_, Some(lanes)) if t < offset && t < offset - border(lanes) => Some(offset - border(lanes)),
            _ => None,
        }
    }
}

fn level_sections(road: &Road) -> Vec<LevelSection> {
    let inside = |lanes: &[Lane]| {
        let first = lanes.iter().position(|lane| lane.level)?;
        Some(lanes[..first].to_vec())
    };
    let section =
        |s: &crate::model::LaneSection| LevelSection { s: s.s, inside: [inside(&s.left), inside(&s.right)] };
    road.sections.iter().map(section).collect()
}
