//! Second heads of traffic lights: as in North America across the junction, over a wide road on an arm; as in
//! Europe at the left of the stop line where there is room, or else across the junction.

use frames::math::sin_cos;
use nalgebra::{Point3, Vector3};
use opendrive::{LaneInfo, LanePoint, LanePos, LaneType, SignalInfo};

use crate::scenery::site::Site;
use crate::scenery::style::FurnitureStyle;
use crate::surfaces::Ground;

/// Approaches with at least so many lanes have a second head.
const WIDE_LANES: usize = 2;
/// No second head is farther from the stop line than this, metres.
pub(super) const FAR_M: f64 = 60.0;
/// One across the junction stands beside the road that leads on, this far behind where it begins and from its
/// kerb, metres.
const BEHIND_M: f64 = 1.2;
const BESIDE_M: f64 = 0.5;
/// Its arm ends over the middle of the road's side, and is this long at least and at most, metres.
const ARM_M: [f64; 2] = [3.0, 7.5];
/// One at the stop line stands this far left of the lanes and before the line, and so much around it is not
/// driven on, metres.
const LEFT_M: f64 = 0.6;
const BEFORE_M: f64 = 1.2;
const FREE_M: f64 = 0.4;
/// It is no nearer to the first head than this, metres.
const APART_M: f64 = 4.0;

/// A pole with a second head.
pub(super) struct Second {
    pub(super) foot: Point3<f64>,
    /// The way it looks.
    pub(super) yaw_rad: f64,
    /// Length of its arm, which reaches to the left of those who see it, metres; 0 without one.
    pub(super) arm_m: f64,
}

/// The second head of a light; none for narrow approaches and where there is no room for it.
pub(super) fn second(site: &Site<'_>, index: usize, signal: &SignalInfo) -> Option<Second> {
    let stops = site.map.stop_points(index);
    if stops.len() < WIDE_LANES {
        return None;
    }
    let left =
        if site.style() == FurnitureStyle::European { at_the_left(site, &stops, signal) } else { None };
    left.or_else(|| across(site, &stops, signal))
}

/// Left of the stop line, on an island between the two directions or beside a one-way road.
fn at_the_left(site: &Site<'_>, stops: &[LanePos], signal: &SignalInfo) -> Option<Second> {
    let point = |stop: &LanePos| site.map.point_at(*stop);
    let first = point(stops.first()?)?;
    let (s, c) = sin_cos(first.heading_rad);
    let left = Vector3::new(-s, c, 0.0);
    let leftmost = |stop: &LanePos| -> Option<(f64, LanePoint, f64)> {
        let at = point(stop)?;
        let lane = site.map.lane(stop.lane)?;
        let bounds = site.map.lane_bounds(stop.lane, lane.s_of_along(stop.along_m))?;
        Some(((at.position - first.position).dot(&left), at, 0.5 * (bounds.outer - bounds.inner).norm()))
    };
    let (_, at, half_m) = stops.iter().filter_map(leftmost).max_by(|a, b| a.0.total_cmp(&b.0))?;
    let foot = at.position + left * (half_m + LEFT_M) - Vector3::new(c, s, 0.0) * BEFORE_M;
    let driven = |[u, v]: [f64; 2]| {
        let p = foot + left * (u * FREE_M) + Vector3::new(c, s, 0.0) * (v * FREE_M);
        site.levels().cover.at(p.x, p.y).any(|(facet, _)| facet.ground == Ground::Paved)
    };
    let around = [[0.0, 0.0], [-1.0, 0.0], [1.0, 0.0], [0.0, -1.0], [0.0, 1.0]];
    let yaw_rad = first.heading_rad + std::f64::consts::PI;
    // The first one may stand there itself.
    let apart_m = (foot - signal.on_surface).xy().norm();
    (apart_m > APART_M && !around.into_iter().any(driven)).then_some(Second { foot, yaw_rad, arm_m: 0.0 })
}

/// Across the junction, right of where the straightest way on leaves it; none where nothing leads on.
fn across(site: &Site<'_>, stops: &[LanePos], signal: &SignalInfo) -> Option<Second> {
    let stop = site.map.point_at(*stops.first()?)?;
    // How much each controlled way turns, and the lane that it leads to.
    let ways =
        signal.lanes.iter().filter_map(|id| site.map.lane(*id).filter(|l| l.junction.is_some())).filter_map(
            |way| {
                let end = site.map.lane_point(way.id, way.s_of_along(way.s_length()), 0.0)?;
                let exit = site.map.successors(way.id).first().and_then(|id| site.map.lane(*id))?;
                let turn = frames::wrap_pi(end.heading_rad - stop.heading_rad).abs();
                exit.junction.is_none().then_some((turn, exit))
            },
        );
    let (turn, exit) = ways.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.id.cmp(&b.1.id)))?;
    if turn > 0.6 {
        return None;
    }
    let (foot, middle_m) = kerbside(site, exit)?;
    let yaw_rad = stop.heading_rad + std::f64::consts::PI;
    let away = foot - stop.position;
    let has_arm = site.style() == FurnitureStyle::American && middle_m > ARM_M[0];
    let arm_m = if has_arm { middle_m.min(ARM_M[1]) } else { 0.0 };
    (away.norm() < FAR_M).then_some(Second { foot, yaw_rad, arm_m })
}

/// A place beside all that vehicles use of the side of a road that a lane is on, just behind where the lane
/// begins, and how far it is from the middle of what is driven on, metres.
fn kerbside(site: &Site<'_>, lane: &LaneInfo) -> Option<(Point3<f64>, f64)> {
    let s = lane.s_of_along(BEHIND_M.min(0.5 * lane.s_length()));
    let side = site.map.lanes_of(lane.id.road, lane.id.section);
    let same = |l: &&LaneInfo| (l.id.lane > 0) == (lane.id.lane > 0);
    let mut outwards: Vec<&LaneInfo> = side.iter().filter(same).collect();
    outwards.sort_by_key(|l| l.id.lane.abs());
    let driven = outwards.iter().rposition(|l| l.lane_type.is_drivable())?;
    let paved = |l: &LaneInfo| {
        matches!(
            l.lane_type,
            LaneType::Shoulder | LaneType::Parking | LaneType::Biking | LaneType::Border | LaneType::Stop
        )
    };
    let beyond = outwards[driven + 1..].iter().take_while(|l| paved(l)).count();
    let edge = site.map.lane_bounds(outwards[driven + beyond].id, s)?;
    let out = Vector3::new(edge.outer.x - edge.inner.x, edge.outer.y - edge.inner.y, 0.0);
    let out = out.try_normalize(1e-6).or_else(|| {
        let edge = site.map.lane_bounds(outwards[driven].id, s)?;
        Vector3::new(edge.outer.x - edge.inner.x, edge.outer.y - edge.inner.y, 0.0).try_normalize(1e-6)
    })?;
    let foot = edge.outer + out * BESIDE_M;
    let first = outwards.iter().find(|l| l.lane_type.is_drivable())?;
    let inner = site.map.lane_bounds(first.id, s)?.inner;
    let last = site.map.lane_bounds(outwards[driven].id, s)?.outer;
    Some((foot, (foot - nalgebra::center(&inner, &last)).xy().norm()))
}
