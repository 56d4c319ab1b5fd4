//! Occupied cells one by one, with what a grid of tags cannot say: whose they are, and how they move.

use std::ops::Range;

use glam::{Affine3A, Vec3A};
use rayon::prelude::*;
use render::{RenderError, VoxelBlock};
use schema::geometry::{Instance, Snapshot};
use schema::{FRAME_PERIOD_S, Tag};

use crate::voxels::column::{GridTriangle, RANK, Span};
use crate::voxels::cpu::{Bins, CpuVoxelRenderer, SLAB_SLICES, collect};

/// Bits of a key that say which instance wins a cell, among those whose labels rank alike.
const ORDER_BITS: u32 = 27;
const ORDER_MASK: u32 = (1 << ORDER_BITS) - 1;

/// What is wanted of each occupied cell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Wanted {
    /// Where it is and its label.
    pub places: bool,
    /// Whose it is.
    pub ids: bool,
    /// How it moves.
    pub flow: bool,
}

/// The occupied cells of a grid, in C order (z runs fastest, then y), as little-endian arrays.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CellRows {
    /// `[n, 4]`, u16: the cell's place along x, y, z and its tag.
    pub places: Vec<u8>,
    /// `[n]`, u16: the object whose surface gives the cell its tag.
    pub ids: Vec<u8>,
    /// `[n, 3]`, f32: velocity of that surface at the cell's centre over the ground, along the grid's axes,
    /// m/s.
    pub flow: Vec<u8>,
    /// Cells per label; free ones are not counted.
    pub counts: [u64; Tag::COUNT],
}

/// A triangle and the instance it belongs to.
struct Owned {
    triangle: GridTriangle,
    instance: u32,
}

impl CpuVoxelRenderer {
    /// The occupied cells of a block: the very ones that [`render::VoxelRenderer::voxelize`] labels. Of
    /// surfaces whose labels rank alike the object of the smaller id has the cell. Holds as many slabs of the
    /// grid as there are threads, never the grid.
    ///
    /// # Errors
    /// The snapshot lists meshes that were not prepared.
    pub fn cell_rows(
        &self,
        snapshot: &Snapshot,
        block: &VoxelBlock,
        wanted: Wanted,
    ) -> Result<CellRows, RenderError> {
        self.check(snapshot)?;
        let [nx, ny, nz] = block.shape;
        let owners = Owners::of(snapshot);
        let mut triangles = Vec::new();
        collect(snapshot, &self.facts, block, 0.0, &mut triangles, |instance, triangle| Owned {
            triangle,
            instance,
        });
        let mut bins = Bins::default();
        bins.sort(&triangles, nx, |owned| owned.triangle.slices(nx));
        let slabs = (0..nx.div_ceil(SLAB_SLICES)).into_par_iter().map_init(
            || Slab::new(ny, nz),
            |work, slab| {
                let slices = slab * SLAB_SLICES..((slab + 1) * SLAB_SLICES).min(nx);
                for &number in bins.of(slab) {
                    let Owned { triangle, instance } = &triangles[number as usize];
                    let key = u32::from(triangle.rank()) << ORDER_BITS | owners.key(*instance);
                    work.write(triangle, slices.clone(), key);
                }
                let mut rows = CellRows::default();
                work.drain(|column, k, key| {
                    let place = [slices.start + column / ny, column % ny, k];
                    rows.push(place, key, &owners, wanted, block);
                });
                rows
            },
        );
        // Slab after slab, whichever thread computed it.
        let slabs: Vec<CellRows> = slabs.collect();
        let mut all = CellRows::default();
        for slab in slabs {
            all.append(slab);
        }
        Ok(all)
    }
}

/// The cells of some slices, by keys; all free between slabs.
struct Slab {
    keys: Vec<u32>,
    /// First and last cell of each column that may be occupied.
    reach: Vec<(usize, usize)>,
    heights: Vec<Span>,
    nz: usize,
}

const UNTOUCHED: (usize, usize) = (usize::MAX, 0);

impl Slab {
    fn new(ny: usize, nz: usize) -> Self {
        let columns = SLAB_SLICES * ny;
        Self {
            keys: vec![0; columns * nz],
            reach: vec![UNTOUCHED; columns],
            heights: vec![Span::EMPTY; ny],
            nz,
        }
    }

