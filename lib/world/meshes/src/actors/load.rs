//! Lorries that carry goods: boxes, curtains, decks, tippers.

use crate::solids::{Detail, MeshBuilder};
use glam::Vec3;
use schema::geometry::{MeshPart, Surface};

use crate::actors::lorry::Lorry;
use crate::actors::pod::rounded;

const WHITE: [f32; 3] = [0.72, 0.72, 0.70];
const STEEL: [f32; 3] = [0.35, 0.35, 0.36];

/// A box, smooth or with ribs, with a panel of the company's colour on its sides.
pub(crate) fn goods(l: &Lorry<'_>, b: &mut MeshBuilder, ribbed: bool, detail: Detail) {
    let (half, paint) = (l.half(), l.cab.looks.paint);
    let (floor, front, top) = (l.body_floor(), l.body_front(), l.size.z);
    let white = Lorry::stuff(Surface::Plain, WHITE);
    let wide = half.y - 0.012;
    rounded(b, white, Vec3::new(-half.x + 0.02, -wide, floor), Vec3::new(front, wide, top), 0.04);
    l.deck(b);
    // The panel with a mark of two strips: seen from near and far.
    let (x, z) = ([-half.x + 0.75, front - 0.55], [floor + 0.55, top - 0.45]);
    Lorry::both(b, paint, x, [wide - 0.02, wide + 0.003], z);
    if detail != Detail::Coarse {
        let long = x[1] - x[0];
        let mark = [x[0] + 0.18 * long, x[0] + 0.60 * long];
        for (share, part) in [(0.30, white), (0.52, white)] {
            let low = z[0] + share * (z[1] - z[0]);
            Lorry::both(
                b,
                part,
                [mark[0] + 0.25 * share * long, mark[1]],
                [wide - 0.02, wide + 0.006],
                [low, low + 0.10 * (z[1] - z[0])],
            );
        }
    }
    if ribbed && detail == Detail::Full {
        let count = ((front + half.x) / 0.62) as usize;
        for k in 1..count {
            let x = -half.x + (front + half.x) * k as f32 / count as f32;
            Lorry::both(
                b,
                white,
                [x - 0.03, x + 0.03],
                [wide - 0.03, half.y - 0.001],
                [floor + 0.05, top - 0.08],
            );
        }
    }
    rear_doors(l, b, top, detail);
    edges(l, b, top, detail);
}

/// Edges of metal along a box.
fn edges(l: &Lorry<'_>, b: &mut MeshBuilder, top: f32, detail: Detail) {
    let (half, front) = (l.half(), l.body_front());
    if detail == Detail::Full {
        let metal = Lorry::stuff(Surface::Metal, STEEL);
        for z in [l.body_floor() + 0.03, top - 0.06] {
            Lorry::both(
                b,
                metal,
                [-half.x + 0.07, front - 0.05],
                [half.y - 0.024, half.y],
                [z - 0.03, z + 0.03],
            );
        }
        for x in [-half.x + 0.05, front - 0.05] {
            Lorry::both(
                b,
                metal,
                [x - 0.03, x + 0.03],
                [half.y - 0.026, half.y - 0.001],
                [l.body_floor() + 0.03, top - 0.06],
            );
        }
    }
}

/// Doors at the rear: where they meet, their bars with handles, hinges.
pub(crate) fn rear_doors(l: &Lorry<'_>, b: &mut MeshBuilder, top: f32, detail: Detail) {
    if detail == Detail::Coarse {
        return;
    }
    let (half, floor, looks) = (l.half(), l.body_floor(), &l.cab.looks);
    let metal = Lorry::stuff(Surface::Metal, STEEL);
    let back = -half.x;
    Lorry::across(b, looks.gap, [back + 0.012, back + 0.05], 0.010, [floor + 0.06, top - 0.06]);
    for y in [-0.72, -0.24, 0.24, 0.72].map(|share| share * half.y) {
        let foot = Vec3::new(back + 0.016, y, floor + 0.03);
        if detail == Detail::Half {
            b.cuboid(
                metal,
                foot - Vec3::new(0.012, 0.02, 0.0),
                (foot + Vec3::new(0.01, 0.02, 0.0)).with_z(top - 0.05),
            );
            continue;
        }
        b.bar(metal, foot, foot.with_z(top - 0.05), [0.021; 2], 5);
        let grip = foot.with_z(floor + 0.75);
        b.bar(metal, grip, grip + Vec3::Y * 0.28 * -y.signum(), [0.014; 2], 5);
    }
    if detail == Detail::Full {
        for z in [0.12, 0.5, 0.88].map(|share| floor + share * (top - floor)) {
            Lorry::both(
                b,
                looks.gap,
                [back + 0.004, back + 0.06],
                [half.y - 0.16, half.y - 0.03],
                [z - 0.04, z + 0.04],
            );
        }
    }
}

