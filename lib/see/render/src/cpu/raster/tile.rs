//! One tile of the picture: walking the trees and drawing triangles.
#![allow(clippy::needless_range_loop, reason = "one index runs through many lane arrays")]

use std::ops::Range;

use crate::{Outputs, PinholeCamera, SKY, Stipple};
use glam::{DVec3, Vec3};

use crate::prepared::{
    BLOCK, Node, Outlines, Stack, TILE_HEIGHT, TILE_WIDTH, TiledView, Vectors, ViewedInstance, inside,
    reciprocal, reciprocal_f64,
};

/// Pixels drawn at once.
const LANES: usize = 8;
/// The pixels of a group, counted from its first.
const LANE: [f32; LANES] = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0];
/// A subtree of at most this many triangles is taken whole.
const BATCH: u32 = 16;
/// Pixels by which the projected box of a triangle grows: more than its rounding.
const MARGIN_PX: f32 = 0.01;
/// Relative slack of the test against the farthest depth drawn.
const DEPTH_SLACK: f32 = 1.0 + 1e-5;
/// After drawing over this many pixels, it pays to look up the farthest depth again.
const STALE_PX: usize = 1024;

/// A tile's pixels: with the numbers of what they see, or depths alone.
pub(super) struct Tile<const NUMBERED: bool> {
    /// Of depths alone, those of the sky are a hair less than that of the far end.
    inverse_depth: Vec<f32>,
    instance: Vec<u32>,
    triangle: Vec<u32>,
    /// Inverse depth where nothing is seen.
    sky: f32,
    /// No pixel is farther (planar depth, metres).
    farthest_m: f32,
    /// Pixels drawn over since `farthest_m` was looked up.
    stale: usize,
}

/// How pixels of a tile map to directions.
struct Lens {
    /// Direction per pixel.
    step: [f64; 2],
    /// Pixels from the optical axis to the centre of the tile's first pixel.
    first: [f64; 2],
    /// The same for projecting, in single precision: focal length, and the axis in tile pixels.
    focal: [f32; 2],
    axis: [f32; 2],
    near_m: f32,
    inverse_near: f32,
}

/// Half spaces, eight at once: a box wholly outside one of them can't be seen.
struct HalfSpaces {
    normal: [[f32; LANES]; 3],
    normal_abs: [[f32; LANES]; 3],
    offset: [f32; LANES],
}

/// The one of the half spaces that ends at the farthest depth drawn.
const DEPTH_PLANE: usize = 5;

impl HalfSpaces {
    /// The tile's frustum in the object frame of an instance.
    fn new(lens: &Lens, seen: &ViewedInstance<'_>) -> Self {
        let [first_x, first_y] = lens.first;
        // Half a pixel outside the outermost centres.
        let left = ((first_x - 0.5) * lens.step[0]) as f32;
        let right = ((first_x + TILE_WIDTH as f64 - 0.5) * lens.step[0]) as f32;
        let top = ((first_y - 0.5) * lens.step[1]) as f32;
        let bottom = ((first_y + TILE_HEIGHT as f64 - 0.5) * lens.step[1]) as f32;
        let optical = [
            (Vec3::new(1.0, 0.0, -left), 0.0),
            (Vec3::new(-1.0, 0.0, right), 0.0),
            (Vec3::new(0.0, 1.0, -top), 0.0),
            (Vec3::new(0.0, -1.0, bottom), 0.0),
            (Vec3::Z, -lens.near_m),
            (Vec3::NEG_Z, f32::MAX),
        ];
        let reach = seen.mesh.aabb.min.abs().max(seen.mesh.aabb.max.abs()).max_element();
        let slack_m = 16.0 * f32::EPSILON * (reach + seen.translation.abs().max_element());
        let mut all = Self { normal: [[0.0; LANES]; 3], normal_abs: [[0.0; LANES]; 3], offset: [0.0; LANES] };
        for (i, (normal, offset)) in optical.into_iter().enumerate() {
            let object = seen.rows[0] * normal.x + seen.rows[1] * normal.y + seen.rows[2] * normal.z;
            for axis in 0..3 {
                all.normal[axis][i] = object[axis];
                all.normal_abs[axis][i] = object[axis].abs();
            }
            all.offset[i] = normal.dot(seen.translation) + offset + slack_m * normal.abs().element_sum();
        }
        all
    }

