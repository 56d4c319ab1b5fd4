//! Styles give sound towns whatever the seed.
#![allow(clippy::unwrap_used, reason = "tests may stop")]

use std::ops::Range;

use crate::check;

use town::{TownParameters, generate, named};

/// So many seeds a round.
const SEEDS: u64 = 4;

/// So many seeds; each round of `make soak` has others.
pub(crate) fn of_round(seeds: u64) -> Range<u64> {
    let round = std::env::var("PROPTEST_RNG_SEED").ok().and_then(|seed| seed.parse().ok()).unwrap_or(1_u64);
    let first = seeds * round.saturating_sub(1);
    first..first + seeds
}

/// Judges a town under some seeds.
fn sound_with_any_seed(name: &str) {
    let parameters = named(name).unwrap();
    for seed in of_round(SEEDS) {
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
