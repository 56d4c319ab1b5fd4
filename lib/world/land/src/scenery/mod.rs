//! The objects beside the roads, placed by rule and seed, never on a lane: buildings, trees, street lamps,
//! lights and signs (those of the map and more), parked vehicles, racks with bicycles, benches. `place` gives
//! the objects of one area; it knows sizes but no meshes: a changed mesh leaves the simulation alone.
//!
//! An object's presence does not depend on the area that was asked for. Candidates are drawn along each side
//! of each road from its start, the same for every tile that draws them; kind by kind (parked vehicles,
//! buildings, lamps, fences, trees, bushes, benches and bins, racks, signs, other furniture) each keeps off
//! existing objects, and among those of its kind it stands if no candidate of a higher rank is in its way. So
//! everything depends on a bounded piece of land, and an area is made from that much around it.
//!
//! ```
//! use schema::ActorKind;
//! use catalogue::Catalogue;
//! use settings::SceneryRules;
//! use land::scenery;
//! use land::surfaces::{Atlas, Region};
//!
//! let map = testkit::straight(200.0);
//! let atlas = Atlas::new(&map);
//! let area = Region { min: [0.0, -64.0], max: [192.0, 64.0] };
//! let objects = scenery::place(&atlas.ground(&area), &SceneryRules::default(), Catalogue::built_in());
//! assert!(objects.iter().any(|o| o.kind == ActorKind::Building));
//! // The same seed places the same.
//! assert_eq!(scenery::place(&atlas.ground(&area), &SceneryRules::default(), Catalogue::built_in()), objects);
//! ```

mod claims;
mod draft;
mod draw;
mod forecourts;
mod frontage;
mod furniture;
mod gardens;
mod islands;
mod kinds;
mod land;
mod lights;
mod lots;
mod parked;
mod patches;
mod plots;
mod racks;
mod signs;
mod site;
mod style;
mod swept;
mod trees;
mod uses;

use crate::surfaces::{AreaGround, Ground};
use catalogue::Catalogue;
use schema::tables::TileObjectRow;
use settings::SceneryRules;

pub use furniture::{FURNITURE, FurnitureFront, FurnitureKind, FurniturePlace};
pub use kinds::{BUILDINGS, BuildingKind, TREES, TreeKind};
pub use signs::{PLATES, Plate};
pub use style::FurnitureStyle;

use draft::Draft;
use islands::Islands;
use land::Land;
use site::Site;
use uses::Uses;

