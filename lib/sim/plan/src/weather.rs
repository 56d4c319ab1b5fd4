//! Random weather.

use random::Stream;
use schema::tables::Weather;
use settings::WeatherSettings;

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

/// Initial and final weather of a scene, with the configured values in place of drawn ones. Couplings between
/// parameters are not applied again after that. Without dynamic weather the two are equal.
#[must_use]
pub fn plan_weather(settings: &WeatherSettings, seed: u64, scene: u32, high_ground: bool) -> [Weather; 2] {
    let draw = |topic| draw_weather(&mut Stream::new(seed, u64::from(scene), topic, 0), high_ground);
    let initial = draw("plan/weather/initial").with_overrides(&settings.initial);
    if !settings.dynamic {
        return [initial, initial];
    }
    [initial, draw("plan/weather/final").with_overrides(&settings.r#final)]
}

#[cfg(test)]
mod tests {
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

    #[test]
    fn overrides_replace_values_and_nothing_else() {
        let drawn = plan_weather(&WeatherSettings::default(), 27, 3, false);
        let settings = WeatherSettings {
            dynamic: true,
            initial: vec![("cloudiness".into(), 5.0)],
            r#final: vec![("sun_altitude_deg".into(), -20.0)],
        };
        let [initial, last] = plan_weather(&settings, 27, 3, false);
        assert_eq!(initial, Weather { cloudiness: 5.0, ..drawn[0] });
        assert_eq!(last, Weather { sun_altitude_deg: -20.0, ..drawn[1] });
        let still = plan_weather(&WeatherSettings { dynamic: false, ..settings }, 27, 3, false);
        assert_eq!(still, [initial, initial]);
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
