//! What happens when something is touched: parked vehicles, cones, people beside the road, others at one's
//! side.

use crate::common::{
    agent, collisions, hazard, lights, parked, run_beside, run_with, scene, settings, straight, touch,
    tracks, two_lanes, yaw,
};
use opendrive::{Cubic, Map, MarkType, Network};
use schema::tables::{ActorRow, PlanAgentRow, PlanHazardRow, PlanSceneRow, StateRow};
use schema::{ActorKind, ActorRole, HazardKind};
use settings::stages::SimulationSettings;
use traffic::SimulationLog;

/// A saloon, as all agents here have it.
const CAR_M: [f64; 3] = [4.7, 1.84, 1.44];

fn size(log: &SimulationLog, id: u16) -> [f64; 2] {
    let actor = log.actors.iter().find(|a| a.id == id).expect("an actor");
    [actor.length_m, actor.width_m]
}

/// How far the first vehicle's footprint, made smaller by a margin on each side, meets that of something
/// parked.
fn meets(log: &SimulationLog, id: u16, thing: &ActorRow, margin_m: f64) -> bool {
    let at = StateRow { xyz_m: thing.xyz_m, quaternion: thing.quaternion, ..StateRow::default() };
    let own = size(log, id).map(|v| v - 2.0 * margin_m);
    tracks(log)[&id].iter().any(|s| touch(s, own, &at, [thing.length_m, thing.width_m]))
}

fn reckless(agent: PlanAgentRow) -> PlanAgentRow {
    PlanAgentRow { reckless: true, ..agent }
}

/// One agent on a road of one lane each way, 400 m to the east, beside something parked.
fn drive_by(driver: PlanAgentRow, thing: &ActorRow) -> SimulationLog {
    run_beside(&straight(400.0), &scene(30.0), &[driver], &[], &settings(), vec![thing.clone()])
}

#[test]
fn drivers_make_room_for_a_parked_car_that_reaches_into_the_lane() {
    // The lane's right edge is at -3.5; the car reaches over it by 0.9 m.
    let thing = parked([150.0, -3.5 - 0.92 + 0.9, 0.0], 0.0, CAR_M);
    for model in ["car.sedan", "bus.city", "motorcycle.sport"] {
        let driver = PlanAgentRow { model: model.into(), ..agent(0, [30.0, -1.75, 0.0], 0.0) };
        let log = drive_by(driver, &thing);
        assert!(!meets(&log, 2, &thing, 0.0), "{model}");
        let track = &tracks(&log)[&2];
        let last = track[track.len() - 1];
        assert!(last.xyz_m[0] > 250.0 && (last.xyz_m[1] + 1.75).abs() < 0.01, "{model}: {:?}", last.xyz_m);
        // Nobody needs more than its own lane and 0.3 m.
        let [_, width] = size(&log, 2);
        let left_m = track.iter().map(|s| s.xyz_m[1] + 0.5 * width).fold(f64::NEG_INFINITY, f64::max);
        assert!(left_m < 0.35, "{model} is at {left_m}");
        // It does not slow down for it, nor steer harder than in a lane change.
        let beside: Vec<&&StateRow> = track.iter().filter(|s| (s.xyz_m[0] - 150.0).abs() < 20.0).collect();
        assert!(beside.iter().all(|s| s.velocity_mps[0] > 9.0 && s.velocity_mps[1].abs() < 1.2), "{model}");
    }
    // An obstacle that does not reach into the lane is passed in its middle.
    let beside = parked([150.0, -3.5 - 0.95, 0.0], 0.0, CAR_M);
    let log = drive_by(agent(0, [30.0, -1.75, 0.0], 0.0), &beside);
    assert!(tracks(&log)[&2].iter().all(|s| (s.xyz_m[1] + 1.75).abs() < 1e-6));
}

#[test]
fn who_sees_no_vehicles_runs_into_parked_ones_wherever_they_stand() {
    for (y_m, stops) in [(-1.75, true), (-3.5 - 0.92 + 1.1, true), (-3.5 - 0.92 - 0.05, false)] {
        let thing = parked([150.0, y_m, 0.0], 0.0, CAR_M);
        let log = drive_by(reckless(agent(0, [30.0, -1.75, 0.0], 0.0)), &thing);
        // No deeper than the way of a step, and out again.
        assert!(!meets(&log, 2, &thing, 0.7), "{y_m}");
        let end = SimulationLog { states: log.states[600..].to_vec(), ..log.clone() };
        assert!(!meets(&end, 2, &thing, 0.05), "{y_m}");
        let track = &tracks(&log)[&2];
        let last = track[track.len() - 1];
        assert_eq!(f64::from(last.velocity_mps[0]) < 0.05, stops, "{y_m}: {:?}", last.xyz_m);
        assert_eq!(last.xyz_m[0] > 250.0, !stops, "{y_m}: {:?}", last.xyz_m);
    }
}

