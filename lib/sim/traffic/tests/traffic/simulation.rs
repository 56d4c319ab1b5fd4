//! Scenes on hand-made networks and, where they are at hand, on real maps.

use crate::common;

use crate::common::{
    agent, agents_on, collisions, crest, crossing, ending_lane, red_runs, run, scene, settings, straight,
    tracks, two_lanes,
};
use nalgebra::Point3;
use opendrive::{LaneId, LaneInfo, LanePos, Map, MarkType};
use schema::tables::{PlanAgentRow, Weather};
use schema::{ActorKind, Attribute, SignalState, lights};
use traffic::{Idm, SimulationLog, equilibrium_gap_m};

fn assert_sound(log: &SimulationLog, frames: u32) {
    let moving = log.actors.iter().filter(|a| !a.fixed).count();
    assert_eq!(log.states.len(), moving * (frames as usize + 1));
    assert!(log.states.windows(2).all(|p| (p[0].frame, p[0].id) < (p[1].frame, p[1].id)));
    assert_eq!((log.states[0].frame, log.states[log.states.len() - 1].frame), (-1, frames as i32 - 1));
    assert_eq!(log.frames.len(), frames as usize);
    for pair in tracks(log).values().flat_map(|t| t.windows(2)) {
        let moved = Point3::from(pair[1].xyz_m) - Point3::from(pair[0].xyz_m);
        // 90 km/h and a little: nobody jumps.
        assert!(moved.norm() < 0.05 * 25.0 + 0.1, "{:?} {:?}", pair[0], pair[1]);
    }
    for s in &log.states {
        let numbers = s.xyz_m.iter().chain(&s.quaternion).all(|v| v.is_finite());
        assert!(
            numbers
                && s.velocity_mps.iter().all(|v| v.is_finite())
                && s.phase_rad.is_finite()
                && s.steer_rad.is_finite()
        );
    }
}

/// Where lanes end apart from the lanes they are linked to: vehicles change over before.
fn apart(map: &Map) -> Vec<Point3<f64>> {
    let end = |l: &LaneInfo| map.point_at(LanePos { lane: l.id, along_m: l.s_length() }).map(|p| p.position);
    let start = |&lane: &LaneId| map.point_at(LanePos { lane, along_m: 0.0 }).map(|p| p.position);
    let lanes = map.lanes().iter().filter(|l| l.lane_type.is_drivable());
    let links = lanes.flat_map(|l| map.successors(l.id).iter().map(move |to| (end(l), start(to))));
    links.filter_map(|(a, b)| Some((a?, b?))).filter(|(a, b)| (a - b).norm() > 0.1).map(|(a, _)| a).collect()
}

/// Largest distance of a vehicle from the middle of a driving lane, but for the 30 m before lane ends that
/// lie apart, and for lane changes (blinking outside junctions).
fn worst_offset(map: &Map, log: &SimulationLog) -> f64 {
    let apart = apart(map);
    let vehicles: Vec<u16> =
        log.actors.iter().filter(|a| a.kind == ActorKind::Vehicle).map(|a| a.id).collect();
    let sampled = log.states.iter().filter(|s| {
        let far = || apart.iter().all(|p| (p - Point3::from(s.xyz_m)).norm() > 30.0);
        s.frame % 10 == 0 && vehicles.binary_search(&s.id).is_ok() && far()
    });
    let offset = |s: &schema::tables::StateRow| {
        let Some(hit) = map.nearest_driving_lane(Point3::from(s.xyz_m)) else { return f64::INFINITY };
        let blinks = s.lights & (lights::BLINK_LEFT | lights::BLINK_RIGHT) != 0;
        let changes = blinks && map.lane(hit.lane).is_some_and(|l| l.junction.is_none());
        if changes { 0.0 } else { hit.distance_m }
    };
    sampled.map(offset).fold(0.0, f64::max)
}

