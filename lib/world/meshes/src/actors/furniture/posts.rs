//! Bollards, hydrants, marker posts, meters and pumps.

use glam::Vec3;
use schema::Tag;
use schema::geometry::{MeshPart, Surface};

use super::outline::along_x;
use super::parts::{BLACK, CONCRETE, DARK_STEEL, STEEL, block, pick, still, turned};
use crate::solids::MeshBuilder;

const WHITE: MeshPart = still(Surface::Plain, [0.80, 0.80, 0.78]);
const RED_BAND: MeshPart = still(Surface::Reflector, [0.60, 0.03, 0.02]);
const WHITE_BAND: MeshPart = still(Surface::Reflector, [0.82, 0.82, 0.80]);

/// A row of four bollards along y: of cast iron with a ball, of steel with a band, of concrete, of wood.
pub(super) fn bollards(b: &mut MeshBuilder, size: Vec3, variant: u32) {
    let r = 0.5 * size.x;
    let (count, h) = (4, size.z);
    for i in 0..count {
        let y = -0.5 * size.y + r + (size.y - 2.0 * r) * i as f32 / (count - 1) as f32;
        let at = [0.0, y];
        match variant % 4 {
            0 => {
                let foot =
                    [(0.0, r), (0.06, r), (0.10, 0.66 * r), (0.80 * h, 0.56 * r), (0.84 * h, 0.80 * r)];
                turned(b, DARK_STEEL, at, &foot, 8);
                let ball = [(0.84 * h, 0.5 * r), (0.90 * h, 0.86 * r), (0.96 * h, 0.74 * r), (h, 0.2 * r)];
                turned(b, DARK_STEEL, at, &ball, 8);
            }
            1 => {
                let body = [(0.0, r), (0.012, r), (0.013, 0.7 * r), (0.78 * h, 0.7 * r)];
                turned(b, STEEL, at, &body, 8);
                turned(b, WHITE_BAND, at, &[(0.78 * h, 0.71 * r), (0.90 * h, 0.71 * r)], 8);
                turned(b, STEEL, at, &[(0.90 * h, 0.7 * r), (0.98 * h, 0.7 * r), (h, 0.5 * r)], 8);
            }
            2 => {
                let body = [(0.0, r), (0.86 * h, 0.88 * r), (0.96 * h, 0.70 * r), (h, 0.30 * r)];
                turned(b, CONCRETE, at, &body, 8);
            }
            _ => {
                let wood = still(Surface::Wood, [0.26, 0.16, 0.08]);
                let (low, high) = (Vec3::new(-r, y - r, 0.0), Vec3::new(r, y + r, 0.94 * h));
                b.cuboid(wood, low, high);
                b.tapered(wood, low + Vec3::Z * 0.94 * h, Vec3::new(r, y + r, h), 0.5, 0.5);
                let x = [-r - 0.0, r];
                b.cuboid(
                    WHITE_BAND,
                    Vec3::new(x[1] - 0.01, y - 0.6 * r, 0.72 * h),
                    Vec3::new(x[1], y + 0.6 * r, 0.84 * h),
                );
            }
        }
    }
}

/// An American hydrant: a barrel with a bonnet, two hose caps and a pumper cap.
pub(super) fn hydrant_barrel(b: &mut MeshBuilder, size: Vec3, variant: u32) {
    let (half, h) = (0.5 * size, size.z);
    let body =
        still(Surface::Plain, pick(&[[0.55, 0.03, 0.02], [0.66, 0.40, 0.02], [0.60, 0.60, 0.58]], variant));
    let caps =
        still(Surface::Plain, pick(&[[0.55, 0.55, 0.53], [0.03, 0.12, 0.40], [0.55, 0.03, 0.02]], variant));
    let r = 0.62 * half.x;
    turned(
        b,
        body,
        [0.0; 2],
        &[(0.0, 1.4 * r), (0.05 * h, 1.4 * r), (0.06 * h, r), (0.60 * h, 0.92 * r)],
        12,
    );
    turned(b, body, [0.0; 2], &[(0.60 * h, 1.25 * r), (0.66 * h, 1.25 * r)], 12);
    let bonnet = [(0.66 * h, 1.08 * r), (0.78 * h, 0.98 * r), (0.88 * h, 0.70 * r), (0.93 * h, 0.32 * r)];
    turned(b, body, [0.0; 2], &bonnet, 12);
    turned(b, caps, [0.0; 2], &[(0.92 * h, 0.26 * r), (h, 0.20 * r)], 5);
    for side in [-1.0f32, 1.0] {
        let at = |y: f32| Vec3::new(0.0, side * y, 0.50 * h);
        b.bar(body, at(0.5 * r), at(0.80 * half.y), [0.40 * r; 2], 8);
        b.bar(caps, at(0.78 * half.y), at(half.y), [0.52 * r, 0.40 * r], 8);
    }
    let at = |x: f32| Vec3::new(x, 0.0, 0.44 * h);
    b.bar(body, at(0.5 * r), at(0.82 * half.x), [0.55 * r; 2], 8);
    b.bar(caps, at(0.80 * half.x), at(half.x), [0.66 * r, 0.52 * r], 8);
}

