//! What a light sees, as depths by texel.

use std::sync::Arc;

use glam::Vec3;
use rayon::prelude::*;
use render::PinholeCamera;
use simd::{F32x8, LANES, Vec3x8, floor_words};

use super::lens::{BLOCK, Lens, Window};

/// How far around a block its readers reach, texels.
pub(super) const AROUND: usize = 3;
/// Where nothing around is higher than this above a place, all of it is lit; where everything is higher than
/// the other, none is. Metres.
const LEVEL_M: f32 = 0.06;
const COVER_M: f32 = 0.5;
/// The last map's shadows fade over this share of its width.
const FADING: f32 = 0.12;

/// What a light sees of static objects, through a whole lens.
#[derive(Clone, Debug)]
pub(super) struct Still {
    side: usize,
    depth_m: Vec<f32>,
    blocks: Vec<[f32; 2]>,
    /// Height of the light in the frame that the blocks' heights are in.
    origin_z: f32,
}

/// Static objects in a window of a lens.
pub(super) struct Standing {
    /// The window, or more.
    pub(super) map: Arc<Still>,
    /// The window's first column and row in it.
    pub(super) corner: [u32; 2],
}

/// What a light sees through a window of a lens.
#[derive(Clone, Debug)]
pub(super) struct Map {
    /// Rows of the rotation from local to light axes, scaled to texels across and metres along.
    right: Vec3,
    down: Vec3,
    forward: Vec3,
    origin: Vec3,
    focal: f32,
    /// Column and row of the axis.
    centre: [f32; 2],
    pub(super) side: usize,
    pub(super) texel_m: f32,
    pub(super) depth_m: Vec<f32>,
    /// Least and greatest height of what the light sees in and around each block: most of the ground is
    /// wholly lit or wholly in shadow, and one look here tells.
    blocks: Vec<[f32; 2]>,
}

impl Map {
    /// The map of a window of a lens, in the local frame of its camera: static objects, if they are known
    /// already, and what else the light sees through the camera.
    pub(super) fn new(
        lens: &Lens,
        window: Window,
        camera: &PinholeCamera,
        seen_m: Vec<f32>,
        standing: Option<&Standing>,
    ) -> Self {
        let Lens { right, down, forward, texel_m, .. } = *lens;
        let mut map = Self {
            right,
            down,
            forward,
            origin: camera.local_from_optical.translation.into(),
            focal: camera.fx,
            centre: [camera.cx, camera.cy],
            side: window.side as usize,
            texel_m,
            depth_m: Vec::new(),
            blocks: Vec::new(),
        };
        let Some(Standing { map: still, corner }) = standing else {
            map.depth_m = seen_m;
            map.blocks = map.sum_up();
            return map;
        };
        let (side, per_side) = (map.side, map.side.div_ceil(BLOCK));
        let [column, row] = corner.map(|c| c as usize);
        map.depth_m.reserve_exact(side * side);
        // Blocks in whose reach something moves.
        let mut touched = vec![false; per_side * per_side];
        for (y, moving) in seen_m.chunks_exact(side).enumerate() {
            let start = (row + y) * still.side + column;
            let standing = &still.depth_m[start..start + side];
            map.depth_m.extend(standing.iter().zip(moving).map(|(s, m)| if m < s { *m } else { *s }));
            let nearer = |x: &usize| moving[*x] < standing[*x];
            let mut x = 0;
            while let Some(found) = (x..side).find(nearer) {
                let reach =
                    |at: usize| at.saturating_sub(AROUND) / BLOCK..=((at + AROUND) / BLOCK).min(per_side - 1);
                for block_row in reach(y) {
                    for block in reach(found) {
                        touched[block_row * per_side + block] = true;
                    }
                }
                x = found + 1;
            }
        }
        // Heights are told from the origin, which is elsewhere for every agent.
        let lift = map.origin.z - still.origin_z;
        let blocks = (0..per_side * per_side).map(|i| {
            let (x, y) = (column / BLOCK + i % per_side, row / BLOCK + i / per_side);
            still.blocks[y * still.side.div_ceil(BLOCK) + x].map(|height| height + lift)
        });
        map.blocks = blocks.collect();
        for (i, _) in touched.iter().enumerate().filter(|(_, touched)| **touched) {
            map.blocks[i] = map.heights(i % per_side, i / per_side);
        }
        map
    }

