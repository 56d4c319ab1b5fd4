//! Motorcycles and bicycles, with their riders or parked.

use std::f32::consts::TAU;
use std::sync::Arc;

use crate::people::{Appearance, Figure, Seat};
use crate::solids::{Detail, MeshBuilder};
use catalogue::{BaseType, Frame, Model, Special, TwoWheelerBody};
use glam::Vec3;
use schema::geometry::{MeshPart, Surface};
use schema::{Tag, lights};

use crate::actors::bodies::{LEVELS, body, fitted};
use crate::actors::motorcycle::{self, Places};
use crate::actors::pieces::{ActorMesh, COARSE_FROM_M, Coarser, Joint, Piece};
use crate::actors::pod::{mudguard, rounded, tube};
use crate::actors::rig::{PEDAL_M, Pedals, Rider, Rig};
use crate::actors::wheel;

/// A two-wheeler with its rider: one object, two tags.
pub(crate) fn two_wheeler(model: &Model, built: &TwoWheelerBody, size: Vec3, variant: u32) -> ActorMesh {
    let alone = built.parked_height_m / model.size_m[2];
    let machine = |detail| machine(model, built, size, size.z * alone as f32, size.z, detail);
    let (mut pieces, rides) = machine(Detail::Full);
    let bicycle = model.base == BaseType::Bicycle;
    let mut look = Appearance::new(model, variant).riding(!bicycle);
    if model.special == Special::Emergency {
        look = Appearance { shoe_rgb: [0.02; 3], extra_rgb: [0.7; 3], ..look.in_uniform() };
    }
    let figure = Figure::new(look, 1.72);
    let on_z = rides.stands_z.unwrap_or(rides.seat.hips.z);
    let figure = fitted(figure, |figure| rides.seat_of(figure), on_z, size.z);
    let rider = Rider { figure, seat: rides.seat_of(&figure), pedals: rides.pedals };
    // People lose detail before machines do.
    let [(half_m, _), (coarse_m, _)] = LEVELS;
    let levels = [
        (half_m, Detail::Half, Detail::Full),
        (coarse_m, Detail::Coarse, Detail::Half),
        (COARSE_FROM_M, Detail::Coarse, Detail::Coarse),
    ];
    let coarser = levels.map(|(from_m, of_body, of_machine)| {
        let limbs = body(&rider.figure, Tag::Rider, of_body);
        let machine = if of_machine == Detail::Full { pieces.clone() } else { machine(of_machine).0 };
        Coarser { from_m, pieces: machine.into_iter().chain(limbs).collect() }
    });
    pieces.extend(body(&rider.figure, Tag::Rider, Detail::Full));
    ActorMesh { pieces, coarser: coarser.into(), rig: Some(Arc::new(Rig::Rides(rider))), cabin: None }
}

/// One that nobody sits on. `ridden` is the same with its rider, by whose height its parts are where they
/// are.
pub(crate) fn parked(model: &Model, ridden: &Model, built: &TwoWheelerBody, size: Vec3) -> ActorMesh {
    let ridden_m = size.z * (ridden.size_m[2] / model.size_m[2]) as f32;
    ActorMesh::in_levels(|detail| machine(ridden, built, size, size.z, ridden_m, detail).0)
}

/// How somebody sits on a machine.
struct Rides {
    seat: Seat,
    pedals: Option<Pedals>,
    /// Height of the board that they stand on, metres.
    stands_z: Option<f32>,
}

impl Rides {
    /// The same of somebody who stands: legs all but straight.
    fn seat_of(&self, figure: &Figure) -> Seat {
        let hips_z = self.stands_z.map_or(self.seat.hips.z, |z| z + 0.975 * figure.leg_m());
        Seat { hips: self.seat.hips.with_z(hips_z), ..self.seat }
    }
}

/// Gear of a bicycle: turns of its crank for one of its wheels.
const GEAR: f32 = 0.42;
/// Length of a crank, metres.
const CRANK_M: f32 = 0.165;
/// Distance of a pedal's middle from the frame's plane, metres.
const PEDAL_ASIDE_M: f32 = 0.115;

