//! A full scene, 400 vehicles and 480 walkers wished for, on a real map where one is at hand: time of 100 steps (5 s of
//! traffic; 20 times real time is 250 ms), and of the preparation alone.

#[path = "../tests/common/mod.rs"]
mod common;

use std::ops::ControlFlow;

use traffic::{SceneInput, simulate};

fn main() {
    divan::main();
}

#[divan::bench(args = [0, 100, 200], sample_count = 3, sample_size = 1)]
fn town03_400_vehicles_480_walkers(bencher: divan::Bencher<'_, '_>, steps: u32) {
    let Some(map) = common::carla("Town03.xodr") else { return };
    let mut scene = common::scene(f64::from(steps) * 0.05);
    scene.warmup_s = 0.0;
    scene.spawn_radius_m = 2000.0;
    scene.spawn_separation_m = 12.0;
    scene.background_vehicles = Some(470);
    scene.walkers = 480;
    let settings = common::settings();
    let agents = common::agents_on(&map, 8, 7);
    // Some of the points turn out to be taken.
    let lights = common::lights(&map);
    let input = SceneInput {
        map: &map,
        scene: &scene,
        agents: &agents,
        hazards: &[],
        settings: &settings,
        fixed: &lights,
        first_id: 1000,
    };
    bencher.bench(|| {
        let log = simulate(&input, &mut |_, _| ControlFlow::Continue(())).expect("a log");
        assert!(
            (380..=480).contains(&log.n_vehicles),
            "{} vehicles, {} walkers",
            log.n_vehicles,
            log.n_walkers
        );
        log
    });
}
