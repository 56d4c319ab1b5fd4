//! Hips and chest with the clothes on them.

use std::f32::consts::PI;

use crate::solids::MeshBuilder;
use catalogue::Age;
use frames::math::f32::{cos, sin};
use schema::geometry::{MeshPart, Surface};

use super::bags::{backpack, shoulder_bag};
use super::garments::{belt, fastened};
use super::shape::{Shaped, Slice, apart, bump, cloth, slice};
use super::stuffs::Stuffs;
use crate::people::appearance::{Appearance, Bottom, Build, Carried, Top};
use crate::people::figure::Figure;

/// Sides of hips and chest: see [`Shaped`].
const SIDES: [usize; 2] = [16, 12];
const BAND: [f32; 3] = [0.75, 0.76, 0.74];

/// How broad the hips are.
fn hips(look: &Appearance) -> f32 {
    look.girth() * if look.woman { 1.06 } else { 1.0 }
}

/// A coat or a skirt about hips and thighs, at heights over the hips. Shares of the stature.
fn hanging_slice(look: &Appearance, z: f32, flare: f32) -> Slice {
    let g = look.girth();
    let down = (-z).max(0.0);
    let up = (z / 0.095).clamp(0.0, 1.0);
    let (front, back, half) =
        (0.066 + 0.10 * flare * down, 0.081 + 0.12 * flare * down, 0.110 + 0.14 * flare * down);
    let coat = look.top == Top::Coat;
    let waist = if coat {
        1.02
    } else if look.woman {
        0.86
    } else {
        0.93
    };
    let narrow = |v: f32, at_waist: f32| v + (at_waist - v) * up;
    let [front, back, half] =
        [narrow(front, 0.056), narrow(back, if coat { 0.061 } else { 0.054 }), narrow(half, 0.092 * waist)];
    slice(z, front * g, back, half * hips(look))
}

pub(super) fn pelvis(b: &mut MeshBuilder, f: &Figure, s: &Stuffs) {
    let h = f.stature;
    let g = f.look.girth();
    let wide = hips(&f.look);
    let cut = |z: f32, front: f32, back: f32, half: f32| slice(z * h, front * h, back * h, half * h);
    let slices = [
        cut(-0.060, 0.020, 0.030, 0.014),
        cut(-0.052, 0.038, 0.054, 0.058),
        cut(-0.030, 0.050 * g, 0.068, 0.095 * wide),
        cut(0.000, 0.056 * g, 0.074, 0.0995 * wide),
        cut(0.035, 0.055 * g, 0.066, 0.095 * wide),
        cut(0.075, 0.052 * g, 0.053, 0.085 * g),
        cut(0.105, 0.047 * g, 0.047, 0.078 * g),
    ];
    // Two halves behind.
    let relief = |z: f32, angle: f32| {
        let seat = bump((z / h + 0.005) / 0.055);
        h * seat
            * (0.006 * bump(apart(angle, 0.82 * PI) / 0.5) + 0.006 * bump(apart(angle, 1.18 * PI) / 0.5)
                - 0.005 * bump(apart(angle, PI) / 0.3))
    };
    let body = Shaped { slices: &slices, sides: SIDES, square: 0.92, between: 0, relief: &relief };
    body.add(b, |_| s.bottom);
    if f.look.bottom != Bottom::Skirt {
        belt(b, f, s, &body);
    }
    let flare = f.look.flare();
    let over = match (f.look.top, f.look.bottom) {
        (Top::Coat, _) => Some((s.top, cloth(&f.look), f.coat_hem())),
        (_, Bottom::Skirt) => Some((s.bottom, 1.0, f.skirt_hem())),
        _ => None,
    };
    if let Some((part, thick, hem)) = over {
        let hang: Vec<Slice> = [1.0, 0.93, 0.62, 0.30]
            .map(|share| share * hem)
            .into_iter()
            .chain([0.0, 0.045, 0.085])
            .map(|z| {
                let slice = hanging_slice(&f.look, z, flare).wider(h * thick);
                Slice { z: z * h, ..slice }
            })
            .collect();
        // A few soft folds, deeper towards the hem.
        let relief = |z: f32, angle: f32| {
            let down = (z / (hem * h)).clamp(0.0, 1.0);
            0.0065 * h * flare * down * cos(4.0 * angle + 0.9)
        };
        Shaped { slices: &hang, sides: SIDES, square: 0.94, between: 0, relief: &relief }.add(b, |_| part);
    }
}

