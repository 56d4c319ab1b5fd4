//! Reading, preparing and querying a network of Town03's size, and CARLA's towns where they are at hand.

use divan::{Bencher, black_box};
use nalgebra::Point3;
use opendrive::{Cubic, Curve, Geometry, LaneType, Map, Network, Road, write};
use testkit::both_ways;

fn main() {
    divan::main();
}

/// 369 roads of four lanes on a grid, lines, arcs and spirals in turn.
fn network() -> Network {
    let road = |i: u32| Road {
        id: i.to_string(),
        length_m: 30.0,
        plan_view: vec![Geometry {
            x_m: f64::from(i % 20) * 32.0,
            y_m: f64::from(i / 20) * 32.0,
            hdg_rad: f64::from(i),
            length_m: 30.0,
            curve: match i % 3 {
                0 => Curve::Line,
                1 => Curve::Arc { curvature: 0.02 },
                _ => Curve::Spiral { curvature_start: 0.0, curvature_end: 0.05 },
            },
            ..Geometry::default()
        }],
        elevation: vec![Cubic { b: 0.01, ..Cubic::default() }],
        sections: vec![both_ways(&[(LaneType::Driving, 3.5), (LaneType::Sidewalk, 3.5)])],
        ..Road::default()
    };
    Network { roads: (0..369).map(road).collect(), ..Network::default() }
}

#[divan::bench]
fn parse(bencher: Bencher<'_, '_>) {
    let text = write(&network());
    bencher.bench(|| Network::parse(black_box(&text)));
}

#[divan::bench]
fn prepare(bencher: Bencher<'_, '_>) {
    bencher.with_inputs(network).bench_values(Map::new);
}

#[divan::bench]
fn nearest_driving_lane_10k(bencher: Bencher<'_, '_>) {
    let map = Map::new(network());
    let at = |i: u32, step: f64, size: f64| (f64::from(i) * step).rem_euclid(size);
    let points: Vec<_> = (0..10_000)
        .map(|i| Point3::new(at(i, 61.803, 640.0), at(i, 38.197, 600.0), at(i, 0.7, 2.0)))
        .collect();
    bencher.bench(|| {
        points.iter().filter_map(|p| map.nearest_driving_lane(*p)).map(|h| h.distance_m).sum::<f64>()
    });
}

/// A CARLA town; without it the network above.
fn town(name: &str) -> Network {
    testkit::real_map(name).map_or_else(network, |map| map.network().clone())
}

#[divan::bench(args = ["Town03", "Town11"], sample_count = 5, sample_size = 1)]
fn prepare_town(bencher: Bencher<'_, '_>, name: &str) {
    bencher.with_inputs(|| town(name)).bench_values(Map::new);
}

#[divan::bench(args = ["Town03", "Town11"], sample_count = 5, sample_size = 1)]
fn junction_areas(bencher: Bencher<'_, '_>, name: &str) {
    let map = Map::new(town(name));
    bencher.bench(|| (0..map.junctions().len()).map(|j| map.junction_area(j).len()).sum::<usize>());
}

#[divan::bench(args = ["Town03", "Town11"], sample_count = 5, sample_size = 1)]
fn stop_lines(bencher: Bencher<'_, '_>, name: &str) {
    let map = Map::new(town(name));
    bencher.bench(|| map.stop_lines().len());
}
