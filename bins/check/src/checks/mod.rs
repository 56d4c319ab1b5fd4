//! The checks, each over a part of a scene.

pub(crate) mod agent;
mod bev;
mod boxes;
mod cameras;
mod clouds;
mod counts;
mod flow;
mod inertial;
pub(crate) mod log;
mod observed;
mod ranging;
mod scans;
pub(crate) mod statistics;
pub(crate) mod tables;
pub(crate) mod tracks;
mod voxels;
