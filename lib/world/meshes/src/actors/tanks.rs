//! Lorries with a machine behind the cab: mixers, tankers, refuse lorries, tow trucks, sweepers.

use crate::solids::{Detail, MeshBuilder};
use frames::math::f32::sin_cos;
use glam::Vec3;
use schema::geometry::Surface;

use crate::actors::load::warning;
use crate::actors::lorry::Lorry;
use crate::actors::pod::{pod, rounded, tube};

const STEEL: [f32; 3] = [0.35, 0.35, 0.36];

fn sides(detail: Detail, full: usize) -> usize {
    match detail {
        Detail::Full => full,
        Detail::Half => (full / 2).max(5),
        Detail::Coarse => 6,
    }
}

/// A drum that leans back, with its blade's line around it, hopper and chute.
pub(crate) fn mixer(l: &Lorry<'_>, b: &mut MeshBuilder, detail: Detail) {
    let (half, front, floor) = (l.half(), l.body_front(), l.body_floor());
    l.spine(b);
    l.guards(b, detail);
    let (paint, dark) = (l.cab.looks.paint, l.cab.looks.trim);
    let metal = Lorry::stuff(Surface::Metal, STEEL);
    let drum = Lorry::stuff(Surface::Plain, [0.70, 0.69, 0.66]);
    let axis = |t: f32| {
        let foot = Vec3::new(front - 0.30, 0.0, floor + 0.98);
        let mouth = Vec3::new(-half.x + 0.95, 0.0, l.size.z - 0.62);
        foot + (mouth - foot) * t
    };
    let widest = half.y - 0.10;
    let shape = [(0.0, 0.62), (0.06, 0.80), (0.28, 1.0), (0.46, 1.0), (0.72, 0.80), (1.0, 0.50)];
    let line: Vec<(Vec3, f32)> = shape.iter().map(|(t, r)| (axis(*t), r * widest)).collect();
    tube(b, drum, &line, sides(detail, 20));
    if detail == Detail::Full {
        // Two bands of paint that go round as the blades inside do.
        let along = (axis(1.0) - axis(0.0)).normalize_or(Vec3::X);
        let (u, v) = (Vec3::Y, along.cross(Vec3::Y));
        for phase in [0.0, 0.5] {
            let steps = 22;
            let at = |k: usize, out: f32| {
                let t = 0.08 + 0.86 * k as f32 / steps as f32;
                let (s, c) = sin_cos(std::f32::consts::TAU * (1.6 * t + phase));
                let r = crate::solids::chain_at(&shape, t) * widest + out;
                axis(t) + (u * c + v * s) * r
            };
            let rings: Vec<Vec<Vec3>> = (0..=steps)
                .map(|k| {
                    let wide = along * 0.07;
                    vec![at(k, -0.05) + wide, at(k, 0.03) + wide, at(k, 0.03) - wide, at(k, -0.05) - wide]
                })
                .collect();
            b.loft(&rings, |_, _| paint, [paint; 2]);
        }
    }
    // What it turns in, before and behind.
    let (low, gear) = (floor - 0.05, axis(0.0));
    rounded(b, dark, Vec3::new(gear.x - 0.05, -0.62, low), Vec3::new(front, 0.62, gear.z + 0.35), 0.04);
    let cradle = axis(0.86);
    for side in [1.0, -1.0] {
        let foot = Vec3::new(cradle.x - 0.1, side * (half.y - 0.30), floor);
        b.bar(metal, foot, cradle + Vec3::new(0.0, side * 0.58, -0.45), [0.09, 0.08], 5);
    }
    // Hopper above, chute below, and the ladder beside them.
    let mouth = axis(1.0);
    let hopper = mouth + Vec3::new(-0.15, 0.0, 0.0);
    b.tapered(
        paint,
        hopper - Vec3::new(0.30, 0.38, 0.05),
        Vec3::new(hopper.x + 0.42, 0.38, l.size.z),
        1.35,
        1.3,
    );
    let chute = [hopper - Vec3::new(0.10, 0.0, 0.45), Vec3::new(-half.x + 0.12, 0.0, floor + 0.45)];
    tube(b, paint, &[(chute[0], 0.26), (chute[1], 0.20)], sides(detail, 10));
    if detail == Detail::Coarse {
        return;
    }
    let water = Vec3::new(front - 0.10, 0.0, l.cab_top - 0.45);
    b.bar(metal, water - Vec3::Y * 0.8, water + Vec3::Y * 0.8, [0.24; 2], sides(detail, 12));
    if detail == Detail::Full {
        let foot = Vec3::new(-half.x + 0.55, -half.y + 0.28, floor);
        let rise = Vec3::new(0.10, 0.0, l.size.z - 0.7 - floor);
        for y in [0.0, 0.36] {
            b.bar(metal, foot + Vec3::Y * y, foot + rise + Vec3::Y * y, [0.022; 2], 5);
        }
        for k in 1..7 {
            let at = foot + rise * (k as f32 / 7.0);
            b.bar(metal, at, at + Vec3::Y * 0.36, [0.016; 2], 4);
        }
    }
}

