//! Semi-trailers, and what they rest on.

use crate::solids::{Detail, MeshBuilder};
use catalogue::{Load, Rim, trains::Train};
use glam::Vec3;
use schema::Tag;
use schema::geometry::{MeshPart, Surface};

use crate::actors::car::{Car, Looks};
use crate::actors::hull::Hull;
use crate::actors::lorry::{CAB, Lorry, TYRE_M};
use crate::actors::pieces::ActorMesh;
use crate::actors::pod::rounded;
use crate::actors::wheel::Wheels;
use crate::actors::{load, tanks};

/// Lower edge of what is carried: over the coupling and the wheels of the tractor unit.
const FLOOR_M: f32 = 1.27;
/// The frame begins so far behind the kingpin that the rear of the tractor unit turns before it, and its legs
/// stand behind that.
const FRAME_M: f32 = 2.15;
const LEGS_M: f32 = 2.65;
/// Lowest place but for the wheels.
const LOW_M: f32 = 0.42;

/// A semi-trailer on three axles.
pub(crate) fn trailer(train: &Train, load: Load, size: Vec3) -> ActorMesh {
    let (model, half) = (train.towed, 0.5 * size);
    let radius = model.wheel_radius_m as f32;
    let kingpin = train.coupling_m as f32;
    let middle = kingpin - train.rod_m as f32;
    let apart = 0.5 * model.wheelbase_m as f32;
    let axles = [middle + apart, middle, middle - apart];
    // It has no cab: only what lorries ask of theirs.
    let hull = Hull::new(CAB, [half.x - 1.0, half.x], [half.y, size.z], &[], radius);
    let wheels = Wheels {
        tag: Tag::Truck,
        axles: &axles,
        radius,
        width: TYRE_M,
        outer_y: half.y - 0.10,
        rim: Rim::Heavy,
    };
    let cab = Car { model, hull: &hull, looks: Looks::new(Tag::Truck, model), wheels };
    let along = [kingpin - LEGS_M, axles[0], axles[1], axles[2]];
    let cab_back = half.x + 0.12;
    let lorry = Lorry { size, cab: &cab, axles: &along, cab_back, cab_top: size.z, load, floor_m: FLOOR_M };
    ActorMesh::in_levels(|detail: Detail| {
        let mut b = MeshBuilder::new();
        frame(&lorry, &mut b, kingpin, detail);
        match load {
            Load::Curtain => load::curtain(&lorry, &mut b, detail),
            Load::Tank => tanks::tanker(&lorry, &mut b, detail),
            Load::Container => container(&lorry, &mut b, detail),
            _ => load::goods(&lorry, &mut b, true, detail),
        }
        if load != Load::Tank {
            lorry.guards(&mut b, detail);
        }
        lorry.rear_lamps(&mut b, detail);
        front_lamps(&lorry, &mut b);
        b.fit(Vec3::new(-half.x, -half.y, LOW_M), half.with_z(size.z));
        cab.wheels.under(b, detail)
    })
}

