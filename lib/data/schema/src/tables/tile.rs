//! The static world, tile by tile, and which of it a scene has.

use std::sync::Arc;

use glam::{Vec2, Vec3};

use crate::geometry::{Kerbs, MeshPart, Paving, Surface, SurfaceMesh, TriMesh};
use crate::mesh_textures::MeshTextures;
use crate::tables::ActorRow;
use crate::{ActorRole, Attributes, Layer, ObjectId, Tag, table};

/// Name of the maker of tiles, as their manifests have it.
pub const TILE_STAGE: &str = "tiles";

table! {
    /// One row per piece of a tile's ground: triangles of one layer.
    SurfaceRow in "tiles/{set}/{x}_{y}/surfaces" by "tiles" {
        /// Which layer it belongs to: `surface.road`, `surface.marking`, ... A scene has one object for each.
        layer: Layer,
        /// Where the frame of its vertices has its origin in the world, m; the axes are the world's.
        origin_m: [f64; 3],
        /// Vertices relative to the origin along x, m.
        x: Vec<f32>,
        /// Along y, m.
        y: Vec<f32>,
        /// Along z, m.
        z: Vec<f32>,
        /// Three vertices a triangle, counter-clockwise seen from outside.
        triangles: Vec<u32>,
        /// Number of each triangle's part.
        triangle_part: Vec<u8>,
        /// Semantic tag of each part.
        part_tag: Vec<u8>,
        /// What each part is made of: `asphalt` (`asphalt_kerb_right`, `_left`, `_both` of a lane with kerbs
        /// beside it), `concrete`, `paving_slabs` (`_tiles`, `_setts`, `_cast`, `_asphalt`), `grass`,
        /// `road_marking`, `metal`, `glass`, `plain`, ...
        part_surface: Vec<String>,
        /// Linear red, green, blue of each part, 0 to 1.
        part_rgb: Vec<f32>,
        /// Of sidewalks, for the three corners of each triangle: how far along the sidewalk (but for whole
        /// multiples of 256) and how far from its kerb they are, m. Empty for other layers.
        laid_m: Vec<f32>,
    }
}

table! {
    /// One row per object that stands in a tile. Its number within the tile is that of the row, from 0.
    TileObjectRow in "tiles/{set}/{x}_{y}/objects" by "tiles" {
        /// As in `log/actors`.
        kind: crate::ActorKind,
        /// Model name.
        model: String,
        /// Semantic tags of its parts.
        semantic_tags: Vec<u8>,
        /// Length along its x axis, m.
        length_m: f64,
        /// Width along its y axis, m.
        width_m: f64,
        /// Height along its z axis, m.
        height_m: f64,
        /// Colour, sRGB red, green, blue.
        color: Vec<u8>,
        /// Position in the world, m: centre of the footprint on the ground.
        xyz_m: [f64; 3],
        /// Orientation in the world: quaternion w, x, y, z.
        quaternion: [f64; 4],
        /// Number that varies its shape among objects of the same model.
        variant: u32,
        /// OpenDRIVE id of its signal or object.
        opendrive_id: Option<String>,
        /// Further facts: see [Attributes](#attributes).
        attributes: Attributes,
    }
}

table! {
    /// One row per tile that comes within reach of an agent at any frame of a scene, by column, then row. The
    /// object of row `k` of the tile's `objects` has the id `first_id + k` in the scene.
    SceneTileRow in "log/tiles" by "simulate-and-log" {
        /// Which set of tiles it is of: the folder below `tiles/`.
        set: String,
        /// Its column: it begins at 256 times this, m.
        x: i32,
        /// Its row: it begins at 256 times this, m.
        y: i32,
        /// BLAKE3 of its manifest.
        digest: String,
        /// Id of its first object.
        first_id: u16,
        /// How many objects it has.
        objects: u32,
    }
}