/// How far a bicycle's mudguards are above the tyres, metres, and where the rear one ends, in turns from
/// ahead.
const GUARD_M: f32 = 0.015;
const GUARD_END: f32 = 0.42;

/// A two-wheeler as high as it is alone; its parts are at shares of the height that it has with a rider.
fn machine(
    model: &Model,
    built: &TwoWheelerBody,
    size: Vec3,
    high_m: f32,
    ridden_m: f32,
    detail: Detail,
) -> (Vec<Piece>, Rides) {
    let bicycle = model.base == BaseType::Bicycle;
    let tag = if bicycle { Tag::Bicycle } else { Tag::Motorcycle };
    let (radius, wheelbase) = (model.wheel_radius_m as f32, model.wheelbase_m as f32);
    let (half_l, half_w) = (0.5 * size.x, 0.5 * size.y);
    // The front wheel ends where the box does; a motorcycle's mudguard reaches farther back than the rear
    // one.
    let slack = (size.x - wheelbase - 2.0 * radius).max(0.0);
    let front = half_l - radius - if bicycle { 0.5 * slack } else { 0.0 };
    let rear = front - wheelbase;
    if built.frame == Frame::KickScooter {
        return kick(size, [front, rear], radius, high_m, detail);
    }
    // The rider of a cargo bicycle sits behind a steering head of its own.
    let cargo = built.frame == Frame::CargoBicycle;
    let head = if cargo { rear + 1.00 } else { front };
    let mut b = MeshBuilder::new();
    let seat = built.saddle_m * ridden_m / model.size_m[2] as f32;
    // The highest part of a machine is its fairing or the grips.
    let grip_z = high_m - built.grips_below_top_m;
    let grip = Vec3::new(head - built.grips_behind_head_m, half_w - 0.02, grip_z);
    let hip = Vec3::new(rear + if bicycle { 0.28 } else { 0.30 } * (head - rear), 0.0, seat + 0.10);
    if bicycle {
        bicycle_frame(&mut b, tag, [head, rear], front, radius, seat, grip, detail);
        if cargo {
            cargo_box(&mut b, tag, [front, head], radius, detail);
        }
        bicycle_lamps(&mut b, tag, [front, rear], radius);
    } else {
        let places = Places { front, rear, radius, seat, grip, back: -half_l, top: high_m, wide: size.y };
        motorcycle::body(&mut b, built.frame, &places, detail);
    }
    // Bicycles end with their wheels, motorcycles with lamps and guards; both fill the box in width and
    // height.
    let (x0, x1) = if bicycle {
        (rear + (radius + GUARD_M + 0.022) * frames::math::f32::cos(TAU * GUARD_END), front + 0.06)
    } else {
        (-half_l, front + 0.2)
    };
    let low = if bicycle { radius - 0.052 } else { 0.45 * radius };
    let fit = b.fit(Vec3::new(x0, -half_w, low), Vec3::new(x1.min(half_l), half_w, high_m));
    let mut pieces = vec![Piece { mesh: Arc::new(b.finish()), joint: Joint::Fixed }];
    let (width, spokes) = if bicycle { (0.035, 16) } else { (0.12, 5) };
    let mesh = Arc::new(wheel::spoked(tag, radius, width, spokes, detail));
    for (x, steered) in [(front, true), (rear, false)] {
        let joint = Joint::Wheel { at: Vec3::new(x, 0.0, radius), steered, right: false };
        pieces.push(Piece { mesh: Arc::clone(&mesh), joint });
    }
    let crank = fit.apply(crank([head, rear], radius));
    let pedals = bicycle.then_some(Pedals { crank, arm_m: CRANK_M, aside_m: PEDAL_ASIDE_M, gear: GEAR });
    pieces.extend(pedals.iter().flat_map(|pedals| cranks(tag, pedals)));
    let peg = fit.apply(Vec3::new(rear + 0.48 * wheelbase, 0.17, 0.52 * radius));
    (
        pieces,
        Rides { seat: seat_on(bicycle, built, fit.apply(hip), fit.apply(grip), peg), pedals, stands_z: None },
    )
}

