//! Where heads are, held against the map.

use std::collections::BTreeMap;

use nalgebra::{Point3, Vector2};
use schema::footprint::{LightMount, footprint};
use schema::tables::TileObjectRow;
use schema::{ActorKind, Attribute};
use settings::SceneryRules;

use crate::scenery::tests::{all_by, town_map};

/// The lights of a square in the middle of a town.
fn lights(map: &opendrive::Map, side_m: f64) -> Vec<TileObjectRow> {
    let objects = all_by(&SceneryRules::default(), map, [-0.5 * side_m; 2], side_m);
    objects.into_iter().filter(|o| o.kind == ActorKind::TrafficLight).collect()
}

fn yaw(object: &TileObjectRow) -> f64 {
    frames::Pose::<frames::World, frames::Object>::from_xyz_wxyz(object.xyz_m, object.quaternion).yaw()
}

/// From one light to another, as the way the first one looks and to its left, metres.
fn off(from: &TileObjectRow, to: &TileObjectRow) -> [f64; 2] {
    let [x, y] = [0, 1].map(|k| to.xyz_m[k] - from.xyz_m[k]);
    let (sin, cos) = frames::math::sin_cos(yaw(from));
    [x * cos + y * sin, y * cos - x * sin]
}

#[test]
fn wide_approaches_have_a_second_light() {
    // How many of them are across the junction, left of the line, and low on the pole of an arm.
    let mut found = [0; 3];
    for name in ["convoy/08", "convoy/demo", "convoy/05", "convoy/03"] {
        let lights = lights(&town_map(name), 512.0);
        for (i, light) in lights.iter().enumerate() {
            for second in lights[..i].iter().filter(|other| other.opendrive_id == light.opendrive_id) {
                if light.model == "light.walkers" {
                    continue;
                }
                // Both look the same way.
                assert!(frames::wrap_pi(yaw(light) - yaw(second)).abs() < 0.2);
                let [along, aside] = off(second, light).map(f64::abs);
                let hangs = [light, second].iter().any(|head| LightMount::from_variant(head.variant).hangs);
                let kind = match () {
                    () if along > 10.0 && along < 75.0 && aside < 25.0 => 0,
                    () if hangs && along < 0.1 && aside < 7.6 => 2,
                    () if along < 4.0 && (4.0..25.0).contains(&aside) => 1,
                    () => panic!("{name}: {along} {aside} at {:?}", light.xyz_m),
                };
                found[kind] += 1;
            }
        }
    }
    assert!(found.iter().all(|count| *count > 3), "{found:?}");
}

#[test]
fn what_hangs_over_the_road_is_high_enough() {
    let mut over = 0;
    for name in ["convoy/08", "convoy/demo"] {
        let map = town_map(name);
        for light in lights(&map, 512.0) {
            let ground_m: f64 =
                light.attributes.get(&Attribute::GroundZ).expect("is said").parse().expect("a number");
            let at = Point3::from(light.xyz_m);
            // Its front.
            let (sin, cos) = frames::math::sin_cos(yaw(&light));
            let ahead_m = 0.5 * light.length_m;
            let low = Point3::new(at.x + ahead_m * cos, at.y + ahead_m * sin, ground_m);
            let on = map.lanes_within(low, 4.0, |lane| lane.lane_type.is_drivable());
            if on.iter().any(opendrive::LaneHit::is_inside) {
                over += 1;
                assert!(at.z - ground_m >= 4.5, "{name}: {} at {at}", light.model);
            }
            assert!(at.z - ground_m >= 2.099, "{name}: {} at {at}", light.model);
        }
    }
    assert!(over > 5, "{over}");
}

#[test]
fn crosswalks_with_lights_have_heads_at_both_ends_and_others_have_none() {
    for (name, least) in [("convoy/demo", 40), ("convoy/08", 30)] {
        let map = town_map(name);
        let lights = lights(&map, 512.0);
        let mut heads: BTreeMap<&str, Vec<&TileObjectRow>> = BTreeMap::new();
        for head in lights.iter().filter(|light| light.model == "light.walkers") {
            heads.entry(head.opendrive_id.as_deref().expect("is named")).or_default().push(head);
        }
        let (mut pairs, mut posts) = (0, 0);
        for (number, crosswalk) in map.crosswalks().iter().enumerate() {
            let Some(theirs) = heads.remove(crosswalk.light_name().as_str()) else { continue };
            assert!(!map.crosswalk_signals(number).is_empty(), "{name}: {}", crosswalk.id);
            let [a, b] = crosswalk.axis().expect("has one").ends;
            for head in &theirs {
                // It looks at the other end, and is beside the way.
                let at = Point3::from(head.xyz_m);
                let [near, far] = if (a - at).norm() < (b - at).norm() { [a, b] } else { [b, a] };
                assert!((near - at).xy().norm() < 6.5, "{name}: {at} and {near}");
                let (sin, cos) = frames::math::sin_cos(yaw(head));
                let way = (far - near).xy().normalize();
                assert!(way.dot(&Vector2::new(cos, sin)) > 0.98, "{name}: {at}");
                posts += usize::from(!LightMount::from_variant(head.variant).hangs);
                let Some(post) = footprint(&head.actor(1)) else { continue };
                let aside = (Point3::from(post.xyz_m) - near).xy().perp(&way).abs();
                assert!(aside > 1.5, "{name}: {aside}");
            }
            pairs += usize::from(theirs.len() == 2);
        }
        assert!(heads.is_empty(), "{name}: {heads:?}");
        assert!(pairs >= least && posts > 0, "{name}: {pairs} {posts}");
    }
}

#[test]
fn what_hangs_is_on_the_axis_of_a_pole() {
    for name in ["convoy/demo", "convoy/08", "convoy/11"] {
        let lights = lights(&town_map(name), 512.0);
        let axis = |light: &TileObjectRow| {
            let mount = LightMount::from_variant(light.variant);
            let standing = LightMount { hangs: false, ..mount }.to_variant();
            let actor = schema::tables::ActorRow { variant: standing, ..light.actor(1) };
            (mount.hangs, Point3::from(footprint(&actor).expect("a pole").xyz_m))
        };
        let poles: Vec<Point3<f64>> =
            lights.iter().map(axis).filter(|(hangs, _)| !hangs).map(|(_, at)| at).collect();
        for at in lights.iter().map(axis).filter(|(hangs, _)| *hangs).map(|(_, at)| at) {
            // Poles at the border of the square may be outside of it.
            let inside = at.x.abs().max(at.y.abs()) < 250.0;
            let nearest = poles.iter().map(|pole| (pole - at).norm()).fold(f64::INFINITY, f64::min);
            assert!(!inside || nearest < 0.02, "{name}: {nearest} m from {at}");
        }
    }
}
