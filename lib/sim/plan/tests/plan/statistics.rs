//! Shares and means over thousands of planned scenes against the published figures.

use std::collections::BTreeMap;

use nalgebra::Point3;
use opendrive::LaneType;
use plan::{Plan, PlanMap, plan};
use schema::tables::{PlanSceneRow, Weather};
use settings::stages::PlanSettings;
use settings::{SceneCount, SpawnMode, Split};
use testkit::both_ways;

/// Four standard errors of a share of one half are 0.9 points.
const SCENES: u32 = 50_000;

/// A short street, so that planning is fast; weather and durations do not depend on it.
fn planned(scenes: u32, change: impl FnOnce(&mut PlanSettings)) -> Plan {
    planned_on(200.0, scenes, change)
}

fn planned_on(length_m: f64, scenes: u32, change: impl FnOnce(&mut PlanSettings)) -> Plan {
    let lanes = both_ways(&[(LaneType::Driving, 3.5)]);
    let map = testkit::map(vec![testkit::road("1", [0.0; 2], 0.0, length_m, lanes)]);
    let maps = BTreeMap::from([("road".to_owned(), PlanMap { map, hash: String::new() })]);
    let wish = SceneCount { split: Split::Train, map: "road".into(), count: scenes };
    let mut settings = PlanSettings::with_scenes(vec![wish]);
    change(&mut settings);
    plan(&settings, &maps).expect("a plan")
}

