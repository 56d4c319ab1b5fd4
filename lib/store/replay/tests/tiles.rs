//! Tiles in a store: made once, however many processes ask at once.
#![allow(clippy::unwrap_used, reason = "tests may stop")]

use std::collections::BTreeSet;

use land::tiles::TileMaker;
use opendrive::Map;
use replay::tiles::TileStore;
use schema::tile::TileIndex;
use settings::SceneryRules;
use store::{Problem, Scope, Store, keys, verify};

fn street() -> Map {
    testkit::straight(600.0)
}

fn some() -> BTreeSet<TileIndex> {
    [(0, 0), (1, 0), (1, -1), (2, 0)].into_iter().map(|(x, y)| TileIndex { x, y }).collect()
}

#[test]
fn what_is_kept_is_what_was_made() {
    let (map, rules) = (street(), SceneryRules::default());
    let store = Store::open("memory:").unwrap();
    let tiles = TileStore::new(&store, (&map, "h"), (&rules, catalogue::Catalogue::built_in()), "1").unwrap();
    let made = tiles.get(&some()).unwrap();
    // Another one finds them in the store.
    let found = TileStore::new(&store, (&map, "h"), (&rules, catalogue::Catalogue::built_in()), "1")
        .unwrap()
        .get(&some())
        .unwrap();
    assert_eq!(made, found);
    let maker = TileMaker::new(&map, &rules, catalogue::Catalogue::built_in());
    for tile in &found {
        let whole = maker.make(tile.index);
        assert_eq!(tile.objects, whole.objects);
        assert_eq!(tiles.surfaces(tile.index).unwrap(), whole.surfaces);
    }
    let checked = verify(&store, &[], |_| {}).unwrap();
    assert_eq!((checked.manifests, checked.shards, checked.findings.len()), (4, 8, 0), "{checked:?}");
}

#[test]
fn other_maps_rules_and_code_have_sets_of_their_own() {
    let (map, rules) = (street(), SceneryRules::default());
    let other = SceneryRules { tree_density: 0.1, ..rules.clone() };
    let store = Store::open("memory:").unwrap();
    let set = |hash: &str, rules, code: &str| {
        TileStore::new(&store, (&map, hash), (rules, catalogue::Catalogue::built_in()), code).unwrap().set()
    };
    let sets = [set("h", &rules, "1"), set("i", &rules, "1"), set("h", &other, "1"), set("h", &rules, "2")];
    assert_eq!(BTreeSet::from(sets).len(), 4);
    assert_eq!(set("h", &rules, "1"), sets[0]);
}

#[test]
fn a_tile_that_was_cut_short_is_made_again() {
    let (map, rules) = (street(), SceneryRules::default());
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path()).unwrap();
    let tiles = TileStore::new(&store, (&map, "h"), (&rules, catalogue::Catalogue::built_in()), "1").unwrap();
    let index = TileIndex { x: 1, y: 0 };
    let whole = tiles.surfaces(index).unwrap();
    let path = folder.path().join(keys::tile(tiles.set(), index, "surfaces"));
    let bytes = std::fs::read(&path).unwrap();
    std::fs::write(&path, &bytes[..100]).unwrap();
    let problems = verify(&store, &[], |_| {}).unwrap().findings;
    assert!(matches!(problems[..], [ref one] if matches!(one.problem, Problem::Size { .. })), "{problems:?}");
    assert_eq!(tiles.surfaces(index).unwrap(), whole);
    assert_eq!(std::fs::read(&path).unwrap(), bytes);
    // A damaged manifest, too.
    let manifest = folder.path().join(Scope::Tile { set: tiles.set(), index }.manifest("tiles"));
    let sound = std::fs::read(&manifest).unwrap();
    std::fs::write(&manifest, "{").unwrap();
    assert_eq!(tiles.surfaces(index).unwrap(), whole);
    assert_eq!(std::fs::read(&manifest).unwrap(), sound);
}