    /// Least and greatest height of what the light sees in and around a block.
    fn heights(&self, column: usize, row: usize) -> [f32; 2] {
        let span = |block: usize| {
            (block * BLOCK).saturating_sub(AROUND)..((block + 1) * BLOCK + AROUND).min(self.side)
        };
        let per_column = self.right.z / self.focal;
        let mut heights = [f32::INFINITY, f32::NEG_INFINITY];
        for y in span(row) {
            let slope = self.forward.z + self.down.z * (y as f32 + 0.5 - self.centre[1]) / self.focal;
            let columns = span(column);
            let texels = &self.depth_m[y * self.side + columns.start..y * self.side + columns.end];
            for (x, depth) in columns.zip(texels) {
                let height = self.origin.z + depth * (slope + per_column * (x as f32 + 0.5 - self.centre[0]));
                heights[0] = if height < heights[0] { height } else { heights[0] };
                heights[1] = if height > heights[1] { height } else { heights[1] };
            }
        }
        heights
    }

    /// [`heights`](Self::heights) of all blocks: columns first, row by row; then rows.
    fn sum_up(&self) -> Vec<[f32; 2]> {
        let (side, per_side) = (self.side, self.side.div_ceil(BLOCK));
        let span =
            |block: usize| (block * BLOCK).saturating_sub(AROUND)..((block + 1) * BLOCK + AROUND).min(side);
        let empty = [f32::INFINITY, f32::NEG_INFINITY];
        let join = |a: [f32; 2], b: [f32; 2]| {
            [if b[0] < a[0] { b[0] } else { a[0] }, if b[1] > a[1] { b[1] } else { a[1] }]
        };
        let per_column = self.right.z / self.focal;
        let mut across = vec![empty; side * per_side];
        across.par_chunks_mut(per_side).zip(self.depth_m.par_chunks(side)).enumerate().for_each_init(
            || vec![0.0; side],
            |heights, (y, (across, depths))| {
                let slope = self.forward.z + self.down.z * (y as f32 + 0.5 - self.centre[1]) / self.focal;
                for (x, (height, depth)) in heights.iter_mut().zip(depths).enumerate() {
                    *height =
                        self.origin.z + depth * (slope + per_column * (x as f32 + 0.5 - self.centre[0]));
                }
                for (block, joined) in across.iter_mut().enumerate() {
                    *joined = heights[span(block)].iter().fold(empty, |all, &h| join(all, [h, h]));
                }
            },
        );
        let mut blocks = vec![empty; per_side * per_side];
        blocks.par_chunks_mut(per_side).enumerate().for_each(|(block_row, blocks)| {
            for row in span(block_row) {
                for (all, one) in blocks.iter_mut().zip(&across[row * per_side..]) {
                    *all = join(*all, *one);
                }
            }
        });
        blocks
    }

    /// What it holds, to be kept.
    pub(super) fn into_still(self) -> Still {
        Still { side: self.side, depth_m: self.depth_m, blocks: self.blocks, origin_z: self.origin.z }
    }

    /// Columns, rows (texel centres at whole numbers) and depths of places.
    #[inline]
    pub(super) fn project(&self, p: Vec3x8) -> Vec3x8 {
        let d = p - Vec3x8::splat(self.origin);
        let z = d.dot(Vec3x8::splat(self.forward));
        let scale = self.focal / z;
        let (x, y) = (d.dot(Vec3x8::splat(self.right)), d.dot(Vec3x8::splat(self.down)));
        Vec3x8::new(x * scale + (self.centre[0] - 0.5), y * scale + (self.centre[1] - 0.5), z)
    }

    /// Where texels all around a place, as many as `margin`, are on the map.
    #[inline]
    pub(super) fn holds(&self, q: &Vec3x8, margin: f32) -> F32x8 {
        let (least, limit) = (2.0 + margin, (self.side - 2) as f32 - margin);
        q.x.simd_ge(least) & q.y.simd_ge(least) & q.x.simd_lt(limit) & q.y.simd_lt(limit)
    }

