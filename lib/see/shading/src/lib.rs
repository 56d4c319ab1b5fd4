#![doc = include_str!("../README.md")]

mod light;
mod materials;
mod painter;
mod picture;
pub mod retro;
mod sight;
pub mod textures;

pub use light::{FrameWeather, Lighting, Sky, StillWorld, fog_extinction_per_m};
pub use painter::{CpuPainter, Painter};
pub use picture::{Drops, Noise, Picture, Shot, compose};
pub use sight::{Sight, wants_colour};
