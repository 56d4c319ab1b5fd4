//! Buses: a hull with rows of windows, doors on the right, a unit on the roof.

use crate::solids::{Detail, MeshBuilder};
use catalogue::{BusBody, Model, Rim, Shape, trains::Train};
use glam::Vec3;
use schema::Tag;
use schema::geometry::{MeshPart, Surface};
use schema::lights;

use crate::actors::cabin::{REAR_DOOR_M, REAR_PANE};
use crate::actors::car::{Car, Looks};
use crate::actors::decal::patch;
use crate::actors::heavy::tall_mirrors;
use crate::actors::hull::Hull;
use crate::actors::pieces::ActorMesh;
use crate::actors::pod::rounded;
use crate::actors::skin::Place;
use crate::actors::wheel::Wheels;

/// A city bus with a low floor.
const CITY: Shape = Shape {
    nose_z: 0.35,
    cowl: (0.003, 0.36),
    roof: (0.030, 0.985),
    deck: (0.997, 0.37),
    tail_z: 0.36,
    windows: (0.035, 0.965),
    pillars: &[0.165, 0.30, 0.435, 0.57, 0.705, 0.84],
    roof_width: 0.93,
    clearance: 0.09,
    rear_glass: false,
    roof_z: 0.935,
    bow_m: [0.20, 0.10],
    glass_bow_m: [0.20, 0.09],
    tuck: 0.006,
    ends_width: [0.93, 0.96],
    nose_lean: &[(0.2, 0.03), (0.4, 0.0), (0.9, 0.01), (1.0, 0.02)],
    tail_lean: &[(0.2, 0.03), (0.4, 0.0), (1.0, 0.01)],
    belt: [0.985, 0.985],
    crown_m: 0.09,
    falls: [0.02, 0.01],
};

/// A coach: passengers sit over their luggage.
const COACH: Shape = Shape {
    nose_z: 0.40,
    cowl: (0.004, 0.42),
    roof: (0.045, 0.985),
    deck: (0.997, 0.45),
    tail_z: 0.44,
    windows: (0.045, 0.955),
    pillars: &[0.20, 0.36, 0.52, 0.68, 0.84],
    roof_width: 0.90,
    roof_z: 0.965,
    bow_m: [0.26, 0.10],
    glass_bow_m: [0.26, 0.09],
    nose_lean: &[(0.2, 0.05), (0.4, 0.0), (0.9, 0.04), (1.0, 0.06)],
    crown_m: 0.13,
    ..CITY
};

/// A school bus behind its bonnet.
const SCHOOL: Shape = Shape {
    nose_z: 0.44,
    cowl: (0.125, 0.485),
    roof: (0.155, 0.985),
    deck: (0.997, 0.47),
    tail_z: 0.45,
    windows: (0.165, 0.965),
    pillars: &[0.255, 0.33, 0.405, 0.48, 0.555, 0.63, 0.705, 0.78, 0.855],
    roof_width: 0.88,
    clearance: 0.13,
    roof_z: 0.97,
    bow_m: [0.16, 0.06],
    glass_bow_m: [0.08, 0.04],
    ends_width: [0.84, 0.96],
    nose_lean: &[(0.2, 0.05), (0.4, 0.0), (0.9, 0.01), (1.0, 0.05)],
    crown_m: 0.16,
    ..CITY
};

