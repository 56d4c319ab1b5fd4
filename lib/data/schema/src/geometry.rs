//! Triangles as every stage sees them: cameras, lidar, BEV and voxels all look at one [`Snapshot`].

use std::sync::Arc;

use frames::{Aabb, LocalOrigin};
use glam::{Affine3A, Vec3};

use crate::mesh_textures::{MeshTextures, PbrFactors};
use crate::{Layer, Normal, ObjectId, Tag};

/// What a part of a mesh is made of; shading decides from it how the part looks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Surface {
    /// A flat colour: linear RGB albedo, 0 to 1.
    Plain,
    /// Takes its colour from the instance ([`Instance::paint`]) and has a clear coat.
    Paint,
    /// Dark glass: of lamps, of water, of what has nothing behind it.
    Glass,
    /// A pane of a vehicle's cabin: dark glass as long as nobody looks through it.
    Window,
    /// Where a door of a cabin stands open: dark as long as nobody looks through it. What stands less than
    /// [`DOOR_M`] behind it is what is there while the door is closed.
    Opening,
    /// Bare or painted metal.
    Metal,
    /// Rubber.
    Rubber,
    /// Skin, hair, leather, and cloth that lies flat.
    Cloth,
    /// Clothes as they are worn.
    Clothes(Weave),
    /// Road surface.
    Asphalt,
    /// The same of a lane, or a flat strip of no use, with kerbs beside it: strips of quadrangles (right,
    /// right, left, left border), of two triangles each that begin with the first corner.
    KerbedAsphalt(Kerbs),
    /// Paint on the road.
    RoadMarking,
    /// Kerbs, walls, concrete.
    Concrete,
    /// What a sidewalk is paved with. Where its mesh has a [`MeshTextures`], places in it are metres along
    /// the sidewalk and away from its kerb.
    Paving(Paving),
    /// Grass and soil.
    Grass,
    /// Leaves.
    Foliage,
    /// Bark and wood.
    Wood,
    /// Loose stones: flat roofs, ballast.
    Gravel,
    /// Tiles of a sloping roof.
    RoofTiles,
    /// A house front: windows in a grid of storeys and bays drawn by the shader from the object position.
    Facade(Wall),
    /// Sheeting that sends light back to where it came from: number plates, signs' faces, reflectors, bands
    /// that warn. Where its mesh has a [`MeshTextures`], the first coat's colour is on it.
    Reflector,
    /// Emits light while one of these [`crate::lights`] bits is set on its instance.
    Lamp(u32),
    /// As the mesh's own [`MeshTextures`] shows it; the part's colour is its mean.
    Textured(PbrFactors),
}

/// What sidewalks are paved with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Paving {
    /// Slabs of half a metre.
    Slabs,
    /// Small square tiles, light and dark.
    Tiles,
    /// Cobbles.
    Setts,
    /// Concrete with a joint every other metre.
    Cast,
    /// Asphalt.
    Asphalt,
}

/// On which sides of a lane kerbs stand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "the names are their own documentation")]
pub enum Kerbs {
    Right,
    Left,
    Both,
}

impl Kerbs {
    /// Of lanes with kerbs on these sides (right, left); none without any.
    #[must_use]
    pub fn on(sides: [bool; 2]) -> Option<Self> {
        match sides {
            [true, true] => Some(Self::Both),
            [true, false] => Some(Self::Right),
            [false, true] => Some(Self::Left),
            [false, false] => None,
        }
    }

    /// Whether they stand on the right, and on the left.
    #[must_use]
    pub fn sides(self) -> [bool; 2] {
        [self != Self::Left, self != Self::Right]
    }
}

impl Surface {
    /// Whether it is a road's surface.
    #[must_use]
    pub fn is_asphalt(self) -> bool {
        matches!(self, Self::Asphalt | Self::KerbedAsphalt(_))
    }

    /// Whether one sees a cabin through it.
    #[must_use]
    pub fn is_window(self) -> bool {
        matches!(self, Self::Window | Self::Opening)
    }
}

/// How deep a door is with its lining, metres: a view through a [`Surface::Opening`] sees what is behind
/// that.
pub const DOOR_M: f32 = 0.13;

/// What the walls of a house front are made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wall {
    /// Smooth render.
    Plaster,
    /// Bricks with grey joints.
    Brick,
    /// Cut stones.
    Ashlar,
    /// Concrete slabs as high as a storey.
    Panels,
    /// Glass from floor to floor.
    Curtain,
}

/// How clothes are woven.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Weave {
    /// Of one colour.
    Plain,
    /// Of one colour, worn in places.
    Denim,
    /// In ribs.
    Knit,
    /// With stripes around limbs and trunk, of a second colour that follows from the first.
    Stripes,
    /// With bands of that colour both ways.
    Checks,
}

/// A part of a mesh: triangles with one tag and one look.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshPart {
    /// What it is.
    pub tag: Tag,
    /// What it is made of.
    pub surface: Surface,
    /// Base colour, linear RGB, 0 to 1.
    pub rgb: [f32; 3],
}

impl MeshPart {
    /// A part.
    #[must_use]
    pub const fn new(tag: Tag, surface: Surface, rgb: [f32; 3]) -> Self {
        Self { tag, surface, rgb }
    }
}

/// A triangle mesh in its object's frame (FLU, metres).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TriMesh {
    /// Vertices.
    pub positions: Vec<Vec3>,
    /// Vertex indices, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// Index into `parts`, one per triangle.
    pub triangle_part: Vec<u8>,
    /// The parts, at most 256.
    pub parts: Vec<MeshPart>,
    /// Normals for light at the corners of each triangle ; empty where all are flat.
    pub corner_normals: Vec<[Normal; 3]>,
    /// What of the light of sky and ground reaches the corners of each triangle past its own body, in 255ths;
    /// empty where that is not known: all of it.
    pub corner_visibility: Vec<[u8; 3]>,
    /// Pictures on it, where it has some of its own.
    pub textures: Option<Arc<MeshTextures>>,
}

