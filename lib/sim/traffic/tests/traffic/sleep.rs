//! Actors far from every agent stand still, and wake when one comes.

use crate::common::{agent, agents_on, collisions, crossing, run, scene, settings, straight, tracks, yaw};
use nalgebra::Point3;
use opendrive::Map;
use schema::tables::{PlanSceneRow, StateRow};
use schema::{ActorKind, ActorRole};
use settings::stages::SimulationSettings;
use traffic::SimulationLog;

fn awake_within(distance_m: f64) -> SimulationSettings {
    let mut settings = settings();
    settings.traffic.active_distance_m = distance_m;
    settings
}

/// Two and a half kilometres of road with traffic and walkers all along it.
fn long_road() -> PlanSceneRow {
    PlanSceneRow { spawn_radius_m: 4000.0, background_vehicles: Some(60), walkers: 200, ..scene(40.0) }
}

/// Positions of the agents, frame by frame.
fn agents_of(log: &SimulationLog) -> Vec<Vec<Point3<f64>>> {
    let tracks = tracks(log);
    let agents = log.actors.iter().filter(|a| a.role.agent().is_some());
    agents.map(|a| tracks[&a.id].iter().map(|s| Point3::from(s.xyz_m)).collect()).collect()
}

/// Distances of an object from the nearest of the agents, frame by frame.
fn distances(agents: &[Vec<Point3<f64>>], track: &[&StateRow]) -> Vec<f64> {
    let to = |i: usize, at: [f64; 3]| {
        agents.iter().map(|t| (t[i] - Point3::from(at)).norm()).fold(f64::INFINITY, f64::min)
    };
    track.iter().enumerate().map(|(i, s)| to(i, s.xyz_m)).collect()
}

fn speed(state: &StateRow) -> f64 {
    state.velocity_mps.iter().map(|v| f64::from(v * v)).sum::<f64>().sqrt()
}

#[test]
fn who_is_far_stands_still_until_an_agent_comes() {
    const AWAKE_M: f64 = 300.0;
    let map = straight(2500.0);
    let agents = [agent(0, [900.0, -1.75, 0.0], 0.0)];
    let log = run(&map, &long_road(), &agents, &awake_within(AWAKE_M));
    assert_eq!(collisions(&log, false), []);
    assert_eq!(collisions(&log, true), []);
    let watched = agents_of(&log);
    // Stood all the time, near all the time and moved, woke up, fell asleep: vehicles, walkers.
    let mut found = [[0; 4]; 2];
    for (id, track) in &tracks(&log) {
        let actor = log.actors.iter().find(|a| a.id == *id).expect("an actor");
        let found = &mut found[usize::from(actor.kind == ActorKind::Walker)];
        if actor.role != ActorRole::Background && actor.kind != ActorKind::Walker {
            assert!(distances(&watched, track).iter().all(|d| *d == 0.0) && speed(track[800]) > 5.0);
            continue;
        }
        let (away, moves) = (distances(&watched, track), |i: usize| speed(track[i]) > 0.0);
        let still = |range: std::ops::Range<usize>| {
            range.clone().all(|i| !moves(i) && track[i].quaternion == track[range.start].quaternion)
        };
        // The warm-up comes before frame -1.
        if away.iter().all(|d| *d > AWAKE_M + 60.0) {
            assert!(still(0..801) && track[0].xyz_m == track[800].xyz_m, "{actor:?}");
            found[0] += 1;
        } else if away.iter().all(|d| *d < AWAKE_M) {
            found[1] += i32::from((0..801).any(moves));
        } else if let Some(woke) = away.iter().position(|d| *d <= AWAKE_M).filter(|i| *i > 60) {
            assert!(still(0..woke), "{actor:?}");
            // A look a second, and a second to set off.
            found[2] += i32::from((woke..(woke + 41).min(801)).any(moves));
        } else if let Some(gone) = away.iter().position(|d| *d > AWAKE_M).filter(|i| *i < 560) {
            // Vehicles brake in comfort: 20 m/s takes 8 s, after a look each second; walkers come to rest
            // within 1.3 s, and look a second time.
            let asleep = gone + if actor.kind == ActorKind::Walker { 70 } else { 220 };
            if away[gone..].iter().all(|d| *d > AWAKE_M) {
                assert!(still(asleep..801), "{actor:?}");
                found[3] += 1;
            }
            let braking = (gone..800).map(|i| (speed(track[i]) - speed(track[i + 1])) / 0.05);
            let most = braking.fold(0.0, f64::max);
            assert!(actor.kind == ActorKind::Walker || most < 5.0, "{most} of {actor:?}");
        }
    }
    assert!(found[0].iter().chain(&found[1][..3]).all(|n| *n > 0), "{found:?}");
}

#[test]
fn nobody_sleeps_in_a_junction() {
    let map = crossing(false);
    let mut asleep = 0;
    for seed in 0..24 {
        let plan = PlanSceneRow { background_vehicles: Some(30), seed, ..scene(40.0) };
        // It leaves the others behind.
        let agents = [agent(0, [40.0, -1.75, 0.0], 0.0)];
        let log = run(&map, &plan, &agents, &awake_within(60.0));
        assert_eq!(collisions(&log, false), []);
        let watched = agents_of(&log);
        for (id, track) in &tracks(&log) {
            let length_m = log.actors.iter().find(|a| a.id == *id).expect("an actor").length_m;
            let last = track[800];
            if distances(&watched, track)[500..].iter().all(|d| *d > 60.0) {
                asleep += usize::from(speed(last) == 0.0);
                // Ways cross within 5 m of the middle; in a queue, a rear may stand over the line 5 m farther
                // out.
                let (sin, cos) = frames::math::sin_cos(yaw(last.quaternion));
                let ends = [-0.5, 0.5].map(|part| [cos, sin].map(|v| part * length_m * v));
                let inside = |end: &[f64; 2]| (0..2).all(|k| (last.xyz_m[k] + end[k]).abs() < 5.0);
                assert!(!ends.iter().any(inside), "{seed}: {last:?}");
            }
        }
    }
    assert!(asleep > 20, "{asleep}");
}

#[test]
fn sleepers_in_a_town_are_in_nobodys_way_for_good() {
    let town = town::generate(&town::named("convoy/03").expect("our town")).expect("a town");
    let map = Map::new(town);
    let agents = agents_on(&map, 3, 7);
    let plan = PlanSceneRow { background_vehicles: Some(150), walkers: 60, ..scene(40.0) };
    let log = run(&map, &plan, &agents, &awake_within(120.0));
    assert_eq!(collisions(&log, false), []);
    assert_eq!(collisions(&log, true), []);
    let tracks = tracks(&log);
    let agents: Vec<_> = log.actors.iter().filter(|a| a.role.agent().is_some()).collect();
    for agent in agents {
        let track = &tracks[&agent.id];
        assert!((Point3::from(track[0].xyz_m) - Point3::from(track[800].xyz_m)).norm() > 20.0, "{agent:?}");
    }
}

#[test]
fn near_ones_are_as_if_nobody_slept() {
    let map = straight(700.0);
    let plan = PlanSceneRow { background_vehicles: Some(20), walkers: 40, ..scene(20.0) };
    let agents = [agent(0, [300.0, -1.75, 0.0], 0.0)];
    let published = run(&map, &plan, &agents, &settings());
    assert_eq!(published, run(&map, &plan, &agents, &awake_within(100_000.0)));
    let near = run(&map, &plan, &agents, &awake_within(100.0));
    assert_ne!(published, near);
    assert_eq!(near, run(&map, &plan, &agents, &awake_within(100.0)));
}