/// How somebody sits there: hips on the saddle, hands at the grips, feet on the pegs.
fn seat_on(bicycle: bool, built: &TwoWheelerBody, hips: Vec3, grip: Vec3, peg: Vec3) -> Seat {
    let mirror = Vec3::new(1.0, -1.0, 1.0);
    let hand = Vec3::new(grip.x - 0.05, grip.y - 0.05, grip.z + 0.025);
    let scooter = built.frame.is_scooter();
    let ball = if scooter { peg + Vec3::new(0.16, -0.04, 0.10) } else { peg + Vec3::new(0.04, 0.0, 0.02) };
    Seat {
        hips,
        lean_rad: built.lean_rad,
        hands: [hand, hand * mirror],
        balls: [ball, ball * mirror],
        heels_rad: if bicycle { 0.18 } else { 0.05 },
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
    let metal = MeshPart::new(tag, Surface::Metal, [0.3; 3]);
    let dark = MeshPart::new(tag, Surface::Rubber, [0.04; 3]);
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

/// A head lamp above the front mudguard and a tail lamp on the rear one.
fn bicycle_lamps(b: &mut MeshBuilder, tag: Tag, [front, rear]: [f32; 2], radius: f32) {
    let lamp = |bits: u32, rgb: [f32; 3]| MeshPart::new(tag, Surface::Lamp(bits), rgb);
    let white = lamp(lights::LOW_BEAM | lights::HIGH_BEAM | lights::POSITION, [0.85; 3]);
    let at = Vec3::new(front + 0.04, 0.0, 2.0 * radius + 0.085);
    tube(b, white, &[(at - Vec3::X * 0.07, 0.015), (at, 0.036), (at + Vec3::X * 0.02, 0.03)], 8);
    let metal = MeshPart::new(tag, Surface::Metal, [0.3; 3]);
    b.bar(metal, at - Vec3::X * 0.05, at - Vec3::new(0.10, 0.0, 0.07), [0.008; 2], 4);
    let red = lamp(lights::POSITION | lights::BRAKE, [0.55, 0.03, 0.03]);
    let (s, c) = frames::math::f32::sin_cos(TAU * 0.365);
    let tail = Vec3::new(rear, 0.0, radius) + Vec3::new(c, 0.0, s) * (radius + GUARD_M + 0.025);
    b.tapered(red, tail - Vec3::new(0.02, 0.022, 0.03), tail + Vec3::new(0.02, 0.022, 0.03), 0.8, 0.8);
    let below = tail - Vec3::new(0.012, 0.0, 0.075);
    let reflector = MeshPart::new(tag, Surface::Reflector, [0.45, 0.02, 0.02]);
    b.cuboid(reflector, below - Vec3::new(0.012, 0.03, 0.022), below + Vec3::new(0.012, 0.03, 0.022));
}

#[allow(clippy::too_many_arguments, reason = "each is a place of the frame")]
fn bicycle_frame(
    b: &mut MeshBuilder,
    tag: Tag,
    [front, rear]: [f32; 2],
    axle: f32,
    radius: f32,
    seat: f32,
    grip: Vec3,
    detail: Detail,
) {
    let paint = MeshPart::new(tag, Surface::Paint, [0.5; 3]);
    let metal = MeshPart::new(tag, Surface::Metal, [0.3; 3]);
    let dark = MeshPart::new(tag, Surface::Rubber, [0.04; 3]);
    let full = detail == Detail::Full;
    let sides = if full { 8 } else { 4 };
    let wheelbase = front - rear;
    let crank = crank([front, rear], radius);
    let saddle = Vec3::new(rear + 0.24 * wheelbase, 0.0, seat);
    let head = Vec3::new(grip.x - 0.06, 0.0, grip.z - 0.16);
    let low = head - Vec3::new(-0.03, 0.0, 0.12);
    let fork = Vec3::new(axle, 0.0, radius);
    let reaches_far = axle > front + 0.1;
    let hub = Vec3::new(rear, 0.0, radius);
    let cluster = crank + 0.86 * (saddle - crank);
    tube(b, paint, &[(low, 0.024), (head, 0.022)], sides);
    tube(b, paint, &[(crank, 0.022), (low, 0.024)], sides);
    tube(b, paint, &[(cluster, 0.018), (head - Vec3::Z * 0.03, 0.019)], sides);
    tube(b, paint, &[(crank, 0.020), (cluster, 0.018)], sides);
    tube(b, metal, &[(cluster, 0.014), (saddle, 0.014)], sides);
    for y in [-0.05, 0.05] {
        let side = Vec3::Y * y;
        tube(b, paint, &[(hub + side, 0.010), (crank + side * 0.5, 0.012)], sides);
        tube(b, paint, &[(hub + side, 0.008), (cluster + side * 0.3, 0.010)], sides);
        // A fork bends forward at its foot.
        let knee = low + 0.7 * (fork - low) - Vec3::X * 0.02;
        if !reaches_far {
            tube(b, paint, &[(fork + side, 0.010), (knee + side, 0.014), (low + side * 0.7, 0.016)], sides);
        }
        let bend = Vec3::new(grip.x, 0.55 * grip.y * y.signum(), grip.z);
        let end = Vec3::new(grip.x - 0.08, (grip.y + 0.016) * y.signum(), grip.z - 0.006);
        tube(b, metal, &[(head + Vec3::Z * 0.12, 0.013), (bend, 0.012)], sides);
        tube(b, dark, &[(bend, 0.014), (end, 0.017)], sides);
    }
    tube(b, metal, &[(head, 0.017), (head + Vec3::Z * 0.13, 0.015)], sides);
    let around = if full { 10 } else { 5 };
    b.ellipsoid(dark, saddle + Vec3::new(-0.05, 0.0, 0.0), Vec3::new(0.09, 0.075, 0.030), 4, around);
    b.ellipsoid(dark, saddle + Vec3::new(0.05, 0.0, 0.004), Vec3::new(0.10, 0.035, 0.024), 4, around);
    let steps = match detail {
        Detail::Full => 9,
        Detail::Half => 4,
        Detail::Coarse => 2,
    };
    mudguard(b, dark, hub, radius + GUARD_M, 0.025, [0.14, GUARD_END], steps);
    mudguard(b, dark, fork, radius + GUARD_M, 0.025, [0.24, 0.45], steps);
    if full {
        // The chain, and a rack over the rear wheel.
        for up in [0.060, -0.015] {
            let wheel = hub + Vec3::new(0.0, -0.045, 0.45 * up);
            b.bar(metal, wheel, crank + Vec3::new(0.0, -0.045, up), [0.006; 2], 4);
        }
        let rack = Vec3::new(rear - 0.16, 0.0, 2.0 * radius + 0.06);
        for y in [-0.05, 0.05] {
            let side = Vec3::Y * y;
            tube(b, metal, &[(rack + side, 0.006), (rack + side + Vec3::X * 0.34, 0.006)], 5);
            tube(b, metal, &[(hub + side, 0.005), (rack + side + Vec3::X * 0.08, 0.005)], 4);
        }
    }
}

/// The box of a cargo bicycle between its steering head and the front wheel, on the tube that carries it.
fn cargo_box(b: &mut MeshBuilder, tag: Tag, [front, head]: [f32; 2], radius: f32, detail: Detail) {
    let paint = MeshPart::new(tag, Surface::Paint, [0.5; 3]);
    let wood = MeshPart::new(tag, Surface::Wood, [0.30, 0.20, 0.11]);
    let metal = MeshPart::new(tag, Surface::Metal, [0.12; 3]);
    let dark = MeshPart::new(tag, Surface::Rubber, [0.03; 3]);
    let sides = if detail == Detail::Full { 8 } else { 4 };
    let low = 0.20;
    let end = front - radius - 0.09;
    // The tube dips under the box and rises to the fork's head.
    let line = [
        (Vec3::new(head - 0.10, 0.0, radius + 0.30), 0.028),
        (Vec3::new(head + 0.04, 0.0, low), 0.030),
        (Vec3::new(end - 0.02, 0.0, low), 0.030),
        (Vec3::new(front - 0.12, 0.0, 2.0 * radius + 0.10), 0.028),
    ];
    tube(b, paint, &line, sides);
    let crown = Vec3::new(front - 0.10, 0.0, 2.0 * radius + 0.06);
    tube(b, paint, &[(crown, 0.024), (crown + Vec3::Z * 0.08, 0.022)], sides);
    for y in [-0.06, 0.06] {
        let foot = Vec3::new(front, y, radius);
        tube(b, paint, &[(foot, 0.011), (crown + Vec3::Y * y, 0.015)], sides);
        b.bar(metal, Vec3::new(head - 0.02, y, low + 0.02), foot.with_z(radius - 0.06), [0.008; 2], 4);
    }
    b.bar(paint, crown - Vec3::Y * 0.06, crown + Vec3::Y * 0.06, [0.014; 2], sides);
    // Wider above; a dark lid.
    let ring = |z: f32, out: f32| -> Vec<Vec3> {
        let (x0, x1, y) = (head + 0.07 - 0.3 * out, end + 2.2 * out - 0.02, 0.24 + out);
        [(x0, -y), (x1, -y), (x1, y), (x0, y)].map(|(x, y)| Vec3::new(x, y, z)).to_vec()
    };
    b.loft(&[ring(low + 0.05, 0.0), ring(low + 0.50, 0.06)], |_, _| wood, [metal, wood]);
    b.loft(&[ring(low + 0.49, 0.075), ring(low + 0.53, 0.07)], |_, _| dark, [dark; 2]);
    // The stand.
    for y in [-0.16, 0.16] {
        b.bar(
            metal,
            Vec3::new(head + 0.20, 0.6 * y, low),
            Vec3::new(head + 0.05, y, low - 0.05),
            [0.012; 2],
            4,
        );
    }
}

/// A scooter to stand on: a board, a column with a bar, small wheels.
fn kick(
    size: Vec3,
    [front, rear]: [f32; 2],
    radius: f32,
    high_m: f32,
    detail: Detail,
) -> (Vec<Piece>, Rides) {
    let tag = Tag::Bicycle;
    let (half_l, half_w) = (0.5 * size.x, 0.5 * size.y);
    let paint = MeshPart::new(tag, Surface::Paint, [0.5; 3]);
    let dark = MeshPart::new(tag, Surface::Rubber, [0.03; 3]);
    let metal = MeshPart::new(tag, Surface::Metal, [0.10; 3]);
    let lamp = |bits: u32, rgb: [f32; 3]| MeshPart::new(tag, Surface::Lamp(bits), rgb);
    let (sides, steps) = match detail {
        Detail::Full => (10, 9),
        Detail::Half => (6, 4),
        Detail::Coarse => (4, 2),
    };
    let mut b = MeshBuilder::new();
    let board_z = radius + 0.05;
    let nose = front - radius - 0.10;
    rounded(
        &mut b,
        metal,
        Vec3::new(rear + radius + 0.04, -0.085, board_z - 0.065),
        Vec3::new(nose, 0.085, board_z - 0.01),
        0.02,
    );
    rounded(
        &mut b,
        dark,
        Vec3::new(rear + radius + 0.06, -0.075, board_z - 0.012),
        Vec3::new(nose - 0.02, 0.075, board_z),
        0.006,
    );
    // The column leans back from the fork to the bar.
    let grip = Vec3::new(front - 0.22, half_w - 0.01, high_m - 0.035);
    let (fork, stem) = (Vec3::new(front - 0.015, 0.0, 2.0 * radius + 0.05), grip.with_y(0.0));
    tube(
        &mut b,
        paint,
        &[(Vec3::new(nose - 0.03, 0.0, board_z - 0.035), 0.035), (fork - Vec3::new(0.04, 0.0, 0.02), 0.028)],
        sides,
    );
    tube(&mut b, metal, &[(fork, 0.028), (stem, 0.022)], sides);
    for y in [-0.055, 0.055] {
        let foot = Vec3::new(front, y, radius);
        tube(&mut b, metal, &[(foot, 0.014), (fork + Vec3::Y * y * 0.5, 0.018)], sides);
        let hub = Vec3::new(rear, y, radius);
        tube(
            &mut b,
            metal,
            &[(hub, 0.014), (Vec3::new(rear + radius + 0.06, y, board_z - 0.035), 0.018)],
            sides,
        );
    }
    for side in [1.0, -1.0] {
        let end = grip * Vec3::new(1.0, side, 1.0);
        b.bar(metal, stem, end.with_y(0.6 * end.y), [0.014; 2], sides);
        b.bar(dark, end.with_y(0.55 * end.y), end, [0.017; 2], sides);
        let lever = end.with_y(0.66 * end.y) + Vec3::X * 0.05;
        b.bar(metal, lever, end.with_y(0.92 * end.y) + Vec3::X * 0.035, [0.007; 2], 4);
    }
    // What shows the speed makes it as high as it is; lamps before and behind.
    b.tapered(
        dark,
        stem - Vec3::new(0.04, 0.035, 0.0),
        (stem + Vec3::new(0.04, 0.035, 0.0)).with_z(high_m),
        0.8,
        0.8,
    );
    let white = lamp(lights::LOW_BEAM | lights::HIGH_BEAM | lights::POSITION, [0.85; 3]);
    let at = stem + 0.16 * (fork - stem) + Vec3::X * 0.03;
    tube(&mut b, white, &[(at - Vec3::X * 0.03, 0.02), (at + Vec3::X * 0.03, 0.03)], sides);
    let hub = Vec3::new(rear, 0.0, radius);
    mudguard(&mut b, dark, hub, radius + 0.012, 0.035, [0.16, 0.42], steps);
    mudguard(&mut b, dark, Vec3::new(front, 0.0, radius), radius + 0.012, 0.035, [0.10, 0.38], steps);
    let (s, c) = frames::math::f32::sin_cos(TAU * 0.40);
    let red = lamp(lights::POSITION | lights::BRAKE, [0.55, 0.03, 0.03]);
    let tail = hub + Vec3::new(c, 0.0, s) * (radius + 0.03);
    b.tapered(red, Vec3::new(-half_l, -0.03, tail.z - 0.02), tail + Vec3::new(0.01, 0.03, 0.025), 0.9, 0.9);
    b.fit(Vec3::new(-half_l, -half_w, board_z - 0.065), Vec3::new(front + radius * 0.8, half_w, high_m));
    let mut pieces = vec![Piece { mesh: Arc::new(b.finish()), joint: Joint::Fixed }];
    let mesh = Arc::new(wheel::spoked(tag, radius, 0.05, 5, detail));
    for (x, steered) in [(front, true), (rear, false)] {
        let joint = Joint::Wheel { at: Vec3::new(x, 0.0, radius), steered, right: false };
        pieces.push(Piece { mesh: Arc::clone(&mesh), joint });
    }
    let mirror = Vec3::new(1.0, -1.0, 1.0);
    let hand = Vec3::new(grip.x - 0.02, 0.78 * grip.y, grip.z + 0.015);
    let seat = Seat {
        hips: Vec3::new(0.5 * (front + rear) - 0.12, 0.0, 1.0),
        lean_rad: 0.05,
        hands: [hand, hand * mirror],
        // One foot before the other.
        balls: [Vec3::new(nose - 0.16, 0.035, board_z), Vec3::new(nose - 0.46, -0.035, board_z)],
        heels_rad: 0.0,
        knees: Vec3::new(1.0, 0.1, 0.1),
        elbows: Vec3::new(-0.7, 0.12, -0.8),
    };
    (pieces, Rides { seat, pedals: None, stands_z: Some(board_z) })
}
