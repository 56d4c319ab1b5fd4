//! Shares and means over thousands of planned scenes against the published figures.

use std::collections::BTreeMap;

use opendrive::{Cubic, Geometry, Lane, LaneSection, LaneType, Map, Network, Road};
use plan::{Plan, PlanMap, plan};
use schema::settings::{DatasetSettings, SceneCount, SpawnMode, Split};
use schema::tables::{PlanSceneRow, Weather};

/// Four standard errors of a share of one half are 0.9 points.
const SCENES: u32 = 50_000;

/// A short street, so that planning is fast; weather and durations do not depend on it.
fn planned(scenes: u32, change: impl FnOnce(&mut DatasetSettings)) -> Plan {
    let lane =
        |id| Lane { id, lane_type: LaneType::Driving, widths: vec![Cubic::constant(3.5)], ..Lane::default() };
    let length_m = 200.0;
    let road = Road {
        id: "1".into(),
        length_m,
        plan_view: vec![Geometry { length_m, ..Geometry::default() }],
        sections: vec![LaneSection { left: vec![lane(1)], right: vec![lane(-1)], ..LaneSection::default() }],
        ..Road::default()
    };
    let map = Map::new(Network { roads: vec![road], ..Network::default() });
    let maps = BTreeMap::from([("road".to_owned(), PlanMap { map, hash: String::new() })]);
    let wish = SceneCount { split: Split::Train, map: "road".into(), count: scenes };
    let mut settings = DatasetSettings::with_scenes(vec![wish]);
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
    let ends: [fn(&PlanSceneRow) -> Weather; 2] =
        [|s| Weather::from_array(s.initial_weather), |s| Weather::from_array(s.final_weather)];
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
        let at = |pick: fn(&PlanSceneRow) -> [f64; 14]| -> Vec<f64> {
            plan.scenes.iter().map(|s| pick(s)[k]).collect()
        };
        let both = correlation(&at(|s| s.initial_weather), &at(|s| s.final_weather));
        assert!(both.abs() < 0.03, "{}: {both}", Weather::NAMES[k]);
    }
}

#[test]
fn durations_follow_their_rule_and_radii_the_durations() {
    let plan = planned(24_000, |_| {});
    let of = |d: f64| plan.scenes.iter().filter(|s| s.duration_s == d).count() as f64;
    // 24,000 draws over 24 s: 1000 for whole seconds inside, half of it at the two ends; four standard errors.
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