/// A European pillar hydrant: a column under a round head, an outlet on either side.
pub(super) fn hydrant_pillar(b: &mut MeshBuilder, size: Vec3, variant: u32) {
    let (half, h) = (0.5 * size, size.z);
    let body =
        still(Surface::Plain, pick(&[[0.05, 0.16, 0.42], [0.50, 0.04, 0.03], [0.32, 0.33, 0.33]], variant));
    let r = 0.55 * half.x;
    turned(b, body, [0.0; 2], &[(0.0, half.x), (0.03 * h, half.x), (0.05 * h, r), (0.72 * h, r)], 12);
    let head = [(0.72 * h, 1.32 * r), (0.82 * h, 1.38 * r), (0.92 * h, 1.10 * r), (h, 0.34 * r)];
    turned(b, body, [0.0; 2], &head, 12);
    turned(b, WHITE_BAND, [0.0; 2], &[(0.66 * h, 1.02 * r), (0.70 * h, 1.02 * r)], 12);
    for side in [-1.0f32, 1.0] {
        let (from, to) =
            (Vec3::new(0.0, side * 0.5 * r, 0.56 * h), Vec3::new(0.0, side * 0.95 * half.y, 0.53 * h));
        b.bar(STEEL, from, to, [0.46 * r, 0.50 * r], 8);
    }
}

/// A post with the plate that tells where a hydrant lies in the ground.
pub(super) fn hydrant_post(b: &mut MeshBuilder, size: Vec3, variant: u32) {
    let (half, h) = (0.5 * size, size.z);
    let post = pick(&[STEEL, CONCRETE], variant);
    block(b, post, [-0.35 * half.x, 0.0], [0.55 * half.x, 0.03], [0.0, h]);
    let x = 0.2 * half.x;
    let plate = |b: &mut MeshBuilder, part: MeshPart, share: f32, from: f32, to: f32| {
        let half_z = 0.5 * 0.26 * h * share;
        let middle = 0.84 * h;
        let (y, z) = (half.y * share, [middle - half_z, middle + half_z]);
        b.cuboid(part, Vec3::new(from, -y, z[0]), Vec3::new(to, y, z[1]));
    };
    plate(b, RED_BAND, 1.0, x, x + 0.4 * half.x);
    plate(b, WHITE, 0.84, x + 0.1 * half.x, x + 0.55 * half.x);
    // Figures on it.
    let ink = half.x;
    block(
        b,
        BLACK,
        [0.5 * (x + ink), -0.35 * half.y],
        [0.5 * (ink - x), 0.06 * half.y],
        [0.79 * h, 0.90 * h],
    );
    for z in [0.79, 0.84, 0.89] {
        block(
            b,
            BLACK,
            [0.5 * (x + ink), 0.22 * half.y],
            [0.5 * (ink - x), 0.26 * half.y],
            [z * h, (z + 0.014) * h],
        );
    }
}

/// A post at the edge of a country road, with a slanting black band and reflectors on both faces.
pub(super) fn delineator(b: &mut MeshBuilder, size: Vec3, variant: u32) {
    let (half, h) = (0.5 * size, size.z);
    // It is flat towards traffic, which passes along y.
    let pole = |part: MeshPart| MeshPart { tag: Tag::Pole, ..part };
    let part = |k: usize| pole(if k == 1 { BLACK } else { WHITE });
    let ring = |z: f32, slant: f32| -> Vec<Vec3> {
        let at = |x: f32, y: f32| Vec3::new(x * half.x, 0.94 * y * half.y, z - slant * (x + 1.0));
        [at(-1.0, -1.0), at(1.0, -1.0), at(1.0, 1.0), at(-1.0, 1.0)].to_vec()
    };
    b.loft(
        &[ring(0.0, 0.0), ring(0.70 * h, 0.03), ring(0.92 * h, 0.03), ring(h, 0.02)],
        |k, _| part(k),
        [pole(WHITE); 2],
    );
    let light = pick(
        &[still(Surface::Reflector, [0.85, 0.85, 0.82]), still(Surface::Reflector, [0.85, 0.35, 0.02])],
        variant,
    );
    for side in [-1.0f32, 1.0] {
        block(
            b,
            pole(light),
            [-0.1 * half.x, 0.9 * side * half.y],
            [0.45 * half.x, 0.1 * half.y],
            [0.73 * h, 0.84 * h],
        );
    }
}

