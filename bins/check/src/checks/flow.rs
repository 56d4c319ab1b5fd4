//! Optical flow against the log and against the previous frame's images.

use std::collections::BTreeMap;

use schema::Tag;

use super::cameras::{Sight, depth_m, label};
use super::ranging::point_before;
use crate::ledger::Ledger;
use crate::rules::Rule;
use crate::scene::Scene;
use crate::space::{V3, norm, sub};

/// Flow may differ by this, pixels, and by this share of it.
const FLOW: [f64; 2] = [0.1, 0.02];
/// Rims turn as fast as their body drives, and somewhat faster where it slides.
const WHEELS: f64 = 1.1;
/// Flow beyond this (a picture is 2) is cut off and not judged.
const CUT: f64 = 1.95;
/// Objects with fewer pixels are not judged.
const FEW: u64 = 30;
/// What was this near to the camera is not judged, m.
const NEAR_M: f64 = 0.3;
/// What hides an object is nearer by this, m, and by this share.
const NEARER: [f64; 2] = [0.05, 0.01];

/// Pixels of an object: all, and those that are off.
type Judged = BTreeMap<u16, [u64; 2]>;

/// Checks the flow of a camera. `before`: what it saw in the previous frame, if there is one.
pub(crate) fn check(
    scene: &Scene,
    now: &Sight<'_>,
    before: &Sight<'_>,
    own: u16,
    frame: usize,
    ledger: &mut Ledger,
) {
    let camera = now.camera;
    let (Some(table), Some(at)) = (&camera.flow, camera.row_of(frame)) else { return };
    let (Some(instance), Some(depth)) = (&now.instance, &now.depth) else {
        let why = "flow is checked where depth and instance images are kept, too";
        ledger.skip(Rule::Flow, why);
        ledger.skip(Rule::FlowIds, why);
        return;
    };
    if frame > 0 && before.instance.is_none() {
        ledger.skip(Rule::FlowIds, "flow is motion since the frame before, at which there is no picture");
    }
    let row = table.row(at).and_then(|row| Ok((row.first_floats("dx")?, row.first_floats("dy")?)));
    let Some(((dx, is_half), (dy, _))) = ledger.read(row) else { return };
    // Half floats are exact to a 2048th: well within the tolerance, which is for both.
    ledger.expect(Rule::Flow, is_half == camera.flow_half, || {
        format!("{}: flow is kept as {} floats", camera.name, if is_half { "half" } else { "32-bit" })
    });
    let (width, height) = camera.size();
    let pixels = width * height;
    ledger.expect(Rule::Pictures, dx.len() == pixels && dy.len() == pixels, || {
        format!("frame {frame}: the flow of {} has {} pixels", camera.name, dx.len())
    });
    if dx.len() != pixels || dy.len() != pixels {
        return;
    }
    let (mut flow, mut beyond_wheels, mut found) = (Judged::new(), Judged::new(), Judged::new());
    for (k, (pixel, depth)) in instance.pixels().iter().zip(depth.pixels()).enumerate() {
        let (id, tag) = label(*pixel);
        let (x, y) = ((k % width) as f64 + 0.5, (k / width) as f64 + 0.5);
        let (flow_x, flow_y) = (f64::from(dx[k]), f64::from(dy[k]));
        if flow_x.abs().max(flow_y.abs()) > CUT || id == own {
            continue;
        }
        let moved = [0.5 * flow_x * width as f64, -0.5 * flow_y * height as f64];
        let Some(point) = point_of(now, [x, y], depth_m(*depth), id) else { continue };
        let Some(was) = point_before_or_sky(scene, id, frame, point, now, before) else { continue };
        let was_m = camera.optics.depth_of(was);
        if was_m < NEAR_M {
            continue;
        }
        let Some([was_x, was_y]) = camera.optics.project(was) else { continue };
        let wanted = [x - was_x, y - was_y];
        if !moves_its_limbs(tag) {
            let off = libm::hypot(moved[0] - wanted[0], moved[1] - wanted[1]);
            let allowed = FLOW[0] + FLOW[1] * libm::hypot(wanted[0], wanted[1]);
            // Beyond the cut the file says less than there was.
            let is_cut =
                wanted[0].abs() > 0.48 * CUT * width as f64 || wanted[1].abs() > 0.48 * CUT * height as f64;
            if !is_cut {
                judge(&mut flow, id, off <= allowed);
                let wheels = wheels_px(now, before, point, was, [was_x, was_y]);
                judge(&mut beyond_wheels, id, off <= allowed + wheels);
            }
        }
        if id != 0
            && now.inner(k % width, k / width).is_some()
            && let Some(holds) = was_there(before, [x - moved[0], y - moved[1]], id, was_m)
        {
            judge(&mut found, id, holds);
        }
    }
    for (rule, judged) in [(Rule::Flow, flow), (Rule::FlowIds, found)] {
        for (id, [all, off]) in judged.into_iter().filter(|(_, [all, _])| *all >= FEW) {
            // Wheels turn; fences are seen through.
            let turns = rule == Rule::Flow && scene.actors.get(&id).is_some_and(|actor| !actor.fixed);
            let wheels_alone = || beyond_wheels.get(&id).is_some_and(|[all, off]| *off <= all / 10);
            let allowed = match rule {
                Rule::Flow if turns && wheels_alone() => all,
                Rule::Flow if turns => 3 * all / 4,
                Rule::Flow => all / 10,
                _ => all / 2,
            };
            ledger.expect(rule, off <= allowed, || {
                let model = scene.actors.get(&id).map_or("sky", |actor| actor.model.as_str());
                format!("frame {frame}: {}: {off} of {all} pixels of object {id} ({model})", camera.name)
            });
        }
    }
}

