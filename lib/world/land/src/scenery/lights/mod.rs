//! Traffic lights: what the map has, second heads for wide approaches, and heads for people who cross.

mod head;
mod second;
#[cfg(test)]
mod tests;
mod walkers;

use frames::OrientedRect;
use frames::math::{atan2, sin_cos};
use nalgebra::{Point3, Vector3};
use opendrive::SignalInfo;
use schema::footprint::LightMount;

use crate::scenery::draft::Draft;
use crate::scenery::land::Land;
use crate::scenery::site::{FOOT_M, POLE_M, Site, reach_m};
use crate::scenery::style::FurnitureStyle;
use crate::scenery::swept::is_swept;
use crate::surfaces::Ground;
use head::{SIGNAL, head};
use second::{FAR_M, Second, second};
use walkers::walkers;

/// Bottom of a housing on a pole, and of one that hangs from an arm, over the ground, metres.
const ON_POLE_M: f64 = 2.6;
const ON_ARM_M: f64 = 5.2;
/// Lanes farther from the pole than this get an arm over the road, metres.
const ARM_FROM_M: f64 = 5.0;
const MAX_ARM_M: f64 = 7.5;

/// The traffic lights of the map. Those of the area become objects; the ground of all that are near is taken.
pub(crate) fn lights(site: &Site<'_>, land: &mut Land<'_>, drafts: &mut Vec<Draft>) {
    let dynamic = site.map.signals().iter().enumerate().filter(|(_, signal)| signal.dynamic);
    let mut seconds: Vec<(Second, &SignalInfo)> = Vec::new();
    let mut poles: Vec<Point3<f64>> = Vec::new();
    for (i, signal) in dynamic {
        let foot = signal.on_surface;
        // A second head is across the junction from its first one.
        if !site.near(foot.x, foot.y, reach_m::GIVEN + 2.0 * FAR_M) {
            continue;
        }
        seconds.extend(second(site, i, signal).map(|second| (second, signal)));
        if !site.near(foot.x, foot.y, reach_m::GIVEN + FAR_M) {
            continue;
        }
        land.take(OrientedRect::square([foot.x, foot.y], FOOT_M));
        poles.push(foot);
        if site.holds(foot.x, foot.y) {
            drafts.extend(first(site, i, signal));
        }
    }
    // What stands where the map says goes first; of two second heads at one place, that of the earlier
    // signal.
    let seconds = seconds.into_iter().filter(|(s, _)| site.near(s.foot.x, s.foot.y, reach_m::GIVEN + FAR_M));
    for (Second { foot, yaw_rad, arm_m }, signal) in seconds {
        let takes = OrientedRect::square([foot.x, foot.y], FOOT_M);
        let on_lane = site.levels().cover.at(foot.x, foot.y).any(|(f, _)| f.ground == Ground::Paved);
        if on_lane || !land.unused(&takes) || is_swept(site.map, foot, POLE_M) {
            continue;
        }
        land.take(takes);
        poles.push(foot);
        if site.holds(foot.x, foot.y) {
            drafts.extend(heads(site, signal, foot, yaw_rad, arm_m, true));
        }
    }
    walkers(site, land, &mut poles, drafts);
}

/// The light where the map has it, on its pole or on an arm over its lanes.
fn first(site: &Site<'_>, index: usize, signal: &SignalInfo) -> Vec<Draft> {
    let foot = signal.on_surface;
    let yaw = site.facing_yaw(index, signal);
    let (s, c) = sin_cos(yaw);
    // Left of the way it faces is the right of the traffic that sees it.
    let left = Vector3::new(-s, c, 0.0);
    let stops = site.map.stop_points(index).into_iter().filter_map(|stop| site.map.point_at(stop));
    let lanes: Vec<f64> = stops.map(|p| (p.position - foot).dot(&left)).collect();
    let mean = lanes.iter().sum::<f64>() / lanes.len().max(1) as f64;
    let arm = if mean.abs() > ARM_FROM_M { (mean.abs() - 1.0).min(MAX_ARM_M) } else { 0.0 };
    heads(site, signal, foot, yaw, arm, mean < 0.0)
}

/// The heads on a pole: one on it, or one on its arm over the road and in Europe a second one below that.
fn heads(
    site: &Site<'_>,
    signal: &SignalInfo,
    foot: Point3<f64>,
    yaw_rad: f64,
    arm_m: f64,
    pole_right: bool,
) -> Vec<Draft> {
    // Whole decimetres and centimetres: that is what the variant can say.
    let arm_m = ((10.0 * arm_m).round() / 10.0) as f32;
    let low = LightMount { height_m: ON_POLE_M as f32, arm_m: 0.0, pole_right, hangs: false };
    let place = (foot, yaw_rad);
    if arm_m <= 0.0 {
        return vec![head(site, &SIGNAL, &signal.id, place, low)];
    }
    let high = LightMount { height_m: ON_ARM_M as f32, arm_m, ..low };
    let hangs = LightMount { hangs: true, ..low };
    let has_low = site.style() == FurnitureStyle::European;
    let mounts = std::iter::once(high).chain(has_low.then_some(hangs));
    mounts.map(|mount| head(site, &SIGNAL, &signal.id, place, mount)).collect()
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