#[test]
fn a_follower_keeps_its_gap() {
    let map = straight(1200.0);
    let mut agents = vec![agent(0, [60.0, -1.75, 0.0], 0.0), agent(1, [20.0, -1.75, 0.0], 0.0)];
    agents[0].speed_difference = 0.5;
    let log = run(&map, &scene(40.0), &agents, &settings());
    assert_sound(&log, 800);
    let tracks = tracks(&log);
    let [leader, follower] = [&tracks[&1], &tracks[&2]].map(|t| t[t.len() - 1]);
    let gap = leader.xyz_m[0] - follower.xyz_m[0] - 4.7;
    let idm = Idm { acceleration: 2.5, braking: 2.5, headway_s: 0.6, standstill_gap_m: 4.0 };
    let expected = equilibrium_gap_m(&idm, 0.5 * 50.0 / 3.6, 50.0 / 3.6);
    assert!((gap - expected).abs() < 0.3, "{gap} instead of {expected}");
    assert!((f64::from(follower.velocity_mps[0]) - 25.0 / 3.6).abs() < 0.1);
    // Wheels turn with the way.
    let way = follower.xyz_m[0] - 20.0;
    assert!(
        (f64::from(follower.phase_rad) - way / 0.33).abs() < 0.1,
        "{} {}",
        follower.phase_rad,
        way / 0.33
    );
    assert!(collisions(&log, false).is_empty());
}

#[test]
fn a_lane_that_ends_beside_its_successor_is_left_as_in_a_lane_change() {
    let map = ending_lane();
    let log = run(&map, &scene(20.0), &[agent(0, [20.0, -5.25, 0.0], 0.0)], &settings());
    let tracks = tracks(&log);
    let track = &tracks[&1];
    assert!(track[track.len() - 1].xyz_m[0] > 150.0);
    for state in track {
        // Eight metres of way for each of the 3.5 m aside, before the lane's end at 100 m.
        let u = ((state.xyz_m[0] - 72.0) / 28.0).clamp(0.0, 1.0);
        let expected = -5.25 + 3.5 * u * u * (3.0 - 2.0 * u);
        assert!((state.xyz_m[1] - expected).abs() < 0.02, "{:?}, not {expected}", state.xyz_m);
        assert!(state.velocity_mps[1].abs() < 3.0);
    }
}

#[test]
fn bodies_pitch_as_speed_changes_and_lie_level_at_rest() {
    let log = run(&straight(300.0), &scene(40.0), &[agent(0, [20.0, -1.75, 0.0], 0.0)], &settings());
    let track = &tracks(&log)[&1];
    let pitch = |i: usize| {
        let [w, x, y, z] = track[i].quaternion;
        frames::math::asin(2.0 * (w * y - z * x))
    };
    let mut nose_up: f64 = 0.0;
    for i in 20..800 {
        // Half a second of steady acceleration: the springs are at rest, 0.0035 rad per m/s2.
        let speed = |k: usize| f64::from(track[k].velocity_mps[0]);
        let (now, before) = ((speed(i) - speed(i - 1)) / 0.05, (speed(i - 19) - speed(i - 20)) / 0.05);
        if (now - before).abs() < 0.1 {
            assert!((pitch(i) + 0.0035 * now).abs() < 1.5e-3, "{} at {now} m/s2", pitch(i));
        }
        nose_up = nose_up.min(pitch(i));
    }
    assert!(nose_up < -0.006 && pitch(800).abs() < 1e-4, "{nose_up} {}", pitch(800));
}

