//! What must hold of every grid of blocks.

use crate::check;

use std::collections::BTreeMap;

use nalgebra::Point3;
use opendrive::{LaneId, LaneInfo, LaneType, Map, Network};
use proptest::prelude::*;
use town::{TownError, TownParameters, generate, named};

fn build(parameters: &TownParameters) -> Network {
    match generate(parameters) {
        Ok(network) => network,
        Err(error) => panic!("{parameters:?}: {error}"),
    }
}

fn demo() -> Network {
    build(&named("convoy/demo").expect("the demo town has a name"))
}

fn check_all(network: &Network) {
    check::check("town", network);
    let map = Map::new(network.clone());
    for group in map.signal_groups() {
        // Arms that face each other: two groups at a crossing of two streets, each of two signals.
        assert_eq!(group.controllers.len(), 2);
        assert!(group.controllers.iter().all(|c| c.signals.len() == 2));
    }
    check_crosswalks(&map);
    check_sidewalks(&map);
    check_no_holes(&map);
}

/// Whether a point lies on a lane's surface; one on the border of two lanes lies on both.
fn under(map: &Map, point: Point3<f64>, filter: impl Fn(&LaneInfo) -> bool) -> bool {
    let on = |t_m: f64, width_m: f64| t_m.abs() <= 0.5 * width_m + 1e-6;
    map.lanes_within(point, 6.0, filter)
        .iter()
        .any(|hit| on(hit.t_m, hit.width_m) && hit.distance_m - hit.t_m.abs() < 0.02)
}

fn check_crosswalks(map: &Map) {
    assert!(!map.crosswalks().is_empty());
    for crosswalk in map.crosswalks() {
        let n = crosswalk.polygon.len() as f64;
        let middle =
            Point3::from(crosswalk.polygon.iter().map(|p| p.coords).sum::<nalgebra::Vector3<f64>>() / n);
        for corner in &crosswalk.polygon {
            for part in [0.0, 0.3, 0.6, 0.98] {
                let point = middle + (corner - middle) * part;
                assert!(
                    under(map, point, |l| !l.lane_type.is_walkable()),
                    "crosswalk {} off the road",
                    crosswalk.id
                );
                assert!(
                    !under(map, point, |l| l.lane_type.is_walkable()),
                    "crosswalk {} on a sidewalk",
                    crosswalk.id
                );
            }
            // Just beyond the kerb there is a sidewalk to come from.
            let beyond = middle + (corner - middle) * 1.03;
            let on_side = under(map, beyond, |l| l.lane_type.is_walkable());
            assert!(on_side, "crosswalk {} leads nowhere", crosswalk.id);
        }
    }
}

fn check_sidewalks(map: &Map) {
    for lane in map.lanes().iter().filter(|l| l.lane_type.is_walkable()) {
        let line = map.lane_polyline(lane.id, 0.2);
        for point in line.centre {
            assert!(
                !under(map, point, |l| !l.lane_type.is_walkable()),
                "{:?} runs over another lane",
                lane.id
            );
        }
    }
}

/// Draws all lanes into a grid: ground that is enclosed by them must be a whole block.
fn check_no_holes(map: &Map) {
    const CELL_M: f64 = 0.2;
    const BLOCK_M2: f64 = 250.0;
    let [north, south, east, west] = map.network().header.bounds_m.expect("bounds");
    let (columns, rows) = (((east - west) / CELL_M) as usize + 1, ((north - south) / CELL_M) as usize + 1);
    let mut paved = vec![false; columns * rows];
    for lane in map.lanes() {
        // The samples of a section are common to its lanes: no cracks between them. Between roads there are
        // cracks as wide as the chords are off.
        let samples = map.section_samples(lane.id.road, lane.id.section, 0.002);
        let line = map.lane_polyline_at(lane.id, &samples);
        for i in 1..line.s.len() {
            let ring = [line.left[i - 1], line.left[i], line.right[i], line.right[i - 1]];
            let ring = ring.map(|p| {
                assert!(p.x > west && p.x < east && p.y > south && p.y < north, "outside the stated bounds");
                [(p.x - west) / CELL_M, (p.y - south) / CELL_M]
            });
            fill(&ring, columns, &mut paved);
        }
    }
    let mut seen = paved.clone();
    for start in 0..seen.len() {
        if seen[start] {
            continue;
        }
        let (mut stack, mut cells) = (vec![start], 0usize);
        seen[start] = true;
        while let Some(cell) = stack.pop() {
            cells += 1;
            let (x, y) = (cell % columns, cell / columns);
            let near = [(x > 0, cell.wrapping_sub(1)), (x + 1 < columns, cell + 1)];
            let rest = [(y > 0, cell.wrapping_sub(columns)), (y + 1 < rows, cell + columns)];
            for (_, cell) in near.into_iter().chain(rest).filter(|(inside, _)| *inside) {
                if !seen[cell] {
                    seen[cell] = true;
                    stack.push(cell);
                }
            }
        }
        let area = cells as f64 * CELL_M * CELL_M;
        let at = [west + (start % columns) as f64 * CELL_M, south + (start / columns) as f64 * CELL_M];
        assert!(area > BLOCK_M2, "hole of {area} m2 at {at:?}");
    }
}

