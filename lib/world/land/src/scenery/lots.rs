//! Buildings.

use frames::OrientedRect;
use random::Stream;
use schema::{ActorKind, Tag};

use crate::scenery::claims::{Candidate, rank, settle};
use crate::scenery::draft::Draft;
use crate::scenery::draw::draw;
use crate::scenery::frontage::Frontage;
use crate::scenery::islands::Islands;
use crate::scenery::kinds::{BUILDINGS, BuildingKind};
use crate::scenery::land::Land;
use crate::scenery::site::{Site, reach_m};

/// Height of a storey, metres.
const STOREY_M: f64 = 3.0;
/// Most that the ground may differ under a building, metres.
const LEVEL_M: f64 = 3.5;
/// Buildings stand this much farther from water than other things, metres.
const SHORE_M: f64 = 4.0;
/// Above this limit a road is a highway: few buildings stand at it, m/s.
pub(crate) const HIGHWAY_MPS: f64 = 19.0;

/// Shares of the kinds of buildings, in the order of the catalogue: in a street with sidewalks, and without.
const TOWN: [f64; 5] = [0.42, 0.16, 0.14, 0.22, 0.06];
const COUNTRY: [f64; 5] = [0.04, 0.0, 0.70, 0.08, 0.18];
/// What a building keeps free around it, metres.
pub(crate) const AROUND_M: f64 = 0.6;
/// Sizes and places that are tried on a lot, until one fits: shares of width and depth, and of the width that
/// is left over to either side.
const TRIES: [[f64; 3]; 7] = [
    [1.0, 1.0, 0.0],
    [0.8, 0.75, 0.0],
    [0.8, 0.75, -1.0],
    [0.8, 0.75, 1.0],
    [0.62, 0.62, 0.0],
    [0.62, 0.62, -1.0],
    [0.62, 0.62, 1.0],
];

/// A building as it was drawn for a place on a frontage.
pub(crate) struct House<'a> {
    pub(crate) front: &'a Frontage,
    /// Where its middle is along the frontage, metres.
    pub(crate) along_m: f64,
    pub(crate) near_z_m: f64,
    pub(crate) kind: &'static BuildingKind,
    floors: f64,
    /// From the edge of the street to the building, metres.
    pub(crate) setback_m: f64,
    /// Its width along the street, metres.
    width_m: f64,
    pub(crate) variant: u32,
    /// Decides what is in front of it.
    pub(crate) fence: f64,
    /// Whether its street has sidewalks.
    pub(crate) is_in_town: bool,
}

impl House<'_> {
    /// How far its door is from the middle of its front, to the left of who looks out of it, metres: that of
    /// towers is aside (their meshes say so).
    pub(crate) fn door_m(&self) -> f64 {
        if self.kind.model == "building.tower" { 0.125 * self.width_m } else { 0.0 }
    }
}

