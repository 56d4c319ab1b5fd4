//! Random weather.

use random::Stream;
use schema::tables::Weather;
use settings::{WeatherSettings, WeatherValue};

/// Values up to this count as none, percent.
const FAINT: f64 = 10.0;
/// Rain and, by day, fog need more clouds than this, percent.
const CLOUDY: f64 = 40.0;
/// Below this sun altitude fog comes without clouds, too, degrees.
const LOW_SUN_DEG: f64 = 10.0;
/// On high ground, fog that thins with the absolute height would be gone: its falloff is divided by this.
const HIGH_GROUND_FALLOFF: f64 = 20.0;

/// One weather. `high_ground`: the map lies high above its zero level.
///
/// Clouds come first: rain needs them, and so does fog unless the sun is low. Puddles and wetness follow the
/// rain; wind and sun are independent.
pub fn draw_weather(stream: &mut Stream, high_ground: bool) -> Weather {
    let notable = |value: f64| if value <= FAINT { 0.0 } else { value };
    let cloudiness = notable(100.0 * stream.beta(0.8, 1.0));
    let precipitation = if cloudiness > CLOUDY { notable(cloudiness * stream.beta(0.8, 0.2)) } else { 0.0 };
    let precipitation_deposits = precipitation + stream.beta(1.2, 1.6) * (100.0 - precipitation);
    let wind_intensity = stream.uniform(0.0, 100.0);
    let sun_azimuth_deg = stream.uniform(0.0, 360.0);
    let sun_altitude_deg = 180.0 * stream.beta(3.2, 2.2) - 90.0;
    let wetness = stream.normal(precipitation, 10.0).clamp(0.0, 100.0);
    let may_be_foggy = cloudiness > CLOUDY || sun_altitude_deg < LOW_SUN_DEG;
    let fog_density = if may_be_foggy { notable(100.0 * stream.beta(0.6, 1.2)) } else { 0.0 };
    let foggy = fog_density > FAINT;
    let fog_distance_m = if foggy { stream.log_normal(3.2, 0.8) } else { 100.0 };
    let mut fog_falloff = if foggy { 5.0 * stream.beta(1.2, 2.4) } else { 1.0 };
    if foggy && high_ground {
        fog_falloff /= HIGH_GROUND_FALLOFF;
    }
    Weather {
        cloudiness,
        precipitation,
        precipitation_deposits,
        wind_intensity,
        sun_azimuth_deg,
        sun_altitude_deg,
        wetness,
        fog_density,
        fog_distance_m,
        fog_falloff,
        ..Weather::default()
    }
}

/// The weather of a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct PlannedWeather {
    /// Before frame 0.
    pub initial: Weather,
    /// Of the last frame.
    pub last: Weather,
    /// Between them: seconds after the first one, ascending, and the weather then.
    pub between: Vec<(f64, Weather)>,
    /// Whether it moves.
    pub is_dynamic: bool,
}

impl PlannedWeather {
    /// Whether the sun is down at any time: it moves evenly between these moments.
    pub(crate) fn is_ever_dark(&self) -> bool {
        let between = self.between.iter().map(|(_, weather)| weather);
        between.chain([&self.initial, &self.last]).any(Weather::is_night)
    }
}