impl TileObjectRow {
    /// The object as one of a scene, with its id there.
    #[must_use]
    pub fn actor(&self, id: ObjectId) -> ActorRow {
        ActorRow {
            id,
            kind: self.kind,
            model: self.model.clone(),
            role: ActorRole::Scenery,
            semantic_tags: self.semantic_tags.clone(),
            length_m: self.length_m,
            width_m: self.width_m,
            height_m: self.height_m,
            color: self.color.clone(),
            fixed: true,
            xyz_m: self.xyz_m,
            quaternion: self.quaternion,
            variant: self.variant,
            parent: None,
            opendrive_id: self.opendrive_id.clone(),
            attributes: self.attributes.clone(),
        }
    }
}

/// Words for what parts are made of. Nothing in the ground shines.
const SURFACES: [(&str, Surface); 21] = [
    ("plain", Surface::Plain),
    ("paint", Surface::Paint),
    ("glass", Surface::Glass),
    ("metal", Surface::Metal),
    ("rubber", Surface::Rubber),
    ("cloth", Surface::Cloth),
    ("asphalt", Surface::Asphalt),
    ("asphalt_kerb_right", Surface::KerbedAsphalt(Kerbs::Right)),
    ("asphalt_kerb_left", Surface::KerbedAsphalt(Kerbs::Left)),
    ("asphalt_kerb_both", Surface::KerbedAsphalt(Kerbs::Both)),
    ("road_marking", Surface::RoadMarking),
    ("concrete", Surface::Concrete),
    ("paving_slabs", Surface::Paving(Paving::Slabs)),
    ("paving_tiles", Surface::Paving(Paving::Tiles)),
    ("paving_setts", Surface::Paving(Paving::Setts)),
    ("paving_cast", Surface::Paving(Paving::Cast)),
    ("paving_asphalt", Surface::Paving(Paving::Asphalt)),
    ("grass", Surface::Grass),
    ("foliage", Surface::Foliage),
    ("wood", Surface::Wood),
    ("gravel", Surface::Gravel),
];

impl From<&SurfaceMesh> for SurfaceRow {
    fn from(piece: &SurfaceMesh) -> Self {
        let axis = |k: usize| piece.mesh.positions.iter().map(|p| p[k]).collect();
        let word = |part: &MeshPart| {
            let known = SURFACES.iter().find(|(_, surface)| *surface == part.surface);
            known.map_or("plain", |(word, _)| word).to_owned()
        };
        let parts = &piece.mesh.parts;
        Self {
            layer: piece.layer,
            origin_m: piece.origin_m,
            x: axis(0),
            y: axis(1),
            z: axis(2),
            triangles: piece.mesh.triangles.as_flattened().to_vec(),
            triangle_part: piece.mesh.triangle_part.clone(),
            part_tag: parts.iter().map(|part| part.tag as u8).collect(),
            part_surface: parts.iter().map(word).collect(),
            part_rgb: parts.iter().flat_map(|part| part.rgb).collect(),
            laid_m: piece
                .mesh
                .textures
                .iter()
                .flat_map(|textures| textures.corners.iter().flatten())
                .flat_map(|at| at.to_array())
                .collect(),
        }
    }
}

