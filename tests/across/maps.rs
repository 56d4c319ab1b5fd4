//! Every road network takes part in a dataset: all towns of our own, and real maps where there are any.

use std::path::Path;

use convoy_tests::{Bench, TINY};
use nalgebra::Point3;
use opendrive::Map;
use schema::ActorKind;
use schema::tables::{ActorRow, StateRow};
use store::{Scope, Store, keys};

/// Plans and simulates a scene on each map and looks at where vehicles are and whether they drive.
fn drive(names: &[&str], maps: Option<&Path>) {
    let wanted: String = names.iter().map(|name| format!("\"{name}\" = 1\n")).collect();
    // Long enough for vehicles to set off that wait for others ahead.
    let longer = TINY.replace("_duration_s = 1", "_duration_s = 4");
    let bench = Bench::new(&longer.replace("\"convoy/demo\" = 1", &wanted));
    let folder = maps.map(|m| m.display().to_string());
    let args: Vec<&str> = folder.iter().flat_map(|f| ["--maps", f.as_str()]).collect();
    bench.run("spawn-planner", &args).expect_done();
    bench.run("simulate-and-log", &[]).expect_done();
    let store = Store::open(bench.store()).expect("is a folder");
    for (scene, name) in names.iter().enumerate() {
        let scene = scene as u32;
        let manifest =
            store.manifest(Scope::Scene(scene), "simulate-and-log").expect("reads").expect("is there");
        let actors: Vec<ActorRow> =
            store.read_rows(&manifest, &keys::scene(scene, "log/actors.parquet")).expect("reads");
        let states: Vec<StateRow> =
            store.read_rows(&manifest, &keys::scene(scene, "log/states.parquet")).expect("reads");
        let map = read(&bench, name);
        let vehicles: Vec<u16> =
            actors.iter().filter(|a| a.kind == ActorKind::Vehicle).map(|a| a.id).collect();
        assert!(vehicles.len() >= 3, "{name}: {} vehicles", vehicles.len());
        let last = states.iter().map(|s| s.frame).max().expect("has frames");
        let at = |id: u16, frame: i32| {
            let state = states.iter().find(|s| s.id == id && s.frame == frame);
            Point3::from(state.expect("has a state").xyz_m)
        };
        for &id in &vehicles {
            let place = at(id, 0);
            let hit = map.nearest_driving_lane(place).expect("the map has lanes");
            assert!(
                hit.distance_m < 1.0,
                "{name}: vehicle {id} is {} m off its lane at {place}",
                hit.distance_m
            );
        }
        let driving = vehicles.iter().filter(|id| (at(**id, last) - at(**id, 0)).norm() > 1.0).count();
        assert!(2 * driving > vehicles.len(), "{name}: {driving} of {} vehicles drive", vehicles.len());
    }
}

/// The map that a dataset keeps.
fn read(bench: &Bench, name: &str) -> Map {
    let kept = bench.store().join(keys::map(name));
    let text = zstd::decode_all(std::fs::File::open(kept).expect("is kept")).expect("decompresses");
    Map::new(opendrive::read_bytes(&text).expect("reads"))
}

#[test]
fn vehicles_drive_in_every_town() {
    let names: Vec<&str> = town::names();
    assert!(names.len() > 9);
    drive(&names, None);
}

#[test]
fn vehicles_drive_on_real_maps() {
    let Some(folder) = testkit::maps_folder() else { return };
    let towns = ["Town01", "Town02", "Town03", "Town04", "Town06", "Town10HD", "Town11"];
    drive(&towns, Some(&folder.join("carla")));
}
