//! Arms and hands. The bones' frames are at the upper joints; everything hangs down.

use std::f32::consts::TAU;

use crate::solids::{Detail, MeshBuilder};
use frames::math::f32::{sin, sin_cos};
use glam::Vec3;
use schema::geometry::{MeshPart, Surface};

use super::shape::{Shaped, Slice, bump, limb, slice, solid, stout};
use super::stuffs::Stuffs;
use crate::people::appearance::{Carried, Hat, Top};
use crate::people::figure::{Figure, Side};

/// Sides of arms: see [`Shaped`].
const SIDES: [usize; 2] = [9, 8];

/// How much wider sleeves are than arms.
fn sleeve(f: &Figure) -> f32 {
    match f.look.top {
        Top::Coat | Top::Jacket => 1.20,
        Top::Hoodie | Top::HiVis => 1.16,
        Top::Suit => 1.12,
        Top::Shirt | Top::Uniform => 1.06,
        Top::Tee | Top::Dress => 1.0,
    }
}

fn short_sleeves(f: &Figure) -> bool {
    matches!(f.look.top, Top::Tee | Top::Dress)
}

/// How far a sleeve's folds stand out, metres: they run askew around the arm, deepest at the elbow.
fn creases(f: &Figure, side: Side, z: f32, angle: f32, deep: f32) -> f32 {
    let loose = (sleeve(f) - 1.0) * 5.0;
    let length = f.upper_arm;
    let turn = 2.0 * side.sign() * angle;
    0.0030 * f.stature * loose * deep * sin(turn + 19.0 * z / length) * (0.7 + 0.3 * sin(angle + 1.0))
}

pub(super) fn upper_arm(b: &mut MeshBuilder, f: &Figure, s: &Stuffs, side: Side) {
    let by = stout(f) * sleeve(f);
    let mut slices = limb(
        f,
        f.upper_arm,
        by,
        &[
            (-1.125, 0.0070, 0.0070, 0.0070),
            (-1.085, 0.0165, 0.0165, 0.0163),
            (-1.000, 0.0233, 0.0233, 0.0230),
            (-0.860, 0.0238, 0.0236, 0.0233),
            (-0.680, 0.0256, 0.0252, 0.0246),
            (-0.480, 0.0290, 0.0280, 0.0262),
            (-0.250, 0.0315, 0.0310, 0.0280),
            (-0.080, 0.0325, 0.0335, 0.0295),
            (0.015, 0.0295, 0.0310, 0.0275),
            (0.065, 0.0235, 0.0250, 0.0215),
            (0.092, 0.0140, 0.0150, 0.0120),
        ],
    );
    // The shoulder slopes into the neck.
    for slice in &mut slices {
        slice.y = -side.sign() * 0.010 * f.stature * ((slice.z / f.upper_arm + 0.10) / 0.19).clamp(0.0, 1.0);
    }
    let relief = |z: f32, angle: f32| {
        let t = z / f.upper_arm;
        creases(f, side, z, angle, bump((t + 0.76) / 0.22) + 0.35 * bump((t + 0.20) / 0.25))
    };
    if !short_sleeves(f) {
        return Shaped { slices: &slices, sides: SIDES, square: 1.0, between: 0, relief: &relief }
            .add(b, |_| s.top);
    }
    let none = |_: f32, _: f32| 0.0;
    let arm: Vec<Slice> = slices.iter().take(7).map(|c| c.wider(0.92)).collect();
    Shaped { slices: &arm, sides: SIDES, square: 1.0, between: 0, relief: &none }.add(b, |_| s.skin);
    // A short sleeve stands off the arm at its hem.
    let hem = [
        Slice { z: slices[4].z + 0.03 * f.upper_arm, ..slices[4].wider(1.16) },
        Slice { z: slices[4].z + 0.10 * f.upper_arm, ..slices[4].wider(1.17) },
    ];
    let cloth: Vec<Slice> = hem.into_iter().chain(slices[5..].iter().map(|c| c.wider(1.07))).collect();
    Shaped { slices: &cloth, sides: SIDES, square: 1.0, between: 0, relief: &none }.add(b, |_| s.top);
}

