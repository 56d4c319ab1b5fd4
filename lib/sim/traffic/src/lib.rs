//! Drivers, signals and walkers on rapier3d: one scene from the plan to the log.
//!
//! [`simulate`] places the scene's actors at rest, runs the warm-up, and logs the state of every moving
//! object and signal from one period before frame 0 to the last frame, in steps of
//! [`schema::FRAME_PERIOD_S`].
//!
//! Drivers follow lanes with the intelligent driver model, obey signals, take turns at junctions and stop for
//! walkers. The rigid-body engine moves the bodies: as drivers wish while nothing touches, and by its contact
//! solver when a driver who looks at nothing hits something. Parked vehicles stop vehicles that run into
//! them; cones and tools are pushed away; two who graze each other side by side drive on; a vehicle that
//! nobody drives any more hits people on the sidewalk, too. Walkers go along sidewalks, and along the edges
//! of roads that have none; some in groups, and some stand and wait or talk.

mod acceleration;
mod activation;
mod bends;
mod bodies;
mod car_following;
mod error;
mod given;
mod grid;
mod hazards;
mod input;
mod junction;
mod lane_change;
mod occupancy;
mod outline;
mod road;
mod scene;
mod simulation;
mod swept_path;
mod vehicle;
mod walking;
mod wide_ways;

pub use car_following::{Idm, equilibrium_gap_m};
pub use error::TrafficError;
pub use input::{FixedWorld, SceneInput, SimulationLog};
pub use simulation::simulate;
