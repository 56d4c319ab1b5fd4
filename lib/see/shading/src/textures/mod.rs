//! Textures for the shading of pictures: tiles that repeat without a seam, with coarser copies, made from
//! fixed seeds.
//!
//! [`Textures::get`] makes all of them at the first call. A [`Texture`] is read eight places at a time;
//! [`Noise`] is the same for one value without a meaning.
//!
//! ```
//! use simd::{F32x8, STEPS};
//! use shading::textures::Textures;
//!
//! let brick = &Textures::get().brick;
//! // Eight places a decimetre apart, seen from far away: all are as bright as the wall on average.
//! let seen = brick.at(STEPS * 0.1, F32x8::ZERO, F32x8::splat(4.0));
//! assert!(seen.shade.to_array().iter().all(|shade| (shade - 1.0).abs() < 0.01));
//! ```

mod all;
mod canvas;
mod cells;
mod laid;
mod noise;
mod plants;
mod stone;
mod texture;
mod wear;

pub use all::Textures;
pub use noise::{Noise, hash2, unit};
pub use texture::{Texels, Texture};
