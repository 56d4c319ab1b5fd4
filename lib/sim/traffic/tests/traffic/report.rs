//! The measures of `traffic-report` on small films made by hand, in which everything that happens is known.
#![allow(dead_code, reason = "the report prints more than is checked here")]

#[path = "../../examples/traffic-report/film.rs"]
mod film;
#[path = "../../examples/traffic-report/lights.rs"]
mod lights;
#[path = "../../examples/traffic-report/motion.rs"]
mod motion;
#[path = "../../examples/traffic-report/people.rs"]
mod people;
#[path = "../../examples/traffic-report/scenes.rs"]
mod scenes;
#[path = "../../examples/traffic-report/standing.rs"]
mod standing;
#[path = "../../examples/traffic-report/things.rs"]
mod things;
#[path = "../../examples/traffic-report/touching.rs"]
mod touching;

use std::f64::consts::{FRAC_PI_2, PI};

use crate::common::{crossing, straight, two_lanes};
use catalogue::models;
use film::Film;
use frames::math::{cos, sin, sin_cos};
use frames::{Object, Pose, World};
use opendrive::{Map, MarkType};
use schema::tables::{ActorRow, SignalRow, StateRow};
use schema::{ActorKind, SignalState};
use traffic::SimulationLog;

/// Middle, yaw and speed along it.
type PlanarState = (f64, f64, f64, f64);

/// A film in the making; state `i` is at `i` times 0.05 s.
struct Shot {
    log: SimulationLog,
    states: usize,
}

impl Shot {
    fn new(seconds: f64) -> Self {
        Self { log: SimulationLog::default(), states: (20.0 * seconds).round() as usize }
    }

    /// Adds an actor of a model that is driven as told; returns the id.
    fn add(&mut self, model: &str, driver: &str, place: impl Fn(f64) -> PlanarState) -> u16 {
        let id = self.log.actors.len() as u16 + 1;
        let known = models::find(model).expect("a model");
        self.log.actors.push(ActorRow {
            id,
            kind: if model.starts_with("walker") { ActorKind::Walker } else { ActorKind::Vehicle },
            model: model.into(),
            length_m: known.size_m[0],
            width_m: known.size_m[1],
            height_m: known.size_m[2],
            attributes: format!("{{\"{driver}\":\"true\"}}").parse().expect("an object of strings"),
            ..ActorRow::default()
        });
        for i in 0..self.states {
            let (x, y, yaw, speed) = place(0.05 * i as f64);
            let (sin, cos) = sin_cos(yaw);
            self.log.states.push(StateRow {
                frame: i as i32 - 1,
                id,
                xyz_m: [x, y, 0.0],
                quaternion: Pose::<World, Object>::from_xyz_rpy([0.0; 3], [0.0, 0.0, yaw]).wxyz(),
                velocity_mps: [(speed * cos) as f32, (speed * sin) as f32, 0.0],
                ..StateRow::default()
            });
        }
        id
    }

    fn car(&mut self, place: impl Fn(f64) -> PlanarState) -> u16 {
        self.add("car.sedan", "ordinary", place)
    }

    /// What a light shows over time.
    fn light(&mut self, id: &str, state: impl Fn(f64) -> SignalState) {
        self.lights(id, 1, state);
    }

    /// The same of a light with several heads, in the order of the log.
    fn lights(&mut self, id: &str, heads: u16, state: impl Fn(f64) -> SignalState) {
        let rows = (0..self.states).flat_map(|i| (0..heads).map(move |head| (i, head)));
        self.log.signals.extend(rows.map(|(i, head)| SignalRow {
            frame: i as i32 - 1,
            id: 900 + head,
            state: state(0.05 * i as f64),
            opendrive_id: id.into(),
        }));
    }

    fn film<'a>(&self, map: &'a Map) -> Film<'a> {
        Film::new(map, &self.log)
    }

    fn touching(&self, map: &Map) -> touching::Touching {
        touching::find(&mut self.film(map))
    }
}

fn still(x: f64, y: f64, yaw: f64) -> impl Fn(f64) -> PlanarState {
    move |_| (x, y, yaw, 0.0)
}

fn east(x: f64, y: f64, speed: f64) -> impl Fn(f64) -> PlanarState {
    move |t| (x + speed * t, y, 0.0, speed)
}

