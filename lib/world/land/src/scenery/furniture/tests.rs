//! Where furniture stands, held against the map.

use std::sync::OnceLock;

use frames::OrientedRect;
use nalgebra::Point3;
use opendrive::{LaneInfo, LaneType, Map};
use schema::footprint::footprint;
use schema::tables::TileObjectRow;
use schema::{ActorKind, Tag};
use settings::SceneryRules;

use super::kinds::{FURNITURE, FurnitureKind};
use super::utility::WIRES;
use crate::scenery::place;
use crate::scenery::site::reach_m;
use crate::surfaces::{Atlas, Region};

struct Town {
    name: &'static str,
    map: Map,
    objects: Vec<TileObjectRow>,
}

/// A town of one style, one of the other style, and one in the country with a motorway.
fn towns() -> &'static [Town] {
    static TOWNS: OnceLock<Vec<Town>> = OnceLock::new();
    TOWNS.get_or_init(|| {
        ["convoy/demo", "convoy/05", "convoy/07"]
            .into_iter()
            .map(|name| {
                let map =
                    Map::new(town::generate(&town::named(name).expect("a town of ours")).expect("roads"));
                let area = Region { min: [-512.0; 2], max: [512.0; 2] };
                let built_in = catalogue::Catalogue::built_in();
                let objects = place(&Atlas::new(&map).ground(&area), &SceneryRules::default(), built_in);
                Town { name, map, objects }
            })
            .collect()
    })
}

fn kind_of(object: &TileObjectRow) -> Option<&'static FurnitureKind> {
    FURNITURE.iter().find(|kind| kind.model == object.model)
}

/// The table's things in a town.
fn things(town: &Town) -> impl Iterator<Item = (&TileObjectRow, OrientedRect)> {
    town.objects.iter().filter(|object| kind_of(object).is_some()).map(|object| (object, ground(object)))
}

/// The ground that an object takes at walking height.
fn ground(object: &TileObjectRow) -> OrientedRect {
    let held = footprint(&object.actor(1)).expect("is no surface");
    OrientedRect::new([held.xyz_m[0], held.xyz_m[1]], held.yaw_rad, held.half_m)
}

/// Places all over a rectangle, edges included.
fn places(rect: &OrientedRect) -> impl Iterator<Item = [f64; 2]> + use<> {
    let rect = *rect;
    let shares = |half_m: f64| {
        let steps = (2.0 * half_m / 0.25).ceil().max(1.0) as usize;
        (0..=steps).map(move |k| 2.0 * k as f64 / steps as f64 - 1.0)
    };
    shares(rect.half_m[0]).flat_map(move |u| shares(rect.half_m[1]).map(move |v| rect.at(u, v)))
}

fn is_for_vehicles(lane: &LaneInfo) -> bool {
    lane.lane_type.is_drivable() || matches!(lane.lane_type, LaneType::Parking | LaneType::Biking)
}

#[test]
fn every_kind_stands_somewhere() {
    for kind in &FURNITURE {
        let count = |town: &Town| town.objects.iter().filter(|o| o.model == kind.model).count();
        let all: usize = towns().iter().map(count).sum();
        assert!(all > 0, "no {}", kind.model);
        for object in towns().iter().flat_map(|town| &town.objects).filter(|o| o.model == kind.model) {
            let tags: Vec<u8> = std::iter::once(&kind.tag).chain(kind.also).map(|tag| *tag as u8).collect();
            assert_eq!(object.semantic_tags, tags);
            assert!(object.variant < kind.variants, "{}", kind.model);
            let is_rail = kind.tag == Tag::GuardRail;
            assert!(is_rail || object.size_m() == kind.size_m, "{}", kind.model);
            let diagonal_m = (object.length_m * object.length_m + object.width_m * object.width_m).sqrt();
            assert!(diagonal_m <= reach_m::FURNITURE, "{}: {diagonal_m}", kind.model);
        }
    }
}

trait Sized3 {
    fn size_m(&self) -> [f64; 3];
}

