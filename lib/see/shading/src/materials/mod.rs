//! How surfaces look before light falls on them.

mod cells;
mod cloth;
mod dirt;
mod facade;
mod foliage;
mod front;
mod front_style;
mod ground;
mod gutter;
mod laid;
mod lane;
mod material;
mod pattern;
mod paving;
mod points;
mod room;
mod shaded_triangle;
mod uv_surface;
mod windows;

pub(crate) use foliage::{foliage, is_leaf};
pub(crate) use ground::gets_wet;
pub(crate) use material::sample;
pub(crate) use pattern::PatternSet;
pub(crate) use shaded_triangle::{Points, ShadedTriangle, Specular, Surroundings};
