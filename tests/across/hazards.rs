//! Accidents and road works through the real programs: what is planned stands in the log, in the boxes and in
//! the masks.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::BufReader;

use catalogue::Special;
use codecs::NpzReader;
use convoy_tests::{Bench, SMALL};
use nalgebra::Point3;
use schema::scene_info::SceneInfo;
use schema::tables::{ActorRow, AgentRow, BoxRow, PlanHazardRow, PlanSceneRow, StateRow};
use schema::{ActorKind, ActorRole, Attribute, BevClass, HazardKind, lights};
use store::{Manifest, Scope, Store, keys};

use crate::masks::mask_is_the_polygons;

/// A quarter of the places around the agent have a hazard, or would if there were room.
const HAZARDS: &str = "
[hazards]
share = 0.25

[weather]
dynamic = false

[weather.initial]
sun_altitude_deg = 5
";

struct Made {
    info: SceneInfo,
    actors: Vec<ActorRow>,
    states: Vec<StateRow>,
    agents: Vec<AgentRow>,
    boxes: Vec<BoxRow>,
    plan: PlanSceneRow,
    planned: Vec<PlanHazardRow>,
}

fn read(store: &Store) -> Made {
    let manifest = |scope, stage: &str| -> Manifest {
        store.manifest(scope, stage).expect("reads").unwrap_or_else(|| panic!("{stage} is done"))
    };
    let log = manifest(Scope::Scene(0), "simulate-and-log");
    let plan = manifest(Scope::Plan, "spawn-planner");
    let key = |name: &str| keys::scene(0, name);
    Made {
        info: store.read_json(&key("log/scene.json")).expect("reads").expect("is there"),
        actors: store.read_rows(&log, &key("log/actors.parquet")).expect("reads"),
        states: store.read_rows(&log, &key("log/states.parquet")).expect("reads"),
        agents: store.read_rows(&log, &key("agents.parquet")).expect("reads"),
        boxes: store.read_rows(&log, &key("boxes.parquet")).expect("reads"),
        plan: store.read_rows(&plan, keys::PLAN_SCENES).expect("reads").remove(0),
        planned: store.read_rows(&plan, keys::PLAN_HAZARDS).expect("reads"),
    }
}

#[test]
fn hazards_are_in_log_boxes_and_masks() {
    let near =
        SMALL.replace("[traffic]\n", "[traffic]\nspawn_radius_m = 150\n").replace("seed = 11", "seed = 4");
    let bench = Bench::new(&(near + HAZARDS));
    for stage in ["spawn-planner", "simulate-and-log", "bev-gt"] {
        bench.run(stage, &[]).expect_done();
    }
    let made = read(&Store::open(bench.store()).expect("is a folder"));
    counts_agree(&made);
    boxes_have_their_classes(&made);
    vehicles_have_lamps_and_doors(&made);
    let areas: Vec<&[[f64; 3]]> = made.info.hazards.iter().map(|h| h.area_m.as_slice()).collect();
    let mut cells = 0;
    for agent in made.info.agents.iter().map(|a| a.agent.as_str()) {
        let path = bench.store().join(format!("scenes/0000/bev/{agent}.npz"));
        let mut masks = NpzReader::new(BufReader::new(File::open(path).expect("opens"))).expect("is npz");
        for row in made.agents.iter().filter(|a| a.agent == agent && a.frame % 9 == 0) {
            let mask = masks.read(&format!("{:04}.npy", row.frame)).expect("is there");
            cells += mask_is_the_polygons(&areas, BevClass::Hazard, row, &mask.bytes);
        }
    }
    assert!(cells > 500, "{cells}");
}

