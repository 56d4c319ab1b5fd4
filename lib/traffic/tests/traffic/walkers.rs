//! Walkers among walkers.

use crate::common;

use std::collections::BTreeMap;

use crate::common::{agent, crossing, run, scene, settings, straight, tracks};
use opendrive::{Cubic, Lane, LaneType, Map, Object};
use schema::tables::StateRow;
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
        for actor in log.actors.iter().filter(|a| a.kind == ActorKind::Walker) {
            let track = &tracks[&actor.id];
            // On the sidewalk, 3.5 to 6.5 m from the middle, with the feet well on it.
            assert!(track.iter().all(|s| (3.75..=6.25).contains(&s.xyz_m[1].abs())), "seed {seed}");
            assert!(track.iter().all(|s| (0.0..=length_m).contains(&s.xyz_m[0])), "seed {seed}");
            // Everybody gets on, in each quarter of a minute.
            for part in track.chunks(300).filter(|c| c.len() == 300) {
                let way: f64 = part.windows(2).map(|p| (p[1].xyz_m[0] - p[0].xyz_m[0]).abs()).sum();
                assert!(way > 3.0, "seed {seed}: {} walks {way} m in 15 s", actor.id);
            }
            // Nobody leaps: aside at most 0.8 m/s, but for what is turned at the ends.
            for pair in track.windows(2) {
                let aside = (pair[1].xyz_m[1] - pair[0].xyz_m[1]).abs() / 0.05;
                assert!(aside < 1.0, "seed {seed}: {aside} m/s aside");
            }
        }
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
