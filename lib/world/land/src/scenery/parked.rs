//! Vehicles that stand in parking spaces and parking lanes for the whole scene.

use std::collections::BTreeSet;
use std::f64::consts::FRAC_PI_2;

use catalogue::{BaseType, Catalogue, Model, Special, fleet, models};
use frames::math::{atan2, sin_cos};
use frames::{OrientedRect, wrap_pi};
use nalgebra::{Point3, Vector3};
use opendrive::{LaneInfo, LaneType};
use random::Stream;
use schema::ActorKind;

use crate::scenery::claims::{Candidate, Rank, rank, settle};
use crate::scenery::draft::Draft;
use crate::scenery::land::Land;
use crate::scenery::site::{Site, reach_m};
use crate::scenery::swept::is_swept;

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
/// Nobody parks as near as this to a way through a junction, metres from the middle of the place: long
/// vehicles swing out where they leave it.
const CORNER_M: f64 = 9.0;

/// Share of places at which a truck begins, which takes up two in a row; a bus, which takes up three; several
/// motorcycles side by side, which take up one. Where they do not fit there may be a car.
const TRUCKS: f64 = 0.03;
const BUSES: f64 = 0.006;
const MOTORCYCLES: f64 = 0.012;
/// Trucks and buses stand out of their places towards the road by at most this, metres, where traffic has
/// room for that.
const OUT_M: f64 = 0.25;
/// The longest vehicle that parks, metres: [`reach_m::PARKED`] counts on it.
const LONGEST_M: f64 = 12.5;
/// Distance between motorcycles side by side, metres.
const SIDE_BY_SIDE_M: f64 = 1.05;
/// Places in a row: their middles are a length apart within this, metres, and they point the same way within
/// this, radians.
const IN_A_ROW: [f64; 2] = [0.4, 0.06];

/// A place to park at.
#[derive(Clone, Copy)]
struct Bay {
    /// Names its random streams, with its number.
    entity: u64,
    slot: u64,
    at: Point3<f64>,
    yaw_rad: f64,
    /// Length and width, metres.
    room_m: [f64; 2],
}

/// A vehicle that would stand somewhere.
struct Stand {
    model: &'static Model,
    colour: [u8; 3],
    /// The ground under it.
    rect: OrientedRect,
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
        let yaw = object.pose.yaw() + if size[1] > size[0] { FRAC_PI_2 } else { 0.0 };
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
    let models = Models::of(site.catalogue);
    let near = |bay: &Bay| site.near(bay.at.x, bay.at.y, reach_m::PARKED + 1.0);
    let mut candidates = Vec::new();
    for row in [marked_bays(site), lane_bays(site)] {
        for (k, bay) in row.iter().enumerate().filter(|(_, bay)| near(bay)) {
            let kind = kind_at(site, bay);
            let held = match kind {
                Kind::One => None,
                Kind::Long { base, bays } => long(site, &row[k..], bays, base, &models, land),
                Kind::Motorcycles => motorcycles(site, bay, &models, land),
            };
            candidates.extend(held);
            candidates.extend(one(site, bay, &models, land));
        }
    }
    for Candidate { takes, what, .. } in settle(candidates, land) {
        if site.holds(takes.centre_m[0], takes.centre_m[1]) {
            drafts.extend(what.iter().filter_map(|stand| on_the_ground(site, stand)));
        }
    }
}