/// Marks the cells whose centre is in a convex or nearly convex ring; seams get no gaps, as rings share their
/// edges.
fn fill(ring: &[[f64; 2]], columns: usize, cells: &mut [bool]) {
    let low = ring.iter().map(|p| p[1]).fold(f64::INFINITY, f64::min) as usize;
    let high = ring.iter().map(|p| p[1]).fold(0.0, f64::max).ceil() as usize;
    for row in low..high {
        let y = row as f64 + 0.5;
        let mut cuts: Vec<f64> = Vec::new();
        for (i, a) in ring.iter().enumerate() {
            let b = &ring[(i + 1) % ring.len()];
            // Both rings of a shared edge must cut it at the same bits: a diagonal may run through cell
            // centres.
            let (a, b) = if a[1] <= b[1] { (a, b) } else { (b, a) };
            if (a[1] <= y) != (b[1] <= y) {
                cuts.push(a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]));
            }
        }
        cuts.sort_by(f64::total_cmp);
        for pair in cuts.chunks_exact(2) {
            for column in (pair[0] - 0.5).ceil() as usize..(pair[1] - 0.5).ceil() as usize {
                cells[row * columns + column] = true;
            }
        }
    }
}

#[test]
fn the_demo_town_holds_together() {
    check_all(&demo());
}

#[test]
fn the_demo_town_has_what_it_promises() {
    let network = demo();
    let map = Map::new(network.clone());
    let (columns, rows) = (4, 3);
    assert_eq!(network.junctions.len(), columns * rows + 2 * (columns + rows));
    assert_eq!(network.controllers.len(), 2 * columns * rows);
    let lights = map.signals().iter().filter(|s| s.dynamic && s.kind == "1000001").count();
    assert_eq!(lights, 4 * columns * rows);
    let yields = map.signals().iter().filter(|s| s.kind == "205").count();
    assert_eq!(yields, 2 * (columns + rows));
    assert_eq!(map.crosswalks().len(), lights + yields);
    // Limits change wherever a street meets the avenue or the ring.
    assert!(map.signals().iter().any(|s| s.kind == "274" && s.value == Some(60.0)));
    for lane_type in
        [LaneType::Driving, LaneType::Sidewalk, LaneType::Shoulder, LaneType::Parking, LaneType::Median]
    {
        assert!(map.lanes().iter().any(|l| l.lane_type == lane_type), "no {lane_type}");
    }
    // Each parking lane has as many spaces of 6 m as fit between its tapers, 6 m each.
    let mut spaces: BTreeMap<LaneId, usize> = BTreeMap::new();
    for space in map.objects().iter().filter(|o| o.kind == "parkingSpace") {
        let on = map.nearest_lane(space.pose.translation().into(), |_| true).expect("a lane");
        assert_eq!(map.lane(on.lane).map(|l| l.lane_type), Some(LaneType::Parking));
        assert!(on.t_m.abs() < 0.01, "space {} is {} m off its lane", space.id, on.t_m);
        *spaces.entry(on.lane).or_default() += 1;
    }
    let rows: Vec<&LaneInfo> = map.lanes().iter().filter(|l| l.lane_type == LaneType::Parking).collect();
    assert!(rows.len() > 20, "only {} parking lanes", rows.len());
    for lane in rows {
        let fit = ((lane.s_length() - 12.0) / 6.0).floor() as usize;
        assert_eq!(spaces.get(&lane.id), Some(&fit), "{:?} of {} m", lane.id, lane.s_length());
    }
    let heights: Vec<f64> = network.roads.iter().flat_map(|r| &r.elevation).map(|c| c.a).collect();
    let (low, high) = heights.iter().fold((f64::MAX, f64::MIN), |(l, h), z| (l.min(*z), h.max(*z)));
    assert!(high - low > 1.0 && high - low <= 4.0, "{low} to {high}");
}

#[test]
fn impossible_towns_are_refused() {
    let refused = |p: TownParameters| generate(&p).expect_err("must be refused");
    let base = TownParameters::default;
    let parameter = |error: TownError| match error {
        TownError::Parameter { name, .. } => name,
        TownError::TooTight { .. } => "tight",
        other => panic!("{other}"),
    };
    let grid = |change: fn(&mut TownParameters)| {
        let mut parameters = base();
        change(&mut parameters);
        parameter(refused(parameters))
    };
    assert_eq!(grid(|p| p.grid.columns = 0), "grid.columns");
    assert_eq!(grid(|p| p.grid.block_m = [90.0, 80.0]), "grid.block_m[1]");
    assert_eq!(grid(|p| p.grid.relief_m = f64::NAN), "grid.relief_m");
    assert_eq!(grid(|p| p.sidewalk_m = 1.0), "sidewalk_m");
    assert_eq!(grid(|p| p.grid.block_m = [40.0, 41.0]), "tight");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(6))]
    #[test]
    fn every_town_holds_together(seed in any::<u64>(), columns in 1..4u32, rows in 1..4u32, lane_width_m in 3.0..3.8f64,
                                 kerb_radius_m in 4.5..7.0f64, sidewalk_m in 2.0..3.5f64,
                                 median_m in prop::sample::select(vec![0.0, 2.0, 3.5])) {
        let mut parameters = TownParameters { seed, lane_width_m, kerb_radius_m, sidewalk_m, ..TownParameters::default() };
        (parameters.grid.columns, parameters.grid.rows, parameters.grid.median_m) = (columns, rows, median_m);
        check_all(&build(&parameters));
    }
}