/// The chest's slices from the waist up, in shares of the stature, bare.
fn ribs(f: &Figure) -> Vec<Slice> {
    let look = &f.look;
    let g = look.girth();
    let belly = match (look.build, look.age) {
        (Build::Heavy, _) => 1.24,
        (_, Age::Elder) => 1.08,
        _ => 1.0,
    };
    let (waist, across) = if look.woman { (0.89, 0.93) } else { (1.0, 1.0) };
    let coat = look.top == Top::Coat;
    // Shoulders: the chest ends inside the upper arms.
    let reach = (f.shoulder.y / f.stature) / 0.104;
    let broad = reach.max(0.9 * g);
    vec![
        slice(
            0.020,
            0.053 * g * belly,
            if coat { 0.057 } else { 0.050 },
            0.085 * g * waist * if coat { 1.08 } else { 1.0 },
        ),
        slice(0.070, 0.057 * g * belly.sqrt(), 0.055, 0.090 * g * across),
        slice(0.110, 0.060 * g, 0.059, 0.098 * g * across),
        slice(0.140, 0.060 * g, 0.061, 0.102 * g.min(broad) * across),
        slice(0.168, 0.054 * g, 0.061, 0.109 * reach),
        slice(0.186, 0.047, 0.057, 0.114 * reach),
        slice(0.200, 0.040, 0.051, 0.108 * reach),
        slice(0.211, 0.036, 0.046, 0.088 * reach),
        slice(0.221, 0.033, 0.042, 0.062 * reach),
        slice(0.231, 0.029, 0.037, 0.043),
    ]
}

/// How far the hem of the top hangs below the waist, as a share of the stature; tops that are tucked in end
/// at the waist.
fn hem(look: &Appearance) -> f32 {
    match look.top {
        Top::Suit => 0.140,
        Top::HiVis => 0.120,
        Top::Jacket | Top::Hoodie => 0.112,
        Top::Tee | Top::Shirt if look.bottom != Bottom::Skirt && !look.tucked() => 0.112,
        _ => 0.020,
    }
}

/// What hangs below the waist, from the hem up.
fn below_waist(look: &Appearance) -> Vec<Slice> {
    let (g, wide) = (look.girth(), hips(look));
    let over = |z: f32, front: f32, back: f32, half: f32| slice(z, front * g, back, half * wide);
    let narrow = if look.woman { 0.93 } else { 1.0 };
    let low = hem(look);
    if matches!(look.top, Top::Coat | Top::Dress) {
        // It goes on as what hangs from the hips.
        let over = |z: f32| Slice { z, ..hanging_slice(look, z + 0.095, look.flare()).wider(1.015) };
        return vec![over(-0.045), over(-0.012)];
    }
    if low < 0.05 {
        return vec![slice(-low, 0.054 * g, 0.052, 0.086 * g * narrow)];
    }
    match look.top {
        // A ribbed band holds it, and it bags over that.
        Top::Hoodie | Top::Jacket => vec![
            over(-low, 0.059, 0.074, 0.1035),
            over(-0.088, 0.059, 0.073, 0.1035),
            over(-0.078, 0.066, 0.078, 0.109),
            over(-0.040, 0.064, 0.070, 0.105),
            over(-0.010, 0.060, 0.060, 0.096 * narrow),
        ],
        _ => vec![
            over(-low, 0.068, 0.083, 0.1140),
            over(-low + 0.012, 0.067, 0.082, 0.1130),
            over(-0.055, 0.063, 0.073, 0.1055),
            over(-0.020, 0.057, 0.059, 0.093 * narrow),
        ],
    }
}

