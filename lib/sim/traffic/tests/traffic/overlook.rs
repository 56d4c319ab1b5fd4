//! Drivers who overlook lights, signs, vehicles and walkers: for a moment, or always.

use crate::common;

use crate::common::{agent, collisions, crossing, red_runs, run, scene, settings, straight, tracks};
use nalgebra::Point3;
use opendrive::Map;
use schema::tables::{PlanAgentRow, PlanSceneRow};
use settings::stages::SimulationSettings;

/// Lights, signs, vehicles, walkers.
fn overlooking([lights, signs, vehicles, walkers]: [f64; 4]) -> SimulationSettings {
    let mut settings = settings();
    settings.traffic.ignore_lights = lights;
    settings.traffic.ignore_signs = signs;
    settings.traffic.ignore_vehicles = vehicles;
    settings.traffic.ignore_walkers = walkers;
    settings.traffic.green_time_s = Some(6.0);
    settings
}

/// Three on each arm of the crossing.
fn queues() -> Vec<PlanAgentRow> {
    let mut agents = Vec::new();
    for (arm, (cos, sin)) in [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)].into_iter().enumerate() {
        for k in 0..3 {
            let d = 50.0 + 25.0 * f64::from(k);
            let at = [d * cos - 1.75 * sin, d * sin + 1.75 * cos, 0.0];
            agents.push(agent(3 * arm + k as usize, at, frames::math::atan2(-sin, -cos)));
        }
    }
    agents
}

fn reds(map: &Map, settings: &SimulationSettings) -> (usize, usize) {
    let log = run(map, &scene(30.0), &queues(), settings);
    (red_runs(map, &log, &common::lights(map)).len(), collisions(&log, false).len())
}

#[test]
fn who_always_overlooks_drives_as_the_reckless_and_the_distracted_do() {
    for (shares, reckless, distracted) in [([1.0; 4], true, false), ([1.0, 1.0, 0.0, 0.0], false, true)] {
        for lights in [true, false] {
            let map = crossing(lights);
            let by_share = run(&map, &scene(30.0), &queues(), &overlooking(shares));
            let mut agents = queues();
            agents.iter_mut().for_each(|a| (a.reckless, a.distracted) = (reckless, distracted));
            let by_driver = run(&map, &scene(30.0), &agents, &overlooking([0.0; 4]));
            assert!(by_share.states == by_driver.states, "{shares:?} {lights}");
            let careful = run(&map, &scene(30.0), &queues(), &overlooking([0.0; 4]));
            // There are no signs to overlook where there are no lights.
            assert_eq!(by_share.states != careful.states, reckless || lights);
        }
    }
}

#[test]
fn who_overlooks_all_lights_runs_red_ones_and_hits_nobody() {
    let map = crossing(true);
    assert_eq!(reds(&map, &overlooking([0.0; 4])), (0, 0));
    let (runs, hits) = reds(&map, &overlooking([1.0, 0.0, 0.0, 0.0]));
    assert!(runs > 0 && hits == 0, "{runs} {hits}");
    // Signs are not what holds them up here.
    assert_eq!(reds(&map, &overlooking([0.0, 1.0, 0.0, 0.0])), (0, 0));
    // Looking away for most of the time lets some of them through, looking away for moments nobody.
    let (runs, hits) = reds(&map, &overlooking([0.97, 0.0, 0.0, 0.0]));
    assert!(runs > 0 && hits == 0, "{runs} {hits}");
    assert_eq!(reds(&map, &overlooking([0.3, 0.3, 0.3, 0.3])), (0, 0));
}

#[test]
fn who_overlooks_all_vehicles_runs_into_them_and_stops_at_lights() {
    let map = straight(600.0);
    let mut agents = vec![agent(0, [60.0, -1.75, 0.0], 0.0), agent(1, [20.0, -1.75, 0.0], 0.0)];
    agents[0].speed_difference = 0.9;
    for (share, hits) in [(0.0, false), (0.3, false), (1.0, true)] {
        let log = run(&map, &scene(20.0), &agents, &overlooking([0.0, 0.0, share, 0.0]));
        assert_eq!(!collisions(&log, false).is_empty(), hits, "{share}");
    }
    let (runs, hits) = reds(&crossing(true), &overlooking([0.0, 0.0, 1.0, 0.0]));
    assert!(runs == 0 && hits > 0, "{runs} {hits}");
}

#[test]
fn who_overlooks_all_walkers_runs_into_them() {
    let map = straight(400.0);
    let hits = |share: f64| {
        let hits = (0..6).map(|seed| {
            let plan = PlanSceneRow {
                walkers: 120,
                background_vehicles: Some(20),
                walker_cross_factor: 1.0,
                seed,
                ..scene(30.0)
            };
            let agents = [agent(0, [20.0, -1.75, 0.0], 0.0)];
            collisions(&run(&map, &plan, &agents, &overlooking([0.0, 0.0, 0.0, share])), true).len()
        });
        hits.sum::<usize>()
    };
    assert_eq!((hits(0.0), hits(0.001)), (0, 0));
    assert!(hits(1.0) > 0);
}

#[test]
fn a_moment_of_inattention_is_hardly_seen() {
    // Eight in a row behind a slow one.
    let map = straight(900.0);
    let mut agents: Vec<_> = (0..8).map(|k| agent(k, [200.0 - 20.0 * k as f64, -1.75, 0.0], 0.0)).collect();
    agents[0].speed_difference = 0.5;
    let [careful, usual] =
        [[0.0; 4], [0.001; 4]].map(|shares| run(&map, &scene(40.0), &agents, &overlooking(shares)));
    assert_eq!(collisions(&usual, false), []);
    let [before, after] = [tracks(&careful), tracks(&usual)];
    let mut farthest: f64 = 0.0;
    for (id, track) in &after {
        for (i, state) in track.iter().enumerate() {
            let off = (Point3::from(state.xyz_m) - Point3::from(before[id][i].xyz_m)).norm();
            assert!(off < 2.0, "{off} at {i}");
            farthest = farthest.max(off);
            let gained = f64::from(state.velocity_mps[0] - track[i.saturating_sub(1)].velocity_mps[0]) / 0.05;
            assert!((-3.0..3.0).contains(&gained), "{gained} at {i}");
        }
    }
    // Eight drivers overlook the one ahead some six times in the 40 s.
    assert!(farthest > 1e-4, "{farthest}");
}
