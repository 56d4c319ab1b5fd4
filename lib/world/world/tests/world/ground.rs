//! What lies on the ground of a town: water, rails, islands, junctions.
#![allow(clippy::unwrap_used, reason = "tests may stop")]

use crate::common::{Columns, around, bare, empty_moment, from_above, named};
use frames::{Object, Pose, World};
use nalgebra::Point3;
use opendrive::{JunctionInfo, LaneInfo, LaneType, Map};
use schema::tables::{ActorRow, FrameRow};
use schema::{ActorKind, Tag};

#[test]
fn rivers_lie_under_bridges() {
    let map = named("convoy/01");
    let river = map.objects().iter().find(|o| o.is_water()).unwrap();
    let water_m = river.outlines[0].base[0].z;
    let bridged = map.network().roads.iter().position(|r| !r.bridges.is_empty()).unwrap();
    let bridge = &map.network().roads[bridged].bridges[0];
    let at = |s: f64, t: f64| map.road_point(bridged as u32, s, t, 0.0).unwrap();
    let middle = at(bridge.s + 0.5 * bridge.length_m, 1.5);
    let (actors, world) = around(&map, middle.coords.into());
    let frame = FrameRow::default();
    let snapshot = world.snapshot(&empty_moment(&frame), middle.coords.into(), 400.0);
    let heights = |hits: &[(f64, Tag)], tag: Tag| -> Vec<f64> {
        hits.iter().filter(|(_, t)| *t == tag).map(|(z, _)| *z).collect()
    };

    let columns = Columns::new(&snapshot);
    let hits = columns.at(middle.x, middle.y);
    assert!(heights(&hits, Tag::Road).iter().any(|z| (z - middle.z).abs() < 0.02), "{hits:?}");
    assert!(heights(&hits, Tag::Water).iter().any(|z| (z - water_m).abs() < 0.01), "{hits:?}");
    assert!(heights(&hits, Tag::Terrain).iter().all(|z| *z < water_m), "{hits:?}");
    assert!(middle.z - water_m > 3.0, "the deck is {} m over the water", middle.z - water_m);
    assert!(!heights(&hits, Tag::Bridge).is_empty(), "{hits:?}");

    // Beside the bridge there is water, and nothing over it.
    let beside = at(bridge.s + 0.5 * bridge.length_m, 20.0);
    let hits = columns.at(beside.x, beside.y);
    assert_eq!(columns.top(beside.x, beside.y).1, Tag::Water, "{hits:?}");
    // The shore follows the outline, and nothing stands in the water.
    let ring: Vec<Point3<f64>> = river.outlines[0].base.clone();
    let mut tested = 0;
    for (a, b) in ring.iter().zip(&ring[1..]) {
        let along = (b - a) / (b - a).norm();
        let left = nalgebra::Vector3::new(-along.y, along.x, 0.0);
        let edge = nalgebra::center(a, b);
        if (edge - middle).norm() > 140.0 {
            continue;
        }
        let tops = [-1.2, 1.2].map(|aside| {
            let p = edge + left * aside;
            columns.top(p.x, p.y)
        });
        if tops.iter().all(|(_, t)| matches!(t, Tag::Water | Tag::Terrain)) {
            tested += 1;
            let water = tops.iter().filter(|(_, t)| *t == Tag::Water).count();
            assert_eq!(water, 1, "at {edge} {tops:?}");
            let [right, left] = tops.map(|(z, _)| z);
            assert!((left - right).abs() < 1.5, "the shore at {edge} is a step: {tops:?}");
        }
    }
    assert!(tested > 10, "only {tested} places on the shore");
    let wet = |x: f64, y: f64| columns.at(x, y).iter().any(|(_, t)| *t == Tag::Water);
    for thing in actors.iter().filter(|a| a.kind != ActorKind::Surface && a.kind != ActorKind::Sign) {
        let pose = Pose::<World, Object>::from_xyz_wxyz(thing.xyz_m, thing.quaternion);
        let share = if thing.kind == ActorKind::Building { 0.5 } else { 0.0 };
        for (u, v) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0), (0.0, 0.0)] {
            let p = pose * Point3::new(share * u * thing.length_m, share * v * thing.width_m, 0.0);
            assert!(
                !wet(p.x, p.y) || p.z > water_m + 2.0,
                "{} {} stands in the river",
                thing.model,
                thing.id
            );
        }
    }
}

