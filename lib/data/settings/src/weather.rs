//! Weather draws and overrides.

use serde::Serialize;

/// Weather. Overrides apply to the fields of [`schema::tables::Weather`] by name.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct WeatherSettings {
    /// Draw a final weather and move towards it over the scene.
    pub dynamic: bool,
    /// Fixed initial values by field name.
    pub initial: Vec<(String, f64)>,
    /// Fixed final values by field name.
    pub r#final: Vec<(String, f64)>,
}

impl Default for WeatherSettings {
    fn default() -> Self {
        Self { dynamic: true, initial: Vec::new(), r#final: Vec::new() }
    }
}
