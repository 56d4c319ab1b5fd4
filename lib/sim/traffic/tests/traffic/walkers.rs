//! Walkers among walkers.

use crate::common;

use std::collections::BTreeMap;
use std::f64::consts::FRAC_PI_2;

use crate::common::{agent, collisions, crossing, run, scene, settings, straight, tracks};
use opendrive::{Cubic, Lane, LaneType, Map, Object};
use schema::tables::{ActorRow, StateRow};
use schema::{ActorKind, Attribute, SignalState};
use traffic::SimulationLog;

/// Pairs of walkers whose boxes overlap in any frame.
fn overlaps(log: &SimulationLog) -> Vec<(i32, u16, u16)> {
    let size: BTreeMap<u16, [f64; 2]> = log
        .actors
        .iter()
        .filter(|a| a.kind == ActorKind::Walker)
        .map(|a| (a.id, [a.length_m, a.width_m]))
        .collect();
    let mut found = Vec::new();
    for frame in log.states.chunk_by(|a, b| a.frame == b.frame) {
        let walkers: Vec<&StateRow> = frame.iter().filter(|s| size.contains_key(&s.id)).collect();
        for (i, a) in walkers.iter().enumerate() {
            for b in &walkers[i + 1..] {
                if (a.xyz_m[0] - b.xyz_m[0]).abs() < 1.0 && common::touch(a, size[&a.id], b, size[&b.id]) {
                    found.push((a.frame, a.id, b.id));
                }
            }
        }
    }
    found
}

#[test]
fn walkers_never_overlap_and_all_get_on() {
    // A sidewalk each side, walked in both directions: one walker on 2 to 13 m of it.
    for (seed, count, length_m) in
        [(1, 12, 80.0), (2, 30, 80.0), (3, 60, 80.0), (4, 40, 60.0), (5, 60, 120.0)]
    {
        let map = straight(length_m);
        let mut scene = scene(60.0);
        scene.seed = seed;
        scene.walkers = count;
        scene.walker_cross_factor = 0.0;
        let log = run(&map, &scene, &[agent(0, [20.0, -1.75, 0.0], 0.0)], &settings());
        assert_eq!(log.n_walkers, count);
        assert_eq!(overlaps(&log), [], "seed {seed}");
        let tracks = tracks(&log);
        let (mut steps, mut at_the_edge) = (0, 0);
        for actor in log.actors.iter().filter(|a| a.kind == ActorKind::Walker) {
            let track = &tracks[&actor.id];
            // On the sidewalk, 3.5 to 6.5 m from the middle, and but for some who are pushed aside with the
            // feet well on it.
            let margins_m = track.iter().map(|s| (s.xyz_m[1].abs() - 3.5).min(6.5 - s.xyz_m[1].abs()));
            let least_m = margins_m.clone().fold(f64::INFINITY, f64::min);
            // What rolls cannot step aside, and needs a few centimetres more to turn.
            let rolls = ["walker.wheelchair", "walker.with_pram"].contains(&actor.model.as_str());
            let edge_m = if rolls { -0.05 } else { 0.0 };
            assert!(least_m >= edge_m, "seed {seed}: {} comes within {least_m} m of an edge", actor.model);
            steps += track.len();
            at_the_edge += margins_m.filter(|margin_m| *margin_m < 0.25).count();
            assert!(track.iter().all(|s| (0.0..=length_m).contains(&s.xyz_m[0])), "seed {seed}");
            // Everybody gets on, in each quarter of a minute, though nobody stops or turns round at once.
            for part in track.chunks(300).filter(|c| c.len() == 300) {
                let way: f64 = part.windows(2).map(|p| (p[1].xyz_m[0] - p[0].xyz_m[0]).abs()).sum();
                assert!(way > 2.0, "seed {seed}: {} walks {way} m in 15 s", actor.id);
            }
            // Nobody leaps: aside at most 0.8 m/s, but for what is turned at the ends, and where a crowd
            // pushes.
            for pair in track.windows(2) {
                let aside = (pair[1].xyz_m[1] - pair[0].xyz_m[1]).abs() / 0.05;
                assert!(aside < 1.5, "seed {seed}: {aside} m/s aside");
            }
        }
        assert!(at_the_edge * 1000 < steps, "seed {seed}: {at_the_edge} of {steps} steps at an edge");
    }
}

