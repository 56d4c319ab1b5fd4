//! Bicycles locked to hoops along the kerbs of sidewalks.

use crate::surfaces::Ground;
use catalogue::{BaseType, Model, models::PARKED_TWO_WHEELERS};
use frames::OrientedRect;
use frames::math::atan2;
use random::Stream;
use schema::{ActorKind, Tag};

use crate::scenery::claims::{Candidate, rank, settle};
use crate::scenery::draft::Draft;
use crate::scenery::frontage::{Frontage, Spot};
use crate::scenery::land::Land;
use crate::scenery::site::{Site, reach_m};
use crate::scenery::swept::is_swept;

/// Share of the sides of streets that have a rack, and how long they are at least, metres.
const RACKS: f64 = 0.06;
const SHORTEST_M: f64 = 40.0;
/// Sidewalks with a rack are at least this wide, metres: walkers get by.
const WALK_M: f64 = 2.2;
/// From the kerb to the middle of a rack, metres.
const FROM_KERB_M: f64 = 0.5;
/// Half the width of the ground it takes, metres.
const HALF_WIDTH_M: f64 = 0.36;
/// Distance between hoops, and a hoop's size, metres.
const STEP_M: f64 = 2.0;
const HOOP_M: [f64; 3] = [0.9, 0.05, 0.85];
/// Share of hoops with a bicycle.
const USED: f64 = 0.8;
/// A bicycle stands this far beside its hoop, metres.
const BESIDE_HOOP_M: f64 = 0.09;

/// A hoop of a rack, with the bicycle at it.
struct Hoop {
    xy_m: [f64; 2],
    bicycle: Option<(&'static Model, [u8; 3], bool)>,
}

/// A rack that would stand somewhere.
struct Rack {
    hoops: Vec<Hoop>,
    near_z_m: f64,
    yaw_rad: f64,
}

/// Puts racks where nothing else stands, on sidewalks beside slow streets.
pub(crate) fn racks(site: &Site<'_>, fronts: &[Frontage], land: &mut Land<'_>, drafts: &mut Vec<Draft>) {
    let bicycles: Vec<&'static Model> =
        PARKED_TWO_WHEELERS.iter().filter(|m| m.base == BaseType::Bicycle && m.size_m[0] < STEP_M).collect();
    let mut candidates = Vec::new();
    for front in fronts.iter().filter(|f| !f.track && f.length_m() > SHORTEST_M) {
        let mut random = Stream::new(site.rules.seed, 0, "world/racks", front.entity);
        let wanted = random.chance(RACKS);
        let along_m = random.uniform(12.0, front.length_m() - 12.0);
        let Some(spot) = front.at(along_m).filter(|spot| wanted && spot.walk_m >= WALK_M) else { continue };
        candidates.extend(rack(site, &spot, &bicycles, &mut random, land).map(|(takes, what)| {
            let rank = rank(site.rules.seed, "world/racks/rank", front.entity, 0);
            Candidate { takes, needs: takes, rank, what }
        }));
    }
    for Candidate { takes, what: rack, .. } in settle(candidates, land) {
        if site.holds(takes.centre_m[0], takes.centre_m[1]) {
            put(site, &takes, &rack, drafts);
        }
    }
}

fn rack(
    site: &Site<'_>,
    spot: &Spot,
    bicycles: &[&'static Model],
    random: &mut Stream,
    land: &Land<'_>,
) -> Option<(OrientedRect, Rack)> {
    let count = 2;
    let along = [-spot.away.y, spot.away.x];
    let middle = spot.beside(FROM_KERB_M - spot.walk_m, 0.0);
    let takes = OrientedRect {
        centre_m: [middle.x, middle.y],
        axis: along,
        half_m: [0.5 * STEP_M * f64::from(count), HALF_WIDTH_M],
    };
    let hoops = (0..count).map(|k| {
        let off_m = (f64::from(k) - 0.5 * f64::from(count - 1)) * STEP_M;
        let bicycle = random.choose(bicycles).copied();
        let colour = [0, 1, 2].map(|_| (30.0 + 190.0 * random.unit()) as u8);
        let (used, turned) = (random.chance(USED), random.chance(0.4));
        Hoop {
            xy_m: [middle.x + off_m * along[0], middle.y + off_m * along[1]],
            bicycle: bicycle.filter(|_| used).map(|model| (model, colour, turned)),
        }
    });
    let rack = Rack { hoops: hoops.collect(), near_z_m: spot.point.z, yaw_rad: atan2(along[1], along[0]) };
    if !site.near(middle.x, middle.y, reach_m::RACKS) || !land.unused(&takes) {
        return None;
    }
    // All of it lies on the sidewalk, and buses keep clear.
    let good = [[-1.0, -1.0], [-1.0, 1.0], [0.0, 0.0], [1.0, -1.0], [1.0, 1.0]].iter().all(|[u, v]| {
        let [x, y] = takes.at(*u, *v);
        let mut levels =
            site.levels().cover.at(x, y).filter(|(_, z)| (z - spot.point.z).abs() < 1.0).peekable();
        levels.peek().is_some()
            && levels.all(|(facet, _)| facet.ground == Ground::Walk)
            && !is_swept(site.map, [x, y, spot.point.z].into(), 0.1)
    });
    good.then_some((takes, rack))
}

fn put(site: &Site<'_>, takes: &OrientedRect, rack: &Rack, drafts: &mut Vec<Draft>) {
    let [ax, ay] = takes.axis;
    for hoop in &rack.hoops {
        let [x, y] = hoop.xy_m;
        let z = site.levels().height(x, y, rack.near_z_m);
        drafts.push(Draft::new(ActorKind::Prop, "prop.rack", Tag::Static, HOOP_M, [x, y, z], rack.yaw_rad));
        let Some((model, colour, turned)) = hoop.bicycle else { continue };
        // Its wheels are along the street, and the street may climb.
        let half = 0.5 * model.wheelbase_m;
        let height = |u: f64| site.levels().height(x + u * ax, y + u * ay, rack.near_z_m);
        let pitch = -atan2(height(half) - height(-half), 2.0 * half);
        let (yaw, pitch) =
            if turned { (rack.yaw_rad + std::f64::consts::PI, -pitch) } else { (rack.yaw_rad, pitch) };
        let aside = BESIDE_HOOP_M + 0.5 * HOOP_M[1];
        let xyz = [x - aside * ay, y + aside * ax, z];
        let tag = Tag::Bicycle;
        let mut draft = Draft::new(ActorKind::Parked, model.name, tag, model.size_m, xyz, yaw);
        draft.rpy_rad = [0.0, pitch, yaw];
        draft.color = colour;
        drafts.push(draft);
    }
}