#[test]
fn a_parked_car_that_leaves_no_room_is_passed_by_the_lane_beside_or_waited_behind() {
    let thing = parked([200.0, -5.25, 0.0], 0.0, CAR_M);
    let agents = [agent(0, [60.0, -5.25, 0.0], 0.0), agent(1, [30.0, -5.25, 0.0], 0.0)];
    let map = two_lanes(MarkType::Broken, None);
    let log = run_beside(&map, &scene(40.0), &agents, &[], &settings(), vec![thing.clone()]);
    for id in [2, 3] {
        assert!(!meets(&log, id, &thing, 0.0));
        assert!(tracks(&log)[&id][800].xyz_m[0] > 260.0, "{:?}", tracks(&log)[&id][800].xyz_m);
    }
    let thing = parked([150.0, -1.75, 0.0], 0.0, CAR_M);
    let log = drive_by(agent(0, [30.0, -1.75, 0.0], 0.0), &thing);
    let last = tracks(&log)[&2][600];
    let gap_m = 150.0 - CAR_M[0] - last.xyz_m[0];
    assert!(last.velocity_mps[0].abs() < 0.05 && (3.5..20.0).contains(&gap_m), "{gap_m}");
}

/// Road works on the lane of a road of one lane each way.
fn works(log_of: PlanAgentRow, settings: &SimulationSettings, seed: u64) -> SimulationLog {
    let row = PlanHazardRow { items: 6, ..hazard(HazardKind::RoadWorks, "1", -1, [150.0, 160.0]) };
    let scene = PlanSceneRow { seed, ..scene(30.0) };
    run_with(&straight(500.0), &scene, &[log_of], &[row], settings)
}

fn things(log: &SimulationLog) -> Vec<&ActorRow> {
    log.actors.iter().filter(|a| a.role == ActorRole::Hazard).collect()
}

/// What in road works weighs more than a person can lift.
fn is_heavy(thing: &ActorRow) -> bool {
    let stone = ["concrete", "pipe", "pile", "stone_ring", "iron_plank", "construction_light"];
    stone.iter().any(|word| thing.model.contains(word)) || thing.kind == ActorKind::Walker
}

#[test]
fn who_sees_no_signs_drives_through_road_works_and_pushes_them_away() {
    let mut pushed = 0;
    let mut driven_through = 0;
    for seed in 0..90 {
        let mut blind = settings();
        blind.traffic.ignore_signs = 1.0;
        let log = works(agent(0, [30.0, -1.75, 0.0], 0.0), &blind, seed);
        if things(&log).iter().any(|t| is_heavy(t) && t.kind != ActorKind::Sign) {
            continue;
        }
        driven_through += 1;
        let track = &tracks(&log)[&1];
        let last = track[track.len() - 1];
        assert!(last.xyz_m[0] > 200.0 && last.velocity_mps[0] > 10.0, "seed {seed}: {:?}", last.xyz_m);
        for thing in things(&log).iter().filter(|t| !t.fixed) {
            // A state at each moment, at rest first and last, and moved on between.
            let states: Vec<&StateRow> = log.states.iter().filter(|s| s.id == thing.id).collect();
            assert_eq!(states.len(), 601);
            assert_eq!(states[0].velocity_mps, [0.0; 3]);
            // What the car does not push any more comes to rest.
            let away = last.xyz_m[0] - states[600].xyz_m[0];
            assert!(away < 30.0 || states[600].velocity_mps == [0.0; 3], "seed {seed}: {}", thing.model);
            assert_eq!((states[1].xyz_m, states[1].frame), (thing.xyz_m, 0));
            for pair in states.windows(2) {
                let moved = (pair[1].xyz_m[0] - pair[0].xyz_m[0]) / 0.05;
                assert!((moved - f64::from(pair[1].velocity_mps[0])).abs() < 1e-3);
                assert!(moved < 32.0, "not much faster than twice the car: {moved}");
            }
            pushed += usize::from(states[600].xyz_m[0] - states[0].xyz_m[0] > 1.0);
        }
        assert!(log.states.windows(2).all(|p| (p[0].frame, p[0].id) < (p[1].frame, p[1].id)));
    }
    assert!(driven_through >= 3 && pushed >= 2 * driven_through, "{driven_through} {pushed}");
}