/// The crossing with lights, a sidewalk on each side of its arms, and a crosswalk 4 m before its lines.
fn crosswalks() -> Map {
    let mut network = crossing(true).network().clone();
    for road in network.roads.iter_mut().filter(|r| r.junction.is_none()) {
        for section in &mut road.sections {
            let walk = |id| Lane {
                id,
                lane_type: LaneType::Sidewalk,
                widths: vec![Cubic::constant(3.0)],
                ..Lane::default()
            };
            section.left.push(walk(2));
            section.right.push(walk(-2));
        }
        road.objects.push(Object {
            id: format!("walk {}", road.id),
            kind: "crosswalk".into(),
            s: 4.0,
            hdg_rad: std::f64::consts::FRAC_PI_2,
            length_m: Some(9.0),
            width_m: Some(3.0),
            ..Object::default()
        });
    }
    Map::new(network)
}

#[test]
fn walkers_who_do_not_cross_anywhere_wait_for_red_at_crosswalks_with_lights() {
    let map = crosswalks();
    assert_eq!(map.crosswalks().len(), 4);
    let mut begun = 0;
    for seed in 1..=3 {
        let mut scene = scene(60.0);
        (scene.seed, scene.walkers, scene.walker_cross_factor) = (seed, 40, 0.0);
        let mut settings = settings();
        settings.traffic.green_time_s = Some(12.0);
        let log = run(&map, &scene, &[agent(0, [60.0, 1.75, 0.0], std::f64::consts::PI)], &settings);
        assert_eq!(overlaps(&log), []);
        let tracks = tracks(&log);
        for walker in log.actors.iter().filter(|a| a.kind == ActorKind::Walker) {
            // On which arm's lanes, if on any: distance along and beside its middle line.
            let on_lanes = |s: &StateRow| {
                let [x, y, _] = s.xyz_m;
                let arms = [(x, y), (y, -x), (-x, -y), (-y, x)];
                arms.iter().position(|(ahead, aside)| *ahead > 10.0 && aside.abs() < 3.2)
            };
            for pair in tracks[&walker.id].windows(2) {
                let (None, Some(arm)) = (on_lanes(pair[0]), on_lanes(pair[1])) else { continue };
                let id = format!("s{arm}");
                let light = log.signals.iter().find(|l| l.frame == pair[1].frame && l.opendrive_id == id);
                let light = light.expect("a light");
                assert_eq!(
                    light.state,
                    SignalState::Red,
                    "seed {seed}: {} steps onto arm {arm}: {light:?}",
                    walker.id
                );
                begun += 1;
            }
        }
    }
    assert!(begun > 20, "{begun} crossed");
}

#[test]
fn a_share_of_walkers_rolls_and_its_wheels_turn_with_the_way() {
    let map = straight(400.0);
    let mut scene = scene(20.0);
    scene.walkers = 120;
    let mut settings = settings();
    settings.walkers.wheelchair = 0.25;
    let log = run(&map, &scene, &[agent(0, [20.0, -1.75, 0.0], 0.0)], &settings);
    assert_eq!(overlaps(&log), []);
    let tracks = tracks(&log);
    let mut chairs = 0;
    for walker in log.actors.iter().filter(|a| a.kind == ActorKind::Walker) {
        let rolls = walker.model == "walker.wheelchair";
        assert_eq!(rolls, walker.attributes.is_true(&Attribute::UseWheelchair));
        chairs += u32::from(rolls);
        for pair in tracks[&walker.id].windows(2).filter(|_| rolls) {
            let way = [0, 1].map(|k| pair[1].xyz_m[k] - pair[0].xyz_m[k]);
            let way = (way[0] * way[0] + way[1] * way[1]).sqrt();
            assert!(way <= 2.01 * 0.05, "{way} m in a step");
            // A wheel of 0.31 m.
            assert!((0.31 * f64::from(pair[1].phase_rad - pair[0].phase_rad) - way).abs() < 1e-4);
        }
    }
    // A quarter of 120: 30, four standard deviations are 19.
    assert!((11..=49).contains(&chairs), "{chairs} wheelchairs");
}

