//! Bird's-eye-view masks: what lies on the ground around an agent, and what stands on it.
//!
//! The grid follows the agent's yaw and planar position only; every mask is a vertical orthographic projection of
//! the world's triangles. Row 0 is farthest ahead, column 0 farthest to the left; the agent's origin is the corner
//! between the four middle cells.
//!
//! # Coverage
//! A cell carries road, sidewalk, crosswalk, hazard, car, truck or bus when its centre does. Road lines,
//! cones, barriers, two-wheelers, riders and pedestrians are thinner than cells: a cell carries them when any part
//! of it does, so that none ever vanishes.
//!
//! # Overpasses
//! Where a vertical line meets the ground several times, the mask shows the layer one gets to by following
//! the ground from the agent, or, where no way leads, the one nearest to the agent's height. An object is shown
//! when it stands on a shown layer (0.5 m below to 4.8 m above it, at its own place), and its surfaces within
//! the same distances of the layer at each cell. So traffic on another deck is not drawn, on any map.

mod layers;
mod mask;
mod polygon;
mod raster;

use std::collections::BTreeMap;

use frames::{Agent, Pose, World, math};
use glam::{Affine3A, Mat3A, Vec3, Vec3A};
use nalgebra::Point3;
use schema::geometry::{Snapshot, TriMesh};
use schema::settings::BevSettings;
use schema::{BevClass, ObjectId, Tag};

use culling::{MeshCache, MeshFacts};
use layers::Ground;
pub use mask::{BevMask, to_rgb};
use raster::Triangle;

/// Objects are shown from this far below the ground they stand on, metres.
const BELOW_M: f32 = 0.5;
/// Objects are shown up to this far above the ground: the clearance under a bridge, metres.
const ABOVE_M: f32 = 4.8;
/// Slope that is allowed for between the grid's edge and an object that stands beyond it.
const EDGE_SLOPE: f32 = 0.3;

/// A grid that cannot be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("BEV grid of {cells} cells of {cell_m} m: 1 to 8192 cells of a finite size above 0 are possible")]
pub struct BevError {
    /// Rows and columns.
    pub cells: u32,
    /// Cell size, metres.
    pub cell_m: f64,
}

/// Areas that no triangle's tag tells, as closed polygons in the world (corners each once).
#[derive(Clone, Copy, Debug, Default)]
pub struct Areas<'a> {
    /// Pedestrian crossings: shown where there is road.
    pub crosswalks: &'a [Vec<Point3<f64>>],
    /// Accident and road-work stretches of lanes.
    pub hazards: &'a [Vec<Point3<f64>>],
}

/// Makes BEV masks; keeps its working memory between frames.
#[derive(Debug)]
pub struct BevRasterizer {
    cells: usize,
    cell_m: f64,
    meshes: MeshCache,
    sorted: Sorted,
}

/// The triangles over the grid.
#[derive(Debug)]
struct Sorted {
    cells: usize,
    ground: Ground,
    objects: Vec<ObjectTriangle>,
    /// Corners of the mesh in hand, in the grid.
    corners: Vec<Vec3A>,
}

#[derive(Clone, Copy, Debug)]
struct ObjectTriangle {
    object: ObjectId,
    class: BevClass,
    triangle: Triangle,
}

/// Whether a tag is a surface one can stand on.
fn is_ground(tag: Tag) -> bool {
    use Tag::*;
    matches!(tag, Road | RoadLine | Sidewalk | Terrain | Ground | Water | RailTrack)
}

/// The channel of an object's tag.
fn object_class(tag: Tag) -> Option<BevClass> {
    Some(match tag {
        Tag::TrafficCone => BevClass::TrafficCone,
        Tag::Barrier => BevClass::Barrier,
        Tag::Car => BevClass::Car,
        Tag::Truck => BevClass::Truck,
        Tag::Bus => BevClass::Bus,
        Tag::Motorcycle => BevClass::Motorcycle,
        Tag::Bicycle => BevClass::Bicycle,
        Tag::Rider => BevClass::Rider,
        Tag::Pedestrian => BevClass::Pedestrian,
        _ => return None,
    })
}

/// Whether a class is shown in every cell it touches, not only where it covers the centre.
fn is_small(class: BevClass) -> bool {
    !matches!(class, BevClass::Car | BevClass::Truck | BevClass::Bus)
}

