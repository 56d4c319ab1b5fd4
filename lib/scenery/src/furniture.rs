//! Traffic lights, signs, street lamps, benches and bins.

use frames::OrientedRect;
use frames::math::{atan2, sin_cos};
use nalgebra::{Point3, Vector3};
use opendrive::SignalInfo;
use random::Stream;
use schema::footprint::LightMount;
use schema::{ActorKind, Attribute, Attributes, Tag};

use crate::draft::Draft;
use crate::frontage::Frontage;
use crate::land::Land;
use crate::site::Site;
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
/// Half the thickness of its pole, metres.
const POLE_M: f64 = 0.14;

pub(crate) fn signals(site: &Site<'_>, land: &mut Land<'_>, drafts: &mut Vec<Draft>) {
    let mut signs = Vec::new();
    for (i, signal) in site.map.signals().iter().enumerate() {
        let foot = signal.on_surface;
        if !site.near(foot.x, foot.y) {
            continue;
        }
        if signal.dynamic {
            drafts.push(light(site, i, signal, land));
        } else {
            signs.extend(sign(site, i, signal, land));
        }
    }
    for object in site.map.objects() {
        let name = object.name.to_ascii_lowercase();
        let at = object.pose.xyz();
        // Speed limits are objects known by their name alone.
        let digits: String = name.chars().filter(char::is_ascii_digit).collect();
        if !(name.contains("speed") || name.contains("spped"))
            || digits.is_empty()
            || !site.near(at[0], at[1])
        {
            continue;
        }
        let point = Point3::new(at[0], at[1], at[2]);
        let Some(hit) = site.map.nearest_driving_lane(point) else { continue };
        let Some(lane) = site.map.lane_point(hit.lane, hit.s, 0.0) else { continue };
        let facts = Attributes::new().with(Attribute::SignType, "speed_limit").with(Attribute::Value, digits);
        let mut draft = board(site, point, lane.heading_rad + std::f64::consts::PI, "speed", facts, land);
        draft.opendrive_id = Some(object.id.clone());
        signs.push(draft);
    }
    drafts.append(&mut signs);
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

fn light(site: &Site<'_>, index: usize, signal: &SignalInfo, land: &mut Land<'_>) -> Draft {
    let foot = signal.on_surface;
    let ground_z = site.ground.height(foot.x, foot.y, foot.z);
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
    draft.variant = mount.to_variant();
    draft.opendrive_id = Some(signal.id.clone());
    draft.attributes = Attributes::new().with(Attribute::GroundZ, format_args!("{ground_z:.3}"));
    land.take(OrientedRect::square([foot.x, foot.y], 0.3));
    draft
}

fn sign(site: &Site<'_>, index: usize, signal: &SignalInfo, land: &mut Land<'_>) -> Option<Draft> {
    let name = signal.name.to_ascii_lowercase();
    // Paint that is listed among the signals is no sign.
    if signal.kind.eq_ignore_ascii_case("roadmark") || name.contains("stopline") || name.contains("stencil") {
        return None;
    }
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
    let mut draft = board(site, signal.on_surface, facing_yaw(site, index, signal), kind, facts, land);
    draft.opendrive_id = Some(signal.id.clone());
    Some(draft)
}

/// The board of a sign, with what it says.
fn board(
    site: &Site<'_>,
    foot: Point3<f64>,
    yaw: f64,
    kind: &str,
    facts: Attributes,
    land: &mut Land<'_>,
) -> Draft {
    let ground_z = site.ground.height(foot.x, foot.y, foot.z);
    let xyz = [foot.x, foot.y, ground_z + BOARD_AT_M];
    let mut draft = Draft::new(ActorKind::Sign, &format!("sign.{kind}"), Tag::TrafficSign, BOARD_M, xyz, yaw);
    draft.variant = (BOARD_AT_M * 100.0).round() as u32;
    draft.attributes = facts.with(Attribute::GroundZ, format_args!("{ground_z:.3}"));
    land.take(OrientedRect::square([foot.x, foot.y], 0.3));
    draft
}

/// Street lamps at the kerb of sidewalks, their heads over the road; beside fast roads without sidewalks, too.
pub(crate) fn lamps(site: &Site<'_>, fronts: &[Frontage], land: &mut Land<'_>, drafts: &mut Vec<Draft>) {
    let spacing = site.settings.lamp_spacing_m.max(5.0);
    for front in fronts.iter().filter(|f| !f.track) {
        // Lamps of the two sides stand in turn.
        let mut along = if front.entity % 2 == 0 { 0.25 } else { 0.75 } * spacing;
        while along < front.length_m() - 2.0 {
            let Some(spot) = front.at(along) else { break };
            along += spacing;
            // The pole stands at the rear end of the lamp's box, just inside the kerb or beyond the edge.
            let pole = if spot.walk_m > 0.9 { 0.35 - spot.walk_m } else { 0.6 };
            let foot = spot.beside(pole, 0.0);
            let middle = spot.beside(pole - 0.5 * LAMP_M[0] + 0.13, 0.0);
            let rect = OrientedRect::square([foot.x, foot.y], 0.3);
            let on_lane = site.ground.cover.at(foot.x, foot.y).any(|(f, _)| f.ground == Ground::Paved);
            if on_lane || !site.near(foot.x, foot.y) || !land.unused(&rect) {
                continue;
            }
            if is_swept(site.map, Point3::new(foot.x, foot.y, spot.point.z), POLE_M) {
                continue;
            }
            let z = site.ground.height(foot.x, foot.y, spot.point.z);
            // Beside a bridge the ground is too low for a lamp to light the deck.
            if (z - spot.point.z).abs() > 1.0 {
                continue;
            }
            let draft = Draft::new(
                ActorKind::Pole,
                "pole.lamp",
                Tag::Pole,
                LAMP_M,
                [middle.x, middle.y, z],
                spot.facing_yaw(),
            );
            drafts.push(draft);
            land.take(rect);
        }
    }
}

/// Benches and bins along the outer edge of sidewalks.
pub(crate) fn small_things(
    site: &Site<'_>,
    fronts: &[Frontage],
    land: &mut Land<'_>,
    drafts: &mut Vec<Draft>,
) {
    for front in fronts {
        let mut random = Stream::new(site.seed, 0, "world/furniture", front.entity);
        let mut along = random.uniform(6.0, 30.0);
        while along < front.length_m() - 3.0 {
            let bench = random.chance(0.6);
            let variant = random.next_u32() % 3;
            let Some(spot) = front.at(along) else { break };
            along += random.uniform(14.0, 45.0);
            if spot.walk_m <= 0.0 || !site.near(spot.point.x, spot.point.y) {
                continue;
            }
            let mut add = |model: &str, size: [f64; 3], sideways: f64| {
                let at = spot.beside(0.5, sideways);
                let rect = OrientedRect {
                    centre_m: [at.x, at.y],
                    axis: [-spot.away.x, -spot.away.y],
                    half_m: [0.5 * size[0], 0.5 * size[1]],
                };
                if land.free(&rect) {
                    let z = site.ground.height(at.x, at.y, spot.point.z);
                    let mut draft = Draft::new(
                        ActorKind::Prop,
                        model,
                        Tag::Static,
                        size,
                        [at.x, at.y, z],
                        spot.facing_yaw(),
                    );
                    draft.variant = variant;
                    drafts.push(draft);
                    land.take(rect);
                }
            };
            if bench {
                add("prop.bench", [0.55, 1.70, 0.85], 0.0);
            }
            add("prop.bin", [0.42, 0.42, 0.95], 1.6);
        }
    }
}
