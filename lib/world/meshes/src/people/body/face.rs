//! Faces: the head's skin with its features, eyes, brows, ears, beards, glasses.

use std::f32::consts::TAU;

use crate::solids::Detail;
use catalogue::Age;
use glam::Vec3;
use schema::geometry::{MeshPart, Surface};

use super::cranium::Head;
use super::shape::strip;
use super::skull::EYE;
use super::stuffs::Stuffs;
use crate::people::appearance::{Beard, Hair, Hat};
use crate::people::figure::Figure;

/// Heights of the rings of a head that is seen from close by, as shares of the head: close together where
/// the face has relief.
const RINGS: [f32; 22] = [
    0.000, 0.030, 0.070, 0.115, 0.150, 0.170, 0.190, 0.215, 0.250, 0.292, 0.320, 0.345, 0.390, 0.435, 0.475,
    0.515, 0.555, 0.620, 0.720, 0.830, 0.920, 0.980,
];
/// Angles of the corners of a ring on one side, from ahead, degrees.
const ANGLES: [f32; 8] = [8.0, 16.0, 25.0, 36.0, 50.0, 70.0, 95.0, 135.0];

/// All angles of a ring from ahead to the left and around, radians.
pub(super) fn angles() -> Vec<f32> {
    let left = ANGLES.iter().map(|a| a.to_radians());
    let right = ANGLES.iter().rev().map(|a| TAU - a.to_radians());
    std::iter::once(0.0).chain(left).chain(std::iter::once(0.5 * TAU)).chain(right).collect()
}

/// A mean of two colours.
fn mixed(a: [f32; 3], b: [f32; 3], share: f32) -> [f32; 3] {
    std::array::from_fn(|k| a[k] + (b[k] - a[k]) * share)
}

pub(super) fn face(it: &mut Head<'_>, f: &Figure, s: &Stuffs) {
    let lips = s.cloth(std::array::from_fn(|k| f.look.skin_rgb[k] * [0.78, 0.50, 0.50][k]));
    let dark = s.cloth([0.03, 0.02, 0.015]);
    if it.b.detail() == Detail::Full {
        skin(it, f, s);
        mouth(it, lips);
        ears(it, s);
        if f.look.hat != Hat::FullHelmet {
            eyes(it, f, s);
        }
        if f.look.glasses {
            glasses(it, s, f.look.face[2] > 0.7);
        }
        return;
    }
    // Farther away, what of it is worth being there.
    it.solid(s.skin, &it.skull.slices());
    it.blob(s.skin, [0.372, 0.0, 0.390], [0.080, 0.045, 0.085], 4, 6);
    it.blob(lips, [0.368, 0.0, 0.190], [0.026, 0.095, 0.022], 3, 6);
    for y in [-1.0, 1.0] {
        it.blob(s.skin, [-0.02, y * 0.330, 0.400], [0.060, 0.035, 0.100], 4, 6);
        it.blob(dark, [0.345, y * 0.140, 0.470], [0.032, 0.046, 0.024], 3, 6);
    }
    if f.look.beard == Beard::Full {
        it.solid(
            s.hair,
            &[
                (-0.035, 0.300, 0.050, 0.100),
                (0.020, 0.372, 0.150, 0.185),
                (0.090, 0.386, 0.230, 0.238),
                (0.150, 0.368, 0.240, 0.276),
                (0.330, 0.230, 0.150, 0.316),
                (0.400, 0.100, 0.100, 0.310),
            ],
        );
    }
}

/// What of a face is covered by a beard, between two rings and two corners, and how far it stands out.
fn bearded(beard: Beard, t: f32, angle: f32) -> bool {
    let aside = angle.min(TAU - angle).to_degrees();
    let moustache = (0.215..0.250).contains(&t) && aside < 25.0;
    let chin = t < 0.150 && aside < 36.0;
    let corner = match aside {
        _ if aside < 16.0 => 0.150,
        _ if aside < 50.0 => 0.217,
        _ if aside < 70.0 => 0.320,
        _ => 0.440,
    };
    let jaw = aside < 95.0 && t < corner;
    match beard {
        Beard::None => false,
        Beard::Moustache => moustache,
        Beard::Goatee => moustache || chin,
        Beard::Stubble | Beard::Full => moustache || chin || jaw,
    }
}

fn skin(it: &mut Head<'_>, f: &Figure, s: &Stuffs) {
    let angles = angles();
    let beard = f.look.beard;
    let thick = match beard {
        Beard::Full => 0.035,
        Beard::Goatee | Beard::Moustache => 0.018,
        _ => 0.0,
    };
    let hair = match beard {
        Beard::Stubble => s.cloth(mixed(f.look.skin_rgb, f.look.hair_rgb, 0.35)),
        _ => s.hair,
    };
    // What hair covers is not there.
    let bare = matches!(f.look.hair, Hair::Bald | Hair::Thin) && f.look.hat == Hat::None;
    let seen = if bare { RINGS.len() } else { RINGS.len() - 2 };
    let rings: Vec<Vec<Vec3>> = RINGS[..seen]
        .iter()
        .map(|t| {
            let place = |angle: &f32| {
                let place = it.skull.surface(*t, *angle);
                let out = if bearded(beard, *t, *angle) { thick } else { 0.0 };
                it.place(place + place.with_z(0.0).normalize_or_zero() * out - Vec3::Z * 0.6 * out)
            };
            angles.iter().map(place).collect()
        })
        .collect();
    let n = angles.len();
    let middle = |k: usize, j: usize| {
        let next = if j + 1 == n { TAU } else { angles[j + 1] };
        (0.5 * (RINGS[k] + RINGS[k + 1]), 0.5 * (angles[j] + next))
    };
    it.b.loft(
        &rings,
        |k, j| {
            let (t, angle) = middle(k, j);
            if bearded(beard, t, angle) { hair } else { s.skin }
        },
        [s.skin; 2],
    );
}

