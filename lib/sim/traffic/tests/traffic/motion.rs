//! How vehicles move: as fast as their drivers wish, along their lanes, without sliding sideways.

use crate::common::{
    agent, agents_on, bent_seam, circle, collisions, right_bend, run, scene, settings, tracks, yaw,
};
use catalogue::models;
use frames::math::{atan, sin_cos};
use opendrive::Map;
use schema::ActorKind;
use schema::tables::{PlanAgentRow, PlanSceneRow, StateRow};
use traffic::SimulationLog;

/// Speed in space over the step before a state, m/s.
fn speed(state: &StateRow) -> f64 {
    nalgebra::Vector3::from(state.velocity_mps.map(f64::from)).norm()
}

/// Strongest braking and acceleration of speeds in space, m/s2, of all vehicles of a log that nothing hits.
fn extremes(log: &SimulationLog) -> [f64; 2] {
    let tracks = tracks(log);
    let vehicles = log.actors.iter().filter(|a| a.kind == ActorKind::Vehicle);
    let pairs = vehicles.flat_map(|a| tracks[&a.id].windows(2));
    let rates = pairs.map(|p| (speed(p[1]) - speed(p[0])) / 0.05);
    rates.fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], a| [least.min(a), most.max(a)])
}

#[test]
fn no_seam_makes_a_vehicle_faster_or_slower() {
    let map = bent_seam();
    let mut straddled = 0;
    for k in 0..12 {
        let x = 20.0 + 5.0 * f64::from(k);
        let mut agents = vec![agent(0, [x + 40.0, -5.25, 0.0], 0.0), agent(1, [x, -5.25, 0.0], 0.0)];
        agents[0].speed_difference = 0.6;
        let log = run(&map, &scene(20.0), &agents, &settings());
        assert_eq!(collisions(&log, false), []);
        let track = &tracks(&log)[&2];
        let over =
            |s: &&&StateRow| (148.0..152.0).contains(&s.xyz_m[0]) && (-4.7..-2.3).contains(&s.xyz_m[1]);
        straddled += usize::from(track.iter().any(|s| over(&s)));
        // What drivers can do at most, and the speed limits' ends.
        let [braking, acceleration] = extremes(&log);
        assert!(braking > -8.01 && acceleration < 3.01, "{k}: {braking} {acceleration}");
        // Nor is one pushed sideways: 3 m/s2 of the bend, 2 m/s2 of the way over, and the angle, turned over
        // a metre or so.
        for pair in track.windows(2) {
            let turned = frames::wrap_pi(yaw(pair[1].quaternion) - yaw(pair[0].quaternion));
            assert!(turned.abs() / 0.05 * speed(pair[1]) < 7.0, "{:?}", pair[1]);
        }
    }
    assert!(straddled >= 2, "{straddled} crossed over the seam");
}

/// The speed that a driver wishes for on a free road at a place, m/s: its share of the highest limit of the
/// lanes there, 50 km/h where the map states none; bicycles go no faster than 8 m/s.
fn wish_mps(map: &Map, state: &StateRow, driver: f64, model: &str) -> f64 {
    let lanes = map.lanes_within(state.xyz_m.into(), 2.0, |l| l.lane_type.is_drivable());
    let limits = lanes.iter().filter_map(|hit| map.lane(hit.lane)).map(|l| l.speed_limit_mps);
    let limit = limits.map(|limit| limit.unwrap_or(50.0 / 3.6)).fold(0.0, f64::max);
    let most = if model.starts_with("bicycle.") { 8.0 } else { f64::INFINITY };
    (limit * (1.0 - driver)).min(most)
}

/// Speeds of all vehicles of a log over what their drivers wish for: of all states, and of those who go
/// evenly for a second.
fn speeds_over_wishes(map: &Map, log: &SimulationLog) -> [Vec<f64>; 2] {
    let tracks = tracks(log);
    let mut found = [Vec::new(), Vec::new()];
    for actor in log.actors.iter().filter(|a| a.kind == ActorKind::Vehicle) {
        // Agents are planned to go at the limit.
        let driver = log.drivers.iter().find(|d| d.id == actor.id).map_or(0.0, |d| d.speed_difference);
        for second in tracks[&actor.id].windows(21).step_by(5) {
            let ratio = speed(second[20]) / wish_mps(map, second[20], driver, &actor.model);
            found[0].push(ratio);
            let [least, most] = second
                .iter()
                .map(|s| speed(s))
                .fold([f64::INFINITY, 0.0], |[least, most], v| [v.min(least), v.max(most)]);
            if least > 3.0 && most - least < 0.1 {
                found[1].push(ratio);
            }
        }
    }
    found.iter_mut().for_each(|ratios| ratios.sort_by(f64::total_cmp));
    found
}