#[test]
fn a_collision_is_seen_when_it_happens_and_told_by_who_drives() {
    let map = straight(300.0);
    for (driver, ordinary, unruly) in [("ordinary", 1, 0), ("reckless", 0, 1), ("distracted", 0, 1)] {
        let mut shot = Shot::new(6.0);
        let stands = shot.car(still(60.0, -1.75, 0.0));
        let hits = shot.add("car.sedan", driver, east(20.0, -1.75, 10.0));
        let found = shot.touching(&map);
        assert_eq!((found.ordinary.len(), found.unruly), (ordinary, unruly), "{driver}");
        // Two halves of 4.7 m, and 2 cm of rounding: at 55.32 m, after 3.53 s.
        assert!(found.ordinary.iter().all(|f| *f == (71, stands, hits)), "{:?}", found.ordinary);
    }
    // On the other lane it passes.
    let mut shot = Shot::new(6.0);
    shot.car(still(60.0, 1.75, PI));
    shot.car(east(20.0, -1.75, 10.0));
    assert_eq!((shot.touching(&map).ordinary, shot.touching(&map).unruly), (vec![], 0));
}

#[test]
fn boxes_touch_by_their_sides_not_by_their_circles() {
    let map = straight(300.0);
    // Half a length and half a width: 2.35 + 0.92; vehicles 2 cm apart count as touching.
    for (gap, touches) in [(3.28, 1), (3.30, 0)] {
        let mut shot = Shot::new(1.0);
        shot.car(still(60.0, 0.0, 0.0));
        shot.car(still(60.0 + gap, 0.0, FRAC_PI_2));
        assert_eq!(shot.touching(&map).ordinary.len(), touches, "{gap}");
    }
    // At 45 degrees the first one's corner meets the other's long side: across that, 0.92 + (2.35 + 0.92) /
    // sqrt 2.
    let reach = 2f64.sqrt() * 0.92 + (2.35 + 0.92);
    for (gap, touches) in [(reach + 0.01, 1), (reach + 0.04, 0)] {
        let mut shot = Shot::new(1.0);
        shot.car(still(60.0, 0.0, 0.0));
        shot.car(still(60.0 + gap, 0.0, 0.25 * PI));
        assert_eq!(shot.touching(&map).ordinary.len(), touches, "{gap}");
    }
}

#[test]
fn walkers_are_told_from_vehicles_and_wrecks_from_innocents() {
    let map = straight(300.0);
    let mut shot = Shot::new(6.0);
    shot.add("walker.man", "ordinary", still(60.0, -1.75, 0.0));
    shot.add("walker.woman", "ordinary", still(100.0, 5.0, 0.0));
    shot.add("walker.child", "ordinary", still(100.2, 5.1, 0.0));
    shot.car(east(20.0, -1.75, 10.0));
    // The second one runs into the wreck of the first one.
    shot.add("car.sedan", "reckless", still(150.0, -1.75, 0.0));
    shot.car(still(154.0, -1.75, 0.0));
    let found = shot.touching(&map);
    assert_eq!((found.vehicle_walker.len(), found.walker_walker, found.unruly), (1, 1, 1));
    assert_eq!(found.ordinary, []);
}

/// West along the arm in the east of the crossing, whose line is at 10 m.
fn towards_line(from: f64, speed: f64, start_s: f64) -> impl Fn(f64) -> PlanarState {
    move |t| {
        let gone = speed * (t - start_s).max(0.0);
        (from - gone, 1.75, PI, if t > start_s { speed } else { 0.0 })
    }
}

