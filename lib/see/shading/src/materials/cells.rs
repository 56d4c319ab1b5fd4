//! Things strewn over the world: one in a square, somewhere in it.

use simd::{F32x8, U32x8, floor_words, hash2, unit};

use super::shaded_triangle::{Points, Surroundings};

/// A random word of the square of the world in which points lie, and how far they are (x and y of the world)
/// from a place in it that is so far from its edges at least, metres.
#[inline]
pub(super) fn in_cell(p: &Points, cell_m: f32, salt: u32, inset_m: f32) -> (U32x8, [F32x8; 2]) {
    let wrapped = (Surroundings::WRAP_M as f32 / cell_m) as u32 - 1;
    let (x, y) = (p.world_m.x * (1.0 / cell_m), p.world_m.y * (1.0 / cell_m));
    let word = hash2(floor_words(x) & wrapped, floor_words(y) & wrapped, U32x8::splat(salt));
    let inset = inset_m / cell_m;
    let off = |v: F32x8, bits: U32x8| (v - v.floor() - inset - unit(bits) * (1.0 - 2.0 * inset)) * cell_m;
    (word, [off(x, word), off(y, word * 0x85eb_ca6bu32)])
}