    /// 1 for places well within the map, 0 at its edge.
    #[inline]
    pub(super) fn within(&self, q: &Vec3x8) -> F32x8 {
        let limit = F32x8::splat(self.side as f32);
        let inward = q.x.fast_min(q.y).fast_min((limit - q.x).fast_min(limit - q.y));
        (inward * (1.0 / (FADING * self.side as f32))).fast_clamp(F32x8::ZERO, F32x8::ONE)
    }

    #[inline]
    pub(super) fn at(&self, column: usize, row: usize) -> f32 {
        self.depth_m.get(row * self.side + column).copied().unwrap_or(f32::INFINITY)
    }

    /// Least and greatest heights around texels, and in which block each is.
    #[inline]
    pub(super) fn block(&self, q: &Vec3x8) -> ([F32x8; 2], [u32; LANES]) {
        let per_side = self.side.div_ceil(BLOCK) as u32;
        let shift = BLOCK.ilog2();
        let index = ((floor_words(q.y) >> shift) * per_side + (floor_words(q.x) >> shift)).to_array();
        let found =
            index.map(|i| self.blocks.get(i as usize).copied().unwrap_or([f32::NEG_INFINITY, f32::INFINITY]));
        ([found.map(|b| b[0]).into(), found.map(|b| b[1]).into()], index)
    }

    /// Shares of the texels around that see the places, each weighted by its overlap with a square two texels
    /// wide: edges of shadows are soft, as wide as three texels. `height` is that of the places; those not
    /// `wanted` get anything.
    #[inline]
    pub(super) fn lit(&self, wanted: F32x8, q: &Vec3x8, height: F32x8, bias_m: f32) -> Lit {
        // Somewhere on the map, where it does not matter.
        let q = q.or(wanted, Vec3x8::splat(Vec3::splat(2.0)));
        let ([least, greatest], block) = self.block(&q);
        let above = greatest.simd_le(height + LEVEL_M);
        let all_around = above | least.simd_gt(height + COVER_M);
        let mut share = above.select(F32x8::ONE, F32x8::ZERO);
        let mixed = wanted & !all_around;
        if mixed.any() {
            share = mixed.select(self.soft(mixed.to_bitmask(), &q, bias_m), share);
        }
        Lit { share, all_around: all_around.to_bitmask(), block }
    }

    /// As [`lit`](Self::lit), from the texels; of the lanes whose bits are set.
    fn soft(&self, mut wanted: u32, q: &Vec3x8, bias_m: f32) -> F32x8 {
        let mut share = [0.0; LANES];
        while wanted != 0 {
            let i = wanted.trailing_zeros() as usize;
            wanted &= wanted - 1;
            let p = q.lane(i);
            let (x0, y0) = (p.x as usize, p.y as usize);
            let z = p.z - bias_m;
            let first = (y0 - 1) * self.side + x0 - 1;
            let row = |r: usize| -> [f32; 4] {
                let start = first + r * self.side;
                let Some(texels) = self.depth_m.get(start..start + 4).and_then(|s| s.first_chunk::<4>())
                else {
                    return [1.0; 4];
                };
                texels.map(|depth| if depth >= z { 1.0 } else { 0.0 })
            };
            let (fx, fy) = (p.x - x0 as f32, p.y - y0 as f32);
            // Each way the weights sum to 3.
            let [a, b, c, d] = [row(0), row(1), row(2), row(3)];
            let down: [f32; 4] = std::array::from_fn(|k| (1.0 - fy) * a[k] + b[k] + c[k] + fy * d[k]);
            share[i] = ((1.0 - fx) * down[0] + down[1] + down[2] + fx * down[3]) * (1.0 / 9.0);
        }
        share.into()
    }
}

/// How much of a light reaches eight places.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lit {
    /// Share of the light's disc that is seen, 0 to 1.
    pub(crate) share: F32x8,
    /// Where it is the same in the whole neighbourhood: bits by lane.
    pub(crate) all_around: u32,
    /// Which neighbourhood: number of a block of texels.
    pub(crate) block: [u32; LANES],
}

impl Lit {
    /// No light, wherever.
    pub(crate) fn none() -> Self {
        Self { share: F32x8::ZERO, all_around: u32::from(u8::MAX), block: [u32::MAX; LANES] }
    }
}
