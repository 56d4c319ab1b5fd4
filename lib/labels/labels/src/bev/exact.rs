//! The rule `exact`: masks by the very triangles that sensors see.

use crate::culling::MeshCache;
use frames::{Aabb, Agent, Pose, World};
use glam::{Affine3A, Vec3, Vec3A};
use nalgebra::Point3;
use schema::geometry::{Snapshot, TriMesh};
use schema::{BevClass, ObjectId, Tag};
use settings::BevSettings;

use crate::bev::error::BevError;
use crate::bev::grid::GridFrame;
use crate::bev::layers::Ground;
use crate::bev::mask::BevMask;
use crate::bev::objects::Objects;
use crate::bev::raster::Triangle;
use crate::bev::tags::{is_ground, object_class, tag_bits};
use crate::bev::{line, polygon};

/// Parts of objects this far outside the grid, metres and cells, still count for the object's middle.
const MARGIN: (f64, f64) = (10.0, 2.0);

/// Where decks lie above one another, the ground is followed beyond the grid by at most so many cells: a
/// bridge's road may be joined to the agent's there alone.
const BEYOND_CELLS: f64 = 300.0;

/// What no triangle's tag tells, in the world.
#[derive(Clone, Copy, Debug, Default)]
pub struct Areas<'a> {
    /// Pedestrian crossings, as closed polygons (corners each once): shown where there is road.
    pub crosswalks: &'a [Vec<Point3<f64>>],
    /// Accident and road-work stretches of lanes, as closed polygons.
    pub hazards: &'a [Vec<Point3<f64>>],
    /// Middles of lane markings, as chains of points.
    pub road_lines: &'a [Vec<Point3<f64>>],
}

/// Paint that is no lane marking, in the world.
#[derive(Clone, Copy, Debug, Default)]
pub struct PaintAreas<'a> {
    /// Middles of stop lines, as chains of points.
    pub stop_lines: &'a [Vec<Point3<f64>>],
    /// Outlines of parking spaces, as chains of points.
    pub parking: &'a [Vec<Point3<f64>>],
    /// Arrows, as closed polygons.
    pub arrows: &'a [Vec<Point3<f64>>],
}

/// Makes BEV masks; keeps its working memory between frames.
#[derive(Debug)]
pub struct BevRasterizer {
    cells: usize,
    cell_m: f64,
    meshes: MeshCache,
    ground: Ground,
    /// The ground of the grid and beyond; made when first needed.
    wide: Option<Ground>,
    objects: Objects,
    /// Corners of the mesh in hand, in the grid.
    corners: Vec<Vec3A>,
    /// The highest object over each cell and how high it is; empty where nobody asks for it.
    highest: Vec<(f32, ObjectId)>,
}

