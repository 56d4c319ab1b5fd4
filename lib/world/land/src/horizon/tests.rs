use glam::Vec3;
use schema::Tag;

use super::*;

fn map() -> Map {
    let lane = || testkit::both_ways(&[(opendrive::LaneType::Driving, 3.5)]);
    // A country road and, 900 m up it, a grid of streets.
    let mut roads = vec![testkit::road("0", [-1200.0, 0.0], 0.0, 1200.0, lane())];
    for i in 0..5u8 {
        let off = 110.0 * f64::from(i);
        roads.push(testkit::road(&format!("a{i}"), [0.0, off - 220.0], 0.0, 440.0, lane()));
        roads.push(testkit::road(
            &format!("b{i}"),
            [off, -220.0],
            std::f64::consts::FRAC_PI_2,
            420.0,
            lane(),
        ));
    }
    testkit::map(roads)
}

fn pieces(seed: u64, places: &[[f64; 2]]) -> Vec<HorizonPiece> {
    horizon(&map(), (seed, false), places, [400.0, 1000.0])
}

#[test]
fn pieces_are_the_same_whoever_asks() {
    let here = pieces(5, &[[-1000.0, 0.0]]);
    let both = pieces(5, &[[-1000.0, 0.0], [-700.0, 30.0]]);
    let same = here.iter().filter(|piece| both.contains(piece)).count();
    assert!(here.len() > 120 && both.len() > here.len(), "{} {}", here.len(), both.len());
    assert_eq!(same, here.len());
    assert_ne!(here, pieces(6, &[[-1000.0, 0.0]]));
    assert!(pieces(5, &[]).is_empty());
}

#[test]
fn land_has_no_gap_rises_far_from_roads_and_lies_under_them() {
    let all = pieces(5, &[[-1000.0, 0.0]]);
    let mut heights = std::collections::BTreeMap::new();
    let mut highest = 0.0f64;
    for HorizonPiece { origin_m, mesh } in &all {
        assert!(origin_m.iter().all(|v| v.is_finite()) && mesh.positions.iter().all(|p| p.is_finite()));
        for (t, part) in mesh.triangle_part.iter().enumerate() {
            if mesh.parts[usize::from(*part)].tag != Tag::Terrain {
                continue;
            }
            let [a, b, c] = mesh.corners(t);
            assert!((b - a).cross(c - a).z > 0.0, "land looks up");
            for corner in [a, b, c] {
                let at = [0, 1, 2].map(|k| origin_m[k] + f64::from(corner[k]));
                let key = [at[0], at[1]].map(|v| v.round() as i64);
                // Corners of neighbours are one place.
                let known = *heights.entry(key).or_insert(at[2]);
                assert!((known - at[2]).abs() < 1e-2, "{at:?} {known}");
                highest = highest.max(at[2]);
                if at[1].abs() < 100.0 && at[0] < 0.0 && at[0] > -1200.0 {
                    assert!((at[2] + SUNK_M).abs() < 0.1, "{at:?}");
                }
            }
        }
    }
    assert!(highest > 15.0 && highest < HILLS_M, "{highest}");
}

#[test]
fn streets_have_houses_and_open_land_has_woods_and_nothing_is_on_a_road() {
    let all = pieces(5, &[[-600.0, 0.0]]);
    let (mut houses, mut leaves) = ([0, 0], [0, 0]);
    for HorizonPiece { origin_m, mesh } in &all {
        let is_town = origin_m[0] > 0.0 && origin_m[0] < 440.0 && origin_m[1].abs() < 220.0;
        for (t, part) in mesh.triangle_part.iter().enumerate() {
            match mesh.parts[usize::from(*part)].tag {
                Tag::Building => houses[usize::from(is_town)] += 1,
                Tag::Vegetation => leaves[usize::from(is_town)] += 1,
                _ => continue,
            }
            let middle = mesh.corners(t).into_iter().sum::<Vec3>() / 3.0;
            let [x, y] = [0, 1].map(|k| origin_m[k] + f64::from(middle[k]));
            let on_road = x > -1200.0 && x < 0.0 && y.abs() < 5.0;
            assert!(!on_road, "{x} {y}");
        }
    }
    // The town is a fifteenth of the land.
    assert!(houses[1] * 5 > houses[0] && leaves[0] > 20 * leaves[1], "{houses:?} {leaves:?}");
}
