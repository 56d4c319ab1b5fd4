//! What stands beside the roads: placed by rule and seed, never on a lane.
//!
//! [`place`] decides once per scene, as actor rows for the log; meshes are made from the rows, elsewhere.
//!
//! ```
//! use scenery::place;
//! use schema::ActorKind;
//! use schema::settings::WorldSettings;
//!
//! let map = testkit::straight(200.0);
//! let actors = place(&map, &WorldSettings::default(), 27, &[[100.0, 0.0, 0.0]], 1)?;
//! assert!(actors.iter().any(|a| a.kind == ActorKind::Building && a.fixed));
//! // The same seed places the same.
//! assert_eq!(place(&map, &WorldSettings::default(), 27, &[[100.0, 0.0, 0.0]], 1)?, actors);
//! # Ok::<(), scenery::SceneryError>(())
//! ```

mod catalogue;
mod draft;
mod error;
mod frontage;
mod furniture;
mod islands;
mod land;
mod lots;
mod parked;
mod site;
mod swept;

use opendrive::Map;
use schema::settings::WorldSettings;
use schema::tables::ActorRow;
use schema::{ActorKind, ObjectId};
use surfaces::{Ground, Layer, Region};

pub use catalogue::{BUILDINGS, BuildingKind, TREES};
pub use error::SceneryError;

use draft::Draft;
use islands::Islands;
use land::Land;
use site::Site;

/// Most scenery objects of a scene.
const MAX_OBJECTS: usize = 20_000;
/// Surfaces reach this far beyond the radius of the scenery, metres.
const MARGIN_M: f64 = 60.0;

/// Places the fixed actors of a scene: surfaces, traffic lights and signs of the map, parked vehicles, street lamps, buildings, fences, trees and
/// street furniture within `settings.radius_m` of the centres. Ids run from `first_id` upward without gaps.
///
/// Rows of kind `surface` stand for the surfaces of an area: their position is its middle, length and width its
/// extent; [`surfaces::areas`] reads them. Rows of lights and signs describe the housing or board alone (origin:
/// centre of its bottom face, x: the way it faces); their poles belong to the same mesh and reach down to the
/// ground, whose height is the attribute `ground_z_m`.
///
/// # Errors
/// No centre, no lanes near any centre, or too few ids.
pub fn place(
    map: &Map,
    settings: &WorldSettings,
    seed: u64,
    centres: &[[f64; 3]],
    first_id: ObjectId,
) -> Result<Vec<ActorRow>, SceneryError> {
    if centres.is_empty() || centres.iter().flatten().any(|v| !v.is_finite()) {
        return Err(SceneryError::NoCentre);
    }
    let region = region(centres, settings.radius_m + MARGIN_M);
    let sections = surfaces::sections(map, &region);
    if sections.is_empty() {
        return Err(SceneryError::NoRoads { radius_m: settings.radius_m });
    }
    let ground = surfaces::levels(map, &sections, &region);
    let site = Site { map, settings, seed, centres, ground: &ground };
    let tracks = sections.iter().flat_map(|s| &s.strips).any(|s| s.ground == Ground::Track);
    let mut land = Land::new(&ground, tracks);
    let mut drafts = surface_drafts(&region, tracks, !ground.waters.is_empty());
    furniture::signals(&site, &mut land, &mut drafts);
    parked::parked(&site, &mut land, &mut drafts);
    let fronts = frontage::frontages(&sections);
    furniture::lamps(&site, &fronts, &mut land, &mut drafts);
    let islands = Islands::new(&ground.cover, &region);
    lots::buildings(&site, &fronts, &islands, &mut land, &mut drafts);
    lots::trees(&site, &fronts, &mut land, &mut drafts);
    furniture::small_things(&site, &fronts, &mut land, &mut drafts);
    if drafts.len() > MAX_OBJECTS {
        tracing::warn!(wanted = drafts.len(), kept = MAX_OBJECTS, "scenery is cut to its limit");
        drafts.truncate(MAX_OBJECTS);
    }
    let wanted = drafts.len();
    let last = usize::from(first_id) + wanted;
    if first_id == 0 || last > usize::from(ObjectId::MAX) + 1 {
        return Err(SceneryError::OutOfIds { first_id, wanted });
    }
    Ok((first_id..=ObjectId::MAX).zip(drafts).map(|(id, draft)| draft.row(id)).collect())
}

fn region(centres: &[[f64; 3]], reach_m: f64) -> Region {
    let fold = |axis: usize, pick: fn(f64, f64) -> f64, start: f64| {
        centres.iter().map(|c| c[axis]).fold(start, pick)
    };
    // Whole metres, so that the region comes back from a row's middle and extent exactly.
    let low = |axis: usize| (fold(axis, f64::min, f64::INFINITY) - reach_m).floor();
    let high = |axis: usize| (fold(axis, f64::max, f64::NEG_INFINITY) + reach_m).ceil();
    Region { min: [low(0), low(1)], max: [high(0), high(1)] }
}

fn surface_drafts(region: &Region, tracks: bool, waters: bool) -> Vec<Draft> {
    // Ids are for what is there.
    let wanted = |layer: &Layer| match layer {
        Layer::Track => tracks,
        Layer::Water => waters,
        _ => true,
    };
    let middle = [0, 1].map(|k| 0.5 * (region.min[k] + region.max[k]));
    let extent = [0, 1].map(|k| region.max[k] - region.min[k]);
    Layer::ALL
        .into_iter()
        .filter(wanted)
        .map(|layer| {
            let (xyz, size) = ([middle[0], middle[1], 0.0], [extent[0], extent[1], 0.0]);
            Draft::new(ActorKind::Surface, layer.model(), layer.tag(), size, xyz, 0.0)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faults_are_named() {
        let map = testkit::straight(200.0);
        let placed = |centres: &[[f64; 3]], first_id| {
            place(&map, &WorldSettings::default(), 1, centres, first_id).map(|rows| rows.len())
        };
        let middle = [100.0, 0.0, 0.0];
        assert_eq!(placed(&[], 1), Err(SceneryError::NoCentre));
        assert_eq!(placed(&[middle, [f64::NAN, 0.0, 0.0]], 1), Err(SceneryError::NoCentre));
        let radius_m = WorldSettings::default().radius_m;
        assert_eq!(placed(&[[9e6, 0.0, 0.0]], 1), Err(SceneryError::NoRoads { radius_m }));
        let wanted = placed(&[middle], 1).expect("a street");
        assert_eq!(placed(&[middle], 65_530), Err(SceneryError::OutOfIds { first_id: 65_530, wanted }));
    }
}