#[test]
fn some_push_prams_or_lead_dogs_and_get_on_among_the_others() {
    let map = straight(1500.0);
    let mut counts: BTreeMap<String, usize> = BTreeMap::new();
    for seed in 1..=5 {
        let mut scene = scene(30.0);
        (scene.seed, scene.walkers, scene.walker_cross_factor, scene.spawn_radius_m) =
            (seed, 400, 0.0, 2000.0);
        let mut settings = settings();
        settings.walkers.wheelchair = 0.0;
        settings.walkers.waiting = 0.0;
        let log = run(&map, &scene, &[agent(0, [700.0, -1.75, 0.0], 0.0)], &settings);
        assert_eq!(overlaps(&log), [], "seed {seed}");
        let tracks = tracks(&log);
        for walker in log.actors.iter().filter(|a| a.kind == ActorKind::Walker) {
            *counts.entry(walker.model.clone()).or_default() += 1;
            let with = walker.attributes.get(&Attribute::SpecialType).unwrap_or_default();
            assert_eq!(walker.model.strip_prefix("walker.with_").unwrap_or(""), with);
            if with == "pram" {
                let way = |p: &[&StateRow]| (p[1].xyz_m[0] - p[0].xyz_m[0]).abs();
                let steps: Vec<f64> = tracks[&walker.id].windows(2).map(way).collect();
                // 1.8 m/s, and a third more for those who catch up with their company.
                assert!(steps.iter().all(|way| *way < 1.3 * 1.8 * 0.05 + 1e-6), "{} runs", walker.id);
                assert!(steps.iter().sum::<f64>() > 10.0, "{} does not get on", walker.id);
            }
        }
    }
    // Of 2000, four of six models grown-up: 27 and 40 expected, within four standard deviations.
    let [prams, dogs] = ["walker.with_pram", "walker.with_dog"].map(|m| counts.get(m).copied().unwrap_or(0));
    assert!((7..=47).contains(&prams) && (15..=65).contains(&dogs), "{counts:?}");
}

/// A country road to the east, one lane each way, without sidewalks.
fn country(length_m: f64) -> Map {
    let mut network = straight(length_m).network().clone();
    for section in &mut network.roads[0].sections {
        section.left.retain(|l| l.lane_type == LaneType::Driving);
        section.right.retain(|l| l.lane_type == LaneType::Driving);
    }
    Map::new(network)
}

#[test]
fn where_there_is_no_sidewalk_people_walk_along_both_edges_of_the_road() {
    let mut scene = scene(40.0);
    (scene.walkers, scene.walker_cross_factor, scene.background_vehicles) = (120, 0.0, Some(20));
    scene.spawn_radius_m = 2000.0;
    let log = run(&country(800.0), &scene, &[agent(0, [20.0, -1.75, 0.0], 0.0)], &settings());
    assert_eq!(log.n_walkers, 120);
    assert_eq!(overlaps(&log), []);
    let tracks = tracks(&log);
    let walkers: Vec<u16> = log.actors.iter().filter(|a| a.kind == ActorKind::Walker).map(|a| a.id).collect();
    let mut in_part = [[0; 2]; 4];
    for id in &walkers {
        // Beyond the lane's edge at 3.5 m, about the strip from 0.3 to 1.9 m beside it.
        let off = tracks[id].iter().find(|s| !(3.52..=5.7).contains(&s.xyz_m[1].abs()));
        assert!(off.is_none(), "{off:?}");
        let [x, y, _] = tracks[id][0].xyz_m;
        in_part[((x / 200.0) as usize).min(3)][usize::from(y > 0.0)] += 1;
    }
    // 120 over eight parts: 15, four standard deviations are 14.5.
    assert!(in_part.iter().flatten().all(|n| (1..=30).contains(n)), "{in_part:?}");
    // Nobody drives into them, nor crawls behind them.
    let vehicles: Vec<u16> =
        log.actors.iter().filter(|a| a.kind == ActorKind::Vehicle).map(|a| a.id).collect();
    assert!(collisions(&log, true).is_empty());
    let agent = &tracks[&vehicles[0]];
    assert!(agent[agent.len() - 1].xyz_m[0] > 250.0, "{:?}", agent[agent.len() - 1].xyz_m);
}

/// For each walker the distance to the nearest other one at a state, metres.
fn nearest_m(log: &SimulationLog, state: usize) -> Vec<f64> {
    let tracks = tracks(log);
    let at = |id: u16| tracks[&id][state].xyz_m;
    let ids: Vec<u16> = log.actors.iter().filter(|a| a.kind == ActorKind::Walker).map(|a| a.id).collect();
    let away = |a: u16, b: u16| {
        let [dx, dy] = [0, 1].map(|k| at(a)[k] - at(b)[k]);
        (dx * dx + dy * dy).sqrt()
    };
    let nearest =
        |&a: &u16| ids.iter().filter(|b| **b != a).map(|&b| away(a, b)).fold(f64::INFINITY, f64::min);
    ids.iter().map(nearest).collect()
}