impl Sized3 for TileObjectRow {
    fn size_m(&self) -> [f64; 3] {
        [self.length_m, self.width_m, self.height_m]
    }
}

#[test]
fn nothing_stands_on_a_lane_for_vehicles() {
    for town in towns() {
        for (object, rect) in things(town) {
            for [x, y] in places(&rect) {
                let at = Point3::new(x, y, object.xyz_m[2]);
                let on = town.map.lanes_within(at, 4.0, is_for_vehicles);
                assert!(!on.iter().any(|hit| hit.is_inside()), "{}: {} at {at}", town.name, object.model);
            }
        }
    }
}

#[test]
fn nothing_stands_in_another_thing() {
    for town in towns() {
        // What stands on the ground, with its ground; what hangs over it does not count.
        // Plants of the land are anywhere, and paving is what is stood on.
        let is_solid = |o: &&TileObjectRow| {
            !o.model.starts_with("plant.") && o.model != WIRES && footprint(&o.actor(1)).is_some()
        };
        let all: Vec<(&TileObjectRow, OrientedRect)> = town
            .objects
            .iter()
            .filter(is_solid)
            .map(|object| (object, ground(object).grown(-0.01)))
            .collect();
        let mut compared = 0;
        for (object, rect) in things(town) {
            let rect = rect.grown(-0.01);
            for (other, other_rect) in &all {
                let off = [0, 1].map(|k| object.xyz_m[k] - other.xyz_m[k]);
                if std::ptr::eq(object, *other) || off[0].abs().max(off[1].abs()) > 30.0 {
                    continue;
                }
                compared += 1;
                // Pieces of a rail lap.
                let rails = object.model == other.model && object.model == "prop.guard_rail";
                assert!(
                    rails || !rect.meets(other_rect),
                    "{}: {} in {} at {:?}",
                    town.name,
                    object.model,
                    other.model,
                    object.xyz_m
                );
            }
        }
        assert!(compared > 1000, "{compared}");
    }
}

#[test]
fn walkers_get_past_and_drivers_see_who_crosses() {
    let (mut on_walks, mut tall) = (0, 0);
    for town in towns() {
        let corners: Vec<Point3<f64>> =
            town.map.crosswalks().iter().flat_map(|crosswalk| crosswalk.polygon.clone()).collect();
        for (object, rect) in things(town) {
            // How far the thing reaches to both sides on each sidewalk that it touches.
            let mut reached: std::collections::BTreeMap<_, [f64; 3]> = std::collections::BTreeMap::new();
            for [x, y] in places(&rect) {
                let at = Point3::new(x, y, object.xyz_m[2]);
                for hit in town.map.lanes_within(at, 4.0, |lane| lane.lane_type.is_walkable()) {
                    if hit.is_inside() {
                        let side = reached.entry(hit.lane).or_insert([f64::INFINITY, f64::NEG_INFINITY, 0.0]);
                        *side = [side[0].min(hit.t_m), side[1].max(hit.t_m), hit.width_m];
                    }
                }
            }
            for [low, high, width] in reached.values() {
                on_walks += 1;
                let clear_m = (0.5 * width - high).max(0.5 * width + low);
                assert!(clear_m >= 1.48, "{}: {} leaves {clear_m} of {width} m", town.name, object.model);
            }
            if reached.is_empty() || object.height_m <= 0.8 {
                continue;
            }
            tall += 1;
            let [x, y, z] = object.xyz_m;
            let middle = Point3::new(x, y, z);
            let near = corners.iter().map(|p| (p - middle).xy().norm()).fold(f64::INFINITY, f64::min);
            assert!(near > 10.0, "{}: {} is {near} m from a crosswalk", town.name, object.model);
        }
    }
    assert!(on_walks > 100 && tall > 80, "{on_walks} {tall}");
}