impl BevRasterizer {
    /// For masks of these settings.
    ///
    /// # Errors
    /// The settings give an empty or immense grid.
    pub fn new(settings: &BevSettings) -> Result<Self, BevError> {
        let (cells, cell_m) = (BevError::check(settings)?, settings.cell_m);
        Ok(Self {
            cells,
            cell_m,
            meshes: MeshCache::default(),
            ground: Ground::new(cells, cell_m as f32),
            wide: None,
            objects: Objects::default(),
            corners: Vec::new(),
            highest: vec![(f32::NEG_INFINITY, 0); if settings.ids { cells * cells } else { 0 }],
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
        self.collect(snapshot, &grid);
        if self.ground.has_layers() {
            self.follow_beyond(snapshot, world_from_agent);
        }
        let mut bits = self.ground.bits();
        self.draw_areas(&grid, areas, &mut bits);
        self.highest.fill((f32::NEG_INFINITY, 0));
        self.objects.draw(&self.ground, self.cells, |cell, class, object, z| {
            bits[cell] |= 1 << class as u16;
            if let Some(highest) = self.highest.get_mut(cell) {
                // Of two at one height the smaller id.
                if z > highest.0 || (z == highest.0 && object < highest.1) {
                    *highest = (z, object);
                }
            }
        });
        BevMask::new(self.cells, bits)
    }

    /// Whose each cell of the last mask is: the object, of those that the mask shows, that is highest over
    /// the cell's centre; 0 where there is none. Little-endian u16 of shape `[cells, cells]`; empty unless
    /// the settings ask for ids.
    #[must_use]
    pub fn id_bytes(&self) -> Vec<u8> {
        self.highest.iter().flat_map(|(_, object)| object.to_le_bytes()).collect()
    }

    /// Height of the ground that the last mask shows above the agent's origin, metres: the topmost surface of
    /// the layer at each cell's centre, NaN where there is none. Little-endian f32 of shape `[cells, cells]`.
    #[must_use]
    pub fn height_bytes(&self) -> Vec<u8> {
        let height_m = |cell: usize| self.ground.height(cell).unwrap_or(f32::NAN);
        (0..self.cells * self.cells).flat_map(|cell| height_m(cell).to_le_bytes()).collect()
    }

    /// Paint on the ground that the last mask shows: bool bytes of shape `[3, cells, cells]`. Stop lines and
    /// the outlines of parking spaces are lines without width, as lane markings are; arrows cover centres.
    #[must_use]
    pub fn paint_bytes(&self, world_from_agent: &Pose<World, Agent>, paint: PaintAreas<'_>) -> Vec<u8> {
        let grid = GridFrame::new(self.cells, self.cell_m, world_from_agent);
        let (ground, cells) = (&self.ground, self.cells);
        let mut bytes = vec![0; 3 * cells * cells];
        let (stop_lines, rest) = bytes.split_at_mut(cells * cells);
        let (parking, arrows) = rest.split_at_mut(cells * cells);
        for (lines, channel) in [(paint.stop_lines, stop_lines), (paint.parking, parking)] {
            for line in lines {
                line::draw(line.iter().map(|&p| grid.of_world_point(p)), cells, |cell, z| {
                    channel[cell] |= u8::from(ground.holds(cell, z));
                });
            }
        }
        for arrow in paint.arrows {
            let corners: Vec<Vec3> = arrow.iter().map(|&p| grid.of_world_point(p)).collect();
            polygon::fill(&corners, cells, |cell, z| arrows[cell] |= u8::from(ground.is_near(cell, z)));
        }
        bytes
    }

    fn draw_areas(&self, grid: &GridFrame, areas: Areas<'_>, bits: &mut [u16]) {
        let (ground, cells) = (&self.ground, self.cells);
        let in_grid = |points: &[Point3<f64>]| -> Vec<Vec3> {
            points.iter().map(|&p| grid.of_world_point(p)).collect()
        };
        for hazard in areas.hazards {
            polygon::fill(&in_grid(hazard), cells, |cell, z| {
                if ground.is_near(cell, z) {
                    bits[cell] |= 1 << BevClass::Hazard as u16;
                }
            });
        }
        for crosswalk in areas.crosswalks {
            polygon::fill(&in_grid(crosswalk), cells, |cell, z| {
                if ground.is_near(cell, z) {
                    let road = bits[cell] >> BevClass::Road as u16 & 1;
                    bits[cell] |= road << BevClass::Crosswalk as u16;
                }
            });
        }
        for marking in areas.road_lines {
            line::draw(marking.iter().map(|&p| grid.of_world_point(p)), cells, |cell, z| {
                if ground.holds(cell, z) {
                    bits[cell] |= 1 << BevClass::RoadLine as u16;
                }
            });
        }
    }

    /// Chooses the layers of the grid by the way that leads to them, beyond the grid as well.
    fn follow_beyond(&mut self, snapshot: &Snapshot, world_from_agent: &Pose<World, Agent>) {
        let beyond = (BevSettings::BEYOND_M / self.cell_m).min(BEYOND_CELLS) as usize;
        let side = self.cells + 2 * beyond;
        let wide = self.wide.get_or_insert_with(|| Ground::new(side, self.cell_m as f32));
        wide.clear();
        let grid_from_local = GridFrame::new(side, self.cell_m, world_from_agent).grid_from_local(snapshot);
        let (ground_tags, facts) = (tag_bits(is_ground), self.meshes.facts(&snapshot.meshes));
        for instance in &snapshot.instances {
            let facts = &facts[instance.mesh as usize];
            let to_grid = grid_from_local * instance.local_from_object;
            if facts.tags & ground_tags == 0 || !is_over(&facts.bounds(&to_grid), side as f32, 0.0) {
                continue;
            }
            let mesh = snapshot.mesh(instance);
            place(mesh, &to_grid, &mut self.corners);
            for (corners, tag) in triangles(mesh, &self.corners).filter(|(_, tag)| is_ground(*tag)) {
                if let Some(triangle) = Triangle::new(corners, side) {
                    wide.add(&triangle, tag);
                }
            }
        }
        wide.settle();
        self.ground.take_middle(wide);
    }

    /// Sorts the triangles over the grid into ground and objects.
    fn collect(&mut self, snapshot: &Snapshot, grid: &GridFrame) {
        let (ground_tags, object_tags) = (tag_bits(is_ground), tag_bits(|tag| object_class(tag).is_some()));
        let facts = self.meshes.facts(&snapshot.meshes);
        let grid_from_local = grid.grid_from_local(snapshot);
        let size = self.cells as f32;
        let margin = (MARGIN.0 / self.cell_m + MARGIN.1) as f32;
        self.ground.clear();
        self.objects.clear();
        for instance in &snapshot.instances {
            let facts = &facts[instance.mesh as usize];
            if facts.tags & (ground_tags | object_tags) == 0 {
                continue;
            }
            let is_object = facts.tags & object_tags != 0;
            let out = if is_object { margin } else { 0.0 };
            let to_grid = grid_from_local * instance.local_from_object;
            if !is_over(&facts.bounds(&to_grid), size, out) {
                continue;
            }
            if is_object {
                self.objects.offer_base(instance.object, facts, &to_grid);
            }
            let mesh = snapshot.mesh(instance);
            place(mesh, &to_grid, &mut self.corners);
            let mut shares = self.objects.mesh(instance.object);
            for (corners, tag) in triangles(mesh, &self.corners) {
                if let Some(class) = object_class(tag) {
                    shares.add(class, corners, self.cells);
                } else if is_ground(tag)
                    && let Some(triangle) = Triangle::new(corners, self.cells)
                {
                    self.ground.add(&triangle, tag);
                }
            }
        }
    }
}

/// Whether bounds in the grid lie over it, or as near to it as `out` cells.
fn is_over(bounds: &Aabb, size: f32, out: f32) -> bool {
    let near = bounds.max.x >= -out && bounds.max.y >= -out;
    near && bounds.min.x <= size + out && bounds.min.y <= size + out
}

/// A mesh's vertices in the grid.
fn place(mesh: &TriMesh, to_grid: &Affine3A, corners: &mut Vec<Vec3A>) {
    corners.clear();
    corners.extend(mesh.positions.iter().map(|&p| to_grid.transform_point3a(Vec3A::from(p))));
}

/// A mesh's triangles and their tags; `corners` are its vertices in the grid.
fn triangles(mesh: &TriMesh, corners: &[Vec3A]) -> impl Iterator<Item = ([Vec3A; 3], Tag)> {
    let tag = |part: u8| mesh.parts[usize::from(part)].tag;
    let triangles = mesh.triangles.iter().zip(&mesh.triangle_part);
    triangles.map(move |(vertices, &part)| (vertices.map(|v| corners[v as usize]), tag(part)))
}