/// Curtains on straps between a front wall and rear doors.
pub(crate) fn curtain(l: &Lorry<'_>, b: &mut MeshBuilder, detail: Detail) {
    let (half, looks) = (l.half(), &l.cab.looks);
    let (floor, front, top) = (l.body_floor(), l.body_front(), l.size.z);
    let white = Lorry::stuff(Surface::Plain, WHITE);
    let cloth = Lorry::stuff(Surface::Cloth, [0.04, 0.13, 0.33]);
    let bright = Lorry::stuff(Surface::Cloth, [0.62, 0.62, 0.60]);
    let wide = half.y - 0.012;
    let x = [-half.x + 0.14, front - 0.12];
    rounded(
        b,
        white,
        Vec3::new(-half.x + 0.02, -wide + 0.03, floor),
        Vec3::new(front, wide - 0.03, top),
        0.03,
    );
    Lorry::both(b, cloth, x, [wide - 0.06, wide - 0.004], [floor - 0.10, top - 0.14]);
    Lorry::both(b, bright, [x[0] + 0.9, x[1] - 0.9], [wide - 0.05, wide], [floor + 0.95, floor + 1.45]);
    for (at, deep) in [(-half.x + 0.07, 0.07), (front - 0.06, 0.06)] {
        if detail == Detail::Coarse {
            break;
        }
        Lorry::both(
            b,
            white,
            [at - deep + 0.02, at + deep],
            [wide - 0.05, wide + 0.002],
            [floor, top - 0.02],
        );
    }
    Lorry::both(b, white, [-half.x + 0.02, front], [wide - 0.05, half.y], [top - 0.16, top - 0.03]);
    l.deck(b);
    if detail == Detail::Full {
        let count = ((x[1] - x[0]) / 0.55) as usize;
        for k in 0..count {
            let at = x[0] + (x[1] - x[0]) * (k as f32 + 0.5) / count as f32;
            Lorry::both(
                b,
                looks.trim,
                [at - 0.022, at + 0.022],
                [wide - 0.03, half.y - 0.001],
                [floor - 0.14, floor + 0.42],
            );
        }
    }
    rear_doors(l, b, top, detail);
}

/// A deck of boards behind a headboard.
fn boards(l: &Lorry<'_>, b: &mut MeshBuilder, headboard_m: f32) {
    let (half, floor, front) = (l.half(), l.body_floor(), l.body_front());
    l.deck(b);
    let wood = Lorry::stuff(Surface::Wood, [0.20, 0.13, 0.075]);
    Lorry::across(b, wood, [-half.x + 0.04, front - 0.04], half.y - 0.06, [floor - 0.02, floor + 0.03]);
    let metal = Lorry::stuff(Surface::Metal, STEEL);
    Lorry::across(b, metal, [front - 0.08, front - 0.02], half.y - 0.03, [floor, floor + headboard_m]);
}

