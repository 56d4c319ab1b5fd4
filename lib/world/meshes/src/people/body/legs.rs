//! Legs with what is worn on them. The bones' frames are at the upper joints; everything hangs down.

use std::f32::consts::PI;

use crate::solids::MeshBuilder;
use frames::math::f32::{cos, sin};
use schema::geometry::MeshPart;

use super::shape::{Shaped, Slice, apart, bump, cloth, limb, round, slice, solid, stout};
use super::stuffs::Stuffs;
use crate::people::appearance::{Bottom, Shoe, Top};
use crate::people::figure::{Figure, Side};

/// Sides of legs: see [`Shaped`].
const SIDES: [usize; 2] = [9, 8];
/// How much wider trousers are than thighs, at the widest place.
const TROUSERS: f32 = 1.06;

/// How thick thighs are.
fn thighs(f: &Figure) -> f32 {
    stout(f) * if f.look.woman { 1.10 } else { 1.0 }
}

/// How thick trousers are at the knee.
fn knee(f: &Figure) -> f32 {
    stout(f) * (1.03 + 0.06 * f.look.loose)
}

/// How far behind its axis a trousers' leg reaches below the hip, and before it at the middle, metres: of
/// somebody who sits these are its lower and its upper side.
pub(crate) fn thigh_reach_m(f: &Figure) -> [f32; 2] {
    [0.057, 0.044].map(|share| TROUSERS * share * thighs(f) * f.stature)
}

/// How far trousers stand out from their slices, metres: a crease down the front of good ones, folds askew
/// behind the knee and over the shoe.
fn creases(f: &Figure, side: Side, t: f32, angle: f32, deep: f32) -> f32 {
    let h = f.stature;
    let pressed = f.look.pressed();
    let line = if pressed { 0.0035 * bump(apart(angle, 0.0) / 0.45) } else { 0.0 };
    let soft = if pressed { 0.6 } else { 1.0 + 0.4 * f.look.loose };
    // Shallow behind, where legs lie on seats.
    let fold = 0.0026 * (0.55 + 0.45 * cos(angle)) * soft * deep * sin(2.0 * side.sign() * angle + 24.0 * t);
    h * (line + fold)
}

/// Thighs are flat behind, where they lie on seats: how far they stand out there, metres.
fn flat_behind(f: &Figure, t: f32, angle: f32) -> f32 {
    -0.009 * f.stature * thighs(f) * bump(apart(angle, PI) / 0.9) * bump((t + 0.60) / 0.45)
}

pub(super) fn thigh(b: &mut MeshBuilder, f: &Figure, s: &Stuffs, side: Side) {
    let shape = [
        (-1.118, 0.0090, 0.0085, 0.0090),
        (-1.080, 0.0215, 0.0200, 0.0205),
        (-1.000, 0.0316, 0.0298, 0.0308),
        (-0.900, 0.0326, 0.0306, 0.0316),
        (-0.740, 0.0360, 0.0328, 0.0340),
        (-0.550, 0.0425, 0.0410, 0.0390),
        (-0.300, 0.0480, 0.0490, 0.0450),
        (-0.080, 0.0490, 0.0570, 0.0475),
        (0.060, 0.0420, 0.0530, 0.0410),
        (0.160, 0.0260, 0.0360, 0.0260),
    ];
    // At the knee a leg is as thick as the shin.
    let grown = |c: &Slice, at_hip: f32, at_knee: f32| {
        let down = (-c.z / f.thigh).clamp(0.0, 1.0);
        c.wider(at_hip + (at_knee - at_hip) * down)
    };
    let shape = limb(f, f.thigh, 1.0, &shape);
    let slices: Vec<Slice> = shape.iter().map(|c| grown(c, thighs(f), stout(f))).collect();
    let none = |_: f32, _: f32| 0.0;
    let bare = Shaped { slices: &slices, sides: SIDES, square: 1.0, between: 0, relief: &none };
    match f.look.bottom {
        Bottom::Trousers => {
            // Wide ones hang straight down from the seat.
            let loose: Vec<Slice> = shape.iter().map(|c| grown(c, TROUSERS * thighs(f), knee(f))).collect();
            let relief = |z: f32, angle: f32| {
                let t = z / f.thigh;
                creases(f, side, t, angle, bump((t + 0.74) / 0.20) + 0.6 * bump((t + 0.22) / 0.16))
                    + flat_behind(f, t, angle)
            };
            Shaped { slices: &loose, sides: SIDES, square: 1.0, between: 0, relief: &relief }
                .add(b, |_| s.bottom);
        }
        Bottom::Shorts => {
            bare.add(b, |_| s.skin);
            let hem = Slice { z: -0.86 * f.thigh, ..slices[5].wider(1.16) };
            let turn = Slice { z: -0.82 * f.thigh, ..slices[5].wider(1.17) };
            let leg: Vec<Slice> =
                [hem, turn].into_iter().chain(slices[5..].iter().map(|c| c.wider(1.09))).collect();
            let relief = |z: f32, angle: f32| {
                let t = z / f.thigh;
                creases(f, side, t, angle, 0.8 * bump((t + 0.25) / 0.2)) + flat_behind(f, t, angle)
            };
            Shaped { slices: &leg, sides: SIDES, square: 1.0, between: 0, relief: &relief }
                .add(b, |_| s.bottom);
        }
        Bottom::Skirt => {
            bare.add(b, |_| s.skin);
            cover(b, f, s.bottom, f.skirt_hem(), 1.0);
        }
    }
    if f.look.top == Top::Coat {
        cover(b, f, s.top, f.coat_hem(), cloth(&f.look));
    }
}

