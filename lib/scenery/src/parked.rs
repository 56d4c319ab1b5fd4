//! Vehicles that stand in parking spaces and parking lanes for the whole scene.

use frames::OrientedRect;
use frames::math::{atan2, sin_cos};
use nalgebra::Point3;
use opendrive::{LaneInfo, LanePoint, LaneType};
use random::Stream;
use schema::ActorKind;
use schema::models::{self, BaseType, Model};

use crate::draft::Draft;
use crate::land::Land;
use crate::site::Site;
use crate::swept::is_swept;

/// Ordinary car colours, sRGB.
const COLOURS: [[u8; 3]; 10] = [
    [235, 235, 232],
    [28, 28, 30],
    [120, 122, 126],
    [178, 180, 184],
    [150, 20, 24],
    [24, 52, 110],
    [70, 84, 60],
    [196, 186, 164],
    [60, 62, 68],
    [198, 120, 30],
];
/// Length of a place in a parking lane without marked spaces, metres.
const PLACE_M: f64 = 6.5;
/// Nobody parks as near as this to a way through a junction, metres from the middle of the place: long vehicles swing out
/// where they leave it.
const CORNER_M: f64 = 9.0;

pub(crate) fn parked(site: &Site<'_>, land: &mut Land<'_>, drafts: &mut Vec<Draft>) {
    let cars: Vec<&Model> = models::vehicles()
        .filter(|m| matches!(m.base, BaseType::Car | BaseType::Van) && m.special != "emergency")
        .collect();
    let mut marked = Vec::new();
    for (i, object) in site.map.objects().iter().enumerate() {
        if !object.kind.eq_ignore_ascii_case("parkingspace") {
            continue;
        }
        marked.push(object.road);
        let at = object.pose.xyz();
        let size = [object.size_m.x, object.size_m.y];
        let mut random = Stream::new(site.seed, 0, "world/parked/spaces", i as u64);
        // The car stands along the longer side of its space.
        let yaw = object.pose.yaw() + if size[1] > size[0] { std::f64::consts::FRAC_PI_2 } else { 0.0 };
        let yaw = if random.chance(0.1) { yaw + std::f64::consts::PI } else { yaw };
        let room = [size[0].max(size[1]), size[0].min(size[1])];
        stand(site, Point3::new(at[0], at[1], at[2]), yaw, room, &cars, &mut random, land, drafts);
    }
    for lane in site.map.lanes() {
        if lane.lane_type != LaneType::Parking || marked.contains(&lane.id.road) || lane.junction.is_some() {
            continue;
        }
        let entity =
            u64::from(lane.id.road) << 32 | u64::from(lane.id.section) << 16 | u64::from(lane.id.lane as u16);
        let mut random = Stream::new(site.seed, 0, "world/parked/lanes", entity);
        let places = (lane.s_length() / PLACE_M).floor().clamp(0.0, 10_000.0) as usize;
        for k in 0..places {
            let s = lane.s_start + (k as f64 + 0.5) * PLACE_M;
            let open = |point: &LanePoint| {
                let turns = |l: &LaneInfo| l.junction.is_some() && l.lane_type.is_drivable();
                site.map.lanes_within(point.position, CORNER_M, turns).is_empty()
            };
            if let Some(point) = site.map.lane_point(lane.id, s, 0.0).filter(open) {
                stand(
                    site,
                    point.position,
                    point.heading_rad,
                    [PLACE_M, point.width_m],
                    &cars,
                    &mut random,
                    land,
                    drafts,
                );
            }
        }
    }
}

#[allow(clippy::too_many_arguments)] // One space's facts.
fn stand(
    site: &Site<'_>,
    at: Point3<f64>,
    yaw: f64,
    room: [f64; 2],
    cars: &[&Model],
    random: &mut Stream,
    land: &mut Land<'_>,
    drafts: &mut Vec<Draft>,
) {
    let taken = random.chance(site.settings.parked_share);
    let model = random.choose(cars).copied();
    let colour = random.choose(&COLOURS).copied().unwrap_or([128; 3]);
    let shift = random.uniform(-0.25, 0.25);
    let turn = random.normal(0.0, 0.012);
    let Some(model) = model else { return };
    let [length, width, height] = model.size_m;
    if !taken || !site.near(at.x, at.y) || length + 0.4 > room[0] || width + 0.1 > room[1] {
        return;
    }
    let (s, c) = sin_cos(yaw);
    let (x, y) = (at.x + shift * c, at.y + shift * s);
    let rect = OrientedRect { centre_m: [x, y], axis: [c, s], half_m: [0.5 * length + 0.1, 0.5 * width] };
    // Its corners, not only its middle, stay clear of buses in bends.
    let swept = [-1.0, 0.0, 1.0].iter().any(|end| {
        let [x, y] = rect.at(*end, 0.0);
        is_swept(site.map, Point3::new(x, y, at.z), 0.5 * width)
    });
    if swept || !land.unused(&rect) {
        return;
    }
    // On a slope the car lies with the road: heights under its ends and sides.
    let ground = |u: f64, v: f64| {
        let [x, y] = rect.at(u, v);
        site.ground.height(x, y, at.z)
    };
    let z = ground(0.0, 0.0);
    let pitch = -atan2(ground(0.7, 0.0) - ground(-0.7, 0.0), 1.4 * rect.half_m[0]);
    let roll = atan2(ground(0.0, 0.6) - ground(0.0, -0.6), 1.2 * rect.half_m[1]);
    if pitch.abs() > 0.25 || roll.abs() > 0.25 {
        return;
    }
    let Some(tag) = model.base.tags().last().copied() else { return };
    let mut draft =
        Draft::new(ActorKind::Parked, model.name, tag, [length, width, height], [x, y, z], yaw + turn);
    draft.rpy_rad = [roll, pitch, yaw + turn];
    draft.color = colour;
    drafts.push(draft);
    land.take(rect);
}
