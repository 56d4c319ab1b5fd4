//! Full scenes: 400 vehicles and 480 walkers wished for, on a town of ours and, where one is at hand, on a
//! real map; and the same town with a quarter and a half of them, for how cost grows. Time of 100 or 200
//! steps (20 times real time is 2.5 ms a step), and of the preparation alone.

#[path = "../tests/traffic/common/mod.rs"]
mod common;

use std::ops::ControlFlow;

use opendrive::Map;
use traffic::{SceneInput, simulate};

fn main() {
    divan::main();
}

/// Vehicles and walkers of a full scene.
const FULL: [u32; 2] = [400, 480];

/// Simulates a share of a full scene, in hundredths, over some steps. `taken`: how many more background
/// vehicles, in hundredths, are wished for, as some of the points turn out to be taken.
fn simulated(bencher: divan::Bencher<'_, '_>, map: &Map, share: u32, taken: u32, steps: u32) {
    let [vehicles, walkers] = FULL.map(|n| n * share / 100);
    let mut scene = common::scene(f64::from(steps) * 0.05);
    scene.warmup_s = 0.0;
    scene.spawn_radius_m = 2000.0;
    scene.spawn_separation_m = 12.0;
    scene.background_vehicles = Some((vehicles * (100 + taken) / 100) as i32 - 8);
    scene.walkers = walkers;
    let settings = common::settings();
    let agents = common::agents_on(map, 8, 7);
    let lights = common::lights(map);
    let input = SceneInput {
        catalogue: catalogue::Catalogue::built_in(),
        map,
        scene: &scene,
        agents: &agents,
        hazards: &[],
        weather: &[],
        routes: &[],
        trajectories: &[],
        settings: &settings,
        fixed: &lights,
        first_id: 1000,
    };
    bencher.bench(|| {
        let log = simulate(&input, &mut |_, _| ControlFlow::Continue(())).expect("a log");
        let (least, most) = (vehicles * 90 / 100, vehicles * 120 / 100);
        assert!(
            (least..=most).contains(&log.n_vehicles),
            "{} vehicles, {} walkers",
            log.n_vehicles,
            log.n_walkers
        );
        log
    });
}

#[divan::bench(args = [0, 100, 200], sample_count = 3, sample_size = 1)]
fn town03_400_vehicles_480_walkers(bencher: divan::Bencher<'_, '_>, steps: u32) {
    let Some(map) = testkit::real_map("Town03") else { return };
    simulated(bencher, &map, 100, 18, steps);
}

/// Hundredths of a full scene, and steps.
#[divan::bench(args = [(25, 0), (25, 200), (50, 0), (50, 200), (100, 0), (100, 200)], sample_count = 3, sample_size = 1)]
fn convoy_03_share_of_400_vehicles_480_walkers(bencher: divan::Bencher<'_, '_>, (share, steps): (u32, u32)) {
    let town = town::generate(&town::named("convoy/03").expect("our town")).expect("a town");
    simulated(bencher, &Map::new(town), share, 0, steps);
}
