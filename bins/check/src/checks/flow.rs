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
/// Tread turns as fast as the body drives, and tread nearer to the camera than its axle is seen to go
/// somewhat faster.
const WHEELS: f64 = 1.25;
/// Bodies of vehicles may be off by this, pixels, more than by what all may: they lean on their springs.
const BODY_PX: f64 = 1.0;
/// Wheels reach up to this above the ground, m: of cars and two-wheelers, and of what is higher or longer
/// than these.
const WHEELS_UP_TO_M: [f64; 2] = [0.85, 1.25];
/// Height and length beyond which wheels are those of lorries and buses, m.
const HEAVY_M: [f64; 2] = [2.3, 6.5];
/// Flow beyond this (a picture is 2) is cut off and not judged.
const CUT: f64 = 1.95;
/// Objects with fewer pixels are not judged.
const FEW: u64 = 30;
/// What was this near to the camera is not judged, m.
const NEAR_M: f64 = 0.3;
/// What hides an object is nearer by this, m, and by this share.
const NEARER: [f64; 2] = [0.05, 0.01];

/// Objects of wires with air between them.
const WIRES: [&str; 2] = ["prop.wire", "pole.wires"];

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
    let mut judges = Judges {
        scene,
        now,
        before,
        frame,
        flow: Judged::new(),
        wheels: Judged::new(),
        found: Judged::new(),
    };
    for (k, (pixel, depth)) in instance.pixels().iter().zip(depth.pixels()).enumerate() {
        let (id, tag) = label(*pixel);
        let flow = [f64::from(dx[k]), f64::from(dy[k])];
        if flow[0].abs().max(flow[1].abs()) <= CUT && id != own {
            judges.pixel([k % width, k / width], (id, tag), depth_m(*depth), flow);
        }
    }
    judges.report(ledger);
}

/// What the pixels of a camera's flow say of the objects that they show.
struct Judges<'a, 's> {
    scene: &'a Scene,
    now: &'a Sight<'s>,
    before: &'a Sight<'s>,
    frame: usize,
    flow: Judged,
    wheels: Judged,
    found: Judged,
}

impl Judges<'_, '_> {
    /// Judges a pixel. `flow` is its own, of a picture that is 2 units wide and high.
    fn pixel(&mut self, [column, row]: [usize; 2], (id, tag): (u16, u8), depth: Option<f64>, flow: [f64; 2]) {
        let Self { scene, now, before, frame, .. } = *self;
        let (width, height) = now.camera.size();
        let (x, y) = (column as f64 + 0.5, row as f64 + 0.5);
        let moved = [0.5 * flow[0] * width as f64, -0.5 * flow[1] * height as f64];
        let Some(point) = point_of(now, [x, y], depth, id) else { return };
        let Some(was) = point_before_or_sky(scene, (id, depth.is_none()), frame, point, now, before) else {
            return;
        };
        let was_m = now.camera.optics.depth_of(was);
        if was_m < NEAR_M {
            return;
        }
        let Some(was_px) = now.camera.optics.project(was) else { return };
        let wanted = [x - was_px[0], y - was_px[1]];
        // Beyond the cut the file says less than there was.
        let is_cut =
            wanted[0].abs() > 0.48 * CUT * width as f64 || wanted[1].abs() > 0.48 * CUT * height as f64;
        if !moves_its_limbs(tag) && !is_cut {
            let off = libm::hypot(moved[0] - wanted[0], moved[1] - wanted[1]);
            let allowed = FLOW[0] + FLOW[1] * libm::hypot(wanted[0], wanted[1]);
            match place_on(scene, id, frame, now.world_from_optical.outward(point)) {
                MotionKind::Fixed => judge(&mut self.flow, id, off <= allowed),
                MotionKind::Body => judge(&mut self.flow, id, off <= allowed + BODY_PX),
                MotionKind::AmongWheels => {
                    let turned = wheels_px(now, before, point, was, was_px);
                    judge(&mut self.wheels, id, off <= allowed + turned);
                }
                MotionKind::Moving => {}
            }
        }
        if id != 0
            && now.inner(column, row).is_some()
            && let Some(holds) = was_there(before, [x - moved[0], y - moved[1]], id, was_m)
        {
            judge(&mut self.found, id, holds);
        }
    }