    fn write(&mut self, triangle: &GridTriangle, slices: Range<usize>, key: u32) {
        let Self { keys, reach, heights, nz } = self;
        triangle.columns(slices, heights, |column, span| {
            let cells = span.cells(*nz);
            if let Some(last) = cells.clone().last() {
                let (low, high) = &mut reach[column];
                (*low, *high) = (cells.start.min(*low), last.max(*high));
                keys[column * *nz..][cells].iter_mut().for_each(|cell| *cell = key.max(*cell));
            }
        });
    }

    /// Calls with column, place along z and key of every occupied cell, in C order, and frees them.
    fn drain(&mut self, mut cell: impl FnMut(usize, usize, u32)) {
        for (column, reach) in self.reach.iter_mut().enumerate().filter(|(_, reach)| **reach != UNTOUCHED) {
            let (low, high) = std::mem::replace(reach, UNTOUCHED);
            for (k, key) in (low..).zip(&mut self.keys[column * self.nz..][low..=high]) {
                if *key != 0 {
                    cell(column, k, std::mem::take(key));
                }
            }
        }
    }
}

/// Which instance has which key.
struct Owners<'a> {
    snapshot: &'a Snapshot,
    /// Instances by the id of their object.
    by_id: Vec<u32>,
    /// The place of each instance in `by_id`.
    place: Vec<u32>,
}

impl<'a> Owners<'a> {
    fn of(snapshot: &'a Snapshot) -> Self {
        let mut by_id: Vec<u32> = (0..snapshot.instances.len() as u32).collect();
        by_id.sort_by_key(|&instance| snapshot.instances[instance as usize].object);
        let mut place = vec![0; by_id.len()];
        for (at, &instance) in by_id.iter().enumerate() {
            place[instance as usize] = at as u32;
        }
        Self { snapshot, by_id, place }
    }

    /// Greater for smaller ids.
    fn key(&self, instance: u32) -> u32 {
        ORDER_MASK - self.place[instance as usize]
    }

    fn instance(&self, key: u32) -> &'a Instance {
        let place = ORDER_MASK - (key & ORDER_MASK);
        &self.snapshot.instances[self.by_id[place as usize] as usize]
    }
}

/// The label of each rank.
const TAG_OF_RANK: [u8; Tag::COUNT] = {
    let mut tags = [0; Tag::COUNT];
    let mut tag = 1;
    while tag < Tag::COUNT {
        tags[RANK[tag] as usize] = tag as u8;
        tag += 1;
    }
    tags
};

impl CellRows {
    fn push(&mut self, place: [usize; 3], key: u32, owners: &Owners<'_>, wanted: Wanted, block: &VoxelBlock) {
        let tag = TAG_OF_RANK[(key >> ORDER_BITS) as usize];
        self.counts[usize::from(tag)] += 1;
        if wanted.places {
            let row = [place[0] as u16, place[1] as u16, place[2] as u16, u16::from(tag)];
            self.places.extend(row.into_iter().flat_map(u16::to_le_bytes));
        }
        let instance = owners.instance(key);
        if wanted.ids {
            self.ids.extend(instance.object.to_le_bytes());
        }
        if wanted.flow {
            let flow = velocity(instance, place, &block.cells_from_local);
            self.flow.extend(flow.to_array().into_iter().flat_map(f32::to_le_bytes));
        }
    }

    fn append(&mut self, other: Self) {
        self.places.extend(other.places);
        self.ids.extend(other.ids);
        self.flow.extend(other.flow);
        for (to, from) in self.counts.iter_mut().zip(other.counts) {
            *to += from;
        }
    }
}

/// Velocity of an instance at a cell's centre along the grid's axes, m/s: its way since one frame ago.
fn velocity(instance: &Instance, place: [usize; 3], cells_from_local: &Affine3A) -> Vec3A {
    let (now, before) = (instance.local_from_object, instance.previous_local_from_object);
    if now == before {
        return Vec3A::ZERO;
    }
    let centre = Vec3A::from(place.map(|n| n as f32 + 0.5));
    let here = cells_from_local.inverse().transform_point3a(centre);
    let there = before.transform_point3a(now.inverse().transform_point3a(here));
    // Cells are cubes: their axes are the grid's, scaled alike.
    let grid_from_local = cells_from_local.matrix3 * (1.0 / cells_from_local.matrix3.x_axis.length());
    grid_from_local * (here - there) * (1.0 / FRAME_PERIOD_S) as f32
}