/// An oval tank with bands, a walkway with a rail, and hoses.
pub(crate) fn tanker(l: &Lorry<'_>, b: &mut MeshBuilder, detail: Detail) {
    let (half, front, floor) = (l.half(), l.body_front(), l.body_floor());
    l.spine(b);
    l.guards(b, detail);
    let (paint, dark) = (l.cab.looks.paint, l.cab.looks.trim);
    let metal = Lorry::stuff(Surface::Metal, STEEL);
    let bright = Lorry::stuff(Surface::Metal, [0.62, 0.63, 0.64]);
    let (ry, rz) = (half.y - 0.06, 0.5 * (l.size.z - 0.40 - floor) + 0.08);
    let (back, z) = (-half.x + 0.16, floor + rz - 0.12);
    let n = sides(detail, 18);
    let at = |x: f32, share: f32| (Vec3::new(x, 0.0, z), share * ry, share * rz);
    pod(
        b,
        bright,
        &[
            at(back, 0.70),
            at(back + 0.06, 0.90),
            at(back + 0.20, 1.0),
            at(front - 0.20, 1.0),
            at(front - 0.06, 0.90),
            at(front, 0.70),
        ],
        n,
    );
    // The company's colour around its middle.
    let (m, w) = (0.5 * (back + front), 0.62);
    let band = |share: f32, x: f32| (Vec3::new(x, 0.0, z), share * ry, share * rz);
    if detail != Detail::Coarse {
        pod(b, paint, &[band(1.004, m - w), band(1.004, m + w)], n);
    }
    if detail == Detail::Full {
        for k in 0..3 {
            let x = back + 0.35 + (front - back - 0.7) * k as f32 / 2.0;
            pod(b, metal, &[band(1.012, x - 0.03), band(1.012, x + 0.03)], n);
        }
    }
    let top = z + rz;
    Lorry::across(b, dark, [back + 0.3, front - 0.3], 0.32, [top - 0.06, top + 0.04]);
    if detail != Detail::Coarse {
        for k in 0..3 {
            let at = Vec3::new(back + 0.8 + (front - back - 1.6) * k as f32 / 2.0, 0.0, top);
            b.bar(metal, at, at + Vec3::Z * 0.13, [0.24, 0.22], sides(detail, 12));
        }
    }
    // The rail beside the walkway.
    let rail = |x: f32| Vec3::new(x, 0.40, l.size.z - 0.025);
    b.bar(metal, rail(back + 0.4), rail(front - 0.4), [0.025; 2], 5);
    for k in 0..4 {
        if detail == Detail::Coarse {
            break;
        }
        let at = rail(back + 0.4 + (front - back - 0.8) * k as f32 / 3.0);
        b.bar(metal, at, at.with_z(top - 0.06), [0.018; 2], 4);
    }
    // Pipes and their box on the sides, and the plate that says what it carries.
    let (x, skirt) = (l.axles[1] + l.radius() + 0.35, [floor - 0.55, floor - 0.02]);
    Lorry::both(b, bright, [x, x + 1.3], [half.y - 0.40, half.y - 0.006], skirt);
    let plate = Lorry::stuff(Surface::Plain, [0.80, 0.26, 0.01]);
    Lorry::across(b, plate, [-half.x + 0.004, -half.x + 0.2], 0.20, [floor - 0.12, floor + 0.18]);
    if detail == Detail::Full {
        for side in [1.0, -1.0] {
            let foot = Vec3::new(back + 0.02, side * 0.25, floor);
            b.bar(metal, foot, foot.with_z(top), [0.02; 2], 5);
            let hose = [
                Vec3::new(x - 0.2, side * (half.y - 0.16), floor - 0.16),
                Vec3::new(x + 1.9, side * (half.y - 0.16), floor - 0.16),
            ];
            b.bar(dark, hose[0], hose[1], [0.075; 2], 8);
        }
        for k in 0..4 {
            let z = floor + 0.20 + 0.40 * k as f32;
            b.bar(metal, Vec3::new(back + 0.02, -0.25, z), Vec3::new(back + 0.02, 0.25, z), [0.015; 2], 4);
        }
    }
}

