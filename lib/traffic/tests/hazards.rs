//! Accidents and road works in a scene: where things stand, and what drivers do about them.

mod common;

use std::ops::ControlFlow;

use common::{agent, collisions, scene, settings, straight, touch, tracks, two_lanes, yaw};
use opendrive::{Map, MarkType};
use schema::settings::DatasetSettings;
use schema::tables::{ActorRow, PlanAgentRow, PlanHazardRow, PlanSceneRow, StateRow};
use traffic::{SceneInput, SceneLog, simulate};

/// A hazard on a lane of road "1" that runs to the east.
fn hazard(kind: &str, lane: i32, from_m: f64, to_m: f64) -> PlanHazardRow {
    PlanHazardRow {
        scene: 1,
        kind: kind.into(),
        back_road: "1".into(),
        back_lane: lane,
        back_s_m: from_m,
        front_road: "1".into(),
        front_lane: lane,
        front_s_m: to_m,
        ..PlanHazardRow::default()
    }
}

fn accident(lane: i32, from_m: f64, models: &[&str], length_m: f64) -> PlanHazardRow {
    let models = models.iter().map(|m| (*m).to_owned()).collect();
    PlanHazardRow { models, ..hazard("accident", lane, from_m, from_m + length_m) }
}

fn run(
    map: &Map,
    scene: &PlanSceneRow,
    agents: &[PlanAgentRow],
    hazards: &[PlanHazardRow],
    settings: &DatasetSettings,
) -> SceneLog {
    let input = SceneInput { map, scene, agents, hazards, settings, fixed: &[], first_id: 1 };
    simulate(&input, &mut |_, _| ControlFlow::Continue(())).expect("a log")
}

fn things(log: &SceneLog) -> Vec<&ActorRow> {
    log.actors.iter().filter(|a| a.role == "hazard").collect()
}

/// Whether a moving thing overlaps something solid of a hazard.
fn hits(log: &SceneLog) -> bool {
    let size = |a: &ActorRow| [a.length_m, a.width_m];
    log.states.iter().any(|s| {
        let Some(mover) = log.actors.iter().find(|a| a.id == s.id) else { return false };
        things(log).iter().any(|t| {
            let at = StateRow { xyz_m: t.xyz_m, quaternion: t.quaternion, ..StateRow::default() };
            let near = (s.xyz_m[0] - t.xyz_m[0]).abs() < 14.0;
            near && touch(s, size(mover), &at, size(t))
        })
    })
}

/// Area of a polygon in the plane (Gauss).
fn area_m2(corners: &[[f64; 3]]) -> f64 {
    let next = corners.iter().cycle().skip(1);
    0.5 * corners.iter().zip(next).map(|(a, b)| a[0] * b[1] - b[0] * a[1]).sum::<f64>().abs()
}

#[test]
fn vehicles_of_an_accident_stand_at_their_places() {
    // Back at 200: an ambulance's 10 m, the rear car's 6 m, the front van's 10 m; so the two meet at 216.
    let row = accident(-1, 200.0, &["van.delivery", "car.sedan", "van.ambulance"], 26.0);
    let mut middles = [0.0; 3];
    for seed in 0..40 {
        let scene = PlanSceneRow { seed, ..scene(1.0) };
        let log = run(
            &straight(600.0),
            &scene,
            &[agent(0, [50.0, -1.75, 0.0], 0.0)],
            std::slice::from_ref(&row),
            &settings(),
        );
        let vehicles: Vec<&ActorRow> = things(&log).into_iter().filter(|a| a.kind == "vehicle").collect();
        assert_eq!(vehicles.len(), 3);
        for ((thing, x_m), most_deg) in vehicles.iter().zip([221.0, 213.0, 204.0]).zip([10.0f64, 30.0, 10.0])
        {
            assert!((thing.xyz_m[0] - x_m).abs() < 1e-6 && (thing.xyz_m[1] + 1.75).abs() < 1e-6, "{thing:?}");
            assert!(thing.fixed && yaw(thing.quaternion).abs() <= most_deg.to_radians() + 1e-9);
        }
        for (sum, thing) in middles.iter_mut().zip(&vehicles) {
            *sum += yaw(thing.quaternion) / 40.0;
        }
        let cones = things(&log).iter().filter(|a| a.model == "prop.cone").count();
        let people = things(&log).iter().filter(|a| a.kind == "walker").count();
        assert!(cones <= 4 && people <= 9, "{cones} {people}");
        // The whole lane from back to front.
        let info = &log.hazards[0];
        assert_eq!((log.hazards.len(), info.kind.as_str()), (1, "accident"));
        assert!((area_m2(&info.area_m) - 26.0 * 3.5).abs() < 1e-6);
        assert!(log.actors.iter().zip(1..).all(|(a, id)| a.id == id));
        assert!(log.states.iter().all(|s| things(&log).iter().all(|t| t.id != s.id)));
    }
    // Cars are turned by up to 30 degrees either way.
    assert!(middles.iter().all(|m| m.abs() < 0.2), "{middles:?}");
}

