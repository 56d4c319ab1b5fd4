//! Accidents and road works.

use crate::key::settings;

settings! {
    /// Accidents and road works. Shares are 0 to 1.
    pub struct HazardSettings {
        /// Share of the spawn points around the vehicles at which a hazard is tried.
        share: f64 = 0.016, share(), yaml_percent("hazard_area_percentage");
        /// Chance that a hazard is an accident, not road works.
        accident_share: f64 = 0.5, share(), yaml_percent("accident_hazard_percentage");
        /// Chance that an emergency vehicle stands at an accident.
        emergency_share: f64 = 0.5, share(), yaml_percent("emergency_vehicle_at_accident_percentage");
        /// Chance that a cone beside an accident or road works is missing.
        missing_cone_share: f64 = 0.32, share(), yaml_percent("missing_cone_percentage");
    }
}
