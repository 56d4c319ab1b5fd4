//! Trajectories that the user gave.

use crate::table;

table! {
    /// One row per actor on a given trajectory and frame; there is none without `agents.trajectories`. Rows
    /// of an actor follow one another by frame: data-collection vehicles first, then the others by name.
    PlanTrajectoryRow in "plan/trajectories" by "spawn-planner" {
        /// Scene number.
        scene: u32,
        /// `vehicle_0`, ... of a data-collection vehicle; the name of any other actor in the file.
        actor: String,
        /// Model of the body.
        model: String,
        /// Frame number; negative ones are before the recording.
        frame: i32,
        /// Centre of the footprint on the ground in the world, m.
        xyz_m: [f64; 3],
        /// Orientation in the world: roll, pitch, yaw, rad.
        rpy_rad: [f64; 3],
    }
}