#[test]
fn lights_are_run_at_red_alone() {
    let map = crossing(true);
    for (shows, driver, runs, unruly) in [
        (SignalState::Red, "ordinary", 1, 0),
        (SignalState::Red, "reckless", 0, 1),
        (SignalState::Yellow, "ordinary", 0, 0),
        (SignalState::Green, "ordinary", 0, 0),
    ] {
        let mut shot = Shot::new(8.0);
        let id = shot.add("car.sedan", driver, towards_line(60.0, 10.0, 0.0));
        shot.light("s0", |_| shows);
        let found = lights::measure(&shot.film(&map));
        assert_eq!(
            (found.red_runs.len(), found.unruly_runs, found.passages),
            (runs, unruly, 1),
            "{shows} {driver}"
        );
        // The front is at the line when the middle is 2.35 m before it: after 4.765 s.
        assert!(found.red_runs.iter().all(|r| *r == (96, id)), "{:?}", found.red_runs);
    }
    // A vehicle that stops before the line passes nothing; nor does one that stops with the rear on it when
    // the light turns.
    let mut shot = Shot::new(8.0);
    shot.car(|t| (60.0 - 10.0 * t.min(4.7), 1.75, PI, if t < 4.7 { 10.0 } else { 0.0 }));
    shot.light("s0", |_| SignalState::Red);
    assert_eq!(lights::measure(&shot.film(&map)).passages, 0);
}

#[test]
fn second_heads_of_a_light_show_what_it_shows_then() {
    let map = crossing(true);
    // The line is passed after 4.8 s, when the light has been green for half a second; before that it was
    // red for as long as it is green after.
    for (heads, turns_s, runs) in [(1, 4.3, 0), (2, 4.3, 0), (3, 4.3, 0), (2, 5.3, 1)] {
        let mut shot = Shot::new(9.0);
        shot.car(towards_line(60.0, 10.0, 0.0));
        shot.lights("s0", heads, |t| if t < turns_s { SignalState::Red } else { SignalState::Green });
        let found = lights::measure(&shot.film(&map));
        assert_eq!((found.red_runs.len(), found.passages), (runs, 1), "{heads} heads, {turns_s} s");
    }
}

#[test]
fn people_turn_and_push_off_as_told() {
    let map = straight(300.0);
    let mut shot = Shot::new(4.0);
    // Walks at 1.5 m/s for 2 s, brakes at 3 m/s2, and turns round at 2 rad/s.
    shot.add("walker.man", "ordinary", |t| {
        let b = (t - 2.0).clamp(0.0, 0.5);
        (20.0 + 1.5 * t.min(2.5) - 1.5 * b * b, 5.0, 2.0 * (t - 2.6).clamp(0.0, 1.0), 1.5 - 3.0 * b)
    });
    // Rolls round on a circle of 1 m at 1 m/s.
    shot.add("walker.wheelchair", "ordinary", |t| {
        let (sin, cos) = sin_cos(t);
        (80.0 + sin, 6.0 - cos, t, 1.0)
    });
    let found = people::measure(&shot.film(&map));
    let most = |values: &[f64]| values.iter().copied().fold(0.0, f64::max);
    let close = |a: f64, b: f64| (a - b).abs() < 0.01 * b;
    let (feet, wheels) = (&found.on_foot, &found.rolling);
    assert!(close(most(&feet.speed_mps), 1.5) && close(most(&feet.acceleration), 3.0));
    assert!(close(most(&feet.turn_standing_degps), 114.6) && most(&feet.turn_walking_degps) < 1e-6);
    assert!(close(most(&wheels.turn_walking_degps), 57.3) && wheels.turn_standing_degps.is_empty());
    assert!(close(most(&wheels.acceleration), 1.0) && close(most(&wheels.speed_mps), 1.0));
    // Half of a step's turn of 0.05 rad.
    assert!(close(most(&wheels.aside), 0.025), "{}", most(&wheels.aside));
}