#[test]
fn rails_lie_on_their_beds_and_in_level_crossings() {
    let map = named("convoy/07");
    let tracks: Vec<&LaneInfo> = map.lanes().iter().filter(|l| l.lane_type == LaneType::Rail).collect();
    let crossing = tracks.iter().find(|l| l.junction.is_some()).unwrap();
    let middle =
        |l: &LaneInfo, t: f64| map.lane_point(l.id, 0.5 * (l.s_start + l.s_end), t).unwrap().position;
    let centre = middle(crossing, 0.0);
    let (actors, world) = around(&map, centre.coords.into());
    let frame = FrameRow::default();
    let snapshot = world.snapshot(&empty_moment(&frame), centre.coords.into(), 400.0);
    let columns = Columns::new(&snapshot);
    let top = |p: Point3<f64>| columns.top(p.x, p.y);
    // Half of 1505 mm to either side of the middle.
    for side in [-0.7525, 0.7525] {
        let rail = middle(crossing, side);
        let (z, tag) = top(rail);
        assert!(tag == Tag::RailTrack && (0.0..0.02).contains(&(z - rail.z)), "{tag:?} {}", z - rail.z);
    }
    assert_eq!(top(centre).1, Tag::Road, "between the rails of a crossing is road");
    // From ballast to ballast there is road.
    for (i, side) in (0..=40).flat_map(|i| [-0.4, 0.4].map(|side| (i, side))) {
        let s = crossing.s_start + crossing.s_length() * f64::from(i) / 40.0;
        let p = map.lane_point(crossing.id, s, side).unwrap().position;
        let (z, tag) = top(p);
        let built = matches!(tag, Tag::Road | Tag::RoadLine | Tag::RailTrack);
        assert!(built && (-0.02..0.1).contains(&(z - p.z)), "{tag:?} {} at {p}", z - p.z);
    }
    let reach = |l: &&&LaneInfo| (middle(l, 0.0) - centre).norm() < 140.0 && l.junction.is_none();
    let open = tracks.iter().find(reach).unwrap();
    let rail = middle(open, 0.7525);
    let (z, tag) = top(rail);
    assert!(tag == Tag::RailTrack && (z - rail.z - 0.17).abs() < 0.02, "{tag:?} {}", z - rail.z);
    assert_eq!(top(middle(open, 0.0)).1, Tag::RailTrack, "ballast or a sleeper");
    // Neither crowns nor lamps reach over the rails, and no house looks at them.
    let track = |l: &LaneInfo| l.lane_type == LaneType::Rail;
    for thing in actors
        .iter()
        .filter(|a| matches!(a.kind, ActorKind::Vegetation | ActorKind::Pole | ActorKind::Building))
    {
        let reach = 0.5 * thing.length_m.max(thing.width_m);
        let at = Point3::from(thing.xyz_m);
        for hit in map.lanes_within(at, reach + 3.0, track) {
            let clear = hit.distance_m - 0.5 * hit.width_m;
            let needed = if thing.model.starts_with("tree.") { 0.9 * reach } else { 0.3 };
            assert!(clear > needed, "{} {} is {clear:.2} m from the rails", thing.model, thing.id);
        }
    }
}

