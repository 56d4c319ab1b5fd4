//! Motorcycles and bicycles, with their riders or parked.

use std::sync::Arc;

use glam::Vec3;
use people::{Figure, Look, Seat};
use schema::geometry::{Part, Surface};
use schema::models::{self, BaseType, Model};
use schema::{Tag, lights};
use solids::{Detail, MeshBuilder};

use crate::bodies::{body, coarser, fitted};
use crate::pieces::{ActorMesh, Joint, Piece};
use crate::rig::{PEDAL_M, Pedals, Rider, Rig};
use crate::wheel;

/// A two-wheeler with its rider: one object, two tags.
pub(crate) fn two_wheeler(model: &Model, size: Vec3, variant: u32) -> ActorMesh {
    let name = format!("{}.parked", model.name);
    let alone = models::find_parked(&name).map_or(0.65, |(parked, _)| parked.size_m[2] / model.size_m[2]);
    let (mut pieces, rides) = machine(model, size, size.z * alone as f32, size.z);
    let bicycle = model.base == BaseType::Bicycle;
    let figure = Figure::new(Look::new(model, variant).riding(!bicycle), 1.72);
    let mut rider = Rider { figure, seat: rides.seat, pedals: rides.pedals };
    rider.figure = fitted(figure, |_| rides.seat, size.z);
    let coarser = coarser(&rider.figure, Tag::Rider, &pieces);
    pieces.extend(body(&rider.figure, Tag::Rider, Detail::Full));
    ActorMesh { pieces, coarser, rig: Some(Arc::new(Rig::Rides(rider))) }
}

/// One that nobody sits on. `ridden` is the same with its rider, by whose height its parts are where they are.
pub(crate) fn parked(model: &Model, ridden: &Model, size: Vec3) -> ActorMesh {
    let ridden_m = size.z * (ridden.size_m[2] / model.size_m[2]) as f32;
    ActorMesh::of(machine(ridden, size, size.z, ridden_m).0)
}

/// How somebody sits on a machine.
struct Rides {
    seat: Seat,
    pedals: Option<Pedals>,
}

/// Gear of a bicycle: turns of its crank for one of its wheels.
const GEAR: f32 = 0.42;
/// Length of a crank, metres.
const CRANK_M: f32 = 0.165;
/// Distance of a pedal's middle from the frame's plane, metres.
const PEDAL_ASIDE_M: f32 = 0.115;

