//! One class at a time over the whole grid.

use std::ops::Range;

use rayon::prelude::*;
use schema::Tag;

use super::bits::Bits;
use super::order::{Classes, layer_chunks};
use voxelgrid::VoxelGrid;

/// Columns along y that one sweep along x carries at a time.
const BAND: usize = 64;
/// Slices along x that one reading task takes.
const READ_SLICES: usize = 16;

/// Cells of one class in one column.
#[derive(Clone, Copy, Debug)]
struct Entry<const W: usize> {
    i: u32,
    j: u32,
    cells: Bits<W>,
}

/// A grid as column masks.
#[derive(Debug, Default)]
pub(super) struct Columns<const W: usize> {
    /// Free cells of each column (i-major).
    free: Vec<Bits<W>>,
    /// Per class, the columns that hold it, in column order.
    entries: Vec<Vec<Entry<W>>>,
    /// The class at hand as dense masks; zero outside a pass.
    dense: Vec<Bits<W>>,
    /// Free cells that may still be filled in the pass at hand; zero outside a pass.
    candidates: Vec<Bits<W>>,
}

/// What a reading task finds: the free cells of its columns, the entries by class.
struct Read<'c, const W: usize> {
    classes: &'c Classes,
    entries: Vec<Vec<Entry<W>>>,
}

impl<const W: usize> Columns<W> {
    /// Reads the grid.
    pub(super) fn read(&mut self, grid: &VoxelGrid, classes: &Classes) {
        let [nx, ny, nz] = grid.shape;
        for masks in [&mut self.free, &mut self.dense, &mut self.candidates] {
            if masks.len() != nx * ny {
                masks.clear();
                masks.resize(nx * ny, Bits::ZERO);
            }
        }
        let parts: Vec<Read<'_, W>> = self
            .free
            .par_chunks_mut(READ_SLICES * ny)
            .zip(grid.data.par_chunks(READ_SLICES * ny * nz))
            .enumerate()
            .map(|(part, (free, cells))| {
                let mut found = Read { classes, entries: vec![Vec::new(); classes.count] };
                for (at, (free, column)) in free.iter_mut().zip(cells.chunks_exact(nz)).enumerate() {
                    let (i, j) = (part * READ_SLICES + at / ny, at % ny);
                    *free = found.column(i as u32, j as u32, column);
                }
                found
            })
            .collect();
        self.entries.resize_with(classes.count, Vec::new);
        for (class, entries) in self.entries.iter_mut().enumerate() {
            entries.clear();
            parts.iter().for_each(|part| entries.extend_from_slice(&part.entries[class]));
        }
    }

    /// One pass: fills the class and writes it into the grid. Later passes see what it has filled where it `claims` it.
    pub(super) fn fill_class(
        &mut self,
        class: usize,
        tag: Tag,
        chunk: [usize; 3],
        claims: bool,
        grid: &mut VoxelGrid,
    ) {
        let [_, ny, nz] = grid.shape;
        let Some(entries) = self.entries.get(class).filter(|entries| !entries.is_empty()) else { return };
        let active = Active::new(entries, chunk, grid.shape);
        let columns: Vec<(usize, Bits<W>)> = entries
            .par_iter()
            .filter_map(|entry| {
                let at = entry.i as usize * ny + entry.j as usize;
                let found = Bits::enclosed(self.free[at], entry.cells);
                let found = if found.is_zero() { found } else { found & active.layers(entry) };
                (!found.is_zero()).then_some((at, found))
            })
            .collect();
        if columns.is_empty() {
            return;
        }

        for entry in entries {
            self.dense[entry.i as usize * ny + entry.j as usize] = entry.cells;
        }
        for &(at, found) in &columns {
            self.candidates[at] = found;
        }
        let reach = Reach::of(entries, &columns, ny);
        self.sweep_y(&reach, ny);
        for (at, filled) in self.sweep_x(&reach, ny).into_iter().flatten() {
            if claims {
                self.free[at] = self.free[at] & !filled;
            }
            let start = at * nz;
            filled.ones().for_each(|k| grid.data[start + k] = tag as u8);
        }
        for &(at, _) in &columns {
            self.candidates[at] = Bits::ZERO;
        }
        for entry in &self.entries[class] {
            self.dense[entry.i as usize * ny + entry.j as usize] = Bits::ZERO;
        }
    }

    /// Keeps the candidates that meet the class first to the left and to the right.
    fn sweep_y(&mut self, reach: &Reach, ny: usize) {
        let (free, dense) = (&self.free, &self.dense);
        let rows = reach.rows.start..reach.rows.end;
        self.candidates[rows.start * ny..rows.end * ny]
            .par_chunks_mut(ny)
            .zip(rows.into_par_iter())
            .filter(|(_, i)| reach.row_has_candidate[i - reach.rows.start])
            .for_each(|(candidates, i)| {
                // Before the first and after the last column of the class nothing can be met.
                let [first, last] = reach.row_span[i - reach.rows.start];
                let row = i * ny;
                let mut met = Bits::ZERO;
                for j in first..=last {
                    candidates[j] = candidates[j] & met;
                    met = dense[row + j] | (free[row + j] & met);
                }
                met = Bits::ZERO;
                for j in (first..=last).rev() {
                    candidates[j] = candidates[j] & met;
                    met = dense[row + j] | (free[row + j] & met);
                }
            });
    }

    /// The candidates that also meet the class first ahead and behind: place and cells of each column.
    fn sweep_x(&self, reach: &Reach, ny: usize) -> Vec<Vec<(usize, Bits<W>)>> {
        let bands: Vec<usize> =
            (0..ny.div_ceil(BAND)).filter(|&band| reach.band_has_candidate[band]).collect();
        bands
            .par_iter()
            .map(|&band| self.sweep_band(band * BAND..((band + 1) * BAND).min(ny), reach, ny))
            .collect()
    }

