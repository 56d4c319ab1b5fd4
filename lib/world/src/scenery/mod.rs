//! What stands beside the roads: placed by rule and seed, never on a lane.

mod frontage;
mod furniture;
mod islands;
mod land;
mod lots;
mod parked;
mod swept;

use frames::{Object, Pose, World};
use opendrive::Map;
use schema::settings::WorldSettings;
use schema::tables::ActorRow;
use schema::{ObjectId, Tag};

use crate::WorldError;
use crate::surfaces::{self, Ground, GroundLevels, Layer, Region};
use islands::Islands;
use land::Land;

/// Most scenery objects of a scene.
const MAX_OBJECTS: usize = 20_000;
/// Surfaces reach this far beyond the radius of the scenery, metres.
const MARGIN_M: f64 = 60.0;

/// Everything that placing rules look at.
pub(super) struct Site<'a> {
    map: &'a Map,
    settings: &'a WorldSettings,
    seed: u64,
    centres: &'a [[f64; 3]],
    ground: &'a GroundLevels,
}

impl Site<'_> {
    /// Whether a place is near enough to a centre.
    fn near(&self, x: f64, y: f64) -> bool {
        let radius = self.settings.radius_m;
        self.centres.iter().any(|c| {
            let (dx, dy) = (x - c[0], y - c[1]);
            dx * dx + dy * dy <= radius * radius
        })
    }
}

/// An object before it has its number.
pub(super) struct Draft {
    pub(super) kind: &'static str,
    pub(super) model: String,
    pub(super) tags: Vec<Tag>,
    pub(super) size_m: [f64; 3],
    pub(super) color: [u8; 3],
    pub(super) xyz_m: [f64; 3],
    pub(super) rpy_rad: [f64; 3],
    pub(super) variant: u32,
    pub(super) opendrive_id: Option<String>,
    pub(super) attributes: String,
}

impl Draft {
    pub(super) fn new(
        kind: &'static str,
        model: &str,
        tag: Tag,
        size_m: [f64; 3],
        xyz_m: [f64; 3],
        yaw_rad: f64,
    ) -> Self {
        Self {
            kind,
            model: model.to_owned(),
            tags: vec![tag],
            size_m,
            color: [128; 3],
            xyz_m,
            rpy_rad: [0.0, 0.0, yaw_rad],
            variant: 0,
            opendrive_id: None,
            attributes: "{}".to_owned(),
        }
    }
}

/// Places the fixed actors of a scene: surfaces, traffic lights and signs of the map, parked vehicles, street lamps, buildings, fences, trees and
/// street furniture within `settings.radius_m` of the centres. Ids run from `first_id` upward without gaps.
///
/// Rows of kind `surface` stand for the surfaces of an area: their position is its middle, length and width its
/// extent; [`World::new`](crate::World::new) makes them from the map. Rows of lights and signs describe the housing or board alone (origin:
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
) -> Result<Vec<ActorRow>, WorldError> {
    if centres.is_empty() || centres.iter().flatten().any(|v| !v.is_finite()) {
        return Err(WorldError::NoCentre);
    }
    let region = region(centres, settings.radius_m + MARGIN_M);
    let sections = surfaces::sections(map, &region);
    if sections.is_empty() {
        return Err(WorldError::NoRoads { radius_m: settings.radius_m });
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
        return Err(WorldError::OutOfIds { first_id, wanted });
    }
    Ok((first_id..=ObjectId::MAX).zip(drafts).map(|(id, draft)| row(id, draft)).collect())
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
            Draft::new("surface", layer.model(), layer.tag(), size, xyz, 0.0)
        })
        .collect()
}

fn row(id: ObjectId, draft: Draft) -> ActorRow {
    let pose = Pose::<World, Object>::from_xyz_rpy(draft.xyz_m, draft.rpy_rad);
    ActorRow {
        id,
        kind: draft.kind.to_owned(),
        model: draft.model,
        role: "scenery".to_owned(),
        semantic_tags: draft.tags.iter().map(|t| *t as u8).collect(),
        length_m: draft.size_m[0],
        width_m: draft.size_m[1],
        height_m: draft.size_m[2],
        color: draft.color.to_vec(),
        fixed: true,
        xyz_m: draft.xyz_m,
        quaternion: pose.wxyz(),
        variant: draft.variant,
        parent: None,
        opendrive_id: draft.opendrive_id,
        attributes: draft.attributes,
    }
}
