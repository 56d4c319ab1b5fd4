//! Colour pictures: light times surface, then what lens, film and weather make of it.

mod antialias;
mod bloom;
mod compose;
mod dazzle;
mod defocus;
mod drops;
mod film;
mod leaves;
mod mirror;
mod noise;
#[expect(clippy::module_inception, reason = "the type that the others work on")]
mod picture;
mod rain;
mod shade;
mod shader;
mod shutter;
mod soften;
mod spray;
mod vignette;

pub use compose::{Shot, compose};
pub use drops::Drops;
pub use noise::Noise;
pub use picture::Picture;
