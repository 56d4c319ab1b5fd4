//! Trees, bushes and hedges.

use glam::Vec3;
use random::{Stream, unit_f32};
use schema::Tag;
use schema::geometry::{MeshPart, Surface, TriMesh};

use crate::solids::{MeshBuilder, circle};

const BARK: [f32; 3] = [0.13, 0.09, 0.06];

fn leaf(variant: u32) -> MeshPart {
    let greens = [
        [0.06, 0.17, 0.03],
        [0.10, 0.21, 0.04],
        [0.045, 0.13, 0.035],
        [0.14, 0.20, 0.04],
        [0.17, 0.15, 0.03],
    ];
    MeshPart::new(Tag::Vegetation, Surface::Foliage, greens[variant as usize % greens.len()])
}

/// Numbers of a plant that depend on an index alone.
struct Draws(Stream);

impl Draws {
    /// Four numbers in 0..1.
    fn at(&self, i: usize) -> [f32; 4] {
        self.0.at(i as u64).map(unit_f32)
    }

    /// How far leaves stand out, by ring and side.
    fn bump(&self, seed: usize) -> impl Fn(usize, usize) -> f32 {
        move |ring, side| 0.80 + 0.28 * self.at(seed * 100 + ring * 12 + side)[0]
    }
}

const WOOD: MeshPart = MeshPart::new(Tag::Vegetation, Surface::Wood, BARK);

/// A trunk that leans a little, up to some height; answers with its upper end.
fn trunk(b: &mut MeshBuilder, draws: &Draws, to_z: f32, r: f32) -> Vec3 {
    let lean = Vec3::new((draws.at(1)[0] - 0.5) * 0.06, (draws.at(1)[1] - 0.5) * 0.06, 1.0) * to_z;
    b.bar(WOOD, Vec3::ZERO, lean, [r, 0.6 * r], 7);
    lean
}

/// A plant by name; it fills its box.
pub(crate) fn plant(family: &str, kind: &str, size: Vec3, variant: u32) -> Option<TriMesh> {
    let mut b = MeshBuilder::new();
    let draws = Draws(Stream::new(u64::from(variant), 0, "world/plant", 0));
    let green = leaf(variant);
    let half = 0.5 * size;
    let thick = 0.018 * size.z + 0.06;
    let ball = |b: &mut MeshBuilder, z: f32, half_z: f32, [rings, sides]: [usize; 2], seed: usize| {
        b.blob(
            green,
            Vec3::Z * z * size.z,
            Vec3::new(half.x, half.y, half_z * size.z),
            rings,
            sides,
            draws.bump(seed),
        );
    };
    match (family, kind) {
        ("tree", "broadleaf") => broadleaf(&mut b, &draws, size, thick, green),
        ("tree", "round") => {
            trunk(&mut b, &draws, 0.42 * size.z, thick);
            ball(&mut b, 0.66, 0.34, [8, 11], 1);
        }
        ("tree", "poplar") => {
            trunk(&mut b, &draws, 0.3 * size.z, thick);
            ball(&mut b, 0.56, 0.44, [11, 9], 2);
        }
        ("tree", "conifer") => conifer(&mut b, &draws, size, thick),
        ("tree", "palm") => palm(&mut b, &draws, size, thick, green),
        ("bush", "hedge") => hedge(&mut b, &draws, size, green),
        ("bush", _) => ball(&mut b, 0.45, 0.55, [6, 9], 3),
        _ => return None,
    }
    b.fit(Vec3::new(-half.x, -half.y, 0.0), Vec3::new(half.x, half.y, size.z));
    Some(b.finish())
}

/// Five boughs with leaves, and a crown over them.
fn broadleaf(b: &mut MeshBuilder, draws: &Draws, size: Vec3, thick: f32, green: MeshPart) {
    let half = 0.5 * size;
    let fork = trunk(b, draws, 0.45 * size.z, thick);
    let count = 5;
    for (i, (c, s)) in circle(count).enumerate() {
        let r = draws.at(10 + i);
        let centre = Vec3::new(c * half.x * 0.48, s * half.y * 0.48, size.z * (0.52 + 0.16 * r[0]));
        b.bar(WOOD, fork * 0.92, centre, [0.5 * thick, 0.2 * thick], 5);
        b.blob(
            green,
            centre,
            Vec3::new(0.52 * half.x, 0.52 * half.y, size.z * (0.17 + 0.05 * r[1])),
            5,
            8,
            draws.bump(i),
        );
    }
    b.blob(
        green,
        Vec3::Z * 0.80 * size.z,
        Vec3::new(0.62 * half.x, 0.62 * half.y, 0.2 * size.z),
        5,
        9,
        draws.bump(9),
    );
}

/// Layers of needles.
fn conifer(b: &mut MeshBuilder, draws: &Draws, size: Vec3, thick: f32) {
    let half = 0.5 * size;
    trunk(b, draws, 0.35 * size.z, thick);
    let dark = MeshPart::new(Tag::Vegetation, Surface::Foliage, [0.03, 0.09, 0.04]);
    let layers = 5;
    for i in 0..layers {
        let share = i as f32 / layers as f32;
        let (low, radius) = (0.14 + 0.70 * share, 1.0 - 0.78 * share);
        let high = (low + 0.30).min(1.0);
        b.stack(
            dark,
            &[
                (Vec3::Z * (low + 0.02) * size.z, 0.25 * radius * half.x, 0.25 * radius * half.y),
                (Vec3::Z * low * size.z, radius * half.x, radius * half.y),
                (Vec3::Z * high * size.z, 0.04 * half.x, 0.04 * half.y),
            ],
            10,
        );
    }
}

/// Fronds round the top of a bare trunk.
fn palm(b: &mut MeshBuilder, draws: &Draws, size: Vec3, thick: f32, green: MeshPart) {
    let half = 0.5 * size;
    let crown = trunk(b, draws, 0.88 * size.z, 0.7 * thick);
    let fronds = 11;
    for (i, (c, s)) in circle(fronds).enumerate() {
        let r = draws.at(30 + i);
        let out = Vec3::new(c * half.x, s * half.y, 0.0);
        let across = Vec3::new(-s, c, 0.0) * 0.05 * size.x;
        let rise = Vec3::Z * size.z * (0.07 + 0.05 * r[0]);
        let ring = |p: Vec3, w: f32| -> Vec<Vec3> {
            let up = Vec3::Z * 0.03;
            vec![p - across * w - up, p + across * w - up, p + up]
        };
        let rings = [
            ring(crown, 0.4),
            ring(crown + 0.5 * out + rise, 1.6),
            ring(crown + out * (0.8 + 0.15 * r[1]) - 0.6 * rise, 0.3),
        ];
        b.loft(&rings, |_, _| green, [green; 2]);
    }
    b.ellipsoid(WOOD, crown, Vec3::splat(0.9 * thick), 4, 6);
}

/// Bushes in a row.
fn hedge(b: &mut MeshBuilder, draws: &Draws, size: Vec3, green: MeshPart) {
    let half = 0.5 * size;
    let bump = draws.bump(4);
    let count = (size.x / 0.9).ceil().max(1.0) as usize;
    for i in 0..count {
        let step = size.x / count as f32;
        let centre = Vec3::new(-half.x + (i as f32 + 0.5) * step, 0.0, 0.5 * size.z);
        b.blob(green, centre, Vec3::new(0.72 * step, 0.62 * size.y, 0.56 * size.z), 4, 8, |ring, side| {
            bump(ring + 7 * i, side)
        });
    }
}