    /// Moves the far end.
    fn end_at(&mut self, seen: &ViewedInstance<'_>, farthest_m: f32) {
        self.offset[DEPTH_PLANE] = farthest_m * DEPTH_SLACK - seen.translation.z;
    }

    #[inline]
    fn excludes(&self, node: &Node) -> bool {
        let centre = (node.min + node.max) * 0.5;
        let half = (node.max - node.min) * 0.5;
        let mut outside = 0;
        for i in 0..LANES {
            let along = |v: &[[f32; LANES]; 3], p: Vec3| v[0][i] * p.x + v[1][i] * p.y + v[2][i] * p.z;
            let nearest = along(&self.normal, centre) + self.offset[i];
            let extent = along(&self.normal_abs, half);
            outside |= u32::from(nearest + extent < 0.0);
        }
        outside != 0
    }
}

/// A linear function over the tile: value at the first pixel's centre, and change per column and row.
#[derive(Clone, Copy)]
struct Linear {
    per_column: f32,
    per_row: f32,
    start: f32,
}

impl Linear {
    /// The product of a vector with the pixels' directions.
    ///
    /// The negative of a vector gives exactly the negative function.
    #[inline]
    fn along_rays(lens: &Lens, v: DVec3) -> Self {
        let (per_column, per_row) = (v.x * lens.step[0], v.y * lens.step[1]);
        let start = v.z + per_column * lens.first[0] + per_row * lens.first[1];
        Self { per_column: per_column as f32, per_row: per_row as f32, start: start as f32 }
    }

    /// The smallest value that counts as inside an edge: zero itself for the one of two neighbours whose edge
    /// grows along the row (or, for level edges, down the column), else the smallest positive number.
    #[inline]
    fn threshold(&self) -> f32 {
        let owns = self.per_column > 0.0 || (self.per_column == 0.0 && self.per_row > 0.0);
        if owns { 0.0 } else { f32::from_bits(1) }
    }
}

/// A triangle that covers pixels of the tile.
struct Covering {
    corners: [Vectors<1>; 3],
    /// First and last column, first and last row.
    bounds: [usize; 4],
    /// Inverse depth of the corners: smallest, largest.
    inverse_range: [f32; 2],
    /// Larger inverse depths are not seen.
    inverse_limit: f32,
    /// The pixels that it may cover.
    stipple: Stipple,
    instance: u32,
    triangle: u32,
}

impl<const NUMBERED: bool> Tile<NUMBERED> {
    /// Draws one tile; `None` when nothing can be in it.
    pub(super) fn draw(view: &TiledView<'_>, column: usize, row: usize) -> Option<Self> {
        view.tile(column, row).next()?;
        let mut tile = Self::empty(view, column, row);
        let lens = Lens::new(view, column, row);
        for seen in view.tile(column, row) {
            tile.refresh(1);
            if seen.nearest_m > tile.farthest_m * DEPTH_SLACK {
                break; // The others are no nearer.
            }
            tile.draw_instance(&lens, seen);
        }
        Some(tile)
    }

    fn empty(view: &TiledView<'_>, column: usize, row: usize) -> Self {
        let (camera, pixels) = (&view.camera, TILE_WIDTH * TILE_HEIGHT);
        let sky = view.sky(if NUMBERED { Outputs::Surfaces } else { Outputs::Depths });
        let mut inverse_depth = vec![sky; pixels];
        // Pixels beyond the picture count as drawn.
        let columns = (camera.width as usize - column * TILE_WIDTH).min(TILE_WIDTH);
        let rows = (camera.height as usize - row * TILE_HEIGHT).min(TILE_HEIGHT);
        for (y, line) in inverse_depth.chunks_mut(TILE_WIDTH).enumerate() {
            line[if y < rows { columns } else { 0 }..].fill(f32::INFINITY);
        }
        let numbers = if NUMBERED { vec![SKY; pixels] } else { Vec::new() };
        Self {
            inverse_depth,
            instance: numbers.clone(),
            triangle: numbers,
            sky,
            farthest_m: camera.far_m,
            stale: 0,
        }
    }

