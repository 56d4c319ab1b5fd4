//! Planters and tubs with plants.

use glam::Vec3;
use schema::Tag;
use schema::geometry::{MeshPart, Surface};

use super::parts::{CONCRETE, DARK_STEEL, block, pick, still, turned};
use crate::solids::{MeshBuilder, circle};

const fn green(rgb: [f32; 3]) -> MeshPart {
    MeshPart::new(Tag::Vegetation, Surface::Foliage, rgb)
}

const GREENS: [MeshPart; 3] =
    [green([0.05, 0.14, 0.03]), green([0.08, 0.19, 0.04]), green([0.10, 0.17, 0.05])];
const FLOWERS: [[f32; 3]; 5] =
    [[0.62, 0.05, 0.10], [0.75, 0.55, 0.04], [0.70, 0.68, 0.66], [0.36, 0.10, 0.45], [0.75, 0.22, 0.28]];
const SOIL: MeshPart = still(Surface::Plain, [0.07, 0.045, 0.03]);

/// A tuft of pointed leaves about a place, which reach so high and wide.
fn tuft(b: &mut MeshBuilder, part: MeshPart, at: Vec3, [wide, tall]: [f32; 2], leaves: usize, turn: f32) {
    for k in 0..leaves {
        let angle = turn + std::f32::consts::TAU * k as f32 / leaves as f32;
        let (s, c) = frames::math::f32::sin_cos(angle);
        let lean = if k % 2 == 0 { 1.0 } else { 0.55 };
        let tip = at + Vec3::new(c * wide * lean, s * wide * lean, tall * (1.35 - 0.35 * lean).min(1.0));
        let across = Vec3::new(-s, c, 0.0) * 0.035;
        let middle = at.lerp(tip, 0.55) + Vec3::Z * 0.06 * tall;
        // A leaf is a thin solid with a fold.
        let ring = |p: Vec3, share: f32| {
            vec![
                p - across * share,
                p + Vec3::Z * 0.012 * share,
                p + across * share,
                p - Vec3::Z * 0.012 * share,
            ]
        };
        let ordered = |mut r: Vec<Vec3>| {
            r.reverse();
            r
        };
        b.loft(
            &[ordered(ring(at, 0.6)), ordered(ring(middle, 1.0)), ordered(ring(tip, 0.12))],
            |_, _| part,
            [part; 2],
        );
    }
}

/// Flowers on a cushion of leaves: an ellipse in plan, from a height up to another one.
fn cushion(b: &mut MeshBuilder, at: Vec3, half: Vec3, variant: u32) {
    let bump = |ring: usize, side: usize| 0.84 + 0.06 * ((ring * 3 + side * 5 + variant as usize) % 4) as f32;
    b.blob(pick(&GREENS, variant), at, half, 5, 9, bump);
    let flower = green(pick(&FLOWERS, variant));
    let count = 9;
    for (k, (c, s)) in circle(count).enumerate() {
        let out = [0.35f32, 0.62, 0.86][k % 3];
        let up = (1.0 - out * out).sqrt();
        let middle = at + half * Vec3::new(out * c, out * s, 0.86 * up);
        let r = 0.035 + 0.008 * ((k * 5) % 3) as f32;
        b.ellipsoid(flower, middle, Vec3::new(r, r, 0.7 * r), 2, 5);
    }
}

/// A trough with shrubs or flowers.
pub(super) fn planter(b: &mut MeshBuilder, size: Vec3, variant: u32) {
    let half = 0.5 * size;
    let wood = still(Surface::Wood, [0.30, 0.19, 0.10]);
    let trough = pick(&[CONCRETE, wood, DARK_STEEL], variant);
    let top = 0.55f32.min(0.6 * size.z);
    let (low, high) =
        (Vec3::new(-0.94 * half.x, -0.97 * half.y, 0.0), Vec3::new(0.94 * half.x, 0.97 * half.y, 0.92 * top));
    b.cuboid(trough, low, high);
    // A rim round the soil.
    for side in [-1.0f32, 1.0] {
        block(b, trough, [side * (half.x - 0.03), 0.0], [0.03, half.y], [0.90 * top, top]);
        block(b, trough, [0.0, side * (half.y - 0.03)], [half.x - 0.06, 0.03], [0.90 * top, top]);
    }
    block(b, SOIL, [0.0, 0.0], [half.x - 0.06, half.y - 0.06], [0.90 * top, 0.955 * top]);
    let room = size.z - top;
    for (k, y) in [-0.56f32, 0.0, 0.56].into_iter().enumerate() {
        let at = Vec3::new(0.0, y * half.y, top);
        let number = variant + k as u32;
        if (variant / 3 + k as u32).is_multiple_of(2) {
            let tall = 0.46 * room;
            cushion(b, at + Vec3::Z * 0.6 * tall, Vec3::new(0.8 * half.x, 0.30 * half.y, tall), number);
        } else {
            tuft(b, pick(&GREENS, number), at - Vec3::Z * 0.04, [0.75 * half.x, room + 0.03], 9, k as f32);
        }
    }
}

/// A round tub of concrete or wood with flowers.
pub(super) fn flower_tub(b: &mut MeshBuilder, size: Vec3, variant: u32) {
    let r = 0.5 * size.x;
    let wood = still(Surface::Wood, [0.28, 0.17, 0.09]);
    let top = 0.62 * size.z;
    let bowl = [
        (0.0, 0.62 * r),
        (0.08 * size.z, 0.66 * r),
        (0.5 * size.z, 0.96 * r),
        (top - 0.05, r),
        (top, r),
        (top + 0.001, 0.90 * r),
    ];
    turned(
        b,
        pick(&[CONCRETE, wood, still(Surface::Concrete, [0.34, 0.17, 0.11])], variant),
        [0.0; 2],
        &bowl,
        14,
    );
    turned(b, SOIL, [0.0; 2], &[(top - 0.03, 0.89 * r), (top + 0.01, 0.89 * r)], 14);
    let room = size.z - top;
    cushion(b, Vec3::Z * (top + 0.1 * room), Vec3::new(0.84 * r, 0.84 * r, 0.84 * room), variant + 1);
}