/// A body that presses what is thrown in behind.
pub(crate) fn refuse(l: &Lorry<'_>, b: &mut MeshBuilder, detail: Detail) {
    let (half, front, floor) = (l.half(), l.body_front(), l.body_floor());
    l.deck(b);
    let looks = &l.cab.looks;
    let white = Lorry::stuff(Surface::Plain, [0.70, 0.70, 0.68]);
    let (paint, dark) = (looks.paint, looks.trim);
    let (wide, top) = (half.y - 0.03, l.size.z - 0.12);
    let hinge = -half.x + 1.95;
    rounded(b, white, Vec3::new(hinge, -wide, floor), Vec3::new(front, wide, top), 0.10);
    // The hopper's slanted shape, from behind to the front.
    let ring = |x: f32, low: f32, high: f32, in_m: f32| -> Vec<Vec3> {
        let w = wide - in_m;
        [(w, low), (w, high - 0.1), (w - 0.1, high), (0.1 - w, high), (-w, high - 0.1), (-w, low)]
            .map(|(y, z)| Vec3::new(x, -y, z))
            .into_iter()
            .rev()
            .map(|p| p * Vec3::new(1.0, -1.0, 1.0))
            .collect()
    };
    let mut rings = vec![
        ring(-half.x + 0.10, floor - 0.16, floor + 0.62, 0.02),
        ring(-half.x + 0.55, floor - 0.22, top - 0.62, 0.02),
        ring(-half.x + 1.10, floor - 0.10, top - 0.10, 0.02),
        ring(hinge + 0.02, floor, l.size.z, 0.0),
    ];
    // Rings run counter-clockwise seen from the front.
    if (rings[0][1] - rings[0][0]).cross(rings[0][2] - rings[0][1]).x < 0.0 {
        rings.iter_mut().for_each(|ring| ring.reverse());
    }
    b.loft(&rings, |_, _| paint, [paint; 2]);
    if detail == Detail::Coarse {
        return;
    }
    // The mouth, and the bar that lifts bins.
    Lorry::across(b, looks.gap, [-half.x + 0.08, -half.x + 0.4], wide - 0.22, [floor + 0.05, floor + 0.55]);
    let bar = Vec3::new(-half.x + 0.05, 0.0, floor + 0.02);
    b.bar(dark, bar - Vec3::Y * (wide - 0.1), bar + Vec3::Y * (wide - 0.1), [0.045; 2], 6);
    Lorry::both(b, dark, [-half.x + 0.02, -half.x + 0.45], [half.y - 0.42, half.y - 0.02], [0.44, 0.49]);
    // A band of the company's colour.
    Lorry::both(
        b,
        paint,
        [hinge + 0.3, front - 0.3],
        [wide - 0.03, wide + 0.014],
        [floor + 0.9, floor + 1.5],
    );
    for k in 0..6 {
        let y = (k as f32 - 3.0) / 3.0 * (wide - 0.05);
        let (min, max) = (
            Vec3::new(-half.x + 0.09, y, floor - 0.15),
            Vec3::new(-half.x + 0.3, y + (wide - 0.05) / 3.0, floor - 0.03),
        );
        b.cuboid(warning(k), min, max);
    }
    for side in [1.0, -1.0] {
        let (foot, head) = (
            Vec3::new(-half.x + 0.7, side * (wide - 0.04), floor + 0.3),
            Vec3::new(hinge - 0.1, side * (wide - 0.04), top - 0.5),
        );
        b.bar(dark, foot, head, [0.06, 0.05], 6);
        if detail == Detail::Full {
            for k in 1..5 {
                let x = hinge + (front - hinge) * k as f32 / 5.0;
                let y = [side * (wide - 0.04), side * (wide + 0.012)];
                b.cuboid(
                    white,
                    Vec3::new(x - 0.05, y[0].min(y[1]), floor + 0.04),
                    Vec3::new(x + 0.05, y[0].max(y[1]), top - 0.12),
                );
            }
            let rail = Vec3::new(-half.x + 0.10, side * (half.y - 0.10), floor + 0.2);
            b.bar(warning(1), rail, rail + Vec3::Z * 0.9, [0.02; 2], 5);
        }
    }
}

