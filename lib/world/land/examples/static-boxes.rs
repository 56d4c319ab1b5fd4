//! Counts what boxes a frame has of things that stand still: `static-boxes [TOWN | MAP.xodr]...`, all of our
//! towns without.
//!
//! As the published statistics do: unique objects within 200 m of any of five agents, which have come up to
//! 150 m away from where the first one started. Start by start, drawn evenly among the places where vehicles
//! may; means of a map in a row.
#![allow(clippy::print_stdout, reason = "a tool for developers")]

use std::collections::{BTreeMap, BTreeSet};
use std::error::Error;
use std::time::{Duration, Instant};

use land::tiles::{TileMaker, reached};
use opendrive::Map;
use random::Stream;
use schema::DetectionClass;
use schema::tables::TileObjectRow;
use schema::tile::TileIndex;
use settings::SceneryRules;

/// Boxes are collected within this distance of an agent, metres.
const RADIUS_M: f64 = 200.0;
const AGENTS: usize = 5;
/// How far from its start agents are, metres.
const SPREAD_M: f64 = 150.0;
/// Distance between places where vehicles start, metres.
const SEPARATION_M: f64 = 6.0;
const SCENES: u64 = 24;
/// Fixed objects of at least this height have no box, metres.
const HIGHEST_M: f64 = 6.4;

fn main() -> Result<(), Box<dyn Error>> {
    let mut names: Vec<String> = std::env::args().skip(1).collect();
    if names.is_empty() {
        names = (1..=11).map(|k| format!("convoy/{k:02}")).collect();
    }
    let columns = DetectionClass::ALL.map(|class| format!("{:>7.7}", class.name()));
    println!("{:<24}{}  tiles  ms a tile  signs", "map", columns.concat());
    for name in &names {
        let map = Map::new(match town::named(name) {
            Some(parameters) => town::generate(&parameters)?,
            None => opendrive::read_bytes(&std::fs::read(name)?)?,
        });
        println!("{}", row(name, &map));
    }
    Ok(())
}

fn class_of(object: &TileObjectRow) -> Option<DetectionClass> {
    (object.height_m < HIGHEST_M).then(|| DetectionClass::from_tags(&object.semantic_tags)).flatten()
}

/// The means of a map, by class, and what they took.
fn row(name: &str, map: &Map) -> String {
    let rules = SceneryRules::default();
    let maker = TileMaker::new(map, &rules, catalogue::Catalogue::built_in());
    let mut tiles: BTreeMap<TileIndex, Vec<TileObjectRow>> = BTreeMap::new();
    let mut clock = Duration::ZERO;
    let places: Vec<[f64; 3]> = map
        .spawn_points(SEPARATION_M)
        .into_iter()
        .filter_map(|at| map.point_at(at))
        .map(|point| point.position.into())
        .collect();
    let mut found: BTreeMap<DetectionClass, usize> = BTreeMap::new();
    let mut signs: BTreeMap<String, usize> = BTreeMap::new();
    for scene in 0..SCENES {
        let mut draw = Stream::new(7, scene, "static-boxes", 0);
        let Some(first) = draw.choose(&places).copied() else { break };
        let near: Vec<[f64; 3]> = places.iter().filter(|p| apart(**p, first) < SPREAD_M).copied().collect();
        let agents: Vec<[f64; 3]> = (0..AGENTS).filter_map(|_| draw.choose(&near).copied()).collect();
        let needed: BTreeSet<TileIndex> = reached(agents.iter().copied(), RADIUS_M);
        for index in needed {
            let objects = tiles.entry(index).or_insert_with(|| {
                let start = Instant::now();
                let objects = maker.make(index).objects;
                clock += start.elapsed();
                objects
            });
            let seen = objects.iter().filter(|o| agents.iter().any(|a| apart(*a, o.xyz_m) < RADIUS_M));
            for (object, class) in seen.filter_map(|o| Some((o, class_of(o)?))) {
                *found.entry(class).or_default() += 1;
                if class == DetectionClass::TrafficSign {
                    *signs.entry(object.model.clone()).or_default() += 1;
                }
            }
        }
    }
    let mean = |count: usize| count as f64 / SCENES as f64;
    let columns =
        DetectionClass::ALL.map(|class| format!("{:7.1}", mean(found.get(&class).copied().unwrap_or(0))));
    let each = 1e3 * clock.as_secs_f64() / tiles.len().max(1) as f64;
    let signs = signs.iter().map(|(model, count)| format!("{model} {:.1}", mean(*count)));
    let name = name.rsplit_once('/').filter(|_| name.ends_with(".xodr")).map_or(name, |(_, file)| file);
    let signs = signs.collect::<Vec<_>>().join(", ");
    format!("{name:<24}{}{:7}{each:11.1}  {signs}", columns.concat(), tiles.len())
}

fn apart(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|k| (a[k] - b[k]) * (a[k] - b[k])).sum::<f64>().sqrt()
}