/// An open deck with stakes and bundles of timber.
pub(crate) fn flatbed(l: &Lorry<'_>, b: &mut MeshBuilder, detail: Detail) {
    let (half, floor, front) = (l.half(), l.body_floor(), l.body_front());
    boards(l, b, 1.25);
    let metal = Lorry::stuff(Surface::Metal, [0.12, 0.12, 0.125]);
    let strap = Lorry::stuff(Surface::Cloth, [0.55, 0.28, 0.02]);
    let long = (front + half.x - 0.9) / 2.0;
    for k in 0..2 {
        let x = -half.x + 0.30 + k as f32 * (long + 0.15);
        let high = [0.85, 1.05][k];
        for (row, y) in [-0.56, 0.56].into_iter().enumerate() {
            let wood = Lorry::stuff(Surface::Wood, [[0.42, 0.29, 0.15], [0.36, 0.25, 0.13]][(k + row) % 2]);
            let (min, max) =
                (Vec3::new(x, y - 0.53, floor + 0.12), Vec3::new(x + long, y + 0.53, floor + high));
            b.cuboid(wood, min, max);
            if detail == Detail::Full {
                for layer in 1..4 {
                    let z = min.z + (max.z - min.z) * layer as f32 / 4.0;
                    b.cuboid(l.cab.looks.gap, min.with_z(z - 0.02) - Vec3::X * 0.004, max.with_z(z));
                }
            }
        }
        if detail != Detail::Coarse {
            for share in [0.2, 0.8] {
                let at = x + share * long;
                Lorry::across(b, strap, [at - 0.03, at + 0.03], 1.10, [floor + 0.02, floor + high + 0.012]);
            }
        }
    }
    if detail == Detail::Full {
        for k in 0..6 {
            let x = -half.x + 0.4 + (front + half.x - 0.9) * k as f32 / 5.0;
            Lorry::both(
                b,
                metal,
                [x - 0.04, x + 0.04],
                [half.y - 0.075, half.y - 0.012],
                [floor - 0.1, floor + 0.75],
            );
        }
    }
}

/// Boards around a deck, and a rack for ladders over the cab.
pub(crate) fn dropside(l: &Lorry<'_>, b: &mut MeshBuilder, detail: Detail) {
    let (half, floor, front) = (l.half(), l.body_floor(), l.body_front());
    boards(l, b, 1.0);
    let alloy = Lorry::stuff(Surface::Metal, [0.55, 0.56, 0.57]);
    let dark = Lorry::stuff(Surface::Metal, [0.10, 0.10, 0.105]);
    let (back, high) = (-half.x + 0.02, floor + 0.42);
    Lorry::both(b, alloy, [back, front - 0.1], [half.y - 0.045, half.y - 0.008], [floor - 0.02, high]);
    Lorry::across(b, alloy, [back, back + 0.04], half.y - 0.02, [floor - 0.02, high]);
    let ridges = if detail == Detail::Full { 2 } else { 0 };
    for k in 0..ridges {
        let z = floor + 0.13 + 0.14 * k as f32;
        Lorry::both(
            b,
            l.cab.looks.gap,
            [back + 0.02, front - 0.12],
            [half.y - 0.02, half.y - 0.006],
            [z - 0.012, z + 0.012],
        );
    }
    if detail != Detail::Coarse {
        for share in [0.0, 0.5, 1.0] {
            let x = back + 0.05 + share * (front - 0.25 - back);
            Lorry::both(
                b,
                dark,
                [x - 0.04, x + 0.04],
                [half.y - 0.03, half.y - 0.001],
                [floor - 0.06, high + 0.02],
            );
        }
    }
    // What is carried: a heap of sand and a box of tools.
    if detail != Detail::Coarse {
        let sand = Lorry::stuff(Surface::Gravel, [0.34, 0.26, 0.16]);
        let around = if detail == Detail::Full { 14 } else { 7 };
        let (x, long, wide) = (-0.30 * half.x - 0.4, 0.26 * l.size.x, half.y - 0.12);
        let layer = |up: f32, share: f32| (Vec3::new(x, 0.0, floor + up), share * long, share * wide);
        b.stack(sand, &[layer(0.0, 1.0), layer(0.18, 0.86), layer(0.31, 0.52), layer(0.37, 0.12)], around);
        let tools = l.cab.looks.trim;
        rounded(
            b,
            tools,
            Vec3::new(front - 0.75, -half.y + 0.12, floor),
            Vec3::new(front - 0.14, half.y - 0.12, floor + 0.62),
            0.03,
        );
    }
    // The rack.
    let top = l.size.z - 0.03;
    let ends = [front - 0.05, half.x - 0.75];
    let around = if detail == Detail::Coarse { 3 } else { 5 };
    for y in [-0.62, 0.62] {
        b.bar(dark, Vec3::new(ends[0], y, top), Vec3::new(ends[1], y, top), [0.03; 2], around);
        b.bar(dark, Vec3::new(ends[0], y, floor + 0.9), Vec3::new(ends[0], y, top), [0.03; 2], around);
    }
    for x in ends {
        b.bar(dark, Vec3::new(x, -0.62, top), Vec3::new(x, 0.62, top), [0.03; 2], around);
    }
}

