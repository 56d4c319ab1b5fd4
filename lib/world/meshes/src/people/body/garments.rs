//! What closes clothes: collars, zips, buttons, lapels, ties, belts, pockets, hoods.

use std::f32::consts::TAU;

use crate::solids::{Detail, MeshBuilder};
use glam::Vec3;
use schema::geometry::{MeshPart, Surface};

use super::shape::{Shaped, slice, solid, strip};
use super::stuffs::Stuffs;
use crate::people::appearance::Top;
use crate::people::figure::Figure;

/// Strips lie so far off the body, shares of the stature.
const OFF: f32 = 0.0016;

/// The trunk on which clothes are fastened.
struct Front<'a, 'b> {
    b: &'a mut MeshBuilder,
    body: &'a Shaped<'b>,
    /// Stature, and how tall the chest is for that.
    h: f32,
    tall: f32,
}

impl Front<'_, '_> {
    /// A place on the body at a height over the waist (share of the stature), so far off it.
    fn at(&self, z: f32, angle: f32, off: f32) -> Vec3 {
        let z = if z > 0.0 { z * self.tall } else { z };
        self.body.surface(z * self.h, angle, off * self.h)
    }

    /// A strip along lines of `(height, left angle, right angle)`.
    fn lay(&mut self, part: MeshPart, line: &[(f32, f32, f32)], off: f32) {
        let pairs: Vec<[Vec3; 2]> =
            line.iter().map(|(z, left, right)| [self.at(*z, *right, off), self.at(*z, *left, off)]).collect();
        strip(self.b, part, &pairs, 0.004 * self.h, false);
    }

    /// The same all along the front, so wide.
    fn seam(&mut self, part: MeshPart, [low, high]: [f32; 2], half: f32, off: f32) {
        let steps = 12;
        let line: Vec<(f32, f32, f32)> =
            (0..=steps).map(|i| (low + (high - low) * i as f32 / steps as f32, half, -half)).collect();
        self.lay(part, &line, off);
    }

    /// What is worn below, seen in an opening from a place on the front up to the neck.
    fn opening(&mut self, part: MeshPart, low: f32, wide: f32) {
        let steps = 5;
        for side in [1.0, -1.0] {
            let line: Vec<(f32, f32, f32)> = (0..=steps)
                .map(|i| {
                    let t = i as f32 / steps as f32;
                    let z = low + (0.224 - low) * t;
                    let edge = side * wide * (0.10 + 0.90 * t);
                    if side > 0.0 { (z, edge, 0.0) } else { (z, 0.0, edge) }
                })
                .collect();
            self.lay(part, &line, 2.4 * OFF);
        }
    }

    /// Lapels or the two sides of an open collar along such an opening.
    fn lapels(&mut self, part: MeshPart, low: f32, wide: f32, broad: f32) {
        for side in [1.0, -1.0] {
            let line = [
                (0.0f32, 0.10, 0.02),
                (0.35, 0.42, 0.55),
                (0.62, 0.68, 1.0),
                (0.68, 0.74, 0.62),
                (1.0, 1.05, 0.50),
            ];
            let line: Vec<(f32, f32, f32)> = line
                .iter()
                .map(|(t, edge, out)| {
                    let z = low + (0.224 - low) * t;
                    let (inner, outer) = (side * wide * edge, side * (wide * edge + broad * out));
                    if side > 0.0 { (z, outer, inner) } else { (z, inner, outer) }
                })
                .collect();
            self.lay(part, &line, 3.2 * OFF);
        }
    }

    fn buttons(&mut self, part: MeshPart, [low, high]: [f32; 2], number: usize) {
        for i in 0..number {
            let z = low + (high - low) * i as f32 / (number - 1).max(1) as f32;
            let middle = self.at(z, 0.0, 2.0 * OFF);
            self.b.ellipsoid(part, middle, Vec3::new(0.002, 0.0042, 0.0042) * self.h, 2, 6);
        }
    }