/// The bars of docs/traffic.md on towns of ours with turn pockets and second heads of lights, and with
/// motorways: by what the log says of whoever is neither reckless nor hit.
#[test]
fn nobody_ordinary_moves_as_nobody_can() {
    for (name, seconds) in [("convoy/03", 50.0), ("convoy/06", 25.0)] {
        let plans = scenes::plans(&[name.to_owned()], &(101..=101), seconds);
        let (map, fixed, log) = plans[0].simulate();
        let heads = fixed.iter().filter(|a| a.kind == ActorKind::TrafficLight);
        let mut signals: Vec<&str> = heads.filter_map(|a| a.opendrive_id.as_deref()).collect();
        let all = signals.len();
        signals.sort_unstable();
        signals.dedup();
        assert!(all > signals.len() + 3, "{name}: {all} heads of {} lights", signals.len());
        let mut film = Film::new(&map, &log);
        let touching = touching::find(&mut film);
        assert_eq!((touching.ordinary, touching.vehicle_walker), (vec![], vec![]), "{name}");
        assert_eq!(touching.walker_walker, 0, "{name}");
        let lights = lights::measure(&film);
        assert_eq!(lights.red_runs, [], "{name}");
        assert!(name != "convoy/03" || lights.passages > 20, "{name}: {} passages", lights.passages);
        let fixed: Vec<&ActorRow> = fixed.iter().collect();
        let inside = things::measure(&film, &fixed);
        assert!(inside.walkers.is_empty() && inside.vehicles.is_empty(), "{name}: {inside:?}");

        let motion = motion::measure(&film);
        let share = |values: &[f64], share: f64| {
            let mut values = values.to_vec();
            values.sort_by(f64::total_cmp);
            values[(share * (values.len() - 1) as f64) as usize]
        };
        assert!(motion.sideways.len() > 50_000);
        assert!(share(&motion.sideways, 1.0) < 4.0, "{name}: {:?}", motion.worst_sideways);
        let braking = share(&motion.acceleration, 0.001);
        assert!(braking > -4.5, "{name}: one sample of a thousand below {braking}");
        let jerk: Vec<f64> = motion.jerk.iter().map(|j| j.abs()).collect();
        assert!(share(&jerk, 0.999) < 13.0, "{name}: {}", share(&jerk, 0.999));

        let people = people::measure(&film);
        let bars = [(&people.on_foot, [180.0, 90.0], 3.4), (&people.rolling, [60.0, 60.0], 2.01)];
        for (moves, [standing, walking], speed_mps) in bars {
            let most = |values: &[f64]| values.iter().copied().fold(0.0, f64::max);
            assert!(most(&moves.turn_standing_degps) < standing + 0.1, "{name}: {:?}", moves.worst_turn);
            assert!(most(&moves.turn_walking_degps) < walking + 0.1, "{name}: {:?}", moves.worst_turn);
            let pushes = most(&moves.acceleration);
            assert!(pushes < 3.0 && most(&moves.upwards) < 1.5, "{name}: {:?}", moves.worst_acceleration);
            assert!(most(&moves.speed_mps) < speed_mps, "{name}");
        }
        assert!(most_aside(&people.rolling) < 0.1, "{name}: wheels slide");
        assert!(people.on_foot.acceleration.len() > 20_000 && !people.rolling.speed_mps.is_empty(), "{name}");
    }
}

fn most_aside(moves: &people::Moves) -> f64 {
    moves.aside.iter().copied().fold(0.0, f64::max)
}

#[test]
fn headways_are_those_of_the_queue_from_the_fourth_car_on() {
    let map = crossing(true);
    let queue = |models: [&str; 6]| {
        let mut shot = Shot::new(25.0);
        for (k, model) in models.into_iter().enumerate() {
            // 1 m before the line and 8 m behind one another; each sets off a second after the one before, at
            // 8 m/s.
            let k = k as f64;
            let half = 0.5 * models::find(model).expect("a model").size_m[0];
            shot.add(model, "ordinary", towards_line(11.0 + half + 8.0 * k, 8.0, 5.0 + k));
        }
        shot.light("s0", |t| if t < 5.0 { SignalState::Red } else { SignalState::Green });
        lights::measure(&shot.film(&map))
    };
    let found = queue(["car.sedan"; 6]);
    assert_eq!(found.passages, 6);
    assert_eq!(found.headways_s.len(), 3, "{:?}", found.headways_s);
    assert!(found.headways_s.iter().all(|h| (h - 2.0).abs() < 0.051), "{:?}", found.headways_s);
    // A bus ends the count: its time is not a car's.
    let mut models = ["car.sedan"; 6];
    models[4] = "bus.city";
    assert_eq!(queue(models).headways_s.len(), 1);
}

