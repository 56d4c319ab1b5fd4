//! Styles give sound towns whatever the seed.
#![allow(clippy::unwrap_used, reason = "tests may stop")]

use crate::check;

use town::{TownParameters, generate, named};

/// Judges a town under the first eight seeds.
fn sound_with_any_seed(name: &str) {
    let parameters = named(name).unwrap();
    for seed in 0..8 {
        let network = generate(&TownParameters { seed, ..parameters.clone() });
        match network {
            Ok(network) => check::check(&format!("{name} with seed {seed}"), &network),
            Err(error) => panic!("{name} with seed {seed}: {error}"),
        }
    }
}

#[test]
fn down_towns() {
    sound_with_any_seed("convoy/08");
}

#[test]
fn cities_with_a_viaduct() {
    sound_with_any_seed("convoy/05");
}

#[test]
fn highways() {
    sound_with_any_seed("convoy/06");
}

#[test]
fn mountain_towns() {
    sound_with_any_seed("convoy/04");
}
