//! Actors on given trajectories go where these say, and the others keep off; vehicles on given routes pass
//! what these say.

use std::ops::ControlFlow;

use crate::common::{agent, collisions, crossing, lights, scene, settings, straight, tracks, yaw};
use opendrive::{LaneId, LaneInfo, LanePoint, Map};
use schema::tables::{PlanAgentRow, PlanRouteRow, PlanSceneRow, PlanTrajectoryRow, StateRow};
use schema::{ActorKind, ActorRole, AgentId, FRAME_PERIOD_S};
use traffic::{SceneInput, SimulationLog, simulate};

fn run(
    map: &Map,
    scene: &PlanSceneRow,
    agents: &[PlanAgentRow],
    (routes, trajectories): (&[PlanRouteRow], &[PlanTrajectoryRow]),
) -> SimulationLog {
    let mut fixed = lights(map);
    for (id, actor) in (1..).zip(&mut fixed) {
        actor.id = id;
    }
    let input = SceneInput {
        catalogue: catalogue::Catalogue::built_in(),
        map,
        scene,
        agents,
        hazards: &[],
        weather: &[],
        routes,
        trajectories,
        settings: &settings(),
        fixed: &fixed,
        first_id: fixed.len() as u16 + 1,
    };
    simulate(&input, &mut |_, _| ControlFlow::Continue(())).expect("a log")
}

/// Length of a way in the plane, metres.
fn way_m([x, y]: [f64; 2]) -> f64 {
    (x * x + y * y).sqrt()
}

/// An actor that goes straight on from a place at a speed.
fn straight_on(
    actor: &str,
    model: &str,
    frames: std::ops::Range<i32>,
    (from_m, yaw_rad, speed_mps): ([f64; 2], f64, f64),
) -> Vec<PlanTrajectoryRow> {
    let (sin, cos) = frames::math::sin_cos(yaw_rad);
    let row = |frame: i32| {
        let way_m = speed_mps * FRAME_PERIOD_S * f64::from(frame);
        PlanTrajectoryRow {
            scene: 1,
            actor: actor.into(),
            model: model.into(),
            frame,
            xyz_m: [from_m[0] + way_m * cos, from_m[1] + way_m * sin, 0.0],
            rpy_rad: [0.0, 0.0, yaw_rad],
        }
    };
    frames.map(row).collect()
}

#[test]
fn actors_are_where_their_trajectories_say_whatever_is_in_the_way() {
    // vehicle_0 goes straight over the crossing at 9 m/s, a van and somebody on foot come from elsewhere.
    let map = crossing(true);
    let scene =
        PlanSceneRow { background_vehicles: Some(30), walkers: 40, spawn_radius_m: 150.0, ..scene(12.0) };
    let rows = [
        straight_on("vehicle_0", "car.sedan", -40..240, ([-60.0, -1.75], 0.0, 9.0)),
        straight_on("a van", "van.delivery", 0..240, ([1.75, -70.0], 0.5 * std::f64::consts::PI, 6.0)),
        straight_on("somebody", "walker.police", 0..240, ([-20.0, 9.0], 0.0, 1.2)),
    ]
    .concat();
    let agents =
        [agent(0, [-60.0, -1.75, 0.0], 0.0), agent(1, [-1.75, 60.0, 0.0], -0.5 * std::f64::consts::PI)];
    let log = run(&map, &scene, &agents, (&[], &rows));
    let first = log.actors[0].id;
    assert!(log.actors.iter().zip(first..).all(|(actor, id)| actor.id == id));
    let find = |role: ActorRole, model: &str| {
        let found = log.actors.iter().find(|a| a.role == role && (model.is_empty() || a.model == model));
        found.expect("is there").id
    };
    assert_eq!(find(ActorRole::Agent(AgentId::vehicle(0)), ""), first);
    assert_eq!(find(ActorRole::Agent(AgentId::vehicle(1)), ""), first + 1);
    let last = log.actors[log.actors.len() - 1].id;
    for (id, actor) in [(first, "vehicle_0"), (last - 1, "a van"), (last, "somebody")] {
        let states = &tracks(&log)[&id];
        assert_eq!(states.len(), 241);
        let own: Vec<&PlanTrajectoryRow> = rows.iter().filter(|row| row.actor == actor).collect();
        for state in states.iter().filter(|state| state.frame >= 0) {
            let row = own.iter().find(|row| row.frame == state.frame).expect("a row");
            assert_eq!(state.xyz_m, row.xyz_m, "{actor} at {}", state.frame);
            assert!((yaw(state.quaternion) - row.rpy_rad[2]).abs() < 1e-9);
        }
        let speed = way_m([0, 1].map(|axis| f64::from(states[1].velocity_mps[axis])));
        let wanted = own[40].xyz_m[0] - own[39].xyz_m[0] + own[40].xyz_m[1] - own[39].xyz_m[1];
        assert!((speed - wanted.abs() / FRAME_PERIOD_S).abs() < 1e-3, "{actor}: {speed}");
    }
    assert_eq!(log.actors[log.actors.len() - 1].kind, ActorKind::Walker);
    assert!(log.states.windows(2).all(|pair| (pair[0].frame, pair[0].id) < (pair[1].frame, pair[1].id)));
    // The van crosses the way of the first vehicle far from it in time: nobody is touched.
    let given = [first, last - 1];
    let hits: Vec<_> = collisions(&log, false);
    let with_given = hits.iter().filter(|(_, a, b)| given.contains(a) || given.contains(b));
    assert_eq!(with_given.count(), 0, "{hits:?}");
}

