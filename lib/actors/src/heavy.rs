//! Trucks with a cab and a body, and buses.

use std::sync::Arc;

use glam::Vec3;
use schema::geometry::{Part, Surface};
use schema::models::Model;
use schema::{Tag, lights};

use crate::pieces::{ActorMesh, Joint, Piece};
use crate::wheel::{Rim, Wheels};
use solids::{Detail, MeshBuilder};

/// A box from the rear `x0` to the front `x1` with a band of windows between the heights `glass`, closed, its edges bevelled.
struct Shell {
    x: [f32; 2],
    half_width: f32,
    z: [f32; 2],
    glass: [f32; 2],
    /// x positions of the pillars between side windows; windows lie between the first and the last.
    pillars: Vec<f32>,
    /// How far the front leans back at the top.
    lean: f32,
    front_glass: bool,
    rear_glass: bool,
    tag: Tag,
}

fn shell(b: &mut MeshBuilder, shell: &Shell) {
    let paint = Part::new(shell.tag, Surface::Paint, [0.5; 3]);
    let glass = Part::new(shell.tag, Surface::Glass, [0.04, 0.05, 0.06]);
    let under = Part::new(shell.tag, Surface::Plain, [0.05; 3]);
    let half_pillar = 0.05;
    // Layers from bottom to top; each is a ring of points around the box, counter-clockwise from above.
    let mut along: Vec<f32> = vec![shell.x[0] + 0.04];
    for p in &shell.pillars {
        along.extend([p - half_pillar, p + half_pillar]);
    }
    along.push(shell.x[1] - 0.06);
    let ring = |z: f32, inset: f32| -> Vec<Vec3> {
        let share = ((z - shell.glass[0]) / (shell.z[1] - shell.glass[0])).max(0.0);
        let w = shell.half_width - inset;
        let front = shell.x[1] - shell.lean * share - inset;
        let bend = |x: f32| x.min(front - 0.02);
        let mut points = vec![Vec3::new(front, -0.9 * w, z), Vec3::new(front, 0.9 * w, z)];
        points.extend(along.iter().rev().map(|x| Vec3::new(bend(*x), w, z)));
        points.push(Vec3::new(shell.x[0] + inset, 0.96 * w, z));
        points.push(Vec3::new(shell.x[0] + inset, -0.96 * w, z));
        points.extend(along.iter().map(|x| Vec3::new(bend(*x), -w, z)));
        points
    };
    let rings = [
        ring(shell.z[0], 0.0),
        ring(shell.glass[0], 0.0),
        ring(shell.glass[1], 0.0),
        ring(shell.z[1] - 0.10, 0.0),
        ring(shell.z[1], 0.08),
    ];
    let n = along.len();
    b.loft(
        &rings,
        |k, j| {
            if k != 1 {
                return paint;
            }
            // Points 0 and 1 are the front, then follow the left side rearwards, the rear at n + 2, the right side forwards.
            // Intervals along a side alternate between pillars (odd) and what lies between; first and last are wall.
            let window = |i: usize| i.is_multiple_of(2) && i > 0 && i + 2 < n;
            let glazed = match j {
                0 => shell.front_glass,
                _ if j == n + 2 => shell.rear_glass,
                _ if (2..=n).contains(&j) => window(n - j),
                _ if j >= n + 4 && j + 1 < 2 * n + 4 => window(j - n - 4),
                _ => false,
            };
            if glazed { glass } else { paint }
        },
        [under, paint],
    );
}

