//! The ground over the grid, layer by layer.

use schema::{BevClass, Tag};

use crate::bev::raster::Triangle;

/// Surfaces at most this far apart on a vertical line are one layer (road, marks, kerb, terrain beneath),
/// metres.
pub(crate) const LAYER_M: f32 = 1.5;
/// Following the ground, a step between neighbouring cells is at most this high, metres.
const STEP_M: f32 = 0.6;
/// The agent stands on ground this near, across and up, metres.
const STAND_M: f32 = 3.0;
/// An area belongs to a layer at most this far away: half the clearance under a bridge, metres.
const AREA_M: f32 = 2.4;

/// What the ground is at one cell, as far as it is known.
#[derive(Clone, Copy, Debug)]
struct Cell {
    low: f32,
    high: f32,
    bits: u16,
}

impl Cell {
    const EMPTY: Self = Self { low: f32::INFINITY, high: f32::NEG_INFINITY, bits: 0 };

    fn is_empty(self) -> bool {
        self.low > self.high
    }

    fn has_layers(self) -> bool {
        self.high - self.low > LAYER_M
    }

    fn add(&mut self, z: f32, bits: u16) {
        self.low = self.low.min(z);
        self.high = self.high.max(z);
        self.bits |= bits;
    }

    /// Vertical distance to another layer, 0 where they overlap.
    fn gap(self, other: Self) -> f32 {
        (self.low - other.high).max(other.low - self.high).max(0.0)
    }

    /// Vertical distance to the agent's height.
    fn height_gap(self) -> f32 {
        self.low.max(-self.high).max(0.0)
    }
}

/// A layer of a cell that has several.
#[derive(Clone, Copy, Debug)]
struct Layer {
    cell: u32,
    is: Cell,
}

/// The layers of all cells.
struct Layers<'a> {
    /// The only layer of every cell that is not among `several`.
    cells: &'a [Cell],
    /// The layers of the others, by cell, then from low to high.
    several: &'a [Layer],
}

impl Layers<'_> {
    /// The layer of a cell (with paving, if wanted) at the smallest distance; the lower one of two equals.
    fn nearest(&self, cell: usize, paved_only: bool, distance: impl Fn(Cell) -> f32) -> Option<Cell> {
        let fits = |layer: Cell| !layer.is_empty() && (layer.bits != 0 || !paved_only);
        if !self.cells[cell].has_layers() {
            return Some(self.cells[cell]).filter(|&layer| fits(layer));
        }
        let start = self.several.partition_point(|layer| (layer.cell as usize) < cell);
        let own = self.several[start..].iter().take_while(|layer| layer.cell as usize == cell);
        own.map(|layer| layer.is).filter(|&l| fits(l)).min_by(|a, b| distance(*a).total_cmp(&distance(*b)))
    }
}

/// The ground over the grid.
#[derive(Debug)]
pub(crate) struct Ground {
    side: usize,
    cell_m: f32,
    cells: Vec<Cell>,
    triangles: Vec<(Triangle, Tag)>,
}

impl Ground {
    /// Nothing yet, over as many cells on each side.
    pub(crate) fn new(side: usize, cell_m: f32) -> Self {
        Self { side, cell_m, cells: vec![Cell::EMPTY; side * side], triangles: Vec::new() }
    }

    pub(crate) fn clear(&mut self) {
        self.cells.fill(Cell::EMPTY);
        self.triangles.clear();
    }

    /// Adds a triangle of a ground tag.
    pub(crate) fn add(&mut self, triangle: &Triangle, tag: Tag) {
        let cells = &mut self.cells;
        visit(triangle, tag, self.side, |cell, z, bits| cells[cell].add(z, bits));
        self.triangles.push((*triangle, tag));
    }

    /// Whether some cell has several layers, of which one must be chosen.
    pub(crate) fn has_layers(&self) -> bool {
        self.cells.iter().any(|cell| cell.has_layers())
    }

    /// Chooses one layer per cell when all triangles are added.
    pub(crate) fn settle(&mut self) {
        let layers = self.split();
        self.follow(&layers);
    }

    /// Takes the middle of a settled larger ground.
    pub(crate) fn take_middle(&mut self, larger: &Self) {
        let beyond = (larger.side - self.side) / 2;
        let rows = larger.cells.chunks_exact(larger.side).skip(beyond);
        for (own, row) in self.cells.chunks_exact_mut(self.side).zip(rows) {
            own.copy_from_slice(&row[beyond..beyond + self.side]);
        }
    }

    /// The classes that each cell shows.
    pub(crate) fn bits(&self) -> Vec<u16> {
        self.cells.iter().map(|cell| cell.bits).collect()
    }

    /// Height of the shown layer's top above the agent; the agent's own where there is no ground.
    pub(crate) fn level(&self, cell: usize) -> f32 {
        self.height(cell).unwrap_or(0.0)
    }

    /// Height of the shown layer's top above the agent, where there is ground.
    pub(crate) fn height(&self, cell: usize) -> Option<f32> {
        let cell = self.cells[cell];
        (!cell.is_empty()).then_some(cell.high)
    }

    /// Size of a cell, metres.
    pub(crate) fn cell_m(&self) -> f32 {
        self.cell_m
    }

    /// Whether a point of a surface belongs to the shown layer.
    pub(crate) fn holds(&self, cell: usize, z: f32) -> bool {
        (z - self.level(cell)).abs() <= LAYER_M
    }