impl TriMesh {
    /// The index of a part, which is added if no equal one is there. Beyond 256 parts the last one is reused.
    pub fn part_index(&mut self, part: MeshPart) -> u8 {
        let found = self.parts.iter().position(|p| *p == part);
        let index = found.unwrap_or_else(|| {
            if self.parts.len() < 256 {
                self.parts.push(part);
            }
            self.parts.len() - 1
        });
        index as u8
    }

    /// Adds a vertex and gives its index.
    pub fn add_vertex(&mut self, position: Vec3) -> u32 {
        self.positions.push(position);
        (self.positions.len() - 1) as u32
    }

    /// Adds a triangle between vertices; one that has two corners in one place is left out.
    pub fn add_triangle(&mut self, part: u8, corners: [u32; 3]) {
        let [a, b, c] = corners.map(|v| self.positions[v as usize]);
        if a == b || b == c || a == c {
            return;
        }
        self.triangles.push(corners);
        self.triangle_part.push(part);
    }

    /// The box around all vertices.
    #[must_use]
    pub fn aabb(&self) -> Aabb {
        Aabb::from_points(&self.positions)
    }

    /// The corners of a triangle.
    #[must_use]
    #[inline]
    pub fn corners(&self, triangle: usize) -> [Vec3; 3] {
        // Not by `map`, which may stay a call: this is asked millions of times a frame.
        let [a, b, c] = self.triangles[triangle];
        [self.positions[a as usize], self.positions[b as usize], self.positions[c as usize]]
    }

    /// The normals at the corners of a triangle, if it is not flat.
    #[must_use]
    #[inline]
    pub fn bent(&self, triangle: usize) -> Option<[Vec3; 3]> {
        let [a, b, c] = *self.corner_normals.get(triangle)?;
        (a != b || b != c).then(|| [a, b, c].map(Normal::get))
    }

    /// The part of a triangle.
    #[must_use]
    pub fn part(&self, triangle: usize) -> &MeshPart {
        &self.parts[usize::from(self.triangle_part[triangle])]
    }
}

/// A piece of the ground: triangles of one layer relative to `origin_m`, axes of the world.
#[derive(Clone, Debug, PartialEq)]
pub struct SurfaceMesh {
    /// Its surface.
    pub layer: Layer,
    /// Where its frame's origin is in the world, metres.
    pub origin_m: [f64; 3],
    /// Its triangles.
    pub mesh: TriMesh,
}

/// The object of what is beyond the world around agents: no object. Cameras see it, rays do not meet it.
pub const HORIZON: ObjectId = 0;

/// One object (or one piece of a large one) in a [`Snapshot`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Instance {
    /// Index into [`Snapshot::meshes`].
    pub mesh: u32,
    /// Whose this is; the same number in every output.
    pub object: ObjectId,
    /// Where it is now: object frame to the snapshot's local frame. Rigid (no scale).
    pub local_from_object: Affine3A,
    /// Where it was one frame period ago, in the same local frame.
    pub previous_local_from_object: Affine3A,
    /// Colour of its [`Surface::Paint`] parts, linear RGB.
    pub paint: [f32; 3],
    /// Which of its lamps burn ([`crate::lights`]).
    pub lights: u32,
    /// Light of its street lamp or windows, linear RGB: the colour, times the flux over the nominal one.
    pub glow: [f32; 3],
}

/// How an object moves as a whole, whatever its limbs and wheels do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ObjectMotion {
    /// Whose.
    pub object: ObjectId,
    /// Where it is now: object frame to the snapshot's local frame.
    pub local_from_object: Affine3A,
    /// Where it was one frame period ago, in the same local frame.
    pub previous_local_from_object: Affine3A,
}

/// The world at one instant, near one place: the triangles that every sensor and label is computed from.
#[derive(Clone, Debug)]
pub struct Snapshot {
    /// Where the local frame's origin is; its axes are the world's.
    pub origin: LocalOrigin,
    /// All meshes; shared between snapshots of a scene, so an index means the same in each.
    pub meshes: Arc<[Arc<TriMesh>]>,
    /// All instances, in a fixed order.
    pub instances: Vec<Instance>,
    /// Objects behind panes ([`Surface::is_window`]), by object ascending: they are seen only
    /// through a pane. They are numbered on from the instances ([`Self::behind`]).
    pub cabins: Vec<Instance>,
    /// Motions of the objects that may move, by id ascending. Others stand still.
    pub motions: Vec<ObjectMotion>,
}

impl Snapshot {
    /// How an object moves, if it may.
    #[must_use]
    pub fn motion(&self, object: ObjectId) -> Option<&ObjectMotion> {
        let at = self.motions.binary_search_by_key(&object, |motion| motion.object).ok()?;
        Some(&self.motions[at])
    }

    /// An instance by its number, or objects behind panes by one beyond theirs.
    #[must_use]
    pub fn behind(&self, number: u32) -> Option<&Instance> {
        let number = number as usize;
        self.instances.get(number).or_else(|| self.cabins.get(number.checked_sub(self.instances.len())?))
    }

    /// Whether something stands behind the panes of an object.
    #[must_use]
    pub fn has_cabin(&self, object: ObjectId) -> bool {
        self.cabins.binary_search_by_key(&object, |cabin| cabin.object).is_ok()
    }

    /// The mesh of an instance.
    #[must_use]
    pub fn mesh(&self, instance: &Instance) -> &TriMesh {
        &self.meshes[instance.mesh as usize]
    }
}