    /// Says of which objects too many pixels are off.
    fn report(self, ledger: &mut Ledger) {
        let Self { scene, now, frame, flow, wheels, found, .. } = self;
        let name = &now.camera.name;
        for (rule, what, judged) in
            [(Rule::Flow, "", flow), (Rule::Flow, " about its wheels", wheels), (Rule::FlowIds, "", found)]
        {
            for (id, [all, off]) in judged.into_iter().filter(|(_, [all, _])| *all >= FEW) {
                let model = scene.actors.get(&id).map_or("sky", |actor| actor.model.as_str());
                // Fences are seen through; a wire is thinner than a pixel, and the next one shows another.
                let allowed = match rule {
                    Rule::Flow => all / 10,
                    _ if WIRES.contains(&model) => all * 4 / 5,
                    _ => all / 2,
                };
                ledger.expect(rule, off <= allowed, || {
                    format!("frame {frame}: {name}: {off} of {all} pixels of object {id} ({model}){what}")
                });
            }
        }
    }
}

/// On what part of an object a point is, by how that moves.
enum MotionKind {
    /// On something fixed, or the sky.
    Fixed,
    /// On the body of a vehicle: it moves as its pose says.
    Body,
    /// As low as wheels are, which turn.
    AmongWheels,
    /// On a vehicle with an open door, which may be moving.
    Moving,
}

fn place_on(scene: &Scene, id: u16, frame: usize, in_world: V3) -> MotionKind {
    let frame = frame as i64;
    let (Some(actor), Some(pose)) = (scene.actors.get(&id), scene.pose(id, frame)) else {
        return MotionKind::Fixed;
    };
    if actor.fixed {
        return MotionKind::Fixed;
    }
    let is_open = |frame| scene.state(id, frame).is_some_and(|state| state.open_door);
    if is_open(frame) || is_open(frame - 1) {
        return MotionKind::Moving;
    }
    let is_heavy = actor.size_m[2] > HEAVY_M[0] || actor.size_m[0] > HEAVY_M[1];
    let up_to_m = WHEELS_UP_TO_M[usize::from(is_heavy)];
    if pose.inward(in_world)[2] < up_to_m { MotionKind::AmongWheels } else { MotionKind::Body }
}

/// How far a wheel's rim may be from where its body takes it, pixels: as far as the body has come, seen from
/// here. It may go any way, and lenses show ways of the same length differently: the longest counts.
fn wheels_px(now: &Sight<'_>, before: &Sight<'_>, point: V3, was: V3, [x, y]: [f64; 2]) -> f64 {
    let way_m = norm(sub(now.world_from_optical.outward(point), before.world_from_optical.outward(was)));
    let ways = (0..3).filter_map(|axis| {
        let mut to = was;
        to[axis] += way_m;
        now.camera.optics.project(to)
    });
    WHEELS * ways.map(|[to_x, to_y]| libm::hypot(to_x - x, to_y - y)).fold(0.0, f64::max)
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
    match depth {
        None if id == 0 => Some(ray),
        depth => depth.map(|depth| ray.map(|part| part * depth)),
    }
}

/// A point of the optical frame a frame before, in the optical frame of then.
fn point_before_or_sky(
    scene: &Scene,
    (id, is_endless): (u16, bool),
    frame: usize,
    point: V3,
    now: &Sight<'_>,
    before: &Sight<'_>,
) -> Option<V3> {
    if id == 0 && is_endless {
        return Some(before.world_from_optical.turn_back(now.world_from_optical.turn(point)));
    }
    if id == 0 {
        // The horizon stands still.
        return Some(before.world_from_optical.inward(now.world_from_optical.outward(point)));
    }
    let was = point_before(scene, id, frame, now.world_from_optical.outward(point))?;
    Some(before.world_from_optical.inward(was))
}

/// Whether an object was at a place of the previous picture, or something nearer; none where that cannot be
/// told.
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