#[test]
fn those_of_a_group_walk_together() {
    for (share, together) in [(0.0, [0.0, 0.25]), (1.0, [0.85, 1.0])] {
        let mut scene = scene(60.0);
        (scene.walkers, scene.walker_cross_factor) = (60, 0.0);
        (scene.spawn_radius_m, scene.seed) = (2000.0, 5);
        let mut settings = settings();
        settings.walkers.in_groups = share;
        let log = run(&straight(1500.0), &scene, &[agent(0, [700.0, -1.75, 0.0], 0.0)], &settings);
        assert_eq!((log.n_walkers, overlaps(&log)), (60, vec![]));
        for state in [0, 400, 800, 1200] {
            let near = nearest_m(&log, state).iter().filter(|d| **d < 2.0).count();
            let part = near as f64 / 60.0;
            assert!((together[0]..=together[1]).contains(&part), "{share} at {state}: {part}");
        }
        // They get on all the same.
        let gone = tracks(&log).into_iter().filter(|(id, track)| {
            let way = |p: &[&StateRow]| (p[1].xyz_m[0] - p[0].xyz_m[0]).abs();
            *id > 1 && track.windows(2).map(way).sum::<f64>() > 25.0
        });
        assert!(gone.count() > 54);
    }
}

#[test]
fn some_stand_and_wait_and_walk_on_later() {
    let mut settings = settings();
    settings.walkers.waiting = 1.0;
    let mut plan = scene(100.0);
    (plan.walkers, plan.walker_cross_factor) = (40, 0.0);
    let map = crosswalks();
    let log = run(&map, &plan, &[agent(0, [60.0, 1.75, 0.0], std::f64::consts::PI)], &settings);
    assert_eq!(overlaps(&log), []);
    let tracks = tracks(&log);
    let mut at_kerb = 0;
    for walker in log.actors.iter().filter(|a| a.kind == ActorKind::Walker) {
        let track = &tracks[&walker.id];
        let from = |i: usize| {
            let [dx, dy] = [0, 1].map(|k| track[i].xyz_m[k] - track[0].xyz_m[k]);
            (dx * dx + dy * dy).sqrt()
        };
        // Nobody leaves before 5 s, of which 2 s were before frame 0; all have left after 90 s.
        assert!((0..55).all(|i| from(i) < 0.3), "{} steps away", walker.id);
        assert!((0..=2000).any(|i| from(i) > 2.0), "{} stands for ever", walker.id);
        // Before a crosswalk, 14 m from the middle of the crossing: looking over the road.
        let [x, y, _] = track[0].xyz_m;
        let arms = [(x, y), (y, -x), (-x, -y), (-y, x)];
        at_kerb +=
            arms.iter().filter(|(ahead, aside)| (ahead - 14.0).abs() < 6.0 && aside.abs() < 6.5).count();
    }
    assert!(at_kerb >= 8, "{at_kerb} at crosswalks");
}

#[test]
fn groups_who_stand_face_one_another_and_walk_on_together() {
    let mut settings = settings();
    (settings.walkers.waiting, settings.walkers.in_groups) = (1.0, 1.0);
    let mut plan = scene(100.0);
    (plan.walkers, plan.walker_cross_factor, plan.spawn_radius_m) = (45, 0.0, 2000.0);
    let log = run(&straight(1500.0), &plan, &[agent(0, [700.0, -1.75, 0.0], 0.0)], &settings);
    assert_eq!((log.n_walkers, overlaps(&log)), (45, vec![]));
    let tracks = tracks(&log);
    let ids: Vec<u16> = log.actors.iter().filter(|a| a.kind == ActorKind::Walker).map(|a| a.id).collect();
    let mut talking = 0;
    for id in &ids {
        let own = tracks[id][0];
        let near = ids.iter().filter(|other| *other != id).filter_map(|other| {
            let there = tracks[other][0].xyz_m;
            let [dx, dy] = [0, 1].map(|k| there[k] - own.xyz_m[k]);
            ((dx * dx + dy * dy).sqrt() < 2.2).then_some((*other, [dx, dy]))
        });
        let near: Vec<(u16, [f64; 2])> = near.collect();
        let yaw =
            frames::Pose::<frames::World, frames::Object>::from_xyz_wxyz(own.xyz_m, own.quaternion).yaw();
        // Each of two or three others of a ring is within 60 degrees of straight ahead: in a ring of three
        // within 30.
        let ahead = |[dx, dy]: [f64; 2]| frames::wrap_pi(frames::math::atan2(dy, dx) - yaw).abs() < 0.6;
        let met = near.iter().filter(|(_, way)| ahead(*way)).count();
        talking += u32::from((1..=2).contains(&met));
        // They stand for at least 5 s, of which 2 s were before frame 0.
        let gone = |i: usize| (tracks[id][i].xyz_m[0] - own.xyz_m[0]).abs();
        assert!((0..55).all(|i| gone(i) < 0.3), "{id} steps away");
        assert!((0..=2000).any(|i| gone(i) > 3.0), "{id} stands for ever");
    }
    // All but those whose group found no room, or was cut off at the end of the list.
    assert!(talking >= 38, "{talking} of 45 talk");
    for state in [600, 1200] {
        let together = nearest_m(&log, state).iter().filter(|d| **d < 3.0).count();
        assert!(together >= 36, "{together} of 45 are together at {state}");
    }
}