#[test]
fn careful_drivers_move_nothing_and_what_is_not_touched_is_fixed() {
    for seed in 0..6 {
        let log = works(agent(0, [30.0, -1.75, 0.0], 0.0), &settings(), seed);
        assert!(things(&log).iter().all(|t| t.fixed));
        assert!(things(&log).iter().all(|t| log.states.iter().all(|s| s.id != t.id)));
        assert!(tracks(&log)[&1][600].xyz_m[0] < 150.0);
    }
}

#[test]
fn each_overlooks_what_it_is_said_to_overlook() {
    // Signs, vehicles, walkers; and whether the driver runs into road works and into an accident's vehicles.
    let cases = [
        ([0.0, 0.0, 0.0], false, false),
        ([1.0, 0.0, 0.0], true, false),
        ([0.0, 1.0, 0.0], false, true),
        ([0.0, 0.0, 1.0], false, false),
    ];
    // With an emergency vehicle at its rear, or there would be a cone.
    let accident = PlanHazardRow {
        models: ["van.delivery", "car.sedan", "van.ambulance"].map(String::from).to_vec(),
        ..hazard(HazardKind::Accident, "1", -1, [150.0, 176.0])
    };
    for (shares, into_works, into_accident) in cases {
        let mut settings = settings();
        let traffic = &mut settings.traffic;
        [traffic.ignore_signs, traffic.ignore_vehicles, traffic.ignore_walkers] = shares;
        let mut looked_at = [0; 2];
        for seed in 0..8 {
            let driver = || agent(0, [30.0, -1.75, 0.0], 0.0);
            let scene = PlanSceneRow { seed, ..scene(30.0) };
            let row = std::slice::from_ref(&accident);
            let at_accident = run_with(&straight(500.0), &scene, &[driver()], row, &settings);
            let wanted = [into_works, into_accident];
            for (k, log) in [works(driver(), &settings, seed), at_accident].into_iter().enumerate() {
                // For people even drivers stop who see nothing else there.
                if wanted[k] && things(&log).iter().any(|t| t.kind == ActorKind::Walker) {
                    continue;
                }
                looked_at[k] += 1;
                let hit = things(&log).iter().any(|t| {
                    let states: Vec<&StateRow> = log.states.iter().filter(|s| s.id == t.id).collect();
                    states.first().zip(states.last()).is_some_and(|(a, b)| a.xyz_m != b.xyz_m)
                });
                assert_eq!(hit, wanted[k], "{shares:?} at {k}, seed {seed}");
            }
        }
        assert!(looked_at.iter().all(|n| *n > 0), "{looked_at:?}");
    }
}

/// Two roads of one lane each, to the east: the second lane's middle lies 3.6 m to the right of the first
/// one's, but from 210 to 290 m as near as told.
fn squeezed(apart_m: f64) -> Map {
    let first = straight(600.0).network().roads[0].clone();
    let mut lanes = first.sections[0].clone();
    lanes.left.clear();
    let mut one = first.clone();
    one.sections = vec![lanes];
    let mut two = one.clone();
    two.id = "2".into();
    two.plan_view[0].y_m -= 3.6;
    // Smoothsteps over 60 m.
    let span = 60.0;
    let step = |s: f64, from: f64, way: f64| Cubic {
        s,
        a: from,
        b: 0.0,
        c: 3.0 * way / (span * span),
        d: -2.0 * way / (span * span * span),
    };
    let way = 3.6 - apart_m;
    two.lane_offset = vec![
        Cubic::constant(0.0),
        step(150.0, 0.0, way),
        Cubic { s: 210.0, ..Cubic::constant(way) },
        step(290.0, way, -way),
        Cubic { s: 350.0, ..Cubic::constant(0.0) },
    ];
    Map::new(Network { roads: vec![one, two], ..Network::default() })
}

