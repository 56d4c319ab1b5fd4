//! Articulated vehicles: what is towed follows its lead, and touches nobody and nothing.

use std::collections::BTreeMap;

use crate::common::{
    agent, agents_on, collisions, hazard, lights, red_runs, run, run_beside, run_with, scene, settings,
    tracks, two_lanes, yaw,
};
use catalogue::trains::{self, Train};
use frames::math::sin_cos;
use land::tiles::TileMaker;
use nalgebra::{Point3, Vector3};
use opendrive::{LaneType, Map, MarkType};
use schema::tables::{ActorRow, PlanSceneRow, StateRow};
use schema::{ActorKind, HazardKind};
use settings::SceneryRules;
use settings::stages::SimulationSettings;
use traffic::SimulationLog;

/// Every other vehicle is a train, where one has room.
fn many_trains() -> SimulationSettings {
    let mut settings = settings();
    (settings.traffic.articulated_lorries, settings.traffic.articulated_buses) = (0.4, 1.0);
    settings
}

/// What is towed in a log, with its train.
fn towed(log: &SimulationLog) -> Vec<(&ActorRow, &'static Train)> {
    log.actors.iter().filter_map(|a| Some((a, trains::of_towed(&a.model)?))).collect()
}

/// A point of a body, metres ahead of and to the left of its middle.
fn point(state: &StateRow, [ahead, left]: [f64; 2]) -> Point3<f64> {
    let (sin, cos) = sin_cos(yaw(state.quaternion));
    Point3::from(state.xyz_m) + Vector3::new(ahead * cos - left * sin, ahead * sin + left * cos, 0.0)
}

/// Each trailer hangs on its hitch, and its axle does not slide.
fn assert_coupled(log: &SimulationLog) {
    let tracks = tracks(log);
    for (actor, train) in towed(log) {
        let lead = actor.parent.and_then(|id| u16::try_from(id).ok()).expect("a lead");
        let row = log.actors.iter().find(|a| a.id == lead).expect("a row");
        assert_eq!((row.model.as_str(), row.kind), (train.lead.name, ActorKind::Vehicle));
        let (own, led) = (&tracks[&actor.id], &tracks[&lead]);
        assert_eq!(own.len(), led.len());
        for (state, lead) in own.iter().zip(led) {
            let [hitch, coupling] =
                [point(lead, [-train.hitch_m, 0.0]), point(state, [train.coupling_m, 0.0])];
            assert!((hitch - coupling).xy().norm() < 0.02, "frame {}: {hitch} {coupling}", state.frame);
            assert!((hitch.z - coupling.z).abs() < 0.7);
            assert_eq!((state.dormant, state.lights), (lead.dormant, lead.lights));
        }
        for pair in own.windows(2) {
            let [before, after] = [0, 1].map(|i| point(pair[i], [train.coupling_m - train.rod_m, 0.0]));
            let middle = yaw(pair[0].quaternion)
                + 0.5 * frames::wrap_pi(yaw(pair[1].quaternion) - yaw(pair[0].quaternion));
            let (sin, cos) = sin_cos(middle);
            let moved = after - before;
            let aside = moved.y * cos - moved.x * sin;
            assert!(aside.abs() < 1e-3 + 0.002 * moved.norm(), "{} slides by {aside} m", actor.model);
        }
    }
}

fn straight_train() -> (Map, PlanSceneRow, SimulationSettings) {
    let mut settings = settings();
    settings.traffic.articulated_lorries = 1.0;
    settings.traffic.speed_difference = Some(0.4);
    let mut scene = scene(20.0);
    scene.background_vehicles = Some(1);
    scene.spawn_separation_m = 60.0;
    (two_lanes(MarkType::Broken, None), scene, settings)
}

/// Footprints of what is towed and of one vehicle ahead of or beside it, in the end of a scene.
fn first_train(log: &SimulationLog) -> (u16, u16, &'static Train) {
    let all = towed(log);
    let (actor, train) = all.first().expect("a train");
    (actor.parent.and_then(|id| u16::try_from(id).ok()).expect("a lead"), actor.id, train)
}

#[test]
fn a_follower_keeps_its_distance_to_the_rear_of_the_whole_train() {
    // A lane that cannot be left, and an agent that comes from behind.
    let (_, mut scene, settings) = straight_train();
    let map = two_lanes(MarkType::Solid, None);
    let mut followed = 0;
    for seed in 0..12 {
        scene.seed = 500 + seed;
        let agents = [agent(0, [12.0, -1.75, 0.0], 0.0), agent(1, [12.0, -5.25, 0.0], 0.0)];
        let log = run(&map, &scene, &agents, &settings);
        assert_eq!(collisions(&log, false), [], "seed {seed}");
        if towed(&log).is_empty() {
            continue;
        }
        let (lead, rear, train) = first_train(&log);
        assert_coupled(&log);
        let tracks = tracks(&log);
        let last = |id: u16| *tracks[&id].last().expect("a state");
        let lane_y = last(lead).xyz_m[1];
        let behind = (1..=2).find(|id| (last(*id).xyz_m[1] - lane_y).abs() < 0.5).expect("one on its lane");
        let gap_m = last(rear).xyz_m[0] - last(behind).xyz_m[0] - 0.5 * (train.towed.size_m[0] + 4.70);
        let speed = f64::from(last(behind).velocity_mps[0]);
        if gap_m < 60.0 && last(rear).xyz_m[0] > last(behind).xyz_m[0] {
            followed += 1;
            assert!(gap_m > 2.0, "seed {seed}: {gap_m} m at {speed} m/s");
        }
    }
    assert!(followed >= 2, "{followed}");
}

