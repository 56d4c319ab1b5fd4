//! Buildings, the fences and walls before them, and trees.

use frames::OrientedRect;
use random::Stream;
use schema::{ActorKind, Tag};

use crate::catalogue::{BUILDINGS, BuildingKind, TREES};
use crate::draft::Draft;
use crate::frontage::{Frontage, Spot};
use crate::islands::Islands;
use crate::land::Land;
use crate::site::Site;

/// Height of a storey, metres.
const STOREY_M: f64 = 3.0;
/// Most that the ground may differ under a building, metres.
const LEVEL_M: f64 = 3.5;
/// Buildings stand this much farther from water than other things, metres.
const SHORE_M: f64 = 4.0;
/// Above this limit a road is a highway: few buildings stand at it, m/s.
const HIGHWAY_MPS: f64 = 19.0;

/// Shares of the kinds of buildings, in the order of the catalogue: in a street with sidewalks, and without.
const TOWN: [f64; 5] = [0.42, 0.16, 0.14, 0.22, 0.06];
const COUNTRY: [f64; 5] = [0.04, 0.0, 0.70, 0.08, 0.18];

pub(crate) fn buildings(
    site: &Site<'_>,
    fronts: &[Frontage],
    islands: &Islands,
    land: &mut Land<'_>,
    drafts: &mut Vec<Draft>,
) {
    for front in fronts.iter().filter(|f| !f.track) {
        let mut random = Stream::new(site.seed, 0, "world/buildings", front.entity);
        let mut along = 2.0;
        while along < front.length_m() - 4.0 {
            let Some(start) = front.at(along) else { break };
            let town = start.walk_m > 0.0;
            let density = site.settings.building_density
                * if front.speed_mps > HIGHWAY_MPS && !town { 0.12 } else { 1.0 };
            let kind = draw(&mut random, if town { &TOWN } else { &COUNTRY });
            let BuildingKind { model, width_m, depth_m, storeys } = BUILDINGS[kind];
            let width = random.uniform(width_m[0], width_m[1]);
            let depth = random.uniform(depth_m[0], depth_m[1]);
            let floors = random.int_inclusive(storeys[0], storeys[1]) as f64;
            let setback = if town { random.uniform(2.6, 5.5) } else { random.uniform(6.0, 16.0) };
            let variant = random.next_u32() % 30;
            let wanted = random.chance(density);
            let fence = random.unit();
            let Some(spot) = front.at(along + 0.5 * width) else { break };
            if !wanted || !site.near(spot.point.x, spot.point.y) {
                along += if wanted { width } else { 0.6 * width };
                continue;
            }
            let Some((rect, size)) = lot(&spot, setback, [depth, width], islands, land) else {
                along += 5.0;
                continue;
            };
            let heights = [(0.0, 0.0), (1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)].map(|(u, v)| {
                let [x, y] = rect.at(u, v);
                site.ground.height(x, y, spot.point.z)
            });
            let low = heights.into_iter().fold(f64::INFINITY, f64::min);
            let high = heights.into_iter().fold(f64::NEG_INFINITY, f64::max);
            if high - low > LEVEL_M || (low - spot.point.z).abs() > 8.0 {
                along += 5.0;
                continue;
            }
            let height = match model {
                "building.house" => floors * 2.8 / 0.64,
                "building.hall" => floors * 3.6,
                _ => floors * STOREY_M + 2.0,
            } + (high - low);
            let xyz = [rect.centre_m[0], rect.centre_m[1], low - 0.1];
            let mut draft = Draft::new(
                ActorKind::Building,
                model,
                Tag::Building,
                [size[0], size[1], height],
                xyz,
                spot.facing_yaw(),
            );
            draft.variant = variant;
            drafts.push(draft);
            land.take(rect.grown(0.6));
            if setback > 3.6 && fence < 0.55 {
                enclose(site, front, along, size[1], fence, variant, land, drafts);
            }
            along += size[1] + random.uniform(1.2, if town { 5.0 } else { 22.0 });
        }
    }
}