/// A low deck with lockers, a boom and a bar that lifts wheels.
pub(crate) fn tow(l: &Lorry<'_>, b: &mut MeshBuilder, detail: Detail) {
    let (half, front, floor) = (l.half(), l.body_front(), l.body_floor());
    l.deck(b);
    let (paint, dark) = (l.cab.looks.paint, l.cab.looks.trim);
    let metal = Lorry::stuff(Surface::Metal, STEEL);
    let shutter = Lorry::stuff(Surface::Metal, [0.50, 0.51, 0.52]);
    let x = [front - 1.75, front];
    rounded(
        b,
        paint,
        Vec3::new(x[0], -half.y + 0.02, floor),
        Vec3::new(x[1], half.y - 0.02, floor + 0.72),
        0.03,
    );
    Lorry::both(
        b,
        shutter,
        [x[0] + 0.12, x[1] - 0.12],
        [half.y - 0.05, half.y - 0.008],
        [floor + 0.12, floor + 0.60],
    );
    rounded(
        b,
        paint,
        Vec3::new(-half.x + 0.04, -half.y + 0.03, floor - 0.05),
        Vec3::new(x[0], half.y - 0.03, floor + 0.22),
        0.03,
    );
    // The boom rises to the rear.
    let foot = Vec3::new(x[0] - 0.1, 0.0, floor + 0.55);
    let head = Vec3::new(-half.x + 0.35, 0.0, l.cab_top - 0.35);
    b.cuboid(dark, Vec3::new(x[0] - 0.5, -0.45, floor + 0.1), Vec3::new(x[0] + 0.1, 0.45, floor + 0.66));
    for y in [-0.22, 0.22] {
        if detail == Detail::Coarse {
            b.bar(paint, foot + Vec3::Y * y, head + Vec3::Y * y, [0.10, 0.08], 3);
            continue;
        }
        b.bar(paint, foot + Vec3::Y * y, head + Vec3::Y * y, [0.10, 0.08], 6);
        b.bar(metal, head + Vec3::new(0.9, y, -0.5), Vec3::new(x[0] - 1.0, y, floor + 0.2), [0.05; 2], 6);
    }

    if detail == Detail::Coarse {
        l.beacons(b, detail);
        return;
    }
    // The lift below.
    b.bar(dark, head - Vec3::Y * 0.3, head + Vec3::Y * 0.3, [0.11; 2], sides(detail, 8));
    b.bar(metal, head, head.with_z(floor + 0.5), [0.015; 2], 4);
    let lift = Vec3::new(-half.x + 0.10, 0.0, 0.50);
    b.bar(paint, Vec3::new(-half.x + 0.45, 0.0, floor), lift, [0.10; 2], 6);
    b.bar(paint, lift - Vec3::Y * 0.8, lift + Vec3::Y * 0.8, [0.07; 2], 6);
    for k in 0..8 {
        let along = (x[0] + half.x - 0.2) / 8.0;
        let at = -half.x + 0.12 + along * k as f32;
        Lorry::both(
            b,
            warning(k),
            [at, at + along],
            [half.y - 0.06, half.y - 0.012],
            [floor + 0.03, floor + 0.15],
        );
    }
    l.beacons(b, detail);
}