#[test]
fn accelerations_and_speeds_are_those_that_were_driven() {
    let map = straight(600.0);
    // 12 m/s, from 8 s on braking at 3 m/s2 for 2 s, then 6 m/s.
    let speed = |t: f64| 12.0 - 3.0 * (t - 8.0).clamp(0.0, 2.0);
    let along = |t: f64| {
        let b = (t - 8.0).clamp(0.0, 2.0);
        20.0 + 12.0 * t - 1.5 * b * b - 6.0 * (t - 10.0).max(0.0)
    };
    let mut shot = Shot::new(20.0);
    let id = shot.car(|t| (along(t), -1.75, 0.0, speed(t)));
    let found = motion::measure(&shot.film(&map));
    let (braking, state, who) = found.worst_braking.expect("it brakes");
    assert!((braking + 3.0).abs() < 1e-3 && (161..=200).contains(&state) && who == id);
    assert!(found.acceleration.iter().all(|a| (-3.001..0.001).contains(a)));
    assert!(found.sideways.iter().chain(&found.slide_mps).all(|v| v.abs() < 1e-6));
    // 50 km/h is 13.89 m/s: in free flow at 12 m/s, and 4 s after the braking at 6 m/s.
    assert!(found.free_flow.len() > 5);
    let of = |v: f64| found.free_flow.iter().any(|f| (f - v / 13.889).abs() < 1e-3);
    assert!(of(12.0) && of(6.0), "{:?}", found.free_flow);

    // Behind somebody nobody is free.
    let mut shot = Shot::new(20.0);
    shot.car(east(20.0, -1.75, 12.0));
    let free = motion::measure(&shot.film(&map)).free_flow.len();
    shot.car(east(60.0, -1.75, 12.0));
    assert_eq!(motion::measure(&shot.film(&map)).free_flow.len(), free);
}

#[test]
fn offsets_slides_and_lane_changes_are_told_apart() {
    let map = two_lanes(MarkType::Broken, None);
    // 0.8 m aside and back, straight ahead all the time.
    let aside = |t: f64| 0.8 * sin(PI * t / 16.0) * sin(PI * t / 16.0);
    let mut shot = Shot::new(16.0);
    let id = shot.car(|t| (20.0 + 10.0 * t, -1.75 + aside(t), 0.0, 10.0));
    let found = motion::measure(&shot.film(&map));
    let worst = found.worst_offset.expect("an offset");
    assert!((worst.0 - 0.8).abs() < 0.01 && worst.2 == id && found.lane_changes == 0, "{worst:?}");
    // The slope's greatest value is 0.8 pi / 16.
    let slide = found.slide_mps.iter().copied().fold(0.0, f64::max);
    assert!((slide - 0.8 * PI / 16.0).abs() < 1e-3, "{slide}");

    // From one lane to the other within 4 s, looking where it goes, about its rear axle.
    let y = |t: f64| -1.75 - 3.5 * 0.5 * (1.0 - cos(PI * ((t - 5.0) / 4.0).clamp(0.0, 1.0)));
    let yaw = |t: f64| frames::math::atan2(y(t + 1e-4) - y(t - 1e-4), 2e-3);
    let half = 0.5 * models::find("car.sedan").expect("a model").wheelbase_m;
    let mut shot = Shot::new(16.0);
    shot.car(|t| {
        let (sin, cos) = sin_cos(yaw(t));
        (20.0 + 10.0 * t + half * cos, y(t) + half * sin, yaw(t), 10.0)
    });
    let found = motion::measure(&shot.film(&map));
    assert_eq!(found.lane_changes, 1);
    assert!(found.worst_offset.is_some_and(|w| w.0 < 0.26), "{:?}", found.worst_offset);
    let slide = found.slide_mps.iter().copied().fold(0.0, f64::max);
    assert!(slide < 0.02, "{slide}");
}