/// The tags that a predicate holds for, as bits.
fn tag_bits(wanted: impl Fn(Tag) -> bool) -> u32 {
    Tag::ALL.into_iter().filter(|&tag| wanted(tag)).fold(0, |bits, tag| bits | 1 << tag as u32)
}

impl BevRasterizer {
    /// For masks of these settings.
    ///
    /// # Errors
    /// The settings give an empty or immense grid.
    pub fn new(settings: &BevSettings) -> Result<Self, BevError> {
        let BevSettings { cells, cell_m, .. } = *settings;
        if cells == 0 || cells > 8192 || !cell_m.is_finite() || cell_m <= 0.0 {
            return Err(BevError { cells, cell_m });
        }
        let cells = cells as usize;
        Ok(Self {
            cells,
            cell_m,
            meshes: MeshCache::default(),
            sorted: Sorted {
                cells,
                ground: Ground::new(cells, cell_m as f32),
                objects: Vec::new(),
                corners: Vec::new(),
            },
        })
    }

    /// The mask around an agent.
    pub fn rasterize(
        &mut self,
        snapshot: &Snapshot,
        world_from_agent: &Pose<World, Agent>,
        areas: Areas<'_>,
    ) -> BevMask {
        let grid = GridFrame::new(self.cells, self.cell_m, world_from_agent);
        let bases = self.collect(snapshot, &grid);
        let mut bits = self.sorted.ground.settle();

        for polygon in areas.hazards {
            let corners: Vec<Vec3> = polygon.iter().map(|&p| grid.of_world_point(p)).collect();
            polygon::fill(&corners, self.cells, |cell, z| {
                if self.sorted.ground.is_near(cell, z) {
                    bits[cell] |= 1 << BevClass::Hazard as u16;
                }
            });
        }
        for polygon in areas.crosswalks {
            let corners: Vec<Vec3> = polygon.iter().map(|&p| grid.of_world_point(p)).collect();
            polygon::fill(&corners, self.cells, |cell, z| {
                let road = bits[cell] >> BevClass::Road as u16 & 1;
                if self.sorted.ground.is_near(cell, z) {
                    bits[cell] |= road << BevClass::Crosswalk as u16;
                }
            });
        }
        self.draw_objects(&bases, &mut bits);
        BevMask::new(self.cells, bits)
    }

    /// Sorts the triangles over the grid into ground (drawn at once) and objects (kept); returns where each
    /// object stands.
    fn collect(&mut self, snapshot: &Snapshot, grid: &GridFrame) -> BTreeMap<ObjectId, Base> {
        let (ground_tags, object_tags) = (tag_bits(is_ground), tag_bits(|tag| object_class(tag).is_some()));
        let facts = self.meshes.facts(&snapshot.meshes);
        let grid_from_local = grid.grid_from_local(snapshot);
        let size = self.cells as f32;
        self.sorted.ground.clear();
        self.sorted.objects.clear();
        let mut bases = BTreeMap::new();
        for instance in &snapshot.instances {
            let facts = &facts[instance.mesh as usize];
            if facts.tags & (ground_tags | object_tags) == 0 {
                continue;
            }
            let to_grid = grid_from_local * instance.local_from_object;
            let bounds = facts.bounds(&to_grid);
            if !(bounds.max.x >= 0.0 && bounds.max.y >= 0.0 && bounds.min.x <= size && bounds.min.y <= size) {
                continue;
            }
            if facts.tags & object_tags != 0 {
                bases.entry(instance.object).or_insert_with(Base::default).offer(facts, &to_grid);
            }
            self.sorted.add(snapshot.mesh(instance), instance.object, &to_grid);
        }
        bases
    }

    fn draw_objects(&self, bases: &BTreeMap<ObjectId, Base>, bits: &mut [u16]) {
        // Objects that stand on what is shown, by id.
        let shown: Vec<ObjectId> =
            bases.iter().filter(|(_, base)| self.stands(base)).map(|(&object, _)| object).collect();
        for ObjectTriangle { object, class, triangle } in &self.sorted.objects {
            if shown.binary_search(object).is_err() {
                continue;
            }
            let z = triangle.z_range();
            let bit = 1 << *class as u16;
            let mut draw = |cell: usize| {
                let level = self.sorted.ground.level(cell);
                if z[1] >= level - BELOW_M && z[0] <= level + ABOVE_M {
                    bits[cell] |= bit;
                }
            };
            if is_small(*class) {
                triangle.touched(self.cells, |row, columns| columns.for_each(|c| draw(row * self.cells + c)));
            } else {
                triangle.centres(self.cells, |row, columns| columns.for_each(|c| draw(row * self.cells + c)));
            }
        }
    }

