//! Traffic lights: what the map has, and second heads for wide approaches.

use crate::surfaces::Ground;
use frames::OrientedRect;
use frames::math::{atan2, sin_cos};
use nalgebra::{Point3, Vector3};
use opendrive::{LaneInfo, LaneType, SignalInfo};
use schema::footprint::LightMount;
use schema::{ActorKind, Attribute, Attributes, Tag};

use crate::scenery::draft::Draft;
use crate::scenery::land::Land;
use crate::scenery::site::{FOOT_M, POLE_M, Site, reach_m};
use crate::scenery::swept::is_swept;

/// Housing of a traffic light: length, width, height, metres.
const HOUSING_M: [f64; 3] = [0.36, 0.42, 1.10];
/// Bottom of a housing on a pole, and of one that hangs from an arm, over the ground, metres.
const ON_POLE_M: f64 = 2.6;
const ON_ARM_M: f64 = 5.2;
/// Lanes farther from the pole than this get an arm over the road, metres.
const ARM_FROM_M: f64 = 5.0;
const MAX_ARM_M: f64 = 7.5;
/// Approaches with at least so many lanes have a second head, across the junction.
const WIDE_LANES: usize = 2;
/// No second head is farther from the stop line than this, metres.
const FAR_M: f64 = 60.0;
/// A second head stands beside the road that leads on, this far behind where it begins and from its kerb,
/// metres.
const BEHIND_M: f64 = 1.2;
const BESIDE_M: f64 = 0.5;

/// The traffic lights of the map. Those of the area become objects; the ground of all that are near is taken.
pub(crate) fn lights(site: &Site<'_>, land: &mut Land<'_>, drafts: &mut Vec<Draft>) {
    let dynamic = site.map.signals().iter().enumerate().filter(|(_, signal)| signal.dynamic);
    let mut seconds: Vec<(Point3<f64>, f64, &SignalInfo)> = Vec::new();
    for (i, signal) in dynamic {
        let foot = signal.on_surface;
        // A second head is across the junction from its first one.
        if !site.near(foot.x, foot.y, reach_m::GIVEN + 2.0 * FAR_M) {
            continue;
        }
        seconds.extend(second(site, i, signal).map(|(foot, yaw)| (foot, yaw, signal)));
        if !site.near(foot.x, foot.y, reach_m::GIVEN) {
            continue;
        }
        land.take(OrientedRect::square([foot.x, foot.y], FOOT_M));
        if site.holds(foot.x, foot.y) {
            drafts.push(first(site, i, signal));
        }
    }
    // What stands where the map says goes first; of two second heads at one place, that of the earlier
    // signal.
    for (foot, yaw, signal) in seconds.into_iter().filter(|(p, ..)| site.near(p.x, p.y, reach_m::GIVEN)) {
        let takes = OrientedRect::square([foot.x, foot.y], FOOT_M);
        let on_lane = site.levels().cover.at(foot.x, foot.y).any(|(f, _)| f.ground == Ground::Paved);
        if on_lane || !land.unused(&takes) || is_swept(site.map, foot, POLE_M) {
            continue;
        }
        land.take(takes);
        if site.holds(foot.x, foot.y) {
            let mount = LightMount { height_m: ON_POLE_M as f32, arm_m: 0.0, pole_right: true };
            drafts.push(head(site, signal, foot, yaw, mount));
        }
    }
}

/// The light where the map has it, on its pole or on an arm over its lanes.
fn first(site: &Site<'_>, index: usize, signal: &SignalInfo) -> Draft {
    let foot = signal.on_surface;
    let yaw = site.facing_yaw(index, signal);
    let (s, c) = sin_cos(yaw);
    // Left of the way it faces is the right of the traffic that sees it.
    let left = Vector3::new(-s, c, 0.0);
    let stops = site.map.stop_points(index).into_iter().filter_map(|stop| site.map.point_at(stop));
    let lanes: Vec<f64> = stops.map(|p| (p.position - foot).dot(&left)).collect();
    let mean = lanes.iter().sum::<f64>() / lanes.len().max(1) as f64;
    let arm = if mean.abs() > ARM_FROM_M { (mean.abs() - 1.0).min(MAX_ARM_M) } else { 0.0 };
    // Whole decimetres and centimetres: that is what the variant can say.
    let arm = (10.0 * arm).round() / 10.0;
    let height = if arm > 0.0 { ON_ARM_M } else { ON_POLE_M };
    let mount = LightMount { height_m: height as f32, arm_m: arm as f32, pole_right: mean < 0.0 };
    head(site, signal, foot, yaw, mount)
}

/// A housing that looks along `yaw`; its pole stands at `foot`.
fn head(site: &Site<'_>, signal: &SignalInfo, foot: Point3<f64>, yaw: f64, mount: LightMount) -> Draft {
    let ground_z = site.levels().height(foot.x, foot.y, foot.z);
    let (s, c) = sin_cos(yaw);
    let (face, left) = (Vector3::new(c, s, 0.0), Vector3::new(-s, c, 0.0));
    let arm = f64::from(mount.arm_m);
    let at = foot + left * if mount.pole_right { -arm } else { arm } + face * (0.5 * HOUSING_M[0] + 0.07);
    let xyz = [at.x, at.y, ground_z + f64::from(mount.height_m)];
    let mut draft =
        Draft::new(ActorKind::TrafficLight, "light.signal", Tag::TrafficLight, HOUSING_M, xyz, yaw);
    draft.tags.insert(0, Tag::Pole);
    draft.variant = mount.to_variant();
    draft.opendrive_id = Some(signal.id.clone());
    draft.attributes = Attributes::new().with(Attribute::GroundZ, format_args!("{ground_z:.3}"));
    draft
}

/// Where the second head of a light stands, and the way it looks: across the junction, right of where the
/// straightest way on leaves it. None for narrow approaches, and where nothing leads on.
fn second(site: &Site<'_>, index: usize, signal: &SignalInfo) -> Option<(Point3<f64>, f64)> {
    let stops = site.map.stop_points(index);
    if stops.len() < WIDE_LANES {
        return None;
    }
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
    let foot = kerbside(site, exit)?;
    let yaw = stop.heading_rad + std::f64::consts::PI;
    let away = foot - stop.position;
    (away.norm() < FAR_M).then_some((foot, yaw))
}

/// A place beside all that vehicles use of the side of a road that a lane is on, just behind where the lane
/// begins.
fn kerbside(site: &Site<'_>, lane: &LaneInfo) -> Option<Point3<f64>> {
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
    Some(edge.outer + out * BESIDE_M)
}

impl Site<'_> {
    /// Yaw of what a signal's traffic sees: against their direction of travel.
    pub(crate) fn facing_yaw(&self, index: usize, signal: &SignalInfo) -> f64 {
        let mut sum = Vector3::zeros();
        for stop in self.map.stop_points(index) {
            if let Some(point) = self.map.point_at(stop) {
                let (s, c) = sin_cos(point.heading_rad);
                sum += Vector3::new(c, s, 0.0);
            }
        }
        if sum.norm() > 0.3 { atan2(-sum.y, -sum.x) } else { signal.pose.yaw() + std::f64::consts::PI }
    }
}
