//! What a scene begins with, and what is written of it.

pub(crate) mod free_space;
pub(crate) mod initial_actors;
pub(crate) mod lamps;
pub(crate) mod log;
pub(crate) mod placing;
pub(crate) mod rolling;
pub(crate) mod rows;
pub(crate) mod spawn;