/// A meter on a post.
pub(super) fn parking_meter(b: &mut MeshBuilder, size: Vec3, variant: u32) {
    let (half, h) = (0.5 * size, size.z);
    let body =
        still(Surface::Metal, pick(&[[0.16, 0.18, 0.20], [0.06, 0.12, 0.22], [0.30, 0.30, 0.28]], variant));
    turned(
        b,
        STEEL,
        [0.0; 2],
        &[(0.0, 0.7 * half.x), (0.02, 0.7 * half.x), (0.021, 0.35 * half.x), (0.74 * h, 0.35 * half.x)],
        8,
    );
    let head: Vec<[f32; 2]> = [
        [-0.86, 0.72],
        [0.86, 0.72],
        [1.0, 0.78],
        [1.0, 0.90],
        [0.7, 0.97],
        [0.25, 1.0],
        [-0.25, 1.0],
        [-0.7, 0.97],
        [-1.0, 0.90],
        [-1.0, 0.78],
    ]
    .map(|[y, z]| [y * half.y, z * h])
    .to_vec();
    along_x(b, body, &head, [-0.9 * half.x, 0.9 * half.x]);
    let glass = still(Surface::Glass, [0.04, 0.05, 0.05]);
    block(b, glass, [0.9 * half.x, 0.0], [0.1 * half.x, 0.55 * half.y], [0.88 * h, 0.95 * h]);
    block(b, BLACK, [0.9 * half.x, 0.0], [0.06 * half.x, 0.12 * half.y], [0.80 * h, 0.85 * h]);
}

/// A stand to mend bicycles at: a post with arms and tools, and a pump.
pub(super) fn bicycle_pump(b: &mut MeshBuilder, size: Vec3, variant: u32) {
    let (half, h) = (0.5 * size, size.z);
    let body =
        still(Surface::Metal, pick(&[[0.55, 0.30, 0.02], [0.03, 0.22, 0.34], [0.10, 0.30, 0.10]], variant));
    let y = -half.y + 0.12;
    block(b, body, [-0.1 * half.x, y], [0.09, 0.11], [0.0, h - 0.02]);
    b.tapered(
        body,
        Vec3::new(-0.1 * half.x - 0.09, y - 0.11, h - 0.02),
        Vec3::new(-0.1 * half.x + 0.09, y + 0.11, h),
        0.7,
        0.7,
    );
    block(b, STEEL, [0.0, y], [half.x, 0.12], [0.0, 0.012]);
    // Two arms that a frame hangs on.
    for side in [-0.06, 0.06] {
        b.bar(
            STEEL,
            Vec3::new(0.0, y + side, 0.86 * h),
            Vec3::new(half.x - 0.02, y + side, 0.90 * h),
            [0.015; 2],
            6,
        );
    }
    // Tools on wires.
    for (k, z) in [0.62f32, 0.56, 0.66].into_iter().enumerate() {
        let at = |z: f32| Vec3::new(0.5 * half.x - 0.03, y - 0.06 + 0.06 * k as f32, z * h);
        b.bar(STEEL, at(z), at(z - 0.14), [0.010; 2], 4);
    }
    // The pump with its hose.
    let y = half.y - 0.09;
    turned(
        b,
        STEEL,
        [0.0, y],
        &[
            (0.0, 0.085),
            (0.012, 0.085),
            (0.013, 0.03),
            (0.62 * h, 0.03),
            (0.63 * h, 0.012),
            (0.80 * h, 0.012),
        ],
        8,
    );
    block(b, DARK_STEEL, [0.0, y], [0.02, 0.085], [0.80 * h, 0.83 * h]);
    let hose = [
        Vec3::new(0.03, y, 0.10),
        Vec3::new(0.12, y - 0.10, 0.05),
        Vec3::new(0.10, y - 0.20, 0.30),
        Vec3::new(0.03, y - 0.05, 0.45),
    ];
    for pair in hose.windows(2) {
        b.bar(BLACK, pair[0], pair[1], [0.010; 2], 5);
    }
}