fn share(values: &[f64], holds: impl Fn(f64) -> bool) -> f64 {
    100.0 * values.iter().filter(|v| holds(**v)).count() as f64 / values.len() as f64
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Correlation after Pearson.
fn correlation(a: &[f64], b: &[f64]) -> f64 {
    let (mean_a, mean_b) = (mean(a), mean(b));
    let product = |x: &[f64], y: &[f64], mx: f64, my: f64| -> f64 {
        x.iter().zip(y).map(|(x, y)| (x - mx) * (y - my)).sum()
    };
    product(a, b, mean_a, mean_b) / (product(a, a, mean_a, mean_a) * product(b, b, mean_b, mean_b)).sqrt()
}

#[test]
fn weather_has_the_published_shares() {
    let plan = planned(SCENES, |_| {});
    let ends: [fn(&PlanSceneRow) -> Weather; 2] = [|s| s.initial_weather, |s| s.final_weather];
    for end in ends {
        let of = |value: fn(&Weather) -> f64| -> Vec<f64> {
            plan.scenes.iter().map(|scene| value(&end(scene))).collect()
        };
        let bins = |values: &[f64], published: [f64; 4]| {
            for (i, want) in published.into_iter().enumerate() {
                let (low, high) = ([0.0, 10.0, 40.0, 70.0][i], [10.0, 40.0, 70.0, 100.1][i]);
                let got = share(values, |v| (low..high).contains(&v));
                assert!((got - want).abs() < 1.0, "{got} % in {low} to {high}, published {want}");
            }
        };
        let (cloudiness, rain) = (of(|w| w.cloudiness), of(|w| w.precipitation));
        bins(&cloudiness, [15.9, 32.2, 27.1, 24.8]);
        bins(&rain, [51.1, 9.4, 23.8, 15.7]);
        bins(&of(|w| w.fog_density), [48.5, 25.1, 16.0, 10.4]);
        let sun = of(|w| w.sun_altitude_deg);
        for (got, want) in [
            (share(&sun, |a| a < 0.0), 32.0),
            (share(&sun, |a| (0.0..=6.0).contains(&a)), 5.5),
            (share(&sun, |a| a > 6.0), 62.5),
            (share(&of(|w| w.wetness), |v| v == 0.0), 26.0),
        ] {
            assert!((got - want).abs() < 1.0, "{got} %, published {want}");
        }
        let spread = mean(&sun.iter().map(|a| (a - 16.7) * (a - 16.7)).collect::<Vec<_>>()).sqrt();
        assert!((mean(&sun) - 16.7).abs() < 0.7 && (spread - 34.9).abs() < 0.7, "{} {spread}", mean(&sun));
        // Clouds couple rain and fog; wind, sun and azimuth go their own ways.
        let free = [of(|w| w.wind_intensity), of(|w| w.sun_azimuth_deg), sun];
        for (i, a) in free.iter().enumerate() {
            for b in free[i + 1..].iter().chain([&cloudiness, &rain]) {
                assert!(correlation(a, b).abs() < 0.02);
            }
        }
        assert!(correlation(&cloudiness, &rain) > 0.5);
    }
    // The final weather is a draw of its own.
    for k in 0..10 {
        let at = |pick: fn(&PlanSceneRow) -> Weather| -> Vec<f64> {
            plan.scenes.iter().map(|s| pick(s).to_array()[k]).collect()
        };
        let both = correlation(&at(|s| s.initial_weather), &at(|s| s.final_weather));
        assert!(both.abs() < 0.03, "{}: {both}", Weather::NAMES[k]);
    }
}

#[test]
fn durations_follow_their_rule_and_radii_the_durations() {
    let plan = planned(24_000, |_| {});
    let of = |d: f64| plan.scenes.iter().filter(|s| s.duration_s == d).count() as f64;
    // 24,000 draws over 24 s: 1000 for whole seconds inside, half of it at the two ends; four standard
    // errors.
    assert!((8..=32).map(|d| of(f64::from(d))).sum::<f64>() == 24_000.0);
    assert!((of(8.0) - 500.0).abs() < 90.0 && (of(32.0) - 500.0).abs() < 90.0);
    assert!((9..32).all(|d| (of(f64::from(d)) - 1000.0).abs() < 126.0));
    for scene in &plan.scenes {
        let rate = if scene.duration_s <= 12.0 {
            30.0
        } else if scene.duration_s <= 16.0 {
            25.0
        } else {
            20.0
        };
        assert_eq!(scene.spawn_radius_m, rate * (scene.duration_s + 2.0));
        assert_eq!(f64::from(scene.frames), 20.0 * scene.duration_s);
    }
}

#[test]
fn walkers_vehicles_and_modes_cover_their_ranges_evenly() {
    let plan = planned(20_000, |s| {
        (s.agents.min_vehicles, s.agents.max_vehicles) = (1, 4);
        s.agents.chained_spawn_distance_m = 500.0;
        s.agents.clustered_spawn_distance_m = 500.0;
    });
    let mut counts: BTreeMap<u32, u32> = BTreeMap::new();
    for agent in &plan.agents {
        *counts.entry(agent.scene).or_default() += 1;
    }
    for n in 1..=4 {
        let of = counts.values().filter(|c| **c == n).count();
        assert!((4755..=5245).contains(&of), "{of} scenes of 20,000 with {n} of 1 to 4 vehicles");
    }
    let walkers: Vec<f64> = plan.scenes.iter().map(|s| f64::from(s.walkers)).collect();
    // Of 0 to 480 the mean is 240, the standard deviation 138.9.
    assert!((mean(&walkers) - 240.0).abs() < 4.0 && walkers.iter().all(|w| *w <= 480.0));
    let clustered = plan.scenes.iter().filter(|s| s.spawn_mode == SpawnMode::Clustered.name()).count();
    assert!((9715..=10_285).contains(&clustered), "{clustered}");
    let factors: Vec<f64> = plan.scenes.iter().map(|s| s.walker_cross_factor).collect();
    // Beta(2.4, 1.6): mean 0.6, variance 0.048.
    let variance = mean(&factors.iter().map(|f| (f - 0.6) * (f - 0.6)).collect::<Vec<_>>());
    assert!((mean(&factors) - 0.6).abs() < 0.007 && (variance - 0.048).abs() < 0.002);
}

#[test]
fn rain_wind_and_fog_follow_their_rules() {
    let plan = planned(SCENES, |_| {});
    let ends: [fn(&PlanSceneRow) -> Weather; 2] = [|s| s.initial_weather, |s| s.final_weather];
    for end in ends {
        let draws: Vec<Weather> = plan.scenes.iter().map(end).collect();
        let of = |holds: fn(&Weather) -> bool, value: fn(&Weather) -> f64| -> Vec<f64> {
            draws.iter().filter(|w| holds(w)).map(value).collect()
        };
        let all: fn(&Weather) -> bool = |_| true;
        let foggy: fn(&Weather) -> bool = |w| w.fog_density > 0.0;
        // Puddles: 43 on the average without rain, 59 in all, never fewer than rain, practically never none.
        let dry = of(|w| w.precipitation == 0.0, |w| w.precipitation_deposits);
        let deposits = of(all, |w| w.precipitation_deposits);
        assert!((mean(&dry) - 43.0).abs() < 0.7 && (mean(&deposits) - 59.0).abs() < 0.7, "{}", mean(&dry));
        assert!(draws.iter().all(|w| w.precipitation <= w.precipitation_deposits));
        assert!(share(&deposits, |d| d < 0.01) < 0.05);
        // Rain and fog begin above 10 %, rain under clouds of more than 40 %, and there is no more rain than
        // clouds.
        for w in &draws {
            assert!(w.precipitation == 0.0 || (w.precipitation > 10.0 && w.cloudiness > 40.0));
            assert!(w.precipitation <= w.cloudiness && (w.cloudiness == 0.0 || w.cloudiness > 10.0));
            assert!(w.fog_density == 0.0 || w.cloudiness > 40.0 || w.sun_altitude_deg < 10.0);
        }
        // Even distributions: mean and standard deviation (a twelfth of the square of the range).
        for (values, range) in
            [(of(all, |w| w.wind_intensity), 100.0), (of(all, |w| w.sun_azimuth_deg), 360.0)]
        {
            let middle = mean(&values);
            let spread = mean(&values.iter().map(|v| (v - middle) * (v - middle)).collect::<Vec<_>>()).sqrt();
            assert!(
                (middle / range - 0.5).abs() < 0.006 && (spread / range - 12f64.sqrt().recip()).abs() < 0.004
            );
            assert!(values.iter().all(|v| (0.0..=range).contains(v)));
        }
        // What is wet: rain and a normal deviate of 10; where neither end is near, as it is.
        let off = of(|w| (40.0..60.0).contains(&w.precipitation), |w| w.wetness - w.precipitation);
        let spread = mean(&off.iter().map(|v| v * v).collect::<Vec<_>>()).sqrt();
        assert!(mean(&off).abs() < 0.6 && (spread - 10.0).abs() < 0.4, "{} {spread}", mean(&off));
        // Fog begins at a log-normal distance: median 24.5 m, 5 % and 95 % at 6.6 and 91 m; without fog at
        // 100 m.
        let distances = of(foggy, |w| w.fog_distance_m);
        for (below, want) in [(6.6, 5.0), (24.5, 50.0), (91.0, 95.0)] {
            let got = share(&distances, |d| d < below);
            assert!((got - want).abs() < 1.3, "{got} % of fog begins within {below} m, published {want}");
        }
        // Five times Beta(1.2, 2.4): mean a third of 5, variance 25 x 2.88 / (12.96 x 4.6).
        let falloff = of(foggy, |w| w.fog_falloff);
        let spread = mean(&falloff.iter().map(|v| (v - 5.0 / 3.0) * (v - 5.0 / 3.0)).collect::<Vec<_>>());
        assert!((mean(&falloff) - 5.0 / 3.0).abs() < 0.03 && (spread - 1.208).abs() < 0.05, "{spread}");
        let clear = draws.iter().filter(|w| w.fog_density == 0.0);
        assert!(
            clear.clone().all(|w| w.fog_distance_m == 100.0 && w.fog_falloff == 1.0) && clear.count() > 1000
        );
    }
}

#[test]
fn clusters_fill_their_radius_and_chains_reach_from_one_to_the_next() {
    // Points every 24 m, each way beside each other.
    let scenes = 1500;
    for (count, radius_m) in
        [(1, 48.0), (2, 48.0), (3, 55.4), (4, 67.9), (5, 81.7), (6, 96.0), (7, 110.6), (8, 125.4)]
    {
        for mode in [SpawnMode::Clustered, SpawnMode::Chained] {
            let plan = planned_on(1992.0, scenes, |s| {
                (s.agents.min_vehicles, s.agents.max_vehicles, s.agents.max_rsus) = (count, count, 0);
                s.agents.spawn_mode = mode;
                s.hazards.share = 0.0;
            });
            let mut farthest = 0.0_f64;
            for (scene, vehicles) in plan.scenes.iter().zip(plan.agents.chunk_by(|a, b| a.scene == b.scene)) {
                let at: Vec<Point3<f64>> = vehicles.iter().map(|v| v.xyz_m.into()).collect();
                assert!(at.len() <= count as usize && scene.scene == vehicles[0].scene);
                if mode == SpawnMode::Clustered {
                    let pivot = Point3::from(scene.pivot_xyz_m);
                    farthest = at.iter().map(|p| (p - pivot).norm()).fold(farthest, f64::max);
                } else {
                    for (i, p) in at.iter().enumerate().skip(1) {
                        let near = at[..i].iter().map(|q| (p - q).norm()).fold(f64::INFINITY, f64::min);
                        assert!(near <= 64.0);
                        farthest = farthest.max(near);
                    }
                }
            }
            // The farthest of the places, straight on or on the other lane, that the rule allows.
            let reach = if mode == SpawnMode::Clustered { radius_m + 0.05 } else { 64.0 };
            let places = (0..10).flat_map(|k| [0.0, 3.5].map(|y| (576.0 * f64::from(k * k) + y * y).sqrt()));
            let want = places.filter(|d| *d <= reach).fold(0.0, f64::max);
            if count > 1 || mode == SpawnMode::Clustered {
                assert!((farthest - want).abs() < 0.6, "{count} {mode:?}: {farthest}, not {want}");
            }
        }
    }
}
