//! Traffic lights, signs, street lamps, benches and bins.

use frames::OrientedRect;
use frames::math::{atan2, sin_cos};
use nalgebra::{Point3, Vector3};
use opendrive::SignalInfo;
use random::Stream;
use schema::footprint::LightMount;
use schema::{ActorKind, Attribute, Attributes, Tag};

use crate::claims::{Candidate, rank, settle};
use crate::draft::Draft;
use crate::frontage::{Frontage, Spot};
use crate::land::Land;
use crate::site::{Site, reach_m};
use crate::swept::is_swept;
use surfaces::Ground;

/// Housing of a traffic light: length, width, height, metres.
const HOUSING_M: [f64; 3] = [0.36, 0.42, 1.10];
/// Board of a sign, metres.
const BOARD_M: [f64; 3] = [0.08, 0.76, 0.76];
/// Bottom of a board over the ground, metres.
const BOARD_AT_M: f64 = 2.2;
/// Lanes farther from the pole than this get an arm over the road, metres.
const ARM_FROM_M: f64 = 5.0;
const MAX_ARM_M: f64 = 7.5;
const LAMP_M: [f64; 3] = [2.4, 0.28, 7.5];
/// Half the side of the ground that a pole takes, metres.
const FOOT_M: f64 = 0.3;
/// Half the thickness of its pole, metres.
const POLE_M: f64 = 0.14;

/// The lights and signs that the map has. Those of the area become objects; the ground of all that are near is taken.
pub(crate) fn signals(site: &Site<'_>, land: &mut Land<'_>, drafts: &mut Vec<Draft>) {
    let mut signs = Vec::new();
    for (i, signal) in site.map.signals().iter().enumerate() {
        let foot = signal.on_surface;
        if !site.near(foot.x, foot.y, reach_m::GIVEN) || (!signal.dynamic && is_paint(signal)) {
            continue;
        }
        land.take(OrientedRect::square([foot.x, foot.y], FOOT_M));
        if site.holds(foot.x, foot.y) {
            if signal.dynamic {
                drafts.push(light(site, i, signal));
            } else {
                signs.push(sign(site, i, signal));
            }
        }
    }
    for object in site.map.objects() {
        let at = object.pose.xyz();
        if !site.near(at[0], at[1], reach_m::GIVEN) {
            continue;
        }
        // Speed limits are objects known by their name alone.
        let name = object.name.to_ascii_lowercase();
        let digits: String = name.chars().filter(char::is_ascii_digit).collect();
        if !(name.contains("speed") || name.contains("spped")) || digits.is_empty() {
            continue;
        }
        let point = Point3::new(at[0], at[1], at[2]);
        let Some(hit) = site.map.nearest_driving_lane(point) else { continue };
        let Some(lane) = site.map.lane_point(hit.lane, hit.s, 0.0) else { continue };
        land.take(OrientedRect::square([at[0], at[1]], FOOT_M));
        if site.holds(at[0], at[1]) {
            let facts =
                Attributes::new().with(Attribute::SignType, "speed_limit").with(Attribute::Value, digits);
            let mut draft = board(site, point, lane.heading_rad + std::f64::consts::PI, "speed", facts);
            draft.opendrive_id = Some(object.id.clone());
            signs.push(draft);
        }
    }
    drafts.append(&mut signs);
}

/// Paint that is listed among the signals is no sign.
fn is_paint(signal: &SignalInfo) -> bool {
    let name = signal.name.to_ascii_lowercase();
    signal.kind.eq_ignore_ascii_case("roadmark") || name.contains("stopline") || name.contains("stencil")
}

/// Yaw of what a signal's traffic sees: against their direction of travel.
fn facing_yaw(site: &Site<'_>, index: usize, signal: &SignalInfo) -> f64 {
    let mut sum = Vector3::zeros();
    for stop in site.map.stop_points(index) {
        if let Some(point) = site.map.point_at(stop) {
            let (s, c) = sin_cos(point.heading_rad);
            sum += Vector3::new(c, s, 0.0);
        }
    }
    if sum.norm() > 0.3 { atan2(-sum.y, -sum.x) } else { signal.pose.yaw() + std::f64::consts::PI }
}

