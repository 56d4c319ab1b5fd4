//! Lorries: a cab on a frame with a body behind it, all on wheels.

use glam::Vec3;
use schema::geometry::{Part, Surface};
use schema::models::Model;
use schema::{Tag, lights};
use solids::{Detail, MeshBuilder};

use crate::car::{Car, Looks};
use crate::hull::{Hull, Style};
use crate::pieces::ActorMesh;
use crate::wheel::{Rim, Wheels};

/// A cab above its engine.
const CAB: Style = Style {
    nose_z: 0.47,
    cowl: (0.012, 0.485),
    roof: (0.17, 0.985),
    deck: (0.995, 0.50),
    tail_z: 0.49,
    windows: (0.13, 0.60),
    pillars: &[],
    roof_width: 0.90,
    clearance: 0.12,
    rear_glass: false,
    roof_z: 1.0,
    bow_m: [0.13, 0.01],
    glass_bow_m: [0.10, 0.01],
    tuck: 0.012,
    ends_width: [0.94, 0.985],
    nose_lean: &[(0.2, 0.04), (0.36, 0.0), (0.8, 0.008), (1.0, 0.03)],
    tail_lean: &[(0.0, 0.0), (1.0, 0.0)],
    belt: [0.97, 0.97],
    crown_m: 0.05,
    falls: [0.05, 0.01],
};

/// That of a fire engine, with room for a crew.
const CREW_CAB: Style =
    Style { cowl: (0.010, 0.485), roof: (0.13, 0.985), windows: (0.10, 0.90), pillars: &[0.42, 0.58], ..CAB };

/// How much narrower than the body a cab is on each side: mirrors fill that.
const NARROWER_M: f32 = 0.07;
/// Width of tyres.
const TYRE_M: f32 = 0.34;

/// A lorry: cab over the front axle, frame, and a box (or the body of a fire engine).
pub(crate) fn truck(model: &Model, size: Vec3) -> ActorMesh {
    let half = 0.5 * size;
    let radius = model.wheel_radius_m as f32;
    let front = half.x - 1.35;
    let rear = front - model.wheelbase_m as f32;
    let axles =
        if model.name == "truck.heavy" { vec![front, rear + 0.65, rear - 0.65] } else { vec![front, rear] };
    let fire = model.special == "emergency";
    let cab_length = if fire { 2.75 } else { 1.35 + 1.12 * radius + 0.09 };
    let cab_back = half.x - cab_length;
    let cab_top = if fire { size.z - 0.25 } else { 0.87 * size.z };
    let hull = Hull::new(
        if fire { CREW_CAB } else { CAB },
        [cab_back, half.x],
        [half.y - NARROWER_M, cab_top],
        &axles[..1],
        radius,
    );
    let wheels = Wheels {
        tag: Tag::Truck,
        axles: &axles,
        radius,
        width: TYRE_M,
        outer_y: half.y - NARROWER_M - 0.03,
        rim: Rim::Heavy,
    };
    let cab = Car { model, hull: &hull, looks: Looks::new(Tag::Truck, model), wheels };
    let lorry = Lorry { size, cab: &cab, axles: &axles, cab_back, cab_top, fire };
    let made = |detail: Detail| {
        let mut b = MeshBuilder::new();
        cab.shell(&mut b, detail);
        cab.nose(&mut b, detail);
        lorry.frame(&mut b, detail);
        lorry.body(&mut b, detail);
        if fire {
            lorry.fire_engine(&mut b, detail);
        } else {
            lorry.deflector(&mut b, detail);
        }
        lorry.rear_lamps(&mut b, detail);
        tall_mirrors(&mut b, &hull, &cab.looks, half, detail);
        let fit = b.fit(Vec3::new(-half.x, -half.y, CAB.clearance * cab_top), half.with_z(size.z));
        (cab.wheels.under(b, detail), fit)
    };
    ActorMesh::with_cabin(made, |fit| cab.cabin(fit, &|_, _, _| false))
}

