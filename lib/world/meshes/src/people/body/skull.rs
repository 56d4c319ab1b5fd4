//! The shape of a head without hair. Lengths are shares of its height, from the chin up; x is ahead of its
//! middle, y to the left.

use crate::solids::curve_at;
use catalogue::Age;
use frames::math::f32::{pow, sin_cos};
use glam::Vec3;

use super::shape::{Slice, bump, slice};
use crate::people::appearance::{Appearance, Build};

/// Slices `(height, front, back, half width)` of a head without features.
pub(super) const SLICES: [(f32, f32, f32, f32); 13] = [
    (0.000, 0.300, 0.060, 0.080),
    (0.030, 0.345, 0.140, 0.150),
    (0.090, 0.370, 0.250, 0.215),
    (0.180, 0.380, 0.330, 0.268),
    (0.290, 0.385, 0.385, 0.300),
    (0.400, 0.378, 0.420, 0.322),
    (0.470, 0.372, 0.435, 0.330),
    (0.530, 0.390, 0.445, 0.335),
    (0.640, 0.388, 0.450, 0.337),
    (0.760, 0.350, 0.425, 0.312),
    (0.860, 0.285, 0.360, 0.258),
    (0.930, 0.205, 0.270, 0.190),
    (0.980, 0.090, 0.130, 0.090),
];
/// Below this height the jaw is of its own breadth.
const JAW_TO: f32 = 0.29;
/// How square its outline is: see [`Slice::at_angle`].
pub(super) const SQUARE: f32 = 0.95;
/// Half the distance of the eyes, and their height.
pub(super) const EYE: [f32; 2] = [0.140, 0.472];

/// How somebody's face differs from others'.
#[derive(Clone, Copy, Debug)]
pub(super) struct Skull {
    /// Breadth of the jaw, of the cheeks.
    jaw: f32,
    cheeks: f32,
    /// How far the nose stands out, how broad it is and how far down it reaches.
    nose: f32,
    nose_wide: f32,
    nose_tip: f32,
    /// How far brow and chin stand out.
    brow: f32,
    chin: f32,
    /// How full the lips are.
    lips: f32,
}

impl Skull {
    pub(super) fn new(look: &Appearance) -> Self {
        let [a, b, c, d] = look.face;
        let grown = !matches!(look.age, Age::Child);
        // Jaws of men are broader, children's faces rounder with small noses.
        let (jaw, nose, brow, chin) = match (grown, look.woman) {
            (false, _) => (0.95, 0.62, 0.2, 0.5),
            (_, true) => (0.88, 0.85, 0.45, 0.8),
            _ => (1.0, 1.0, 1.0, 1.0),
        };
        let full = match look.build {
            Build::Slim => 0.96,
            Build::Average => 1.0,
            Build::Heavy => 1.07,
        };
        Self {
            jaw: jaw * full * (0.94 + 0.12 * a),
            cheeks: full * (0.97 + 0.05 * b),
            nose: nose * (0.82 + 0.40 * b),
            nose_wide: 0.85 + 0.45 * c,
            nose_tip: 0.340 + 0.030 * (d - 0.5),
            brow: brow * (0.7 + 0.6 * c),
            chin: chin * (0.5 + d),
            lips: (if look.woman { 1.15 } else { 0.85 }) * (0.75 + 0.6 * a),
        }
    }

    /// The slices of a head of no features.
    pub(super) fn slices(&self) -> [(f32, f32, f32, f32); 13] {
        SLICES.map(|(t, front, back, half)| {
            (t, front, back, half * if t < JAW_TO { self.jaw } else { self.cheeks })
        })
    }

    fn slice_at(&self, t: f32) -> Slice {
        let slices = self.slices();
        let [front, back, half] = [0, 1, 2].map(|k| {
            let curve = slices.map(|(t, front, back, half)| (t, [front, back, half][k]));
            curve_at(&curve, t)
        });
        slice(t, front, back, half)
    }

    /// A place on the head without features, at a height and an angle from ahead to the left.
    pub(super) fn bare(&self, t: f32, angle: f32) -> Vec3 {
        self.slice_at(t).at_angle(angle, SQUARE)
    }

    /// The same with the features of the face.
    pub(super) fn surface(&self, t: f32, angle: f32) -> Vec3 {
        let place = self.bare(t, angle);
        let (_, c) = sin_cos(angle);
        if c <= 0.0 {
            return place;
        }
        // Features stand ahead, less on the sides.
        place + Vec3::X * self.feature(t, place.y) * pow(c, 0.35)
    }

    /// How far the face stands out at a height, so far aside.
    fn feature(&self, t: f32, y: f32) -> f32 {
        let aside = y.abs();
        let at = |t0: f32, reach: f32| bump((t - t0) / reach);
        let tip = self.nose_tip;
        let ridge = [
            (tip - 0.048, 0.0),
            (tip - 0.026, 0.060),
            (tip, 0.112),
            (tip + 0.030, 0.100),
            (tip + 0.080, 0.066),
            (tip + 0.140, 0.030),
            (tip + 0.190, 0.010),
            (tip + 0.220, 0.0),
        ];
        let wide = self.nose_wide * curve_at(&[(tip - 0.02, 0.125), (tip + 0.05, 0.095), (0.50, 0.085)], t);
        let nose = self.nose * curve_at(&ridge, t) * bump(aside / wide);
        let sockets = -0.042 * bump((aside - EYE[0]) / 0.115) * at(EYE[1], 0.065);
        let brow = (0.006 + 0.014 * self.brow) * bump((aside - 0.13) / 0.19) * at(0.556, 0.055);
        let cheeks = 0.016 * bump((aside - 0.20) / 0.13) * at(0.385, 0.10);
        let folds = -0.012 * bump((aside - 0.125) / 0.05) * at(0.270, 0.08);
        let lips = self.lips
            * (0.024 * bump(aside / 0.125) * at(0.218, 0.034)
                + 0.026 * bump(aside / 0.11) * at(0.163, 0.032));
        let mouth = -0.016 * bump(aside / 0.14) * at(0.190, 0.020);
        let below = -0.016 * bump(aside / 0.13) * at(0.118, 0.036);
        let chin = 0.026 * self.chin * bump(aside / 0.13) * at(0.055, 0.065);
        nose + sockets + brow + cheeks + folds + lips + mouth + below + chin
    }
}
