//! Traffic lights, street lamps and the poles of road-side units; signs by their kind.

use std::f32::consts::TAU;

use frames::math::f32::sin_cos;
use glam::Vec3;
use schema::footprint::LightMount;
use schema::geometry::{MeshPart, Surface, TriMesh};
use schema::{SignFace, Tag, lights};

use crate::actors::{sign, warning};
use crate::solids::MeshBuilder;

const STEEL: MeshPart = MeshPart::new(Tag::Pole, Surface::Metal, [0.22, 0.23, 0.24]);

pub(crate) fn street(family: &str, kind: &str, size: Vec3, variant: u32) -> Option<TriMesh> {
    match (family, kind) {
        ("light", "signal") => Some(signal(size, LightMount::from_variant(variant))),
        ("sign", "accident" | "road_works" | "danger") => warning::warning(kind, size),
        ("sign", _) => Some(sign::sign(kind, size, SignFace::from_variant(variant))),
        ("pole", "lamp") => Some(lamp(size)),
        ("rsu", "pole") => Some(rsu(size)),
        _ => None,
    }
}

/// The housing stands on z = 0 and looks along +x; seen from there the pole is to the left when it is at the
/// traffic's right, that is towards +y.
fn signal(size: Vec3, mount: LightMount) -> TriMesh {
    let half = 0.5 * size;
    let black = MeshPart::new(Tag::TrafficLight, Surface::Plain, [0.03, 0.03, 0.03]);
    let mut b = MeshBuilder::new();
    b.cuboid(black, Vec3::new(-half.x, -half.y, 0.0), Vec3::new(0.25 * half.x, half.y, size.z));
    let lens = [
        (lights::SIGNAL_GREEN, [0.02, 0.35, 0.15]),
        (lights::SIGNAL_YELLOW, [0.45, 0.30, 0.02]),
        (lights::SIGNAL_RED, [0.45, 0.02, 0.02]),
    ];
    let radius = (0.145 * size.z).min(0.8 * half.y);
    for (i, (bits, rgb)) in lens.into_iter().enumerate() {
        let glass = MeshPart::new(Tag::TrafficLight, Surface::Lamp(bits), rgb);
        let z = size.z * (i as f32 + 0.5) / 3.0;
        let at = |x: f32| Vec3::new(x * half.x, 0.0, z);
        b.bar(glass, at(0.2), at(0.45), [radius, 0.8 * radius], 12);
        // The hood over the lens: half a tube, thin boxes around its upper half.
        for k in 0..5 {
            let angle = |step: usize| TAU * (0.02 + 0.092 * step as f32);
            let ((s0, c0), (s1, c1)) = (sin_cos(angle(k)), sin_cos(angle(k + 1)));
            let ring = |x: f32| -> Vec<Vec3> {
                let (inner, outer) = (1.02 * radius, 1.10 * radius);
                [(inner, c0, s0), (outer, c0, s0), (outer, c1, s1), (inner, c1, s1)]
                    .map(|(r, c, s)| Vec3::new(x * half.x, r * c, z + r * s))
                    .to_vec()
            };
            b.loft(&[ring(0.2), ring(1.0)], |_, _| black, [black; 2]);
        }
    }
    let side = if mount.pole_right { 1.0 } else { -1.0 };
    let back = -half.x - 0.07;
    let foot = Vec3::new(back, side * mount.arm_m, -mount.height_m - 0.15);
    let top = if mount.arm_m > 0.0 { 0.75 * size.z + 0.5 } else { 0.9 * size.z };
    b.bar(STEEL, foot, Vec3::new(back, side * mount.arm_m, top), [0.10, 0.07], 8);
    b.bar(STEEL, foot, foot + Vec3::Z * 0.5, [0.17, 0.15], 8);
    if mount.arm_m > 0.0 {
        let z = 0.55 * size.z;
        b.bar(
            STEEL,
            Vec3::new(back, side * mount.arm_m, z),
            Vec3::new(back, -side * 0.15, z + 0.05),
            [0.07, 0.045],
            8,
        );
    }
    // Brackets between pole or arm and housing.
    b.cuboid(STEEL, Vec3::new(back, -0.04, 0.5 * size.z), Vec3::new(-half.x + 0.01, 0.04, 0.62 * size.z));
    b.finish()
}

/// Pole at the rear end of the box, the lamp at its front end, over the road.
fn lamp(size: Vec3) -> TriMesh {
    let half = 0.5 * size;
    let mut b = MeshBuilder::new();
    let r = (0.5 * half.y).min(0.09);
    let x = -half.x + 1.5 * r;
    b.bar(STEEL, Vec3::new(x, 0.0, 0.0), Vec3::new(x, 0.0, 0.9), [1.5 * r, 1.3 * r], 8);
    b.bar(STEEL, Vec3::new(x, 0.0, 0.9), Vec3::new(x, 0.0, size.z - 0.35), [r, 0.65 * r], 8);
    b.bar(
        STEEL,
        Vec3::new(x, 0.0, size.z - 0.4),
        Vec3::new(half.x - 0.5, 0.0, size.z - 0.08),
        [0.6 * r, 0.5 * r],
        6,
    );
    let head = MeshPart::new(Tag::Pole, Surface::Metal, [0.3; 3]);
    b.tapered(
        head,
        Vec3::new(half.x - 0.75, -half.y, size.z - 0.12),
        Vec3::new(half.x, half.y, size.z),
        0.8,
        0.6,
    );
    let lens = MeshPart::new(Tag::Pole, Surface::Lamp(lights::STREET_LAMP), [0.75; 3]);
    b.cuboid(
        lens,
        Vec3::new(half.x - 0.65, -0.75 * half.y, size.z - 0.16),
        Vec3::new(half.x - 0.08, 0.75 * half.y, size.z - 0.115),
    );
    b.finish()
}

/// A road-side unit: the sensors are at the origin's vertical, so the pole stands behind them at the rear end
/// of the box.
fn rsu(size: Vec3) -> TriMesh {
    let half = 0.5 * size;
    let mut b = MeshBuilder::new();
    let r = (0.25 * half.x).min(0.045);
    let x = -half.x + r;
    b.bar(STEEL, Vec3::new(x, 0.0, 0.0), Vec3::new(x, 0.0, size.z), [r; 2], 8);
    let cabinet = MeshPart::new(Tag::Static, Surface::Metal, [0.55, 0.56, 0.57]);
    b.cuboid(
        cabinet,
        Vec3::new(-half.x, -half.y, 0.25 * size.z),
        Vec3::new(-half.x + 2.0 * r, half.y, 0.25 * size.z + 0.35),
    );
    b.finish()
}