impl SurfaceRow {
    /// The triangles; none where the columns do not fit together.
    #[must_use]
    pub fn mesh(&self) -> Option<SurfaceMesh> {
        let n = self.x.len();
        let (triangles, rest) = self.triangles.as_chunks::<3>();
        let (rgb, rgb_rest) = self.part_rgb.as_chunks::<3>();
        let (laid, laid_rest) = self.laid_m.as_chunks::<6>();
        let parts = self.part_tag.len();
        let fits = self.y.len() == n
            && self.z.len() == n
            && rest.is_empty()
            && rgb_rest.is_empty()
            && laid_rest.is_empty()
            && (laid.is_empty() || laid.len() == triangles.len())
            && self.triangles.iter().all(|v| (*v as usize) < n)
            && self.triangle_part.len() == triangles.len()
            && self.triangle_part.iter().all(|p| usize::from(*p) < parts)
            && self.part_surface.len() == parts
            && rgb.len() == parts;
        if !fits {
            return None;
        }
        let part = |i: usize| {
            let (_, surface) = SURFACES.iter().find(|(word, _)| *word == self.part_surface[i])?;
            Some(MeshPart::new(Tag::from_u8(self.part_tag[i])?, *surface, rgb[i]))
        };
        let mesh = TriMesh {
            positions: (0..n).map(|i| Vec3::new(self.x[i], self.y[i], self.z[i])).collect(),
            triangles: triangles.to_vec(),
            triangle_part: self.triangle_part.clone(),
            parts: (0..parts).map(part).collect::<Option<_>>()?,
            // The ground is flat in its triangles.
            corner_normals: Vec::new(),
            corner_visibility: Vec::new(),
            textures: (!laid.is_empty()).then(|| {
                let corners = laid
                    .iter()
                    .map(|[a, b, c, d, e, f]| [[a, b], [c, d], [e, f]].map(|[x, y]| Vec2::new(*x, *y)));
                Arc::new(MeshTextures { corners: corners.collect(), sets: Vec::new() })
            }),
        };
        Some(SurfaceMesh { layer: self.layer, origin_m: self.origin_m, mesh })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn piece() -> SurfaceMesh {
        let mut mesh = TriMesh::default();
        let corners = [[0.0, 0.0], [4.0, 0.0], [4.0, 3.0], [0.0, 3.0]]
            .map(|[x, y]| mesh.add_vertex(Vec3::new(x, y, 0.25)));
        for (part, surface, corners) in [
            (Tag::Road, Surface::Asphalt, [corners[0], corners[1], corners[2]]),
            (Tag::Road, Surface::KerbedAsphalt(Kerbs::Right), [corners[0], corners[1], corners[2]]),
            (Tag::Road, Surface::KerbedAsphalt(Kerbs::Left), [corners[0], corners[1], corners[2]]),
            (Tag::Road, Surface::KerbedAsphalt(Kerbs::Both), [corners[0], corners[1], corners[2]]),
            (Tag::Water, Surface::Glass, [corners[0], corners[2], corners[3]]),
        ] {
            let part = mesh.part_index(MeshPart::new(part, surface, [0.1, 0.2, 0.3]));
            mesh.add_triangle(part, corners);
        }
        SurfaceMesh { layer: Layer::Water, origin_m: [32.0, -32.0, 5.0], mesh }
    }

    #[test]
    fn places_along_sidewalks_survive_too() {
        let mut piece = piece();
        let part = piece.mesh.part_index(MeshPart::new(
            Tag::Sidewalk,
            Surface::Paving(Paving::Setts),
            [0.1, 0.2, 0.3],
        ));
        piece.mesh.triangle_part[0] = part;
        let corners =
            (0..piece.mesh.triangles.len()).map(|i| [0, 1, 2].map(|k| Vec2::new(i as f32, 0.5 * k as f32)));
        piece.mesh.textures = Some(Arc::new(MeshTextures { corners: corners.collect(), sets: Vec::new() }));
        assert_eq!(SurfaceRow::from(&piece).mesh(), Some(piece));
    }

    #[test]
    fn pieces_survive_the_way_to_rows_and_back() {
        assert_eq!(SurfaceRow::from(&piece()).mesh(), Some(piece()));
    }

    #[test]
    fn columns_that_do_not_fit_give_no_triangles() {
        let whole = SurfaceRow::from(&piece());
        let broken = [
            SurfaceRow { y: vec![0.0; 3], ..whole.clone() },
            SurfaceRow { triangles: vec![0, 1, 4, 0, 2, 3], ..whole.clone() },
            SurfaceRow { triangles: vec![0, 1, 2, 0], ..whole.clone() },
            SurfaceRow { triangle_part: vec![0, 2], ..whole.clone() },
            SurfaceRow { part_tag: vec![1, 200], ..whole.clone() },
            SurfaceRow { part_surface: vec!["asphalt".into(), "butter".into()], ..whole.clone() },
            SurfaceRow { part_rgb: vec![0.0; 5], ..whole.clone() },
            SurfaceRow { laid_m: vec![0.0; 6], ..whole.clone() },
            SurfaceRow { laid_m: vec![0.0; 31], ..whole },
        ];
        for row in broken {
            assert_eq!(row.mesh(), None, "{row:?}");
        }
    }
}
