//! Junctions: coming to one, reserving the way through, and giving way inside.

pub(crate) mod approach;
pub(crate) mod conflict;
pub(crate) mod exits;
mod queues;
pub(crate) mod reservations;
pub(crate) mod right_of_way;