/// The ground of a building of some depth and width, metres, and how large it is in the end: a lot that is too large is tried
/// smaller before it is given up.
fn lot(
    spot: &Spot,
    setback_m: f64,
    [depth, width]: [f64; 2],
    islands: &Islands,
    land: &Land<'_>,
) -> Option<(OrientedRect, [f64; 2])> {
    [(1.0, 1.0), (0.8, 0.75), (0.62, 0.62)].into_iter().find_map(|(w, d)| {
        let size = [depth * d, width * w];
        let centre = spot.beside(setback_m + 0.5 * size[0], 0.0);
        let rect = OrientedRect {
            centre_m: [centre.x, centre.y],
            axis: [-spot.away.x, -spot.away.y],
            half_m: size.map(|v| 0.5 * v),
        };
        let fits = land.free(&rect.grown(0.6))
            && land.is_dry(&rect.grown(SHORE_M))
            && !islands.holds(centre.x, centre.y);
        fits.then_some((rect, size))
    })
}

/// An index drawn with the given shares.
fn draw(random: &mut Stream, shares: &[f64]) -> usize {
    let mut rest = random.unit();
    for (i, share) in shares.iter().enumerate() {
        rest -= share;
        if rest < 0.0 {
            return i;
        }
    }
    shares.len() - 1
}

/// A fence, wall or hedge along the front of a lot, in pieces that follow the edge.
#[allow(clippy::too_many_arguments)] // One lot's facts, used once.
fn enclose(
    site: &Site<'_>,
    front: &Frontage,
    from_m: f64,
    length_m: f64,
    pick: f64,
    variant: u32,
    land: &mut Land<'_>,
    drafts: &mut Vec<Draft>,
) {
    let (model, kind, tag, width, height) = if pick < 0.22 {
        ("prop.fence", ActorKind::Prop, Tag::Fence, 0.10, 1.1)
    } else if pick < 0.38 {
        ("prop.wall", ActorKind::Prop, Tag::Wall, 0.30, 1.4)
    } else {
        ("bush.hedge", ActorKind::Vegetation, Tag::Vegetation, 0.80, 1.2)
    };
    let pieces = (length_m / 6.0).ceil().max(1.0) as usize;
    let piece = length_m / pieces as f64;
    for i in 0..pieces {
        // The way in stays open.
        if pieces > 2 && i == pieces / 2 {
            continue;
        }
        let Some(spot) = front.at(from_m + (i as f64 + 0.5) * piece) else { continue };
        let at = spot.beside(0.9, 0.0);
        let rect = OrientedRect {
            centre_m: [at.x, at.y],
            axis: [-spot.away.y, spot.away.x],
            half_m: [0.5 * piece, 0.5 * width],
        };
        if land.free(&rect.grown(0.05)) {
            let z = [-1.0, 0.0, 1.0].map(|u| {
                let [x, y] = rect.at(u, 0.0);
                site.ground.height(x, y, spot.point.z)
            });
            let low = z.into_iter().fold(f64::INFINITY, f64::min);
            let yaw = frames::math::atan2(spot.away.x, -spot.away.y);
            let mut draft = Draft::new(kind, model, tag, [piece, width, height], [at.x, at.y, low], yaw);
            draft.variant = variant;
            drafts.push(draft);
            land.take(rect);
        }
    }
}