#[test]
fn a_slower_vehicle_is_passed_where_the_marks_allow_it() {
    let mut agents = vec![agent(0, [60.0, -5.25, 0.0], 0.0), agent(1, [20.0, -5.25, 0.0], 0.0)];
    agents[0].speed_difference = 0.6;
    for (marks, passes) in [(MarkType::Broken, true), (MarkType::Solid, false)] {
        let log = run(&two_lanes(marks, None), &scene(30.0), &agents, &settings());
        assert_sound(&log, 600);
        assert_eq!(collisions(&log, false), []);
        let tracks = tracks(&log);
        let [slow, fast] = [1, 2].map(|id| &tracks[&id]);
        assert_eq!(fast[600].xyz_m[0] > slow[600].xyz_m[0] + 50.0, passes);
        let left = fast.iter().any(|s| s.xyz_m[1] > -2.0);
        assert_eq!(left, passes);
        // Over in about 3.7 s, a little faster as it gains speed: sideways at most 15/8 of the mean (a
        // quintic).
        let sideways = |i: usize| (fast[i].xyz_m[1] - fast[i - 1].xyz_m[1]) / 0.05;
        let fastest = (1..601).map(|i| sideways(i).abs()).fold(0.0, f64::max);
        assert!(fastest < 2.2, "{fastest}");
        let pushed = (2..601).map(|i| (sideways(i) - sideways(i - 1)).abs() / 0.05).fold(0.0, f64::max);
        assert!(pushed < 3.0, "no more than in curves: {pushed}");
        // It blinks while it goes over, to the side that it goes to.
        for (i, state) in fast.iter().enumerate().skip(1).filter(|(i, _)| sideways(*i).abs() > 0.3) {
            let blinker = if sideways(i) > 0.0 { lights::BLINK_LEFT } else { lights::BLINK_RIGHT };
            assert!(state.lights & blinker != 0, "{state:?}");
        }
    }
}

#[test]
fn two_full_lanes_zip_into_one() {
    let map = two_lanes(MarkType::Broken, Some(200.0));
    let mut agents = Vec::new();
    for k in 0..8 {
        for (lane, y) in [-1.75, -5.25].into_iter().enumerate() {
            agents.push(agent(2 * k + lane, [150.0 - 16.0 * k as f64 - 3.0 * lane as f64, y, 0.0], 0.0));
        }
    }
    let log = run(&map, &scene(80.0), &agents, &settings());
    assert_sound(&log, 1600);
    assert_eq!(collisions(&log, false), []);
    let tracks = tracks(&log);
    // Nobody stays behind at the end of the lane.
    for (id, track) in &tracks {
        assert!(track[1600].xyz_m[0] > 300.0, "{id} is at {:?}", track[1600].xyz_m);
    }
}

#[test]
fn over_a_crest_the_body_turns_about_its_left_axis() {
    let heading = 0.6;
    let map = crest(heading);
    let start = map.lanes().first().and_then(|l| map.lane_point(l.id, 10.0, 0.0)).expect("a lane");
    // Two-wheelers do not pitch on their springs.
    let rider = PlanAgentRow { model: "motorcycle.sport".into(), ..agent(0, start.position.into(), heading) };
    let log = run(&map, &scene(10.0), &[rider], &settings());
    let (sin, cos) = frames::math::sin_cos(heading);
    let tracks = tracks(&log);
    let track = &tracks[&1];
    let mut fastest: f64 = 0.0;
    for pair in track.windows(2) {
        let s = |k: usize| pair[k].xyz_m[0] * cos + pair[k].xyz_m[1] * sin;
        // Nose down is positive: the pitch's tangent is minus the slope 0.4 - 0.004 s.
        let pitch = |k: usize| -frames::math::atan(0.4 - 0.004 * s(k));
        let rate = (pitch(1) - pitch(0)) / 0.05;
        let expected = [-sin * rate, cos * rate, 0.0];
        for (got, wanted) in pair[1].angular_velocity_radps.iter().zip(expected) {
            assert!((f64::from(*got) - wanted).abs() < 1e-3, "{:?}, not {expected:?}", pair[1]);
        }
        fastest = fastest.max(rate);
    }
    assert!(fastest > 0.03, "{fastest}");
}

