//! Trees, bushes and hedges.

use glam::Vec3;
use random::{Stream, unit_f32};
use schema::Tag;
use schema::geometry::{Part, Surface, TriMesh};

use crate::solids::{MeshBuilder, circle};

const BARK: [f32; 3] = [0.13, 0.09, 0.06];

fn leaf(variant: u32) -> Part {
    let greens = [
        [0.06, 0.17, 0.03],
        [0.10, 0.21, 0.04],
        [0.045, 0.13, 0.035],
        [0.14, 0.20, 0.04],
        [0.17, 0.15, 0.03],
    ];
    Part::new(Tag::Vegetation, Surface::Foliage, greens[variant as usize % greens.len()])
}

pub(crate) fn plant(family: &str, kind: &str, size: Vec3, variant: u32) -> Option<TriMesh> {
    let mut b = MeshBuilder::new();
    let random = Stream::new(u64::from(variant), 0, "world/plant", 0);
    // Four numbers in 0..1 that depend on an index alone.
    let at = |i: usize| random.at(i as u64).map(unit_f32);
    let bump =
        |seed: usize| move |ring: usize, side: usize| 0.80 + 0.28 * at(seed * 100 + ring * 12 + side)[0];
    let wood = Part::new(Tag::Vegetation, Surface::Wood, BARK);
    let green = leaf(variant);
    let half = 0.5 * size;
    let mut trunk = |to_z: f32, r: f32| {
        let lean = Vec3::new((at(1)[0] - 0.5) * 0.06, (at(1)[1] - 0.5) * 0.06, 1.0) * to_z;
        b.bar(wood, Vec3::ZERO, lean, [r, 0.6 * r], 7);
        lean
    };
    let thick = 0.018 * size.z + 0.06;
    match (family, kind) {
        ("tree", "broadleaf") => {
            let fork = trunk(0.45 * size.z, thick);
            let count = 5;
            for (i, (c, s)) in circle(count).enumerate() {
                let r = at(10 + i);
                let centre = Vec3::new(c * half.x * 0.48, s * half.y * 0.48, size.z * (0.52 + 0.16 * r[0]));
                b.bar(wood, fork * 0.92, centre, [0.5 * thick, 0.2 * thick], 5);
                b.blob(
                    green,
                    centre,
                    Vec3::new(0.52 * half.x, 0.52 * half.y, size.z * (0.17 + 0.05 * r[1])),
                    5,
                    8,
                    bump(i),
                );
            }
            b.blob(
                green,
                Vec3::Z * 0.80 * size.z,
                Vec3::new(0.62 * half.x, 0.62 * half.y, 0.2 * size.z),
                5,
                9,
                bump(9),
            );
        }
        ("tree", "round") => {
            trunk(0.42 * size.z, thick);
            b.blob(green, Vec3::Z * 0.66 * size.z, Vec3::new(half.x, half.y, 0.34 * size.z), 8, 11, bump(1));
        }
        ("tree", "poplar") => {
            trunk(0.3 * size.z, thick);
            b.blob(green, Vec3::Z * 0.56 * size.z, Vec3::new(half.x, half.y, 0.44 * size.z), 11, 9, bump(2));
        }
        ("tree", "conifer") => {
            trunk(0.35 * size.z, thick);
            let dark = Part::new(Tag::Vegetation, Surface::Foliage, [0.03, 0.09, 0.04]);
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
        ("tree", "palm") => {
            let crown = trunk(0.88 * size.z, 0.7 * thick);
            let fronds = 11;
            for (i, (c, s)) in circle(fronds).enumerate() {
                let r = at(30 + i);
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
            b.ellipsoid(wood, crown, Vec3::splat(0.9 * thick), 4, 6);
        }
        ("bush", "hedge") => {
            let bump = bump(4);
            let count = (size.x / 0.9).ceil().max(1.0) as usize;
            for i in 0..count {
                let step = size.x / count as f32;
                let centre = Vec3::new(-half.x + (i as f32 + 0.5) * step, 0.0, 0.5 * size.z);
                b.blob(
                    green,
                    centre,
                    Vec3::new(0.72 * step, 0.62 * size.y, 0.56 * size.z),
                    4,
                    8,
                    |ring, side| bump(ring + 7 * i, side),
                );
            }
        }
        ("bush", _) => {
            b.blob(green, Vec3::Z * 0.45 * size.z, Vec3::new(half.x, half.y, 0.55 * size.z), 6, 9, bump(3))
        }
        _ => return None,
    }
    b.fit(Vec3::new(-half.x, -half.y, 0.0), Vec3::new(half.x, half.y, size.z));
    Some(b.finish())
}