/// A hopper with a suction pipe behind, and brushes before it.
pub(crate) fn sweeper(l: &Lorry<'_>, b: &mut MeshBuilder, detail: Detail) {
    let (half, front, floor) = (l.half(), l.body_front(), l.body_floor());
    l.deck(b);
    let (paint, dark) = (l.cab.looks.paint, l.cab.looks.trim);
    let metal = Lorry::stuff(Surface::Metal, STEEL);
    let (wide, top) = (half.y - 0.06, l.cab_top - 0.10);
    rounded(b, paint, Vec3::new(-half.x + 0.62, -wide, floor), Vec3::new(front - 0.7, wide, top), 0.12);
    rounded(
        b,
        dark,
        Vec3::new(front - 0.72, -wide + 0.08, floor),
        Vec3::new(front, wide - 0.08, floor + 1.0),
        0.05,
    );
    // The door of the hopper, and the pipe over it.
    rounded(
        b,
        paint,
        Vec3::new(-half.x + 0.16, -wide + 0.05, floor + 0.06),
        Vec3::new(-half.x + 0.66, wide - 0.05, top - 0.12),
        0.08,
    );
    if detail == Detail::Coarse {
        l.beacons(b, detail);
        return;
    }
    let hose = |x: f32, z: f32| Vec3::new(-half.x + x, 0.55, z);
    tube(
        b,
        dark,
        &[
            (hose(0.9, top + 0.02), 0.13),
            (hose(0.4, top + 0.0), 0.13),
            (hose(0.14, top - 0.3), 0.13),
            (hose(0.14, floor - 0.2), 0.13),
        ],
        sides(detail, 10),
    );
    // Brushes at the kerb and the nozzle between the axles.
    let x = 0.5 * (l.axles[0] + l.axles[1]);
    let bristles = Lorry::stuff(Surface::Cloth, [0.10, 0.16, 0.30]);
    for side in [1.0, -1.0] {
        let foot = Vec3::new(x + 0.25, side * (half.y - 0.42), 0.04);
        b.stack(bristles, &[(foot, 0.40, 0.40), (foot + Vec3::Z * 0.16, 0.22, 0.22)], sides(detail, 16));
        b.stack(
            metal,
            &[(foot + Vec3::Z * 0.15, 0.20, 0.20), (foot + Vec3::Z * 0.22, 0.16, 0.16)],
            sides(detail, 12),
        );
        b.bar(metal, foot + Vec3::Z * 0.2, Vec3::new(x + 0.1, side * 0.42, floor - 0.15), [0.04; 2], 5);
    }
    b.tapered(dark, Vec3::new(x - 0.75, -0.95, 0.06), Vec3::new(x - 0.25, 0.95, 0.34), 0.6, 0.9);
    Lorry::both(
        b,
        dark,
        [-half.x + 0.7, front - 0.75],
        [wide - 0.04, wide + 0.008],
        [floor + 0.10, floor + 0.16],
    );
    for k in 0..8 {
        let y = (k as f32 - 4.0) / 4.0 * (wide - 0.12);
        let (min, max) = (
            Vec3::new(-half.x + 0.15, y, floor + 0.30),
            Vec3::new(-half.x + 0.4, y + (wide - 0.12) / 4.0, floor + 0.46),
        );
        b.cuboid(warning(k), min, max);
    }
    l.beacons(b, detail);
}