#[test]
fn whoever_stands_has_the_reason_that_is_there() {
    let map = crossing(true);
    let reasons = |shows: SignalState, with_walker: bool, leader: bool| {
        let mut shot = Shot::new(20.0);
        // The first one's front is 1.5 m before the line.
        shot.car(still(13.85, 1.75, PI));
        if leader {
            shot.car(still(13.85 + 8.0, 1.75, PI));
        }
        if with_walker {
            shot.add("walker.man", "ordinary", still(6.0, 1.75, 0.0));
        }
        shot.light("s0", |_| shows);
        standing::measure(&shot.film(&map))
    };
    let alone = reasons(SignalState::Red, false, false);
    assert_eq!(alone.reasons.keys().copied().collect::<Vec<_>>(), ["light"]);
    assert!(alone.faults.is_empty() && alone.gridlock.is_none_or(|g| g.0 < 0.6), "{:?}", alone.gridlock);
    assert!(alone.longest.is_some_and(|l| (l.0 - 19.5).abs() < 0.6), "{:?}", alone.longest);
    let queue = reasons(SignalState::Red, false, true);
    assert_eq!(queue.reasons.keys().copied().collect::<Vec<_>>(), ["leader", "light"]);
    assert_eq!(queue.reasons["leader"], queue.reasons["light"]);
    assert_eq!(
        reasons(SignalState::Green, true, false).reasons.keys().copied().collect::<Vec<_>>(),
        ["walker"]
    );
    // At green with nobody there: a fault at each look after the first 3 s.
    let idle = reasons(SignalState::Green, false, false);
    assert_eq!(idle.reasons.keys().copied().collect::<Vec<_>>(), ["none"]);
    assert_eq!((idle.faults.len(), idle.faults[0]), (34, (60, 1)));
    assert!(idle.gridlock.is_some_and(|g| (g.0 - 19.5).abs() < 0.6), "{:?}", idle.gridlock);
    // The road ends 2 m ahead.
    let mut shot = Shot::new(6.0);
    shot.car(still(295.0, -1.75, 0.0));
    let road = straight(300.0);
    let found = standing::measure(&shot.film(&road));
    assert_eq!(found.reasons.keys().copied().collect::<Vec<_>>(), ["dead end"]);
}

#[test]
fn walkers_in_things_are_found_by_what_is_drawn() {
    let map = straight(300.0);
    let thing = |id: u16, kind: ActorKind, model: &str, size: [f64; 3], at: [f64; 3]| ActorRow {
        id,
        kind,
        model: model.into(),
        length_m: size[0],
        width_m: size[1],
        height_m: size[2],
        xyz_m: at,
        quaternion: [1.0, 0.0, 0.0, 0.0],
        ..ActorRow::default()
    };
    let fixed = [
        thing(101, ActorKind::Building, "building.block", [12.0, 20.0, 15.0], [60.0, 20.0, -0.1]),
        thing(102, ActorKind::Parked, "car.wagon", [4.78, 1.83, 1.48], [100.0, 5.0, 0.0]),
        thing(103, ActorKind::Vegetation, "tree.round", [5.0, 5.0, 7.0], [140.0, 5.0, 0.0]),
        // Its pole stands at the rear end of its box, 1.07 m west of the middle; the lamp hangs over the
        // others.
        thing(104, ActorKind::Pole, "pole.lamp", [2.4, 0.28, 7.5], [181.07, 5.0, 0.0]),
        thing(105, ActorKind::Surface, "surface.road", [300.0, 300.0, 0.0], [150.0, 0.0, 0.0]),
    ];
    let fixed: Vec<&ActorRow> = fixed.iter().collect();
    for (y, found) in [
        // Through the car, the trunk and the pole, then half a metre beside the car and past all, then in the
        // house.
        (5.0, vec![102, 103, 104]),
        (6.35, vec![]),
        (20.0, vec![101]),
    ] {
        let mut shot = Shot::new(180.0);
        shot.add("walker.man", "ordinary", |t| (30.0 + t, y, 0.0, 1.0));
        let inside = things::measure(&shot.film(&map), &fixed).walkers;
        let ids: Vec<u16> = inside.iter().map(|i| i.2).collect();
        assert_eq!(ids, found, "{inside:?}");
        for (state, _, id, _) in inside {
            // Half a second between looks, and no earlier than the boxes meet.
            let [x, half] = match id {
                101 => [60.0, 6.0],
                102 => [100.0, 2.39],
                103 => [140.0, 0.4],
                _ => [180.0, 0.15],
            };
            let at = 30.0 + 0.05 * state as f64;
            assert!((at - (x - half - 0.2)).abs() < 0.9, "{id} at {at}");
        }
    }
    // A car into the parked one, and one that passes it.
    for (y, found) in [(5.0, vec![102]), (7.0, vec![])] {
        let mut shot = Shot::new(30.0);
        shot.add("car.sedan", "ordinary", |t| (80.0 + t, y, 0.0, 1.0));
        let inside = things::measure(&shot.film(&map), &fixed).vehicles;
        assert_eq!(inside.iter().map(|i| i.2).collect::<Vec<_>>(), found, "{inside:?}");
    }
}
