//! One class at a time over the whole grid.

use crate::voxel_grid::VoxelGrid;
use rayon::prelude::*;
use schema::Tag;

use crate::fill::bits::Bits;
use crate::fill::lines::Lines;
use crate::fill::order::{Classes, layer_chunks};
use crate::fill::read::{Entry, SLICES, SliceColumns, read};

/// Columns along y that one task follows along x.
const BAND: usize = 64;

/// A grid as column masks.
#[derive(Debug, Default)]
pub(super) struct Columns<const W: usize> {
    /// Free cells of each column (i-major).
    free: Vec<Bits<W>>,
    /// The class at hand as dense masks; zero outside a pass.
    dense: Vec<Bits<W>>,
}

impl<const W: usize> Columns<W> {
    /// Reads the grid: the columns of each class, part by part.
    pub(super) fn read<'c>(&mut self, grid: &VoxelGrid, classes: &'c Classes) -> Vec<SliceColumns<'c, W>> {
        let [nx, ny, _] = grid.shape;
        for masks in [&mut self.free, &mut self.dense] {
            if masks.len() != nx * ny {
                masks.clear();
                masks.resize(nx * ny, Bits::ZERO);
            }
        }
        read(grid, classes, &mut self.free)
    }

    /// One pass: fills the class, which some columns hold, and writes it into the grid. Later passes see what
    /// it has filled where it `claims` it.
    pub(super) fn fill_class(
        &mut self,
        parts: &[&[Entry<W>]],
        tag: Tag,
        chunk: [usize; 3],
        claims: bool,
        grid: &mut VoxelGrid,
    ) {
        let ny = grid.shape[1];
        let active = Active::new(parts, chunk, grid.shape);
        let enclosed: Vec<Vec<Entry<W>>> =
            parts.par_iter().map(|columns| self.enclosed(columns, &active, ny)).collect();
        if enclosed.iter().all(Vec::is_empty) {
            return;
        }
        spread(parts, &mut self.dense, ny, |column| column.cells);
        let lines = Lines::new(&self.free, &self.dense, parts, grid.shape);
        let kept: Vec<Vec<Vec<Entry<W>>>> = enclosed
            .into_par_iter()
            .map(|mut columns| {
                lines.keep_along_y(&mut columns);
                in_bands(&columns, ny)
            })
            .collect();
        let filled: Vec<Vec<Entry<W>>> = (0..ny.div_ceil(BAND))
            .into_par_iter()
            .map(|band| {
                let of_band = kept.iter().filter_map(|part| part.get(band));
                let mut columns: Vec<Entry<W>> = of_band.flatten().copied().collect();
                lines.keep_along_x(&mut columns, band * BAND, BAND);
                columns
            })
            .collect();
        spread(parts, &mut self.dense, ny, |_| Bits::ZERO);
        self.write(&filled, tag, claims, grid);
    }

    /// Of some columns that hold the class: free cells that may be filled, going by their own column alone.
    fn enclosed(&self, entries: &[Entry<W>], active: &Active<W>, ny: usize) -> Vec<Entry<W>> {
        let enclosed = |entry: &Entry<W>| {
            let found = Bits::enclosed(self.free[entry.at(ny)], entry.cells);
            let cells = if found.is_zero() { found } else { found & active.layers(entry) };
            (!cells.is_zero()).then_some(Entry { cells, ..*entry })
        };
        entries.iter().filter_map(enclosed).collect()
    }

    /// Writes what was filled, which is in column order in each band.
    fn write(&mut self, bands: &[Vec<Entry<W>>], tag: Tag, claims: bool, grid: &mut VoxelGrid) {
        let [_, ny, nz] = grid.shape;
        let bands: Vec<&Vec<Entry<W>>> = bands.iter().filter(|band| !band.is_empty()).collect();
        let parts = grid.data.par_chunks_mut(SLICES * ny * nz).zip(self.free.par_chunks_mut(SLICES * ny));
        parts.enumerate().for_each(|(part, (data, free))| {
            for entry in bands.iter().flat_map(|band| of_part(band, part)) {
                let at = entry.at(ny) - part * SLICES * ny;
                if claims {
                    free[at] = free[at] & !entry.cells;
                }
                let column = &mut data[at * nz..(at + 1) * nz];
                entry.cells.runs().for_each(|run| column[run].fill(tag as u8));
            }
        });
    }
}

/// Those of some columns, in column order, whose slices a task takes.
fn of_part<const W: usize>(columns: &[Entry<W>], part: usize) -> &[Entry<W>] {
    let [start, end] =
        [part, part + 1].map(|part| columns.partition_point(|column| (column.i as usize) < part * SLICES));
    &columns[start..end]
}

/// Sets the masks of the columns of all parts.
fn spread<const W: usize>(
    parts: &[&[Entry<W>]],
    masks: &mut [Bits<W>],
    ny: usize,
    mask: impl Fn(&Entry<W>) -> Bits<W> + Sync,
) {
    masks.par_chunks_mut(SLICES * ny).zip(parts).enumerate().for_each(|(part, (masks, columns))| {
        for column in *columns {
            masks[column.at(ny) - part * SLICES * ny] = mask(column);
        }
    });
}

/// Columns that have cells left, by band; none if there are no columns.
fn in_bands<const W: usize>(columns: &[Entry<W>], ny: usize) -> Vec<Vec<Entry<W>>> {
    if columns.is_empty() {
        return Vec::new();
    }
    let mut bands = vec![Vec::new(); ny.div_ceil(BAND)];
    for column in columns.iter().filter(|column| !column.cells.is_zero()) {
        bands[column.j as usize / BAND].push(*column);
    }
    bands
}

/// Which chunks hold the class.
struct Active<const W: usize> {
    /// Of each place along x and y, the first chunk of columns of its row, and its place in the row.
    rows: Vec<usize>,
    places: Vec<usize>,
    /// Per chunk of columns, the layers of its active chunks.
    layers: Vec<Bits<W>>,
}

impl<const W: usize> Active<W> {
    fn new(parts: &[&[Entry<W>]], chunk: [usize; 3], [nx, ny, nz]: [usize; 3]) -> Self {
        let across = ny.div_ceil(chunk[1]);
        let mut active = Self {
            rows: (0..nx).map(|i| i / chunk[0] * across).collect(),
            places: (0..ny).map(|j| j / chunk[1]).collect(),
            layers: vec![Bits::ZERO; nx.div_ceil(chunk[0]) * across],
        };
        for entry in parts.iter().copied().flatten() {
            let at = active.index(entry);
            active.layers[at] = active.layers[at] | entry.cells;
        }
        let layer_chunks = layer_chunks::<W>(nz, chunk[2]);
        for layers in &mut active.layers {
            let of_class = *layers;
            let held = layer_chunks.iter().filter(|chunk| !(**chunk & of_class).is_zero());
            *layers = held.fold(Bits::ZERO, |all, chunk| all | *chunk);
        }
        active
    }

    fn index(&self, entry: &Entry<W>) -> usize {
        self.rows[entry.i as usize] + self.places[entry.j as usize]
    }

    /// A free cell in one of these layers lies in a chunk that holds the class - and a free cell: itself.
    fn layers(&self, entry: &Entry<W>) -> Bits<W> {
        self.layers[self.index(entry)]
    }
}
