//! Motorcycles and bicycles, with their riders or parked.

use std::sync::Arc;

use glam::Vec3;
use schema::geometry::{Part, Surface};
use schema::models::{BaseType, Model};
use schema::{Tag, lights};

use crate::pieces::{ActorMesh, Joint, Piece};
use crate::solids::MeshBuilder;
use crate::walker::{SKIN, TOPS, TROUSERS};
use crate::wheel;

/// A two-wheeler with its rider: one object, two tags.
pub(crate) fn two_wheeler(model: &Model, size: Vec3, variant: u32) -> ActorMesh {
    machine(model, size, size.z, Some(variant))
}

/// One that nobody sits on. `ridden` is the same with its rider, by whose height its parts are where they are.
pub(crate) fn parked(model: &Model, ridden: &Model, size: Vec3) -> ActorMesh {
    machine(ridden, size, size.z * (ridden.size_m[2] / model.size_m[2]) as f32, None)
}

/// A two-wheeler in a box; parts are at shares of the height that it has with a rider. `rider_variant` is that of who rides.
fn machine(model: &Model, size: Vec3, ridden_m: f32, rider_variant: Option<u32>) -> ActorMesh {
    let bicycle = model.base == BaseType::Bicycle;
    let tag = if bicycle { Tag::Bicycle } else { Tag::Motorcycle };
    let (radius, wheelbase) = (model.wheel_radius_m as f32, model.wheelbase_m as f32);
    let (half_l, half_w) = (0.5 * size.x, 0.5 * size.y);
    // The wheels end where the box does, as far as the wheelbase lets them.
    let slack = (size.x - wheelbase - 2.0 * radius).max(0.0);
    let front = half_l - radius - 0.5 * slack;
    let rear = front - wheelbase;
    let mut b = MeshBuilder::new();
    let seat = if bicycle { 0.53 * ridden_m } else { 0.50 * ridden_m };
    let grip = Vec3::new(
        front - if bicycle { 0.14 } else { 0.24 },
        0.82 * half_w,
        if bicycle { 0.56 } else { 0.62 } * ridden_m,
    );
    if bicycle {
        bicycle_frame(&mut b, tag, [front, rear], radius, seat, grip);
    } else {
        motorcycle_frame(&mut b, tag, model, [front, rear], radius, seat, grip);
    }
    let hip = Vec3::new(rear + if bicycle { 0.28 } else { 0.33 } * wheelbase, 0.0, seat + 0.05);
    let foot = if bicycle {
        Vec3::new(rear + 0.42 * wheelbase, 0.10, radius - 0.10)
    } else {
        Vec3::new(rear + 0.48 * wheelbase, 0.17, 0.62 * radius)
    };
    if let Some(variant) = rider_variant {
        rider(&mut b, size, hip, grip, foot, !bicycle, variant);
    }
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
    let bounds_low = b_low(bicycle, radius);
    let bounds = Vec3::new(-half_l, -half_w, bounds_low);
    // Bicycles end with their wheels, motorcycles with lamps and guards; both fill the box in width and height.
    let (x0, x1) = if bicycle { (rear - 0.3 * radius, front + 0.06) } else { (-half_l, front + 0.2) };
    b.fit(Vec3::new(x0, bounds.y, bounds.z), Vec3::new(x1.min(half_l), half_w, size.z));
    let mut pieces = vec![Piece { mesh: Arc::new(b.finish()), joint: Joint::Fixed }];
    let (width, spokes) = if bicycle { (0.035, 8) } else { (0.12, 6) };
    let mesh = Arc::new(wheel::spoked(tag, radius, width, spokes));
    for (x, steered) in [(front, true), (rear, false)] {
        let joint = Joint::Wheel { at: Vec3::new(x, 0.0, radius), steered, right: false };
        pieces.push(Piece { mesh: Arc::clone(&mesh), joint });
    }
    ActorMesh { pieces }
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

/// Lowest point of the body without its wheels.
fn b_low(bicycle: bool, radius: f32) -> f32 {
    if bicycle { radius - 0.2 } else { 0.45 * radius }
}

fn bicycle_frame(b: &mut MeshBuilder, tag: Tag, [front, rear]: [f32; 2], radius: f32, seat: f32, grip: Vec3) {
    let paint = Part::new(tag, Surface::Paint, [0.5; 3]);
    let metal = Part::new(tag, Surface::Metal, [0.3; 3]);
    let dark = Part::new(tag, Surface::Rubber, [0.04; 3]);
    let wheelbase = front - rear;
    let crank = Vec3::new(rear + 0.42 * wheelbase, 0.0, radius - 0.03);
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
    b.bar(metal, crank - Vec3::Y * 0.1, crank + Vec3::Y * 0.1, [0.09, 0.09], 8);
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

/// A seated person: the hip on the saddle, hands at the grips, feet on the pedals or pegs.
fn rider(
    b: &mut MeshBuilder,
    size: Vec3,
    hip: Vec3,
    grip: Vec3,
    foot: Vec3,
    helmet_closed: bool,
    variant: u32,
) {
    let cloth = |rgb: [f32; 3]| Part::new(Tag::Rider, Surface::Cloth, rgb);
    let (jacket, trousers) =
        (cloth(TOPS[variant as usize % TOPS.len()]), cloth(TROUSERS[variant as usize / 3 % TROUSERS.len()]));
    let skin = cloth(SKIN[variant as usize / 7 % SKIN.len()]);
    let head_r = 0.125;
    let neck = Vec3::new(hip.x + 0.55 * (grip.x - hip.x) - 0.02, 0.0, size.z - 2.0 * head_r - 0.02);
    let chest = hip.lerp(neck, 0.75);
    b.bar(jacket, hip, chest, [0.15, 0.17], 8);
    b.bar(jacket, chest, neck, [0.17, 0.07], 8);
    let helmet: Part = Part::new(Tag::Rider, Surface::Plain, TOPS[(variant as usize + 3) % TOPS.len()]);
    b.bar(skin, neck - Vec3::Z * 0.03, neck + Vec3::Z * 0.08, [0.05; 2], 6);
    b.ellipsoid(
        if helmet_closed { helmet } else { skin },
        neck + Vec3::Z * (head_r + 0.01),
        Vec3::new(head_r, 0.105, head_r),
        6,
        8,
    );
    if !helmet_closed {
        b.ellipsoid(helmet, neck + Vec3::Z * (head_r + 0.06), Vec3::new(head_r + 0.01, 0.115, 0.085), 4, 8);
    }
    for side in [1.0, -1.0] {
        let mirror = Vec3::new(1.0, side, 1.0);
        let shoulder = chest.lerp(neck, 0.4) + Vec3::Y * side * 0.17;
        let hand = grip * mirror;
        let elbow = shoulder.lerp(hand, 0.5) + Vec3::new(-0.03, side * 0.05, -0.08);
        b.bar(jacket, shoulder, elbow, [0.06, 0.05], 6);
        b.bar(jacket, elbow, hand, [0.048, 0.038], 6);
        let hip_side = hip + Vec3::new(0.0, side * 0.1, 0.0);
        let sole = foot * mirror;
        let knee = hip_side.lerp(sole, 0.48) + Vec3::new(0.22, side * 0.05, 0.10);
        b.bar(trousers, hip_side, knee, [0.095, 0.065], 6);
        b.bar(trousers, knee, sole, [0.062, 0.045], 6);
        let shoe = Part::new(Tag::Rider, Surface::Rubber, [0.05; 3]);
        b.cuboid(shoe, sole + Vec3::new(-0.09, -0.045, -0.05), sole + Vec3::new(0.16, 0.045, 0.03));
    }
}