pub(super) fn forearm(b: &mut MeshBuilder, f: &Figure, s: &Stuffs, side: Side) {
    let (h, length) = (f.stature, f.forearm);
    let bare = short_sleeves(f);
    let slices = if bare {
        limb(
            f,
            length,
            0.92 * stout(f),
            &[
                (-1.000, 0.0155, 0.0155, 0.0130),
                (-0.930, 0.0165, 0.0165, 0.0138),
                (-0.650, 0.0205, 0.0205, 0.0180),
                (-0.300, 0.0262, 0.0255, 0.0228),
                (-0.120, 0.0262, 0.0255, 0.0235),
                (0.000, 0.0229, 0.0230, 0.0227),
                (0.095, 0.0150, 0.0152, 0.0150),
            ],
        )
    } else {
        // The sleeve ends in a cuff and bags over it.
        limb(
            f,
            length,
            stout(f) * sleeve(f),
            &[
                (-0.985, 0.0178, 0.0178, 0.0160),
                (-0.910, 0.0182, 0.0182, 0.0163),
                (-0.880, 0.0210, 0.0208, 0.0188),
                (-0.760, 0.0212, 0.0210, 0.0190),
                (-0.550, 0.0225, 0.0222, 0.0200),
                (-0.300, 0.0240, 0.0238, 0.0220),
                (-0.120, 0.0236, 0.0235, 0.0227),
                (0.000, 0.0229, 0.0230, 0.0227),
                (0.095, 0.0150, 0.0152, 0.0150),
            ],
        )
    };
    let relief = |z: f32, angle: f32| {
        let t = z / length;
        creases(f, side, z, angle, bump((t + 0.22) / 0.20) + 0.75 * bump((t + 0.74) / 0.14))
    };
    Shaped { slices: &slices, sides: SIDES, square: 1.0, between: 0, relief: &relief }.add(b, |k| match k {
        _ if bare => s.skin,
        0 if matches!(f.look.top, Top::Jacket | Top::Hoodie) => s.trim,
        _ => s.top,
    });
    let gloves = matches!(f.look.hat, Hat::FullHelmet) || f.look.top == Top::HiVis;
    let skin = if gloves { s.cloth([0.03, 0.03, 0.03]) } else { s.skin };
    hand(b, f, skin, side);
    if side == Side::Right && f.look.carried == Carried::Phone {
        let glass = MeshPart::new(s.tag, Surface::Plain, [0.02, 0.02, 0.025]);
        let middle = Vec3::new(0.004 * h, -side.sign() * 0.016 * h, -length - 0.62 * f.hand);
        b.cuboid(glass, middle - Vec3::new(0.033, 0.005, 0.070), middle + Vec3::new(0.033, 0.005, 0.070));
    }
}

/// Whether both hands hold a handle that runs across: of a pram, or of what is ridden.
fn holds_across(f: &Figure) -> bool {
    f.look.carried == Carried::Pram || matches!(f.look.hat, Hat::FullHelmet | Hat::BicycleHelmet)
}

/// How far fingers are bent at each of two joints, radians: around what is held, or as they hang.
fn bend(f: &Figure, side: Side) -> f32 {
    let holds = match f.look.carried {
        Carried::Shovel => true,
        Carried::Cane | Carried::Phone => side == Side::Right,
        Carried::Dog => side == Side::Left,
        _ => holds_across(f),
    };
    if holds { 0.85 } else { 0.28 + 0.10 * f.look.face[1] }
}