/// The rear section of an articulated bus: nobody looks out ahead.
const REAR: Shape = Shape {
    cowl: (0.001, 0.36),
    roof: (0.006, 0.985),
    windows: (0.05, 0.94),
    pillars: &[0.27, 0.50, 0.72],
    bow_m: [0.02, 0.10],
    glass_bow_m: [0.02, 0.09],
    ends_width: [0.985, 0.96],
    nose_lean: &[(0.0, 0.0), (1.0, 0.0)],
    belt: [0.985, 0.985],
    ..CITY
};
/// The front one: it ends upright before its bellows.
const FRONT: Shape = Shape {
    pillars: &[0.20, 0.36, 0.52, 0.68, 0.84],
    bow_m: [0.20, 0.02],
    glass_bow_m: [0.20, 0.02],
    ends_width: [0.93, 0.985],
    tail_lean: &[(0.0, 0.0), (1.0, 0.0)],
    deck: (0.9985, 0.37),
    ..CITY
};
/// Half of the bellows, from either section to where they turn, and half their width; their lower edge and
/// how much lower than the roof they end.
const HALF_BELLOWS_M: f32 = 0.80;
const BELLOWS_Y: f32 = 1.15;
const BELLOWS_Z: [f32; 2] = [0.40, 0.22];

/// A bus, or the section of an articulated one that drives.
pub(crate) fn bus(model: &Model, body: BusBody, size: Vec3) -> ActorMesh {
    let half = 0.5 * size;
    let radius = model.wheel_radius_m as f32;
    let (shape, overhang_m) = match body {
        BusBody::City => (CITY, 2.75),
        BusBody::Coach => (COACH, 2.70),
        BusBody::School => (SCHOOL, 1.05),
        BusBody::ArticulatedFront => (FRONT, 2.75),
        BusBody::ArticulatedRear => (REAR, 2.75),
    };
    let is_front = body == BusBody::ArticulatedFront;
    let back = if is_front { HALF_BELLOWS_M - half.x } else { -half.x };
    let front = half.x - overhang_m;
    let axles = [front, front - model.wheelbase_m as f32];
    let hull = Hull::new(shape, [back, half.x], [half.y, size.z], &axles, radius);
    let wheels =
        Wheels { tag: Tag::Bus, axles: &axles, radius, width: 0.32, outer_y: half.y - 0.07, rim: Rim::Heavy };
    let car = Car { model, hull: &hull, looks: Looks::new(Tag::Bus, model), wheels };
    let made = |detail: Detail| {
        let mut b = MeshBuilder::new();
        car.shell(&mut b, detail);
        car.nose(&mut b, detail);
        if is_front {
            bellows(&mut b, [-half.x, back + 0.05], size.z, detail);
        } else {
            car.tail(&mut b, detail);
        }
        doors(&mut b, &car, detail);
        glass_and_signs(&mut b, &car, detail);
        bands(&mut b, &car, detail);
        on_the_roof(&mut b, &car, size, detail);
        // A bonnet stands before the mirrors.
        let bonnet_m = if body == BusBody::School { half.x - hull.x_of(shape.cowl.0) - 0.22 } else { 0.0 };
        tall_mirrors(&mut b, &hull, &car.looks, half - Vec3::X * bonnet_m, detail);
        let fit = b.fit(Vec3::new(-half.x, -half.y, shape.clearance * size.z), half.with_z(size.z));
        (car.wheels.under(b, detail), fit)
    };
    let on_the_skin = |f: f32, place: Place, left: bool| is_pane(&car, f, place, left);
    ActorMesh::with_cabin(made, |fit| car.cabin(fit, &on_the_skin))
}

/// Folds of an articulated bus's bellows between two places along it.
fn bellows(b: &mut MeshBuilder, x: [f32; 2], high_m: f32, detail: Detail) {
    let rubber = MeshPart::new(Tag::Bus, Surface::Rubber, [0.045, 0.045, 0.048]);
    let folds = match detail {
        Detail::Full => 6,
        Detail::Half => 3,
        Detail::Coarse => 1,
    };
    let z = [BELLOWS_Z[0], high_m - BELLOWS_Z[1]];
    let ring = |x: f32, inset: f32| -> Vec<Vec3> {
        let (y, z0, z1) = (BELLOWS_Y - inset, z[0] + inset, z[1] - inset);
        [(y, z0), (y, z1 - 0.15), (y - 0.15, z1), (0.15 - y, z1), (-y, z1 - 0.15), (-y, z0)]
            .map(|(y, z)| Vec3::new(x, y, z))
            .to_vec()
    };
    let deep = if folds > 1 { 0.05 } else { 0.0 };
    let at = |k: usize| x[0] + (x[1] - x[0]) * k as f32 / (2 * folds) as f32;
    let rings: Vec<Vec<Vec3>> =
        (0..=2 * folds).map(|k| ring(at(k), if k % 2 == 1 { deep } else { 0.0 })).collect();
    b.loft(&rings, |_, _| rubber, [rubber; 2]);
}