#[test]
fn vehicles_go_as_fast_as_their_drivers_wish_on_any_map() {
    let town = town::generate(&town::named("convoy/demo").expect("our town")).expect("a town");
    let real = testkit::real_maps(&["Town10HD", "Town04", "Town06"]);
    for (name, map) in std::iter::once(("convoy/demo", Map::new(town))).chain(real) {
        // A single cyclist before a queue decides what one scene's vehicles do.
        let mut found = [Vec::new(), Vec::new()];
        for seed in [28, 29, 30] {
            let scene = PlanSceneRow { background_vehicles: Some(80), seed, ..scene(40.0) };
            let log = run(&map, &scene, &agents_on(&map, 4, 7), &settings());
            assert_eq!(collisions(&log, false), [], "{name} {seed}");
            let [braking, acceleration] = extremes(&log);
            assert!(braking > -8.05 && acceleration < 3.05, "{name} {seed}: {braking} {acceleration}");
            let of_seed = speeds_over_wishes(&map, &log);
            for (all, new) in found.iter_mut().zip(of_seed) {
                all.extend(new);
            }
        }
        found.iter_mut().for_each(|ratios| ratios.sort_by(f64::total_cmp));
        let [all, even] = found;
        let below = |ratios: &[f64], share: f64| ratios[(share * (ratios.len() - 1) as f64) as usize];
        // Nobody goes faster, but for a moment where a lower limit begins.
        let fastest = [0.999, 1.0].map(|share| below(&all, share));
        assert!(fastest[0] < 1.02 && fastest[1] < 1.15, "{name}: {fastest:?}");
        // Bends, lights and leaders hold up many of those who go evenly; whom nothing does goes as wished.
        let [some, most] = [0.75, 0.9].map(|share| below(&even, share));
        assert!(even.len() > 100 && some > 0.95 && most > 0.98, "{name}: {some} {most} of {}", even.len());
    }
}

#[test]
fn on_a_circle_the_wheels_roll_where_they_point() {
    for (model, radius_m) in
        [("car.sedan", 12.0), ("bus.city", 12.0), ("truck.heavy", 25.0), ("motorcycle.sport", 15.0)]
    {
        let rider = PlanAgentRow { model: model.into(), ..agent(0, [5.0, -1.75, 0.0], 0.0) };
        let log = run(&circle(radius_m), &scene(40.0), &[rider], &settings());
        let base = models::find(model).expect("a model").wheelbase_m;
        // The middle between the axles goes round on the circle, the rear axle on a smaller one about the
        // same point.
        let rear_m = (radius_m * radius_m - 0.25 * base * base).sqrt();
        let expected = atan(base / rear_m);
        let track = &tracks(&log)[&1];
        let mut checked = 0;
        for pair in track.windows(2) {
            let [before, now] = pair else { continue };
            let turn = frames::wrap_pi(yaw(now.quaternion) - yaw(before.quaternion));
            let (sin, cos) = sin_cos(yaw(before.quaternion) + 0.5 * turn);
            let rear = |s: &StateRow| {
                let (sin, cos) = sin_cos(yaw(s.quaternion));
                [s.xyz_m[0] - 0.5 * base * cos, s.xyz_m[1] - 0.5 * base * sin]
            };
            let ([x0, y0], [x1, y1]) = (rear(before), rear(now));
            let slide = ((y1 - y0) * cos - (x1 - x0) * sin) / 0.05;
            assert!(slide.abs() < 0.02, "{model} on {radius_m} m slides at {slide} m/s: {now:?}");
            // Well into the bend, as long as it rolls.
            let in_bend = now.xyz_m[0] < 20.0 && now.xyz_m[1] > radius_m - 1.75 && speed(now) > 1.0;
            if in_bend {
                assert!((f64::from(now.steer_rad) - expected).abs() < 0.01, "{} {expected}", now.steer_rad);
                let rolled = f64::from(now.phase_rad - before.phase_rad);
                let wheel = models::find(model).expect("a model").wheel_radius_m;
                assert!((rolled * wheel - 0.05 * speed(now)).abs() < 1e-3, "{rolled}");
                checked += 1;
            }
        }
        assert!(checked > 20, "{checked} states in the bend");
    }
}