/// Beams, axles, legs, rails along the sides, the bar against driving under it.
fn frame(l: &Lorry<'_>, b: &mut MeshBuilder, kingpin: f32, detail: Detail) {
    let (half, radius, trim) = (l.half(), l.radius(), l.cab.looks.trim);
    let metal = Lorry::stuff(Surface::Metal, [0.07, 0.07, 0.075]);
    let [legs, first, .., last] = l.axles[..] else { return };
    let floor = l.body_floor() - 0.12;
    for y in [-0.38, 0.38] {
        b.cuboid(
            metal,
            Vec3::new(-half.x + 0.12, y - 0.06, floor - 0.36),
            Vec3::new(kingpin - FRAME_M, y + 0.06, floor),
        );
    }
    Lorry::across(b, metal, [-half.x + 0.03, -half.x + 0.14], half.y - 0.06, [0.46, 0.72]);
    // The plate around the kingpin, and the legs, wound up.
    Lorry::across(b, metal, [kingpin - 0.9, kingpin + 0.7], 0.62, [floor - 0.012, floor + 0.02]);
    Lorry::both(b, metal, [legs - 0.06, legs + 0.06], [0.68, 0.82], [LOW_M + 0.04, floor]);
    Lorry::both(b, metal, [legs - 0.15, legs + 0.15], [0.62, 0.88], [LOW_M, LOW_M + 0.05]);
    if detail == Detail::Coarse {
        return;
    }
    for axle in &l.axles[1..] {
        let end = Vec3::new(*axle, half.y - 0.37, radius);
        b.bar(metal, end * Vec3::new(1.0, -1.0, 1.0), end, [0.08; 2], 6);
    }
    let room = [first + radius + 0.20, legs - 0.30];
    for z in [0.55, 0.86] {
        Lorry::both(b, metal, room, [half.y - 0.09, half.y - 0.05], [z - 0.05, z + 0.05]);
    }
    // A box of pallets on one side, tools on the other.
    let tools = [room[1] - 1.5, room[1] - 0.5];
    rounded(b, trim, Vec3::new(tools[0], 0.55, 0.50), Vec3::new(tools[1], half.y - 0.14, floor - 0.06), 0.05);
    rounded(
        b,
        trim,
        Vec3::new(room[0] + 0.3, 0.2 - half.y, 0.56),
        Vec3::new(room[0] + 1.9, -0.55, floor - 0.06),
        0.04,
    );
    if detail == Detail::Half {
        return;
    }
    for k in 0..5 {
        let x = room[0] + 0.08 + (room[1] - room[0] - 0.16) * k as f32 / 4.0;
        Lorry::both(b, metal, [x - 0.03, x + 0.03], [half.y - 0.12, half.y - 0.08], [0.50, floor]);
    }
    for side in [1.0_f32, -1.0] {
        let y = side * (half.y - 0.27);
        let flap = Vec3::new(last - radius - 0.14, y, 0.0);
        b.cuboid(trim, flap + Vec3::new(-0.01, -0.17, 0.24), flap + Vec3::new(0.01, 0.17, floor - 0.1));
        // Air springs and shock absorbers.
        for axle in &l.axles[1..] {
            let at = Vec3::new(*axle - 0.30, side * 0.40, radius);
            b.stack(trim, &[(at, 0.11, 0.11), (at.with_z(floor - 0.36), 0.13, 0.13)], 8);
        }
    }
    // The winding gear between the legs, and the coupling for air.
    let gear = Vec3::new(legs, 0.0, 0.85);
    b.bar(metal, gear - Vec3::Y * 0.7, gear + Vec3::Y * 0.95, [0.03; 2], 5);
    let front = Vec3::new(half.x - 0.05, 0.0, l.body_floor() + 0.35);
    Lorry::across(b, metal, [front.x, half.x - 0.002], 0.34, [front.z - 0.09, front.z + 0.09]);
}

/// Small white lamps at the front corners, and amber ones along the sides.
fn front_lamps(l: &Lorry<'_>, b: &mut MeshBuilder) {
    let (half, looks) = (l.half(), &l.cab.looks);
    let white = looks.lamp(schema::lights::POSITION, [0.75, 0.75, 0.72]);
    let amber = looks.lamp(schema::lights::POSITION, [0.75, 0.35, 0.05]);
    let z = [l.body_floor() - 0.11, l.body_floor() - 0.03];
    Lorry::both(b, white, [half.x - 0.04, half.x - 0.001], [half.y - 0.22, half.y - 0.10], z);
    for share in [0.2, 0.5, 0.8] {
        let x = -half.x + share * l.size.x;
        Lorry::both(b, amber, [x - 0.05, x + 0.05], [half.y - 0.03, half.y - 0.0005], z);
    }
}

/// A shipping container of corrugated steel on a frame.
pub(crate) fn container(l: &Lorry<'_>, b: &mut MeshBuilder, detail: Detail) {
    let (half, paint, dark) = (l.half(), l.cab.looks.paint, l.cab.looks.gap);
    let (floor, top) = (l.body_floor(), l.size.z);
    let [back, front] = [-half.x + 0.015, half.x - 0.30];
    let wide = half.y - 0.05;
    // The frame: a neck between the container's rails, and cross beams with locks.
    let metal = Lorry::stuff(Surface::Metal, [0.10, 0.10, 0.105]);
    Lorry::across(b, metal, [back + 0.1, half.x], 0.55, [floor - 0.12, floor + 0.02]);
    for x in [back + 0.12, front - 0.12] {
        Lorry::across(b, metal, [x - 0.10, x + 0.10], half.y - 0.002, [floor - 0.12, floor]);
    }
    Lorry::across(b, metal, [front + 0.02, half.x - 0.001], half.y - 0.002, [floor - 0.12, floor + 0.10]);
    b.cuboid(
        paint,
        Vec3::new(back + 0.02, -wide + 0.03, floor),
        Vec3::new(front - 0.02, wide - 0.03, top - 0.03),
    );
    // Rails and posts.
    for z in [[floor, floor + 0.16], [top - 0.12, top]] {
        Lorry::both(b, paint, [back, front], [wide - 0.10, wide + 0.01], z);
        for x in [[back, back + 0.10], [front - 0.10, front]] {
            Lorry::across(b, paint, x, wide - 0.02, z);
        }
    }
    for x in [[back, back + 0.16], [front - 0.16, front]] {
        Lorry::both(b, paint, x, [wide - 0.16, wide + 0.012], [floor, top]);
    }
    if detail == Detail::Coarse {
        return;
    }
    let count = if detail == Detail::Full { 42 } else { 14 };
    let pitch = (front - back - 0.4) / count as f32;
    for k in 0..count {
        ribs(b, paint, back + 0.2 + pitch * (k as f32 + 0.1), pitch, wide, [floor + 0.15, top - 0.11]);
    }
    if detail == Detail::Full {
        for k in 0..8 {
            let y = -wide + 0.25 + (2.0 * wide - 0.5) * k as f32 / 7.0;
            b.cuboid(
                paint,
                Vec3::new(front - 0.05, y - 0.07, floor + 0.15),
                Vec3::new(front - 0.004, y + 0.07, top - 0.11),
            );
        }
        // Corner castings with their holes.
        for x in [back - 0.003, front - 0.17] {
            for z in [floor - 0.003, top - 0.115] {
                Lorry::both(b, dark, [x + 0.05, x + 0.13], [wide - 0.02, wide + 0.015], [z + 0.03, z + 0.09]);
            }
        }
    }
    load::rear_doors(l, b, top, detail);
}

