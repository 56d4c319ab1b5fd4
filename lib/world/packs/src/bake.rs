//! Meshes as everyone sees them: triangles with parts and pictures.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::{DVec3, Vec2, Vec3};
use schema::geometry::{MeshPart, Surface, TriMesh};
use schema::mesh_textures::{Image, MeshTextures, PbrFactors};

use crate::cutout::cut;
use crate::document::{Document, ModelFiles};
use crate::error::PackError;
use crate::manifest::ModelManifest;
use crate::material::{PackMaterial, material_of};
use crate::normals;
use crate::picture::Curve;
use crate::pictures::Pictures;
use crate::triangle_soup::{PartKey, Triangle, TriangleSoup};

/// Makes meshes of triangles; pictures are shared among them.
pub(crate) struct Baker<'a> {
    sheet: &'a ModelManifest,
    curve: Curve,
    looks: Vec<(PartKey, PackMaterial)>,
}

impl<'a> Baker<'a> {
    /// # Errors
    /// A picture cannot be used.
    pub(crate) fn new(
        document: &'a Document,
        sheet: &'a ModelManifest,
        bag: &mut ModelFiles<'_>,
        parts: &[PartKey],
        place: String,
    ) -> Result<Self, PackError> {
        let curve = Curve::new();
        let mut pictures = Pictures::new(document, bag, place, &curve);
        let mut looks = Vec::new();
        for part in parts {
            let materials = &document.root.materials;
            let material = part.material.and_then(|m| materials.get(m)).cloned().unwrap_or_default();
            looks.push((
                *part,
                material_of(&material, part.lamp.map(|(bits, _)| bits), sheet, &mut pictures)?,
            ));
        }
        Ok(Self { sheet, curve, looks })
    }

    /// Leaves out what the pictures' cut-outs do not show.
    pub(crate) fn cut(&self, soup: &mut TriangleSoup) {
        let stencil_of = |triangle: &Triangle| self.looks[triangle.part].1.stencil.as_ref();
        for level in &mut soup.levels {
            *level = cut(level, stencil_of);
        }
    }

    /// The mesh of triangles, moved by `shift_m`.
    pub(crate) fn mesh(&self, triangles: &[Triangle], shift_m: DVec3) -> TriMesh {
        let mut mesh = TriMesh::default();
        let mut vertices: BTreeMap<[u32; 3], u32> = BTreeMap::new();
        let mut parts: Vec<Option<u8>> = vec![None; self.looks.len()];
        // Light times area, and area, of each part.
        let mut sums: Vec<([f32; 3], f32)> = Vec::new();
        let mut textures = MeshTextures::default();
        let mut given = Vec::new();
        for triangle in triangles {
            let (key, look) = &self.looks[triangle.part];
            let part = *parts[triangle.part].get_or_insert_with(|| {
                mesh.parts.push(MeshPart::new(key.tag, with_texture_set(look, &mut textures), look.rgb));
                sums.push(([0.0; 3], 0.0));
                (mesh.parts.len() - 1) as u8
            });
            let corners = triangle.corners_m.map(|corner| {
                // Adding 0 makes one zero of two.
                let at = (corner + shift_m).as_vec3() + Vec3::ZERO;
                *vertices.entry(at.to_array().map(f32::to_bits)).or_insert_with(|| mesh.add_vertex(at))
            });
            let before = mesh.triangles.len();
            mesh.add_triangle(part, corners);
            if mesh.triangles.len() == before {
                continue;
            }
            given.push(triangle.normals);
            textures.corners.push(triangle.uv);
            let [a, b, c] = mesh.corners(before);
            let area = (b - a).cross(c - a).length();
            let colour = look.texture_set.as_ref().and_then(|texture_set| texture_set.colour.as_deref());
            let seen = colour.map_or(look.rgb, |picture| self.seen(picture, triangle.uv));
            let sum = &mut sums[usize::from(part)];
            (0..3).for_each(|k| sum.0[k] += seen[k] * area);
            sum.1 += area;
        }
        for (index, part) in parts.iter().enumerate() {
            let Some(part) = part.map(usize::from) else { continue };
            let (light, area) = sums[part];
            if area > 0.0 {
                mesh.parts[part].rgb = light.map(|v| v / area);
            }
            if let Some((_, Some(rgb))) = self.looks[index].0.lamp {
                mesh.parts[part].rgb = rgb;
            }
        }
        normals::set(&mut mesh, &given, self.sheet.crease_rad);
        mesh.textures = (!textures.sets.is_empty()).then(|| Arc::new(textures));
        mesh
    }

    /// The mean colour that a triangle shows, by a coarse copy of the picture at its middle.
    fn seen(&self, picture: &Image, uv: [Vec2; 3]) -> [f32; 3] {
        let coarse = picture.levels.iter().find(|level| level.width.max(level.height) <= 64);
        let Some(level) = coarse.or(picture.levels.last()) else { return [0.5; 3] };
        let at = (uv[0] + uv[1] + uv[2]) / 3.0;
        let x = picture.wrap[0].texel((at.x * level.width as f32).floor() as i32, level.width);
        let y = picture.wrap[1].texel((at.y * level.height as f32).floor() as i32, level.height);
        self.curve.linear(level.texels[(y * level.width + x) as usize])
    }
}

/// The surface of a look, its coat put among those of a skin.
fn with_texture_set(look: &PackMaterial, textures: &mut MeshTextures) -> Surface {
    let (Surface::Textured(factors), Some(texture_set)) = (look.surface, &look.texture_set) else {
        return look.surface;
    };
    textures.sets.push(texture_set.clone());
    // There are no more coats than parts.
    Surface::Textured(PbrFactors { texture_set: u8::try_from(textures.sets.len() - 1).ok(), ..factors })
}