    /// A folded collar about the neck, which lies on the chest: its points are ahead at an angle on either
    /// side, and at a height over the waist; behind them it ends at another.
    fn collar(&mut self, part: MeshPart, tips: f32, [tip_z, low_z]: [f32; 2], high: f32) {
        let (h, tall) = (self.h, self.tall);
        let n = 14;
        let pairs: Vec<[Vec3; 2]> = (0..=n)
            .map(|i| {
                let u = i as f32 / n as f32;
                let around = |free: f32| free + (TAU - 2.0 * free) * u;
                // Higher behind, and pointed ahead.
                let behind = 0.5 - 0.5 * frames::math::f32::cos(TAU * u);
                let tip = (1.0 - (u.min(1.0 - u) / 0.13)).max(0.0);
                let neck = slice(
                    (0.222 + high * (0.30 + 0.70 * behind)) * tall * h,
                    0.035 * h,
                    0.040 * h,
                    0.037 * h,
                );
                let low = self.at(low_z + (tip_z - low_z) * tip, around(tips), 3.0 * OFF);
                [low, neck.at_angle(around(0.35 * tips), 1.0)]
            })
            .collect();
        strip(self.b, part, &pairs, 0.005 * h, false);
    }

    /// A band that stands about the neck.
    fn standing(&mut self, part: MeshPart, high: f32) {
        let h = self.h;
        let at = |z: f32| z * self.tall * h;
        let ring = [
            slice(at(0.205), 0.038 * h, 0.044 * h, 0.054 * h),
            slice(at(0.226), 0.035 * h, 0.040 * h, 0.041 * h),
            slice(at(0.228 + high), 0.035 * h, 0.040 * h, 0.039 * h),
            slice(at(0.226 + high), 0.030 * h, 0.034 * h, 0.033 * h),
        ];
        let ring = if high > 0.004 { &ring[..] } else { &ring[..2] };
        solid(self.b, part, ring, 12);
    }

    /// A flap of a pocket on either side of the front.
    fn pockets(&mut self, part: MeshPart, z: f32, [near, far]: [f32; 2], tall: f32) {
        for side in [1.0, -1.0] {
            let line: Vec<(f32, f32, f32)> =
                [near, 0.5 * (near + far), far].iter().map(|angle| (z, side * angle, 0.0)).collect();
            let pairs: Vec<[Vec3; 2]> = line
                .iter()
                .map(|(z, angle, _)| [self.at(*z, *angle, 1.5 * OFF), self.at(*z + tall, *angle, 1.5 * OFF)])
                .collect();
            strip(self.b, part, &pairs, 0.003 * self.h, false);
        }
    }
}

