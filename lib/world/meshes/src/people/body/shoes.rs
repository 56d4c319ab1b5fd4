//! Shoes: the foot's part and that of the toes, which bends against it.

use crate::solids::{Detail, MeshBuilder};
use glam::Vec3;
use schema::geometry::{MeshPart, Surface};

use super::shape::{Shaped, Slice, slice, strip};
use super::stuffs::Stuffs;
use crate::people::appearance::Shoe;
use crate::people::figure::Figure;

/// Sides of shoes: see [`Shaped`].
const SIDES: [usize; 2] = [10, 9];
const SQUARE: f32 = 0.85;

/// What the sole is of: light under sports shoes, dark under others.
fn sole(f: &Figure, s: &Stuffs) -> MeshPart {
    let rgb = match f.look.shoe {
        Shoe::Sports => [0.55, 0.55, 0.53],
        _ => f.look.shoe_rgb.map(|c| 0.35 * c),
    };
    MeshPart::new(s.tag, Surface::Rubber, rgb)
}

fn add(b: &mut MeshBuilder, f: &Figure, s: &Stuffs, slices: &[Slice]) {
    let sole = sole(f, s);
    Shaped { slices, sides: SIDES, square: SQUARE, between: 0, relief: &|_, _| 0.0 }
        .add(b, |k| if k < 2 { sole } else { s.shoe });
}

pub(super) fn foot(b: &mut MeshBuilder, f: &Figure, s: &Stuffs) {
    let (h, a) = (f.stature, f.ankle);
    // Far away it is a foot with toes.
    let long = if b.detail() == Detail::Coarse { (f.toe - 0.012 * h) / (0.060 * h) } else { 1.0 };
    let cut = |z: f32, front: f32, back: f32, half: f32| {
        slice(z * a, long * front * h, back * h, half * h).at(0.012 * h, 0.0)
    };
    // A sole, a welt, and an upper that rises to the instep and closes about the ankle.
    let slices = [
        cut(-1.00, 0.058, 0.051, 0.0230),
        cut(-0.80, 0.060, 0.0535, 0.0258),
        cut(-0.78, 0.058, 0.0515, 0.0240),
        cut(-0.56, 0.0570, 0.0518, 0.0247),
        cut(-0.32, 0.0440, 0.0472, 0.0237),
        cut(-0.08, 0.0245, 0.0415, 0.0220),
        cut(0.22, 0.0120, 0.0350, 0.0198),
    ];
    add(b, f, s, &slices);
    if f.look.shoe == Shoe::Leather {
        return;
    }
    // The tongue with its laces.
    let light =
        if f.look.shoe == Shoe::Sports { [0.60, 0.60, 0.58] } else { f.look.shoe_rgb.map(|c| 0.5 * c) };
    let lace = s.cloth(light);
    for (x, z) in [(0.051, -0.24), (0.040, -0.03)] {
        let at = |d: f32, y: f32| Vec3::new((x + 0.010 + d) * h, y * h, (z + 0.08) * a - 0.7 * d * h);
        let pairs = [-0.011, 0.0, 0.011].map(|y: f32| {
            let bow = -0.12 * y.abs();
            [at(0.0020 + bow, y), at(-0.0020 + bow, y)]
        });
        strip(b, lace, &pairs, 0.003 * h, false);
    }
}

pub(super) fn toes(b: &mut MeshBuilder, f: &Figure, s: &Stuffs) {
    if b.detail() == Detail::Coarse {
        return;
    }
    let (h, a) = (f.stature, f.ankle);
    let tip = f.toe - f.ball;
    let cut = |z: f32, front: f32, back: f32, half: f32| slice(z * a, front * tip, back * h, half * h);
    let slices = [
        cut(-0.25, 0.93, 0.022, 0.0235),
        cut(-0.06, 1.00, 0.026, 0.0268),
        cut(-0.04, 0.96, 0.025, 0.0252),
        cut(0.14, 0.84, 0.027, 0.0246),
        cut(0.27, 0.58, 0.027, 0.0218),
        cut(0.36, 0.26, 0.022, 0.0150),
    ];
    add(b, f, s, &slices);
}