#[test]
fn after_an_accident_both_sections_skid_and_stay_coupled() {
    let (_, mut scene, settings) = straight_train();
    let map = two_lanes(MarkType::Solid, None);
    let mut struck = 0;
    for seed in 0..12 {
        scene.seed = 500 + seed;
        let mut agents = [agent(0, [12.0, -1.75, 0.0], 0.0), agent(1, [12.0, -5.25, 0.0], 0.0)];
        for driver in &mut agents {
            (driver.reckless, driver.speed_difference) = (true, -0.9);
        }
        let log = run(&map, &scene, &agents, &settings);
        if towed(&log).is_empty() {
            continue;
        }
        let (lead, rear, train) = first_train(&log);
        let hit = collisions(&log, false).into_iter().find(|(_, a, b)| *a == rear || *b == rear);
        let Some((frame, ..)) = hit else { continue };
        struck += 1;
        let tracks = tracks(&log);
        let (led, own) = (&tracks[&lead], &tracks[&rear]);
        for (lead, state) in led.iter().zip(own) {
            let [hitch, coupling] =
                [point(lead, [-train.hitch_m, 0.0]), point(state, [train.coupling_m, 0.0])];
            let off_m = (hitch - coupling).xy().norm();
            assert!(off_m < 0.25, "seed {seed} frame {}: {off_m} m apart", state.frame);
        }
        // Nobody drives on.
        let last = own[own.len() - 1];
        if frame + 120 < last.frame {
            let speed = f64::from(last.velocity_mps[0]).abs() + f64::from(last.velocity_mps[1]).abs();
            assert!(speed < 0.1, "seed {seed}: {speed} m/s at the end");
        }
    }
    assert!(struck >= 1, "{struck} were struck");
}

#[test]
fn trains_change_lanes_before_a_hazard_with_room_for_all_of_them() {
    let (map, mut scene, settings) = straight_train();
    scene.duration_s = 45.0;
    scene.frames = 900;
    scene.background_vehicles = Some(9);
    let blocked = [hazard(HazardKind::Accident, "1", -2, [420.0, 434.0])];
    let hazards = [schema::tables::PlanHazardRow {
        models: vec!["car.suv".into(), "car.sedan".into()],
        ..blocked[0].clone()
    }];
    let mut passed = 0;
    for seed in 0..6 {
        scene.seed = 40 + seed;
        let log = run_with(&map, &scene, &[agent(0, [12.0, -5.25, 0.0], 0.0)], &hazards, &settings);
        assert_eq!(collisions(&log, false), [], "seed {seed}");
        assert_coupled(&log);
        let tracks = tracks(&log);
        for (actor, _) in towed(&log) {
            let track = &tracks[&actor.id];
            let (first, last) = (track[0], track[track.len() - 1]);
            passed += usize::from(first.xyz_m[1] < -4.5 && last.xyz_m[1] > -2.5);
        }
    }
    assert!(passed >= 3, "{passed} changed lanes");
}

#[test]
fn a_train_is_the_one_that_it_would_be_without_others() {
    let (map, scene, settings) = straight_train();
    let agents = [agent(0, [12.0, -5.25, 0.0], 0.0)];
    let (one, two) = (run(&map, &scene, &agents, &settings), run(&map, &scene, &agents, &settings));
    assert_eq!(one, two);
    // Nobody is another one because trains are left out.
    let mut none = settings;
    (none.traffic.articulated_lorries, none.traffic.articulated_buses) = (0.0, 0.0);
    let without = run(&map, &scene, &agents, &none);
    assert!(towed(&without).is_empty() && without.actors.iter().all(|a| a.parent.is_none()));
}

/// The objects beside the roads around agents, as in a dataset, and the lights that are farther off.
fn scenery(map: &Map, agents: &[schema::tables::PlanAgentRow]) -> Vec<ActorRow> {
    let centres: Vec<[f64; 3]> = agents.iter().map(|a| a.xyz_m).collect();
    let rules = SceneryRules { seed: 1, ..SceneryRules::default() };
    let around = TileMaker::new(map, &rules, catalogue::Catalogue::built_in()).around(&centres, 250.0, 1);
    let mut fixed = around.map(|around| around.actors).unwrap_or_default();
    let mut missing = lights(map);
    missing.retain(|light| fixed.iter().all(|a| a.opendrive_id != light.opendrive_id));
    fixed.extend(missing);
    for (id, actor) in (1..).zip(&mut fixed) {
        actor.id = id;
    }
    fixed
}