/// The buildings that stand in the area, or near enough to have a fence there.
///
/// The lots of a frontage follow one another as they are drawn, whether one is built up or not.
pub(crate) fn buildings<'a>(
    site: &Site<'_>,
    fronts: &'a [Frontage],
    islands: &Islands,
    land: &mut Land<'_>,
    drafts: &mut Vec<Draft>,
) -> Vec<Candidate<House<'a>>> {
    let mut candidates = Vec::new();
    for front in fronts.iter().filter(|f| !f.track) {
        let mut random = Stream::new(site.rules.seed, 0, "world/buildings", front.entity);
        let mut along = 2.0;
        for slot in 0.. {
            let Some(start) = front.at(along).filter(|_| along < front.length_m() - 4.0) else { break };
            let town = start.walk_m > 0.0;
            let density =
                site.rules.building_density * if front.speed_mps > HIGHWAY_MPS && !town { 0.12 } else { 1.0 };
            let kind = &BUILDINGS[draw(&mut random, if town { &TOWN } else { &COUNTRY })];
            let BuildingKind { width_m, depth_m, storeys, .. } = kind;
            let width = random.uniform(width_m[0], width_m[1]);
            let depth = random.uniform(depth_m[0], depth_m[1]);
            let floors = random.int_inclusive(storeys[0], storeys[1]) as f64;
            let setback_m = if town { random.uniform(2.6, 5.5) } else { random.uniform(6.0, 16.0) };
            let variant = random.next_u32() % 30;
            let wanted = random.chance(density);
            let fence = random.unit();
            let gap = random.uniform(1.2, if town { 5.0 } else { 22.0 });
            let from = along;
            along += if wanted { width + gap } else { 0.6 * width };
            let Some(middle) = front.at(from + 0.5 * width).filter(|_| wanted) else { continue };
            if !site.near(middle.point.x, middle.point.y, reach_m::BUILDINGS + 34.0) {
                continue;
            }
            let Some((rect, along_m)) = lot(site, front, from, setback_m, [depth, width], islands, land)
            else {
                continue;
            };
            let near_z_m = middle.point.z;
            let rank = rank(site.rules.seed, "world/buildings/rank", front.entity, slot);
            let (width_m, is_in_town) = (2.0 * rect.half_m[1], town);
            let what = House {
                front,
                along_m,
                near_z_m,
                kind,
                floors,
                setback_m,
                width_m,
                variant,
                fence,
                is_in_town,
            };
            let rect = rect.grown(AROUND_M);
            candidates.push(Candidate { takes: rect, needs: rect, rank, what });
        }
    }
    let mut kept = Vec::new();
    for house in settle(candidates, land) {
        let [x, y] = house.takes.centre_m;
        if site.near(x, y, reach_m::BUILT)
            && let Some(draft) = on_the_ground(site, &house.takes.grown(-AROUND_M), &house.what)
        {
            drafts.extend(site.holds(x, y).then_some(draft));
            kept.push(house);
        }
    }
    kept
}

/// The ground of a building of some depth and width, metres, and where its middle is along the frontage: a
/// lot that is too large is tried smaller before it is given up.
fn lot(
    site: &Site<'_>,
    front: &Frontage,
    from_m: f64,
    setback_m: f64,
    [depth, width]: [f64; 2],
    islands: &Islands,
    land: &Land<'_>,
) -> Option<(OrientedRect, f64)> {
    TRIES.into_iter().find_map(|[w, d, aside]| {
        let size = [depth * d, width * w];
        let along_m = from_m + 0.5 * (width + aside * (width - size[1]));
        let spot = front.at(along_m)?;
        let centre = spot.beside(setback_m + 0.5 * size[0], 0.0);
        let rect = OrientedRect {
            centre_m: [centre.x, centre.y],
            axis: [-spot.away.x, -spot.away.y],
            half_m: size.map(|v| 0.5 * v),
        };
        let fits = site.near(centre.x, centre.y, reach_m::BUILDINGS)
            && !islands.holds(centre.x, centre.y)
            && land.free(&rect.grown(AROUND_M))
            && land.is_dry(&rect.grown(SHORE_M));
        fits.then_some((rect, along_m))
    })
}

/// The building as it stands on the land; none where that is too steep.
fn on_the_ground(site: &Site<'_>, rect: &OrientedRect, house: &House<'_>) -> Option<Draft> {
    let heights = [(0.0, 0.0), (1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)].map(|(u, v)| {
        let [x, y] = rect.at(u, v);
        site.levels().height(x, y, house.near_z_m)
    });
    let low = heights.into_iter().fold(f64::INFINITY, f64::min);
    let high = heights.into_iter().fold(f64::NEG_INFINITY, f64::max);
    if high - low > LEVEL_M || (low - house.near_z_m).abs() > 8.0 {
        return None;
    }
    let floors = house.floors;
    let height = match house.kind.model {
        "building.house" => floors * 2.8 / 0.64,
        "building.hall" => floors * 3.6,
        _ => floors * STOREY_M + 2.0,
    } + (high - low);
    let xyz = [rect.centre_m[0], rect.centre_m[1], low - 0.1];
    let size = [2.0 * rect.half_m[0], 2.0 * rect.half_m[1], height];
    // It stands as its lot lies, whose middle may be farther along a bend than where it was drawn.
    let yaw_rad = frames::math::atan2(rect.axis[1], rect.axis[0]);
    let mut draft = Draft::new(ActorKind::Building, house.kind.model, Tag::Building, size, xyz, yaw_rad);
    draft.variant = house.variant;
    Some(draft)
}