fn counts_agree(made: &Made) {
    let info = &made.info;
    let of = |kind| info.hazards.iter().filter(|h| h.kind == kind).count() as u32;
    assert_eq!(
        [info.n_accident_hazards, info.n_road_work_hazards],
        [of(HazardKind::Accident), of(HazardKind::RoadWorks)]
    );
    assert!(info.n_accident_hazards > 1 && info.n_road_work_hazards > 1, "{:?}", made.planned);
    assert!(info.hazards.len() <= made.planned.len());
    assert!(made.planned.len() as u32 <= made.plan.hazard_attempts);
    let mut fenced = 0;
    for hazard in &info.hazards {
        let planned = made.planned.iter().find(|p| p.hazard == hazard.hazard).expect("it was planned");
        assert_eq!(hazard.kind, planned.kind);
        // It has what it was planned with.
        let number = hazard.hazard.to_string();
        let of_hazard = |a: &&ActorRow| a.attributes.get(&Attribute::Hazard) == Some(&number);
        let things: Vec<&ActorRow> = made.actors.iter().filter(of_hazard).collect();
        assert!(things.iter().all(|a| a.role == ActorRole::Hazard));
        let mut models: Vec<&str> =
            things.iter().filter(|a| a.kind == ActorKind::Vehicle).map(|a| a.model.as_str()).collect();
        let mut wanted: Vec<&str> = planned.models.iter().map(String::as_str).collect();
        models.sort_unstable();
        wanted.sort_unstable();
        assert_eq!(models, wanted);
        let barriers = things.iter().filter(|a| a.model.starts_with("barrier.")).count();
        fenced += u32::from(hazard.kind == HazardKind::RoadWorks && barriers >= 2);
    }
    // Barriers that would touch existing objects are left out.
    assert!(2 * fenced > info.n_road_work_hazards, "{fenced}");
    // Vehicles and walkers of hazards are not counted among the background.
    let background = made.actors.iter().filter(|a| a.role == ActorRole::Background).count();
    let walkers = made.actors.iter().filter(|a| a.role == ActorRole::Walker).count();
    assert_eq!([background, walkers], [info.n_vehicles as usize, info.n_walkers as usize]);
}

/// The class of a model by its family, from the published list.
fn class_of(model: &str) -> Option<&'static str> {
    let (family, kind) = model.split_once('.')?;
    Some(match family {
        "car" => "car",
        "van" | "truck" => "truck",
        "bus" => "bus",
        "motorcycle" => "motorcycle",
        "bicycle" => "bicycle",
        "walker" => "pedestrian",
        "cone" => "traffic_cone",
        "barrier" => "barrier",
        "sign" if ["accident", "road_works", "danger"].contains(&kind) => "traffic_sign",
        _ => return None,
    })
}

fn boxes_have_their_classes(made: &Made) {
    let mut seen: BTreeMap<&str, u32> = BTreeMap::new();
    let mut boxes: BTreeMap<(&str, u32, u16), Vec<&BoxRow>> = BTreeMap::new();
    for b in &made.boxes {
        boxes.entry((&b.agent, b.frame, b.id)).or_default().push(b);
    }
    for row in &made.agents {
        for actor in made.actors.iter().filter(|a| a.role == ActorRole::Hazard) {
            let away = Point3::from(actor.xyz_m) - Point3::from(row.xyz_m);
            let found = boxes.remove(&(row.agent.as_str(), row.frame, actor.id)).unwrap_or_default();
            // Boxes are collected within 200 m.
            let class = class_of(&actor.model).filter(|_| away.norm() < 200.0);
            assert_eq!(found.iter().map(|b| b.class.as_str()).collect::<Vec<_>>(), Vec::from_iter(class));
            for b in found {
                *seen.entry(class.expect("it has one")).or_default() += 1;
                let middle = Point3::from(actor.xyz_m) + nalgebra::Vector3::z() * 0.5 * actor.height_m;
                assert!((Point3::from(b.center_m) - middle).norm() < 0.3 * actor.height_m, "{b:?}");
                assert_eq!(b.velocity_mps, [0.0; 3]);
            }
        }
    }
    for class in ["car", "traffic_cone", "barrier", "pedestrian", "traffic_sign"] {
        assert!(seen.contains_key(class), "no {class}: {seen:?}");
    }
}

fn vehicles_have_lamps_and_doors(made: &Made) {
    let mut doors = 0;
    for actor in made.actors.iter().filter(|a| a.role == ActorRole::Hazard && a.kind == ActorKind::Vehicle) {
        let states: Vec<&StateRow> = made.states.iter().filter(|s| s.id == actor.id).collect();
        assert_eq!(states.len(), made.info.frames as usize + 1, "{actor:?}");
        let model = catalogue::models::find(&actor.model).expect("a model");
        // The sun is at 5 degrees.
        let wanted = lights::POSITION | lights::LOW_BEAM;
        let flashing = if model.special == Special::Emergency { lights::EMERGENCY } else { 0 };
        for state in states {
            assert_eq!(state.lights & (wanted | lights::EMERGENCY), wanted | flashing, "{actor:?}");
            let open = state.door_rad.iter().filter(|a| **a > 0.0).count();
            assert!(if usize::from(model.doors) == 0 {
                open == 0
            } else {
                open == 1 || open == usize::from(model.doors)
            });
            doors += usize::from(open > 0);
        }
    }
    assert!(doors > 0);
}
