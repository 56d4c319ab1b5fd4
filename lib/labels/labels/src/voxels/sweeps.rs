//! Grids by sweeping along their axes: what is met first.
//!
//! A column of cells is swept by a face of one cell, from half a cell beyond one end to half a cell beyond
//! the other. Every object on the way (what has one id and one tag) gives its label to the cell in which it
//! is met first; what is met beyond an end counts for the end's cell. Labels have their usual priorities, so
//! the order of the sweeps makes no difference.
//!
//! Where the first thing met from the top is ground and nothing is met in a lower cell, the sweep of that
//! column from below is left out.

use rayon::prelude::*;
use render::{RenderError, VoxelBlock, VoxelRenderer};
use schema::geometry::Snapshot;
use schema::{ObjectId, Tag};
use settings::{SweepSettings, ZFill};

use crate::voxels::column::{GridTriangle, RANK, Span};
use crate::voxels::cpu::{Bins, CpuVoxelRenderer, SLAB_SLICES, collect};

/// A sweep begins and ends this far beyond the grid, cells.
const BEYOND: f32 = 0.5;

/// A triangle and the object it belongs to.
struct Owned {
    triangle: GridTriangle,
    object: ObjectId,
}

/// Where a column meets an object first from either end: in cells from the column's lower end.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Contact {
    column: u32,
    object: ObjectId,
    tag: u8,
    low: f32,
    high: f32,
}

impl Contact {
    fn owner(&self) -> (u32, ObjectId, u8) {
        (self.column, self.object, self.tag)
    }
}

/// What one column makes of its contacts.
struct Hits<'a> {
    contacts: &'a [Contact],
    cells: usize,
}

impl Hits<'_> {
    fn cell(&self, place: f32) -> usize {
        (place.max(0.0) as usize).min(self.cells - 1)
    }

    fn highest(&self) -> impl Iterator<Item = (usize, u8)> {
        self.contacts.iter().map(|c| (self.cell(c.high), c.tag))
    }

    fn lowest(&self) -> impl Iterator<Item = (usize, u8)> {
        self.contacts.iter().map(|c| (self.cell(c.low), c.tag))
    }

    /// Whether the sweep from below finds nothing new: what is met first from the top is ground, and nothing
    /// lies lower.
    fn is_bare_ground(&self) -> bool {
        let Some(first) = self.contacts.iter().max_by(|a, b| a.high.total_cmp(&b.high)) else { return true };
        let ground = [Tag::Road, Tag::Sidewalk, Tag::Terrain, Tag::RoadLine, Tag::Ground];
        let is_ground = ground.iter().any(|tag| *tag as u8 == first.tag);
        is_ground && self.highest().all(|(cell, _)| cell >= self.cell(first.high))
    }

    /// Runs of cells between what is met from below and what is next met from the top, where both have one
    /// label: first and last cell and the label.
    fn scanlines(&self) -> Vec<(usize, usize, u8)> {
        let below = self.lowest().map(|(cell, tag)| (cell, false, tag));
        let mut hits: Vec<(usize, bool, u8)> =
            below.chain(self.highest().map(|(cell, tag)| (cell, true, tag))).collect();
        hits.sort_unstable();
        let mut open: Option<(usize, u8)> = None;
        let mut runs = Vec::new();
        for (cell, is_top, tag) in hits {
            if !is_top {
                open = Some((cell, tag));
            } else if let Some((start, of)) = open.take().filter(|(_, of)| *of == tag) {
                runs.push((start, cell, of));
            }
        }
        runs
    }
}

/// Gives a cell a label if it wins.
fn put(cell: &mut u8, tag: u8) {
    if RANK[usize::from(*cell)] < RANK[usize::from(tag)] {
        *cell = tag;
    }
}