/// A tub with ribs, full of gravel, and the plate that keeps it off the cab.
pub(crate) fn tipper(l: &Lorry<'_>, b: &mut MeshBuilder, detail: Detail) {
    let (half, front, looks) = (l.half(), l.body_front(), &l.cab.looks);
    l.deck(b);
    let floor = l.body_floor() + 0.06;
    let high = floor + 1.15;
    let paint = looks.paint;
    let gravel = Lorry::stuff(Surface::Gravel, [0.24, 0.22, 0.20]);
    let back = -half.x + 0.06;
    // Wider above; the tail gate leans out.
    let ring = |z: f32, out: f32, lean: f32| -> Vec<Vec3> {
        let wide = half.y - 0.12 + out;
        [(back + lean, -wide), (front, -wide), (front, wide), (back + lean, wide)]
            .map(|(x, y)| Vec3::new(x, y, z))
            .to_vec()
    };
    b.loft(&[ring(floor, 0.0, 0.22), ring(high, 0.10, 0.0)], |_, _| paint, [paint, gravel]);
    let rim = |b: &mut MeshBuilder, x: [f32; 2], y: [f32; 2]| {
        Lorry::both(b, paint, x, y, [high - 0.04, high + 0.10])
    };
    rim(b, [back, front], [half.y - 0.10, half.y - 0.004]);
    Lorry::across(b, paint, [back, back + 0.09], half.y - 0.02, [high - 0.04, high + 0.10]);
    Lorry::across(b, paint, [front - 0.09, front], half.y - 0.02, [high - 0.04, high + 0.32]);
    let (rings, around) = if detail == Detail::Full { (8, 18) } else { (3, 6) };
    let middle = Vec3::new(0.5 * (back + front), 0.0, high - 0.10);
    b.blob(
        gravel,
        middle,
        Vec3::new(0.44 * (front - back), half.y - 0.16, 0.42),
        rings,
        around,
        |ring, side| 1.0 + 0.06 * (((ring * 7 + side * 5) % 11) as f32 / 5.5 - 1.0),
    );
    // The plate over the cab.
    let plate = l.cab_top + 0.02;
    Lorry::across(b, paint, [front - 0.06, front], half.y - 0.06, [high, plate + 0.02]);
    Lorry::across(b, paint, [front - 0.06, l.cab_back + 0.55], half.y - 0.10, [plate, l.size.z]);
    if detail == Detail::Full {
        for k in 0..7 {
            let x = back + 0.45 + (front - back - 0.7) * k as f32 / 6.0;
            for side in [1.0, -1.0] {
                let at = |z: f32, out: f32| Vec3::new(x, side * (half.y - 0.12 + out), z);
                b.bar(paint, at(floor, 0.0), at(high, 0.07), [0.05, 0.04], 4);
            }
        }
        let metal = Lorry::stuff(Surface::Metal, STEEL);
        for y in [-0.8, 0.8] {
            let hinge = Vec3::new(back + 0.02, y, high + 0.05);
            b.bar(metal, hinge - Vec3::Y * 0.09, hinge + Vec3::Y * 0.09, [0.05; 2], 8);
        }
        let ram = Vec3::new(back + 0.25, 0.0, l.body_floor() - 0.1);
        b.bar(metal, ram, (ram + Vec3::X * 0.6).with_z(floor), [0.07; 2], 8);
    }
}

/// What a strip of warning colours is made of: red and white in turn.
pub(crate) fn warning(k: usize) -> MeshPart {
    Lorry::stuff(Surface::Plain, [[0.62, 0.03, 0.03], [0.75, 0.75, 0.73]][k % 2])
}