/// A model, and how common it is among those that stand alike.
type Common = (&'static Model, f64);

/// What is parked, by how it stands.
struct Models {
    ordinary: Vec<Common>,
    trucks: Vec<Common>,
    buses: Vec<Common>,
    motorcycles: Vec<Common>,
}

impl Models {
    fn of(catalogue: &Catalogue) -> Self {
        let fits = |m: &&'static Model| m.special != Special::Emergency && m.size_m[0] <= LONGEST_M;
        let civil = || catalogue.vehicles().filter(fits);
        let common = |m: &'static Model| -> Common { (m, catalogue.weight(m)) };
        let is_long = |m: &&'static Model| m.base == BaseType::Truck && m.size_m[0] > PLACE_M;
        let ordinary = |m: &&'static Model| {
            matches!(m.base, BaseType::Car | BaseType::Van) || m.base == BaseType::Truck && !is_long(m)
        };
        let motorcycles = models::PARKED_TWO_WHEELERS.iter().filter(|m| m.base == BaseType::Motorcycle);
        let motorcycles = motorcycles.filter(|m| m.special != Special::Emergency);
        Self {
            ordinary: civil().filter(ordinary).map(common).collect(),
            trucks: civil().filter(is_long).map(common).collect(),
            buses: civil().filter(|m| m.base == BaseType::Bus).map(common).collect(),
            motorcycles: motorcycles.map(|m| (m, fleet::weight(m))).collect(),
        }
    }
}

/// The parking spaces of the map, in its order.
fn marked_bays(site: &Site<'_>) -> Vec<Bay> {
    let bay = |(i, at, yaw_rad, room_m): (usize, Point3<f64>, f64, [f64; 2])| {
        let mut random = Stream::new(site.rules.seed, 0, "world/parked/turned", i as u64);
        let turned = if random.chance(0.1) { std::f64::consts::PI } else { 0.0 };
        Bay { entity: i as u64, slot: u64::MAX, at, yaw_rad: yaw_rad + turned, room_m }
    };
    spaces(site).map(bay).collect()
}

/// The places of parking lanes that have no marked spaces, lane by lane.
fn lane_bays(site: &Site<'_>) -> Vec<Bay> {
    let marked: BTreeSet<u32> =
        spaces(site).filter_map(|(i, ..)| site.map.objects().get(i)).map(|object| object.road).collect();
    let roads: BTreeSet<u32> = site.ground.sections.iter().map(|section| section.road).collect();
    let lanes = roads.difference(&marked).flat_map(|&road| {
        (0..site.map.section_count(road) as u16).flat_map(move |k| site.map.lanes_of(road, k))
    });
    let mut bays = Vec::new();
    for lane in lanes.filter(|l| l.lane_type == LaneType::Parking && l.junction.is_none()) {
        let entity =
            u64::from(lane.id.road) << 32 | u64::from(lane.id.section) << 16 | u64::from(lane.id.lane as u16);
        let places = (lane.s_length() / PLACE_M).floor().clamp(0.0, 10_000.0) as u32;
        for k in 0..places {
            let s = lane.s_start + (f64::from(k) + 0.5) * PLACE_M;
            // A row may go on beyond what is looked at.
            let close = |p: &Point3<f64>| site.near(p.x, p.y, reach_m::PARKED + 1.0 + 3.0 * PLACE_M);
            let Some(point) = site.map.lane_point(lane.id, s, 0.0).filter(|p| close(&p.position)) else {
                continue;
            };
            let turns = |l: &LaneInfo| l.junction.is_some() && l.lane_type.is_drivable();
            if !site.map.lanes_within(point.position, CORNER_M, turns).is_empty() {
                continue;
            }
            let room_m = [PLACE_M, point.width_m];
            bays.push(Bay { entity, slot: k.into(), at: point.position, yaw_rad: point.heading_rad, room_m });
        }
    }
    bays
}

/// What a place is taken up with, if it is.
enum Kind {
    One,
    Long { base: BaseType, bays: usize },
    Motorcycles,
}

fn kind_at(site: &Site<'_>, bay: &Bay) -> Kind {
    let mut random = Stream::new(site.rules.seed, bay.slot, "world/parked/kinds", bay.entity);
    // Half of the places are taken by default: shares are those of such a street.
    let roll = random.unit() / (2.0 * site.rules.parked_share).max(1e-9);
    match roll {
        _ if roll < BUSES => Kind::Long { base: BaseType::Bus, bays: 3 },
        _ if roll < BUSES + TRUCKS => Kind::Long { base: BaseType::Truck, bays: 2 },
        _ if roll < BUSES + TRUCKS + MOTORCYCLES => Kind::Motorcycles,
        _ => Kind::One,
    }
}