#[test]
fn two_who_graze_drive_on() {
    for (apart_m, touches) in [(1.9, false), (1.75, true)] {
        let agents = [agent(0, [40.0, -1.75, 0.0], 0.0), agent(1, [40.0, -5.35, 0.0], 0.0)];
        let log = run_with(&squeezed(apart_m), &scene(32.0), &agents, &[], &settings());
        let tracks = tracks(&log);
        // Cars of 1.84 m whose lanes are 1.75 m apart push each other aside by 4.5 cm each.
        let beside = |id: u16, y_m: f64| {
            let there = |s: &&&StateRow| (s.xyz_m[0] - 250.0).abs() < 30.0;
            let off = tracks[&id].iter().filter(there).map(|s| (s.xyz_m[1] - y_m).abs());
            off.fold(0.0, f64::max)
        };
        let off = [beside(1, -1.75), beside(2, -1.75 - apart_m)];
        assert_eq!(off.iter().sum::<f64>() > 0.06, touches, "{apart_m}: {off:?}");
        assert!(touches || off.iter().all(|o| *o < 1e-3), "{off:?}");
        for (id, y_m) in [(1, -1.75), (2, -5.35)] {
            let last = tracks[&id][640];
            assert!(
                last.xyz_m[0] > 400.0 && last.velocity_mps[0] > 10.0,
                "{apart_m}: {id} at {:?}",
                last.xyz_m
            );
            assert!(
                (last.xyz_m[1] - y_m).abs() < 0.02 && yaw(last.quaternion).abs() < 0.01,
                "{:?}",
                last.xyz_m
            );
            // Nor is it thrown about.
            let jumps = tracks[&id].windows(2).map(|p| (p[1].velocity_mps[1] - p[0].velocity_mps[1]).abs());
            assert!(jumps.fold(0.0, f32::max) < 1.0);
        }
        // They give: no deeper than 3 cm.
        let deep = log.states.chunk_by(|a, b| a.frame == b.frame).any(|frame| {
            let [a, b] = [&frame[0], &frame[1]];
            touch(a, size(&log, 1).map(|v| v - 0.06), b, size(&log, 2))
        });
        assert!(!deep);
    }
}

#[test]
fn a_car_out_of_control_hits_people_on_the_sidewalk() {
    // A lorry stands askew on the left half of the lane: a vehicle that drives against it at full speed is
    // thrown to the right, onto the sidewalk, which lies from -3.5 to -6.5.
    let lorry = parked([120.0, 0.2, 0.0], -0.45, [8.0, 2.4, 3.0]);
    let mut struck = 0;
    for seed in 0..6 {
        let plan = PlanSceneRow { seed, walkers: 130, walker_cross_factor: 0.0, ..scene(25.0) };
        for (driver, hits) in [(true, true), (false, false)] {
            let driver = PlanAgentRow { reckless: driver, ..agent(0, [30.0, -1.75, 0.0], 0.0) };
            let map = straight(240.0);
            let fixed = lights(&map).into_iter().chain([lorry.clone()]).collect();
            let log = run_beside(&map, &plan, &[driver], &[], &settings(), fixed);
            let tracks = tracks(&log);
            let walkers = log.actors.iter().filter(|a| a.kind == ActorKind::Walker);
            let thrown: Vec<f64> = walkers
                .filter_map(|w| {
                    // No walker gains 1.5 m/s within a step, but for runners, who do not lie there in
                    // the end.
                    let lies = tracks[&w.id][440..].iter().all(|s| s.velocity_mps == [0.0; 3]);
                    let hit = tracks[&w.id].windows(2).filter(|_| lies).find(|p| {
                        let gained = [0, 1].map(|k| f64::from(p[1].velocity_mps[k] - p[0].velocity_mps[k]));
                        gained[0] * gained[0] + gained[1] * gained[1] > 1.5 * 1.5
                    })?;
                    Some(hit[0].xyz_m[1])
                })
                .collect();
            assert!(hits || thrown.is_empty(), "seed {seed}: {thrown:?}");
            assert!(thrown.iter().all(|y| (3.5..6.5).contains(&y.abs())), "on the sidewalks: {thrown:?}");
            struck += thrown.len();
            // No walker ends up inside the wreck.
            let rest = log.states.iter().filter(|s| s.frame == 499).cloned().collect();
            let still = SimulationLog { states: rest, ..log.clone() };
            assert_eq!(collisions(&still, true), [], "seed {seed}");
        }
    }
    assert!(struck >= 3, "{struck}");
}
