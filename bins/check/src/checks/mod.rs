//! The checks, each over a part of a scene.

pub(crate) mod agent;
mod bev;
mod boxes;
mod boxes_2d;
mod cameras;
mod cells;
mod clouds;
mod counts;
mod flow;
mod grid;
mod inertial;
mod layers;
pub(crate) mod log;
mod mapped;
mod mask;
mod observed;
mod ranging;
mod raster;
mod scans;
pub(crate) mod seats;
pub(crate) mod sightings;
pub(crate) mod statistics;
pub(crate) mod tables;
pub(crate) mod tracks;
mod voxels;
pub(crate) mod windows;
