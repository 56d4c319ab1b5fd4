//! Hair: a shell about the skull from the hairline to the crown, and what hangs or is tied behind it.

use std::f32::consts::{PI, TAU};

use crate::solids::{Detail, curve_at};
use frames::math::f32::{pow, sin, sin_cos};
use glam::Vec3;

use super::cranium::Head;
use super::face::angles;
use super::shape::bump;
use super::stuffs::Stuffs;
use crate::people::appearance::{Hair, Hat};
use crate::people::figure::Figure;

/// Heights of the hairline by the angle from ahead, degrees: cut short about the ears, drawn back from a
/// high forehead, falling over the forehead, gone from it.
const SHORT: &[(f32, f32)] = &[
    (0.0, 0.790),
    (25.0, 0.785),
    (40.0, 0.735),
    (54.0, 0.640),
    (68.0, 0.520),
    (80.0, 0.440),
    (92.0, 0.520),
    (112.0, 0.330),
    (135.0, 0.215),
    (180.0, 0.165),
];
const DRAWN: &[(f32, f32)] = &[
    (0.0, 0.810),
    (30.0, 0.790),
    (50.0, 0.700),
    (68.0, 0.560),
    (84.0, 0.450),
    (100.0, 0.440),
    (120.0, 0.290),
    (180.0, 0.150),
];
const FRINGE: &[(f32, f32)] = &[
    (0.0, 0.625),
    (36.0, 0.615),
    (50.0, 0.560),
    (64.0, 0.440),
    (84.0, 0.370),
    (110.0, 0.320),
    (180.0, 0.150),
];
const GONE: &[(f32, f32)] = &[
    (0.0, 0.935),
    (20.0, 0.925),
    (36.0, 0.880),
    (52.0, 0.720),
    (68.0, 0.520),
    (80.0, 0.440),
    (92.0, 0.520),
    (112.0, 0.330),
    (180.0, 0.165),
];
/// How far up a shell goes from the hairline at its rows, as shares.
const ROWS: [f32; 8] = [0.0, 0.015, 0.12, 0.28, 0.47, 0.67, 0.85, 1.0];
/// The height of the last row, on the crown.
const CROWN: f32 = 0.975;
/// Under a hat a shell ends at this height.
const RIM: f32 = 0.70;
/// The edge of a shell lies so deep in the skin.
const TUCKED: f32 = 0.012;
/// What shells swell away from.
const MIDDLE: Vec3 = Vec3::new(-0.03, 0.0, 0.50);

pub(super) fn hair(it: &mut Head<'_>, f: &Figure, s: &Stuffs) {
    if it.b.detail() == Detail::Full {
        shell(it, f, s);
    } else {
        cap(it, f, s);
    }
    let worn_down = f.look.hat != Hat::FullHelmet;
    match f.look.hair {
        Hair::Bob if worn_down => curtain(it, s, 0.02),
        Hair::Long if worn_down => curtain(it, s, if f.look.face[2] > 0.5 { -0.62 } else { -0.28 }),
        Hair::Bun => {
            // Low at the neck, or high up.
            let at = if f.look.face[2] > 0.5 { [-0.500, 0.0, 0.560] } else { [-0.470, 0.0, 0.740] };
            let at = if f.look.hat == Hat::None { at } else { [-0.470, 0.0, 0.330] };
            it.blob(s.hair, at, [0.140, 0.165, 0.150], 6, 10);
        }
        Hair::Ponytail => tail(it, s),
        _ => {}
    }
}

/// How thick the hair is by the share of the way up, the angle and the height.
fn thickness(f: &Figure, up: f32, angle: f32, t: f32) -> f32 {
    let (s, _) = sin_cos(angle);
    let ahead = angle.min(TAU - angle);
    let rise = bump(1.0 - (up / 0.25).min(1.0));
    match f.look.hair {
        Hair::Bald => 0.004,
        Hair::Thin => 0.016 * rise,
        Hair::Crew => 0.012 + 0.020 * rise,
        Hair::Curls => 0.020 + 0.075 * rise,
        Hair::Afro => 0.030 + 0.150 * pow(rise, 0.6),
        // Up and away from the forehead.
        Hair::Quiff => 0.018 + 0.030 * rise + 0.075 * bump(ahead / 1.1) * bump((t - 0.90) / 0.20),
        // More to one side of a line.
        Hair::Parted => {
            let line = bump((s + 0.42) / 0.16) * bump(ahead / 1.5) * bump((t - 0.95) / 0.3);
            0.020 + 0.032 * rise + 0.022 * s.max(-0.3) * rise - 0.030 * line
        }
        Hair::Fringe | Hair::Bob => 0.034 + 0.030 * rise,
        Hair::Short => 0.020 + 0.034 * rise,
        Hair::Long | Hair::Bun | Hair::Ponytail => {
            let line = bump(s / 0.14) * bump(ahead / 1.2) * bump((t - 0.95) / 0.3);
            0.022 + 0.030 * rise - 0.022 * line
        }
    }
}