    /// Whether a flat area at some height lies on the shown layer.
    pub(crate) fn is_near(&self, cell: usize, z: f32) -> bool {
        (z - self.level(cell)).abs() <= AREA_M
    }

    /// The layers of all cells that have several, by cell, then from low to high.
    fn split(&self) -> Vec<Layer> {
        let mut surfaces: Vec<(u32, f32, u16)> = Vec::new();
        for (triangle, tag) in &self.triangles {
            visit(triangle, *tag, self.side, |cell, z, bits| {
                if self.cells[cell].has_layers() {
                    surfaces.push((cell as u32, z, bits));
                }
            });
        }
        surfaces.sort_unstable_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)).then(a.2.cmp(&b.2)));
        let mut layers: Vec<Layer> = Vec::new();
        for (cell, z, bits) in surfaces {
            match layers.last_mut() {
                Some(last) if last.cell == cell && z - last.is.high <= LAYER_M => last.is.add(z, bits),
                _ => {
                    let mut is = Cell::EMPTY;
                    is.add(z, bits);
                    layers.push(Layer { cell, is });
                }
            }
        }
        layers
    }

    /// Follows the ground from the agent, cell by cell, nearest cells first, and keeps the layer by which
    /// each cell is reached: first along roads and sidewalks, then over all other ground, and wherever that
    /// meets a road again, first along it. So neither a ramp nor a bridge is undercut by the terrain beside
    /// it.
    fn follow(&mut self, layers: &[Layer]) {
        let layers = Layers { cells: &self.cells, several: layers };
        let mut walk = Walk {
            side: self.side,
            settled: self.cells.clone(),
            reached: vec![false; self.side * self.side],
            order: Vec::new(),
            paved: Vec::new(),
        };
        let (mut next, mut next_paved) = (0, 0);
        for paved_only in [true, false] {
            for cell in self.near_agent() {
                let here = layers.nearest(cell, paved_only, Cell::height_gap);
                walk.reach(cell, here.filter(|l| l.height_gap() <= STAND_M));
            }
            loop {
                if let Some(&cell) = walk.paved.get(next_paved) {
                    next_paved += 1;
                    walk.step(cell, true, &layers);
                } else if let Some(&cell) = walk.order.get(next).filter(|_| !paved_only) {
                    next += 1;
                    walk.step(cell, false, &layers);
                } else {
                    break;
                }
            }
        }
        let Walk { mut settled, reached, .. } = walk;
        for (cell, settled) in settled.iter_mut().enumerate().filter(|(cell, _)| !reached[*cell]) {
            if let Some(layer) = layers.nearest(cell, false, Cell::height_gap) {
                *settled = layer;
            }
        }
        self.cells = settled;
    }

    /// The cells about the agent, row by row.
    fn near_agent(&self) -> impl Iterator<Item = usize> + use<> {
        let side = self.side;
        let reach = ((STAND_M / self.cell_m).ceil() as usize).max(1).min(side.div_ceil(2));
        let range = (side / 2).saturating_sub(reach)..(side / 2 + reach).min(side);
        range.clone().flat_map(move |row| range.clone().map(move |column| row * side + column))
    }
}

/// How far the ground has been followed.
struct Walk {
    side: usize,
    /// The layer of each cell that was reached.
    settled: Vec<Cell>,
    reached: Vec<bool>,
    /// The cells that were reached, in the order in which they were; and those of them on roads and
    /// sidewalks.
    order: Vec<usize>,
    paved: Vec<usize>,
}

impl Walk {
    /// A cell is reached by one of its layers.
    fn reach(&mut self, cell: usize, layer: Option<Cell>) {
        if let Some(layer) = layer.filter(|_| !self.reached[cell]) {
            (self.reached[cell], self.settled[cell]) = (true, layer);
            self.order.push(cell);
            if layer.bits != 0 {
                self.paved.push(cell);
            }
        }
    }

    /// Goes on from a cell to those beside it.
    fn step(&mut self, cell: usize, paved_only: bool, layers: &Layers) {
        let (side, from) = (self.side, self.settled[cell]);
        let (row, column) = (cell / side, cell % side);
        let neighbours = [
            (row > 0).then(|| cell - side),
            (column > 0).then(|| cell - 1),
            (column + 1 < side).then_some(cell + 1),
            (row + 1 < side).then_some(cell + side),
        ];
        for to in neighbours.into_iter().flatten() {
            if self.reached[to] {
                continue;
            }
            let layer = layers.nearest(to, paved_only, |l| l.gap(from));
            self.reach(to, layer.filter(|l| l.gap(from) <= STEP_M));
        }
    }
}

/// Calls with the cells of a ground triangle: the cell, the height, the classes it shows there.
fn visit(triangle: &Triangle, tag: Tag, side: usize, mut cell: impl FnMut(usize, f32, u16)) {
    let height = triangle.height();
    let road = 1 << BevClass::Road as u16;
    let bits = match tag {
        Tag::Road | Tag::RoadLine => road,
        Tag::Sidewalk => 1 << BevClass::Sidewalk as u16,
        _ => 0,
    };
    triangle.centres(side, |row, columns| {
        for column in columns {
            cell(row * side + column, height.at(row, column), bits);
        }
    });
}