/// The cloth of a skirt or a coat over a thigh: within what hangs from the hips while its owner stands, and
/// before or behind that in a stride. It ends at a height, a share of the stature.
fn cover(b: &mut MeshBuilder, f: &Figure, part: MeshPart, hem: f32, thick: f32) {
    let h = f.stature;
    let by = thick * thighs(f);
    let cut =
        |z: f32, front: f32, back: f32, half: f32| slice(z * h, front * h * by, back * h * by, half * h * by);
    let slices = [
        cut(0.985 * hem, 0.0560, 0.0590, 0.0500),
        cut(0.60 * hem, 0.0545, 0.0600, 0.0495),
        cut(0.25 * hem, 0.0510, 0.0600, 0.0480),
        cut(0.02, 0.0400, 0.0500, 0.0400),
    ];
    Shaped { slices: &slices, sides: [12, 8], square: 1.0, between: 0, relief: &|_, _| 0.0 }.add(b, |_| part);
}

pub(super) fn shin(b: &mut MeshBuilder, f: &Figure, s: &Stuffs, side: Side) {
    let h = f.stature;
    let bare = f.look.bare_legs();
    let none = |_: f32, _: f32| 0.0;
    if bare {
        let shape = [
            (-1.060, 0.014, 0.016, 0.014),
            (-1.000, 0.0170, 0.0195, 0.0170),
            (-0.850, 0.0182, 0.0215, 0.0180),
            (-0.600, 0.0230, 0.0305, 0.0250),
            (-0.380, 0.0268, 0.0380, 0.0310),
            (-0.200, 0.0282, 0.0360, 0.0312),
            (-0.070, 0.0314, 0.0308, 0.0306),
            (0.000, 0.0312, 0.0294, 0.0304),
            (0.085, 0.0190, 0.0180, 0.0185),
        ];
        let slices = limb(f, f.shin, stout(f), &shape);
        Shaped { slices: &slices, sides: SIDES, square: 1.0, between: 0, relief: &none }.add(b, |_| s.skin);
        if f.look.bottom == Bottom::Shorts {
            // Socks.
            let sock = [
                round(-1.04 * f.shin, 0.020 * h),
                slice(-0.82 * f.shin, 0.0200 * h, 0.0235 * h, 0.0200 * h).wider(stout(f)),
                slice(-0.79 * f.shin, 0.0195 * h, 0.0230 * h, 0.0195 * h).wider(stout(f)),
            ];
            solid(b, s.cloth([0.5, 0.5, 0.48]), &sock, SIDES[1]);
        }
    } else {
        // From the knee down trousers are as wide as they are cut.
        let wide = stout(f) * (0.80 + 0.34 * f.look.loose);
        let hem = |v: f32, down: f32| v * (knee(f) + (wide - knee(f)) * down);
        let shape = [
            (-1.035, 0.0285, 0.0335, 0.0300),
            (-0.985, 0.0282, 0.0332, 0.0298),
            (-0.900, 0.0278, 0.0335, 0.0292),
            (-0.780, 0.0280, 0.0340, 0.0295),
            (-0.580, 0.0286, 0.0352, 0.0302),
            (-0.340, 0.0296, 0.0365, 0.0316),
            (-0.120, 0.0312, 0.0322, 0.0312),
            (0.000, 0.0312, 0.0294, 0.0304),
            (0.085, 0.0190, 0.0180, 0.0185),
        ]
        .map(|(t, front, back, half): (f32, f32, f32, f32)| {
            let down = (-t / 0.7).clamp(0.0, 1.0);
            (t, hem(front, down), hem(back, down), hem(half, down))
        });
        let slices = limb(f, f.shin, 1.0, &shape);
        let relief = |z: f32, angle: f32| {
            let t = z / f.shin;
            creases(f, side, t, angle, bump((t + 0.17) / 0.15) + 1.1 * bump((t + 0.88) / 0.16))
        };
        Shaped { slices: &slices, sides: SIDES, square: 1.0, between: 0, relief: &relief }
            .add(b, |_| s.bottom);
    }
    if bare && f.look.shoe == Shoe::Boots {
        // The shaft of a boot.
        let shaft = [
            slice(-1.05 * f.shin, 0.0200 * h, 0.0225 * h, 0.0195 * h),
            slice(-0.85 * f.shin, 0.0215 * h, 0.0250 * h, 0.0212 * h),
            slice(-0.60 * f.shin, 0.0262 * h, 0.0338 * h, 0.0282 * h),
            slice(-0.42 * f.shin, 0.0292 * h, 0.0405 * h, 0.0335 * h),
            slice(-0.39 * f.shin, 0.0285 * h, 0.0395 * h, 0.0328 * h),
        ]
        .map(|c| c.wider(stout(f)));
        Shaped { slices: &shaft, sides: SIDES, square: 1.0, between: 0, relief: &none }.add(b, |_| s.shoe);
    }
}