/// How far a wheel's rim may be from where its body takes it, pixels: as far as the body has come, seen from here.
fn wheels_px(now: &Sight<'_>, before: &Sight<'_>, point: V3, was: V3, [x, y]: [f64; 2]) -> f64 {
    let way_m = norm(sub(now.world_from_optical.outward(point), before.world_from_optical.outward(was)));
    let beside = now.camera.optics.project([was[0] + way_m, was[1], was[2]]);
    WHEELS * beside.map_or(0.0, |[to_x, to_y]| libm::hypot(to_x - x, to_y - y))
}

fn judge(judged: &mut Judged, id: u16, holds: bool) {
    let [all, off] = judged.entry(id).or_default();
    *all += 1;
    *off += u64::from(!holds);
}

/// Parts that do not move with their object's body.
fn moves_its_limbs(tag: u8) -> bool {
    [Tag::Pedestrian, Tag::Rider, Tag::Bicycle].iter().any(|&t| t as u8 == tag)
}

/// The point at a pixel in the optical frame, or the direction of the sky.
fn point_of(sight: &Sight<'_>, [x, y]: [f64; 2], depth: Option<f64>, id: u16) -> Option<V3> {
    let ray = sight.camera.optics.ray([x, y]);
    if id == 0 { Some(ray) } else { depth.map(|depth| ray.map(|part| part * depth)) }
}

/// A point of the optical frame a frame before, in the optical frame of then.
fn point_before_or_sky(
    scene: &Scene,
    id: u16,
    frame: usize,
    point: V3,
    now: &Sight<'_>,
    before: &Sight<'_>,
) -> Option<V3> {
    if id == 0 {
        return Some(before.world_from_optical.turn_back(now.world_from_optical.turn(point)));
    }
    let was = point_before(scene, id, frame, now.world_from_optical.outward(point))?;
    Some(before.world_from_optical.inward(was))
}

/// Whether an object was at a place of the previous picture, or something nearer; none where that cannot be told.
fn was_there(before: &Sight<'_>, [x, y]: [f64; 2], id: u16, at_m: f64) -> Option<bool> {
    let (instance, depth) = (before.instance.as_ref()?, before.depth.as_ref()?);
    if !(x >= 1.0 && y >= 1.0 && x < instance.width as f64 - 1.0 && y < instance.height as f64 - 1.0) {
        return None;
    }
    let (x, y) = (x as usize, y as usize);
    let around = || (0..9).map(|k| (x + k % 3 - 1, y + k / 3 - 1));
    let nearest = at_m - NEARER[0] - NEARER[1] * at_m;
    let is_hidden = |(x, y)| depth_m(depth.at(x, y)).is_some_and(|d| d < nearest);
    Some(around().any(|(x, y)| label(instance.at(x, y)).0 == id) || around().any(is_hidden))
}
