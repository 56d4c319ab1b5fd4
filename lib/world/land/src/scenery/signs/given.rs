//! The signs of the map: its signals that do not change, and objects whose names are those of signs.

use frames::OrientedRect;
use nalgebra::Point3;
use opendrive::{ObjectInfo, SignalInfo};
use random::Stream;
use schema::{ActorKind, Attribute, Attributes, SIGN_TYPES, SignFace, Tag};

use super::codes::{Meaning, of_object, of_signal};
use super::plates::{GUIDE, NAME};
use crate::scenery::draft::Draft;
use crate::scenery::land::Land;
use crate::scenery::site::{FOOT_M, Site, reach_m};

/// A sign that the map has.
#[derive(Clone, Copy, Debug)]
pub(crate) struct GivenSign {
    pub(super) foot: Point3<f64>,
    /// The way it looks, radians.
    pub(super) yaw_rad: f64,
    pub(super) sign_type: &'static str,
}

/// The signs of the map that are near. Those of the area become objects; the ground of all is taken.
pub(crate) fn given(site: &Site<'_>, land: &mut Land<'_>, drafts: &mut Vec<Draft>) -> Vec<GivenSign> {
    let signals =
        site.map.signals().iter().enumerate().filter_map(|(i, signal)| of_map_signal(site, i, signal));
    let objects = site.map.objects().iter().filter_map(|object| of_map_object(site, object));
    let mut found = Vec::new();
    for (id, foot, yaw, meaning) in signals.chain(objects) {
        land.take(OrientedRect::square([foot.x, foot.y], FOOT_M));
        found.push(GivenSign { foot, yaw_rad: yaw, sign_type: meaning.sign_type });
        if site.holds(foot.x, foot.y) {
            let mut draft = board(site, foot, yaw, meaning);
            draft.opendrive_id = Some(id.to_owned());
            drafts.push(draft);
        }
    }
    found
}

/// Id, foot, the way it looks, and what it says.
type Found<'a> = (&'a str, Point3<f64>, f64, Meaning);

fn of_map_signal<'a>(site: &Site<'_>, index: usize, signal: &'a SignalInfo) -> Option<Found<'a>> {
    let foot = signal.on_surface;
    if signal.dynamic || !site.near(foot.x, foot.y, reach_m::GIVEN) {
        return None;
    }
    let meaning = of_signal(&signal.kind, &signal.subtype, signal.value, &signal.name)?;
    Some((&signal.id, foot, site.facing_yaw(index, signal), meaning))
}

/// An object looks at the traffic of the lane that is nearest.
fn of_map_object<'a>(site: &Site<'_>, object: &'a ObjectInfo) -> Option<Found<'a>> {
    let foot = Point3::from(object.pose.xyz());
    if !site.near(foot.x, foot.y, reach_m::GIVEN) {
        return None;
    }
    let meaning = of_object(&object.kind, &object.name)?;
    let hit = site.map.nearest_driving_lane(foot)?;
    let lane = site.map.lane_point(hit.lane, hit.s, 0.0)?;
    Some((&object.id, foot, lane.heading_rad + std::f64::consts::PI, meaning))
}

/// The board of a sign, with what it says.
pub(super) fn board(site: &Site<'_>, foot: Point3<f64>, yaw: f64, meaning: Meaning) -> Draft {
    let plate = meaning.plate;
    let ground_z = site.levels().height(foot.x, foot.y, foot.z);
    let xyz = [foot.x, foot.y, ground_z + plate.bottom_m];
    let mut draft = Draft::new(ActorKind::Sign, plate.model, Tag::TrafficSign, plate.size_m, xyz, yaw);
    draft.tags.insert(0, Tag::Pole);
    draft.variant = SignFace {
        bottom_cm: (plate.bottom_m * 100.0).round() as u16,
        sign_type: SIGN_TYPES.iter().position(|word| *word == meaning.sign_type).unwrap_or(0) as u8,
        number: match meaning.value {
            Some(value) => value.round() as u16,
            None if [NAME.model, GUIDE.model].contains(&plate.model) => names(site, &foot),
            None => 0,
        },
    }
    .variant();
    let mut facts = Attributes::new().with(Attribute::SignType, meaning.sign_type);
    if let Some(value) = meaning.value {
        facts = facts.with(Attribute::Value, value);
    }
    draft.attributes = facts.with(Attribute::GroundZ, format_args!("{ground_z:.3}"));
    draft
}

/// Which made-up names a board has that says some: the same wherever it is asked from.
fn names(site: &Site<'_>, foot: &Point3<f64>) -> u16 {
    let [x, y] = [foot.x, foot.y].map(|v| (v * 10.0).round() as i64 as u64);
    let mut random = Stream::new(site.rules.seed, 0, "world/signs/names", x << 32 ^ y & 0xffff_ffff);
    (random.next_u32() & 0x3fff) as u16
}