#[test]
fn doors_stay_free() {
    for town in towns() {
        // Two metres before the door of a building, in the middle of its front; of towers it is aside.
        let ways: Vec<OrientedRect> = town
            .objects
            .iter()
            .filter(|o| o.kind == ActorKind::Building && o.model != "building.tower")
            .map(|o| {
                let own = ground(o);
                let [x, y] = own.at(1.0 + 1.0 / own.half_m[0], 0.0);
                OrientedRect { centre_m: [x, y], axis: own.axis, half_m: [1.0, 0.7] }
            })
            .collect();
        for (object, rect) in things(town).filter(|(o, _)| o.model != "prop.guard_rail") {
            assert!(
                !ways.iter().any(|way| way.meets(&rect)),
                "{}: {} before a door",
                town.name,
                object.model
            );
        }
    }
}

#[test]
fn rails_follow_fast_roads_without_a_break() {
    let mut all = 0;
    for town in towns() {
        let rails: Vec<&TileObjectRow> =
            town.objects.iter().filter(|o| o.model == "prop.guard_rail").collect();
        let ends = |o: &TileObjectRow| {
            let rect = ground(o);
            [rect.at(0.0, -1.0), rect.at(0.0, 1.0)]
        };
        let (mut loose, mut beside_fast) = (0, 0);
        for rail in &rails {
            let [x, y, z] = rail.xyz_m;
            let lane = town
                .map
                .nearest_lane(Point3::new(x, y, z), |lane| lane.lane_type.is_drivable())
                .expect("a lane");
            let info = town.map.lane(lane.lane).expect("is one");
            let limit = info.speed_limit_mps.unwrap_or(0.0);
            let beside_m = lane.t_m.abs() - 0.5 * lane.width_m;
            // Shoulders are up to some metres wide.
            assert!(limit > 10.9, "{}: {limit} m/s at {:?}", town.name, rail.xyz_m);
            assert!((0.4..6.0).contains(&beside_m), "{}: {beside_m}", town.name);
            let heading = town.map.lane_point(lane.lane, lane.s, 0.0).expect("on it").heading_rad;
            let [a, b] = ends(rail);
            let along = frames::math::atan2(b[1] - a[1], b[0] - a[0]);
            let turn = frames::wrap_pi(2.0 * (along - heading)).abs() / 2.0;
            assert!(turn < 0.12, "{}: turned by {turn}", town.name);
            let touches = |end: [f64; 2]| {
                rails.iter().filter(|other| !std::ptr::eq(**other, *rail)).any(|other| {
                    ends(other).iter().any(|p| (p[0] - end[0]).abs().max((p[1] - end[1]).abs()) < 0.12)
                })
            };
            // At slower roads rails are where the land falls, no longer.
            if limit > 19.0 {
                beside_fast += 1;
                loose += [a, b].into_iter().filter(|end| !touches(*end)).count();
            }
        }
        // Of both ends of all pieces few are ends of the rail.
        assert!(4 * loose <= beside_fast, "{}: {loose} of {beside_fast}", town.name);
        all += rails.len();
    }
    assert!(all > 300, "{all}");
}