#[test]
fn bodies_roll_out_of_curves_on_their_springs_and_two_wheelers_lean_into_them() {
    for (model, radius_m) in
        [("car.sedan", 25.0), ("bus.city", 25.0), ("motorcycle.sport", 25.0), ("bicycle.city", 20.0)]
    {
        let rider = PlanAgentRow { model: model.into(), ..agent(0, [5.0, -1.75, 0.0], 0.0) };
        let log = run(&circle(radius_m), &scene(40.0), &[rider], &settings());
        let roll_of = |s: &StateRow| {
            let pose = frames::Pose::<frames::World, frames::Object>::from_xyz_wxyz(s.xyz_m, s.quaternion);
            pose.rpy()[0]
        };
        let track = &tracks(&log)[&1];
        let (mut steady, mut most) = (0, 0.0_f64);
        for window in track.windows(41) {
            let (long_ago, before, now) = (window[0], window[39], window[40]);
            // The road is level: all of the roll is the body's, and it comes and goes smoothly.
            let (roll, step) = (roll_of(now), roll_of(now) - roll_of(before));
            assert!(step.abs() < 0.04, "{model} at {}: {step} in a step", now.frame);
            let (v, rate) = (speed(now), f64::from(now.angular_velocity_radps[2]));
            let inward = v * v / radius_m;
            let two_wheeled = model.starts_with("motor") || model.starts_with("bi");
            if two_wheeled {
                assert_eq!(now.lean_rad, [0.0; 2]);
            } else {
                assert!((f64::from(now.lean_rad[0]) - roll).abs() < 1e-6, "{model}: {:?}", now.lean_rad);
            }
            most = most.max(roll.abs());
            // For two seconds round at one speed.
            if (speed(long_ago) - v).abs() < 0.02
                && v > 2.0
                && (rate * radius_m - v).abs() < 0.02 * v
                && window.iter().all(|s| (f64::from(s.angular_velocity_radps[2]) - rate).abs() < 0.01)
            {
                let expected = if two_wheeled { -atan(inward / 9.81) } else { 0.005 * inward };
                assert!((roll - expected).abs() < 0.01 * expected.abs() + 1e-3, "{model}: {roll} {expected}");
                steady += 1;
            }
        }
        assert!(steady >= 5, "{model}: {steady} steady states of {}, at most {most}", track.len());
    }
}

#[test]
fn a_bus_whose_corner_sweeps_the_sidewalk_hits_nobody_there() {
    let radius_m = 10.0;
    let map = circle(radius_m);
    let mut swept: f64 = 0.0;
    // Where a crowd fills the sidewalk, it need not get round.
    for (seed, walkers) in [(0, 25), (1, 25), (0, 12), (1, 12), (2, 12), (3, 12)] {
        let mut scene = scene(60.0);
        (scene.seed, scene.walkers, scene.walker_cross_factor) = (seed, walkers, 0.0);
        let bus = PlanAgentRow { model: "bus.city".into(), ..agent(0, [7.0, -1.75, 0.0], 0.0) };
        let log = run(&map, &scene, &[bus], &settings());
        assert_eq!(collisions(&log, true), [], "{seed}");
        let [length, width, _] = models::find("bus.city").expect("a bus").size_m;
        let track = &tracks(&log)[&1];
        for state in track {
            let (sin, cos) = sin_cos(yaw(state.quaternion));
            let x = state.xyz_m[0] + 0.5 * (length * cos + width * sin);
            let y = state.xyz_m[1] + 0.5 * (length * sin - width * cos);
            let from_centre = frames::math::hypot(x - 20.0, y - (radius_m - 1.75));
            swept = swept.max(from_centre - radius_m - 1.75);
        }
        let end = track[track.len() - 1].xyz_m;
        let round = end[0] < 15.0 && end[1] > 10.0;
        assert!(round || walkers > 12, "{seed} it gets round: {end:?}");
    }
    assert!(swept > 0.5, "it needs the sidewalk: {swept}");
}

#[test]
fn a_bus_meets_nobody_in_a_bend_too_tight_for_it() {
    let map = right_bend(15.0);
    let north = std::f64::consts::FRAC_PI_2;
    let mut met = [0, 0];
    for k in 0..10 {
        // The bus on the inside; two cars come towards it on the outside.
        let bus = PlanAgentRow { model: "bus.city".into(), ..agent(0, [40.0, -1.75, 0.0], 0.0) };
        let y = -40.0 - 5.0 * f64::from(k);
        let cars = [agent(1, [118.5, y, 0.0], north), agent(2, [118.5, y - 12.0, 0.0], north)];
        let log = run(&map, &scene(60.0), &[bus, cars[0].clone(), cars[1].clone()], &settings());
        assert_eq!(collisions(&log, false), [], "{k}");
        let tracks = tracks(&log);
        // All come through, one after the other or side by side where the road is straight.
        let ends = [1, 3].map(|id| tracks[&id][1200].xyz_m);
        assert!(ends[0][1] < -60.0 && ends[1][0] < 60.0, "{k}: {ends:?}");
        let least = |id: u16| tracks[&id][60..400].iter().map(|s| speed(s)).fold(f64::INFINITY, f64::min);
        met[0] += usize::from(least(1) < 0.5);
        met[1] += usize::from(least(2) < 0.5);
    }
    assert!(met[0] > 0 && met[1] > 0, "now one waits, now the other one: {met:?}");
}

#[test]
fn cars_do_not_wait_for_cars_in_a_bend() {
    let map = right_bend(15.0);
    for k in 0..4 {
        let y = -40.0 - 8.0 * f64::from(k);
        let cars =
            [agent(0, [40.0, -1.75, 0.0], 0.0), agent(1, [118.5, y, 0.0], std::f64::consts::FRAC_PI_2)];
        let log = run(&map, &scene(25.0), &cars, &settings());
        assert_eq!(collisions(&log, false), []);
        for track in tracks(&log).values() {
            // The bend's speed is that of 3 m/s2 sideways.
            assert!(track[60..240].iter().all(|s| speed(s) > 4.0));
        }
    }
}