fn lamps(b: &mut MeshBuilder, tag: Tag, half_l: f32, half_w: f32, head_z: f32, tail_z: f32) {
    let lamp = |bits: u32, rgb: [f32; 3]| Part::new(tag, Surface::Lamp(bits), rgb);
    let head = lamp(lights::LOW_BEAM | lights::HIGH_BEAM | lights::POSITION, [0.85, 0.86, 0.88]);
    let amber = [0.75, 0.35, 0.05];
    let (left, right) = (lamp(lights::BLINK_LEFT, amber), lamp(lights::BLINK_RIGHT, amber));
    let mut pair = |part: Part, other: Part, x: [f32; 2], y: [f32; 2], z: [f32; 2]| {
        b.cuboid(part, Vec3::new(x[0], y[0] * half_w, z[0]), Vec3::new(x[1], y[1] * half_w, z[1]));
        b.cuboid(other, Vec3::new(x[0], -y[1] * half_w, z[0]), Vec3::new(x[1], -y[0] * half_w, z[1]));
    };
    let (front, rear) = ([half_l - 0.15, half_l], [-half_l, -half_l + 0.1]);
    pair(head, head, front, [0.52, 0.78], [head_z, head_z + 0.2]);
    pair(left, right, front, [0.78, 0.86], [head_z, head_z + 0.2]);
    let fog = lamp(lights::FOG, [0.8, 0.8, 0.75]);
    pair(fog, fog, front, [0.58, 0.70], [head_z - 0.25, head_z - 0.13]);
    let red = lamp(lights::POSITION | lights::FOG, [0.55, 0.03, 0.03]);
    let brake = lamp(lights::BRAKE, [0.6, 0.02, 0.02]);
    let white = lamp(lights::REVERSE, [0.8; 3]);
    pair(red, red, rear, [0.78, 0.92], [tail_z, tail_z + 0.13]);
    pair(brake, brake, rear, [0.64, 0.78], [tail_z, tail_z + 0.13]);
    pair(left, right, rear, [0.54, 0.64], [tail_z, tail_z + 0.13]);
    pair(white, white, rear, [0.46, 0.54], [tail_z, tail_z + 0.13]);
    let plate = Part::new(tag, Surface::Plain, [0.8, 0.8, 0.78]);
    b.cuboid(plate, Vec3::new(-half_l, -0.26, tail_z), Vec3::new(-half_l + 0.08, 0.26, tail_z + 0.11));
    b.cuboid(plate, Vec3::new(half_l - 0.08, -0.26, head_z - 0.12), Vec3::new(half_l, 0.26, head_z - 0.01));
}

/// A truck: chassis, cab over the front axle, and a box (or the body of a fire engine).
pub(crate) fn truck(model: &Model, size: Vec3) -> ActorMesh {
    let tag = Tag::Truck;
    let (half_l, half_w, height) = (0.5 * size.x, 0.5 * size.y, size.z);
    let radius = model.wheel_radius_m as f32;
    let front = half_l - 1.35;
    let rear = front - model.wheelbase_m as f32;
    let heavy = model.name == "truck.heavy";
    let fire = model.special == "emergency";
    let axles = if heavy { vec![front, rear + 0.65, rear - 0.65] } else { vec![front, rear] };
    let cab_length = if fire { 2.7 } else { 1.95 };
    let cab_back = half_l - cab_length;
    let cab_top = if fire { height - 0.25 } else { 0.86 * height };
    let floor = 1.05 * radius + 0.12;
    let mut b = MeshBuilder::new();
    chassis(&mut b, size, &axles, radius, [0.5 * (front + rear), cab_back], floor);
    // The cab stands over the front axle; wings beside the wheel are left away by raising its floor.
    let cab_floor = 2.0 * radius + 0.10;
    shell(
        &mut b,
        &Shell {
            x: [cab_back, half_l - 0.01],
            half_width: half_w - 0.015,
            z: [cab_floor, cab_top],
            glass: [cab_floor + 0.36 * (cab_top - cab_floor), cab_top - 0.28],
            pillars: if fire {
                vec![cab_back + 0.25, cab_back + 1.35, half_l - 0.35]
            } else {
                vec![cab_back + 0.7, half_l - 0.35]
            },
            lean: 0.16,
            front_glass: true,
            rear_glass: false,
            tag,
        },
    );
    let bumper = Part::new(tag, Surface::Plain, [0.12, 0.12, 0.13]);
    b.cuboid(
        bumper,
        Vec3::new(half_l - 0.55, -half_w + 0.02, 0.35),
        Vec3::new(half_l - 0.02, half_w - 0.02, cab_floor),
    );
    b.cuboid(
        bumper,
        Vec3::new(front - radius - 0.75, -half_w + 0.2, 0.4),
        Vec3::new(front - radius - 0.12, half_w - 0.2, cab_floor),
    );
    // The body.
    let body_front = cab_back - 0.14;
    let body_part = if fire {
        Part::new(tag, Surface::Paint, [0.5; 3])
    } else {
        Part::new(tag, Surface::Plain, [0.72, 0.72, 0.70])
    };
    let frame = Part::new(tag, Surface::Metal, [0.35, 0.35, 0.36]);
    let body_floor = 2.0 * radius + 0.08;
    b.cuboid(
        body_part,
        Vec3::new(-half_l + 0.02, -half_w, body_floor),
        Vec3::new(body_front, half_w, height - if fire { 0.3 } else { 0.0 }),
    );
    b.cuboid(
        frame,
        Vec3::new(-half_l, -half_w + 0.03, body_floor - 0.12),
        Vec3::new(body_front, half_w - 0.03, body_floor),
    );
    if fire {
        fire_engine(&mut b, size, [body_front, body_floor], cab_top);
    } else {
        let guard = [rear + radius + 0.2, body_front];
        side_guards(&mut b, size, guard, body_floor, [cab_back, cab_top]);
    }
    lamps(&mut b, tag, half_l, half_w, 0.62, 0.75);
    b.fit(Vec3::new(-half_l, -half_w, 0.33), Vec3::new(half_l, half_w, height));
    let mut pieces = vec![Piece { mesh: Arc::new(b.finish()), joint: Joint::Fixed }];
    let wheels = Wheels { tag, axles: &axles, radius, width: 0.34, outer_y: half_w - 0.03, rim: Rim::Heavy };
    pieces.extend(wheels.pieces(Detail::Full));
    ActorMesh::of(pieces)
}

