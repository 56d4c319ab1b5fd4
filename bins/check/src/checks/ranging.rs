//! Lidar and radar against depth images and velocities.

use std::collections::BTreeMap;

use schema::FRAME_PERIOD_S;

use super::cameras::{Sight, depth_m};
use super::clouds::{Cloud, Kind, OfSurface, SIGMAS};
use crate::ledger::Ledger;
use crate::rules::Rule;
use crate::scene::{AgentTrack, Scene};
use crate::space::{V3, dot, norm, scale, sub, within};

/// Depth and range may differ by this, m, and by this share.
const DEPTH: [f64; 2] = [0.05, 0.005];
/// Objects with fewer returns in a picture are not judged.
const FEW: u64 = 12;
/// Radial velocities may differ by this, m/s.
const VELOCITY_MPS: f64 = 0.05;

/// Where a return falls into the middle of an object's pixels, their depths hold its own; what one of both
/// sees past the other's edge is why more than half of an object's returns count.
pub(crate) fn check_depth(sight: &Sight<'_>, cloud: &Cloud<'_>, own: u16, frame: usize, ledger: &mut Ledger) {
    let (Some(depth), camera) = (&sight.depth, sight.camera) else { return };
    let mut judged: BTreeMap<u16, (u64, u64, f64)> = BTreeMap::new();
    // Pictures of depth stop at the pane.
    let met_first = cloud.surfaces().filter(|of| !of.behind_glass);
    for OfSurface { point, id, tag, .. } in met_first {
        let seen = sight.world_from_optical.inward(point);
        let at_m = camera.optics.depth_of(seen);
        if id == own || at_m < 0.2 {
            continue;
        }
        let Some([u, v]) = camera.optics.project(seen) else { continue };
        let (width, height) = camera.size();
        if !(u >= 0.0 && v >= 0.0 && u < width as f64 && v < height as f64) {
            continue;
        }
        let (x, y) = (u as usize, v as usize);
        if sight.inner(x, y) != Some((id, tag)) {
            continue;
        }
        let depths = (0..9).filter_map(|k| depth_m(depth.at(x + k % 3 - 1, y + k / 3 - 1)));
        let (low, high) = depths.fold((f64::INFINITY, 0.0_f64), |(low, high), d| (low.min(d), high.max(d)));
        let tolerance = DEPTH[0] + DEPTH[1] * at_m + SIGMAS * cloud.ranger.noise_m;
        let beyond = (low - at_m).max(at_m - high) - tolerance;
        let (all, off, worst) = judged.entry(id).or_insert((0, 0, 0.0));
        *all += 1;
        if beyond > 0.0 {
            *off += 1;
            *worst = worst.max(beyond);
        }
    }
    for (id, (all, off, worst)) in judged.into_iter().filter(|(_, (all, ..))| *all >= FEW) {
        ledger.expect(Rule::DepthLidar, 2 * off <= all, || {
            format!(
                "frame {frame}: {off} of {all} returns of {} from object {id} are at another depth than in {} (up to {worst:.2} m more than allowed)",
                cloud.ranger.name, camera.name
            )
        });
    }
}

/// Radial velocities are those of the body hit and of the radar over the last frame.
pub(crate) fn check_velocity(
    scene: &Scene,
    agent: &AgentTrack,
    cloud: &Cloud<'_>,
    frame: usize,
    ledger: &mut Ledger,
) {
    if cloud.ranger.kind != Kind::Radar {
        return;
    }
    let name = &cloud.ranger.name;
    ledger.expect(Rule::RadarPresence, !cloud.points.is_empty(), || {
        format!("frame {frame}: {name} has no return")
    });
    let Some(before) = scene.agent_pose(agent, frame as i64 - 1) else { return };
    let sensor = cloud.world_from_sensor.origin;
    let sensor_before = before.outward(cloud.ranger.agent_from_sensor.origin);
    let mut by_object: BTreeMap<u16, (u64, u64, f64)> = BTreeMap::new();
    for ((point, id), &velocity) in cloud.in_world().zip(&cloud.ids).zip(&cloud.velocities) {
        let moves = scene.actors.get(id).is_none_or(|actor| !actor.fixed);
        if cloud.ranger.micro_motion && moves {
            ledger.skip(
                Rule::RadarVelocity,
                format!("{}: of what moves, micro_motion is on", cloud.ranger.name),
            );
            continue;
        }
        let Some(was) = point_before(scene, *id, frame, point) else { continue };
        let moved = sub(sub(point, was), sub(sensor, sensor_before));
        let away = sub(point, sensor);
        let wanted = dot(scale(moved, 1.0 / FRAME_PERIOD_S), away) / norm(away).max(1e-9);
        let off = (wanted - f64::from(velocity)).abs();
        let (all, bad, worst) = by_object.entry(*id).or_insert((0, 0, 0.0));
        *all += 1;
        if !within(off, VELOCITY_MPS) {
            *bad += 1;
            *worst = worst.max(off);
        }
    }
    for (id, (all, bad, worst)) in by_object {
        ledger.fine(Rule::RadarVelocity, all - bad);
        let model = scene.actors.get(&id).map_or("", |actor| actor.model.as_str());
        ledger.all_off(Rule::RadarVelocity, bad, model, || {
            format!("frame {frame}: {bad} of {all} returns of {name} from object {id} ({model}) are up to {worst:.2} m/s off")
        });
    }
}

/// Where a point of an object was a frame before, if the object moves as one body.
pub(crate) fn point_before(scene: &Scene, id: u16, frame: usize, point: V3) -> Option<V3> {
    if scene.actors.get(&id)?.fixed {
        return Some(point);
    }
    let (now, before) = (scene.pose(id, frame as i64)?, scene.pose(id, frame as i64 - 1)?);
    Some(before.outward(now.inward(point)))
}
