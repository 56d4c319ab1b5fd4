//! Drivers, signals and walkers on rapier3d: one scene from the plan to the log.
//!
//! [`simulate`] places the scene's actors at rest, runs the warm-up, and logs the state of every moving object and
//! signal from one period before frame 0 to the last frame, in steps of [`schema::FRAME_PERIOD_S`].
//!
//! Drivers follow lanes with the intelligent driver model, obey signals, take turns at junctions and stop for walkers.
//! The rigid-body engine moves the bodies: as drivers wish while nothing touches, and by its contact solver when a
//! driver who looks at nothing hits something.

mod approach;
mod attention;
mod bends;
mod bodies;
mod change;
mod crowd;
mod doors;
mod driver;
mod error;
mod exits;
mod fixtures;
mod grid;
mod hazards;
mod input;
mod junction;
mod links;
mod log;
mod meeting;
mod moving;
mod net;
mod occupancy;
mod paths;
mod placing;
mod queues;
mod reservations;
mod routes;
mod sides;
mod signals;
mod simulation;
mod sleep;
mod spawn;
mod sway;
mod sweep;
mod vehicles;
mod walkers;
mod ways;

pub use driver::{Idm, equilibrium_gap_m};
pub use error::TrafficError;
pub use input::{SceneInput, SceneLog};
pub use simulation::simulate;
