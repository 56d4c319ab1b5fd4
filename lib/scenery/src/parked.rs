//! Vehicles that stand in parking spaces and parking lanes for the whole scene.

use std::collections::BTreeSet;

use frames::OrientedRect;
use frames::math::{atan2, sin_cos};
use nalgebra::Point3;
use opendrive::{LaneInfo, LaneType};
use random::Stream;
use schema::ActorKind;
use schema::models::{self, BaseType, Model};

use crate::claims::{Candidate, Rank, rank, settle};
use crate::draft::Draft;
use crate::land::Land;
use crate::site::{Site, reach_m};
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

/// A vehicle that would stand somewhere.
struct Stand {
    model: &'static Model,
    colour: [u8; 3],
    /// Height of the place that it is for, metres.
    near_z_m: f64,
    /// Along its space, and how much it stands askew, radians.
    yaw_rad: f64,
    turn_rad: f64,
}

/// The parking spaces that the map holds as objects: number, place, heading of a car, length and width.
fn spaces(site: &Site<'_>) -> impl Iterator<Item = (usize, Point3<f64>, f64, [f64; 2])> {
    let spaces = site.map.objects().iter().enumerate();
    spaces.filter(|(_, object)| object.kind.eq_ignore_ascii_case("parkingspace")).map(|(i, object)| {
        let size = [object.size_m.x, object.size_m.y];
        // The car stands along the longer side of its space.
        let yaw = object.pose.yaw() + if size[1] > size[0] { std::f64::consts::FRAC_PI_2 } else { 0.0 };
        (i, object.pose.xyz().into(), yaw, [size[0].max(size[1]), size[0].min(size[1])])
    })
}

/// Takes the ground of marked spaces: nothing is built there, whether somebody stands there or not.
pub(crate) fn keep_spaces(site: &Site<'_>, land: &mut Land<'_>) {
    for (_, at, yaw, room) in spaces(site).filter(|(_, at, ..)| site.near(at.x, at.y, reach_m::GIVEN)) {
        land.take(OrientedRect::new([at.x, at.y], yaw, room.map(|v| (0.5 * v).min(8.0))));
    }
}

pub(crate) fn parked(site: &Site<'_>, land: &mut Land<'_>, drafts: &mut Vec<Draft>) {
    let cars: Vec<&'static Model> = models::vehicles()
        .filter(|m| matches!(m.base, BaseType::Car | BaseType::Van) && m.special != "emergency")
        .collect();
    let seed = site.rules.seed;
    let mut candidates = Vec::new();
    let near = |at: &Point3<f64>| site.near(at.x, at.y, reach_m::PARKED + 1.0);
    for (i, at, yaw, room) in spaces(site).filter(|(_, at, ..)| near(at)) {
        let mut random = Stream::new(seed, 0, "world/parked/spaces", i as u64);
        let yaw = if random.chance(0.1) { yaw + std::f64::consts::PI } else { yaw };
        let rank = rank(seed, "world/parked/spaces/rank", i as u64, 0);
        candidates.extend(stand(site, at, yaw, room, &cars, &mut random, rank, land));
    }
    let marked: BTreeSet<u32> =
        spaces(site).filter_map(|(i, ..)| site.map.objects().get(i)).map(|object| object.road).collect();
    let roads: BTreeSet<u32> = site.ground.sections.iter().map(|section| section.road).collect();
    let lanes = roads.difference(&marked).flat_map(|&road| {
        (0..site.map.section_count(road) as u16).flat_map(move |k| site.map.lanes_of(road, k))
    });
    for lane in lanes.filter(|l| l.lane_type == LaneType::Parking && l.junction.is_none()) {
        let entity =
            u64::from(lane.id.road) << 32 | u64::from(lane.id.section) << 16 | u64::from(lane.id.lane as u16);
        let places = (lane.s_length() / PLACE_M).floor().clamp(0.0, 10_000.0) as u32;
        for k in 0..places {
            let s = lane.s_start + (f64::from(k) + 0.5) * PLACE_M;
            let Some(point) = site.map.lane_point(lane.id, s, 0.0).filter(|p| near(&p.position)) else {
                continue;
            };
            let turns = |l: &LaneInfo| l.junction.is_some() && l.lane_type.is_drivable();
            if !site.map.lanes_within(point.position, CORNER_M, turns).is_empty() {
                continue;
            }
            let mut random = Stream::new(seed, k.into(), "world/parked/lanes", entity);
            let rank = rank(seed, "world/parked/lanes/rank", entity, k.into());
            let (at, yaw, room) = (point.position, point.heading_rad, [PLACE_M, point.width_m]);
            candidates.extend(stand(site, at, yaw, room, &cars, &mut random, rank, land));
        }
    }
    for Candidate { takes, what, .. } in settle(candidates, land) {
        if site.holds(takes.centre_m[0], takes.centre_m[1]) {
            drafts.extend(on_the_ground(site, &takes, &what));
        }
    }
}

#[allow(clippy::too_many_arguments)] // One space's facts.
fn stand(
    site: &Site<'_>,
    at: Point3<f64>,
    yaw: f64,
    room: [f64; 2],
    cars: &[&'static Model],
    random: &mut Stream,
    rank: Rank,
    land: &Land<'_>,
) -> Option<Candidate<Stand>> {
    let taken = random.chance(site.rules.parked_share);
    let model = random.choose(cars).copied()?;
    let colour = random.choose(&COLOURS).copied().unwrap_or([128; 3]);
    let shift = random.uniform(-0.25, 0.25);
    let turn_rad = random.normal(0.0, 0.012);
    let [length, width, _] = model.size_m;
    if !taken || length + 0.4 > room[0] || width + 0.1 > room[1] {
        return None;
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
        return None;
    }
    let what = Stand { model, colour, near_z_m: at.z, yaw_rad: yaw, turn_rad };
    Some(Candidate { takes: rect, needs: rect, rank, what })
}

/// The vehicle as it lies with the road; none where that is too steep.
fn on_the_ground(site: &Site<'_>, rect: &OrientedRect, stand: &Stand) -> Option<Draft> {
    // Heights under its ends and sides.
    let ground = |u: f64, v: f64| {
        let [x, y] = rect.at(u, v);
        site.levels().height(x, y, stand.near_z_m)
    };
    let z = ground(0.0, 0.0);
    let pitch = -atan2(ground(0.7, 0.0) - ground(-0.7, 0.0), 1.4 * rect.half_m[0]);
    let roll = atan2(ground(0.0, 0.6) - ground(0.0, -0.6), 1.2 * rect.half_m[1]);
    if pitch.abs() > 0.25 || roll.abs() > 0.25 {
        return None;
    }
    let tag = stand.model.base.tags().last().copied()?;
    let ([x, y], yaw) = (rect.centre_m, stand.yaw_rad + stand.turn_rad);
    let size_m = stand.model.size_m;
    let mut draft = Draft::new(ActorKind::Parked, stand.model.name, tag, size_m, [x, y, z], yaw);
    draft.rpy_rad = [roll, pitch, yaw];
    draft.color = stand.colour;
    Some(draft)
}
