//! The boards of traffic signs on their poles.

use std::sync::Arc;

use glam::{Vec2, Vec3};
use schema::geometry::{MeshPart, Surface, TriMesh};
use schema::mesh_textures::{MeshTextures, TextureSet};
use schema::{SignFace, Tag};

use crate::actors::device::{Board, board};
use crate::solids::{MeshBuilder, circle};

const GREY: MeshPart = MeshPart::new(Tag::TrafficSign, Surface::Metal, [0.35; 3]);
const STEEL: MeshPart = MeshPart::new(Tag::Pole, Surface::Metal, [0.22, 0.23, 0.24]);

const fn face(rgb: [f32; 3]) -> MeshPart {
    MeshPart::new(Tag::TrafficSign, Surface::Reflector, rgb)
}

/// The board stands on z = 0 and looks along +x; its pole reaches as far below as its face says. What is
/// painted on it is a picture: no ray meets it.
pub(crate) fn sign(kind: &str, size: Vec3, said: SignFace) -> TriMesh {
    let half = 0.5 * size;
    let Board { outline, rim, inner, inside, middle } = board(kind);
    let outline: Vec<[f32; 2]> =
        outline.map_or_else(|| circle(16).map(|(y, z)| [y, z]).collect(), <[[f32; 2]]>::to_vec);
    let at = |x: f32, [y, z]: [f32; 2]| Vec3::new(x, y * half.y, half.z + z * half.z);
    let ring = |x: f32, share: f32| -> Vec<Vec3> {
        outline.iter().map(|[y, z]| at(x, [y * share, middle + (z - middle) * share])).collect()
    };
    let (front, back) = (0.9 * half.x, -0.2 * half.x);
    let mut b = MeshBuilder::new();
    let rings = [ring(back, 1.0), ring(0.8 * front, 1.0), ring(0.9 * front, inside)];
    b.loft(&rings, |k, _| if k == 0 { GREY } else { face(rim) }, [GREY, face(inner)]);
    let pole_x = -half.x + 0.004;
    let height_m = f32::from(said.bottom_cm) / 100.0;
    b.bar(
        STEEL,
        Vec3::new(pole_x, 0.0, -height_m - 0.15),
        Vec3::new(pole_x, 0.0, 0.8 * size.z),
        [0.03; 2],
        8,
    );
    let mut mesh = b.finish();
    let image = crate::actors::device::picture(kind, [size.y, size.z], said);
    // As a reader sees it: y is to the right.
    let place = |p: Vec3| Vec2::new(0.5 + p.y / size.y, 1.0 - p.z / size.z);
    let corners = (0..mesh.triangles.len()).map(|i| mesh.corners(i).map(place)).collect();
    let sets = vec![TextureSet { colour: Some(image), ..TextureSet::default() }];
    mesh.textures = Some(Arc::new(MeshTextures { corners, sets }));
    mesh
}
