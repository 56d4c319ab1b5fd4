//! Walkers: where they can walk, where they go, and how they keep out of the way.

pub(crate) mod crowd;
mod dodging;
mod edges;
pub(crate) mod fixtures;
pub(crate) mod gait;
pub(crate) mod paths;
pub(crate) mod routes;
pub(crate) mod seats;
pub(crate) mod surroundings;
pub(crate) mod talk;
pub(crate) mod together;
pub(crate) mod waiting;
pub(crate) mod walker;
pub(crate) mod walking_group;