/// The rear section of an articulated bus: bellows about the joint, a door, an engine behind.
pub(crate) fn rear_section(train: &Train, size: Vec3) -> ActorMesh {
    let (model, half) = (train.towed, 0.5 * size);
    let radius = model.wheel_radius_m as f32;
    let joint = train.coupling_m as f32;
    let axles = [joint - train.rod_m as f32];
    let nose = joint - HALF_BELLOWS_M;
    let hull = Hull::new(REAR, [-half.x, nose], [half.y, size.z], &axles, radius);
    let wheels =
        Wheels { tag: Tag::Bus, axles: &axles, radius, width: 0.32, outer_y: half.y - 0.07, rim: Rim::Heavy };
    let car = Car { model, hull: &hull, looks: Looks::new(Tag::Bus, model), wheels };
    let made = |detail: Detail| {
        let mut b = MeshBuilder::new();
        car.shell(&mut b, detail);
        car.tail(&mut b, detail);
        bellows(&mut b, [nose - 0.05, joint], size.z, detail);
        // However the sections turn, a drum fills the gap between the two halves of the bellows.
        let rubber = MeshPart::new(Tag::Bus, Surface::Rubber, [0.04, 0.04, 0.042]);
        let foot = Vec3::new(joint, 0.0, BELLOWS_Z[0] + 0.04);
        let high = size.z - BELLOWS_Z[1] - 0.05;
        let sides = if detail == Detail::Full { 32 } else { 16 };
        b.stack(rubber, &[(foot, BELLOWS_Y, BELLOWS_Y), (foot.with_z(high), BELLOWS_Y, BELLOWS_Y)], sides);
        doors(&mut b, &car, detail);
        glass_and_signs(&mut b, &car, detail);
        bands(&mut b, &car, detail);
        on_the_roof(&mut b, &car, size, detail);
        let fit = b.fit(Vec3::new(-half.x, -half.y, REAR.clearance * size.z), half.with_z(size.z));
        (car.wheels.under(b, detail), fit)
    };
    let on_the_skin = |f: f32, place: Place, left: bool| is_pane(&car, f, place, left);
    ActorMesh::with_cabin(made, |fit| car.cabin(fit, &on_the_skin))
}

/// Whether a pane lies on the skin there: those of the doors, and the rear window.
fn is_pane(car: &Car<'_>, f: f32, place: Place, left: bool) -> bool {
    let (hull, style) = (car.hull, &car.hull.style);
    match place {
        Place::Side(row) => {
            let x = hull.x_of(f);
            !left
                && (0.14..1.9).contains(&row)
                && door_places(car).iter().any(|(at, wide)| (x - at).abs() < wide - 0.04)
        }
        Place::Top(s) => {
            let down = (f - style.roof.1) / (style.deck.0 - style.roof.1);
            // Behind the rear section stands the engine.
            !car.model.name.starts_with("bus.articulated")
                && s.abs() < 0.84
                && (REAR_PANE[0]..REAR_PANE[1]).contains(&down)
        }
        _ => false,
    }
}

