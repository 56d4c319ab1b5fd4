//! Every named town is sound, and is the same town every time.
#![allow(clippy::unwrap_used)] // Tests may stop.

mod check;

use opendrive::write;
use town::{TownError, TownParameters, generate, named, names};

#[test]
fn every_named_town_is_sound() {
    for name in names() {
        let parameters = named(name).unwrap();
        check::check(name, &generate(&parameters).unwrap());
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
