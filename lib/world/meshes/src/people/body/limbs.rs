//! Arms and legs. The bones' frames are at the upper joints; everything hangs down.

use crate::solids::{Detail, MeshBuilder};
use glam::Vec3;
use schema::geometry::{MeshPart, Surface};

use super::shape::{Slice, lofted, round, slice, solid};
use super::stuffs::Stuffs;
use crate::people::appearance::{Bottom, Build, Carried, Hat, Top};
use crate::people::figure::{Figure, Side};

const SIDES: usize = 8;

/// How thick limbs are.
fn stout(f: &Figure) -> f32 {
    let build = match f.look.build {
        Build::Slim => 0.90,
        Build::Average => 1.0,
        Build::Heavy => 1.14,
    };
    build * if f.look.woman { 0.92 } else { 1.0 }
}

fn sleeve(f: &Figure) -> f32 {
    match f.look.top {
        Top::Coat | Top::Jacket => 1.20,
        Top::Hoodie | Top::HiVis | Top::Suit => 1.14,
        Top::Shirt | Top::Uniform => 1.05,
        Top::Tee | Top::Dress => 1.0,
    }
}

fn short_sleeves(f: &Figure) -> bool {
    matches!(f.look.top, Top::Tee | Top::Dress)
}

/// Slices of a limb in shares of its length and of the stature: a half ball below, so that the joint shows no
/// gap.
fn limb(f: &Figure, length: f32, by: f32, shape: &[(f32, f32, f32, f32)]) -> Vec<Slice> {
    let h = f.stature;
    shape
        .iter()
        .map(|(z, front, back, half)| slice(z * length, front * h, back * h, half * h).wider(by))
        .collect()
}

pub(super) fn upper_arm(b: &mut MeshBuilder, f: &Figure, s: &Stuffs) {
    let by = stout(f) * sleeve(f);
    let slices = limb(
        f,
        f.upper_arm,
        by,
        &[
            (-1.100, 0.010, 0.010, 0.010),
            (-1.060, 0.018, 0.018, 0.018),
            (-1.000, 0.0235, 0.0235, 0.0235),
            (-0.750, 0.0255, 0.025, 0.0245),
            (-0.500, 0.0285, 0.0275, 0.026),
            (-0.250, 0.0315, 0.031, 0.028),
            (-0.080, 0.0330, 0.034, 0.0300),
            (0.020, 0.0295, 0.031, 0.0270),
            (0.085, 0.0215, 0.023, 0.0190),
            (0.120, 0.0100, 0.011, 0.0090),
        ],
    );
    if short_sleeves(f) {
        let arm: Vec<Slice> = slices.iter().take(6).map(|c| c.wider(0.92)).collect();
        solid(b, s.skin, &arm, SIDES);
        solid(b, s.top, &slices[3..].iter().map(|c| c.wider(1.06)).collect::<Vec<_>>(), SIDES);
    } else {
        solid(b, s.top, &slices, SIDES);
    }
}