impl CpuVoxelRenderer {
    /// Fills a block by sweeps; `cells` are as [`VoxelRenderer::voxelize`] gives them.
    ///
    /// # Errors
    /// The snapshot lists meshes that were not prepared.
    pub fn sweep(
        &self,
        snapshot: &Snapshot,
        block: &VoxelBlock,
        settings: &SweepSettings,
        cells: &mut Vec<u8>,
    ) -> Result<(), RenderError> {
        self.check(snapshot)?;
        let [nx, ny, nz] = block.shape;
        cells.resize(nx * ny * nz, 0);
        if cells.is_empty() {
            return Ok(());
        }
        if settings.z_fill == ZFill::BoxSweep {
            self.voxelize(snapshot, &[*block], std::slice::from_mut(cells))?;
        } else {
            cells.fill(0);
        }
        let mut triangles = Vec::new();
        let object_of = |instance: u32| snapshot.instances[instance as usize].object;
        collect(snapshot, &self.facts, block, BEYOND, &mut triangles, |instance, triangle| Owned {
            triangle,
            object: object_of(instance),
        });
        let SweepSettings { z_top, z_bottom, x_front, x_back, y_left, y_right, .. } = *settings;
        if z_top || z_bottom {
            let contacts = contacts(&triangles, [0, 1, 2], block.shape);
            sweep_z(&contacts, settings, block.shape, cells);
        }
        // Forward is +x, left is +y.
        for (axes, from_high, from_low) in [([1, 2, 0], x_front, x_back), ([0, 2, 1], y_left, y_right)] {
            if !(from_high || from_low) {
                continue;
            }
            let shape = axes.map(|axis| block.shape[axis]);
            for contacts in columns(&contacts(&triangles, axes, shape)) {
                let hits = Hits { contacts, cells: shape[2] };
                let column = contacts[0].column as usize;
                let mut label = |(cell, tag): (usize, u8)| {
                    let mut place = [0; 3];
                    for (axis, at) in axes.into_iter().zip([column / shape[1], column % shape[1], cell]) {
                        place[axis] = at;
                    }
                    put(&mut cells[(place[0] * ny + place[1]) * nz + place[2]], tag);
                };
                if from_high {
                    hits.highest().for_each(&mut label);
                }
                if from_low {
                    hits.lowest().for_each(&mut label);
                }
            }
        }
        Ok(())
    }
}

/// The contacts of each column that has some.
fn columns(contacts: &[Contact]) -> impl Iterator<Item = &[Contact]> {
    contacts.chunk_by(|a, b| a.column == b.column)
}

fn sweep_z(contacts: &[Contact], settings: &SweepSettings, [nx, ny, nz]: [usize; 3], cells: &mut [u8]) {
    let mut swept = vec![false; if settings.z_fill == ZFill::BoxSweep { nx * ny } else { 0 }];
    for contacts in columns(contacts) {
        let hits = Hits { contacts, cells: nz };
        let number = contacts[0].column as usize;
        let column = &mut cells[number * nz..][..nz];
        let from_below = settings.z_bottom && !(settings.z_top && hits.is_bare_ground());
        if let (ZFill::BoxSweep, Some(swept)) = (settings.z_fill, swept.get_mut(number)) {
            *swept = true;
            let top = hits.highest().map(|(cell, _)| cell).max().unwrap_or(0);
            let low = hits.lowest().map(|(cell, _)| cell).min().filter(|_| from_below).unwrap_or(0);
            column[..low].fill(0);
            column[top + 1..].fill(0);
        }
        if settings.z_top {
            hits.highest().for_each(|(cell, tag)| put(&mut column[cell], tag));
        }
        if from_below {
            hits.lowest().for_each(|(cell, tag)| put(&mut column[cell], tag));
            if settings.z_fill == ZFill::Scanline && settings.z_top {
                for (start, end, tag) in hits.scanlines() {
                    column[start..=end].iter_mut().for_each(|cell| put(cell, tag));
                }
            }
        }
    }
    // Columns in which nothing is met are empty.
    for (column, _) in cells.chunks_exact_mut(nz).zip(&swept).filter(|(_, swept)| !**swept) {
        column.fill(0);
    }
}

/// The contacts of all columns along the last of some axes, by column, object and tag; `shape` is in the
/// order of the axes.
fn contacts(triangles: &[Owned], axes: [usize; 3], shape: [usize; 3]) -> Vec<Contact> {
    let [slices, across, along] = shape;
    let turned: Vec<Owned> = triangles
        .par_iter()
        .map(|owned| Owned { triangle: owned.triangle.permuted(axes), object: owned.object })
        .collect();
    let mut bins = Bins::default();
    bins.sort(&turned, slices, |owned| owned.triangle.slices(slices));
    let slabs = (0..slices.div_ceil(SLAB_SLICES)).into_par_iter().map_init(
        || vec![Span::EMPTY; across],
        |heights, slab| {
            let range = slab * SLAB_SLICES..((slab + 1) * SLAB_SLICES).min(slices);
            let first = range.start * across;
            let mut found: Vec<Contact> = Vec::new();
            for &number in bins.of(slab) {
                let Owned { triangle, object } = &turned[number as usize];
                triangle.columns(range.clone(), heights, |column, Span { low, high }| {
                    let end = along as f32 + BEYOND;
                    if low <= end && high >= -BEYOND {
                        let column = (first + column) as u32;
                        let (low, high) = (low.max(-BEYOND), high.min(end));
                        found.push(Contact { column, object: *object, tag: triangle.tag(), low, high });
                    }
                });
            }
            found.sort_unstable_by_key(Contact::owner);
            found.dedup_by(|next, kept| {
                let same = next.owner() == kept.owner();
                if same {
                    (kept.low, kept.high) = (kept.low.min(next.low), kept.high.max(next.high));
                }
                same
            });
            found
        },
    );
    slabs.collect::<Vec<_>>().concat()
}