#[test]
fn nobody_lives_on_the_island_of_a_roundabout() {
    let map = named("convoy/03");
    let ring: Vec<Point3<f64>> = (map.network().roads.iter().enumerate())
        .filter(|(_, road)| road.name.ends_with("ring"))
        .filter_map(|(i, road)| map.road_point(i as u32, 0.5 * road.length_m, 0.0, 0.0))
        .collect();
    let corners = ring.iter().fold([ring[0]; 2], |[low, high], p| [low.inf(p), high.sup(p)]);
    let centre = nalgebra::center(&corners[0], &corners[1]);
    assert!(ring.len() > 2 && ring.iter().all(|p| (p - centre).norm() < 22.0), "{ring:?}");
    let (actors, _) = around(&map, centre.coords.into());
    let near: Vec<&ActorRow> = actors
        .iter()
        .filter(|a| a.kind == ActorKind::Building)
        .filter(|a| (a.xyz_m[0] - centre.x).abs() + (a.xyz_m[1] - centre.y).abs() < 20.0)
        .collect();
    assert!(near.is_empty(), "{near:?}");
    assert!(actors.iter().filter(|a| a.kind == ActorKind::Building).count() > 20);
}

/// Patches of land in view that other ground surrounds: area and a place of each.
fn enclosed_land(tags: &[Option<Tag>], n: usize, cell_m: f64) -> Vec<(f64, [usize; 2])> {
    let mut left: Vec<bool> = tags.iter().map(|t| *t == Some(Tag::Terrain)).collect();
    let mut found = Vec::new();
    for start in 0..left.len() {
        if !std::mem::take(&mut left[start]) {
            continue;
        }
        let (mut open, mut next, mut cells) = (false, 0, vec![start]);
        while let Some(cell) = cells.get(next).copied() {
            next += 1;
            let (x, y) = (cell % n, cell / n);
            open |= x == 0 || y == 0 || x + 1 == n || y + 1 == n;
            let near = [
                (x > 0).then(|| cell - 1),
                (x + 1 < n).then_some(cell + 1),
                (y > 0).then(|| cell - n),
                (y + 1 < n).then_some(cell + n),
            ];
            cells.extend(near.into_iter().flatten().filter(|i| std::mem::take(&mut left[*i])));
        }
        if !open {
            found.push((cells.len() as f64 * cell_m * cell_m, [start % n, start / n]));
        }
    }
    found
}

fn check_junctions(map: &Map, name: &str) {
    const CELL_M: f64 = 0.15;
    let mut junctions = 0;
    // Those in the middle: in Town03 that is a roundabout made of many.
    let mut middle: Vec<&JunctionInfo> = map.junctions().iter().filter(|j| j.roads.len() > 2).collect();
    middle.sort_by(|a, b| a.centre.coords.norm().total_cmp(&b.centre.coords.norm()));
    for junction in middle.into_iter().take(10) {
        let [low, high] = junction.bounds;
        let half_m = 0.5 * (high.x - low.x).max(high.y - low.y) + 12.0;
        if half_m > 60.0 || high.z - low.z > 3.0 {
            continue;
        }
        junctions += 1;
        let centre = junction.centre.coords.into();
        let world = bare(map, centre);
        let frame = FrameRow::default();
        let snapshot = world.snapshot(&empty_moment(&frame), centre, 3.0 * half_m);
        let (tags, n) = from_above(&snapshot, [centre[0], centre[1]], half_m, CELL_M);
        for (area, [x, y]) in enclosed_land(&tags, n, CELL_M) {
            let at = [x, y].map(|v| v as f64 * CELL_M - half_m);
            let at = [centre[0] + at[0], centre[1] + at[1]];
            // The narrowest slivers may stay; larger ground is an island.
            assert!(!(0.4..100.0).contains(&area), "{name}: {area:.1} m2 of land at {at:?}, {}", junction.id);
        }
    }
    assert!(junctions > 5, "{name}: {junctions}");
}

#[test]
fn junctions_have_no_holes() {
    for name in ["convoy/03", "convoy/08"] {
        check_junctions(&named(name), name);
    }
    for (name, map) in testkit::real_maps(&["Town03"]) {
        check_junctions(&map, name);
    }
}
