//! Trees, bushes and rocks.

use frames::OrientedRect;
use random::Stream;
use schema::{ActorKind, Tag};

use crate::scenery::claims::{Candidate, rank, settle};
use crate::scenery::draft::Draft;
use crate::scenery::draw::draw;
use crate::scenery::frontage::{Frontage, Spot};
use crate::scenery::kinds::TREES;
use crate::scenery::land::Land;
use crate::scenery::site::{Site, reach_m};

/// How deep a trunk stands in the ground, metres.
const ROOT_M: f64 = 0.05;

/// Something that grows or lies somewhere.
struct Plant {
    kind: ActorKind,
    model: &'static str,
    tag: Tag,
    size_m: [f64; 3],
    near_z_m: f64,
    yaw_rad: f64,
    variant: u32,
}

/// A plant and its place.
struct Planted {
    x_m: f64,
    y_m: f64,
    plant: Plant,
}

/// Trees along the streets and in the yards behind, and bushes where there is no sidewalk. What is drawn does
/// not depend on what stands.
pub(crate) fn trees(site: &Site<'_>, fronts: &[Frontage], land: &mut Land<'_>, drafts: &mut Vec<Draft>) {
    let (mut trees, mut bushes) = (Vec::new(), Vec::new());
    let density = site.rules.tree_density;
    for front in fronts {
        let mut random = Stream::new(site.rules.seed, 0, "world/trees", front.entity);
        let random = &mut random;
        // One species lines a street.
        let street_tree = draw(random, &[0.35, 0.25, 0.12, 0.08, 0.20]);
        let mut along = random.uniform(2.0, 8.0);
        let mut slot = 0;
        let mut plant_tree = |spot: &Spot, [far, grown]: [f64; 2], kind, slot, random: &mut Stream| {
            let tree = tree(spot, far, kind, grown, random);
            trees.extend(tree_candidate(site, land, tree, (front.entity, slot)));
        };
        while let Some(spot) = front.at(along).filter(|_| along < front.length_m() - 2.0) {
            slot += 4;
            if spot.walk_m > 0.0 {
                if random.chance(density) {
                    plant_tree(&spot, [0.9, 0.25], street_tree, slot, random);
                }
                // Yards behind the buildings have trees of their own.
                if random.chance(0.5 * density) {
                    let far = random.uniform(7.0, 34.0);
                    let kind = draw(random, &[0.45, 0.30, 0.08, 0.17, 0.0]);
                    plant_tree(&spot, [far, 0.5], kind, slot + 1, random);
                }
                along += random.uniform(8.0, 13.0);
            } else {
                for k in 0..2 {
                    if random.chance(density) {
                        let far = random.uniform(4.5, 34.0);
                        let kind = draw(random, &[0.34, 0.20, 0.10, 0.36, 0.0]);
                        plant_tree(&spot, [far, 0.6], kind, slot + k, random);
                    }
                }
                if random.chance(0.35 * density) {
                    bushes.push((bush(&spot, random), (front.entity, slot + 2)));
                }
                along += random.uniform(6.0, 12.0);
            }
        }
    }
    plant(site, settle(trees, land), drafts);
    let bushes = bushes.into_iter().filter_map(|(bush, who)| bush_candidate(site, land, bush, who)).collect();
    plant(site, settle(bushes, land), drafts);
}

fn plant(site: &Site<'_>, kept: Vec<Candidate<Plant>>, drafts: &mut Vec<Draft>) {
    for Candidate { takes, what: plant, .. } in kept {
        let [x, y] = takes.centre_m;
        if site.holds(x, y) {
            let xyz = [x, y, site.levels().height(x, y, plant.near_z_m) - ROOT_M];
            let mut draft = Draft::new(plant.kind, plant.model, plant.tag, plant.size_m, xyz, plant.yaw_rad);
            draft.variant = plant.variant;
            drafts.push(draft);
        }
    }
}

/// A tree of some kind beyond the edge of a street, of which a part of the height is common to its place.
fn tree(spot: &Spot, far_m: f64, kind: usize, grown: f64, random: &mut Stream) -> Planted {
    let (model, low, high, crown) = TREES[kind];
    // Quarter metres, few variants: many trees share a mesh.
    let height = (4.0 * (low + (high - low) * (grown * random.unit() + 0.5 * (1.0 - grown) * random.unit())))
        .round()
        / 4.0;
    let variant = random.next_u32() % 6;
    let yaw_rad = random.uniform(-3.0, 3.0);
    let at = spot.beside(far_m, 0.0);
    let width = (4.0 * crown * height).round() / 4.0;
    let (kind, tag, size_m) = (ActorKind::Vegetation, Tag::Vegetation, [width, width, height]);
    let plant = Plant { kind, model, tag, size_m, near_z_m: spot.point.z, yaw_rad, variant };
    Planted { x_m: at.x, y_m: at.y, plant }
}

fn tree_candidate(
    site: &Site<'_>,
    land: &Land<'_>,
    Planted { x_m, y_m, plant }: Planted,
    (entity, slot): (u64, u64),
) -> Option<Candidate<Plant>> {
    let square = |half_m: f64| OrientedRect::square([x_m, y_m], half_m);
    let width = plant.size_m[0];
    // The crown may reach over the sidewalk, not into a wall or over rails; the trunk stands on land.
    let (trunk, room) = (square(0.45), square((0.3 * width).min(1.2)));
    let grows = site.near(x_m, y_m, reach_m::TREES)
        && land.unused(&room)
        && land.free(&trunk)
        && land.off_tracks(&square(0.5 * width));
    let rank = || rank(site.rules.seed, "world/trees/rank", entity, slot);
    grows.then(|| Candidate { takes: trunk, needs: room, rank: rank(), what: plant })
}

/// A bush, or a rock in its place.
fn bush(spot: &Spot, random: &mut Stream) -> Planted {
    let width = (4.0 * random.uniform(0.8, 2.2)).round() / 4.0;
    let at = spot.beside(random.uniform(2.5, 9.0), random.uniform(-2.0, 2.0));
    let stone = random.chance(0.15);
    let variant = random.next_u32() % 6;
    let (kind, model, tag) = if stone {
        (ActorKind::Prop, "prop.rock", Tag::Rock)
    } else {
        (ActorKind::Vegetation, "bush.round", Tag::Vegetation)
    };
    let size_m = [width, width, 0.7 * width];
    let plant = Plant { kind, model, tag, size_m, near_z_m: spot.point.z, yaw_rad: 0.0, variant };
    Planted { x_m: at.x, y_m: at.y, plant }
}

fn bush_candidate(
    site: &Site<'_>,
    land: &Land<'_>,
    Planted { x_m, y_m, plant }: Planted,
    (entity, slot): (u64, u64),
) -> Option<Candidate<Plant>> {
    let rect = OrientedRect::square([x_m, y_m], 0.5 * plant.size_m[0]);
    let rank = || rank(site.rules.seed, "world/trees/rank", entity, slot);
    (site.near(x_m, y_m, reach_m::BUSHES) && land.free(&rect)).then(|| Candidate {
        takes: rect,
        needs: rect,
        rank: rank(),
        what: plant,
    })
}