pub(super) fn forearm(b: &mut MeshBuilder, f: &Figure, s: &Stuffs, side: Side) {
    let (h, length) = (f.stature, f.forearm);
    let thick = if short_sleeves(f) { 0.92 } else { sleeve(f) };
    let wrist = if short_sleeves(f) { 0.0155 } else { 0.019 };
    let slices = limb(
        f,
        length,
        stout(f) * thick,
        &[
            (-1.000, wrist, wrist, 0.93 * wrist),
            (-0.930, 0.0185, 0.0185, 0.0165),
            (-0.650, 0.0215, 0.0215, 0.019),
            (-0.300, 0.0255, 0.025, 0.0225),
            (-0.060, 0.0245, 0.0245, 0.0235),
            (0.060, 0.019, 0.019, 0.019),
            (0.110, 0.010, 0.010, 0.010),
        ],
    );
    solid(b, if short_sleeves(f) { s.skin } else { s.top }, &slices, SIDES);
    let gloves = matches!(f.look.hat, Hat::FullHelmet) || f.look.top == Top::HiVis;
    let skin = if gloves { s.cloth([0.03, 0.03, 0.03]) } else { s.skin };
    // The palm looks inward, its breadth ahead; the fingers are bent a little.
    let inward = -side.sign();
    let big = f.hand / 0.104 * if f.look.woman { 0.92 } else { 1.0 };
    let cut = |z: f32, front: f32, back: f32, half: f32, y: f32| {
        slice(-length - z * f.hand, front * big, back * big, half * big).at(0.0, inward * y * h)
    };
    let hand = [
        cut(0.990, 0.009, 0.007, 0.0045, 0.010),
        cut(0.930, 0.015, 0.013, 0.0070, 0.008),
        cut(0.760, 0.019, 0.018, 0.0085, 0.004),
        cut(0.500, 0.022, 0.021, 0.0100, 0.001),
        cut(0.250, 0.020, 0.019, 0.0120, 0.000),
        cut(0.050, 0.015, 0.015, 0.0125, 0.000),
        cut(-0.100, 0.013, 0.013, 0.0120, 0.000),
    ];
    solid(b, skin, &hand, 7);
    let base = Vec3::new(0.014 * h, inward * 0.003 * h, -length - 0.18 * f.hand);
    let tip = Vec3::new(0.030 * h, inward * 0.010 * h, -length - 0.55 * f.hand);
    b.bar(skin, base, tip, [0.0085 * h, 0.006 * h], 6);
    if side == Side::Right && f.look.carried == Carried::Phone {
        let glass = MeshPart::new(s.tag, Surface::Plain, [0.02, 0.02, 0.025]);
        let middle = Vec3::new(0.004 * h, inward * 0.016 * h, -length - 0.62 * f.hand);
        b.cuboid(glass, middle - Vec3::new(0.033, 0.005, 0.070), middle + Vec3::new(0.033, 0.005, 0.070));
    }
}

/// How thick thighs are.
fn thighs(f: &Figure) -> f32 {
    stout(f) * if f.look.woman { 1.10 } else { 1.0 }
}

/// How far behind its axis a trousers' leg reaches below the hip, and before it at the middle, metres: of
/// somebody who sits these are its lower and its upper side.
pub(crate) fn thigh_reach_m(f: &Figure) -> [f32; 2] {
    [0.057, 0.044].map(|share| 1.06 * share * thighs(f) * f.stature)
}

pub(super) fn thigh(b: &mut MeshBuilder, f: &Figure, s: &Stuffs, side: Side) {
    let by = thighs(f);
    let shape = [
        (-1.095, 0.012, 0.012, 0.012),
        (-1.060, 0.023, 0.022, 0.022),
        (-1.000, 0.0310, 0.0290, 0.0295),
        (-0.850, 0.0340, 0.0310, 0.0320),
        (-0.600, 0.0410, 0.0400, 0.0380),
        (-0.300, 0.0480, 0.0490, 0.0450),
        (-0.080, 0.0490, 0.0570, 0.0475),
        (0.070, 0.0420, 0.0540, 0.0420),
        (0.160, 0.0260, 0.0360, 0.0260),
    ];
    let slices = limb(f, f.thigh, by, &shape);
    match f.look.bottom {
        Bottom::Trousers => {
            let loose: Vec<Slice> = slices.iter().map(|c| c.wider(1.06)).collect();
            solid(b, s.bottom, &loose, SIDES);
        }
        Bottom::Shorts => {
            solid(b, s.skin, &slices, SIDES);
            let hem = Slice { z: -0.80 * f.thigh, ..slices[4].wider(1.12) };
            let leg: Vec<Slice> =
                std::iter::once(hem).chain(slices[4..].iter().map(|c| c.wider(1.09))).collect();
            solid(b, s.bottom, &leg, SIDES);
        }
        Bottom::Skirt => {
            solid(b, s.skin, &slices, SIDES);
            hang(b, f, s.bottom, side, [0.92, 0.066, 0.078]);
        }
    }
    if f.look.top == Top::Coat {
        hang(b, f, s.top, side, [0.66, 0.066, 0.084]);
    }
}

/// A leg's half of a skirt or a coat's tails: `[length, front, back]`, the length as a share of the thigh's.
fn hang(b: &mut MeshBuilder, f: &Figure, part: MeshPart, side: Side, [length, front, back]: [f32; 3]) {
    let (h, g) = (f.stature, f.look.girth());
    let middle = -side.sign() * (f.hip_y - 0.026 * h);
    let half = if f.look.woman { 0.096 } else { 0.092 } * g * h;
    let cut = |z: f32, by: f32| slice(z, front * h * by * g, back * h * by, half * by).at(0.0, middle);
    let hem = -length * f.thigh;
    let slices = [cut(hem, 1.08), cut(0.5 * hem, 1.03), cut(-0.03 * h, 0.97), cut(0.02 * h, 0.84)];
    lofted(b, &slices, 10, 0.95, |_, _| part);
}