#[test]
fn wires_hang_from_pole_to_pole_over_everything() {
    let mut spans = 0;
    for town in towns() {
        let poles: Vec<&TileObjectRow> = town.objects.iter().filter(|o| o.model == "pole.utility").collect();
        // Where the insulators of an arm are: of the outermost two.
        let held = |o: &TileObjectRow| {
            let pose = frames::Pose::<frames::World, frames::Object>::from_xyz_wxyz(o.xyz_m, o.quaternion);
            [-1.0, 1.0]
                .map(|side| pose.isometry() * Point3::new(side * 0.94 * 1.18, 0.10, 0.93 * o.height_m + 0.20))
        };
        let all: Vec<[Point3<f64>; 2]> = poles.iter().map(|pole| held(pole)).collect();
        let houses: Vec<OrientedRect> =
            town.objects.iter().filter(|o| o.kind == ActorKind::Building).map(ground).collect();
        let mut holding = vec![0; poles.len()];
        for wires in town.objects.iter().filter(|o| o.model == WIRES) {
            spans += 1;
            let [x, y, _] = wires.xyz_m;
            assert!((20.0..54.1).contains(&wires.length_m), "{}: {}", town.name, wires.length_m);
            let pose =
                frames::Pose::<frames::World, frames::Object>::from_xyz_wxyz(wires.xyz_m, wires.quaternion);
            let turns = [wires.variant & 0x1ff, wires.variant >> 9].map(|turn| f64::from(turn) - 180.0);
            for (side, turn) in [-0.5, 0.5].into_iter().zip(turns) {
                let (s, c) = frames::math::sin_cos(turn.to_radians());
                let ends = [-1.0, 1.0].map(|of| {
                    let across = of * 0.94 * 1.18;
                    let end = [side * wires.length_m + across * c, across * s, wires.height_m - 0.05];
                    pose.isometry() * Point3::from(end)
                });
                let off =
                    |at: &[Point3<f64>; 2]| (0..2).map(|k| (at[k] - ends[k]).norm()).fold(0.0, f64::max);
                let (nearest, gap) = all
                    .iter()
                    .enumerate()
                    .map(|(i, at)| (i, off(at)))
                    .min_by(|a, b| a.1.total_cmp(&b.1))
                    .expect("a pole");
                let inside = x.abs().max(y.abs()) < 480.0;
                assert!(!inside || gap < 0.02, "{}: {gap} m at {x} {y}", town.name);
                if gap < 0.02 {
                    holding[nearest] += 1;
                }
            }
            let below = OrientedRect::new([x, y], pose.yaw(), [0.5 * wires.length_m, 1.15]);
            for [x, y] in places(&below) {
                let low = town.map.lanes_within(Point3::new(x, y, wires.xyz_m[2]), 12.0, |_| true);
                let inside = low.iter().filter(|hit| hit.is_inside());
                for lane in inside.filter_map(|hit| town.map.lane_point(hit.lane, hit.s, hit.t_m)) {
                    assert!(wires.xyz_m[2] - lane.position.z > 6.0, "{}: at {x} {y}", town.name);
                }
            }
            assert!(!houses.iter().any(|house| house.meets(&below)), "{}: at {x} {y}", town.name);
        }
        for (pole, count) in poles.iter().zip(holding) {
            let inside = pole.xyz_m[0].abs().max(pole.xyz_m[1].abs()) < 450.0;
            assert!(!inside || (1..=2).contains(&count), "{}: {count} at {:?}", town.name, pole.xyz_m);
        }
    }
    assert!(spans > 60, "{spans}");
}

#[test]
fn rails_on_medians_look_at_the_traffic_beside_them() {
    let map = Map::new(town::generate(&town::named("convoy/04").expect("a town of ours")).expect("roads"));
    let area = Region { min: [-512.0; 2], max: [512.0; 2] };
    let objects =
        place(&Atlas::new(&map).ground(&area), &SceneryRules::default(), catalogue::Catalogue::built_in());
    let mut on_medians = 0;
    for rail in objects.iter().filter(|o| o.model == "prop.guard_rail") {
        let rect = ground(rail);
        for [x, y] in places(&rect) {
            let on = map.lanes_within(Point3::new(x, y, rail.xyz_m[2]), 4.0, is_for_vehicles);
            assert!(!on.iter().any(|hit| hit.is_inside()), "{:?}", rail.xyz_m);
        }
        let middle = Point3::from(rail.xyz_m);
        let on = map.lanes_within(middle, 4.0, |lane| lane.lane_type == LaneType::Median);
        if !on.iter().any(|hit| hit.is_inside()) {
            continue;
        }
        on_medians += 1;
        let [x, y] = rect.at(1.0 + 3.0 / rect.half_m[0], 0.0);
        let ahead = map.lanes_within(Point3::new(x, y, rail.xyz_m[2]), 4.0, is_for_vehicles);
        assert!(ahead.iter().any(|hit| hit.is_inside()), "{:?}", rail.xyz_m);
    }
    assert!(on_medians > 20, "{on_medians}");
}
