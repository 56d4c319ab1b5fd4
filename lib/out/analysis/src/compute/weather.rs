//! How weather moves from the start to the end of a scene.

use std::collections::BTreeMap;

use schema::Published;
use schema::scene_info::SceneInfo;

use super::share::ratio;
use crate::table::{Section, Table};

/// One transition matrix.
pub(crate) struct WeatherTable {
    pub(crate) table: &'static str,
    pub(crate) title: &'static str,
    /// Name of the weather parameter.
    parameter: &'static str,
    /// Names of the bins; the k-th ends before the k-th limit, the last has no end.
    pub(crate) bins: &'static [&'static str],
    limits: &'static [f64],
    note: &'static str,
    /// Scenes of the published dataset, row by row.
    pub(crate) published: &'static [u64],
}

const SHARE_BINS: &[&str] = &["none", "low", "moderate", "heavy"];
const SHARE_LIMITS: &[f64] = &[10.0, 40.0, 70.0];
const SHARE_NOTE: &str = "Percent: none below 10, low from 10, moderate from 40, heavy from 70.";

const fn share(
    table: &'static str,
    title: &'static str,
    parameter: &'static str,
    published: &'static [u64; 16],
) -> WeatherTable {
    WeatherTable {
        table,
        title,
        parameter,
        bins: SHARE_BINS,
        limits: SHARE_LIMITS,
        note: SHARE_NOTE,
        published,
    }
}

pub(crate) const WEATHER_TABLES: [WeatherTable; 4] = [
    share("weather_cloudiness", "Cloud cover", "cloudiness", &Published::CLOUDINESS),
    share("weather_precipitation", "Rain", "precipitation", &Published::PRECIPITATION),
    share("weather_fog_density", "Fog density", "fog_density", &Published::FOG_DENSITY),
    WeatherTable {
        table: "weather_sun_altitude",
        title: "Sun altitude",
        parameter: "sun_altitude_deg",
        bins: &["night", "dawn/dusk", "day"],
        limits: &[0.0, 6.0],
        note: "Degrees: night below 0, dawn or dusk from 0, day from 6.",
        published: &Published::SUN_ALTITUDE,
    },
];

impl WeatherTable {
    fn bin_of(&self, weather: &BTreeMap<String, f64>) -> Option<usize> {
        let value = weather.get(self.parameter).copied().filter(|value| value.is_finite())?;
        Some(self.limits.iter().filter(|limit| value >= **limit).count())
    }
}

/// Scenes by initial and final weather, one row a pair. A scene without final weather keeps its first;
/// one without either is left out.
pub(super) fn transitions(spec: &WeatherTable, scenes: &[&SceneInfo]) -> Table {
    let n = spec.bins.len();
    let mut counts = vec![0_u64; n * n];
    for scene in scenes {
        if let Some(initial) = spec.bin_of(&scene.initial_weather) {
            let last = spec.bin_of(&scene.final_weather).unwrap_or(initial);
            counts[initial * n + last] += 1;
        }
    }
    let total = counts.iter().sum();
    let names = |index: fn(usize, usize) -> usize| (0..n * n).map(move |i| spec.bins[index(i, n)]);
    Table::new(spec.table, Section::Weather, spec.title, spec.note)
        .with_strings("initial", names(|i, n| i / n))
        .with_strings("final", names(|i, n| i % n))
        .with_counts("scenes", counts.iter().copied())
        .with_numbers("fraction", 4, counts.iter().map(|&count| ratio(count, total)))
}
