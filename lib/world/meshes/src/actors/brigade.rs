//! Fire engines: lockers, lights, stripes, ladders.

use crate::solids::{Detail, MeshBuilder};
use catalogue::Load;
use glam::Vec3;
use schema::geometry::{MeshPart, Surface};
use schema::{Tag, lights};

use crate::actors::lorry::Lorry;
use crate::actors::pod::rounded;

/// The body of a fire engine; a ladder lies on its roof, or on a turntable.
pub(crate) fn fire_engine(l: &Lorry<'_>, b: &mut MeshBuilder, detail: Detail) {
    let (half, height, looks) = (l.half(), l.size.z, &l.cab.looks);
    let (front, floor) = (l.body_front(), l.body_floor());
    let turns = l.load == Load::Ladder;
    let top = if turns { l.cab_top - 0.45 } else { height - 0.3 };
    let wide = half.y - 0.02;
    rounded(b, looks.paint, Vec3::new(-half.x + 0.02, -wide, floor), Vec3::new(front, wide, top), 0.04);
    l.deck(b);
    if turns {
        turntable(l, b, top, detail)
    } else {
        roof_ladder(l, b, detail)
    }
    // Beside the ladder's cage, or across the cab.
    let (lamp_y, lamp_z) = if turns { ([0.58, 0.86], l.cab_top + 0.20) } else { ([0.0, 0.7], height) };
    for (side, bits) in [(1.0, lights::EMERGENCY), (-1.0, lights::EMERGENCY_OTHER)] {
        let [y0, y1] = if side > 0.0 { lamp_y } else { [-lamp_y[1], -lamp_y[0]] };
        let (min, max) = (
            Vec3::new(half.x - 1.15, y0 * half.y, l.cab_top - 0.05),
            Vec3::new(half.x - 0.80, y1 * half.y, lamp_z),
        );
        b.tapered(looks.lamp(bits, [0.05, 0.1, 0.8]), min, max, 0.7, 0.97);
    }
    let stripe = MeshPart::new(Tag::Truck, Surface::Reflector, [0.85, 0.85, 0.3]);
    let shutter = MeshPart::new(Tag::Truck, Surface::Metal, [0.5, 0.51, 0.52]);
    for side in [1.0, -1.0] {
        let face = |part: MeshPart, b: &mut MeshBuilder, x: [f32; 2], z: [f32; 2], out_m: f32| {
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
            face(shutter, b, [x + 0.05, x + long - 0.05], [floor + 0.30, top - 0.18], 0.0);
            if detail == Detail::Full {
                for slat in 1..6 {
                    let z = floor + 0.30 + (top - 0.48 - floor) * slat as f32 / 6.0;
                    face(looks.trim, b, [x + 0.06, x + long - 0.06], [z - 0.014, z + 0.014], 0.006);
                }
            }
        }
    }
    back(l, b, top, detail);
}

/// Shutters and warning stripes at the rear.
fn back(l: &Lorry<'_>, b: &mut MeshBuilder, top: f32, detail: Detail) {
    if detail == Detail::Coarse {
        return;
    }
    let (half, floor) = (l.half(), l.body_floor());
    let shutter = Lorry::stuff(Surface::Metal, [0.5, 0.51, 0.52]);
    let yellow = Lorry::stuff(Surface::Reflector, [0.72, 0.62, 0.04]);
    let x = [-half.x + 0.008, -half.x + 0.06];
    Lorry::across(b, shutter, x, 0.62, [floor + 0.15, top - 0.35]);
    for k in 0..5 {
        let z = floor + 0.12 + (top - 0.3 - floor) * k as f32 / 5.0;
        Lorry::both(b, yellow, x, [0.70, half.y - 0.08], [z, z + 0.16]);
    }
}

/// Two rails with rungs on the roof.
fn roof_ladder(l: &Lorry<'_>, b: &mut MeshBuilder, detail: Detail) {
    let (half, height, front) = (l.half(), l.size.z, l.body_front());
    let ladder = Lorry::stuff(Surface::Metal, [0.6, 0.6, 0.62]);
    Lorry::both(b, ladder, [-half.x + 0.1, front], [0.30, 0.40], [height - 0.3, height - 0.12]);
    if detail == Detail::Full {
        for k in 0..((front + half.x - 0.4) / 0.45) as usize {
            let x = -half.x + 0.3 + 0.45 * k as f32;
            Lorry::across(b, ladder, [x, x + 0.05], 0.30, [height - 0.24, height - 0.18]);
        }
    }
}

/// A ladder of two trusses on a turntable, with a cage over the cab.
fn turntable(l: &Lorry<'_>, b: &mut MeshBuilder, top: f32, detail: Detail) {
    let (half, front) = (l.half(), l.body_front());
    let ladder = Lorry::stuff(Surface::Metal, [0.6, 0.6, 0.62]);
    let dark = l.cab.looks.trim;
    let paint = l.cab.looks.paint;
    let pivot = Vec3::new(-half.x + 1.5, 0.0, top - 0.02);
    let around = if detail == Detail::Full { 18 } else { 8 };
    b.bar(dark, pivot, pivot + Vec3::Z * 0.16, [0.85, 0.80], around);
    b.cuboid(paint, pivot + Vec3::new(-0.55, -0.60, 0.14), pivot + Vec3::new(0.35, 0.60, 0.62));
    let (low, high) = (l.cab_top + 0.10, l.size.z - 0.08);
    let bars = if detail == Detail::Coarse { 3 } else { 5 };
    let x = [pivot.x - 0.2, half.x - 0.55];
    for y in [-0.48, 0.48] {
        for (z, thick) in [(low, 0.05), (high, 0.04)] {
            b.bar(ladder, Vec3::new(x[0], y, z), Vec3::new(x[1], y, z), [thick; 2], bars);
        }
        let bays = match detail {
            Detail::Full => 12,
            Detail::Half => 4,
            Detail::Coarse => 0,
        };
        for k in 0..bays {
            let at = |t: usize, z: f32| Vec3::new(x[0] + (x[1] - x[0]) * t as f32 / bays as f32, y, z);
            b.bar(ladder, at(k, low), at(k + 1, high), [0.022; 2], 4);
        }
    }
    let rungs = if detail == Detail::Full { 16 } else { 0 };
    for k in 0..rungs {
        let at = Vec3::new(x[0] + 0.2 + (x[1] - x[0] - 0.3) * k as f32 / rungs as f32, 0.0, low);
        b.bar(ladder, at - Vec3::Y * 0.48, at + Vec3::Y * 0.48, [0.018; 2], 4);
    }
    // The cage hangs before the ladder's head.
    let cage = [x[1] - 0.05, half.x - 0.06];
    Lorry::across(b, dark, cage, 0.70, [l.cab_top + 0.05, l.cab_top + 0.11]);
    Lorry::across(b, ladder, [cage[1] - 0.04, cage[1]], 0.70, [high - 0.08, l.size.z]);
    if detail == Detail::Coarse {
        return;
    }
    Lorry::both(b, ladder, cage, [0.66, 0.70], [high - 0.08, l.size.z]);
    Lorry::both(b, ladder, [cage[1] - 0.04, cage[1]], [0.66, 0.70], [l.cab_top + 0.05, l.size.z]);
    if detail == Detail::Full {
        // Outriggers and steps between the axles.
        for share in [0.25, 0.75] {
            let at = -half.x + 0.9 + share * (front + half.x - 1.6);
            Lorry::both(b, dark, [at - 0.12, at + 0.12], [half.y - 0.35, half.y - 0.03], [0.62, 1.02]);
        }
    }
}
