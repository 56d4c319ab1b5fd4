//! The triangles of each level of detail, by what they hang on.

use glam::{DVec3, Vec2, Vec3};
use gltf_json::mesh::{Mode, Semantic};
use gltf_json::validation::Checked;
use schema::Tag;

use crate::accessor::Numbers;
use crate::document::Document;
use crate::error::Problem;
use crate::graph::{At, Graph, Placed};
use crate::limits;

/// What tells the parts of a mesh apart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PartKey {
    pub(crate) material: Option<usize>,
    pub(crate) tag: Tag,
    pub(crate) lamp: Option<(u32, Option<[f32; 3]>)>,
}

/// A triangle in the object's frame, not yet shifted to its middle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Triangle {
    pub(crate) corners_m: [DVec3; 3],
    /// Normals of the file.
    pub(crate) normals: Option<[Vec3; 3]>,
    /// Places in the picture.
    pub(crate) uv: [Vec2; 3],
    /// Index into [`Soup::parts`].
    pub(crate) part: usize,
}

/// All triangles of a model.
pub(crate) struct Soup {
    /// By level, then by what they hang on.
    pub(crate) levels: Vec<Vec<Vec<Triangle>>>,
    pub(crate) parts: Vec<PartKey>,
}

impl Soup {
    /// # Errors
    /// Data are missing or damaged, or there is too much of them.
    pub(crate) fn new(document: &Document, graph: &Graph, levels: usize) -> Result<Self, At> {
        let mut soup = Self { levels: vec![vec![Vec::new(); graph.hung.len()]; levels], parts: Vec::new() };
        let mut counts = vec![0; levels];
        // What a coarser version replaces at every level is nowhere to be seen.
        for placed in graph.placed.iter().filter(|placed| placed.levels.contains(&true)) {
            let at = |problem| (Some(placed.node), problem);
            let missing = |what: &str, number| at(Problem::Broken(format!("there is no {what} {number}")));
            let mesh = document.root.meshes.get(placed.mesh).ok_or_else(|| missing("mesh", placed.mesh))?;
            for primitive in &mesh.primitives {
                let key = PartKey {
                    material: primitive.material.map(|material| material.value()),
                    tag: placed.role.tag,
                    lamp: placed.role.lamp,
                };
                if let Some(material) = key.material.filter(|m| *m >= document.root.materials.len()) {
                    return Err(missing("material", material));
                }
                let part = soup.part(key).map_err(at)?;
                let source = Source::open(document, primitive).map_err(at)?;
                let there = || placed.levels.iter().enumerate().filter(|(_, there)| **there);
                for (level, _) in there() {
                    counts[level] += source.triangles();
                    if counts[level] > limits::TRIANGLES {
                        return Err(at(Problem::TooManyTriangles { level, most: limits::TRIANGLES }));
                    }
                }
                let triangles = source.read(placed, part).map_err(at)?;
                for (level, _) in there() {
                    soup.levels[level][placed.role.hung].extend_from_slice(&triangles);
                }
            }
        }
        if soup.levels[0].iter().all(Vec::is_empty) {
            return Err((None, Problem::Empty));
        }
        Ok(soup)
    }

    fn part(&mut self, key: PartKey) -> Result<usize, Problem> {
        if let Some(known) = self.parts.iter().position(|part| *part == key) {
            return Ok(known);
        }
        if self.parts.len() == limits::PARTS {
            return Err(Problem::TooManyParts(limits::PARTS));
        }
        self.parts.push(key);
        Ok(self.parts.len() - 1)
    }
}

/// The numbers of a primitive.
struct Source<'d> {
    mode: Mode,
    positions: Numbers<'d>,
    normals: Option<Numbers<'d>>,
    uv: Option<Numbers<'d>>,
    indices: Option<Numbers<'d>>,
}

impl<'d> Source<'d> {
    fn open(document: &'d Document, primitive: &gltf_json::mesh::Primitive) -> Result<Self, Problem> {
        let mode = match primitive.mode {
            Checked::Valid(mode @ (Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan)) => mode,
            _ => return Err(Problem::NotTriangles),
        };
        let of = |semantic: Semantic| {
            primitive.attributes.get(&Checked::Valid(semantic)).map(|accessor| accessor.value())
        };
        let texture = primitive.material.and_then(|material| document.root.materials.get(material.value()));
        let texture =
            texture.and_then(|material| material.pbr_metallic_roughness.base_color_texture.as_ref());
        let uv = match texture {
            Some(texture) => {
                let set = texture.tex_coord;
                let missing = || Problem::Key {
                    key: format!("TEXCOORD_{set}"),
                    problem: "its material has a picture, but it has no places in it: unwrap the mesh".into(),
                };
                let accessor = of(Semantic::TexCoords(set)).ok_or_else(missing)?;
                Some(Numbers::texture_places(document, accessor)?)
            }
            None => None,
        };
        let positions = of(Semantic::Positions).ok_or(Problem::Empty)?;
        Ok(Self {
            mode,
            positions: Numbers::vectors(document, positions)?,
            normals: of(Semantic::Normals).map(|a| Numbers::vectors(document, a)).transpose()?,
            uv,
            indices: primitive.indices.map(|a| Numbers::indices(document, a.value())).transpose()?,
        })
    }

