//! What `simulate-and-log` annotates while it has the world in hand: raw boxes and HD-map records.
//!
//! | module | from | to |
//! |---|---|---|
//! | [`boxes`] | actors and poses of a frame | raw 3-D boxes of every agent |
//! | [`hd_map`] | the map and a pose | the lane an agent is in |

pub mod boxes;
pub mod hd_map;