/// The rank of a place's vehicle. Those that need more than a car go before cars.
fn rank_of(site: &Site<'_>, bay: &Bay, topic: &str, first: bool) -> Rank {
    let (drawn, entity, slot) = rank(site.rules.seed, topic, bay.entity, bay.slot);
    (drawn >> 1 | u32::from(first) << 31, entity, slot)
}

/// A car, van or pickup in one place.
fn one(site: &Site<'_>, bay: &Bay, models: &Models, land: &Land<'_>) -> Option<Candidate<Vec<Stand>>> {
    let mut random = Stream::new(site.rules.seed, bay.slot, "world/parked/one", bay.entity);
    let taken = random.chance(site.rules.parked_share);
    let stand = drawn(&mut random, &models.ordinary, bay)?;
    let [length, width, _] = stand.model.size_m;
    if !taken || length + 0.4 > bay.room_m[0] || width + 0.1 > bay.room_m[1] {
        return None;
    }
    let rank = rank_of(site, bay, "world/parked/one/rank", false);
    fits(site, &stand.rect, bay.at.z, land).then(|| Candidate {
        takes: stand.rect,
        needs: stand.rect,
        rank,
        what: vec![stand],
    })
}

/// A truck or bus in the first places of a row.
fn long(
    site: &Site<'_>,
    row: &[Bay],
    bays: usize,
    base: BaseType,
    models: &Models,
    land: &Land<'_>,
) -> Option<Candidate<Vec<Stand>>> {
    let (row, bay) = (row.get(..bays)?, row.first()?);
    let in_a_row = |pair: &[Bay]| {
        let apart = (pair[1].at - pair[0].at).norm() - 0.5 * (pair[0].room_m[0] + pair[1].room_m[0]);
        // A vehicle that was turned in its place still is in the row.
        let turn = wrap_pi(2.0 * (pair[1].yaw_rad - pair[0].yaw_rad)).abs() / 2.0;
        apart.abs() < IN_A_ROW[0] && turn < IN_A_ROW[1] && (pair[1].at.z - pair[0].at.z).abs() < 1.0
    };
    if !row.windows(2).all(in_a_row) {
        return None;
    }
    let mut random = Stream::new(site.rules.seed, bay.slot, "world/parked/long", bay.entity);
    let last = row.last()?;
    let room_m = [row.iter().map(|b| b.room_m[0]).sum(), bay.room_m[1].min(last.room_m[1])];
    let whole = Bay { at: nalgebra::center(&bay.at, &last.at), room_m, ..*bay };
    let kinds = if base == BaseType::Bus { &models.buses } else { &models.trucks };
    let mut stand = drawn(&mut random, kinds, &whole)?;
    let [length, width, _] = stand.model.size_m;
    if length + 0.4 > room_m[0] || width > room_m[1] + OUT_M {
        return None;
    }
    // Its wheels stay off the kerb.
    let out_m = (0.5 * (width - room_m[1]) + 0.02).max(0.0);
    let road = site.map.nearest_driving_lane(whole.at)?;
    let left = Vector3::new(-stand.rect.axis[1], stand.rect.axis[0], 0.0);
    let to_road = site.map.lane_point(road.lane, road.s, 0.0)?.position - whole.at;
    let aside = if to_road.dot(&left) > 0.0 { out_m } else { -out_m };
    stand.rect.centre_m = [stand.rect.centre_m[0] + aside * left.x, stand.rect.centre_m[1] + aside * left.y];
    let rank = rank_of(site, bay, "world/parked/long/rank", true);
    fits(site, &stand.rect, bay.at.z, land).then(|| Candidate {
        takes: stand.rect,
        needs: stand.rect,
        rank,
        what: vec![stand],
    })
}