/// What cools the air, or hatches; flashing lamps of a school bus.
fn on_the_roof(b: &mut MeshBuilder, car: &Car<'_>, size: Vec3, detail: Detail) {
    let half = 0.5 * size;
    let unit = MeshPart::new(Tag::Bus, Surface::Plain, [0.72, 0.72, 0.71]);
    let low = car.hull.style.roof_z * size.z - 0.10;
    let mut boxed = |x: [f32; 2], wide: f32, z: f32, part: MeshPart| {
        let (min, max) = (Vec3::new(x[0] * size.x, -wide, low), Vec3::new(x[1] * size.x, wide, z));
        if detail == Detail::Coarse { b.cuboid(part, min, max) } else { rounded(b, part, min, max, 0.05) }
    };
    match car.model.name {
        "bus.coach" => {
            boxed([-0.16, 0.06], 0.62 * half.y, size.z, car.looks.paint);
            if detail != Detail::Coarse {
                boxed([0.20, 0.26], 0.34 * half.y, size.z - 0.04, unit);
            }
        }
        "bus.school" => {
            if detail != Detail::Coarse {
                boxed([-0.30, -0.24], 0.36 * half.y, size.z - 0.02, car.looks.paint);
            }
            boxed([0.06, 0.12], 0.36 * half.y, size.z, car.looks.paint);
        }
        "bus.articulated_rear" => boxed([-0.30, 0.02], 0.66 * half.y, size.z, unit),
        _ => {
            boxed([-0.30, 0.02], 0.66 * half.y, size.z, unit);
            boxed([0.10, 0.34], 0.66 * half.y, size.z - 0.05, unit);
        }
    }
}

/// Bands along the sides: of a line's colour, of luggage flaps, of a school bus's rails.
fn bands(b: &mut MeshBuilder, car: &Car<'_>, detail: Detail) {
    let (hull, looks) = (car.hull, &car.looks);
    let plain = |rgb: [f32; 3]| MeshPart::new(Tag::Bus, Surface::Plain, rgb);
    let right_from = hull.f_of(door_places(car)[0].0 - door_places(car)[0].1 - 0.05);
    // Clear of the arches.
    let arches: Vec<[f32; 2]> = hull
        .axles
        .iter()
        .map(|x| [x + hull.arch + 0.04, x - hull.arch - 0.04].map(|x| hull.f_of(x)))
        .collect();
    let per_share = match detail {
        Detail::Full => 14.0,
        Detail::Half => 6.0,
        Detail::Coarse => 1.0,
    };
    let mut band = |part: MeshPart, f: [f32; 2], z: [f32; 2], out_m: f32| {
        let over_arches = z[0] > hull.radius + hull.arch + 0.02;
        for left in [true, false] {
            let start = if left { f[0] } else { f[0].max(right_from) };
            let mut spans = vec![[start, f[1]]];
            if !over_arches {
                for [ahead, behind] in &arches {
                    let cut = spans
                        .iter()
                        .flat_map(|[from, to]| [[*from, to.min(*ahead)], [from.max(*behind), *to]]);
                    spans = cut.collect();
                }
            }
            for [from, to] in spans.into_iter().filter(|[from, to]| to - from > 1e-4) {
                let cells = [((to - from) * per_share).ceil().max(1.0) as usize, 1];
                patch(b, part, cells, Vec3::Y * if left { -0.10 } else { 0.10 }, &|u, v| {
                    let out = Vec3::Y * if left { out_m } else { -out_m };
                    hull.side_at(from + (to - from) * u, z[0] + (z[1] - z[0]) * v, left) + out
                });
            }
        }
    };
    let belt = hull.section(0.5).belt_z;
    match car.model.name {
        "bus.school" => {
            let black = plain([0.02, 0.02, 0.02]);
            let rails: &[f32] = if detail == Detail::Full { &[0.62, 0.76, 0.95] } else { &[0.76] };
            for z in rails {
                band(black, [hull.style.cowl.0, 0.97], [z * belt, z * belt + 0.055], 0.012);
            }
        }
        "bus.coach" => {
            band(plain([0.70, 0.70, 0.69]), [0.10, 0.96], [0.86 * belt, 0.95 * belt], 0.006);
            if detail == Detail::Full {
                // Flaps of the luggage room between the axles.
                for x in [0.0, 1.05, 2.10, 3.15].map(|back| hull.axles[0] - 1.1 - back) {
                    for edge in [x, x - 0.95] {
                        band(
                            looks.gap,
                            [hull.f_of(edge + 0.008), hull.f_of(edge - 0.008)],
                            [0.32 * belt, 0.82 * belt],
                            0.004,
                        );
                    }
                }
            }
        }
        _ => {
            let light = plain([0.72, 0.72, 0.70]);
            band(light, [0.10, 0.97], [0.80 * belt, 0.93 * belt], 0.006);
        }
    }
}

