//! The rule `solid`: whatever is closed is full.
//!
//! Free cells that no way over faces leads out of - to the grid's border - form rooms. A room takes the label
//! that most of the cell faces around it have (of equally many the smaller label), if that is a label which
//! is ever filled. A column's free cells are runs here, and rooms are runs joined from column to column.

use std::collections::BTreeMap;

use crate::voxel_grid::VoxelGrid;
use schema::Tag;

use crate::fill::order::ORDERED;

/// A run of free cells in a column.
#[derive(Clone, Copy, Debug)]
struct Run {
    start: u16,
    end: u16,
}

/// Runs of all columns, and which belong together.
#[derive(Debug, Default)]
pub(crate) struct Rooms {
    runs: Vec<Run>,
    /// Where each column's runs start, and at last where the last one's end.
    starts: Vec<u32>,
    /// A run of the same room with a smaller or equal number.
    parents: Vec<u32>,
}

/// The room of the border: it is never filled.
const OUTSIDE: u32 = 0;

impl Rooms {
    /// Fills the grid in place.
    pub(crate) fn fill(&mut self, grid: &mut VoxelGrid) {
        self.read(grid);
        self.join(grid.shape);
        let faces = self.count_faces(grid);
        for (column, cells) in grid.data.chunks_exact_mut(grid.shape[2]).enumerate() {
            for run in self.starts[column]..self.starts[column + 1] {
                let room = self.parents[run as usize];
                if let Some(label) = faces.get(&room).and_then(winner) {
                    let Run { start, end } = self.runs[run as usize];
                    cells[usize::from(start)..usize::from(end)].fill(label);
                }
            }
        }
    }

    fn read(&mut self, grid: &VoxelGrid) {
        self.runs.clear();
        self.starts.clear();
        // What is outside.
        self.runs.push(Run { start: 0, end: 0 });
        for column in grid.data.chunks_exact(grid.shape[2]) {
            self.starts.push(self.runs.len() as u32);
            let mut start = 0;
            while let Some(free) = column[start..].iter().position(|&cell| cell == 0) {
                let first = start + free;
                let end =
                    column[first..].iter().position(|&cell| cell != 0).map_or(column.len(), |n| first + n);
                self.runs.push(Run { start: first as u16, end: end as u16 });
                start = end;
            }
        }
        self.starts.push(self.runs.len() as u32);
        self.parents.clear();
        self.parents.extend(0..self.runs.len() as u32);
    }

    /// The smallest known number of a run's room.
    fn root(&mut self, mut run: u32) -> u32 {
        while self.parents[run as usize] != run {
            let above = self.parents[self.parents[run as usize] as usize];
            self.parents[run as usize] = above;
            run = above;
        }
        run
    }

    fn unite(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        self.parents[a.max(b) as usize] = a.min(b);
    }

    /// Joins what touches; afterwards every run knows its room.
    fn join(&mut self, [nx, ny, nz]: [usize; 3]) {
        for column in 0..nx * ny {
            let (i, j) = (column / ny, column % ny);
            let at_border = i == 0 || j == 0 || i + 1 == nx || j + 1 == ny;
            for run in self.starts[column]..self.starts[column + 1] {
                let Run { start, end } = self.runs[run as usize];
                if at_border || start == 0 || usize::from(end) == nz {
                    self.unite(OUTSIDE, run);
                }
            }
            let before = [(i > 0).then(|| column - ny), (j > 0).then(|| column - 1)];
            for other in before.into_iter().flatten() {
                self.join_columns(column, other);
            }
        }
        for run in 0..self.runs.len() as u32 {
            self.parents[run as usize] = self.root(run);
        }
    }

    fn join_columns(&mut self, a: usize, b: usize) {
        let (mut left, mut right) = (self.starts[a], self.starts[b]);
        while left < self.starts[a + 1] && right < self.starts[b + 1] {
            let (of_a, of_b) = (self.runs[left as usize], self.runs[right as usize]);
            if of_a.start < of_b.end && of_b.start < of_a.end {
                self.unite(left, right);
            }
            if of_a.end <= of_b.end {
                left += 1;
            } else {
                right += 1;
            }
        }
    }

    /// Faces of each closed room to occupied cells, by label.
    fn count_faces(&self, grid: &VoxelGrid) -> BTreeMap<u32, [u32; Tag::COUNT]> {
        let [_, ny, nz] = grid.shape;
        let mut faces = BTreeMap::new();
        for column in 0..self.starts.len() - 1 {
            for run in self.starts[column]..self.starts[column + 1] {
                let room = self.parents[run as usize];
                if room == OUTSIDE {
                    continue;
                }
                let counts = faces.entry(room).or_insert([0; Tag::COUNT]);
                let mut count = |label: u8| {
                    if let Some(count) = counts.get_mut(usize::from(label)).filter(|_| label != 0) {
                        *count += 1;
                    }
                };
                let Run { start, end } = self.runs[run as usize];
                let (start, end) = (usize::from(start), usize::from(end));
                // A closed room has cells on all sides.
                let cells = |column: usize| &grid.data[column * nz..][..nz];
                count(cells(column)[start - 1]);
                count(cells(column)[end]);
                for beside in [column - ny, column + ny, column - 1, column + 1] {
                    cells(beside)[start..end].iter().for_each(|&label| count(label));
                }
            }
        }
        faces
    }
}

/// The label that a room with these faces takes.
fn winner(faces: &[u32; Tag::COUNT]) -> Option<u8> {
    let most = (0..Tag::COUNT).max_by_key(|&label| (faces[label], std::cmp::Reverse(label)))? as u8;
    (ORDERED.of[usize::from(most)] != 255).then_some(most)
}