#[test]
fn a_reckless_driver_runs_into_a_slow_one() {
    let map = straight(600.0);
    let mut agents = vec![agent(0, [60.0, -1.75, 0.0], 0.0), agent(1, [20.0, -1.75, 0.0], 0.0)];
    agents[0].speed_difference = 0.9;
    agents[1].reckless = true;
    let log = run(&map, &scene(20.0), &agents, &settings());
    assert_sound(&log, 400);
    let tracks = tracks(&log);
    let speed = |id: u16, i: usize| tracks[&id][i].velocity_mps[0];
    // Both come to rest, the one hit having been pushed to a higher speed than it ever wished for.
    let pushed = (0..401).map(|i| speed(1, i)).fold(0.0, f32::max);
    assert!(pushed > 2.0, "{pushed}");
    assert!(speed(1, 400).abs() < 0.01 && speed(2, 400).abs() < 0.01);
    // The solver keeps them apart but for a little penetration.
    let gap =
        (0..401).map(|i| tracks[&1][i].xyz_m[0] - tracks[&2][i].xyz_m[0] - 4.7).fold(f64::INFINITY, f64::min);
    assert!((-0.6..0.3).contains(&gap), "{gap}");
}

#[test]
fn signals_are_obeyed_at_a_crossing() {
    let map = crossing(true);
    let mut agents = Vec::new();
    for (arm, (sin, cos)) in
        [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)].into_iter().map(|(c, s)| (s, c)).enumerate()
    {
        for k in 0..3 {
            // On the right of the way in, which is on the left of the arm's outward direction.
            let d = 50.0 + 25.0 * f64::from(k);
            let at = [d * cos - 1.75 * sin, d * sin + 1.75 * cos, 0.0];
            agents.push(agent(3 * arm + k as usize, at, frames::math::atan2(-sin, -cos)));
        }
    }
    let mut settings = settings();
    settings.traffic.green_time_s = Some(6.0);
    let log = run(&map, &scene(40.0), &agents, &settings);
    assert_sound(&log, 800);
    assert_eq!(red_runs(&map, &log, &common::lights(&map)), []);
    assert!(collisions(&log, false).is_empty());
    // Both directions get through in the end.
    let tracks = tracks(&log);
    let through = agents.iter().enumerate().filter(|(i, a)| {
        let last = tracks[&(*i as u16 + 5)].last().expect("states");
        last.xyz_m[0] * a.xyz_m[0] + last.xyz_m[1] * a.xyz_m[1] < 0.0
    });
    assert_eq!(through.count(), agents.len());
    // Opposite lights agree, crossing ones are never both open.
    for frame in log.signals.chunk_by(|a, b| a.frame == b.frame) {
        assert!(frame[0].state == frame[2].state && frame[1].state == frame[3].state);
        assert!(frame[0].state == SignalState::Red || frame[1].state == SignalState::Red);
    }
}

#[test]
fn an_unsignalised_crossing_is_shared_without_touching() {
    let map = crossing(false);
    let mut agents = Vec::new();
    for (arm, (cos, sin)) in [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)].into_iter().enumerate() {
        for k in 0..4 {
            let d = 40.0 + 20.0 * f64::from(k);
            let at = [d * cos - 1.75 * sin, d * sin + 1.75 * cos, 0.0];
            agents.push(agent(4 * arm + k as usize, at, frames::math::atan2(-sin, -cos)));
        }
    }
    let log = run(&map, &scene(40.0), &agents, &settings());
    assert!(collisions(&log, false).is_empty());
    let tracks = tracks(&log);
    let through = agents.iter().enumerate().filter(|(i, a)| {
        let last = tracks[&(*i as u16 + 1)].last().expect("states");
        last.xyz_m[0] * a.xyz_m[0] + last.xyz_m[1] * a.xyz_m[1] < 0.0
    });
    assert_eq!(through.count(), agents.len());
}

