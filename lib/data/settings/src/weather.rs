//! Weather draws and what of them is fixed.

use schema::tables::Weather;
use serde::{Deserialize, Serialize};

use crate::key::{Name, settings, tables};
use crate::reader::Section;

/// A value of the weather.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum WeatherValue {
    /// The same in every scene.
    Fixed(f64),
    /// Drawn for each scene, evenly between the two.
    Between([f64; 2]),
}

impl WeatherValue {
    /// The greatest value that it may be.
    #[must_use]
    pub fn greatest(self) -> f64 {
        match self {
            Self::Fixed(value) => value,
            Self::Between([_, most]) => most,
        }
    }
}

impl From<f64> for WeatherValue {
    fn from(value: f64) -> Self {
        Self::Fixed(value)
    }
}

settings! {
    /// The weather at a moment of each scene.
    pub struct WeatherKeyframe {
        /// The moment, s, always given: `initial` is at 0, `final` at the scene's end, which may come before.
        at_s: f64 = 0.0, within(0.0..=3600.0);
        /// Values then. Between the keyframes that have a key its values move evenly, before and after them
        /// they stay; keys that no keyframe has are drawn as without keyframes.
        values: Vec<(String, WeatherValue)> = Vec::new(), by(values_here);
    }
}

settings! {
    /// Weather. Fixed values are of the fields of [`schema::tables::Weather`] by name.
    pub struct WeatherSettings {
        /// Draw a final weather and move towards it over the scene.
        dynamic: bool = true, yaml("dynamic_weather");
        /// Values of the initial weather that are fixed, or drawn between two numbers; the others are drawn.
        initial: Vec<(String, WeatherValue)> = Vec::new(), by(values);
        /// The same of the final weather.
        r#final: Vec<(String, WeatherValue)> = Vec::new(), named("final"), by(values);
        /// Weather at moments of a scene, in their order.
        #[serde(skip_serializing_if = "Vec::is_empty")]
        keyframes: Vec<WeatherKeyframe> = Vec::new(), by(tables);
    }
    rule in_order;
}

fn values(
    parent: &Section<'_>,
    name: &Name,
    default: Vec<(String, WeatherValue)>,
) -> Vec<(String, WeatherValue)> {
    values_here(&parent.section(name.key, name.doc), name, default)
}

/// The values that stand among a section's keys.
fn values_here(s: &Section<'_>, _: &Name, _: Vec<(String, WeatherValue)>) -> Vec<(String, WeatherValue)> {
    let read = |&name: &&'static str| {
        let range = match name {
            "sun_azimuth_deg" => (0.0, 360.0),
            "sun_altitude_deg" => (-90.0, 90.0),
            "fog_distance_m" => (0.0, 100_000.0),
            "fog_falloff" => (0.0, 100.0),
            "scattering_intensity" | "mie_scattering_scale" | "rayleigh_scattering_scale" => (0.0, 10.0),
            _ => (0.0, 100.0),
        };
        let doc = "See the frames table in schema.md.";
        let value = match s.number_or_two(name, "drawn", range, doc)? {
            [least, most] if least == most => WeatherValue::Fixed(least),
            two => WeatherValue::Between(two),
        };
        Some((name.to_owned(), value))
    };
    Weather::NAMES.iter().filter_map(read).collect()
}

fn in_order(s: &Section<'_>, read: &WeatherSettings) {
    let sections = s.sections("keyframes", "none", "").unwrap_or_default();
    for section in sections.iter().filter(|section| !section.has("at_s")) {
        section
            .fault_at("at_s", format!("`{}` is missing: when is it, in seconds?", section.path_of("at_s")));
    }
    for (section, pair) in sections.iter().skip(1).zip(read.keyframes.windows(2)) {
        let [before, after] = [pair[0].at_s, pair[1].at_s];
        if after <= before {
            let path = section.path_of("at_s");
            section.fault_at("at_s", format!("`{path}` is {after}, not after the one before it ({before})"));
        }
    }
    // At 0 `initial` is a keyframe, too.
    let first = sections.first().zip(read.keyframes.first()).filter(|(_, keyframe)| keyframe.at_s == 0.0);
    for (name, _) in first.iter().flat_map(|(_, keyframe)| &keyframe.values) {
        if let Some((section, _)) = first.filter(|_| read.initial.iter().any(|(other, _)| other == name)) {
            let (path, other) = (section.path_of(name), s.path_of("initial"));
            section
                .fault_at(name, format!("`{path}` is at 0 s, as `{other}.{name}` is: leave one of them out"));
        }
    }
}
