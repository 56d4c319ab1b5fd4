//! What is seen from far above and from far below.

use crate::culling::MeshFacts;
use glam::{Affine3A, Vec3A};
use schema::Tag;
use schema::geometry::Snapshot;

use crate::bev::raster::Triangle;
use crate::bev::tags::is_ground;

/// The tags that are highest and lowest on the vertical lines through the centres of the cells.
#[derive(Debug)]
pub(crate) struct Projection {
    cells: usize,
    highest: Vec<(f32, Tag)>,
    lowest: Vec<(f32, Tag)>,
    corners: Vec<Vec3A>,
}

impl Projection {
    pub(crate) fn new(cells: usize) -> Self {
        Self { cells, highest: Vec::new(), lowest: Vec::new(), corners: Vec::new() }
    }

    /// Projects all triangles along the grid's z axis. From below the ground is see-through. Of surfaces at
    /// the same height the smaller tag is seen.
    pub(crate) fn draw(&mut self, snapshot: &Snapshot, facts: &[MeshFacts], grid_from_local: &Affine3A) {
        let (cells, size) = (self.cells, self.cells as f32);
        self.highest.clear();
        self.highest.resize(cells * cells, (f32::NEG_INFINITY, Tag::Unlabeled));
        self.lowest.clear();
        self.lowest.resize(cells * cells, (f32::INFINITY, Tag::Unlabeled));
        for instance in &snapshot.instances {
            let to_grid = *grid_from_local * instance.local_from_object;
            let bounds = facts[instance.mesh as usize].bounds(&to_grid);
            let over = bounds.max.x >= 0.0 && bounds.max.y >= 0.0;
            if !(over && bounds.min.x <= size && bounds.min.y <= size) {
                continue;
            }
            let mesh = snapshot.mesh(instance);
            self.corners.clear();
            self.corners.extend(mesh.positions.iter().map(|&p| to_grid.transform_point3a(Vec3A::from(p))));
            for (vertices, &part) in mesh.triangles.iter().zip(&mesh.triangle_part) {
                let corners = vertices.map(|v| self.corners[v as usize]);
                if let Some(triangle) = Triangle::new(corners, cells).filter(Triangle::may_cover_a_centre) {
                    self.add(&triangle, mesh.parts[usize::from(part)].tag);
                }
            }
        }
    }

    fn add(&mut self, triangle: &Triangle, tag: Tag) {
        let (cells, height) = (self.cells, triangle.height());
        let from_below = !is_ground(tag);
        triangle.centres(cells, |row, columns| {
            for column in columns {
                let (at, z) = (row * cells + column, height.at(row, column));
                let highest = &mut self.highest[at];
                if z > highest.0 || (z == highest.0 && tag < highest.1) {
                    *highest = (z, tag);
                }
                let lowest = &mut self.lowest[at];
                if from_below && (z < lowest.0 || (z == lowest.0 && tag < lowest.1)) {
                    *lowest = (z, tag);
                }
            }
        });
    }

    /// The tags of a cell, from above and from below; [`Tag::Unlabeled`] where there is nothing.
    pub(crate) fn tags(&self, cell: usize) -> [Tag; 2] {
        [self.highest[cell].1, self.lowest[cell].1]
    }
}