#[test]
fn drivers_keep_behind_beside_and_before_given_vehicles() {
    // A slow vehicle ahead: whoever comes from behind follows it.
    let map = straight(600.0);
    let scene = scene(20.0);
    let slow = straight_on("slow", "car.sedan", -40..400, ([100.0, -1.75], 0.0, 4.0));
    let log = run(&map, &scene, &[agent(0, [40.0, -1.75, 0.0], 0.0)], (&[], &slow));
    let (own, other) = (&tracks(&log)[&log.actors[0].id], &tracks(&log)[&log.actors[1].id]);
    let gaps: Vec<f64> = own.iter().zip(other).map(|(a, b)| b.xyz_m[0] - a.xyz_m[0] - 4.7).collect();
    let least = gaps.iter().copied().fold(f64::INFINITY, f64::min);
    let end = gaps[gaps.len() - 1];
    assert!(least > 2.0 && end < 14.0, "{least} {end}");
    assert!((f64::from(own[400].velocity_mps[0]) - 4.0).abs() < 0.3, "{:?}", own[400].velocity_mps);
    // One that crosses the road where there is no junction: it is let pass.
    let across =
        straight_on("across", "van.delivery", -40..400, ([200.0, 75.0], -0.5 * std::f64::consts::PI, 6.0));
    let log = run(&map, &scene, &[agent(0, [40.0, -1.75, 0.0], 0.0)], (&[], &across));
    assert!(collisions(&log, false).is_empty(), "{:?}", collisions(&log, false));
    assert!(tracks(&log)[&log.actors[0].id][400].xyz_m[0] > 220.0);
    // Without it nobody brakes there; with it somebody does.
    let alone = run(&map, &scene, &[agent(0, [40.0, -1.75, 0.0], 0.0)], (&[], &[]));
    let slowest = |log: &SimulationLog| {
        let own = &tracks(log)[&log.actors[0].id];
        let near = own.iter().filter(|s| (150.0..195.0).contains(&s.xyz_m[0])).map(|s| s.velocity_mps[0]);
        near.fold(f32::INFINITY, f32::min)
    };
    assert!(slowest(&log) < slowest(&alone) - 3.0, "{} {}", slowest(&log), slowest(&alone));
}

#[test]
fn vehicles_pass_the_places_of_their_routes() {
    // From lanes before junctions of a town, out by each way that leads on.
    let map = Map::new(town::generate(&town::named("convoy/demo").expect("our town")).expect("roads"));
    let is_long = |lane: &&LaneInfo| {
        lane.lane_type.is_drivable()
            && lane.junction.is_none()
            && lane.length_m > 60.0
            && lane.length_m < 120.0
    };
    let mut ways = 0;
    for lane in map.lanes().iter().filter(is_long).step_by(9).take(3) {
        for exit in map.successors(lane.id).iter().flat_map(|way| map.successors(*way)) {
            let places = [(lane.id, 0.7), (*exit, 0.5)].map(|(id, share)| {
                let s_m = map.lane(id).map(|info| info.s_of_along(share * info.s_length())).expect("a lane");
                (id, s_m, map.lane_point(id, s_m, 0.0).expect("a place"))
            });
            let row = |(number, (id, s_m, at)): (usize, &(LaneId, f64, LanePoint))| PlanRouteRow {
                scene: 1,
                agent: AgentId::vehicle(0),
                number: number as u32,
                road: map.network().roads[id.road as usize].id.clone(),
                lane: i32::from(id.lane),
                s_m: *s_m,
                xyz_m: at.position.into(),
            };
            let routes: Vec<PlanRouteRow> = places.iter().enumerate().map(row).collect();
            let [(_, _, from), (_, _, to)] = &places;
            let agents = [agent(0, from.position.into(), from.heading_rad)];
            for seed in 1..4 {
                let log = run(&map, &PlanSceneRow { seed, ..scene(70.0) }, &agents, (&routes, &[]));
                let own = &tracks(&log)[&log.actors[0].id];
                let away = |s: &&StateRow| way_m([s.xyz_m[0] - to.position.x, s.xyz_m[1] - to.position.y]);
                let nearest = own.iter().map(away).fold(f64::INFINITY, f64::min);
                assert!(nearest < 1.0, "{lane:?} to {exit:?} with seed {seed}: {nearest}");
            }
            ways += 1;
        }
    }
    assert!(ways >= 6, "{ways}");
}
