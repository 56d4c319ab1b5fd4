//! Typed poses, frames and boxes: the geometric words every other crate speaks.
//!
//! * World: the map's OpenDRIVE inertial frame, right-handed, x east, y north, z up, metres, `f64`.
//! * Bodies are FLU (x forward, y left, z up). A vehicle's origin is the centre of its footprint on the
//!   ground, an RSU's the foot of its pole.
//! * Cameras look along +z of their optical frame (x right, y down, z forward).
//! * Near an agent, geometry is `f32` relative to a [`LocalOrigin`]: world axes, shifted origin.
//!
//! A transform `world_from_agent: Pose<World, Agent>` takes points of the agent's frame to the world's
//! and composes only with a `Pose<Agent, _>` on its right.
//!
//! ```
//! use frames::{Agent, Pose, Sensor, World};
//! use nalgebra::{Point3, Vector3};
//!
//! let world_from_agent = Pose::<World, Agent>::from_xyz_rpy([10.0, 0.0, 0.0], [0.0, 0.0, frames::deg(90.0)]);
//! let agent_from_sensor = Pose::<Agent, Sensor>::from_xyz_rpy([1.0, 0.0, 2.0], [0.0; 3]);
//! let world_from_sensor = world_from_agent * agent_from_sensor;
//! // One metre ahead of an agent that faces north is one metre north of it.
//! let origin = world_from_sensor * Point3::origin();
//! assert!((origin - Point3::new(10.0, 1.0, 2.0)).norm() < 1e-12);
//! ```

mod aabb;
mod bbox;
mod local;
pub mod math;
mod pose;
mod rect;

pub use aabb::Aabb;
pub use bbox::{CORNER_SIGNS, FOOTPRINT_LOOP, OrientedBox};
pub use local::LocalOrigin;
pub use pose::{Agent, Frame, Object, Optical, Pose, Sensor, World, flu_from_optical};
pub use rect::OrientedRect;

/// Degrees to radians.
#[must_use]
pub fn deg(degrees: f64) -> f64 {
    degrees * (std::f64::consts::PI / 180.0)
}

/// Radians to degrees.
#[must_use]
pub fn to_deg(radians: f64) -> f64 {
    radians * (180.0 / std::f64::consts::PI)
}

/// Wraps an angle to `(-pi, pi]`.
#[must_use]
pub fn wrap_pi(angle_rad: f64) -> f64 {
    use std::f64::consts::{PI, TAU};
    let wrapped = angle_rad - TAU * ((angle_rad + PI) / TAU).floor();
    // The floor maps -pi to -pi; the interval is closed at +pi.
    if wrapped <= -PI { wrapped + TAU } else { wrapped }
}
