//! The terrace of a cafe.

use glam::Vec3;
use schema::Tag;
use schema::geometry::{MeshPart, Surface};

use super::parts::{CONCRETE, DARK_STEEL, STEEL, block, loose, pick, still, turned};
use crate::solids::{Detail, MeshBuilder, circle};

/// Two tables with two chairs each, a parasol between them.
pub(super) fn cafe(b: &mut MeshBuilder, size: Vec3, variant: u32) {
    let half = 0.5 * size;
    let top = pick(
        &[still(Surface::Wood, [0.36, 0.22, 0.11]), STEEL, still(Surface::Plain, [0.62, 0.60, 0.56])],
        variant,
    );
    let cloth =
        pick(&[[0.56, 0.06, 0.04], [0.62, 0.58, 0.46], [0.05, 0.20, 0.12], [0.06, 0.12, 0.30]], variant);
    let seat = loose(
        Surface::Plain,
        pick(&[[0.08, 0.08, 0.085], [0.45, 0.28, 0.12], [0.50, 0.08, 0.05]], variant / 2),
    );
    let y_table = 0.5 * half.y + 0.02;
    for side in [-1.0f32, 1.0] {
        let at = [0.0, side * y_table];
        turned(b, DARK_STEEL, at, &[(0.0, 0.22), (0.02, 0.22), (0.04, 0.03), (0.70, 0.03)], 6);
        turned(b, top, at, &[(0.70, 0.36), (0.735, 0.36)], 10);
        chair(b, seat, [at[0], at[1] + 0.62], 1.0);
        chair(b, seat, [at[0], at[1] - 0.62], -1.0);
    }
    // The parasol: a heavy foot, a pole, a canopy of eight panels.
    turned(b, CONCRETE, [0.0; 2], &[(0.0, 0.26), (0.07, 0.26), (0.09, 0.10)], 8);
    b.bar(still(Surface::Wood, [0.40, 0.27, 0.15]), Vec3::Z * 0.08, Vec3::Z * (size.z - 0.03), [0.022; 2], 6);
    let canopy = MeshPart::new(Tag::Other, Surface::Cloth, cloth);
    let r = half.x.min(half.y);
    let ring = |z: f32, r: f32| -> Vec<Vec3> { circle(8).map(|(c, s)| Vec3::new(r * c, r * s, z)).collect() };
    // A flap hangs from its rim.
    let rings = [ring(2.0, 0.985 * r), ring(2.14, r), ring(size.z - 0.02, 0.06), ring(size.z, 0.02)];
    b.loft(&rings, |_, _| canopy, [canopy; 2]);
}

/// A chair whose back is on the side of `away` along y.
fn chair(b: &mut MeshBuilder, part: MeshPart, [x, y]: [f32; 2], away: f32) {
    block(b, part, [x, y], [0.21, 0.20], [0.43, 0.465]);
    let back = y + away * 0.19;
    block(b, part, [x, back], [0.20, 0.012], [0.60, 0.84]);
    for dx in [-0.185, 0.185] {
        if b.detail() > Detail::Full {
            block(b, part, [x + dx, y], [0.012, 0.19], [0.0, 0.44]);
            continue;
        }
        b.bar(
            part,
            Vec3::new(x + dx, y - away * 0.18, 0.0),
            Vec3::new(x + dx, y - away * 0.18, 0.44),
            [0.016; 2],
            4,
        );
        b.bar(part, Vec3::new(x + dx, back, 0.0), Vec3::new(x + dx, back, 0.86), [0.016; 2], 4);
    }
}
