//! Walkers among walkers.

mod common;

use std::collections::BTreeMap;

use common::{agent, run, scene, settings, straight, tracks};
use schema::tables::StateRow;
use traffic::SceneLog;

/// Pairs of walkers whose boxes overlap in any frame.
fn overlaps(log: &SceneLog) -> Vec<(i32, u16, u16)> {
    let size: BTreeMap<u16, [f64; 2]> =
        log.actors.iter().filter(|a| a.kind == "walker").map(|a| (a.id, [a.length_m, a.width_m])).collect();
    let mut found = Vec::new();
    for frame in log.states.chunk_by(|a, b| a.frame == b.frame) {
        let walkers: Vec<&StateRow> = frame.iter().filter(|s| size.contains_key(&s.id)).collect();
        for (i, a) in walkers.iter().enumerate() {
            for b in &walkers[i + 1..] {
                if (a.xyz_m[0] - b.xyz_m[0]).abs() < 1.0 && common::touch(a, size[&a.id], b, size[&b.id]) {
                    found.push((a.frame, a.id, b.id));
                }
            }
        }
    }
    found
}

#[test]
fn walkers_never_overlap_and_all_get_on() {
    // A sidewalk each side, walked in both directions: one walker on 2 to 13 m of it.
    for (seed, count, length_m) in
        [(1, 12, 80.0), (2, 30, 80.0), (3, 60, 80.0), (4, 40, 60.0), (5, 60, 120.0)]
    {
        let map = straight(length_m);
        let mut scene = scene(60.0);
        scene.seed = seed;
        scene.walkers = count;
        scene.walker_cross_factor = 0.0;
        let log = run(&map, &scene, &[agent(0, [20.0, -1.75, 0.0], 0.0)], &settings());
        assert_eq!(log.n_walkers, count);
        assert_eq!(overlaps(&log), [], "seed {seed}");
        let tracks = tracks(&log);
        for actor in log.actors.iter().filter(|a| a.kind == "walker") {
            let track = &tracks[&actor.id];
            // On the sidewalk, 3.5 to 6.5 m from the middle, with the feet well on it.
            assert!(track.iter().all(|s| (3.75..=6.25).contains(&s.xyz_m[1].abs())), "seed {seed}");
            assert!(track.iter().all(|s| (0.0..=length_m).contains(&s.xyz_m[0])), "seed {seed}");
            // Everybody gets on, in each quarter of a minute.
            for part in track.chunks(300).filter(|c| c.len() == 300) {
                let way: f64 = part.windows(2).map(|p| (p[1].xyz_m[0] - p[0].xyz_m[0]).abs()).sum();
                assert!(way > 3.0, "seed {seed}: {} walks {way} m in 15 s", actor.id);
            }
            // Nobody leaps: aside at most 0.8 m/s, but for what is turned at the ends.
            for pair in track.windows(2) {
                let aside = (pair[1].xyz_m[1] - pair[0].xyz_m[1]).abs() / 0.05;
                assert!(aside < 1.0, "seed {seed}: {aside} m/s aside");
            }
        }
    }
}