fn light(site: &Site<'_>, index: usize, signal: &SignalInfo) -> Draft {
    let foot = signal.on_surface;
    let ground_z = site.levels().height(foot.x, foot.y, foot.z);
    let yaw = facing_yaw(site, index, signal);
    let (s, c) = sin_cos(yaw);
    // Left of the way it faces is the right of the traffic that sees it.
    let (face, left) = (Vector3::new(c, s, 0.0), Vector3::new(-s, c, 0.0));
    let lanes: Vec<f64> = site
        .map
        .stop_points(index)
        .into_iter()
        .filter_map(|stop| site.map.point_at(stop))
        .map(|p| (p.position - foot).dot(&left))
        .collect();
    let mean = lanes.iter().sum::<f64>() / lanes.len().max(1) as f64;
    let arm = if mean.abs() > ARM_FROM_M { (mean.abs() - 1.0).min(MAX_ARM_M) } else { 0.0 };
    // Whole decimetres and centimetres: that is what the variant can say.
    let arm = (10.0 * arm).round() / 10.0;
    let height = if arm > 0.0 { 5.2 } else { 2.6 };
    let mount = LightMount { height_m: height as f32, arm_m: arm as f32, pole_right: mean < 0.0 };
    let aside = if mount.pole_right { -arm } else { arm };
    let at = foot + left * aside + face * (0.5 * HOUSING_M[0] + 0.07);
    let mut draft = Draft::new(
        ActorKind::TrafficLight,
        "light.signal",
        Tag::TrafficLight,
        HOUSING_M,
        [at.x, at.y, ground_z + height],
        yaw,
    );
    draft.tags.insert(0, Tag::Pole);
    draft.variant = mount.to_variant();
    draft.opendrive_id = Some(signal.id.clone());
    draft.attributes = Attributes::new().with(Attribute::GroundZ, format_args!("{ground_z:.3}"));
    draft
}

fn sign(site: &Site<'_>, index: usize, signal: &SignalInfo) -> Draft {
    let (kind, sign_type) = match signal.kind.as_str() {
        "205" => ("yield", "yield"),
        "206" => ("stop", "stop"),
        "274" => ("speed", "speed_limit"),
        _ => ("other", "other"),
    };
    let mut facts = Attributes::new().with(Attribute::SignType, sign_type);
    if let Some(value) = signal.value.filter(|v| *v > 0.0) {
        facts = facts.with(Attribute::Value, value);
    }
    let mut draft = board(site, signal.on_surface, facing_yaw(site, index, signal), kind, facts);
    draft.opendrive_id = Some(signal.id.clone());
    draft
}

/// The board of a sign, with what it says.
fn board(site: &Site<'_>, foot: Point3<f64>, yaw: f64, kind: &str, facts: Attributes) -> Draft {
    let ground_z = site.levels().height(foot.x, foot.y, foot.z);
    let xyz = [foot.x, foot.y, ground_z + BOARD_AT_M];
    let mut draft = Draft::new(ActorKind::Sign, &format!("sign.{kind}"), Tag::TrafficSign, BOARD_M, xyz, yaw);
    draft.tags.insert(0, Tag::Pole);
    draft.variant = (BOARD_AT_M * 100.0).round() as u32;
    draft.attributes = facts.with(Attribute::GroundZ, format_args!("{ground_z:.3}"));
    draft
}

/// A street lamp: its foot's place and the middle of its box.
struct Lamp {
    middle: Point3<f64>,
    z_m: f64,
    yaw_rad: f64,
}

/// Street lamps at the kerb of sidewalks, their heads over the road; beside fast roads without sidewalks, too.
pub(crate) fn lamps(site: &Site<'_>, fronts: &[Frontage], land: &mut Land<'_>, drafts: &mut Vec<Draft>) {
    let spacing = site.rules.lamp_spacing_m.max(5.0);
    let mut candidates = Vec::new();
    for front in fronts.iter().filter(|f| !f.track) {
        // Lamps of the two sides stand in turn.
        let first = if front.entity % 2 == 0 { 0.25 } else { 0.75 } * spacing;
        for slot in 0u32.. {
            let along = first + f64::from(slot) * spacing;
            if along >= front.length_m() - 2.0 {
                break;
            }
            let Some(spot) = front.at(along) else { break };
            if let Some(lamp) = lamp_at(site, &spot, land) {
                let rank = rank(site.rules.seed, "world/lamps/rank", front.entity, slot.into());
                let foot = OrientedRect::square([spot.foot().x, spot.foot().y], FOOT_M);
                candidates.push(Candidate { takes: foot, needs: foot, rank, what: lamp });
            }
        }
    }
    for Candidate { takes, what: Lamp { middle, z_m, yaw_rad }, .. } in settle(candidates, land) {
        if site.holds(takes.centre_m[0], takes.centre_m[1]) {
            let xyz = [middle.x, middle.y, z_m];
            drafts.push(Draft::new(ActorKind::Pole, "pole.lamp", Tag::Pole, LAMP_M, xyz, yaw_rad));
        }
    }
}