/// Points on the outline of what is towed that are over a sidewalk, most of them at a time, and how deep,
/// metres.
fn over_sidewalks(map: &Map, log: &SimulationLog) -> (usize, f64, Vec<String>) {
    let tracks = tracks(log);
    let (mut looked, mut deepest) = (0, 0.0_f64);
    let mut said = Vec::new();
    for (actor, train) in towed(log) {
        let [length, width, _] = train.towed.size_m;
        for state in tracks[&actor.id].iter().step_by(5) {
            looked += 1;
            for part in 0..=8 {
                for side in [-0.5, 0.5] {
                    let at = point(state, [(f64::from(part) / 8.0 - 0.5) * length, side * width]);
                    let walks = map.lanes_within(at, 6.0, |l| l.lane_type == LaneType::Sidewalk);
                    let hit = walks.into_iter().find(|hit| hit.is_inside());
                    let Some(hit) = hit else { continue };
                    // Where lanes of a junction lie over it, it is cut away.
                    let paved = map.lanes_within(at, 6.0, |l| l.lane_type.is_drivable());
                    let paved: Vec<_> = paved.into_iter().filter(|hit| hit.is_inside()).collect();
                    let above_m = (hit.distance_m * hit.distance_m - hit.t_m * hit.t_m).max(0.0).sqrt();
                    if !paved.is_empty() || above_m > 2.0 {
                        continue;
                    }
                    let deep = 0.5 * hit.width_m - hit.t_m.abs();
                    if deep > 0.05 {
                        said.push(format!("{} {} at {:?}: {deep}", actor.model, state.frame, at));
                    }
                    deepest = deepest.max(deep);
                }
            }
        }
    }
    (looked, deepest, said)
}

#[test]
fn trains_touch_nobody_and_nothing_in_towns() {
    let town = |name: &str| {
        let made = town::generate(&town::named(name).expect("our town")).expect("a town");
        Some(Map::new(made))
    };
    let mut met: BTreeMap<&str, usize> = BTreeMap::new();
    let maps = [
        ("convoy/demo", town("convoy/demo")),
        ("convoy/03", town("convoy/03")),
        ("convoy/06", town("convoy/06")),
        ("Town10HD", testkit::real_map("Town10HD")),
        ("Town03", testkit::real_map("Town03")),
        ("Town04", testkit::real_map("Town04")),
    ];
    for (name, map) in maps {
        let Some(map) = map else { continue };
        for seed in 0..2 {
            let mut scene = scene(30.0);
            scene.seed = 300 + seed;
            scene.background_vehicles = Some(80);
            scene.walkers = 40;
            let agents = agents_on(&map, 3, 7);
            let fixed = scenery(&map, &agents);
            let log = run_beside(&map, &scene, &agents, &[], &many_trains(), fixed.clone());
            assert_coupled(&log);
            for (_, train) in towed(&log) {
                *met.entry(train.towed.name).or_default() += 1;
            }
            assert_eq!(collisions(&log, false), [], "{name} {seed}");
            assert_eq!(collisions(&log, true), [], "{name} {seed}");
            assert_eq!(red_runs(&map, &log, &shown(&fixed)), [], "{name} {seed}");
            // Parked vehicles.
            let tracks = tracks(&log);
            for (actor, train) in towed(&log) {
                let [length, width, _] = train.towed.size_m;
                for parked in fixed.iter().filter(|a| a.kind == ActorKind::Parked) {
                    let at = StateRow {
                        xyz_m: parked.xyz_m,
                        quaternion: parked.quaternion,
                        ..StateRow::default()
                    };
                    let size = [parked.length_m, parked.width_m];
                    let hit = tracks[&actor.id]
                        .iter()
                        .find(|s| crate::common::touch(s, [length, width], &at, size));
                    assert!(hit.is_none(), "{name} {seed}: {} in {} at {:?}", actor.model, parked.model, hit);
                }
            }
            let (looked, deepest, said) = over_sidewalks(&map, &log);
            assert!(deepest < 0.05, "{name} {seed}: {deepest} m over a sidewalk, of {looked}: {said:?}");
            // And they get on.
            let moved = |track: &Vec<&StateRow>| {
                (Point3::from(track[0].xyz_m) - Point3::from(track[track.len() - 1].xyz_m)).norm()
            };
            let all = towed(&log);
            let gone = all.iter().filter(|(a, _)| moved(&tracks[&a.id]) > 15.0).count();
            assert!(2 * gone >= all.len(), "{name} {seed}: {gone} of {} got on", all.len());
        }
    }
    assert!(met.values().sum::<usize>() >= 20 && met.len() >= 4, "{met:?}");
}

/// The traffic lights of the objects beside the roads.
fn shown(fixed: &[ActorRow]) -> Vec<ActorRow> {
    fixed.iter().filter(|a| a.kind == ActorKind::TrafficLight).cloned().collect()
}