/// Adds what closes the top, and what is on it.
pub(super) fn fastened(b: &mut MeshBuilder, f: &Figure, s: &Stuffs, body: &Shaped<'_>, tall: f32) {
    let look = &f.look;
    let full = b.detail() == Detail::Full;
    let mut it = Front { b, body, h: f.stature, tall };
    let white = s.cloth([0.66, 0.66, 0.64]);
    let metal = MeshPart::new(s.tag, Surface::Metal, [0.30; 3]);
    let dark = s.cloth([0.02; 3]);
    // Wide enough to be seen, whatever the chest measures around.
    let bit = 0.030;
    match look.top {
        Top::Tee | Top::Dress => {
            let neck = if look.woman { 0.42 } else { 0.30 };
            it.opening(s.skin, 0.196 - 0.02 * look.face[1], neck);
        }
        Top::Shirt => {
            it.opening(s.skin, 0.186, 0.30);
            it.collar(s.top, 0.42, [0.200, 0.2135], 0.022);
            it.seam(s.trim, [-0.015, 0.190], 0.040, OFF);
            it.buttons(white, [0.0, 0.180], 6);
        }
        Top::Suit => {
            let low = 0.085;
            it.opening(white, low, 0.42);
            it.collar(white, 0.36, [0.206, 0.2220], 0.024);
            it.collar(s.top, 0.80, [0.206, 0.2135], 0.010);
            it.lapels(s.top, low, 0.40, 0.24);
            if look.woman {
                it.opening(s.skin, 0.185, 0.24);
            } else {
                let tie = s.accent;
                it.lay(
                    tie,
                    &[(low, 0.05, -0.05), (0.11, 0.10, -0.10), (0.18, 0.07, -0.07), (0.212, 0.06, -0.06)],
                    3.6 * OFF,
                );
                it.lay(tie, &[(0.204, 0.05, -0.05), (0.224, 0.14, -0.14)], 4.4 * OFF);
            }
            it.seam(s.trim, [-0.135, low], 0.010, OFF);
            it.buttons(dark, [0.02, 0.07], 2);
            it.pockets(s.trim, -0.060, [0.55, 1.05], 0.010);
        }
        Top::Jacket => {
            if look.open() {
                // Open: what is below shows all the way down.
                it.opening(s.accent, 0.03, 0.34);
                it.lapels(s.top, 0.03, 0.34, 0.13);
            } else {
                it.standing(s.top, 0.016);
            }
            it.seam(metal, [-0.108, 0.030], 0.5 * bit, OFF);
            if !look.open() {
                it.seam(metal, [0.030, 0.212], 0.5 * bit, OFF);
            }
            it.pockets(s.trim, -0.050, [0.50, 0.95], 0.030);
        }
        Top::Coat => {
            let low = 0.120;
            it.opening(s.accent, low, 0.36);
            it.lapels(s.top, low, 0.36, 0.26);
            it.collar(s.top, 0.62, [0.205, 0.2135], 0.018);
            it.seam(s.trim, [-0.018, low], 0.014, OFF);
            it.buttons(dark, [-0.005, 0.105], 3);
        }
        Top::Hoodie => {
            let h = f.stature;
            let at = |z: f32| z * tall * h;
            // The hood lies on the shoulders and the back.
            let hood = [
                slice(at(0.168), -0.020 * h, 0.074 * h, 0.034 * h),
                slice(at(0.185), -0.004 * h, 0.080 * h, 0.052 * h),
                slice(at(0.210), 0.026 * h, 0.076 * h, 0.060 * h),
                slice(at(0.232), 0.036 * h, 0.062 * h, 0.054 * h),
                slice(at(0.243), 0.032 * h, 0.050 * h, 0.046 * h),
            ];
            solid(it.b, s.top, &hood, 12);
            if full {
                // A pouch, and the cords.
                let pouch: Vec<(f32, f32, f32)> =
                    [(-0.070, 0.55), (-0.020, 0.50), (0.005, 0.34)].map(|(z, a)| (z, a, 0.0)).to_vec();
                for side in [1.0, -1.0] {
                    let line: Vec<(f32, f32, f32)> = pouch
                        .iter()
                        .map(|(z, a, _)| if side > 0.0 { (*z, *a, 0.0) } else { (*z, 0.0, -*a) })
                        .collect();
                    it.lay(s.top, &line, 1.6 * OFF);
                }
                for side in [1.0, -1.0] {
                    it.lay(
                        white,
                        &[
                            (0.140, side * 0.16 + 0.02, side * 0.16 - 0.02),
                            (0.214, side * 0.20 + 0.025, side * 0.20 - 0.025),
                        ],
                        3.4 * OFF,
                    );
                }
            }
        }
        Top::HiVis => {
            it.standing(s.top, 0.006);
            it.seam(s.trim, [-0.115, 0.212], 0.5 * bit, 1.6 * OFF);
        }
        Top::Uniform => {
            it.collar(s.top, 0.38, [0.203, 0.2135], 0.022);
            it.seam(s.trim, [-0.015, 0.205], 0.5 * bit, 1.6 * OFF);
            it.pockets(s.trim, 0.135, [0.40, 0.75], 0.012);
        }
    }
}

/// A belt in the loops of trousers, where the top is tucked in, and its buckle.
pub(super) fn belt(b: &mut MeshBuilder, f: &Figure, s: &Stuffs, body: &Shaped<'_>) {
    if !f.look.tucked() && f.look.top != Top::Uniform {
        return;
    }
    let h = f.stature;
    let leather = s.cloth(f.look.shoe_rgb.map(|c| (0.6 * c).min(0.12)));
    let n = 18;
    let pairs: Vec<[Vec3; 2]> = (0..n)
        .map(|i| {
            let angle = TAU * i as f32 / n as f32;
            [0.066, 0.084].map(|z| body.surface(z * h, angle, 0.007 * h))
        })
        .collect();
    strip(b, leather, &pairs, 0.006 * h, true);
    let buckle = MeshPart::new(s.tag, Surface::Metal, [0.35; 3]);
    let middle = body.surface(0.075 * h, 0.0, 0.008 * h);
    if b.detail() == Detail::Full {
        b.cuboid(
            buckle,
            middle - Vec3::new(0.003, 0.011, 0.009) * h,
            middle + Vec3::new(0.002, 0.011, 0.009) * h,
        );
    }
}