/// Locks stand out and lie low: a share of the thickness by row and corner.
fn locks(f: &Figure, row: usize, corner: usize) -> f32 {
    let [a, b, ..] = f.look.face;
    let wave = |x: f32| sin(x * TAU);
    let (r, c) = (row as f32, corner as f32);
    match f.look.hair {
        Hair::Curls | Hair::Afro => {
            0.10 * wave(0.37 * c + 0.41 * r + a) + 0.07 * wave(0.31 * c - 0.27 * r + b)
        }
        Hair::Bald | Hair::Thin | Hair::Crew => 0.0,
        // Strands run from the crown down.
        _ => 0.16 * wave(0.39 * c + 0.06 * r + a) + 0.06 * wave(0.23 * c + 0.31 * r + b),
    }
}

/// The shell, close by.
fn shell(it: &mut Head<'_>, f: &Figure, s: &Stuffs) {
    let line = match f.look.hair {
        Hair::Bald | Hair::Thin => GONE,
        Hair::Fringe | Hair::Bob => FRINGE,
        Hair::Long | Hair::Bun | Hair::Ponytail => DRAWN,
        _ => SHORT,
    };
    let bare = f.look.hat == Hat::None;
    let bald = f.look.hair == Hair::Bald;
    let crown = match (bare, bald) {
        (true, false) => CROWN,
        _ => RIM,
    };
    let angles = angles();
    let mut rings: Vec<Vec<Vec3>> = ROWS
        .iter()
        .enumerate()
        .map(|(row, up)| {
            let place = |(corner, angle): (usize, &f32)| {
                let ahead = angle.min(TAU - angle).to_degrees();
                let from = curve_at(line, ahead).min(crown - 0.02);
                // Hair of those who are bald is a wreath.
                let to = if bald { (from + 0.01).max(0.62 + 0.0008 * ahead) } else { crown };
                let t = from + (to - from) * up;
                let skin = it.skull.bare(t, *angle);
                let hidden = row == 0 || bald && (row + 1 == ROWS.len() || ahead < 58.0);
                let thick = if hidden {
                    -TUCKED
                } else {
                    thickness(f, *up, *angle, t) * (1.0 + locks(f, row, corner))
                };
                // A hat lies close on it.
                let thick = if bare { thick } else { thick.min(0.030) };
                skin + (skin - MIDDLE).normalize_or(Vec3::Z) * thick
            };
            angles.iter().enumerate().map(place).collect()
        })
        .collect();
    // The highest place is where it has to be.
    if bare && !bald {
        let high = rings.iter().flatten().map(|p| p.z).fold(0.0, f32::max);
        let by = it.top - high;
        for p in rings.iter_mut().flatten() {
            let share = ((p.z - 0.6) / (high - 0.6)).clamp(0.0, 1.0);
            p.z += by * share * share;
        }
    }
    let rings: Vec<Vec<Vec3>> =
        rings.into_iter().map(|ring| ring.into_iter().map(|p| it.place(p)).collect()).collect();
    it.b.loft(&rings, |_, _| s.hair, [s.hair; 2]);
}

