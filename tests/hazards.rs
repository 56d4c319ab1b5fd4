//! Accidents and road works through the real programs: what is planned stands in the log, in the boxes and in the masks.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::BufReader;

use convoy_tests::Bench;
use formats::NpzReader;
use frames::{Agent, Pose, World};
use nalgebra::{Point2, Point3};
use schema::scene_info::{HazardInfo, SceneInfo};
use schema::tables::{ActorRow, AgentRow, BoxRow, PlanHazardRow, PlanSceneRow, StateRow};
use schema::{ActorKind, ActorRole, Attribute, BevClass, HazardKind, lights};
use store::{Manifest, Scope, Store, keys};

/// A quarter of the places around the agent have a hazard, or would if there were room.
const HAZARDOUS: &str = r#"
name = "hazardous"
seed = 4

[scenes.train]
"convoy/demo" = 1

[agents]
min_vehicles = 1
max_vehicles = 1
min_rsus = 1
max_rsus = 1

[timing]
warmup_s = 0.5
min_duration_s = 1
max_duration_s = 1

[traffic]
vehicles = 8
spawn_radius_m = 150

[walkers]
count = 8

[hazards]
share = 0.25

[world]
radius_m = 120

[weather]
dynamic = false

[weather.initial]
sun_altitude_deg = 5
"#;

/// Nearer to an edge than this, rounding decides on which side a cell's centre lies, metres.
const EDGE_M: f64 = 0.002;

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
    let bench = Bench::new(HAZARDOUS);
    for stage in ["spawn-planner", "simulate-and-log", "bev-gt"] {
        bench.run(stage, &[]).expect_done();
    }
    let made = read(&Store::open(bench.store()).expect("is a folder"));
    counts_agree(&made);
    boxes_have_their_classes(&made);
    vehicles_have_lamps_and_doors(&made);
    let mut cells = 0;
    for agent in made.info.agents.iter().map(|a| a.agent.as_str()) {
        let path = bench.store().join(format!("scenes/0000/bev/{agent}.npz"));
        let mut masks = NpzReader::new(BufReader::new(File::open(path).expect("opens"))).expect("is npz");
        for row in made.agents.iter().filter(|a| a.agent == agent && a.frame % 9 == 0) {
            let mask = masks.read(&format!("{:04}.npy", row.frame)).expect("is there");
            cells += mask_is_the_polygons(&made.info.hazards, row, &mask.bytes);
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
    // Barriers that would touch what stands already are left out.
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
        let model = schema::models::find(&actor.model).expect("a model");
        // The sun is at 5 degrees.
        let wanted = lights::POSITION | lights::LOW_BEAM;
        let flashing = if model.special == "emergency" { lights::EMERGENCY } else { 0 };
        for state in states {
            assert_eq!(state.lights & (wanted | lights::EMERGENCY), wanted | flashing, "{actor:?}");
            let open = state.door_rad.iter().filter(|a| **a > 0.0).count();
            assert!(if model.doors() == 0 { open == 0 } else { open == 1 || open == model.doors() });
            doors += usize::from(open > 0);
        }
    }
    assert!(doors > 0);
}

/// Signed turn of a polygon about a point, in full turns: not 0 inside.
fn turns(polygon: &[Point2<f64>], at: Point2<f64>) -> f64 {
    let next = polygon.iter().cycle().skip(1);
    let angle = |(a, b): (&Point2<f64>, &Point2<f64>)| {
        let (a, b) = (a - at, b - at);
        frames::math::atan2(a.perp(&b), a.dot(&b))
    };
    polygon.iter().zip(next).map(angle).sum::<f64>() / std::f64::consts::TAU
}

/// Distance of a point from a polygon's outline.
fn edge_m(polygon: &[Point2<f64>], at: Point2<f64>) -> f64 {
    let next = polygon.iter().cycle().skip(1);
    let away = |(a, b): (&Point2<f64>, &Point2<f64>)| {
        let (along, to) = (b - a, at - a);
        let share = (to.dot(&along) / along.norm_squared().max(1e-12)).clamp(0.0, 1.0);
        (to - along * share).norm()
    };
    polygon.iter().zip(next).map(away).fold(f64::INFINITY, f64::min)
}

/// Compares a mask's hazard channel with the polygons, cell by cell, and says how many cells carry it.
fn mask_is_the_polygons(hazards: &[HazardInfo], agent: &AgentRow, mask: &[u8]) -> usize {
    const CELLS: usize = 400;
    const CELL_M: f64 = 0.4;
    let pose = Pose::<World, Agent>::from_xyz_wxyz(agent.xyz_m, agent.quaternion);
    let (sin, cos) = frames::math::sin_cos(pose.yaw());
    // Polygons in the grid: columns and rows as real numbers.
    let polygons: Vec<Vec<Point2<f64>>> = hazards
        .iter()
        .map(|hazard| {
            let corner = |p: &[f64; 3]| {
                let (dx, dy) = (p[0] - agent.xyz_m[0], p[1] - agent.xyz_m[1]);
                let (ahead, left) = (dx * cos + dy * sin, dy * cos - dx * sin);
                Point2::new(0.5 * CELLS as f64 - left / CELL_M, 0.5 * CELLS as f64 - ahead / CELL_M)
            };
            hazard.area_m.iter().map(corner).collect()
        })
        .collect();
    // Nothing is near a polygon outside its bounds and one cell more.
    let span = |p: &[Point2<f64>], k: usize| {
        let values = || p.iter().map(move |c| c[k]);
        values().fold(f64::INFINITY, f64::min) - 1.0..values().fold(f64::NEG_INFINITY, f64::max) + 1.0
    };
    let bounds: Vec<_> = polygons.iter().map(|p| [span(p, 0), span(p, 1)]).collect();
    let channel = &mask[BevClass::Hazard as usize * CELLS * CELLS..][..CELLS * CELLS];
    let mut carried = 0;
    for (i, got) in channel.iter().enumerate() {
        let at = Point2::new((i % CELLS) as f64 + 0.5, (i / CELLS) as f64 + 0.5);
        let near: Vec<&Vec<Point2<f64>>> = polygons
            .iter()
            .zip(&bounds)
            .filter(|(_, [columns, rows])| columns.contains(&at.x) && rows.contains(&at.y))
            .map(|(p, _)| p)
            .collect();
        if near.iter().any(|p| edge_m(p, at) < EDGE_M / CELL_M) {
            continue;
        }
        let inside = near.iter().any(|p| turns(p, at).abs() > 0.5);
        assert_eq!(*got != 0, inside, "{} frame {}: cell {at}", agent.agent, agent.frame);
        carried += usize::from(inside);
    }
    carried
}