/// A hand: the palm looks inward, its breadth ahead. Close by it has four fingers and a thumb.
fn hand(b: &mut MeshBuilder, f: &Figure, skin: MeshPart, side: Side) {
    let (h, length) = (f.stature, f.forearm);
    let inward = -side.sign();
    let big = f.hand / 0.104 * if f.look.woman { 0.92 } else { 1.0 };
    let cut = |z: f32, front: f32, back: f32, half: f32, y: f32| {
        slice(-length - z * f.hand, front * big, back * big, half * big).at(0.0, inward * y * h)
    };
    let thumb = |z: f32, x: f32, y: f32| Vec3::new(x * big, inward * y * h, -length - z * f.hand);
    if b.detail() != Detail::Full {
        let mitten = [
            cut(0.930, 0.014, 0.012, 0.0070, 0.012),
            cut(0.760, 0.019, 0.018, 0.0085, 0.006),
            cut(0.500, 0.022, 0.021, 0.0105, 0.001),
            cut(0.250, 0.020, 0.019, 0.0120, 0.000),
            cut(0.050, 0.015, 0.015, 0.0125, 0.000),
            cut(-0.100, 0.013, 0.013, 0.0120, 0.000),
        ];
        solid(b, skin, &mitten, 7);
        b.bar(skin, thumb(0.18, 0.014, 0.003), thumb(0.55, 0.030, 0.010), [0.0085 * h, 0.006 * h], 6);
        return;
    }
    let palm = [
        cut(0.530, 0.0205, 0.0190, 0.0070, 0.000),
        cut(0.480, 0.0225, 0.0210, 0.0090, 0.000),
        cut(0.320, 0.0215, 0.0200, 0.0105, 0.001),
        cut(0.140, 0.0175, 0.0170, 0.0115, 0.001),
        cut(0.020, 0.0140, 0.0140, 0.0110, 0.000),
        cut(-0.120, 0.0125, 0.0125, 0.0105, 0.000),
    ];
    // Around a handle that runs across, the palm looks down and the thumb inward.
    let across = holds_across(f);
    let turned = |p: Vec3| if across { Vec3::new(side.sign() * p.y, -side.sign() * p.x, p.z) } else { p };
    let ring = |slice: &Slice| {
        (0..8).map(|j| turned(slice.at_angle((j as f32 + 0.5) * TAU / 8.0, 0.9))).collect::<Vec<Vec3>>()
    };
    let palm: Vec<Vec<Vec3>> = palm.iter().map(ring).collect();
    b.loft(&palm, |_, _| skin, [skin; 2]);
    // Fingers from the first to the little one.
    let bent = bend(f, side);
    let fingers = [(0.0158, 0.49, 0.42), (0.0055, 0.51, 0.47), (-0.0050, 0.50, 0.44), (-0.0148, 0.47, 0.35)];
    for (number, (x, root, long)) in fingers.into_iter().enumerate() {
        let mut at = Vec3::new(x * big, 0.0, -length - root * f.hand);
        let mut angle = 0.35 * bent + 0.05 * number as f32;
        let mut line = vec![(turned(at), 0.0052)];
        for (share, radius) in [(0.50, 0.0054), (0.50, 0.0036)] {
            let (sin, cos) = sin_cos(angle);
            at += Vec3::new(0.0, inward * sin, -cos) * (share * long * f.hand);
            angle += 1.25 * bent;
            line.push((turned(at), radius));
        }
        finger(b, skin, &line, big);
    }
    let line = [
        (thumb(0.10, 0.0095, 0.001), 0.0080),
        (thumb(0.34, 0.0235, 0.006), 0.0072),
        (thumb(0.62, 0.0265, 0.009 + 0.018 * bent), 0.0042),
    ]
    .map(|(at, radius)| (turned(at), radius));
    finger(b, skin, &line, big);
}

/// A round thing along a line of places with radii, in shares of the stature.
fn finger(b: &mut MeshBuilder, part: MeshPart, line: &[(Vec3, f32)], big: f32) {
    const AROUND: usize = 4;
    let last = line.len() - 1;
    let mut rings: Vec<Vec<Vec3>> = Vec::with_capacity(line.len());
    for (i, (at, radius)) in line.iter().enumerate() {
        let along = (line[(i + 1).min(last)].0 - line[i.saturating_sub(1)].0).normalize_or(Vec3::NEG_Z);
        let u = Vec3::X - along * along.x;
        let u = u.normalize_or(Vec3::X);
        let v = along.cross(u);
        let ring = crate::solids::circle(AROUND).map(|(c, s)| *at + (u * c + v * s) * *radius * big);
        rings.push(ring.collect());
    }
    b.loft(&rings, |_, _| part, [part; 2]);
}