    /// Copies the tile's depths into a band of the picture that starts at the tile's first row, row after
    /// row.
    pub(super) fn copy_depths(&self, camera: &PinholeCamera, column: usize, depth_m: &mut [f32]) {
        let sky = self.sky;
        for (row, to) in self.rows(camera.width as usize, column, depth_m) {
            // All of a tile's row, whatever of it is in the picture: the compiler turns that into vector
            // instructions.
            let row = row.start..row.start + TILE_WIDTH;
            let inverse = &self.inverse_depth[row.clone()];
            let mut line = [0.0; TILE_WIDTH];
            for x in 0..TILE_WIDTH {
                // Divided: no id hangs on it, and to round to the nearest has one answer everywhere.
                line[x] = 1.0 / inverse[x];
            }
            if NUMBERED {
                let instances = &self.instance[row];
                for x in 0..TILE_WIDTH {
                    line[x] = if instances[x] == SKY { f32::INFINITY } else { line[x] };
                }
            } else {
                for x in 0..TILE_WIDTH {
                    line[x] = if inverse[x] > sky { line[x] } else { f32::INFINITY };
                }
            }
            to.copy_from_slice(&line[..to.len()]);
        }
    }

    /// The same of the numbers.
    pub(super) fn copy_numbers(
        &self,
        camera: &PinholeCamera,
        column: usize,
        [instance, triangle]: [&mut [u32]; 2],
    ) {
        for (numbers, band) in [(&self.instance, instance), (&self.triangle, triangle)] {
            for (row, to) in self.rows(camera.width as usize, column, band) {
                to.copy_from_slice(&numbers[row]);
            }
        }
    }