/// The objects in an area: traffic lights and signs of the map, parked vehicles, buildings, street lamps,
/// borders of plots, forecourts, patches of plants, trees, benches and bins, racks with bicycles, the signs
/// that roads have besides and all other
/// street furniture, in this order.
/// It follows from the map, the rules, the models that may be parked and the area alone; areas side by side
/// have each thing once, as it would be if they were one.
///
/// Rows of lights and signs describe the housing or board alone (origin: centre of its bottom face, x: the
/// way it faces); their poles belong to the same mesh and reach down to the ground, whose height is the
/// attribute `ground_z_m`.
#[must_use]
pub fn place(ground: &AreaGround<'_>, rules: &SceneryRules, catalogue: &Catalogue) -> Vec<TileObjectRow> {
    let tracks = ground.sections.iter().flat_map(|s| &s.strips).any(|s| s.ground == Ground::Track);
    let site = Site { map: ground.map(), rules, catalogue, ground };
    let fronts = frontage::frontages(ground.map(), &ground.sections);
    let islands = Islands::new(&ground.levels.cover, &ground.around);
    let mut drafts: Vec<Draft> = Vec::new();
    let mut land = Land::new(&ground.levels, tracks);
    lights::lights(&site, &mut land, &mut drafts);
    let signs = signs::given(&site, &mut land, &mut drafts);
    // Buildings keep off every marked space, and so do not ask where somebody parks.
    let mut to_build = land.clone();
    parked::parked(&site, &mut land, &mut drafts);
    parked::keep_spaces(&site, &mut to_build);
    let houses = lots::buildings(&site, &fronts, &islands, &mut to_build, &mut drafts);
    houses.iter().for_each(|house| land.take(house.takes));
    let mut built = Land::new(&ground.levels, tracks);
    houses.iter().for_each(|house| built.take(house.takes));
    furniture::lamps(&site, &fronts, &mut land, &mut drafts);
    furniture::utility(&site, &fronts, &houses, &mut land, &mut drafts);
    plots::borders(&site, &houses, &mut land, &mut drafts);
    let paved = forecourts::forecourts(&site, &houses, &land, &mut drafts);
    gardens::gardens(&site, &houses, &paved, &mut land, &mut drafts);
    let uses = Uses::new(&site, &fronts);
    let mut open = land.clone();
    paved.take(&mut open);
    patches::patches(&site, &uses, &open, &mut drafts);
    trees::trees(&site, (&fronts, &uses, &paved), &built, &mut land, &mut drafts);
    furniture::small_things(&site, (&fronts, &paved), &mut land, &mut drafts);
    racks::racks(&site, &fronts, &mut land, &mut drafts);
    signs::roadside(&site, &fronts, &signs, &mut land, &mut drafts);
    furniture::things(&site, &fronts, (&houses, &paved), &mut land, &mut drafts);
    drafts.into_iter().map(Draft::row).collect()
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::surfaces::{Atlas, Region};
    use frames::OrientedRect;
    use opendrive::Map;
    use schema::{ActorKind, Attribute};

    /// Places of things to tenths of a millimetre, with all that they are.
    fn sorted(mut objects: Vec<TileObjectRow>) -> Vec<TileObjectRow> {
        objects.sort_by(|a, b| {
            a.xyz_m.map(|v| (v * 1e4).round() as i64).cmp(&b.xyz_m.map(|v| (v * 1e4).round() as i64))
        });
        objects
    }

    fn check(map: &Map, corner: [f64; 2]) {
        let atlas = Atlas::new(map);
        let rules = SceneryRules::default();
        let place_in = |x: f64, y: f64, side: f64| {
            let area = Region { min: [x, y], max: [x + side, y + side] };
            place(&atlas.ground(&area), &rules, Catalogue::built_in())
        };
        let whole = sorted(place_in(corner[0], corner[1], 384.0));
        let parts = (0..9).flat_map(|k| {
            let [x, y] = [k % 3, k / 3].map(|i| f64::from(i) * 128.0);
            place_in(corner[0] + x, corner[1] + y, 128.0)
        });
        let parts = sorted(parts.collect());
        assert!(whole.len() > 300, "{}", whole.len());
        let gone: Vec<_> = whole.iter().filter(|o| !parts.contains(o)).map(|o| (&o.model, o.xyz_m)).collect();
        let new: Vec<_> = parts.iter().filter(|o| !whole.contains(o)).map(|o| (&o.model, o.xyz_m)).collect();
        assert!(gone.is_empty() && new.is_empty(), "{} of {}\n{gone:#?}\n{new:#?}", gone.len(), whole.len());
        assert_eq!(whole.len(), parts.len());
    }

    pub(crate) fn town_map(name: &str) -> Map {
        Map::new(town::generate(&town::named(name).expect("a town of ours")).expect("roads"))
    }

    fn all_of(map: &Map, corner: [f64; 2], side: f64) -> Vec<TileObjectRow> {
        all_by(&SceneryRules::default(), map, corner, side)
    }

    /// The objects of a square by some rules.
    pub(crate) fn all_by(rules: &SceneryRules, map: &Map, corner: [f64; 2], side: f64) -> Vec<TileObjectRow> {
        let area = Region { min: corner, max: corner.map(|v| v + side) };
        place(&Atlas::new(map).ground(&area), rules, Catalogue::built_in())
    }

    /// The ground under an object.
    pub(crate) fn footprint(object: &TileObjectRow) -> OrientedRect {
        let half_m = [0.5 * object.length_m, 0.5 * object.width_m];
        OrientedRect::new([object.xyz_m[0], object.xyz_m[1]], yaw(object), half_m)
    }

    /// Whether a rectangle meets a lane that somebody drives or walks on, looked at each 0.4 m.
    pub(crate) fn meets_lanes(map: &Map, rect: &OrientedRect, z_m: f64) -> bool {
        let steps = rect.half_m.map(|half| (half / 0.2).ceil() as i32);
        (-steps[0]..=steps[0]).any(|i| {
            (-steps[1]..=steps[1]).any(|j| {
                let [x, y] = rect.at(f64::from(i) / f64::from(steps[0]), f64::from(j) / f64::from(steps[1]));
                let used =
                    |lane: &opendrive::LaneInfo| lane.lane_type.is_drivable() || lane.lane_type.is_walkable();
                let near = map.lanes_within(nalgebra::Point3::new(x, y, z_m), 6.0, used);
                // Lanes are surfaces of straight pieces.
                near.iter().any(|hit| hit.t_m.abs() < 0.5 * hit.width_m - 0.15)
            })
        })
    }

    fn yaw(object: &TileObjectRow) -> f64 {
        frames::Pose::<frames::World, frames::Object>::from_xyz_wxyz(object.xyz_m, object.quaternion).yaw()
    }

    /// Signs that are not the map's stand off all lanes for vehicles and outside of houses, near the lane
    /// whose traffic sees them.
    fn check_signs(name: &str, map: &Map, corner: [f64; 2], side: f64, least: usize) {
        let objects = all_of(map, corner, side);
        let own = |o: &&TileObjectRow| o.kind == ActorKind::Sign && o.opendrive_id.is_none();
        let (mut count, mut turned) = (0, 0);
        for sign in objects.iter().filter(own) {
            count += 1;
            let ground_z: f64 =
                sign.attributes.get(&Attribute::GroundZ).expect("is said").parse().expect("a number");
            let foot = nalgebra::Point3::new(sign.xyz_m[0], sign.xyz_m[1], ground_z);
            let vehicles = |lane: &opendrive::LaneInfo| {
                lane.lane_type.is_drivable() || lane.lane_type == opendrive::LaneType::Parking
            };
            for hit in map.lanes_within(foot, 8.0, vehicles) {
                assert!(
                    hit.t_m.abs() > 0.5 * hit.width_m + 0.1,
                    "{name}: {} on a lane at {foot}",
                    sign.model
                );
            }
            let nearest = map.nearest_lane(foot, |lane| lane.lane_type.is_drivable()).expect("a lane");
            assert!(nearest.distance_m < 14.0, "{name}: {} {} m off", sign.model, nearest.distance_m);
            let heading = map.lane_point(nearest.lane, nearest.s, 0.0).expect("on it").heading_rad;
            let faces = frames::wrap_pi(yaw(sign) - heading).abs() > std::f64::consts::PI - 0.35;
            // One kind is for those who come the wrong way; beside a crossing another street may be nearer.
            turned += usize::from(!faces && sign.model != "sign.no_entry");
            let word = sign.attributes.get(&Attribute::SignType).expect("says something");
            assert!(schema::SIGN_TYPES.contains(&word), "{word}");
            for house in objects.iter().filter(|o| o.kind == ActorKind::Building) {
                assert!(
                    !footprint(house).meets(&OrientedRect::square([foot.x, foot.y], 0.05)),
                    "{name}: {foot}"
                );
            }
        }
        assert!(count >= least, "{name}: {count} signs");
        assert!(10 * turned <= count, "{name}: {turned} of {count} look away from their traffic");
    }

    #[test]
    fn crowns_keep_off_walls_and_stems_off_lanes() {
        let map = town_map("convoy/demo");
        let objects = all_of(&map, [-256.0, -256.0], 512.0);
        let houses: Vec<OrientedRect> =
            objects.iter().filter(|o| o.kind == ActorKind::Building).map(footprint).collect();
        let trees: Vec<_> = objects.iter().filter(|o| o.model.starts_with("tree.")).collect();
        let (mut ages, mut at_kerbs) = ([0; 3], 0);
        for tree in &trees {
            let [x, y, z] = tree.xyz_m;
            // What a round crown reaches of a square.
            let crown = OrientedRect::square([x, y], 0.5 * 0.9 * tree.width_m);
            assert!(!houses.iter().any(|house| house.meets(&crown)), "{} at {x} {y}", tree.model);
            let kind = TREES.iter().find(|kind| kind.model == tree.model).expect("is planted");
            let is_of = |age: &usize| kind.size_m(*age, tree.variant)[2] == tree.height_m;
            ages[(0..3).find(is_of).expect("of some age")] += 1;
            let foot = nalgebra::Point3::new(x, y, z);
            let on = map.lanes_within(foot, 4.0, |_| true);
            let on = on.iter().filter(|hit| hit.t_m.abs() < 0.5 * hit.width_m);
            for hit in on {
                let kind = map.lane(hit.lane).expect("is one").lane_type;
                assert!(!kind.is_drivable(), "{} on a lane at {x} {y}", tree.model);
                at_kerbs += usize::from(kind == opendrive::LaneType::Sidewalk);
            }
        }
        assert!(trees.len() > 250 && ages.iter().all(|count| 20 * count > trees.len()), "{ages:?}");
        assert!(at_kerbs > 25, "{at_kerbs} of {}", trees.len());
    }

    #[test]
    fn signs_stand_beside_the_road_and_look_at_its_traffic() {
        check_signs("convoy/demo", &town_map("convoy/demo"), [-256.0, -256.0], 512.0, 10);
        check_signs("convoy/07", &town_map("convoy/07"), [-512.0, -512.0], 1024.0, 20);
        for (name, map) in testkit::real_maps(&["Town03", "Town04"]) {
            check_signs(name, &map, [-256.0, -256.0], 512.0, 10);
        }
    }

    /// Whether two vehicles' footprints meet.
    fn meet(a: &TileObjectRow, b: &TileObjectRow) -> bool {
        footprint(a).meets(&footprint(b))
    }

    #[test]
    fn trucks_buses_and_two_wheelers_park_where_they_fit() {
        let mut seen: std::collections::BTreeMap<String, usize> = std::collections::BTreeMap::new();
        let towns = [("convoy/02", [-512.0, -512.0]), ("convoy/demo", [-512.0, -512.0])]
            .map(|(n, c)| (town_map(n), c));
        let real = testkit::real_maps(&["Town03"]).map(|(_, map)| (map, [-512.0, -512.0]));
        for (map, corner) in towns.into_iter().chain(real) {
            let objects = all_of(&map, corner, 1024.0);
            let parked: Vec<_> = objects.iter().filter(|o| o.kind == ActorKind::Parked).collect();
            for (i, one) in parked.iter().enumerate() {
                *seen.entry(one.model.split('.').next().unwrap_or_default().to_owned()).or_default() += 1;
                assert!(parked[..i].iter().all(|other| !meet(one, other)), "{} {:?}", one.model, one.xyz_m);
                assert!(!one.semantic_tags.contains(&(schema::Tag::Rider as u8)));
                let at = nalgebra::Point3::from(one.xyz_m);
                if one.model.starts_with("bicycle") {
                    let walk = map.nearest_lane(at, |l| l.lane_type.is_walkable()).expect("a sidewalk");
                    assert!(walk.is_inside(), "{:?}", one.xyz_m);
                }
                // A bus whose middle keeps to its lane gets by.
                let near = map.nearest_driving_lane(at).expect("a lane");
                let room =
                    if one.model.starts_with("motorcycle") { 0.5 * one.length_m } else { 0.5 * one.width_m };
                assert!(near.t_m.abs() - room > 1.27, "{} {:?} {}", one.model, one.xyz_m, near.t_m);
            }
        }
        for kind in ["car", "van", "truck", "motorcycle", "bicycle"] {
            assert!(seen.get(kind).is_some_and(|n| *n > 1), "{kind}: {seen:?}");
        }
        let cars = seen["car"] + seen["van"];
        assert!(seen["truck"] + seen.get("bus").copied().unwrap_or(0) < cars / 5, "{seen:?}");
    }

    #[test]
    fn nine_small_areas_are_as_one_large_one() {
        for (name, corner) in [("convoy/demo", [-192.0, -192.0]), ("convoy/03", [-192.0, -160.0])] {
            check(&town_map(name), corner);
        }
        for (_, map) in testkit::real_maps(&["Town03"]) {
            check(&map, [-192.0, -192.0]);
        }
    }
}