/// Mirrors on arms before the corners of an upright windscreen, as far out as the vehicle is wide.
pub(crate) fn tall_mirrors(b: &mut MeshBuilder, hull: &Hull, looks: &Looks, half: Vec3, detail: Detail) {
    if detail == Detail::Coarse {
        return;
    }
    let z = 0.68 * hull.height;
    for side in [1.0, -1.0] {
        let at = Vec3::new(half.x - 0.13, side * (half.y - 0.09), z);
        rounded(b, looks.trim, at - Vec3::new(0.05, 0.09, 0.20), at + Vec3::new(0.05, 0.09, 0.20), 0.03);
        if detail == Detail::Full {
            let root = Vec3::new(half.x - 0.30, side * (hull.half_width - 0.08), z);
            for up in [0.16, -0.16] {
                b.bar(looks.trim, root + Vec3::Z * (up + 0.05), at + Vec3::Z * up, [0.018; 2], 5);
            }
        }
    }
}

/// A box whose edges are bevelled.
pub(crate) fn rounded(b: &mut MeshBuilder, part: Part, min: Vec3, max: Vec3, bevel: f32) {
    let ring = |x: f32, inset: f32| -> Vec<Vec3> {
        let (y0, y1) = (min.y + inset, max.y - inset);
        let (z0, z1) = (min.z + inset, max.z - inset);
        [
            (y0 + bevel, z0),
            (y1 - bevel, z0),
            (y1, z0 + bevel),
            (y1, z1 - bevel),
            (y1 - bevel, z1),
            (y0 + bevel, z1),
            (y0, z1 - bevel),
            (y0, z0 + bevel),
        ]
        .map(|(y, z)| Vec3::new(x, y, z))
        .to_vec()
    };
    let rings = [ring(min.x, bevel), ring(min.x + bevel, 0.0), ring(max.x - bevel, 0.0), ring(max.x, bevel)];
    b.loft(&rings, |_, _| part, [part; 2]);
}

/// What is behind and under a cab.
struct Lorry<'a> {
    size: Vec3,
    cab: &'a Car<'a>,
    axles: &'a [f32],
    cab_back: f32,
    cab_top: f32,
    fire: bool,
}

