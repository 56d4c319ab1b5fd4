//! Placing scenery, building meshes and taking snapshots of a generated town.
#![allow(clippy::unwrap_used)] // A bench may stop.

use opendrive::Map;
use scenery::place;
use schema::settings::WorldSettings;
use schema::tables::FrameRow;
use world::{Moment, SceneWorld};

fn main() {
    divan::main();
}

fn map() -> Map {
    Map::new(town::generate(&town::named("convoy/demo").unwrap()).unwrap())
}

#[divan::bench(sample_count = 5)]
fn place_scenery(bencher: divan::Bencher<'_, '_>) {
    let map = map();
    bencher.bench_local(|| place(&map, &WorldSettings::default(), 1, &[[0.0; 3]], 1).unwrap());
}

#[divan::bench(sample_count = 5)]
fn build_world(bencher: divan::Bencher<'_, '_>) {
    let map = map();
    let actors = place(&map, &WorldSettings::default(), 1, &[[0.0; 3]], 1).unwrap();
    bencher.bench_local(|| SceneWorld::new(&map, &actors).unwrap());
}

#[divan::bench]
fn snapshot(bencher: divan::Bencher<'_, '_>) {
    let map = map();
    let actors = place(&map, &WorldSettings::default(), 1, &[[0.0; 3]], 1).unwrap();
    let world = SceneWorld::new(&map, &actors).unwrap();
    let frame = FrameRow::default();
    let moment = Moment { states: &[], previous: &[], signals: &[], frame: &frame };
    bencher.bench_local(|| world.snapshot(&moment, [0.0; 3], 400.0));
}
