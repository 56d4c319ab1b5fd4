//! Every named town is sound, and is the same town every time.
#![allow(clippy::unwrap_used, reason = "tests may stop")]

use crate::check;
use crate::seeds::of_round;

use opendrive::{Network, Road, write};
use proptest::prelude::*;
use town::{TownError, TownParameters, generate, named, names};

#[test]
fn every_named_town_is_sound() {
    for name in names() {
        let parameters = named(name).unwrap();
        check::check(name, &generate(&parameters).unwrap());
    }
}

/// Named towns have smaller seeds of their own.
const FIRST_OTHER: u64 = 100;
/// Towns that take long to judge.
const LARGE: [&str; 2] = ["convoy/09", "convoy/10"];

#[test]
fn towns_of_other_seeds_are_sound() {
    for name in names() {
        let seeds = of_round(if LARGE.contains(&name) { 1 } else { 2 });
        for seed in seeds.map(|seed| FIRST_OTHER + seed) {
            let parameters = TownParameters { seed, ..named(name).unwrap() };
            check::check(&format!("{name}, seed {seed}"), &generate(&parameters).unwrap());
        }
    }
}

#[test]
fn the_seed_decides() {
    for name in names() {
        let parameters = named(name).unwrap();
        let text = write(&generate(&parameters).unwrap());
        assert_eq!(text, write(&generate(&parameters).unwrap()), "{name}");
        let other = TownParameters { seed: parameters.seed + 1, ..parameters };
        assert_ne!(text, write(&generate(&other).unwrap()), "{name}");
    }
    assert_eq!(named("convoy/nowhere"), None);
}

#[test]
fn parameter_files_are_checked() {
    let read = |text: &str| TownParameters::from_toml(text);
    let ok = read("seed = 4\nstyle = \"city\"\n[city]\ncolumns = 8\n").unwrap();
    assert_eq!((ok.seed, ok.city.columns), (4, 8));
    assert!(matches!(read("[grid]\ncolumns = 0"), Err(TownError::Parameter { name: "grid.columns", .. })));
    let region = |keys: &str| read(&format!("style = \"region\"\n[region]\n{keys}"));
    assert!(region("river = true\nrelief_m = 8.0").is_ok());
    let steep = region("coast = true\nrelief_m = 9.0");
    assert!(matches!(steep, Err(TownError::Parameter { name: "region.relief_m", .. })));
    let inside = region("towns = [\"grid\", \"river\"]");
    assert!(matches!(inside, Err(TownError::Layout { problem, .. }) if problem.contains("river")));
    for (text, word) in [
        ("sede = 4", "sede"),
        ("style = \"grid\"\n[grid]\ncollums = 3", "collums"),
        ("style = \"grid\"\n[city]\ncolumns = 8", "[city]"),
        ("style = \"village\"", "village"),
        ("seed = \"four\"", "seed"),
    ] {
        match read(text) {
            Err(TownError::Toml(message)) => assert!(message.contains(word), "{message}"),
            other => panic!("{text}: {other:?}"),
        }
    }
}

/// The first fault that contains a word.
fn fault(network: &Network, word: &str) -> bool {
    check::faults(network).iter().any(|fault| fault.contains(word))
}

#[test]
fn the_checker_finds_what_is_broken() {
    let sound = generate(&named("convoy/demo").unwrap()).unwrap();
    assert!(check::faults(&sound).is_empty());
    let broken = |change: &dyn Fn(&mut Network)| {
        let mut network = sound.clone();
        change(&mut network);
        network
    };
    // Street 3 is an ordinary one; the first connecting road follows the streets.
    let way = sound.roads.iter().position(|r| r.junction.is_some()).unwrap();
    assert!(fault(&broken(&|n| n.roads[3].elevation[0].a += 0.05), "borders are"));
    assert!(fault(&broken(&|n| n.roads[way].elevation[0].b += 0.01), "crease"));
    assert!(fault(&broken(&|n| n.roads[3].plan_view[0].hdg_rad += 0.004), "kink"));
    assert!(fault(&broken(&|n| n.roads[3].sections[0].right[0].widths[0].a = -1.0), "is -1"));
    assert!(fault(&broken(&|n| n.roads[3].sections[0].right[0].widths[0].a += 0.1), "borders are"));
    assert!(fault(&broken(&|n| n.roads[way].plan_view[0].length_m += 0.5), "add up"));
    assert!(fault(&broken(&|n| n.roads[3].elevation[0].c += 0.01), "slope of"));
    let cut_off = broken(&|n| {
        n.junctions[0].connections.clear();
        let id = n.junctions[0].id.clone();
        for road in n.roads.iter_mut().filter(|r| r.junction.as_ref() == Some(&id)) {
            (road.predecessor, road.successor) = (None, None);
        }
    });
    assert!(fault(&cut_off, "leads nowhere"));
    let lights: Vec<&String> = sound.controllers.iter().flat_map(|c| &c.signals).collect();
    let is_lit = |r: &Road| r.signal_references.iter().any(|s| lights.contains(&&s.id));
    let lit = sound.roads.iter().position(is_lit).unwrap();
    assert!(fault(&broken(&|n| n.roads[lit].signal_references.clear()), "signals for lane"));
    // All signals of a junction in one phase: traffic of both streets is green at once.
    let merged = broken(&|n| {
        let ids: Vec<String> = n
            .junctions
            .iter()
            .find(|j| j.controllers.len() == 2)
            .unwrap()
            .controllers
            .iter()
            .map(|c| c.id.clone())
            .collect();
        let moved = n.controllers.iter().find(|c| c.id == ids[1]).unwrap().signals.clone();
        n.controllers.iter_mut().find(|c| c.id == ids[0]).unwrap().signals.extend(moved);
        n.controllers.iter_mut().find(|c| c.id == ids[1]).unwrap().signals.clear();
    });
    assert!(fault(&merged, "green together"));
    // A street moved sideways lies over its neighbour.
    let moved = broken(&|n| {
        let (from, to) = (n.roads[2].plan_view[0], n.roads[3].plan_view[0]);
        n.roads[3].plan_view[0].x_m += 0.5 * (from.x_m - to.x_m) + 2.0;
        n.roads[3].plan_view[0].y_m += 0.5 * (from.y_m - to.y_m) + 2.0;
    });
    assert!(fault(&moved, "lies over"));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(5))]
    #[test]
    fn cities_are_sound_whatever_the_seed(seed in any::<u64>(), columns in 6..10u32, rows in 5..8u32,
                                          disorder_m in 0.0..18.0f64, island_m in 15.0..26.0f64) {
        let mut parameters = named("convoy/03").unwrap();
        parameters.seed = seed;
        (parameters.city.columns, parameters.city.rows) = (columns, rows);
        (parameters.city.disorder_m, parameters.city.island_m) = (disorder_m, island_m);
        check::check("city", &generate(&parameters).unwrap());
    }
}
