//! The triangles of each level of detail, by what they hang on.

use glam::{DAffine3, DMat3, DVec3, Vec2, Vec3};
use gltf_json::mesh::{Mode, Semantic};
use gltf_json::validation::Checked;
use meshes::people::Bone;
use schema::Tag;

use crate::accessor::Numbers;
use crate::document::Document;
use crate::error::Problem;
use crate::graph::{At, Graph, Placed};
use crate::limits;
use crate::material::places;
use crate::rig::{Rig, Weights};

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
    /// Index into [`TriangleSoup::parts`].
    pub(crate) part: usize,
    /// Of pedestrians the bone that each corner hangs on most.
    pub(crate) bones: [Bone; 3],
}

impl Triangle {
    /// What has no area is not seen.
    pub(crate) fn has_area(&self) -> bool {
        let [a, b, c] = self.corners_m;
        (b - a).cross(c - a).length_squared() > 1e-18
    }

    /// Where a turn and a shift take it.
    pub(crate) fn moved(&self, way: &DAffine3) -> Self {
        let corners_m = self.corners_m.map(|corner| way.transform_point3(corner));
        let turned = |normal: Vec3| way.transform_vector3(normal.as_dvec3()).as_vec3();
        Self { corners_m, normals: self.normals.map(|normals| normals.map(turned)), ..*self }
    }
}

/// All triangles of a model.
pub(crate) struct TriangleSoup {
    /// By level, then by what they hang on.
    pub(crate) levels: Vec<Vec<Vec<Triangle>>>,
    pub(crate) parts: Vec<PartKey>,
}

impl TriangleSoup {
    /// # Errors
    /// Data are missing or damaged, or there is too much of them.
    pub(crate) fn new(
        document: &Document,
        graph: &Graph,
        rig: Option<&Rig>,
        levels: usize,
    ) -> Result<Self, At> {
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
                let source = Source::open(document, primitive, placed, rig).map_err(at)?;
                let there = || placed.levels.iter().enumerate().filter(|(_, there)| **there);
                for (level, _) in there() {
                    counts[level] += source.triangles();
                    if counts[level] > limits::TRIANGLES {
                        return Err(at(Problem::TooManyTriangles { level, most: limits::TRIANGLES }));
                    }
                }
                let triangles = source.read(part).map_err(at)?;
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
    hold: Hold<'d>,
}

/// What holds the vertices of a primitive.
enum Hold<'d> {
    /// One thing all of them: of pedestrians a bone.
    One(DAffine3, Bone),
    /// The joints of a skin.
    Skin(Weights<'d>),
}

impl Hold<'_> {
    fn of(&self, vertex: usize) -> Result<(DAffine3, Bone), Problem> {
        match self {
            Self::One(place, bone) => Ok((*place, *bone)),
            Self::Skin(weights) => weights.of(vertex),
        }
    }
}

/// Sets of four joints that a vertex may hang on.
const SETS: u32 = 4;

impl<'d> Source<'d> {
    fn open(
        document: &'d Document,
        primitive: &gltf_json::mesh::Primitive,
        placed: &Placed,
        rig: Option<&'d Rig>,
    ) -> Result<Self, Problem> {
        let mode = match primitive.mode {
            Checked::Valid(mode @ (Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan)) => mode,
            _ => return Err(Problem::NotTriangles),
        };
        let of = |semantic: Semantic| {
            primitive.attributes.get(&Checked::Valid(semantic)).map(|accessor| accessor.value())
        };
        let material = primitive.material.and_then(|material| document.root.materials.get(material.value()));
        let uv = match material.and_then(places) {
            Some(set) => {
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
        let hold = match (rig, placed.skin) {
            (Some(rig), Some(skin)) => {
                let set = |set: u32| Some((of(Semantic::Joints(set))?, of(Semantic::Weights(set))?));
                let open = |(joints, weights): (usize, usize)| {
                    Ok([Numbers::joints(document, joints)?, Numbers::weights(document, weights)?])
                };
                let sets = (0..SETS).map_while(set).map(open).collect::<Result<_, Problem>>()?;
                Hold::Skin(Weights::new(rig, skin, sets)?)
            }
            (Some(rig), None) => {
                Hold::One(placed.object_from_mesh, rig.bone_of(placed.node).ok_or(Problem::Loose)?)
            }
            (None, _) => Hold::One(placed.object_from_mesh, Bone::Pelvis),
        };
        Ok(Self {
            mode,
            positions: Numbers::vectors(document, positions)?,
            normals: of(Semantic::Normals).map(|a| Numbers::vectors(document, a)).transpose()?,
            uv,
            indices: primitive.indices.map(|a| Numbers::indices(document, a.value())).transpose()?,
            hold,
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

    fn read(&self, part: usize) -> Result<Vec<Triangle>, Problem> {
        let mut triangles = Vec::with_capacity(self.triangles());
        for number in 0..self.triangles() {
            let mut corners = [0_usize; 3];
            for (corner, at) in corners.iter_mut().zip(self.corners(number)) {
                *corner = self.vertex(at)?;
            }
            // A skin that turns a part of a triangle inside out is broken anyway; its first corner says it.
            let mirrored = self.hold.of(corners[0])?.0.matrix3.determinant() < 0.0;
            let side = if mirrored { -1.0 } else { 1.0 };
            if mirrored {
                corners.swap(1, 2);
            }
            let mut read = Triangle {
                corners_m: [DVec3::ZERO; 3],
                normals: None,
                uv: [Vec2::ZERO; 3],
                part,
                bones: [Bone::Pelvis; 3],
            };
            let mut normals = [Vec3::ZERO; 3];
            for (k, &vertex) in corners.iter().enumerate() {
                let (place, bone) = self.hold.of(vertex)?;
                read.bones[k] = bone;
                let position = triple(&self.positions, vertex, "a position")?;
                let there = place.transform_point3(position);
                if !there.is_finite() || there.length() > 1e6 {
                    return Err(Problem::NotFinite("a position"));
                }
                read.corners_m[k] = there;
                if let Some(list) = self.normals.as_ref().filter(|list| vertex < list.len()) {
                    // Normals go by the cofactors, which any scale leaves upright.
                    let [x, y, z] = [place.matrix3.x_axis, place.matrix3.y_axis, place.matrix3.z_axis];
                    let cofactors = DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y));
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
            if read.has_area() {
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