#[test]
fn some_who_wait_sit_on_benches() {
    let mut settings = settings();
    settings.walkers.waiting = 1.0;
    let mut plan = scene(100.0);
    (plan.walkers, plan.walker_cross_factor) = (60, 0.0);
    // Beyond the outer edges of both sidewalks, looking at the road.
    let benches: Vec<ActorRow> = (0..20)
        .map(|k| {
            let (x, left) = (120.0 + 20.0 * f64::from(k), if k % 2 == 0 { 1.0 } else { -1.0 });
            let bench = common::parked([x, left * 7.0, 0.1], -left * FRAC_PI_2, [0.55, 1.7, 0.85]);
            ActorRow { kind: ActorKind::Prop, model: "prop.bench".into(), semantic_tags: vec![20], ..bench }
        })
        .collect();
    let agents = [agent(0, [300.0, -1.75, 0.0], 0.0)];
    let log = common::run_beside(&straight(600.0), &plan, &agents, &[], &settings, benches.clone());
    let tracks = tracks(&log);
    let mut taken = Vec::new();
    for walker in log.actors.iter().filter(|a| a.kind == ActorKind::Walker) {
        let track = &tracks[&walker.id];
        let seat_m = f64::from(track[0].seat_m);
        assert_eq!(walker.attributes.is_true(&Attribute::SitsOnBench), seat_m > 0.0);
        if seat_m == 0.0 {
            assert!(track.iter().all(|s| s.seat_m == 0.0));
            continue;
        }
        // A bench's seat is at half its height; people who sit stay there.
        assert!((seat_m - 0.425).abs() < 1e-6, "{seat_m}");
        let same = |s: &&StateRow| s.xyz_m == track[0].xyz_m && s.seat_m == track[0].seat_m;
        assert!(track.iter().all(same), "{} moves", walker.id);
        assert!(walker.model != "walker.child" && walker.attributes.get(&Attribute::SpecialType) == Some(""));
        // Before the back rest of a bench, on one of two places, looking away from it.
        let [x, y, z] = track[0].xyz_m;
        let on = benches.iter().position(|b| (b.xyz_m[0] - x).abs() < 0.5 && b.xyz_m[1] * y > 0.0);
        let bench = &benches[on.expect("a bench")];
        let before_m = bench.xyz_m[1].abs() - y.abs();
        assert!((before_m - (-0.275 + 0.09 + 0.33)).abs() < 1e-9, "{before_m}");
        assert!(((x - bench.xyz_m[0]).abs() - 0.22 * 1.7).abs() < 1e-9 && z == bench.xyz_m[2]);
        let turned = common::yaw(track[0].quaternion) - common::yaw(bench.quaternion);
        assert!(frames::wrap_pi(turned).abs() < 1e-9);
        taken.push((on, x > bench.xyz_m[0]));
    }
    let all = taken.len();
    taken.sort_unstable();
    taken.dedup();
    assert!(all >= 12 && taken.len() == all, "{all} sit, on {} places", taken.len());
    let both = taken.windows(2).filter(|pair| pair[0].0 == pair[1].0).count();
    assert!(both >= 2, "{both} benches have two on them");
    // Passing walkers keep off them.
    assert_eq!(overlaps(&log), []);
}