/// A rib in each side wall from a place on: with sloping flanks, as sheet steel is bent.
fn ribs(b: &mut MeshBuilder, part: MeshPart, x: f32, pitch: f32, wide: f32, z: [f32; 2]) {
    let (base, flank) = (0.8 * pitch, 0.26 * pitch);
    let outline = [(0.0, wide - 0.05), (base, wide - 0.05), (base - flank, wide), (flank, wide)];
    for side in [1.0, -1.0] {
        let rings = z.map(|z| {
            let mut ring = outline.map(|(along, y)| Vec3::new(x + along, side * y, z));
            if side < 0.0 {
                ring.reverse();
            }
            ring.to_vec()
        });
        b.loft(&rings, |_, _| part, [part; 2]);
    }
}

/// Behind the cab of a tractor unit: the plate that a trailer rests on, a walkway, hoses, walls that lead the
/// air.
pub(crate) fn coupling(l: &Lorry<'_>, b: &mut MeshBuilder, detail: Detail) {
    let (half, paint, dark) = (l.half(), l.cab.looks.paint, l.cab.looks.trim);
    let metal = Lorry::stuff(Surface::Metal, [0.14, 0.14, 0.145]);
    let floor = l.body_floor() - 0.1;
    let plate = l.axles[1] + 0.55;
    Lorry::across(b, metal, [-half.x + 0.12, l.cab_back], 0.40, [floor - 0.10, floor]);
    Lorry::across(b, metal, [plate - 0.42, plate + 0.36], 0.46, [floor, floor + 0.155]);
    // A ramp up to it from behind.
    for y in [-0.30, 0.30] {
        let low = Vec3::new(plate - 0.85, y, floor + 0.02);
        b.bar(metal, low, Vec3::new(plate - 0.40, y, floor + 0.12), [0.09, 0.09], 4);
    }
    l.guards(b, detail);
    let wall = [l.cab_back - 0.30, l.cab_back + 0.05];
    Lorry::both(b, paint, wall, [half.y - 0.20, half.y - 0.10], [0.95, l.cab_top - 0.12]);
    if detail == Detail::Coarse {
        return;
    }
    Lorry::across(b, dark, [plate + 0.45, l.cab_back - 0.05], 0.62, [floor + 0.01, floor + 0.05]);
    let stand = Vec3::new(l.cab_back - 0.12, 0.0, floor + 0.05);
    b.bar(metal, stand, stand.with_z(2.3), [0.05; 2], 6);
    if detail == Detail::Full {
        for (y, rgb) in [(-0.18, [0.5, 0.03, 0.03]), (0.0, [0.04, 0.04, 0.045]), (0.18, [0.5, 0.4, 0.02])] {
            let hose = Lorry::stuff(Surface::Rubber, rgb);
            let line = [
                (Vec3::new(stand.x, y, 2.2), 0.018),
                (Vec3::new(stand.x - 0.22, y, 1.75), 0.018),
                (Vec3::new(stand.x - 0.30, 1.2 * y, 1.45), 0.018),
                (Vec3::new(stand.x - 0.12, y, 1.12), 0.018),
            ];
            crate::actors::pod::tube(b, hose, &line, 5);
        }
        // Air tanks beside the frame, over the guard's front.
        Lorry::both(b, metal, [plate + 0.75, plate + 1.35], [0.45, 0.75], [floor - 0.30, floor - 0.02]);
    }
}