    fn sweep_band(&self, columns: Range<usize>, reach: &Reach, ny: usize) -> Vec<(usize, Bits<W>)> {
        let row = |i: usize| i * ny + columns.start..i * ny + columns.end;
        let mut met = [Bits::ZERO; BAND];
        let mut kept: Vec<(usize, Bits<W>)> = Vec::new();
        for i in reach.rows.clone() {
            if reach.row_has_candidate[i - reach.rows.start] {
                let places = row(i).zip(&self.candidates[row(i)]).zip(&met);
                kept.extend(
                    places.map(|((at, &c), &met)| (at, c & met)).filter(|(_, cells)| !cells.is_zero()),
                );
            }
            self.pass_row(&mut met, row(i));
        }
        // Backwards, and only as far as candidates are left; those are in ascending order.
        let Some(first) = kept.first().map(|(at, _)| at / ny) else { return kept };
        met = [Bits::ZERO; BAND];
        let mut left = kept.len();
        for i in (first..reach.rows.end).rev() {
            while let Some((at, cells)) =
                left.checked_sub(1).map(|last| &mut kept[last]).filter(|(at, _)| *at >= row(i).start)
            {
                *cells = *cells & met[*at - row(i).start];
                left -= 1;
            }
            self.pass_row(&mut met, row(i));
        }
        kept
    }

    /// Carries "the next occupied cell behind is of the class" on over a row.
    fn pass_row(&self, met: &mut [Bits<W>; BAND], places: Range<usize>) {
        for (met, (&free, &dense)) in
            met.iter_mut().zip(self.free[places.clone()].iter().zip(&self.dense[places]))
        {
            *met = dense | (free & *met);
        }
    }
}

impl<const W: usize> Read<'_, W> {
    /// Notes the classes of a column and returns its free cells.
    fn column(&mut self, i: u32, j: u32, column: &[u8]) -> Bits<W> {
        let mut free = Bits::range_below(column.len());
        let (groups, rest) = column.as_chunks::<8>();
        for (group, cells) in groups.iter().enumerate() {
            if u64::from_ne_bytes(*cells) != 0 {
                self.cells(i, j, 8 * group, cells, &mut free);
            }
        }
        self.cells(i, j, 8 * groups.len(), rest, &mut free);
        free
    }

    fn cells(&mut self, i: u32, j: u32, start: usize, cells: &[u8], free: &mut Bits<W>) {
        for (k, &label) in cells.iter().enumerate().filter(|(_, label)| **label != 0) {
            let k = start + k;
            free.0[k / 64] &= !(1 << (k % 64));
            let class = usize::from(self.classes.of[usize::from(label)]);
            if let Some(entries) = self.entries.get_mut(class) {
                match entries.last_mut() {
                    Some(last) if last.i == i && last.j == j => last.cells.set(k),
                    _ => {
                        let mut cells = Bits::ZERO;
                        cells.set(k);
                        entries.push(Entry { i, j, cells });
                    }
                }
            }
        }
    }
}

/// Where a pass has anything to do.
struct Reach {
    /// Rows (along x) from the first to the last of the class.
    rows: Range<usize>,
    /// Per row of `rows`, first and last column of the class.
    row_span: Vec<[usize; 2]>,
    row_has_candidate: Vec<bool>,
    /// Per band of columns.
    band_has_candidate: Vec<bool>,
}

impl Reach {
    fn of<const W: usize>(entries: &[Entry<W>], columns: &[(usize, Bits<W>)], ny: usize) -> Self {
        // Entries are in column order.
        let first = entries.first().map_or(0, |e| e.i as usize);
        let last = entries.last().map_or(0, |e| e.i as usize);
        let mut reach = Self {
            rows: first..last + 1,
            row_span: vec![[usize::MAX, 0]; last + 1 - first],
            row_has_candidate: vec![false; last + 1 - first],
            band_has_candidate: vec![false; ny.div_ceil(BAND)],
        };
        for entry in entries {
            let [low, high] = &mut reach.row_span[entry.i as usize - first];
            *low = (*low).min(entry.j as usize);
            *high = (*high).max(entry.j as usize);
        }
        for &(at, _) in columns {
            reach.row_has_candidate[at / ny - first] = true;
            reach.band_has_candidate[at % ny / BAND] = true;
        }
        reach
    }
}

/// Which chunks hold the class.
struct Active<const W: usize> {
    chunk: [usize; 3],
    across: usize,
    /// Per chunk of columns, the layers of its active chunks.
    layers: Vec<Bits<W>>,
}

impl<const W: usize> Active<W> {
    fn new(entries: &[Entry<W>], chunk: [usize; 3], shape: [usize; 3]) -> Self {
        let across = shape[1].div_ceil(chunk[1]);
        let mut active =
            Self { chunk, across, layers: vec![Bits::ZERO; shape[0].div_ceil(chunk[0]) * across] };
        let layer_chunks = layer_chunks::<W>(shape[2], chunk[2]);
        for entry in entries {
            let at = active.index(entry);
            let known = active.layers[at];
            for &layers in &layer_chunks {
                if !(entry.cells & layers & !known).is_zero() {
                    active.layers[at] = active.layers[at] | layers;
                }
            }
        }
        active
    }

    fn index(&self, entry: &Entry<W>) -> usize {
        entry.i as usize / self.chunk[0] * self.across + entry.j as usize / self.chunk[1]
    }

    /// A free cell in one of these layers lies in a chunk that holds the class - and a free cell: itself.
    fn layers(&self, entry: &Entry<W>) -> Bits<W> {
        self.layers[self.index(entry)]
    }
}
