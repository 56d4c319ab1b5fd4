//! Bags: on the back, and at the hip.

use crate::solids::{Detail, MeshBuilder};
use glam::Vec3;

use super::shape::{Shaped, cloth, lofted, slice, strip};
use super::stuffs::Stuffs;
use crate::people::figure::Figure;

pub(super) fn backpack(b: &mut MeshBuilder, f: &Figure, s: &Stuffs, body: &Shaped<'_>, tall: f32) {
    let h = f.stature;
    let size = if f.stature < 1.4 { 0.9 } else { 1.0 };
    let cut = |z: f32, deep: f32, half: f32| {
        slice(z * h, 0.045 * h, deep * h * size, half * h * size).at(-0.052 * h, 0.0)
    };
    let slices = [
        cut(0.000, 0.050, 0.060),
        cut(0.012, 0.070, 0.076),
        cut(0.090, 0.078, 0.080),
        cut(0.160, 0.062, 0.076),
        cut(0.190, 0.045, 0.062),
        cut(0.198, 0.020, 0.040),
    ];
    lofted(b, &slices, 12, 0.6, |_, _| s.extra);
    let pocket = [
        slice(0.02 * h, 0.03 * h, 0.030 * h, 0.050 * h),
        slice(0.085 * h, 0.03 * h, 0.026 * h, 0.048 * h),
        slice(0.095 * h, 0.03 * h, 0.010 * h, 0.040 * h),
    ]
    .map(|c| c.at(-0.115 * h * size, 0.0));
    lofted(b, &pocket, 10, 0.6, |_, _| s.cloth(f.look.extra_rgb.map(|c| 0.6 * c)));
    // Straps over the shoulders and back under the arms; farther away thin bars.
    for side in [1.0, -1.0] {
        if b.detail() == Detail::Full {
            let line = [
                (0.182f32, 2.55f32),
                (0.206, 2.15),
                (0.214, 1.45),
                (0.200, 0.86),
                (0.165, 0.62),
                (0.120, 0.62),
                (0.080, 0.90),
                (0.055, 1.40),
                (0.045, 2.00),
            ];
            let pairs: Vec<[Vec3; 2]> = line
                .iter()
                .map(|(z, angle)| {
                    let at = |d: f32| {
                        let place = body.surface(z * tall * h, side * (angle + d), 0.0065 * h);
                        // Over the shoulder a strap lies on top.
                        let over = (z - 0.19).max(0.0) * 0.6 * h;
                        place * Vec3::new(1.0, 1.0 - 0.8 * (z - 0.19).max(0.0) / 0.024 * 0.35, 1.0)
                            + Vec3::Z * over
                    };
                    [at(-0.11), at(0.11)]
                })
                .collect();
            strip(b, s.extra, &pairs, 0.004 * h, false);
            continue;
        }
        let y = 0.052 * side;
        let thick = cloth(&f.look);
        let points = [
            Vec3::new(-0.055, y, 0.185),
            Vec3::new(-0.012, 1.08 * y, 0.214),
            Vec3::new(0.042, 1.12 * y, 0.185),
            Vec3::new(0.058 * thick, 1.15 * y, 0.120),
            Vec3::new(0.030, 1.65 * y, 0.060),
        ];
        for pair in points.windows(2) {
            b.bar(s.extra, pair[0] * h, pair[1] * h, [0.008 * h; 2], 5);
        }
    }
}

pub(super) fn shoulder_bag(b: &mut MeshBuilder, f: &Figure, s: &Stuffs) {
    let h = f.stature;
    let leather = s.extra;
    let side = -(0.122 * f.look.girth() * cloth(&f.look)) * h;
    let cut = |z: f32, long: f32, half: f32| slice(z * h, long * h, long * h, half * h).at(-0.035 * h, side);
    let slices = [
        cut(-0.165, 0.060, 0.018),
        cut(-0.155, 0.070, 0.024),
        cut(-0.090, 0.068, 0.022),
        cut(-0.066, 0.062, 0.012),
    ];
    lofted(b, &slices, 12, 0.6, |_, _| leather);
    let over = Vec3::new(0.0, 0.062, 0.214) * h;
    let thick = cloth(&f.look) * f.look.girth();
    for x in [0.060 * thick, -0.064 * thick] {
        let breast = Vec3::new(x, 0.012, 0.130) * h;
        let hip = Vec3::new(0.7 * x * h, side + 0.018 * h, -0.02 * h);
        let clasp = Vec3::new((-0.035 + if x > 0.0 { 0.04 } else { -0.04 }) * h, side, -0.075 * h);
        for pair in [over, breast, hip, clasp].windows(2) {
            b.bar(leather, pair[0], pair[1], [0.008 * h; 2], 5);
        }
    }
}