#[test]
fn frames_carry_the_weather_and_lamps() {
    let map = straight(300.0);
    let log = run(&map, &scene(4.0), &[agent(0, [20.0, -1.75, 0.0], 0.0)], &settings());
    let first = Weather::default().sun_altitude_deg;
    let last = &log.frames[79];
    assert!((last.sun_altitude_deg + 20.0).abs() < 1e-9 && last.street_lamps);
    assert!(
        (log.frames[0].sun_altitude_deg - (first - (first + 20.0) / 80.0)).abs() < 1e-9
            && !log.frames[0].street_lamps
    );
    assert_eq!(log.states[80].lights & schema::lights::LOW_BEAM, schema::lights::LOW_BEAM);
    assert_eq!(log.states[1].lights & schema::lights::POSITION, 0);
}

#[test]
fn walkers_stay_on_sidewalks_or_cross() {
    let map = straight(400.0);
    let mut scene = scene(30.0);
    scene.walkers = 60;
    scene.background_vehicles = Some(12);
    let log = run(&map, &scene, &[agent(0, [20.0, -1.75, 0.0], 0.0)], &settings());
    assert_sound(&log, 600);
    assert_eq!(log.n_walkers, 60);
    let tracks = tracks(&log);
    let mut crossed = 0;
    for actor in log.actors.iter().filter(|a| a.kind == ActorKind::Walker) {
        let anywhere = actor.attributes.is_true(&Attribute::CrossesAnywhere);
        let track = &tracks[&actor.id];
        let on_road = track.iter().filter(|s| s.xyz_m[1].abs() < 3.5).count();
        crossed += usize::from(on_road > 0);
        assert!(anywhere || on_road == 0);
        assert!(track.iter().all(|s| s.xyz_m[1].abs() < 6.5 && (0.0..=400.0).contains(&s.xyz_m[0])));
        let steps = track.windows(2).map(|p| (Point3::from(p[1].xyz_m) - Point3::from(p[0].xyz_m)).norm());
        assert!(steps.fold(0.0, f64::max) < 0.05 * 12.0);
    }
    assert!(crossed > 5, "{crossed}");
    assert!(collisions(&log, true).is_empty());
}

#[test]
fn towns_run_without_collisions_or_red_light_running() {
    for (name, vehicles, walkers) in [("Town10HD", 60, 80), ("Town03", 120, 80), ("Town02", 50, 40)] {
        let Some(map) = testkit::real_map(name) else { continue };
        for seed in 0..3 {
            let mut scene = scene(16.0);
            scene.seed = 100 + seed;
            scene.background_vehicles = Some(vehicles);
            scene.walkers = walkers;
            let agents = agents_on(&map, 4, 7);
            let log = run(&map, &scene, &agents, &settings());
            assert_sound(&log, 320);
            assert!(log.n_vehicles as i32 > vehicles / 2, "{name}: {}", log.n_vehicles);
            assert_eq!(collisions(&log, false), [], "{name} {seed}");
            assert_eq!(collisions(&log, true), [], "{name} {seed}");
            assert_eq!(red_runs(&map, &log, &common::lights(&map)), [], "{name} {seed}");
            let worst = worst_offset(&map, &log);
            assert!(worst < 0.5, "{name}: {worst}");
            let moved = tracks(&log)
                .values()
                .filter(|t| (Point3::from(t[0].xyz_m) - Point3::from(t[320].xyz_m)).norm() > 20.0)
                .count();
            assert!(moved > vehicles as usize / 2, "{name}: {moved} moved");
        }
    }
}

#[test]
fn a_rerun_gives_the_same_log() {
    let map = crossing(true);
    let mut scene = scene(10.0);
    scene.background_vehicles = Some(12);
    let agents = [agent(0, [50.0, 1.75, 0.0], std::f64::consts::PI)];
    let first = run(&map, &scene, &agents, &settings());
    assert_eq!(first, run(&map, &scene, &agents, &settings()));
    scene.seed += 1;
    assert_ne!(first.states, run(&map, &scene, &agents, &settings()).states);
}