    /// Whether an object stands on the shown layer at its own place.
    fn stands(&self, base: &Base) -> bool {
        let last = self.cells as f32 - 1.0;
        let (u, v) = (base.place.x.floor().clamp(0.0, last), base.place.y.floor().clamp(0.0, last));
        // Beyond the edge the ground is not known: what is known is at the edge.
        let beyond = (base.place.x - u - 0.5).abs().max((base.place.y - v - 0.5).abs()) - 0.5;
        let slack_m = EDGE_SLOPE * beyond.max(0.0) * self.cell_m as f32;
        let above = base.place.z - self.sorted.ground.level(v as usize * self.cells + u as usize);
        above >= -BELOW_M - slack_m && above <= ABOVE_M + slack_m
    }
}

impl Sorted {
    /// Sorts a mesh's triangles over the grid into ground (drawn at once) and objects (kept).
    fn add(&mut self, mesh: &TriMesh, object: ObjectId, to_grid: &Affine3A) {
        self.corners.clear();
        self.corners.extend(mesh.positions.iter().map(|&p| to_grid.transform_point3a(Vec3A::from(p))));
        for (&[a, b, c], &part) in mesh.triangles.iter().zip(&mesh.triangle_part) {
            let tag = mesh.parts[usize::from(part)].tag;
            let class = object_class(tag);
            if class.is_none() && !is_ground(tag) {
                continue;
            }
            let corners = [a, b, c].map(|v| self.corners[v as usize]);
            let Some(triangle) = Triangle::new(corners, self.cells) else { continue };
            match class {
                Some(class) if is_small(class) || triangle.may_cover_a_centre() => {
                    self.objects.push(ObjectTriangle { object, class, triangle });
                }
                Some(_) => {}
                None => self.ground.add(&triangle, tag),
            }
        }
    }
}

/// Where an object stands, in the grid: the bottom of its largest part (wheels and limbs are parts of their own).
#[derive(Clone, Copy, Debug, Default)]
struct Base {
    place: Vec3A,
    volume: f32,
    known: bool,
}

impl Base {
    fn offer(&mut self, facts: &MeshFacts, to_grid: &Affine3A) {
        if !self.known || facts.volume() > self.volume {
            *self = Self {
                place: to_grid.transform_point3a(facts.bottom()),
                volume: facts.volume(),
                known: true,
            };
        }
    }
}

/// Grid coordinates: x the column, y the row (both in cells, from the far left corner), z metres above the agent.
struct GridFrame {
    half_cells: f64,
    per_m: f64,
    agent_m: [f64; 3],
    sin_cos: (f64, f64),
}

impl GridFrame {
    fn new(cells: usize, cell_m: f64, world_from_agent: &Pose<World, Agent>) -> Self {
        Self {
            half_cells: 0.5 * cells as f64,
            per_m: 1.0 / cell_m,
            agent_m: world_from_agent.xyz(),
            sin_cos: math::sin_cos(world_from_agent.yaw()),
        }
    }

    fn of_world_point(&self, point: Point3<f64>) -> Vec3 {
        let (sin, cos) = self.sin_cos;
        let (dx, dy) = (point.x - self.agent_m[0], point.y - self.agent_m[1]);
        let (ahead, left) = (cos * dx + sin * dy, cos * dy - sin * dx);
        Vec3::new(
            (self.half_cells - left * self.per_m) as f32,
            (self.half_cells - ahead * self.per_m) as f32,
            (point.z - self.agent_m[2]) as f32,
        )
    }

    /// From the snapshot's local frame.
    fn grid_from_local(&self, snapshot: &Snapshot) -> Affine3A {
        let (sin, cos) = self.sin_cos;
        let (sin, cos) = ((sin * self.per_m) as f32, (cos * self.per_m) as f32);
        let origin = snapshot.origin.world_xyz();
        Affine3A {
            matrix3: Mat3A::from_cols(
                Vec3A::new(sin, -cos, 0.0),
                Vec3A::new(-cos, -sin, 0.0),
                Vec3A::new(0.0, 0.0, 1.0),
            ),
            translation: self.of_world_point(Point3::from(origin)).into(),
        }
    }
}

#[cfg(test)]
mod tests;