pub(super) fn shin(b: &mut MeshBuilder, f: &Figure, s: &Stuffs) {
    let h = f.stature;
    let bare = f.look.bare_legs();
    let shape: &[(f32, f32, f32, f32)] = if bare {
        &[
            (-1.060, 0.014, 0.016, 0.014),
            (-1.000, 0.0175, 0.020, 0.0175),
            (-0.850, 0.0185, 0.0215, 0.0185),
            (-0.600, 0.0230, 0.0300, 0.0250),
            (-0.300, 0.0275, 0.0370, 0.0310),
            (-0.100, 0.0290, 0.0320, 0.0300),
            (0.000, 0.0300, 0.0280, 0.0295),
            (0.060, 0.0240, 0.0210, 0.0230),
            (0.095, 0.0120, 0.0110, 0.0120),
        ]
    } else {
        &[
            (-1.030, 0.0270, 0.0330, 0.0285),
            (-0.900, 0.0270, 0.0330, 0.0285),
            (-0.600, 0.0280, 0.0355, 0.0300),
            (-0.300, 0.0305, 0.0395, 0.0335),
            (-0.100, 0.0320, 0.0345, 0.0325),
            (0.000, 0.0325, 0.0305, 0.0318),
            (0.060, 0.0260, 0.0230, 0.0250),
            (0.095, 0.0130, 0.0120, 0.0130),
        ]
    };
    let slices = limb(f, f.shin, stout(f), shape);
    solid(b, if bare { s.skin } else { s.bottom }, &slices, SIDES);
    if bare && f.look.bottom == Bottom::Shorts {
        // Socks.
        let sock =
            [round(-1.04 * f.shin, 0.020 * h), slice(-0.80 * f.shin, 0.0205 * h, 0.024 * h, 0.0205 * h)];
        solid(b, s.cloth([0.5, 0.5, 0.48]), &sock, SIDES);
    }
}

pub(super) fn foot(b: &mut MeshBuilder, f: &Figure, s: &Stuffs) {
    let (h, a) = (f.stature, f.ankle);
    // Far away it is a foot with toes.
    let long = if b.detail() == Detail::Coarse { (f.toe - 0.012 * h) / (0.060 * h) } else { 1.0 };
    let cut = |z: f32, front: f32, back: f32, half: f32| {
        slice(z * a, long * front * h, back * h, half * h).at(0.012 * h, 0.0)
    };
    let sole = MeshPart::new(s.tag, Surface::Rubber, f.look.shoe_rgb.map(|c| 0.35 * c));
    let slices = [
        cut(-1.00, 0.058, 0.051, 0.0230),
        cut(-0.86, 0.060, 0.054, 0.0255),
        cut(-0.62, 0.058, 0.052, 0.0250),
        cut(-0.38, 0.044, 0.046, 0.0235),
        cut(-0.10, 0.020, 0.040, 0.0215),
        cut(0.22, 0.010, 0.034, 0.0190),
    ];
    lofted(b, &slices, 9, 0.85, |k, _| if k == 0 { sole } else { s.shoe });
}

pub(super) fn toes(b: &mut MeshBuilder, f: &Figure, s: &Stuffs) {
    if b.detail() == Detail::Coarse {
        return;
    }
    let (h, a) = (f.stature, f.ankle);
    let tip = f.toe - f.ball;
    let cut = |z: f32, front: f32, back: f32, half: f32| slice(z * a, front * tip, back * h, half * h);
    let sole = MeshPart::new(s.tag, Surface::Rubber, f.look.shoe_rgb.map(|c| 0.35 * c));
    let slices = [
        cut(-0.25, 0.93, 0.022, 0.0235),
        cut(-0.12, 1.00, 0.026, 0.0265),
        cut(0.08, 0.86, 0.028, 0.0250),
        cut(0.24, 0.50, 0.026, 0.0200),
        cut(0.32, 0.20, 0.016, 0.0110),
    ];
    lofted(b, &slices, 9, 0.85, |k, _| if k == 0 { sole } else { s.shoe });
}
