//! How a scene begins: traffic at rest or under way, lights all at the beginning of their cycle or each
//! somewhere in it.

use crate::common::{
    agent, agents_on, collisions, crossing, queues_at_roundabout, roundabout, run, scene, settings, straight,
    tracks,
};
use opendrive::Map;
use schema::SignalState;
use schema::tables::{PlanAgentRow, PlanSceneRow};
use settings::stages::SimulationSettings;

fn moving() -> SimulationSettings {
    let mut settings = settings();
    settings.traffic.moving_start = true;
    settings
}

#[test]
fn traffic_is_at_rest_or_under_way_when_the_simulation_begins() {
    let scene = PlanSceneRow { warmup_s: 0.0, ..scene(10.0) };
    let (mut first, mut second) = (agent(0, [120.0, -1.75, 0.0], 0.0), agent(1, [60.0, -1.75, 0.0], 0.0));
    (first.speed_difference, second.speed_difference) = (0.2, -0.2);
    let speeds = |settings: &SimulationSettings, frame: usize| {
        let log = run(&straight(900.0), &scene, &[first.clone(), second.clone()], settings);
        assert!(collisions(&log, false).is_empty());
        [1, 2].map(|id| f64::from(tracks(&log)[&id][frame + 1].velocity_mps[0]))
    };
    assert!(speeds(&settings(), 0).iter().all(|v| *v < 0.2));
    // 50 km/h: 0.8 of it, and 1.2 of it, for which 60 m less 4.7 m are enough.
    let rolling = speeds(&moving(), 0);
    for (v, wished) in rolling.iter().zip([0.8, 1.2]) {
        assert!((v - wished * 50.0 / 3.6).abs() < 0.2, "{rolling:?}");
    }
    // A vehicle that starts 12 m behind one that goes at 0.8 of the limit follows it and plans to brake with
    // 2 m/s2: s0 + v T + v (v - u) / (2 sqrt(a b)) = (12 - 4.7) sqrt(2 / a).
    second.xyz_m[0] = 108.0;
    let log = run(&straight(900.0), &scene, &[first, second], &moving());
    let follower = &tracks(&log)[&2];
    let u: f64 = 0.8 * 50.0 / 3.6;
    let room_m = 7.3 * (2.0f64 / 2.5).sqrt() - 4.0;
    let half = 0.5 * (5.0 * 0.6 - u);
    let wanted = (half * half + 5.0 * room_m).sqrt() - half;
    assert!((f64::from(follower[1].velocity_mps[0]) - wanted).abs() < 0.2, "{wanted}");
}

#[test]
fn nobody_who_is_under_way_has_to_brake_hard() {
    let queue = |arm: [f64; 2]| {
        (0..5).map(move |k| {
            let d = 40.0 + 22.0 * f64::from(k);
            let at = [d * arm[0] - 1.75 * arm[1], d * arm[1] + 1.75 * arm[0], 0.0];
            (at, frames::math::atan2(-arm[1], -arm[0]))
        })
    };
    let arms = [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]];
    let at_crossing: Vec<PlanAgentRow> =
        arms.into_iter().flat_map(queue).enumerate().map(|(i, (at, yaw))| agent(i, at, yaw)).collect();
    let town = Map::new(town::generate(&town::named("convoy/demo").expect("our town")).expect("roads"));
    let in_town = agents_on(&town, 12, 5);
    let (lit, signed) = (crossing(true), crossing(false));
    let (circle, queues) = (roundabout(18.0, 300.0), queues_at_roundabout(18.0, 6, 20.0, 5));
    let mut scenes =
        vec![(&lit, &at_crossing, 0, 28), (&signed, &at_crossing, 0, 28), (&circle, &queues, 0, 28)];
    scenes.extend((20..40).map(|seed| (&town, &in_town, 40, seed)));
    for (map, agents, background, seed) in scenes {
        let scene =
            PlanSceneRow { warmup_s: 0.0, background_vehicles: Some(background), seed, ..scene(12.0) };
        let log = run(map, &scene, agents, &moving());
        assert!(collisions(&log, false).is_empty());
        let mut fastest: f64 = 0.0;
        for track in tracks(&log).values() {
            let speeds: Vec<f64> = track
                .iter()
                .map(|s| s.velocity_mps.map(|v| f64::from(v) * f64::from(v)))
                .map(|square| (square[0] + square[1]).sqrt())
                .collect();
            fastest = fastest.max(speeds[1]);
            for pair in speeds[1..60].windows(2) {
                assert!((pair[1] - pair[0]) / 0.05 > -4.5, "seed {seed}: {pair:?}");
            }
        }
        assert!(fastest > 8.0, "{fastest}");
    }
}

#[test]
fn lights_begin_together_or_anywhere_in_their_cycle() {
    let map = crossing(true);
    let agents = [agent(0, [100.0, 1.75, 0.0], std::f64::consts::PI)];
    let mut settings = settings();
    (settings.traffic.green_time_s, settings.traffic.yellow_time_s) = (Some(12.0), 3.0);
    settings.traffic.all_red_time_s = 2.0;
    let mut green = 0;
    for seed in 0..120 {
        let plan = PlanSceneRow { seed, warmup_s: 0.0, ..scene(1.0) };
        for offsets in [false, true] {
            settings.traffic.signal_offsets = offsets;
            let log = run(&map, &plan, &agents, &settings);
            // Two controllers: 2 (12 + 3 + 2) s.
            assert!(log.signal_groups.iter().all(|g| (g.cycle_s - 34.0).abs() < 1e-9));
            let start = |id: &str| {
                log.signal_groups.iter().find(|g| g.signals.iter().any(|s| s == id)).expect("a group").start_s
            };
            assert!((0.0..34.0).contains(&start("s0")));
            assert!(((start("s1") - start("s0")).rem_euclid(34.0) - 17.0).abs() < 1e-9);
            assert!(offsets || start("s0") == 0.0);
            for row in &log.signals {
                // Frame 0 is one step after the beginning.
                let since = (0.05 * f64::from(row.frame + 1) - start(&row.opendrive_id)).rem_euclid(34.0);
                let wanted = match since {
                    s if s < 12.0 => SignalState::Green,
                    s if s < 15.0 => SignalState::Yellow,
                    _ => SignalState::Red,
                };
                let at_change = [0.0, 12.0, 15.0, 34.0].iter().any(|t| (since - t).abs() < 1e-6);
                assert!(row.state == wanted || at_change, "{row:?} at {since}");
            }
            let first = log.signals.iter().find(|r| r.opendrive_id == "s0").expect("a state");
            green += u32::from(offsets && first.state == SignalState::Green);
        }
    }
    // 12 of 34 s: 42 of 120, four standard deviations are 21.
    assert!((21..=63).contains(&green), "{green}");
}