/// Weather of a scene, with the configured values in place of drawn ones. Couplings between parameters are
/// not applied again after that. Without dynamic weather only what keyframes say moves.
#[must_use]
pub fn plan_weather(
    settings: &WeatherSettings,
    seed: u64,
    scene: u32,
    duration_s: f64,
    high_ground: bool,
) -> PlannedWeather {
    let stream = |topic: &str, entity| Stream::new(seed, u64::from(scene), topic, entity);
    let draw = |topic| draw_weather(&mut stream(topic, 0), high_ground);
    // Each drawn value has a stream of its own, a keyframe's by its time: what is added moves no other.
    let resolved = |place: &str, entity: u64, values: &[(String, WeatherValue)]| -> Vec<(String, f64)> {
        let value = |(name, value): &(String, WeatherValue)| {
            let value = match *value {
                WeatherValue::Fixed(value) => value,
                WeatherValue::Between([least, most]) => {
                    stream(&format!("plan/weather/{place}/{name}"), entity).uniform(least, most)
                }
            };
            (name.clone(), value)
        };
        values.iter().map(value).collect()
    };
    let first = resolved("initial", 0, &settings.initial);
    let initial = draw("plan/weather/initial").with_overrides(&first);
    let (last, ends) = if settings.dynamic {
        let ends = resolved("final", 0, &settings.r#final);
        (draw("plan/weather/final").with_overrides(&ends), ends)
    } else {
        (initial, Vec::new())
    };
    if settings.keyframes.is_empty() {
        return PlannedWeather { initial, last, between: Vec::new(), is_dynamic: settings.dynamic };
    }
    let keyframes: Vec<(f64, Vec<(String, f64)>)> = settings
        .keyframes
        .iter()
        .map(|k| (k.at_s, resolved("keyframe", (1000.0 * k.at_s).round() as u64, &k.values)))
        .collect();
    let fixed = Fixed { initial: (initial, &first), last: (last, &ends), keyframes: &keyframes, duration_s };
    let inner = keyframes.iter().map(|(at_s, _)| *at_s).filter(|at_s| 0.0 < *at_s && *at_s < duration_s);
    PlannedWeather {
        initial: fixed.at(0.0),
        last: fixed.at(duration_s),
        between: inner.map(|at_s| (at_s, fixed.at(at_s))).collect(),
        is_dynamic: true,
    }
}

/// The weather of a scene with keyframes.
struct Fixed<'a> {
    /// At the beginning and at the end: as drawn, and what of it the settings say.
    initial: (Weather, &'a [(String, f64)]),
    last: (Weather, &'a [(String, f64)]),
    keyframes: &'a [(f64, Vec<(String, f64)>)],
    duration_s: f64,
}

impl Fixed<'_> {
    /// The weather at a time, each parameter by itself.
    fn at(&self, at_s: f64) -> Weather {
        let of = |name: &str| {
            let value = |values: &[(String, f64)]| {
                values.iter().find(|(other, _)| other == name).map(|(_, value)| *value)
            };
            let mut moments: Vec<(f64, f64)> =
                self.keyframes.iter().filter_map(|(at_s, values)| Some((*at_s, value(values)?))).collect();
            if moments.is_empty() {
                return None;
            }
            if let Some(value) = value(self.initial.1) {
                moments.insert(0, (0.0, value));
            }
            if let Some(value) = value(self.last.1) {
                // What comes later is past the end.
                moments.retain(|(at_s, _)| *at_s < self.duration_s);
                moments.push((self.duration_s, value));
            }
            Some(along(&moments, at_s))
        };
        let drawn = self.initial.0.mix(&self.last.0, at_s / self.duration_s);
        let said = Weather::NAMES.iter().filter_map(|name| Some(((*name).to_owned(), of(name)?)));
        drawn.with_overrides(&said.collect::<Vec<_>>())
    }
}

/// The value at a time on straight lines from moment to moment; before the first and after the last it stays.
fn along(moments: &[(f64, f64)], at_s: f64) -> f64 {
    let leg = moments.windows(2).find(|leg| leg[0].0 <= at_s && at_s <= leg[1].0);
    match (leg, moments.first(), moments.last()) {
        (Some(leg), ..) => {
            let ((from_s, from), (to_s, to)) = (leg[0], leg[1]);
            if to_s > from_s { from + (to - from) * (at_s - from_s) / (to_s - from_s) } else { to }
        }
        (None, Some((first_s, value)), _) if at_s < *first_s => *value,
        (None, _, last) => last.map_or(0.0, |(_, value)| *value),
    }
}

#[cfg(test)]
mod tests {
    use settings::WeatherKeyframe;

    use super::*;

    const DRAWS: u64 = 20_000;

    fn draws() -> Vec<Weather> {
        (0..DRAWS).map(|i| draw_weather(&mut Stream::new(27, i, "test/weather", 0), false)).collect()
    }

    /// Percent of the draws for which a condition holds.
    fn share(draws: &[Weather], holds: impl Fn(&Weather) -> bool) -> f64 {
        100.0 * draws.iter().filter(|w| holds(w)).count() as f64 / draws.len() as f64
    }

    #[test]
    fn shares_are_the_published_check_values() {
        let draws = draws();
        let bins = |value: fn(&Weather) -> f64, edges: [f64; 5], expected: [f64; 4]| {
            for (i, want) in expected.iter().enumerate() {
                let got = share(&draws, |w| (edges[i]..edges[i + 1]).contains(&value(w)));
                // Four standard errors of a share of 50 % over 20,000 draws are 1.4.
                assert!((got - want).abs() < 1.4, "bin {i}: {got} instead of {want}");
            }
        };
        let edges = [0.0, 10.0, 40.0, 70.0, 100.1];
        bins(|w| w.cloudiness, edges, [15.9, 32.2, 27.1, 24.8]);
        bins(|w| w.precipitation, edges, [51.1, 9.4, 23.8, 15.7]);
        bins(|w| w.fog_density, edges, [48.5, 25.1, 16.0, 10.4]);
        for (low, high, want) in [(-91.0, 0.0, 32.0), (0.0, 6.0, 5.5), (6.0, 91.0, 62.5)] {
            let got = share(&draws, |w| (low..high).contains(&w.sun_altitude_deg));
            assert!((got - want).abs() < 1.4, "sun {low}..{high}: {got} instead of {want}");
        }
        assert!((share(&draws, |w| w.wetness == 0.0) - 26.0).abs() < 1.4);
    }

    #[test]
    fn couplings_and_ranges_hold() {
        for w in draws() {
            assert!(w.precipitation <= w.cloudiness && w.precipitation_deposits >= w.precipitation);
            assert!(w.precipitation == 0.0 || w.cloudiness > 40.0);
            assert!(w.fog_density == 0.0 || w.cloudiness > 40.0 || w.sun_altitude_deg < 10.0);
            assert_eq!(w.fog_density == 0.0, w.fog_distance_m == 100.0);
            for percent in [
                w.cloudiness,
                w.precipitation,
                w.precipitation_deposits,
                w.wind_intensity,
                w.wetness,
                w.fog_density,
            ] {
                assert!((0.0..=100.0).contains(&percent));
            }
            assert!(
                (-90.0..=90.0).contains(&w.sun_altitude_deg)
                    && (0.0..5.0).contains(&w.fog_falloff.min(4.999))
            );
        }
    }

    #[test]
    fn moments_of_deposits_and_fog_distance() {
        let draws = draws();
        let mean = |values: Vec<f64>| values.iter().sum::<f64>() / values.len() as f64;
        let dry =
            mean(draws.iter().filter(|w| w.precipitation == 0.0).map(|w| w.precipitation_deposits).collect());
        assert!((dry - 43.0).abs() < 1.0, "{dry}");
        assert!((mean(draws.iter().map(|w| w.precipitation_deposits).collect()) - 59.0).abs() < 1.0);
        assert!((mean(draws.iter().map(|w| w.sun_altitude_deg).collect()) - 16.7).abs() < 1.0);
        let mut distances: Vec<f64> =
            draws.iter().filter(|w| w.fog_density > 0.0).map(|w| w.fog_distance_m).collect();
        distances.sort_by(f64::total_cmp);
        let median = distances[distances.len() / 2];
        assert!((median - 24.5).abs() < 1.0, "{median}");
    }

    fn fixed(name: &str, value: f64) -> (String, WeatherValue) {
        (name.to_owned(), value.into())
    }

    fn plan(settings: &WeatherSettings, scene: u32) -> PlannedWeather {
        plan_weather(settings, 27, scene, 10.0, false)
    }

    #[test]
    fn overrides_replace_values_and_nothing_else() {
        let drawn = plan(&WeatherSettings::default(), 3);
        let settings = WeatherSettings {
            initial: vec![fixed("cloudiness", 5.0)],
            r#final: vec![fixed("sun_altitude_deg", -20.0)],
            ..WeatherSettings::default()
        };
        let planned = plan(&settings, 3);
        assert_eq!(planned.initial, Weather { cloudiness: 5.0, ..drawn.initial });
        assert_eq!(planned.last, Weather { sun_altitude_deg: -20.0, ..drawn.last });
        assert!(planned.is_dynamic && planned.between.is_empty());
        let still = plan(&WeatherSettings { dynamic: false, ..settings }, 3);
        assert_eq!((still.initial, still.last, still.is_dynamic), (planned.initial, planned.initial, false));
    }

    #[test]
    fn values_between_two_numbers_are_drawn_scene_by_scene_and_move_nothing() {
        let between = |name: &str, two| (name.to_owned(), WeatherValue::Between(two));
        let settings = WeatherSettings {
            initial: vec![between("precipitation", [20.0, 80.0])],
            r#final: vec![between("precipitation", [20.0, 80.0]), between("wetness", [5.0, 6.0])],
            ..WeatherSettings::default()
        };
        let scenes: Vec<PlannedWeather> = (0..2000).map(|scene| plan(&settings, scene)).collect();
        let rain: Vec<f64> =
            scenes.iter().flat_map(|p| [p.initial.precipitation, p.last.precipitation]).collect();
        assert!(rain.iter().all(|value| (20.0..80.0).contains(value)));
        // Uniform: 60 / sqrt(12) / sqrt(4000) is 0.27.
        assert!((rain.iter().sum::<f64>() / 4000.0 - 50.0).abs() < 1.1);
        // A quarter of them in each quarter, and the two ends know nothing of each other.
        let low = rain.iter().filter(|value| **value < 35.0).count();
        assert!((900..1100).contains(&low), "{low}");
        let both = scenes.iter().filter(|p| p.initial.precipitation < 50.0 && p.last.precipitation < 50.0);
        assert!((430..570).contains(&both.count()));
        for (scene, planned) in (0..).zip(&scenes) {
            let drawn = plan(&WeatherSettings::default(), scene);
            assert!((5.0..6.0).contains(&planned.last.wetness));
            let precipitation = planned.initial.precipitation;
            assert_eq!(planned.initial, Weather { precipitation, ..drawn.initial });
            let Weather { precipitation, wetness, .. } = planned.last;
            assert_eq!(planned.last, Weather { precipitation, wetness, ..drawn.last });
        }
        let fewer = WeatherSettings { r#final: settings.r#final[1..].to_vec(), ..settings };
        let pairs = (0..20).map(|scene| plan(&fewer, scene)).zip(&scenes);
        for (one, other) in pairs {
            assert_eq!((one.initial, one.last.wetness), (other.initial, other.last.wetness));
        }
    }

    #[test]
    fn keyframes_say_what_they_have_and_nothing_else() {
        let keyframe =
            |at_s, values: &[(String, WeatherValue)]| WeatherKeyframe { at_s, values: values.to_vec() };
        let (cloudy, rain) = (|value| fixed("cloudiness", value), |value| fixed("precipitation", value));
        let mut settings = WeatherSettings {
            keyframes: vec![
                keyframe(2.0, &[cloudy(80.0)]),
                keyframe(4.0, &[rain(60.0)]),
                keyframe(6.0, &[cloudy(40.0), rain(0.0)]),
                keyframe(12.0, &[rain(30.0)]),
            ],
            ..WeatherSettings::default()
        };
        let drawn = plan(&WeatherSettings::default(), 5);
        let at = |planned: &PlannedWeather, at_s: f64| {
            let moments = [(0.0, planned.initial), (10.0, planned.last)];
            let all: Vec<_> = planned.between.iter().copied().chain(moments).collect();
            all.into_iter().find(|(moment, _)| *moment == at_s).expect("is a moment").1
        };
        let planned = plan(&settings, 5);
        assert_eq!(planned.between.iter().map(|(at_s, _)| *at_s).collect::<Vec<_>>(), [2.0, 4.0, 6.0]);
        // At 0, 2, 4, 6 and 10 s: clouds stay before 2 s and after 6 s, the rain grows until 12 s.
        let moments = [0.0, 2.0, 4.0, 6.0, 10.0];
        let course =
            |planned: &PlannedWeather, of: fn(&Weather) -> f64| moments.map(|at_s| of(&at(planned, at_s)));
        assert_eq!(course(&planned, |w| w.cloudiness), [80.0, 80.0, 60.0, 40.0, 40.0]);
        assert_eq!(course(&planned, |w| w.precipitation), [60.0, 60.0, 60.0, 0.0, 20.0]);
        for at_s in moments {
            let want = drawn.initial.mix(&drawn.last, at_s / 10.0);
            let Weather { cloudiness, precipitation, .. } = at(&planned, at_s);
            assert_eq!(at(&planned, at_s), Weather { cloudiness, precipitation, ..want }, "{at_s} s");
        }
        // The two ends have a say where they say something.
        settings.initial = vec![cloudy(0.0)];
        settings.r#final = vec![rain(100.0)];
        let ended = plan(&settings, 5);
        assert_eq!(course(&ended, |w| w.cloudiness), [0.0, 80.0, 60.0, 40.0, 40.0]);
        assert_eq!(course(&ended, |w| w.precipitation), [60.0, 60.0, 60.0, 0.0, 100.0]);
        // What stands still but for keyframes.
        let still = plan(&WeatherSettings { dynamic: false, ..settings.clone() }, 5);
        assert!(still.is_dynamic && still.last.wetness == still.initial.wetness);
        assert_eq!(course(&still, |w| w.precipitation), course(&planned, |w| w.precipitation));
        // A night between two days.
        settings.keyframes = vec![
            keyframe(0.0, &[fixed("sun_altitude_deg", 9.0)]),
            keyframe(5.0, &[fixed("sun_altitude_deg", -9.0)]),
        ];
        settings.keyframes.push(keyframe(10.0, &[fixed("sun_altitude_deg", 9.0)]));
        let night = plan(&settings, 5);
        assert!(night.is_ever_dark() && !night.initial.is_night() && !night.last.is_night());
    }

    #[test]
    fn high_ground_only_lowers_the_falloff_of_fog() {
        for i in 0..200 {
            let draw = |high| draw_weather(&mut Stream::new(27, i, "test/weather", 0), high);
            let (low, high) = (draw(false), draw(true));
            let expected = if low.fog_density > 0.0 { low.fog_falloff / 20.0 } else { 1.0 };
            assert_eq!(high, Weather { fog_falloff: expected, ..low });
        }
    }
}
