#![doc = include_str!("../README.md")]

mod catalogue;
mod claims;
mod draft;
mod draw;
mod frontage;
mod furniture;
mod islands;
mod land;
mod lots;
mod parked;
mod site;
mod swept;
mod trees;

use schema::settings::SceneryRules;
use schema::tables::TileObjectRow;
use surfaces::{AreaGround, Ground};

pub use catalogue::{BUILDINGS, BuildingKind, TREES};

use draft::Draft;
use islands::Islands;
use land::Land;
use site::Site;

/// What stands in an area: traffic lights and signs of the map, parked vehicles, buildings, street lamps, fences, trees and
/// street furniture, in this order. It follows from the map, the rules and the area alone; areas side by side have each thing
/// once, as it would be if they were one.
///
/// Rows of lights and signs describe the housing or board alone (origin: centre of its bottom face, x: the way it faces);
/// their poles belong to the same mesh and reach down to the ground, whose height is the attribute `ground_z_m`.
#[must_use]
pub fn place(ground: &AreaGround<'_>, rules: &SceneryRules) -> Vec<TileObjectRow> {
    let tracks = ground.sections.iter().flat_map(|s| &s.strips).any(|s| s.ground == Ground::Track);
    let site = Site { map: ground.map(), rules, ground };
    let fronts = frontage::frontages(&ground.sections);
    let islands = Islands::new(&ground.levels.cover, &ground.around);
    let mut drafts: Vec<Draft> = Vec::new();
    let mut land = Land::new(&ground.levels, tracks);
    furniture::signals(&site, &mut land, &mut drafts);
    // Buildings keep off every marked space, and so do not ask where somebody parks.
    let mut to_build = land.clone();
    parked::parked(&site, &mut land, &mut drafts);
    parked::keep_spaces(&site, &mut to_build);
    let houses = lots::buildings(&site, &fronts, &islands, &mut to_build, &mut drafts);
    houses.iter().for_each(|house| land.take(house.takes));
    furniture::lamps(&site, &fronts, &mut land, &mut drafts);
    lots::fences(&site, &houses, &mut land, &mut drafts);
    trees::trees(&site, &fronts, &mut land, &mut drafts);
    furniture::small_things(&site, &fronts, &mut land, &mut drafts);
    drafts.into_iter().map(Draft::row).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use opendrive::Map;
    use surfaces::{Atlas, Region};

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
            place(&atlas.ground(&area), &rules)
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

    #[test]
    fn nine_small_areas_are_as_one_large_one() {
        for (name, corner) in [("convoy/demo", [-192.0, -192.0]), ("convoy/03", [-192.0, -160.0])] {
            let town = town::generate(&town::named(name).expect("a town of ours")).expect("roads");
            check(&Map::new(town), corner);
        }
        for (_, map) in testkit::real_maps(&["Town03"]) {
            check(&map, [-192.0, -192.0]);
        }
    }
}
