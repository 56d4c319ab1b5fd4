//! A texture in the making.

use crate::textures::noise::{Noise, lattice};

/// One texel.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Spot {
    /// Texels over the mean.
    pub(crate) height: f32,
    /// Brightness; only ratios count.
    pub(crate) shade: f32,
    /// Share of the other stuff; only differences count.
    pub(crate) tint: f32,
}

/// A square that repeats.
pub(crate) struct Canvas {
    pub(crate) side: usize,
    pub(crate) spots: Vec<Spot>,
}

impl Canvas {
    /// Each texel by where its middle is, 0 to 1.
    pub(crate) fn new(side: usize, of: impl Fn(f32, f32) -> Spot) -> Self {
        let middle = |i: usize| (i as f32 + 0.5) / side as f32;
        let spots = (0..side * side).map(|i| of(middle(i % side), middle(i / side))).collect();
        Self { side, spots }
    }

    /// The texel of a column and row, which repeat.
    pub(crate) fn spot(&mut self, x: i32, y: i32) -> &mut Spot {
        let wrap = |v: i32| v as usize & (self.side - 1);
        let index = wrap(y) * self.side + wrap(x);
        &mut self.spots[index]
    }
}

/// Clouds over a tile of which the largest are a quarter as large as `1 / times` of the tile, and turned by
/// `seed`: 0 to 1, 1/2 on average.
pub(crate) fn clouds(x: f32, y: f32, times: f32, seed: u32) -> f32 {
    let shift = seed as f32;
    Noise::get().at(x * 256.0 * times + shift * 37.0, y * 256.0 * times + shift * 101.0, 0.5)
}

/// Grain of `across` to the tile and half that size: 0 to 1, 1/2 on average, without anything larger that
/// would show how the tile repeats.
pub(crate) fn grain(x: f32, y: f32, across: i32) -> f32 {
    let octave = |n: i32| lattice(x * n as f32, y * n as f32, n);
    0.6 * octave(across) + 0.4 * octave(2 * across)
}

/// 0 below `low`, 1 above `high`, smooth between.
pub(crate) fn smooth(low: f32, high: f32, x: f32) -> f32 {
    let t = ((x - low) / (high - low)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}