/// A two-wheeler as high as it is alone; its parts are at shares of the height that it has with a rider.
fn machine(model: &Model, size: Vec3, high_m: f32, ridden_m: f32) -> (Vec<Piece>, Rides) {
    let bicycle = model.base == BaseType::Bicycle;
    let tag = if bicycle { Tag::Bicycle } else { Tag::Motorcycle };
    let (radius, wheelbase) = (model.wheel_radius_m as f32, model.wheelbase_m as f32);
    let (half_l, half_w) = (0.5 * size.x, 0.5 * size.y);
    // The front wheel ends where the box does; a motorcycle's mudguard reaches farther back than the rear one.
    let slack = (size.x - wheelbase - 2.0 * radius).max(0.0);
    let front = half_l - radius - if bicycle { 0.5 * slack } else { 0.0 };
    let rear = front - wheelbase;
    let mut b = MeshBuilder::new();
    let seat = seat_m(model) * ridden_m / model.size_m[2] as f32;
    // The highest part of a machine is its fairing or the grips.
    let grip_z = high_m - if model.name == "motorcycle.sport" { 0.12 } else { 0.02 };
    let grip = Vec3::new(front - if bicycle { 0.14 } else { 0.24 }, half_w - 0.02, grip_z);
    if bicycle {
        bicycle_frame(&mut b, tag, [front, rear], radius, seat, grip);
    } else {
        motorcycle_frame(&mut b, tag, model, [front, rear], radius, seat, grip);
    }
    let hip = Vec3::new(rear + if bicycle { 0.28 } else { 0.30 } * wheelbase, 0.0, seat + 0.10);
    // Lamps mark the ends of the box.
    let lamp = |bits: u32, rgb: [f32; 3]| Part::new(tag, Surface::Lamp(bits), rgb);
    let head_z = if bicycle { grip.z - 0.12 } else { grip.z - 0.10 };
    b.cuboid(
        lamp(lights::LOW_BEAM | lights::HIGH_BEAM | lights::POSITION, [0.85; 3]),
        Vec3::new(front - 0.08, -0.07, head_z - 0.06),
        Vec3::new(front + 0.06, 0.07, head_z + 0.08),
    );
    let tail_x = if bicycle { hip.x - 0.20 } else { -half_l + 0.12 };
    let tail_z = if bicycle { seat - 0.12 } else { seat - 0.06 };
    b.cuboid(
        lamp(lights::POSITION | lights::BRAKE, [0.55, 0.03, 0.03]),
        Vec3::new(tail_x - 0.03, -0.05, tail_z),
        Vec3::new(tail_x + 0.06, 0.05, tail_z + 0.06),
    );
    if !bicycle {
        blinkers_and_guards(&mut b, tag, half_l, [front, rear], radius, [tail_x, tail_z, head_z, seat]);
    }
    // Bicycles end with their wheels, motorcycles with lamps and guards; both fill the box in width and height.
    let (x0, x1) = if bicycle { (rear - 0.3 * radius, front + 0.06) } else { (-half_l, front + 0.2) };
    let low = if bicycle { radius - 0.052 } else { 0.45 * radius };
    let fit = b.fit(Vec3::new(x0, -half_w, low), Vec3::new(x1.min(half_l), half_w, high_m));
    let mut pieces = vec![Piece { mesh: Arc::new(b.finish()), joint: Joint::Fixed }];
    let (width, spokes) = if bicycle { (0.035, 8) } else { (0.12, 6) };
    let mesh = Arc::new(wheel::spoked(tag, radius, width, spokes));
    for (x, steered) in [(front, true), (rear, false)] {
        let joint = Joint::Wheel { at: Vec3::new(x, 0.0, radius), steered, right: false };
        pieces.push(Piece { mesh: Arc::clone(&mesh), joint });
    }
    let crank = fit.apply(crank([front, rear], radius));
    let pedals = bicycle.then_some(Pedals { crank, arm_m: CRANK_M, aside_m: PEDAL_ASIDE_M, gear: GEAR });
    pieces.extend(pedals.iter().flat_map(|pedals| cranks(tag, pedals)));
    let peg = fit.apply(Vec3::new(rear + 0.48 * wheelbase, 0.17, 0.52 * radius));
    (pieces, Rides { seat: seat_on(model, fit.apply(hip), fit.apply(grip), peg), pedals })
}

/// Height of the saddle, metres.
fn seat_m(model: &Model) -> f32 {
    match model.name {
        "motorcycle.cruiser" => 0.71,
        "motorcycle.sport" => 0.80,
        "motorcycle.scooter" => 0.76,
        _ => 0.93,
    }
}

/// How somebody sits there: hips on the saddle, hands at the grips, feet on the pegs.
fn seat_on(model: &Model, hips: Vec3, grip: Vec3, peg: Vec3) -> Seat {
    let lean_rad = match model.name {
        "bicycle.road" => 0.72,
        "bicycle.city" => 0.24,
        "motorcycle.sport" => 0.52,
        "motorcycle.cruiser" => 0.10,
        _ => 0.06,
    };
    let mirror = Vec3::new(1.0, -1.0, 1.0);
    let hand = Vec3::new(grip.x - 0.05, grip.y - 0.05, grip.z + 0.025);
    let scooter = model.name == "motorcycle.scooter";
    let ball = if scooter { peg + Vec3::new(0.16, -0.04, 0.10) } else { peg + Vec3::new(0.04, 0.0, 0.02) };
    Seat {
        hips,
        lean_rad,
        hands: [hand, hand * mirror],
        balls: [ball, ball * mirror],
        heels_rad: if model.base == BaseType::Bicycle { 0.18 } else { 0.05 },
        knees: Vec3::new(1.0, if scooter { 0.05 } else { 0.16 }, 0.6),
        elbows: Vec3::new(-0.7, 0.35, -0.8),
    }
}

/// Where a bicycle's crank turns.
fn crank([front, rear]: [f32; 2], radius: f32) -> Vec3 {
    Vec3::new(rear + 0.42 * (front - rear), 0.0, radius - 0.03)
}