pub(super) fn chest(b: &mut MeshBuilder, f: &Figure, s: &Stuffs) {
    let h = f.stature;
    let look = &f.look;
    let thick = cloth(look);
    // The chest's own measures are those of somebody whose neck begins at 0.219 of the stature over the
    // waist.
    let tall = f.neck.z / (0.219 * h);
    let mut slices = below_waist(look);
    let hips = slices.len();
    slices.extend(ribs(f));
    let slices: Vec<Slice> = slices
        .into_iter()
        .map(|c| {
            let z = if c.z > 0.0 { c.z * tall } else { c.z };
            let by = if c.z > 0.21 { 1.0 } else { thick };
            Slice { z: h * z, ..c.wider(h * by) }
        })
        .collect();
    let relief = |z: f32, angle: f32| h * modelled(look, z / (h * tall), angle);
    let body = Shaped { slices: &slices, sides: SIDES, square: 0.88, between: 0, relief: &relief };
    let band = MeshPart::new(s.tag, Surface::Reflector, BAND);
    let vest = s.cloth([0.60, 0.72, 0.03]);
    body.add(b, |k| match look.top {
        Top::HiVis if k + 1 == hips || k == hips + 2 => band,
        Top::Uniform if k == hips || k == hips + 2 => vest,
        Top::Hoodie | Top::Jacket if k == 0 => s.trim,
        // The neck is bare down to where an opening begins.
        Top::Tee | Top::Dress if k >= hips + if look.woman { 7 } else { 8 } => s.skin,
        Top::Shirt | Top::Suit if k >= hips + 8 => s.skin,
        Top::Jacket | Top::Coat if k >= hips + 8 && look.open() => s.accent,
        _ => s.top,
    });
    fastened(b, f, s, &body, tall);
    match look.carried {
        Carried::Backpack => backpack(b, f, s, &body, tall),
        Carried::ShoulderBag => shoulder_bag(b, f, s),
        _ => {}
    }
}

/// How far the trunk stands out from its slices at a height over the waist and an angle, in shares of the
/// stature: breasts or chest muscles, shoulder blades, spine, and how the cloth falls over them.
fn modelled(look: &Appearance, z: f32, angle: f32) -> f32 {
    let ahead = apart(angle, 0.0);
    let front = bump((ahead - 0.52) / 0.62);
    let chest = match (look.woman, look.age) {
        (_, Age::Child) => 0.0,
        (true, _) => {
            let full = match look.build {
                Build::Slim => 0.013,
                Build::Average => 0.018,
                Build::Heavy => 0.022,
            };
            // Cloth falls from them rather than following.
            full * front * bump((z - 0.128) / if z < 0.128 { 0.075 } else { 0.055 })
        }
        (false, _) => 0.006 * front * bump((z - 0.148) / 0.055),
    };
    let blades = 0.006 * bump((apart(angle, PI) - 0.62) / 0.5) * bump((z - 0.150) / 0.06);
    let spine = -0.005 * bump(apart(angle, PI) / 0.35) * bump((z - 0.085) / 0.10);
    // Cloth that is held at the waist and arms is drawn askew.
    let drawn = bump((z - 0.050) / 0.050) * 0.0022 * sin(3.0 * angle + 70.0 * z)
        + bump((z - 0.150) / 0.05) * 0.0018 * frames::math::f32::sin(5.0 * angle - 60.0 * z);
    chest + blades + spine + drawn
}

impl Figure {
    /// Where a skirt and a coat end, over the hips: shares of the stature.
    pub(super) fn skirt_hem(&self) -> f32 {
        -self.look.skirt() * self.thigh / self.stature
    }

    /// See [`Figure::skirt_hem`].
    pub(super) fn coat_hem(&self) -> f32 {
        0.80 * self.skirt_hem()
    }
}