#[test]
fn road_works_lie_between_two_barriers() {
    let row = PlanHazardRow { items: 20, ..hazard("road_works", -1, 300.0, 330.0) };
    let (mut barriers, mut cones) = (0, 0);
    for seed in 0..60 {
        let scene = PlanSceneRow { seed, ..scene(1.0) };
        let log = run(
            &straight(600.0),
            &scene,
            &[agent(0, [50.0, -1.75, 0.0], 0.0)],
            std::slice::from_ref(&row),
            &settings(),
        );
        for thing in things(&log) {
            let [x, y, _] = thing.xyz_m;
            assert!((299.6..=330.4).contains(&x), "{thing:?}");
            let aside_m = (y + 1.75).abs();
            if thing.model == "prop.cone" {
                assert!((0.42 * 3.5 - 0.2..=0.42 * 3.5 + 0.2).contains(&aside_m), "{thing:?}");
                cones += 1;
            } else {
                assert!(aside_m <= 0.4, "{thing:?}");
            }
        }
        let at_ends = things(&log)
            .iter()
            .filter(|a| a.model == "prop.barrier" && (a.xyz_m[0] < 300.41 || a.xyz_m[0] > 329.59))
            .count();
        barriers += usize::from(at_ends >= 2);
    }
    assert_eq!(barriers, 60);
    // Five of twenty things have two cones, of which 32 % are missing: 408 of 600, some more skipped beside wide things.
    assert!((330..=450).contains(&cones), "{cones}");
}

#[test]
fn drivers_stop_behind_a_hazard_on_the_only_lane() {
    for row in [
        accident(-1, 150.0, &["car.suv", "truck.box"], 18.0),
        PlanHazardRow { items: 12, ..hazard("road_works", -1, 150.0, 165.0) },
    ] {
        let log =
            run(&straight(600.0), &scene(30.0), &[agent(0, [30.0, -1.75, 0.0], 0.0)], &[row], &settings());
        let track = &tracks(&log)[&1];
        let last = track[track.len() - 1];
        let rear_m = things(&log).iter().map(|t| t.xyz_m[0]).fold(f64::INFINITY, f64::min);
        let gap_m = rear_m - last.xyz_m[0];
        assert!(f64::from(last.velocity_mps[0]).abs() < 0.05 && (4.0..25.0).contains(&gap_m), "{gap_m}");
        assert!(!hits(&log));
    }
}

#[test]
fn drivers_pass_a_hazard_by_the_lane_beside() {
    let rows = [
        accident(-2, 300.0, &["car.suv", "car.sedan", "car.police"], 18.0),
        PlanHazardRow { items: 20, ..hazard("road_works", -2, 300.0, 330.0) },
    ];
    for row in rows {
        for seed in [3, 28] {
            let scene = PlanSceneRow { seed, ..scene(60.0) };
            let agents = [(0, 60.0), (1, 110.0)].map(|(i, x_m)| agent(i, [x_m, -5.25, 0.0], 0.0));
            let map = two_lanes(MarkType::Broken, None);
            let log = run(&map, &scene, &agents, std::slice::from_ref(&row), &settings());
            assert!(!hits(&log) && collisions(&log, false).is_empty(), "{} seed {seed}", row.kind);
            for id in [1, 2] {
                let last = tracks(&log)[&id][1200];
                assert!(last.xyz_m[0] > 380.0, "{} seed {seed}: {id} is at {:?}", row.kind, last.xyz_m);
            }
        }
    }
}

#[test]
fn nobody_starts_in_a_hazard_and_no_hazard_lies_on_an_agent() {
    let scene = PlanSceneRow { background_vehicles: Some(40), ..scene(2.0) };
    let works = PlanHazardRow { items: 40, ..hazard("road_works", -1, 300.0, 360.0) };
    let clash = accident(-1, 45.0, &["car.suv", "car.sedan"], 14.0);
    let clash = PlanHazardRow { hazard: 1, ..clash };
    let map = straight(800.0);
    let log = run(&map, &scene, &[agent(0, [50.0, -1.75, 0.0], 0.0)], &[works, clash], &settings());
    assert_eq!(log.hazards.iter().map(|h| h.hazard).collect::<Vec<_>>(), [0]);
    let starts: Vec<&StateRow> = log.states.iter().filter(|s| s.frame == -1).collect();
    assert!(starts.len() > 20);
    // On the way there during the warm-up of 2 s, but not inside.
    let inside = starts.iter().filter(|s| s.xyz_m[1] < 0.0 && (300.0..360.0).contains(&s.xyz_m[0]));
    assert_eq!(inside.count(), 0);
    assert!(!hits(&log));
}
