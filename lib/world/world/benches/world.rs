//! Making tiles, building meshes and taking snapshots of a generated town.
#![allow(clippy::unwrap_used, reason = "a bench may stop")]

use land::tiles::TileMaker;
use opendrive::Map;
use schema::tables::FrameRow;
use schema::tile::TileIndex;
use settings::SceneryRules;
use world::{Moment, SceneWorld};

fn main() {
    divan::main();
}

fn map() -> Map {
    Map::new(town::generate(&town::named("convoy/demo").unwrap()).unwrap())
}

/// Tiles at the middle of the town, one after another.
#[divan::bench(sample_count = 5)]
fn make_four_tiles(bencher: divan::Bencher<'_, '_>) {
    let (map, rules) = (map(), SceneryRules::default());
    let tiles = [(-1, -1), (-1, 0), (0, -1), (0, 0)].map(|(x, y)| TileIndex { x, y });
    bencher.bench_local(|| {
        let maker = TileMaker::new(&map, &rules, catalogue::Catalogue::built_in());
        tiles.map(|index| maker.make(index))
    });
}

#[divan::bench(sample_count = 5)]
fn build_world(bencher: divan::Bencher<'_, '_>) {
    let (map, rules) = (map(), SceneryRules::default());
    let around =
        TileMaker::new(&map, &rules, catalogue::Catalogue::built_in()).around(&[[0.0; 3]], 400.0, 1).unwrap();
    bencher
        .with_inputs(|| around.ground.clone())
        .bench_local_values(|ground| SceneWorld::new(&around.actors, ground).unwrap());
}

#[divan::bench]
fn snapshot(bencher: divan::Bencher<'_, '_>) {
    let (map, rules) = (map(), SceneryRules::default());
    let around =
        TileMaker::new(&map, &rules, catalogue::Catalogue::built_in()).around(&[[0.0; 3]], 400.0, 1).unwrap();
    let world = SceneWorld::new(&around.actors, around.ground).unwrap();
    let frame = FrameRow::default();
    let moment = Moment { states: &[], previous: &[], signals: &[], frame: &frame };
    bencher.bench_local(|| world.snapshot(&moment, [0.0; 3], 400.0));
}