/// The crank with its chain wheel, and the pedals on it.
fn cranks(tag: Tag, pedals: &Pedals) -> [Piece; 3] {
    let metal = Part::new(tag, Surface::Metal, [0.3; 3]);
    let dark = Part::new(tag, Surface::Rubber, [0.04; 3]);
    let Pedals { crank: at, gear, .. } = *pedals;
    let mut b = MeshBuilder::new();
    b.bar(metal, Vec3::Y * -0.045, Vec3::Y * -0.040, [0.09; 2], 14);
    b.bar(metal, Vec3::Y * -0.06, Vec3::Y * 0.06, [0.018; 2], 8);
    for side in [1.0, -1.0] {
        let root = Vec3::Y * side * 0.06;
        b.bar(metal, root, root + pedals.arm(side) * Vec3::new(1.0, 0.0, 1.0), [0.014, 0.010], 6);
    }
    let mut step = MeshBuilder::new();
    step.cuboid(dark, Vec3::new(-0.045, -0.045, -PEDAL_M), Vec3::new(0.045, 0.045, PEDAL_M));
    let step = Arc::new(step.finish());
    let pedal = |side: f32| Joint::Pedal { at, arm: pedals.arm(side), gear };
    [
        Piece { mesh: Arc::new(b.finish()), joint: Joint::Crank { at, gear } },
        Piece { mesh: Arc::clone(&step), joint: pedal(1.0) },
        Piece { mesh: step, joint: pedal(-1.0) },
    ]
}

/// What a motorcycle has at its ends besides: blinkers and mudguards.
fn blinkers_and_guards(
    b: &mut MeshBuilder,
    tag: Tag,
    half_l: f32,
    [front, rear]: [f32; 2],
    radius: f32,
    [tail_x, tail_z, head_z, seat]: [f32; 4],
) {
    for (bits, y) in [(lights::BLINK_LEFT, 0.13), (lights::BLINK_RIGHT, -0.13)] {
        let amber = Part::new(tag, Surface::Lamp(bits), [0.75, 0.35, 0.05]);
        b.cuboid(
            amber,
            Vec3::new(tail_x - 0.02, y - 0.03, tail_z),
            Vec3::new(tail_x + 0.03, y + 0.03, tail_z + 0.05),
        );
        b.cuboid(
            amber,
            Vec3::new(front - 0.1, y - 0.03, head_z),
            Vec3::new(front - 0.02, y + 0.03, head_z + 0.05),
        );
    }
    let guard = Part::new(tag, Surface::Plain, [0.05; 3]);
    b.tapered(guard, Vec3::new(-half_l, -0.07, radius + 0.02), Vec3::new(rear, 0.07, seat - 0.1), 0.4, 0.9);
    b.cuboid(
        guard,
        Vec3::new(front - 0.16, -0.06, 2.0 * radius + 0.01),
        Vec3::new(front + 0.2, 0.06, 2.0 * radius + 0.05),
    );
}

fn bicycle_frame(b: &mut MeshBuilder, tag: Tag, [front, rear]: [f32; 2], radius: f32, seat: f32, grip: Vec3) {
    let paint = Part::new(tag, Surface::Paint, [0.5; 3]);
    let metal = Part::new(tag, Surface::Metal, [0.3; 3]);
    let dark = Part::new(tag, Surface::Rubber, [0.04; 3]);
    let wheelbase = front - rear;
    let crank = crank([front, rear], radius);
    let saddle = Vec3::new(rear + 0.24 * wheelbase, 0.0, seat);
    let head = Vec3::new(grip.x - 0.06, 0.0, grip.z - 0.16);
    let fork = Vec3::new(front, 0.0, radius);
    let hub = Vec3::new(rear, 0.0, radius);
    for (from, to, r) in [(crank, head, 0.022), (saddle - Vec3::Z * 0.1, head, 0.02), (crank, saddle, 0.018)]
    {
        b.bar(paint, from, to, [r; 2], 6);
    }
    for y in [-0.05, 0.05] {
        let side = Vec3::Y * y;
        b.bar(paint, hub + side, crank + side * 0.4, [0.012; 2], 4);
        b.bar(paint, hub + side, saddle - Vec3::Z * 0.12, [0.011; 2], 4);
        b.bar(metal, fork + side, head + side * 0.4, [0.014; 2], 4);
    }
    let bar_middle = Vec3::new(grip.x - 0.02, 0.0, grip.z);
    b.bar(metal, head, bar_middle, [0.016; 2], 5);
    for y in [-grip.y, grip.y] {
        b.bar(dark, bar_middle, Vec3::new(grip.x - 0.05, y, grip.z), [0.014, 0.018], 5);
    }
    b.tapered(dark, saddle + Vec3::new(-0.13, -0.08, -0.03), saddle + Vec3::new(0.14, 0.08, 0.03), 1.0, 0.8);
}