/// Lips, which end in the corners of the mouth.
fn mouth(it: &mut Head<'_>, lips: MeshPart) {
    let line =
        [(-0.36f32, 0.05), (-0.20, 0.75), (-0.07, 1.0), (0.0, 0.8), (0.07, 1.0), (0.20, 0.75), (0.36, 0.05)];
    for (middle, half) in [(0.2065, 0.0155), (0.1710, 0.0175)] {
        let pairs: Vec<[Vec3; 2]> = line
            .iter()
            .map(|(angle, share)| {
                [-1.0, 1.0].map(|up| {
                    // Both end at the line between them.
                    let t = 0.189 + (middle - 0.189) * (0.3 + 0.7 * share) + up * half * share;
                    it.place(it.skull.surface(t, *angle) + Vec3::X * 0.005)
                })
            })
            .collect();
        strip(it.b, lips, &pairs, 0.004, false);
    }
}

fn ears(it: &mut Head<'_>, s: &Stuffs) {
    let inside = s.cloth(s.skin.rgb.map(|c| 0.62 * c));
    for y in [-1.0, 1.0] {
        // A lobe, the rim leaning back and outward, and the hollow before it.
        it.leaning(
            s.skin,
            &[
                (0.320, 0.016, 0.018, 0.014, [-0.010, y * 0.302]),
                (0.345, 0.030, 0.032, 0.022, [-0.014, y * 0.312]),
                (0.440, 0.040, 0.060, 0.028, [-0.034, y * 0.342]),
                (0.528, 0.020, 0.036, 0.018, [-0.036, y * 0.342]),
            ],
            7,
        );
        it.blob(inside, [-0.012, y * 0.349, 0.440], [0.030, 0.010, 0.048], 2, 6);
    }
}

fn eyes(it: &mut Head<'_>, f: &Figure, s: &Stuffs) {
    let white = s.cloth([0.52, 0.49, 0.46]);
    let iris = s.cloth(mixed([0.025, 0.016, 0.012], [0.05, 0.07, 0.09], f.look.face[3] * f.look.skin_rgb[0]));
    let lash = s.cloth(mixed(f.look.skin_rgb, [0.012, 0.009, 0.008], 0.82));
    let lid = s.cloth(f.look.skin_rgb.map(|c| 0.80 * c));
    let brow =
        s.cloth(mixed(f.look.hair_rgb, f.look.skin_rgb, if f.look.age == Age::Child { 0.45 } else { 0.2 }));
    let [aside, high] = EYE;
    let big = if f.look.age == Age::Child { 1.2 } else { 1.0 };
    for y in [-1.0, 1.0] {
        let x = it.skull.surface(high, y * 0.42).x;
        it.blob(white, [x - 0.030, y * aside, high], [0.040, 0.060 * big, 0.035 * big], 3, 7);
        it.blob(iris, [x - 0.006, y * (aside - 0.004), high], [0.020, 0.026 * big, 0.029 * big], 3, 6);
        it.blob(
            lash,
            [x - 0.016, y * (aside + 0.004), high + 0.033 * big],
            [0.036, 0.066 * big, 0.009],
            3,
            6,
        );
        it.blob(lid, [x - 0.022, y * aside, high + 0.046 * big], [0.034, 0.066 * big, 0.014], 3, 6);
        // A brow rises from the nose and falls outward.
        let wide = if f.look.woman { 0.011 } else { 0.017 };
        let line = [(0.17f32, 0.552, 0.9), (0.36, 0.562, 1.0), (0.58, 0.564, 0.8), (0.74, 0.546, 0.2)];
        let pairs: Vec<[Vec3; 2]> = line
            .iter()
            .map(|(angle, t, share)| {
                [-1.0, 1.0].map(|up| {
                    let place = it.skull.surface(t + up * wide * share, y * angle);
                    it.place(place + Vec3::new(0.008, 0.0, 0.0))
                })
            })
            .collect();
        strip(it.b, brow, &pairs, 0.004, false);
    }
}

fn glasses(it: &mut Head<'_>, s: &Stuffs, tinted: bool) {
    let frame = MeshPart::new(s.tag, Surface::Plain, [0.015, 0.014, 0.016]);
    let lens = MeshPart::new(s.tag, Surface::Glass, [0.02, 0.02, 0.022]);
    let [aside, high] = EYE;
    let ahead = it.skull.surface(high, 0.0).x + 0.03;
    let bar = |it: &mut Head<'_>, from: [f32; 3], to: [f32; 3]| {
        let radius = 0.010 * it.m;
        let [from, to] = [from, to].map(|p| it.place(Vec3::from_array(p)));
        it.b.bar(frame, from, to, [radius; 2], 4);
    };
    for y in [-1.0, 1.0] {
        if tinted {
            it.blob(lens, [ahead - 0.035, y * aside, high - 0.005], [0.030, 0.092, 0.062], 4, 8);
        }
        let (inner, outer) = (y * (aside - 0.085), y * (aside + 0.095));
        let (low, up) = (high - 0.060, high + 0.045);
        let back = ahead - 0.055;
        bar(it, [ahead, inner, up], [back, outer, up]);
        bar(it, [ahead, inner, low], [back, outer, low]);
        bar(it, [ahead, inner, low], [ahead, inner, up]);
        bar(it, [back, outer, low], [back, outer, up]);
        bar(it, [back, outer, up], [-0.03, y * 0.345, high + 0.03]);
    }
    bar(it, [ahead, -0.06, high + 0.02], [ahead, 0.06, high + 0.02]);
}
