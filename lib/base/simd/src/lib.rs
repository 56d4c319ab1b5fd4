//! SIMD: eight numbers at a time, for the inner loops of pictures.
//!
//! Every operation here is plain IEEE arithmetic, lane by lane: nothing fused, nothing approximate, no lane
//! meets another. A loop over eight lanes gives the bits that eight scalar turns would, on every machine.

mod math;
mod vector;

pub use math::{exp_neg, floor_words, hash2, lerp, number_of, smoothstep, unit};
pub use vector::Vec3x8;

/// Eight numbers; also the mask that a comparison of them gives (all bits of a lane, or none).
pub type F32x8 = wide::f32x8;
/// Eight words.
pub type U32x8 = wide::u32x8;
/// How many lanes there are.
pub const LANES: usize = 8;

/// 0, 1, ... 7.
pub const STEPS: F32x8 = F32x8::new([0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]);