/// The beams and axles of a truck, and the tank in its middle.
fn chassis(
    b: &mut MeshBuilder,
    size: Vec3,
    axles: &[f32],
    radius: f32,
    [middle, cab_back]: [f32; 2],
    floor: f32,
) {
    let tag = Tag::Truck;
    let (half_l, half_w) = (0.5 * size.x, 0.5 * size.y);
    let metal = Part::new(tag, Surface::Metal, [0.10, 0.10, 0.11]);
    // Chassis beams and the tank between the axles.
    for y in [-0.4, 0.4] {
        b.cuboid(
            metal,
            Vec3::new(-half_l + 0.05, y - 0.08, floor - 0.25),
            Vec3::new(cab_back, y + 0.08, floor),
        );
    }
    for axle in axles {
        b.bar(
            metal,
            Vec3::new(*axle, -half_w + 0.1, radius),
            Vec3::new(*axle, half_w - 0.1, radius),
            [0.09; 2],
            6,
        );
    }
    b.cuboid(metal, Vec3::new(middle - 0.5, 0.5, 0.45), Vec3::new(middle + 0.5, half_w - 0.12, floor));
}

/// The ladder, lights and stripe of a fire engine's body.
fn fire_engine(b: &mut MeshBuilder, size: Vec3, [body_front, body_floor]: [f32; 2], cab_top: f32) {
    let tag = Tag::Truck;
    let (half_l, half_w, height) = (0.5 * size.x, 0.5 * size.y, size.z);
    let ladder = Part::new(tag, Surface::Metal, [0.6, 0.6, 0.62]);
    for y in [-0.35, 0.35] {
        b.cuboid(
            ladder,
            Vec3::new(-half_l + 0.1, y - 0.05, height - 0.3),
            Vec3::new(body_front, y + 0.05, height - 0.12),
        );
    }
    let mut x = -half_l + 0.3;
    while x < body_front - 0.1 {
        b.cuboid(ladder, Vec3::new(x, -0.30, height - 0.24), Vec3::new(x + 0.05, 0.30, height - 0.18));
        x += 0.45;
    }
    for (y0, y1, bits) in [(0.0, 0.7, lights::EMERGENCY), (-0.7, 0.0, lights::EMERGENCY_OTHER)] {
        b.cuboid(
            Part::new(tag, Surface::Lamp(bits), [0.05, 0.1, 0.8]),
            Vec3::new(half_l - 0.9, y0 * half_w, cab_top - 0.02),
            Vec3::new(half_l - 0.6, y1 * half_w, height),
        );
    }
    let stripe = Part::new(tag, Surface::Plain, [0.85, 0.85, 0.3]);
    b.cuboid(
        stripe,
        Vec3::new(-half_l + 0.05, -half_w, body_floor + 0.5),
        Vec3::new(body_front - 0.05, half_w, body_floor + 0.65),
    );
}