fn motorcycle_frame(
    b: &mut MeshBuilder,
    tag: Tag,
    model: &Model,
    [front, rear]: [f32; 2],
    radius: f32,
    seat: f32,
    grip: Vec3,
) {
    let paint = Part::new(tag, Surface::Paint, [0.5; 3]);
    let metal = Part::new(tag, Surface::Metal, [0.25; 3]);
    let dark = Part::new(tag, Surface::Rubber, [0.04; 3]);
    let wheelbase = front - rear;
    let at = |share: f32, z: f32| Vec3::new(rear + share * wheelbase, 0.0, z);
    let head = Vec3::new(grip.x, 0.0, grip.z - 0.06);
    for y in [-0.09, 0.09] {
        let side = Vec3::Y * y;
        b.bar(metal, Vec3::new(front, y, radius), head + side * 0.8, [0.025; 2], 5);
        b.bar(metal, Vec3::new(rear, y, radius), at(0.38, radius + 0.05) + side, [0.03; 2], 5);
    }
    let at: &dyn Fn(f32, f32) -> Vec3 = &at;
    if model.name == "motorcycle.scooter" {
        scooter_body(b, paint, at, radius, seat, grip);
    } else {
        engine_and_tank(b, [paint, metal], model, at, front, radius, seat, grip);
    }
    b.tapered(
        dark,
        at(0.02, seat - 0.1) - Vec3::Y * 0.14,
        at(0.48, seat + 0.02) + Vec3::Y * 0.14,
        0.95,
        0.85,
    );
    for y in [-grip.y, grip.y] {
        b.bar(dark, head, Vec3::new(grip.x - 0.04, y, grip.z), [0.018; 2], 5);
    }
    b.cuboid(
        metal,
        Vec3::new(rear + 0.48 * wheelbase - 0.05, -0.2, 0.45 * radius),
        Vec3::new(rear + 0.48 * wheelbase + 0.05, 0.2, 0.52 * radius),
    );
}

/// The foot board of a scooter, its seat's box and its shield.
fn scooter_body(
    b: &mut MeshBuilder,
    paint: Part,
    at: &dyn Fn(f32, f32) -> Vec3,
    radius: f32,
    seat: f32,
    grip: Vec3,
) {
    b.cuboid(
        paint,
        at(0.22, radius) + Vec3::new(-0.25, -0.16, 0.12),
        at(0.45, seat - 0.05) + Vec3::new(0.0, 0.16, 0.0),
    );
    b.cuboid(
        paint,
        at(0.45, radius - 0.03) + Vec3::new(-0.02, -0.17, 0.0),
        at(0.74, radius + 0.05) + Vec3::new(0.0, 0.17, 0.0),
    );
    b.tapered(
        paint,
        at(0.74, radius) + Vec3::new(-0.02, -0.2, 0.0),
        Vec3::new(grip.x + 0.05, 0.2, grip.z - 0.05),
        0.5,
        0.8,
    );
}

/// Engine, tank, fairing and exhaust of a motorcycle.
#[allow(clippy::too_many_arguments)] // One frame's facts, used once.
fn engine_and_tank(
    b: &mut MeshBuilder,
    [paint, metal]: [Part; 2],
    model: &Model,
    at: &dyn Fn(f32, f32) -> Vec3,
    front: f32,
    radius: f32,
    seat: f32,
    grip: Vec3,
) {
    b.tapered(
        metal,
        at(0.36, 0.6 * radius) - Vec3::Y * 0.15,
        at(0.66, seat - 0.24) + Vec3::Y * 0.15,
        0.9,
        0.9,
    );
    let tank = [at(0.45, seat - 0.22) - Vec3::Y * 0.15, Vec3::new(grip.x - 0.06, 0.15, seat + 0.14)];
    b.tapered(paint, tank[0], tank[1], 0.75, 0.6);
    if model.name == "motorcycle.sport" {
        b.tapered(
            paint,
            Vec3::new(grip.x - 0.02, -0.2, radius + 0.08),
            Vec3::new(front + 0.05, 0.2, grip.z + 0.12),
            0.45,
            0.7,
        );
    }
    b.bar(
        metal,
        at(0.55, 0.6 * radius) - Vec3::Y * 0.17,
        at(-0.05, 0.9 * radius) - Vec3::Y * 0.17,
        [0.04, 0.055],
        6,
    );
}