/// x of the middles of doors in the right side, and half their widths: where one gets in front, and between
/// the axles.
fn door_places(car: &Car<'_>) -> Vec<(f32, f32)> {
    let hull = car.hull;
    if let [axle] = hull.axles[..] {
        return vec![(axle + REAR_DOOR_M, 0.64)];
    }
    let middle = 0.5 * (hull.axles[0] + hull.axles[1]);
    match car.model.name {
        "bus.coach" => vec![(hull.x[1] - 1.15, 0.46), (middle - 0.9, 0.40)],
        "bus.school" => vec![(hull.x_of(0.21), 0.42), (hull.x_of(0.92), 0.34)],
        _ => vec![(hull.x[1] - 1.25, 0.64), (middle, 0.64)],
    }
}

/// Doors of two leaves.
fn doors(b: &mut MeshBuilder, car: &Car<'_>, detail: Detail) {
    let (hull, looks) = (car.hull, &car.looks);
    for (x, wide) in door_places(car) {
        let mut pane = |part: MeshPart, x: [f32; 2], rows: [f32; 2], out_m: f32| {
            let cells = if detail == Detail::Full { [2, 8] } else { [1, 3] };
            patch(b, part, cells, Vec3::Y * 0.12, &|u, v| {
                let at = hull.section(hull.f_of(x[0] + (x[1] - x[0]) * u));
                hull.side(&at, rows[0] + (rows[1] - rows[0]) * v, false) - Vec3::Y * out_m
            });
        };
        pane(looks.trim, [x - wide, x + wide], [0.06, 1.90], 0.006);
        if detail != Detail::Coarse {
            for leaf in [x - wide + 0.03, x + 0.02] {
                pane(looks.window, [leaf, leaf + wide - 0.05], [0.14, 1.84], 0.012);
            }
        }
    }
}

/// The rear window and the boards that say where it goes.
fn glass_and_signs(b: &mut MeshBuilder, car: &Car<'_>, detail: Detail) {
    let (hull, looks) = (car.hull, &car.looks);
    let ((roof0, roof1), cowl, deck) = (hull.style.roof, hull.style.cowl.0, hull.style.deck.0);
    let mut pane = |part: MeshPart, f: [f32; 2], s: f32, out: Vec3| {
        let cells = if detail == Detail::Full { [6, 3] } else { [2, 1] };
        patch(b, part, cells, -9.0 * out, &|u, v| {
            hull.top(&hull.section(f[0] + (f[1] - f[0]) * v), s * (1.0 - 2.0 * u)) + out
        });
    };
    let sign = looks.lamp(lights::POSITION, [0.75, 0.5, 0.1]);
    let screen = roof0 - cowl;
    if !matches!(car.model.name, "bus.school" | "bus.articulated_rear") {
        pane(looks.gap, [roof0 - 0.28 * screen, roof0 - 0.02 * screen], 0.86, Vec3::X * 0.008);
        pane(sign, [roof0 - 0.23 * screen, roof0 - 0.08 * screen], 0.62, Vec3::X * 0.014);
    }
    if detail != Detail::Coarse && !car.model.name.starts_with("bus.articulated") {
        let rear = deck - roof1;
        pane(looks.window, REAR_PANE.map(|share| roof1 + share * rear), 0.84, Vec3::X * -0.008);
    }
}
