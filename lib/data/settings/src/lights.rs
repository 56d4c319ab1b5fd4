//! Street lamps and lit windows.

use crate::key::settings;

settings! {
    /// Street lamps and lit windows at night.
    pub struct LightSettings {
        /// Share of street lamps that have failed.
        street_lamp_failure: f64 = 0.1, share();
        /// Change the flux of all street lamps of a dark scene by a common amount.
        change_intensity: bool = true, yaml("change_street_light_intensity");
        /// That amount, lm (negative: darker); drawn within the nominal 20000 lm either way.
        intensity_change_lm: Option<f64> = None, within(-1e9..=1e9), or("drawn per scene"),
            yaml("street_light_intensity_change");
        /// No change takes a street lamp below this flux, lm.
        min_intensity_lm: f64 = 10_000.0, within(0.0..=1e9), yaml("min_street_light_intensity");
        /// In a dark scene each building's windows have a colour of their own (not on high ground).
        random_building_colors: bool = true, yaml("random_building_light_colors");
        /// Street lamps never burn.
        street_lamps_off: bool = false, yaml("turn_off_street_lights");
        /// Windows are never lit.
        buildings_off: bool = false, yaml("turn_off_building_lights");
    }
}
