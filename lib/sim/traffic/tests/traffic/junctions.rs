//! The order at junctions: full queues on all arms of roundabouts.

use crate::common::{
    collisions, queues_at_roundabout, roundabout, roundabout_entry_m, run, scene, settings, tracks,
};
use schema::tables::StateRow;

/// Vehicles in each queue, metres from one to the next, seconds of simulated time.
const QUEUE: usize = 32;
const QUEUED_M: f64 = 10.0;
const DURATION_S: f64 = 180.0;
/// Nobody stands longer than this near a ring, seconds: the longest gridlock that traffic may show.
const LONGEST_S: f64 = 60.0;
/// Of the capacity of a real roundabout, as much on every arm, and on all together.
const LEAST_SHARE: [f64; 2] = [0.4, 0.55];

/// Vehicles per hour that come in by each arm of a one-lane roundabout if all arms are full and half of those
/// on the ring leave it at each arm: those who pass an arm are then as many as those who come in there, and
/// the capacity of an entry is 1380 exp(-0.00102 v) for v vehicles that pass (Highway Capacity Manual, 6th
/// edition, equation 22-1).
fn capacity_vph() -> f64 {
    (0..100).fold(600.0f64, |q, _| 0.5 * (q + 1380.0 * frames::math::exp(-0.00102 * q)))
}

fn speed(s: &StateRow) -> f64 {
    s.velocity_mps.iter().map(|v| f64::from(v * v)).sum::<f64>().sqrt()
}

fn full_queues_flow(radius_m: f64, seed: u64) {
    let map = roundabout(radius_m, 400.0);
    let mut scene = scene(DURATION_S);
    scene.seed = seed;
    let agents = queues_at_roundabout(radius_m, QUEUE, QUEUED_M, seed);
    let log = run(&map, &scene, &agents, &settings());
    let off = |s: &StateRow| (s.xyz_m[0] * s.xyz_m[0] + s.xyz_m[1] * s.xyz_m[1]).sqrt();
    let line_m = roundabout_entry_m(radius_m)[0];
    let mut entered = [0u32; 4];
    for (id, track) in &tracks(&log) {
        if track.iter().any(|s| off(s) < line_m - 2.5) {
            entered[(usize::from(*id) - 1) / QUEUE] += 1;
        }
        let near = track.iter().map(|s| speed(s) < 0.1 && off(s) < line_m + 6.0);
        let longest = near.fold((0, 0), |(now, most), stands| {
            let now = if stands { now + 1 } else { 0 };
            (now, most.max(now))
        });
        let longest_s = f64::from(longest.1) * 0.05;
        assert!(
            longest_s < LONGEST_S,
            "{id} stands for {longest_s} s at a radius of {radius_m} m, seed {seed}"
        );
    }
    let touching = collisions(&log, false);
    assert!(touching.is_empty(), "{:?} at a radius of {radius_m} m, seed {seed}", touching[0]);
    let vph = entered.map(|n| f64::from(n) * 3600.0 / DURATION_S);
    let [least, all] = LEAST_SHARE.map(|share| share * capacity_vph());
    assert!(vph.iter().all(|v| *v > least), "{vph:?} at a radius of {radius_m} m, seed {seed}");
    assert!(vph.iter().sum::<f64>() > 4.0 * all, "{vph:?} at a radius of {radius_m} m, seed {seed}");
}

#[test]
fn full_queues_flow_round_a_small_ring() {
    // The pieces of the ring between the arms are too short for a car.
    full_queues_flow(14.0, 1);
}

#[test]
fn full_queues_flow_round_a_ring() {
    // Scenes that stood for good where the vehicle ahead may have a younger reservation, and where a standing
    // one keeps its turn.
    [1, 3].into_iter().for_each(|seed| full_queues_flow(18.0, seed));
}

#[test]
fn full_queues_flow_round_a_wide_ring() {
    // One car has room on a piece. Scenes as before.
    [2, 4, 8].into_iter().for_each(|seed| full_queues_flow(28.0, seed));
}
