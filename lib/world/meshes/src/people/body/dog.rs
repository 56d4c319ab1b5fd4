//! Dogs: trunk, head, tail and legs, and the lead.

use crate::solids::{Detail, MeshBuilder};
use glam::Vec3;
use schema::geometry::{MeshPart, Surface};

use super::shape::{lofted, slice};
use super::stuffs::Stuffs;
use crate::people::dog::Dog;

/// The trunk about its middle, the chest ahead.
pub(super) fn trunk(b: &mut MeshBuilder, dog: &Dog, s: &Stuffs) {
    let m = dog.back;
    let cut = |x: f32, down: f32, up: f32, half: f32| slice(x * m, down * m, up * m, half * m);
    // As if it stood on its tail: ahead is up and the belly in front.
    let slices = [
        cut(-0.54, 0.02, 0.05, 0.03),
        cut(-0.50, 0.08, 0.14, 0.10),
        cut(-0.40, 0.15, 0.20, 0.145),
        cut(-0.20, 0.14, 0.20, 0.140),
        cut(0.05, 0.19, 0.205, 0.155),
        cut(0.25, 0.25, 0.215, 0.165),
        cut(0.40, 0.23, 0.20, 0.145),
        cut(0.49, 0.13, 0.13, 0.095),
        cut(0.53, 0.03, 0.05, 0.035),
    ];
    lofted(b, &slices, 10, 1.0, |_, _| s.extra);
    b.reshape(|p| Vec3::new(p.z, p.y, -p.x));
}

/// Neck, skull, muzzle and ears, from the neck's lower end.
pub(super) fn head(b: &mut MeshBuilder, dog: &Dog, s: &Stuffs) {
    let m = dog.back;
    let at = |x: f32, y: f32, z: f32| Vec3::new(x, y, z) * m;
    let nose = s.cloth([0.012; 3]);
    let band = s.cloth([0.32, 0.03, 0.03]);
    b.bar(s.extra, at(-0.06, 0.0, -0.10), at(0.15, 0.0, 0.27), [0.135 * m, 0.095 * m], 10);
    b.bar(band, at(0.025, 0.0, 0.055), at(0.052, 0.0, 0.103), [0.124 * m, 0.119 * m], 10);
    if b.detail() == Detail::Coarse {
        // Skull and muzzle in one: neither alone is long enough to be kept.
        b.bar(s.extra, at(0.03, 0.0, 0.30), at(0.455, 0.0, 0.24), [0.115 * m, 0.055 * m], 8);
        return;
    }
    b.ellipsoid(s.extra, at(0.19, 0.0, 0.30), at(0.145, 0.115, 0.115), 8, 10);
    b.bar(s.extra, at(0.24, 0.0, 0.27), at(0.43, 0.0, 0.235), [0.080 * m, 0.052 * m], 8);
    b.ellipsoid(nose, at(0.435, 0.0, 0.252), at(0.025, 0.030, 0.024), 4, 6);
    let upright = dog.back > 0.40;
    for side in [-1.0, 1.0] {
        let root = at(0.12, 0.085 * side, 0.375);
        // They stand up, or hang.
        let tip = if upright { at(0.10, 0.105 * side, 0.53) } else { at(0.15, 0.135 * side, 0.22) };
        b.bar(s.extra, root, tip, [0.058 * m, 0.018 * m], 5);
        b.ellipsoid(nose, at(0.300, 0.062 * side, 0.335), at(0.018, 0.014, 0.016), 4, 5);
    }
}

/// The tail, from its root.
pub(super) fn tail(b: &mut MeshBuilder, dog: &Dog, s: &Stuffs) {
    let m = dog.back;
    let points = [Vec3::new(0.04, 0.0, -0.03), Vec3::new(-0.09, 0.0, 0.09), Vec3::new(-0.13, 0.0, 0.32)];
    let radii = [0.052 * m, 0.042 * m, 0.016 * m];
    for k in 0..2 {
        b.bar(s.extra, points[k] * m, points[k + 1] * m, [radii[k], radii[k + 1]], 6);
    }
    b.ellipsoid(s.extra, points[1] * m, Vec3::splat(0.044 * m), 4, 6);
}

/// The upper half of a leg, hanging; hind ones have thighs.
pub(super) fn upper_leg(b: &mut MeshBuilder, dog: &Dog, s: &Stuffs, hind: bool) {
    let (m, by) = (dog.back, if hind { 1.25 } else { 1.0 });
    let cut = |z: f32, front: f32, back: f32, half: f32| {
        slice(z * dog.leg, front * by * m, back * by * m, half * m)
    };
    let slices = [
        cut(-1.08, 0.020, 0.025, 0.030),
        cut(-1.00, 0.045, 0.048, 0.045),
        cut(-0.50, 0.075, 0.085, 0.060),
        cut(0.00, 0.095, 0.105, 0.070),
        cut(0.25, 0.050, 0.055, 0.040),
    ];
    lofted(b, &slices, 8, 1.0, |_, _| s.extra);
}

/// The lower half of a leg, hanging, with its paw.
pub(super) fn lower_leg(b: &mut MeshBuilder, dog: &Dog, s: &Stuffs) {
    let (m, paw) = (dog.back, dog.paw);
    b.bar(s.extra, Vec3::Z * 0.10 * dog.leg, Vec3::NEG_Z * dog.leg, [0.046 * m, 0.034 * m], 7);
    if b.detail() != Detail::Coarse {
        let middle = Vec3::new(0.25 * paw, 0.0, -dog.leg);
        b.ellipsoid(s.extra, middle, Vec3::new(1.15 * paw, 0.95 * paw, paw), 6, 8);
    }
}

/// Half of the lead, hanging.
pub(super) fn lead(b: &mut MeshBuilder, s: &Stuffs, length_m: f32) {
    let strap = MeshPart::new(s.tag, Surface::Cloth, [0.28, 0.03, 0.03]);
    b.bar(strap, Vec3::NEG_Z * length_m, Vec3::ZERO, [0.006; 2], 5);
}