    fn triangles(&self) -> usize {
        let count = self.indices.as_ref().map_or(self.positions.len(), Numbers::len);
        if self.mode == Mode::Triangles { count / 3 } else { count.saturating_sub(2) }
    }

    /// The corners of a triangle, counter-clockwise seen from outside, as places in the list of vertices.
    fn corners(&self, triangle: usize) -> [usize; 3] {
        match self.mode {
            Mode::TriangleStrip => {
                let odd = triangle % 2;
                [triangle, triangle + 1 + odd, triangle + 2 - odd]
            }
            Mode::TriangleFan => [0, triangle + 1, triangle + 2],
            _ => [3 * triangle, 3 * triangle + 1, 3 * triangle + 2],
        }
    }

    fn read(&self, placed: &Placed, part: usize) -> Result<Vec<Triangle>, Problem> {
        let place = &placed.object_from_mesh;
        let mirrored = place.matrix3.determinant() < 0.0;
        // Normals go by the cofactors, which any scale leaves upright.
        let [x, y, z] = [place.matrix3.x_axis, place.matrix3.y_axis, place.matrix3.z_axis];
        let cofactors = glam::DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y));
        let side = if mirrored { -1.0 } else { 1.0 };
        let mut triangles = Vec::with_capacity(self.triangles());
        for number in 0..self.triangles() {
            let mut corners = [0_usize; 3];
            for (corner, at) in corners.iter_mut().zip(self.corners(number)) {
                *corner = self.vertex(at)?;
            }
            if mirrored {
                corners.swap(1, 2);
            }
            let mut read = Triangle { corners_m: [DVec3::ZERO; 3], normals: None, uv: [Vec2::ZERO; 3], part };
            let mut normals = [Vec3::ZERO; 3];
            for (k, &vertex) in corners.iter().enumerate() {
                let position = triple(&self.positions, vertex, "a position")?;
                let there = place.transform_point3(position);
                if !there.is_finite() || there.length() > 1e6 {
                    return Err(Problem::NotFinite("a position"));
                }
                read.corners_m[k] = there;
                if let Some(list) = self.normals.as_ref().filter(|list| vertex < list.len()) {
                    normals[k] =
                        (cofactors * triple(list, vertex, "a normal")? * side).normalize_or_zero().as_vec3();
                }
                if let Some(list) = &self.uv {
                    let [u, v] = list
                        .pair(vertex)
                        .ok_or(Problem::Index { index: vertex as u32, vertices: list.len() })?;
                    // Beyond this a float no longer tells texels apart.
                    if !(u.abs() < 1e4 && v.abs() < 1e4) {
                        return Err(Problem::NotFinite("a place in a picture"));
                    }
                    read.uv[k] = Vec2::new(u, v);
                }
            }
            let [a, b, c] = read.corners_m;
            let face = (b - a).cross(c - a);
            // What has no area is not seen.
            if face.length_squared() > 1e-18 {
                let face = face.normalize_or_zero().as_vec3();
                // A normal that looks inwards would light the wrong side.
                read.normals = normals.iter().all(|n| n.dot(face) > 0.05).then_some(normals);
                triangles.push(read);
            }
        }
        Ok(triangles)
    }

    /// The vertex at a place in the list of indices.
    fn vertex(&self, at: usize) -> Result<usize, Problem> {
        let index = match &self.indices {
            Some(indices) => indices.index(at).unwrap_or(u32::MAX),
            None => at as u32,
        };
        let vertices = self.positions.len();
        let vertex = index as usize;
        (vertex < vertices).then_some(vertex).ok_or(Problem::Index { index, vertices })
    }
}

fn triple(list: &Numbers<'_>, vertex: usize, what: &'static str) -> Result<DVec3, Problem> {
    let found = list.triple(vertex).ok_or(Problem::Index { index: vertex as u32, vertices: list.len() })?;
    let found = DVec3::from_array(found.map(f64::from));
    found.is_finite().then_some(found).ok_or(Problem::NotFinite(what))
}

/// The box around triangles.
pub(crate) fn bounds<'t>(triangles: impl Iterator<Item = &'t Triangle>) -> Option<[DVec3; 2]> {
    triangles.flat_map(|triangle| triangle.corners_m).fold(None, |found, p| {
        let [low, high] = found.unwrap_or([p; 2]);
        Some([low.min(p), high.max(p)])
    })
}
