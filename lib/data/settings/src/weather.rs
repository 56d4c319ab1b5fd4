//! Weather draws and overrides.

use schema::tables::Weather;

use crate::key::{Name, settings};
use crate::reader::Section;

settings! {
    /// Weather. Overrides apply to the fields of [`schema::tables::Weather`] by name.
    pub struct WeatherSettings {
        /// Draw a final weather and move towards it over the scene.
        dynamic: bool = true, yaml("dynamic_weather");
        /// Fixed values of the initial weather; the others are drawn.
        initial: Vec<(String, f64)> = Vec::new(), by(overrides);
        /// Fixed values of the final weather; the others are drawn.
        r#final: Vec<(String, f64)> = Vec::new(), named("final"), by(overrides);
    }
}

fn overrides(parent: &Section<'_>, name: &Name, _: Vec<(String, f64)>) -> Vec<(String, f64)> {
    let s = parent.section(name.key, name.doc);
    let read = |&name: &&'static str| {
        let (min, max) = match name {
            "sun_azimuth_deg" => (0.0, 360.0),
            "sun_altitude_deg" => (-90.0, 90.0),
            "fog_distance_m" => (0.0, 100_000.0),
            "fog_falloff" => (0.0, 100.0),
            "scattering_intensity" | "mie_scattering_scale" | "rayleigh_scattering_scale" => (0.0, 10.0),
            _ => (0.0, 100.0),
        };
        let value = s.optional_number(name, "drawn", min, max, "See the frames table in schema.md.")?;
        Some((name.to_owned(), value))
    };
    Weather::NAMES.iter().filter_map(read).collect()
}