/// The same of less detail: a cap, or what a hat leaves of it.
fn cap(it: &mut Head<'_>, f: &Figure, s: &Stuffs) {
    let (top, bare) = (it.top, f.look.hat == Hat::None);
    match f.look.hair {
        Hair::Bald | Hair::Thin => it.solid(
            s.hair,
            &[
                (0.160, 0.020, 0.360, 0.270),
                (0.300, 0.060, 0.432, 0.325),
                (0.450, 0.100, 0.450, 0.345),
                (0.620, 0.090, 0.460, 0.346),
                (0.740, 0.020, 0.440, 0.322),
                (0.800, 0.000, 0.390, 0.280),
            ],
        ),
        Hair::Curls | Hair::Afro if bare => {
            let middle = 0.62;
            let wide = if f.look.hair == Hair::Afro { 1.15 } else { 1.0 };
            it.blob(s.hair, [-0.085, 0.0, middle], [0.450 * wide, 0.420 * wide, top - middle], 9, 14);
            it.blob(s.hair, [-0.170, 0.0, 0.40], [0.360 * wide, 0.380 * wide, 0.260], 7, 12);
        }
        style => {
            let thick = if matches!(style, Hair::Bob | Hair::Long) { 1.05 } else { 1.0 };
            let cap = [
                (0.130, 0.000, 0.340, 0.255),
                (0.270, 0.050, 0.430, 0.305),
                (0.400, 0.085, 0.472, 0.345 * thick),
                (0.540, 0.190, 0.485, 0.360 * thick),
                (0.640, 0.320, 0.488, 0.366 * thick),
                (0.710, 0.385, 0.480, 0.360 * thick),
                (0.800, 0.362, 0.448, 0.336),
                (0.890, 0.288, 0.368, 0.268),
                (0.960, 0.175, 0.240, 0.170),
                (top, 0.050, 0.070, 0.050),
            ];
            // A hat hides what is above its rim.
            it.solid(s.hair, if bare { &cap } else { &cap[..7] });
        }
    }
}

/// Hair that hangs beside the face and behind, down to a height.
fn curtain(it: &mut Head<'_>, s: &Stuffs, end: f32) {
    // Slices `(height, front, back, half width, degrees of the face that are free on either side)`, from
    // above.
    let all: [(f32, f32, f32, f32, f32); 8] = [
        (0.660, 0.36, 0.470, 0.372, 62.0),
        (0.460, 0.32, 0.500, 0.395, 68.0),
        (0.260, 0.27, 0.495, 0.395, 74.0),
        (0.080, 0.24, 0.480, 0.375, 80.0),
        (-0.100, 0.24, 0.470, 0.360, 92.0),
        (-0.280, 0.24, 0.500, 0.350, 104.0),
        (-0.460, 0.24, 0.520, 0.300, 116.0),
        (-0.620, 0.24, 0.525, 0.220, 128.0),
    ];
    let arc = if it.b.detail() == Detail::Full { 9 } else { 5 };
    let mut rings: Vec<Vec<Vec3>> = Vec::new();
    for (k, (t, front, back, half, free)) in all.into_iter().enumerate() {
        if t < end - 1e-3 {
            break;
        }
        let last = all.get(k + 1).is_none_or(|next| next.0 < end - 1e-3);
        let deep = if last { 0.03 } else { 0.075 };
        let place = |i: usize, deep: f32| {
            let share = i as f32 / (arc - 1) as f32;
            let angle = free.to_radians() + share * 2.0 * (PI - free.to_radians());
            let (sin, cos) = sin_cos(angle);
            let wave = 1.0 + 0.022 * if i.is_multiple_of(2) { 1.0 } else { -1.0 };
            let reach = if cos > 0.0 { front } else { back };
            it.place(Vec3::new(cos * (reach * wave - deep), sin * (half * wave - deep), t))
        };
        let outer = (0..arc).map(|i| place(i, 0.0));
        let inner = (0..arc).rev().map(|i| place(i, deep));
        rings.push(outer.chain(inner).collect());
    }
    rings.reverse();
    it.b.loft(&rings, |_, _| s.hair, [s.hair; 2]);
}

/// A tail of hair, tied behind.
fn tail(it: &mut Head<'_>, s: &Stuffs) {
    let at = |x: f32, t: f32| it.place(Vec3::new(x, 0.0, t));
    let tail = [at(-0.44, 0.66), at(-0.60, 0.60), at(-0.64, 0.36), at(-0.61, 0.08), at(-0.57, -0.25)];
    let radius = [0.065, 0.100, 0.110, 0.085, 0.025].map(|r| r * it.m);
    for k in 0..4 {
        it.b.bar(s.hair, tail[k], tail[k + 1], [radius[k], radius[k + 1]], 8);
        if k < 3 {
            it.b.ellipsoid(s.hair, tail[k + 1], Vec3::splat(0.98 * radius[k + 1]), 4, 8);
        }
    }
}