fn lamp_at(site: &Site<'_>, spot: &Spot, land: &Land<'_>) -> Option<Lamp> {
    let foot = spot.foot();
    if !site.near(foot.x, foot.y, reach_m::LAMPS) {
        return None;
    }
    let on_lane = site.levels().cover.at(foot.x, foot.y).any(|(f, _)| f.ground == Ground::Paved);
    let swept = || is_swept(site.map, Point3::new(foot.x, foot.y, spot.point.z), POLE_M);
    if on_lane || !land.unused(&OrientedRect::square([foot.x, foot.y], FOOT_M)) || swept() {
        return None;
    }
    let z_m = site.levels().height(foot.x, foot.y, spot.point.z);
    // The pole stands at the rear end of the lamp's box.
    let middle = spot.beside(spot.pole_m() - 0.5 * LAMP_M[0] + 0.13, 0.0);
    // Beside a bridge the ground is too low for a lamp to light the deck.
    ((z_m - spot.point.z).abs() <= 1.0).then_some(Lamp { middle, z_m, yaw_rad: spot.facing_yaw() })
}

impl Spot {
    /// How far the pole of a lamp stands beyond the edge, metres: just inside the kerb, or beside the road.
    fn pole_m(&self) -> f64 {
        if self.walk_m > 0.9 { 0.35 - self.walk_m } else { 0.6 }
    }

    fn foot(&self) -> Point3<f64> {
        self.beside(self.pole_m(), 0.0)
    }
}

/// A bench or bin.
struct Small {
    model: &'static str,
    size_m: [f64; 3],
    variant: u32,
    near_z_m: f64,
    yaw_rad: f64,
}

/// Benches and bins along the outer edge of sidewalks.
pub(crate) fn small_things(
    site: &Site<'_>,
    fronts: &[Frontage],
    land: &mut Land<'_>,
    drafts: &mut Vec<Draft>,
) {
    let mut candidates = Vec::new();
    for front in fronts {
        let mut random = Stream::new(site.rules.seed, 0, "world/furniture", front.entity);
        let mut along = random.uniform(6.0, 30.0);
        let mut slot = 0;
        while along < front.length_m() - 3.0 {
            let bench = random.chance(0.6);
            let variant = random.next_u32() % 3;
            let Some(spot) = front.at(along) else { break };
            along += random.uniform(14.0, 45.0);
            slot += 2;
            if spot.walk_m <= 0.0 {
                continue;
            }
            let mut add = |model: &'static str, size_m: [f64; 3], sideways: f64, slot: u64| {
                let at = spot.beside(0.5, sideways);
                let rect = OrientedRect {
                    centre_m: [at.x, at.y],
                    axis: [-spot.away.x, -spot.away.y],
                    half_m: [0.5 * size_m[0], 0.5 * size_m[1]],
                };
                if site.near(at.x, at.y, reach_m::SMALL) && land.free(&rect) {
                    let (near_z_m, yaw_rad) = (spot.point.z, spot.facing_yaw());
                    let rank = rank(site.rules.seed, "world/furniture/rank", front.entity, slot);
                    let what = Small { model, size_m, variant, near_z_m, yaw_rad };
                    candidates.push(Candidate { takes: rect, needs: rect, rank, what });
                }
            };
            if bench {
                add("prop.bench", [0.55, 1.70, 0.85], 0.0, slot);
            }
            add("prop.bin", [0.42, 0.42, 0.95], 1.6, slot + 1);
        }
    }
    for Candidate { takes, what: thing, .. } in settle(candidates, land) {
        let [x, y] = takes.centre_m;
        if site.holds(x, y) {
            let xyz = [x, y, site.levels().height(x, y, thing.near_z_m)];
            let mut draft =
                Draft::new(ActorKind::Prop, thing.model, Tag::Static, thing.size_m, xyz, thing.yaw_rad);
            draft.variant = thing.variant;
            drafts.push(draft);
        }
    }
}