impl Lorry<'_> {
    fn half(&self) -> Vec3 {
        0.5 * self.size
    }

    fn radius(&self) -> f32 {
        self.cab.wheels.radius
    }

    /// Lower edge and front of the body.
    fn body_floor(&self) -> f32 {
        2.0 * self.radius() + 0.08
    }

    fn body_front(&self) -> f32 {
        self.cab_back - 0.12
    }

    /// Beams, axles, tanks, mudguards and bars against driving under it.
    fn frame(&self, b: &mut MeshBuilder, detail: Detail) {
        let (half, radius, looks) = (self.half(), self.radius(), &self.cab.looks);
        let metal = Part::new(Tag::Truck, Surface::Metal, [0.07, 0.07, 0.075]);
        let (floor, front) = (self.body_floor() - 0.1, self.cab_back + 0.4);
        for y in [-0.4, 0.4] {
            b.cuboid(
                metal,
                Vec3::new(-half.x + 0.12, y - 0.06, floor - 0.28),
                Vec3::new(front, y + 0.06, floor),
            );
        }
        // The bar at the rear carries the lamps.
        b.cuboid(
            metal,
            Vec3::new(-half.x + 0.03, -half.y + 0.06, 0.46),
            Vec3::new(-half.x + 0.14, half.y - 0.06, 0.72),
        );
        if detail == Detail::Coarse {
            return;
        }
        for axle in &self.axles[1..] {
            let end = Vec3::new(*axle, half.y - 0.35, radius);
            b.bar(metal, end * Vec3::new(1.0, -1.0, 1.0), end, [0.09; 2], 6);
        }
        let (first, last) = (self.axles[1], self.axles[self.axles.len() - 1]);
        let room = [first + radius + 0.18, self.axles[0] - 1.15 * radius - 0.25];
        let tank = Part::new(Tag::Truck, Surface::Metal, [0.45, 0.46, 0.47]);
        let long = 0.42 * (room[1] - room[0]);
        for (y, x, part) in [(1.0, room[1] - long, tank), (-1.0, room[1] - 0.7 * long, looks.trim)] {
            let (a, c) = (0.52 * y, (half.y - 0.16) * y);
            let x1 = if y > 0.0 { x + long } else { x + 0.7 * long };
            rounded(b, part, Vec3::new(x, a.min(c), 0.42), Vec3::new(x1, a.max(c), floor - 0.02), 0.06);
        }
        for side in [1.0, -1.0] {
            let y = side * (half.y - 0.07);
            for z in [0.52, 0.82] {
                let rail = Vec3::new(0.0, 0.02, 0.05);
                b.cuboid(metal, Vec3::new(room[0], y, z) - rail, Vec3::new(room[1], y, z) + rail);
            }
            if detail == Detail::Full {
                for share in [0.1, 0.5, 0.9] {
                    let x = room[0] + share * (room[1] - room[0]);
                    b.cuboid(
                        metal,
                        Vec3::new(x - 0.03, y - 0.03, 0.47),
                        Vec3::new(x + 0.03, y + 0.01, floor),
                    );
                }
                // Mudflaps behind the wheels.
                let flap = Vec3::new(last - radius - 0.10, y - side * 0.20, 0.0);
                b.cuboid(
                    looks.trim,
                    flap + Vec3::new(-0.01, -0.17, 0.22),
                    flap + Vec3::new(0.01, 0.17, floor),
                );
            }
        }
    }

    fn body(&self, b: &mut MeshBuilder, detail: Detail) {
        let (half, looks) = (self.half(), &self.cab.looks);
        let part =
            if self.fire { looks.paint } else { Part::new(Tag::Truck, Surface::Plain, [0.72, 0.72, 0.70]) };
        let metal = Part::new(Tag::Truck, Surface::Metal, [0.35, 0.35, 0.36]);
        let (floor, front) = (self.body_floor(), self.body_front());
        let top = self.size.z - if self.fire { 0.3 } else { 0.0 };
        // What lies on the sides makes it as wide as it is.
        let wide = half.y - if self.fire { 0.02 } else { 0.008 };
        rounded(b, part, Vec3::new(-half.x + 0.02, -wide, floor), Vec3::new(front, wide, top), 0.04);
        b.cuboid(
            metal,
            Vec3::new(-half.x, -half.y + 0.03, floor - 0.12),
            Vec3::new(front, half.y - 0.03, floor),
        );
        if detail != Detail::Full {
            return;
        }
        // Doors at the rear: where they meet, and their bars.
        b.cuboid(
            looks.gap,
            Vec3::new(-half.x + 0.015, -0.008, floor + 0.06),
            Vec3::new(-half.x + 0.04, 0.008, top - 0.06),
        );
        for y in [-0.75, -0.25, 0.25, 0.75].map(|share| share * half.y) {
            let foot = Vec3::new(-half.x + 0.012, y, floor + 0.03);
            b.bar(metal, foot, foot.with_z(top - 0.05), [0.016; 2], 5);
        }
        // Edges of metal along a box.
        if !self.fire {
            for side in [1.0, -1.0] {
                for z in [floor + 0.03, top - 0.06] {
                    let edge = Vec3::new(0.0, side * (half.y - 0.012), z);
                    let around = Vec3::new(0.0, 0.012, 0.03);
                    let long = Vec3::X * (front - 0.05);
                    b.cuboid(metal, edge - around - Vec3::X * (half.x - 0.07), edge + around + long);
                }
            }
        }
    }

    fn rear_lamps(&self, b: &mut MeshBuilder, detail: Detail) {
        let (half, looks) = (self.half(), &self.cab.looks);
        let amber = [0.75, 0.35, 0.05];
        let red = looks.lamp(lights::POSITION | lights::FOG, [0.55, 0.03, 0.03]);
        let brake = looks.lamp(lights::BRAKE, [0.6, 0.02, 0.02]);
        let white = looks.lamp(lights::REVERSE, [0.8; 3]);
        let (left, right) = (looks.lamp(lights::BLINK_LEFT, amber), looks.lamp(lights::BLINK_RIGHT, amber));
        let [z0, z1] = [0.52, 0.66];
        for (parts, y) in [
            ([red; 2], [0.80, 0.93]),
            ([brake; 2], [0.67, 0.79]),
            ([left, right], [0.57, 0.66]),
            ([white; 2], [0.49, 0.56]),
        ] {
            for (part, side) in parts.into_iter().zip([1.0, -1.0]) {
                let (a, c) = (y[0] * half.y * side, y[1] * half.y * side);
                let (min, max) = (Vec3::new(-half.x, a.min(c), z0), Vec3::new(-half.x + 0.08, a.max(c), z1));
                if detail == Detail::Full {
                    rounded(b, part, min, max, 0.012)
                } else {
                    b.cuboid(part, min, max)
                }
            }
        }
        let plate = Part::new(Tag::Truck, Surface::Plain, [0.78, 0.78, 0.76]);
        b.cuboid(plate, Vec3::new(-half.x + 0.01, -0.26, 0.54), Vec3::new(-half.x + 0.08, 0.26, 0.65));
    }

    /// What leads the air over the box.
    fn deflector(&self, b: &mut MeshBuilder, detail: Detail) {
        let (half, paint) = (self.half(), self.cab.looks.paint);
        let (low, high) = (self.cab_top - 0.06, self.size.z - 0.05);
        let steps = if detail == Detail::Full { 6 } else { 2 };
        let rings: Vec<Vec<Vec3>> = (0..=steps)
            .map(|i| {
                let t = i as f32 / steps as f32;
                // From the cab's back forwards, round over the top.
                let x = self.cab_back + 0.04 + t * (self.half().x - 0.55 - self.cab_back);
                let (top, wide) = (high + (low + 0.02 - high) * t * t, (0.84 - 0.14 * t) * half.y);
                [(-wide, low), (wide, low), (0.9 * wide, top), (-0.9 * wide, top)]
                    .map(|(y, z)| Vec3::new(x, y, z))
                    .to_vec()
            })
            .collect();
        b.loft(&rings, |_, _| paint, [self.cab.looks.trim, paint]);
    }

    /// The ladder, shutters, lights and stripe of a fire engine's body.
    fn fire_engine(&self, b: &mut MeshBuilder, detail: Detail) {
        let (half, height, looks) = (self.half(), self.size.z, &self.cab.looks);
        let (front, floor) = (self.body_front(), self.body_floor());
        let ladder = Part::new(Tag::Truck, Surface::Metal, [0.6, 0.6, 0.62]);
        for y in [-0.35, 0.35] {
            let rail = Vec3::new(front, y + 0.05, height - 0.12);
            b.cuboid(ladder, Vec3::new(-half.x + 0.1, y - 0.05, height - 0.3), rail);
        }
        if detail == Detail::Full {
            for k in 0..((front + half.x - 0.4) / 0.45) as usize {
                let x = -half.x + 0.3 + 0.45 * k as f32;
                b.cuboid(
                    ladder,
                    Vec3::new(x, -0.30, height - 0.24),
                    Vec3::new(x + 0.05, 0.30, height - 0.18),
                );
            }
        }
        for (y0, y1, bits) in [(0.0, 0.7, lights::EMERGENCY), (-0.7, 0.0, lights::EMERGENCY_OTHER)] {
            let (min, max) = (
                Vec3::new(half.x - 1.15, y0 * half.y, self.cab_top - 0.05),
                Vec3::new(half.x - 0.80, y1 * half.y, height),
            );
            b.tapered(looks.lamp(bits, [0.05, 0.1, 0.8]), min, max, 0.7, 0.97);
        }
        let stripe = Part::new(Tag::Truck, Surface::Plain, [0.85, 0.85, 0.3]);
        let shutter = Part::new(Tag::Truck, Surface::Metal, [0.5, 0.51, 0.52]);
        for side in [1.0, -1.0] {
            let face = |part: Part, b: &mut MeshBuilder, x: [f32; 2], z: [f32; 2], out_m: f32| {
                let y = [half.y - 0.05, half.y - 0.012 + out_m].map(|y| y * side);
                b.cuboid(part, Vec3::new(x[0], y[0].min(y[1]), z[0]), Vec3::new(x[1], y[0].max(y[1]), z[1]));
            };
            face(stripe, b, [-half.x + 0.08, front - 0.06], [floor + 0.06, floor + 0.20], 0.012);
            if detail == Detail::Coarse {
                continue;
            }
            let (count, long) = (3, (front + half.x - 0.3) / 3.0);
            for k in 0..count {
                let x = -half.x + 0.15 + long * k as f32;
                face(shutter, b, [x + 0.05, x + long - 0.05], [floor + 0.30, height - 0.48], 0.0);
                if detail == Detail::Full {
                    for slat in 1..9 {
                        let z = floor + 0.30 + (height - 0.78 - floor) * slat as f32 / 9.0;
                        face(looks.trim, b, [x + 0.06, x + long - 0.06], [z - 0.006, z + 0.006], 0.006);
                    }
                }
            }
        }
    }
}