pub(crate) fn trees(site: &Site<'_>, fronts: &[Frontage], land: &mut Land<'_>, drafts: &mut Vec<Draft>) {
    for front in fronts {
        let mut random = Stream::new(site.seed, 0, "world/trees", front.entity);
        // One species lines a street.
        let street_tree = draw(&mut random, &[0.35, 0.25, 0.12, 0.08, 0.20]);
        let mut along = random.uniform(2.0, 8.0);
        while along < front.length_m() - 2.0 {
            let Some(spot) = front.at(along) else { break };
            if spot.walk_m > 0.0 {
                if random.chance(site.settings.tree_density) {
                    tree(site, &spot, 0.9, street_tree, 0.25, &mut random, land, drafts);
                }
                // Yards behind the buildings have trees of their own.
                if random.chance(0.5 * site.settings.tree_density) {
                    let (far, kind) =
                        (random.uniform(7.0, 34.0), draw(&mut random, &[0.45, 0.30, 0.08, 0.17, 0.0]));
                    tree(site, &spot, far, kind, 0.5, &mut random, land, drafts);
                }
                along += random.uniform(8.0, 13.0);
            } else {
                for _ in 0..2 {
                    if random.chance(site.settings.tree_density) {
                        let far = random.uniform(4.5, 34.0);
                        let kind = draw(&mut random, &[0.34, 0.20, 0.10, 0.36, 0.0]);
                        tree(site, &spot, far, kind, 0.6, &mut random, land, drafts);
                    }
                }
                if random.chance(0.35 * site.settings.tree_density) {
                    bush(site, &spot, &mut random, land, drafts);
                }
                along += random.uniform(6.0, 12.0);
            }
        }
    }
}

#[allow(clippy::too_many_arguments)] // One tree's facts.
fn tree(
    site: &Site<'_>,
    spot: &Spot,
    far_m: f64,
    kind: usize,
    grown: f64,
    random: &mut Stream,
    land: &mut Land<'_>,
    drafts: &mut Vec<Draft>,
) {
    let (model, low, high, crown) = TREES[kind];
    // Quarter metres, few variants: many trees share a mesh.
    let height = (4.0 * (low + (high - low) * (grown * random.unit() + 0.5 * (1.0 - grown) * random.unit())))
        .round()
        / 4.0;
    let variant = random.next_u32() % 6;
    let yaw = random.uniform(-3.0, 3.0);
    let at = spot.beside(far_m, 0.0);
    let width = (4.0 * crown * height).round() / 4.0;
    // The crown may reach over the sidewalk, not into a wall or over rails; the trunk stands on land.
    let trunk = OrientedRect::square([at.x, at.y], 0.45);
    let room = OrientedRect::square([at.x, at.y], (0.3 * width).min(1.2));
    let crown = OrientedRect::square([at.x, at.y], 0.5 * width);
    if site.near(at.x, at.y) && land.free(&trunk) && land.unused(&room) && land.off_tracks(&crown) {
        let z = site.ground.height(at.x, at.y, spot.point.z) - 0.05;
        let mut draft = Draft::new(
            ActorKind::Vegetation,
            model,
            Tag::Vegetation,
            [width, width, height],
            [at.x, at.y, z],
            yaw,
        );
        draft.variant = variant;
        drafts.push(draft);
        land.take(trunk);
    }
}

fn bush(site: &Site<'_>, spot: &Spot, random: &mut Stream, land: &mut Land<'_>, drafts: &mut Vec<Draft>) {
    let width = (4.0 * random.uniform(0.8, 2.2)).round() / 4.0;
    let at = spot.beside(random.uniform(2.5, 9.0), random.uniform(-2.0, 2.0));
    let stone = random.chance(0.15);
    let variant = random.next_u32() % 6;
    let rect = OrientedRect::square([at.x, at.y], 0.5 * width);
    if site.near(at.x, at.y) && land.free(&rect) {
        let z = site.ground.height(at.x, at.y, spot.point.z) - 0.05;
        let (kind, model, tag) = if stone {
            (ActorKind::Prop, "prop.rock", Tag::Rock)
        } else {
            (ActorKind::Vegetation, "bush.round", Tag::Vegetation)
        };
        let mut draft = Draft::new(kind, model, tag, [width, width, 0.7 * width], [at.x, at.y, z], 0.0);
        draft.variant = variant;
        drafts.push(draft);
        land.take(rect);
    }
}
