//! Bird's-eye-view masks: what lies on the ground around an agent, and the objects on it.
//!
//! [`BevRasterizer`] draws them by the rule `exact`, which follows; [`LaneRasterizer`] by the rule
//! `simbev2x`.
//!
//! The grid follows the agent's yaw and planar position only. Row 0 is farthest ahead, column 0 farthest to
//! the left; the agent's origin is the corner between the four middle cells.
//!
//! # Coverage
//! Masks are vertical orthographic projections of the world's triangles: a cell carries road, sidewalk or a
//! class of objects when its **centre** does; so crosswalks and hazards, which are polygons. What an object
//! has of one class (a rider; the bicycle below it; a car with its wheels and open doors) and that covers no
//! centre in the grid takes the one cell whose centre is nearest to the middle of its bounding rectangle
//! along the grid's axes: nothing vanishes.
//!
//! Lane markings are lines without width: a cell carries road line when a sample of a marking's middle lies
//! in it. Samples follow one another at less than a cell's size, dashed markings and continuous ones alike.
//! Zebra bars, stop lines and the outlines of parking spaces are no lane markings.
//!
//! # Overpasses
//! Where a vertical line meets the ground several times, the mask shows the layer one gets to by following
//! the ground from the agent, first along roads and sidewalks, then over land as well; or, where no way
//! leads, the one nearest to the agent's height. Ways lead up to 60 m, at most 300 cells, beyond the mask. A
//! marking is shown when it lies within 1.5 m of the shown layer, an object when it stands on it (0.5 m below
//! to 1.5 m above it, at its own place), and its surfaces from 0.5 m below to 4.8 m above the layer at each
//! cell. So each cell shows one deck alone, with the objects on it; another deck is drawn where ways lead to
//! it and it lies over no ground of the agent's own.

mod error;
mod exact;
mod grid;
mod layers;
mod line;
mod mask;
mod objects;
mod polygon;
mod raster;
mod simbev2x;
mod tags;

pub use error::BevError;
pub use exact::{Areas, BevRasterizer, PaintAreas};
pub use mask::{BevMask, to_rgb};
pub use simbev2x::{Footprint, LaneAreas, LaneRasterizer, LaneStrip, LaneView};

#[cfg(test)]
mod tests;
