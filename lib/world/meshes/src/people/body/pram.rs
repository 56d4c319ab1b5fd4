//! Prams: a tub with a hood on a frame of four wheels, or a seat.

use crate::solids::{Detail, MeshBuilder};
use glam::Vec3;
use schema::geometry::{MeshPart, Surface};

use super::shape::{lofted, slice};
use super::stuffs::Stuffs;
use crate::people::figure::Figure;
use crate::people::pram::{Axle, FRONT, REAR};

/// Thickness of a wheel, metres.
const TYRE_M: f32 = 0.034;

/// All but the wheels, from the ground below the hips of the person who pushes.
pub(super) fn frame(b: &mut MeshBuilder, f: &Figure, s: &Stuffs) {
    let tube = MeshPart::new(s.tag, Surface::Metal, [0.10, 0.10, 0.11]);
    let grip = MeshPart::new(s.tag, Surface::Rubber, [0.03, 0.03, 0.032]);
    let [ahead, up] = f.handle_m();
    let wide = 0.21;
    for y in [-wide, wide] {
        let at = |x: f32, z: f32| Vec3::new(x, y, z);
        // From the handle to the front wheels, and across from the rear ones to the tub.
        b.bar(tube, at(ahead, up), at(0.86, 0.48), [0.012; 2], 6);
        b.bar(tube, at(0.86, 0.48), Vec3::new(FRONT.ahead, 0.80 * y, FRONT.radius), [0.012; 2], 6);
        b.bar(tube, Vec3::new(REAR.ahead, 1.1 * y, REAR.radius), at(1.06, 0.56), [0.012; 2], 6);
    }
    b.bar(grip, Vec3::new(ahead, -wide, up), Vec3::new(ahead, wide, up), [0.016; 2], 8);
    for axle in [FRONT, REAR] {
        let end = Vec3::new(axle.ahead, axle.aside, axle.radius);
        b.bar(tube, end * Vec3::new(1.0, -1.0, 1.0), end, [0.010; 2], 6);
    }
    // A net of things below.
    let net = s.cloth([0.02; 3]);
    b.tapered(net, Vec3::new(0.76, -0.16, 0.17), Vec3::new(1.14, 0.16, 0.27), 1.08, 1.05);
    if f.look.woman == (f.look.dog_m > 0.41) { tub(b, s) } else { seat(b, s) }
}

/// A tub for a baby, who looks back; the hood is at the far end.
fn tub(b: &mut MeshBuilder, s: &Stuffs) {
    let cut = |z: f32, long: f32, half: f32| slice(z, long, long, half).at(0.955, 0.0);
    let slices = [
        cut(0.520, 0.28, 0.12),
        cut(0.535, 0.32, 0.155),
        cut(0.640, 0.355, 0.180),
        cut(0.740, 0.365, 0.190),
        cut(0.752, 0.350, 0.175),
    ];
    lofted(b, &slices, 16, 0.75, |_, _| s.extra);
    let cover = s.cloth(s.extra.rgb.map(|c| 0.5 * c + 0.12));
    b.ellipsoid(cover, Vec3::new(0.84, 0.0, 0.745), Vec3::new(0.22, 0.165, 0.045), 6, 14);
    hood(b, s, 1.14);
}

/// A seat for an infant, who looks ahead; the hood is at the near end.
fn seat(b: &mut MeshBuilder, s: &Stuffs) {
    let dark = s.cloth(s.extra.rgb.map(|c| 0.55 * c));
    let cut = |z: f32, x: f32, long: f32, half: f32| slice(z, long, long, half).at(x, 0.0);
    let back = [
        cut(0.46, 0.92, 0.050, 0.155),
        cut(0.50, 0.91, 0.065, 0.175),
        cut(0.80, 0.78, 0.055, 0.175),
        cut(0.96, 0.72, 0.030, 0.150),
    ];
    lofted(b, &back, 12, 0.7, |_, _| s.extra);
    let floor = [
        cut(0.43, 1.02, 0.16, 0.150),
        cut(0.45, 1.02, 0.19, 0.170),
        cut(0.50, 1.02, 0.19, 0.170),
        cut(0.52, 1.02, 0.17, 0.155),
    ];
    lofted(b, &floor, 12, 0.7, |_, _| s.extra);
    // Foot muff over the legs, rest below.
    b.ellipsoid(dark, Vec3::new(1.08, 0.0, 0.55), Vec3::new(0.19, 0.145, 0.085), 6, 12);
    b.tapered(dark, Vec3::new(1.16, -0.12, 0.28), Vec3::new(1.20, 0.12, 0.47), 1.0, 1.1);
    b.ellipsoid(s.skin, Vec3::new(0.88, 0.0, 0.80), Vec3::new(0.075, 0.070, 0.090), 6, 10);
    let coat = s.cloth(s.extra.rgb.map(|c| 0.3 * c + 0.25));
    b.ellipsoid(coat, Vec3::new(0.93, 0.0, 0.65), Vec3::new(0.095, 0.115, 0.130), 6, 12);
    b.ellipsoid(coat, Vec3::new(0.868, 0.0, 0.832), Vec3::new(0.080, 0.078, 0.076), 6, 10);
    hood(b, s, 0.78);
}

/// Half a ball about a place on the tub's edge.
fn hood(b: &mut MeshBuilder, s: &Stuffs, x: f32) {
    let dark = s.cloth(s.extra.rgb.map(|c| 0.7 * c));
    let far = x > 1.0;
    let z = if far { 0.735 } else { 0.86 };
    let sides = |up: f32, low: f32, half: f32, long: f32| {
        let (front, back) = if far { (long, low) } else { (low, long) };
        slice(z + up, front, back, half).at(x, 0.0)
    };
    let slices = [
        sides(0.00, 0.03, 0.185, 0.18),
        sides(0.09, 0.05, 0.180, 0.165),
        sides(0.16, 0.06, 0.160, 0.135),
        sides(0.21, 0.05, 0.125, 0.095),
        sides(0.235, 0.03, 0.070, 0.050),
    ];
    lofted(b, &slices, 14, 0.85, |_, _| dark);
}

/// Both wheels of an axle, about its middle.
pub(super) fn wheels(b: &mut MeshBuilder, s: &Stuffs, axle: &Axle) {
    let tyre = MeshPart::new(s.tag, Surface::Rubber, [0.03, 0.03, 0.032]);
    let rim = MeshPart::new(s.tag, Surface::Metal, [0.45, 0.46, 0.48]);
    let spoke = MeshPart::new(s.tag, Surface::Metal, [0.06, 0.06, 0.065]);
    for side in [-1.0, 1.0] {
        let hub = Vec3::Y * side * axle.aside;
        let across = |half: f32| [hub - Vec3::Y * half, hub + Vec3::Y * half];
        let [a, z] = across(0.5 * TYRE_M);
        b.bar(tyre, a, z, [axle.radius; 2], 16);
        if b.detail() == Detail::Coarse {
            continue;
        }
        let [a, z] = across(0.5 * TYRE_M + 0.003);
        b.bar(rim, a, z, [0.72 * axle.radius; 2], 12);
        let (long, half) = (0.66 * axle.radius, 0.5 * TYRE_M + 0.006);
        for reach in [Vec3::new(long, half, 0.011), Vec3::new(0.011, half, long)] {
            b.cuboid(spoke, hub - reach, hub + reach);
        }
    }
}