/// Guards between the axles, and an air deflector on the cab.
fn side_guards(
    b: &mut MeshBuilder,
    size: Vec3,
    guard: [f32; 2],
    body_floor: f32,
    [cab_back, cab_top]: [f32; 2],
) {
    let tag = Tag::Truck;
    let (half_l, half_w, height) = (0.5 * size.x, 0.5 * size.y, size.z);
    let frame = Part::new(tag, Surface::Metal, [0.35, 0.35, 0.36]);
    for y in [-half_w + 0.04, half_w - 0.08] {
        b.cuboid(frame, Vec3::new(guard[0], y, 0.45), Vec3::new(guard[1], y + 0.04, body_floor - 0.12));
    }
    let paint = Part::new(tag, Surface::Paint, [0.5; 3]);
    b.tapered(
        paint,
        Vec3::new(cab_back, -0.8 * half_w, cab_top - 0.02),
        Vec3::new(half_l - 0.6, 0.8 * half_w, height - 0.06),
        0.55,
        0.85,
    );
}

/// A city bus: low floor, a band of windows, doors on the right.
pub(crate) fn bus(model: &Model, size: Vec3) -> ActorMesh {
    let tag = Tag::Bus;
    let (half_l, half_w, height) = (0.5 * size.x, 0.5 * size.y, size.z);
    let radius = model.wheel_radius_m as f32;
    let front = half_l - 2.75;
    let axles = [front, front - model.wheelbase_m as f32];
    let mut b = MeshBuilder::new();
    let count = 7;
    let pillars = (0..=count).map(|i| -half_l + 0.5 + (size.x - 0.9) * i as f32 / count as f32).collect();
    shell(
        &mut b,
        &Shell {
            x: [-half_l + 0.01, half_l - 0.01],
            half_width: half_w,
            z: [2.0 * radius + 0.06, height - 0.2],
            glass: [2.0 * radius + 0.16, height - 0.65],
            pillars,
            lean: 0.12,
            front_glass: true,
            rear_glass: true,
            tag,
        },
    );
    // Skirts between the wheel arches.
    let skirt = Part::new(tag, Surface::Paint, [0.5; 3]);
    let arch = radius + 0.12;
    let edges =
        [-half_l + 0.02, axles[1] - arch, axles[1] + arch, axles[0] - arch, axles[0] + arch, half_l - 0.03];
    for pair in edges.chunks_exact(2) {
        b.cuboid(
            skirt,
            Vec3::new(pair[0], -half_w + 0.01, 0.28),
            Vec3::new(pair[1], half_w - 0.01, 2.0 * radius + 0.06),
        );
    }
    let inner = Part::new(tag, Surface::Plain, [0.05; 3]);
    for axle in axles {
        b.cuboid(
            inner,
            Vec3::new(axle - arch, -half_w + 0.5, 0.3),
            Vec3::new(axle + arch, half_w - 0.5, 2.0 * radius + 0.06),
        );
    }
    let door = Part::new(tag, Surface::Glass, [0.05, 0.06, 0.07]);
    for x in [half_l - 1.6, 0.5 * (axles[0] + axles[1])] {
        b.cuboid(door, Vec3::new(x - 0.6, -half_w, 0.36), Vec3::new(x + 0.6, -half_w + 0.1, height - 0.7));
    }
    let unit = Part::new(tag, Surface::Plain, [0.75, 0.75, 0.74]);
    b.tapered(
        unit,
        Vec3::new(-0.32 * size.x, -0.7 * half_w, height - 0.21),
        Vec3::new(0.2 * size.x, 0.7 * half_w, height),
        0.97,
        0.9,
    );
    let board = Part::new(tag, Surface::Lamp(lights::POSITION), [0.75, 0.5, 0.1]);
    b.cuboid(
        board,
        Vec3::new(half_l - 0.3, -0.6 * half_w, height - 0.6),
        Vec3::new(half_l - 0.1, 0.6 * half_w, height - 0.32),
    );
    lamps(&mut b, tag, half_l, half_w, 0.62, 0.8);
    b.fit(Vec3::new(-half_l, -half_w, 0.28), Vec3::new(half_l, half_w, height));
    let mut pieces = vec![Piece { mesh: Arc::new(b.finish()), joint: Joint::Fixed }];
    let wheels = Wheels { tag, axles: &axles, radius, width: 0.32, outer_y: half_w - 0.03, rim: Rim::Heavy };
    pieces.extend(wheels.pieces(Detail::Full));
    ActorMesh::of(pieces)
}