    /// The tile's pixels row by row, with where they are in a band of the picture.
    fn rows<'b, T>(
        &self,
        width: usize,
        column: usize,
        band: &'b mut [T],
    ) -> impl Iterator<Item = (Range<usize>, &'b mut [T])> + use<'b, T, NUMBERED> {
        let columns = (width - column).min(TILE_WIDTH);
        let rows = band.chunks_exact_mut(width).enumerate();
        rows.map(move |(y, row)| {
            (y * TILE_WIDTH..y * TILE_WIDTH + columns, &mut row[column..column + columns])
        })
    }

    /// Looks up the farthest depth again when at least this many pixels were drawn since.
    fn refresh(&mut self, stale: usize) -> bool {
        if self.stale < stale {
            return false;
        }
        let mut least = [f32::INFINITY; LANES];
        for chunk in self.inverse_depth.as_chunks::<LANES>().0 {
            for i in 0..LANES {
                least[i] = if chunk[i] < least[i] { chunk[i] } else { least[i] };
            }
        }
        self.farthest_m = 1.0 / least.into_iter().fold(f32::INFINITY, f32::min);
        self.stale = 0;
        true
    }

    fn draw_instance(&mut self, lens: &Lens, seen: &ViewedInstance<'_>) {
        let nodes = &seen.mesh.bvh.nodes;
        let mut spaces = HalfSpaces::new(lens, seen);
        spaces.end_at(seen, self.farthest_m);
        let mut stack = Stack::new(0u32);
        stack.push(0);
        while let Some(index) = stack.pop() {
            let node = &nodes[index as usize];
            if spaces.excludes(node) {
                continue;
            }
            if node.child == 0 || node.count <= BATCH {
                self.draw_range(lens, seen, node.first, node.count);
                if self.refresh(STALE_PX) {
                    spaces.end_at(seen, self.farthest_m);
                }
                continue;
            }
            // The nearer child last, to be drawn first.
            let depth = |n: &Node| seen.rows[2].dot(n.min + n.max);
            let (left, right) = (node.child, node.child + 1);
            let left_nearer = depth(&nodes[left as usize]) <= depth(&nodes[right as usize]);
            let (near, far) = if left_nearer { (left, right) } else { (right, left) };
            stack.push(far);
            stack.push(near);
        }
    }

    /// Draws the triangles of some slots of a mesh.
    fn draw_range(&mut self, lens: &Lens, seen: &ViewedInstance<'_>, first: u32, count: u32) {
        let (first, end) = (first as usize, (first + count) as usize);
        for block in first / BLOCK..end.div_ceil(BLOCK) {
            self.draw_block(lens, seen, block, first, end);
        }
    }

    /// Draws the triangles of one block whose slots are in `first..end`: projects all, sorts out those that
    /// cover no pixel centre.
    fn draw_block(&mut self, lens: &Lens, seen: &ViewedInstance<'_>, block: usize, first: usize, end: usize) {
        let corners = &seen.mesh.blocks[block].0;
        let mut place = [[[0.0f32; BLOCK]; 3]; 3];
        for corner in 0..3 {
            let [px, py, pz] = &corners[corner];
            for axis in 0..3 {
                let (row, shift) = (seen.rows[axis], seen.translation[axis]);
                for i in 0..BLOCK {
                    place[corner][axis][i] = row.x * px[i] + row.y * py[i] + row.z * pz[i] + shift;
                }
            }
        }
        let low = |a: f32, b: f32| if a < b { a } else { b };
        let high = |a: f32, b: f32| if a > b { a } else { b };
        let mut nearest = [0.0; BLOCK];
        let mut farthest = [0.0; BLOCK];
        // Columns and rows, first and last pixel centre within the projected box. Divided, which may round
        // otherwise elsewhere: far less than the margin, so that what is seen does not hang on it.
        let mut from = [[0.0f32; BLOCK]; 2];
        let mut to = [[0.0f32; BLOCK]; 2];
        let mut wanted = [0u32; BLOCK];
        let last = [(TILE_WIDTH - 1) as f32, (TILE_HEIGHT - 1) as f32];
        for i in 0..BLOCK {
            let z = [place[0][2][i], place[1][2][i], place[2][2][i]];
            nearest[i] = low(low(z[0], z[1]), z[2]);
            farthest[i] = high(high(z[0], z[1]), z[2]);
            let all_in_front = nearest[i] >= lens.near_m;
            let per_depth = z.map(|z| 1.0 / z);
            for axis in 0..2 {
                let p: [f32; 3] = std::array::from_fn(|k| {
                    lens.focal[axis] * per_depth[k] * place[k][axis][i] + lens.axis[axis]
                });
                let start = high(low(low(p[0], p[1]), p[2]) - MARGIN_PX, 0.0).ceil();
                let stop = low(high(high(p[0], p[1]), p[2]) + MARGIN_PX, last[axis]).floor();
                from[axis][i] = if all_in_front { start } else { 0.0 };
                to[axis][i] = if all_in_front { stop } else { last[axis] };
            }
            wanted[i] = u32::from(
                (from[0][i] <= to[0][i])
                    & (from[1][i] <= to[1][i])
                    & (farthest[i] >= lens.near_m)
                    & (nearest[i] <= self.farthest_m * DEPTH_SLACK),
            );
        }
        if wanted.iter().all(|&wanted| wanted == 0) {
            return;
        }
        let (mut least, mut greatest) = ([0.0f32; BLOCK], [0.0f32; BLOCK]);
        for i in 0..BLOCK {
            least[i] = reciprocal(farthest[i]);
            greatest[i] = reciprocal(nearest[i]);
        }
        let panes = seen.panes.get(block).copied().unwrap_or(0);
        for i in 0..BLOCK {
            let slot = block * BLOCK + i;
            if wanted[i] == 0 || slot < first || slot >= end {
                continue;
            }
            let in_front = nearest[i] >= lens.near_m;
            self.cover(
                lens,
                &Covering {
                    corners: place.map(|corner| corner.map(|axis| [axis[i].into()])),
                    bounds: [from[0][i] as usize, to[0][i] as usize, from[1][i] as usize, to[1][i] as usize],
                    inverse_range: [least[i], if in_front { greatest[i] } else { f32::INFINITY }],
                    inverse_limit: if in_front { f32::INFINITY } else { lens.inverse_near },
                    stipple: if panes >> i & 1 != 0 { seen.stipple } else { Stipple::OPAQUE },
                    instance: seen.number,
                    triangle: seen.mesh.bvh.order[slot],
                },
            );
        }
    }

    /// Draws one triangle.
    fn cover(&mut self, lens: &Lens, covering: &Covering) {
        let outline = Outlines::new(&covering.corners);
        if outline.offset == [0.0] {
            return; // Seen edge-on.
        }
        let edges = outline.edges.map(|edge| Linear::along_rays(lens, vector(edge)));
        let thresholds = edges.map(|edge| edge.threshold());
        let inverse = Linear::along_rays(lens, vector(outline.normal) * reciprocal_f64(outline.offset[0]));
        let [x_first, x_last, y_first, y_last] = covering.bounds;
        let x_first = x_first - x_first % LANES;
        for y in y_first..=y_last {
            let at_row = |f: Linear| f.per_row * y as f32 + f.start;
            let rows = edges.map(at_row);
            let inverse_row = at_row(inverse);
            for x in (x_first..=x_last).step_by(LANES) {
                let start = x as f32;
                let index = y * TILE_WIDTH + x;
                let drawn = &mut self.inverse_depth[index..index + LANES];
                let mut value = [0.0f32; LANES];
                let mut closer = [0u32; LANES];
                let mut any = 0;
                for i in 0..LANES {
                    let column = start + LANE[i];
                    let w = inverse.per_column * column + inverse_row;
                    let products = std::array::from_fn(|k| edges[k].per_column * column + rows[k]);
                    let inside = inside(products, thresholds) & (w <= covering.inverse_limit);
                    // Within the corners' depths whatever the rounding of a steep plane.
                    let w = if w < covering.inverse_range[0] { covering.inverse_range[0] } else { w };
                    let w = if w > covering.inverse_range[1] { covering.inverse_range[1] } else { w };
                    value[i] = w;
                    closer[i] = u32::from(inside & (w >= drawn[i]));
                    any |= closer[i];
                }
                if any == 0 {
                    continue;
                }
                if covering.stipple != Stipple::OPAQUE {
                    // Tiles and groups begin at even columns and rows.
                    let row = covering.stipple.row(y as u32);
                    for i in 0..LANES {
                        closer[i] &= row >> (i & 1);
                    }
                }
                if NUMBERED {
                    let instances = &mut self.instance[index..index + LANES];
                    let triangles = &mut self.triangle[index..index + LANES];
                    let key = (covering.instance, covering.triangle);
                    for i in 0..LANES {
                        if closer[i] != 0 && (value[i] > drawn[i] || key < (instances[i], triangles[i])) {
                            drawn[i] = value[i];
                            instances[i] = covering.instance;
                            triangles[i] = covering.triangle;
                        }
                    }
                } else {
                    for i in 0..LANES {
                        drawn[i] = if closer[i] != 0 { value[i] } else { drawn[i] };
                    }
                }
                self.stale += LANES;
            }
        }
    }
}

fn vector([[x], [y], [z]]: Vectors<1>) -> DVec3 {
    DVec3::new(x, y, z)
}

impl Lens {
    fn new(view: &TiledView<'_>, column: usize, row: usize) -> Self {
        let (camera, first) = (&view.camera, view.first(column, row));
        Self {
            step: view.step(),
            first,
            focal: [camera.fx, camera.fy],
            axis: first.map(|f| -f as f32),
            near_m: camera.near_m,
            inverse_near: reciprocal(camera.near_m),
        }
    }
}
