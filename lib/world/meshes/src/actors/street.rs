//! Street lamps and the poles of road-side units; signs by their kind.

use glam::Vec3;
use schema::geometry::{MeshPart, Surface, TriMesh};
use schema::{SignFace, Tag, lights};

use crate::actors::{sign, warning};
use crate::solids::{Detail, MeshBuilder};

const STEEL: MeshPart = MeshPart::new(Tag::Pole, Surface::Metal, [0.22, 0.23, 0.24]);

pub(crate) fn street(family: &str, kind: &str, size: Vec3, variant: u32) -> Option<TriMesh> {
    match (family, kind) {
        ("sign", "accident" | "road_works" | "danger") => warning::warning(kind, size),
        ("sign", _) => Some(sign::sign(kind, size, SignFace::from_variant(variant))),
        ("rsu", "pole") => Some(rsu(size)),
        _ => None,
    }
}

/// Pole at the rear end of the box, the lamp at its front end, over the road.
pub(crate) fn lamp(size: Vec3, detail: Detail) -> TriMesh {
    let half = 0.5 * size;
    let mut b = MeshBuilder::at(detail);
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
