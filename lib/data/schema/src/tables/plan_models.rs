//! The models of packs.

use crate::table;

table! {
    /// One row per model of the packs that the configuration names; there is none without packs.
    PlanModelRow in "plan/models" by "spawn-planner" {
        /// Model name; one of the built-in catalogue is replaced.
        name: String,
        /// `car`, `van`, `truck`, `bus`, `motorcycle`, `bicycle`, `pedestrian`, `cone`, `barrier`.
        base_type: String,
        /// Length, width, height of its mesh (of people as they stand), m.
        size_m: [f64; 3],
        /// Distance between the axles, m (0 without wheels).
        wheelbase_m: f64,
        /// Wheel radius, m.
        wheel_radius_m: f64,
        /// Doors that open.
        doors: u32,
        /// Wheels.
        wheels: u32,
        /// Whether it has lamps.
        has_lights: bool,
        /// `emergency`, `taxi`, `electric` or empty.
        special: String,
        /// Of people `adult`, `child`, `elderly`; else empty.
        age: String,
        /// Of people `male`, `female`; else empty.
        gender: String,
        /// How common it is; all vehicles of the built-in catalogue together are 44, each person of it is 1.
        weight: f64,
        /// Its page: the TOML that describes it.
        page: String,
        /// BLAKE3 of its files, which are in `models/NAME`.
        hash: String,
    }
}