/// Motorcycles side by side across a place.
fn motorcycles(
    site: &Site<'_>,
    bay: &Bay,
    models: &Models,
    land: &Land<'_>,
) -> Option<Candidate<Vec<Stand>>> {
    let mut random = Stream::new(site.rules.seed, bay.slot, "world/parked/motorcycles", bay.entity);
    let count = 3 + random.index(3)?;
    let (s, c) = sin_cos(bay.yaw_rad);
    let takes = OrientedRect {
        centre_m: [bay.at.x, bay.at.y],
        axis: [c, s],
        half_m: [0.5 * SIDE_BY_SIDE_M * count as f64, 0.5 * bay.room_m[1]],
    };
    let mut stands = Vec::new();
    for k in 0..count {
        let along_m = (k as f64 - 0.5 * (count - 1) as f64) * SIDE_BY_SIDE_M;
        let at = Point3::new(bay.at.x + along_m * c, bay.at.y + along_m * s, bay.at.z);
        // They look at the road or away from it.
        let quarter = if random.chance(0.5) { FRAC_PI_2 } else { -FRAC_PI_2 };
        let place = Bay { at, yaw_rad: bay.yaw_rad + quarter, ..*bay };
        let mut stand = drawn(&mut random, &models.motorcycles, &place)?;
        stand.rect.centre_m = [at.x, at.y];
        if stand.model.size_m[0] + 0.05 <= bay.room_m[1] {
            stands.push(stand);
        }
    }
    let rank = rank_of(site, bay, "world/parked/motorcycles/rank", true);
    let room = 2.0 * takes.half_m[0] <= bay.room_m[0] && stands.len() > 1;
    (room && fits(site, &takes, bay.at.z, land)).then_some(Candidate {
        takes,
        needs: takes,
        rank,
        what: stands,
    })
}

/// Some vehicle about the middle of a place.
fn drawn(random: &mut Stream, models: &[Common], bay: &Bay) -> Option<Stand> {
    let (model, _) = random.choose_weighted(models, |(_, weight)| *weight).copied()?;
    let colour = random.choose(&COLOURS).copied().unwrap_or([128; 3]);
    let shift = random.uniform(-0.25, 0.25);
    let turn_rad = random.normal(0.0, 0.012);
    let [length, width, _] = model.size_m;
    let (s, c) = sin_cos(bay.yaw_rad);
    let centre_m = [bay.at.x + shift * c, bay.at.y + shift * s];
    let rect = OrientedRect { centre_m, axis: [c, s], half_m: [0.5 * length + 0.1, 0.5 * width] };
    Some(Stand { model, colour, rect, near_z_m: bay.at.z, yaw_rad: bay.yaw_rad, turn_rad })
}

/// Whether nothing stands on the ground, and buses in bends keep clear of it: of its corners, not only its
/// middle.
fn fits(site: &Site<'_>, rect: &OrientedRect, z: f64, land: &Land<'_>) -> bool {
    let steps = (rect.half_m[0] / 2.5).ceil().max(1.0) as i32;
    let swept = (-steps..=steps).any(|k| {
        let [x, y] = rect.at(f64::from(k) / f64::from(steps), 0.0);
        is_swept(site.map, Point3::new(x, y, z), rect.half_m[1])
    });
    !swept && land.unused(rect)
}

/// The vehicle as it lies with the road; none where that is too steep.
fn on_the_ground(site: &Site<'_>, stand: &Stand) -> Option<Draft> {
    let rect = &stand.rect;
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
    // On its stand a motorcycle is upright.
    let roll = if stand.model.base == BaseType::Motorcycle { 0.0 } else { roll };
    let tag = stand.model.base.tags().last().copied()?;
    let ([x, y], yaw) = (rect.centre_m, stand.yaw_rad + stand.turn_rad);
    let size_m = stand.model.size_m;
    let mut draft = Draft::new(ActorKind::Parked, stand.model.name, tag, size_m, [x, y, z], yaw);
    draft.rpy_rad = [roll, pitch, yaw];
    draft.color = stand.colour;
    Some(draft)
}
