//! Trees, bushes and rocks.

use frames::OrientedRect;
use nalgebra::Point3;
use random::Stream;
use schema::{ActorKind, Tag};
use settings::Season;

use crate::scenery::claims::{Candidate, rank, settle};
use crate::scenery::draft::Draft;
use crate::scenery::draw::draw;
use crate::scenery::forecourts::Forecourts;
use crate::scenery::frontage::{Frontage, Spot};
use crate::scenery::kinds::{TREES, TreeKind};
use crate::scenery::land::Land;
use crate::scenery::site::{Site, reach_m};
use crate::scenery::swept::is_swept;
use crate::scenery::uses::{PLOT_M, Use, Uses};
use crate::surfaces::Ground;

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
    /// What it stands in, for trees at kerbs, and how that is turned, radians from east.
    pit: Option<(Pit, f64)>,
}

/// Open ground round a stem in a sidewalk: its model, side and height, metres.
#[derive(Clone, Copy)]
struct Pit {
    model: &'static str,
    side_m: f64,
    height_m: f64,
}

/// Young trees are held by stakes where these leave room enough to walk by; others stand in soil or in a
/// grate.
const STAKED: Pit = Pit { model: "prop.tree_stakes", side_m: 0.75, height_m: 1.8 };
const SOIL: Pit = Pit { model: "prop.tree_pit", side_m: 1.0, height_m: 0.04 };
const GRATE: Pit = Pit { model: "prop.tree_grate", side_m: 1.0, height_m: 0.03 };
/// Sidewalks from this width on have that room, metres.
const STAKES_WALK_M: f64 = 2.45;

/// A plant and its place.
struct Planted {
    x_m: f64,
    y_m: f64,
    plant: Plant,
}

/// Shares of the kinds of trees: in rows along streets, in yards, on open land, and in a town that is warm.
/// In the order of [`TREES`].
const STREET: [f64; 15] =
    [0.22, 0.17, 0.13, 0.09, 0.09, 0.05, 0.05, 0.03, 0.07, 0.08, 0.0, 0.0, 0.0, 0.02, 0.0];
const YARD: [f64; 15] =
    [0.08, 0.10, 0.03, 0.05, 0.05, 0.06, 0.05, 0.15, 0.04, 0.14, 0.02, 0.03, 0.12, 0.08, 0.0];
const OPEN: [f64; 15] =
    [0.06, 0.08, 0.02, 0.02, 0.05, 0.18, 0.10, 0.15, 0.03, 0.02, 0.06, 0.05, 0.10, 0.08, 0.0];
const WARM: [f64; 15] = [0.0, 0.0, 0.18, 0.0, 0.16, 0.0, 0.0, 0.0, 0.0, 0.08, 0.0, 0.0, 0.0, 0.18, 0.40];
/// Share of towns that are warm.
const WARM_TOWNS: f64 = 0.15;
/// Shares of young, grown and old trees.
const AGES: [f64; 3] = [0.25, 0.60, 0.15];
/// Sidewalks of this width have trees at the kerb, metres; the middles of their stems stand so far behind it.
const WIDE_WALK_M: f64 = 2.3;
const BEHIND_KERB_M: f64 = 0.55;
/// A stem in a sidewalk with the ground around it that nothing else takes, metres.
const PIT_M: f64 = 0.4;
/// Ground that a stem takes elsewhere, and half the ground that keeps free of other stems at most, metres.
const STEM_M: f64 = 0.45;
const APART_M: f64 = 2.0;
/// Trees of woods and orchards keep this far from streets, metres.
const EDGE_M: f64 = 2.5;
/// Fruit trees, by their place in [`TREES`].
const CHERRY: usize = 9;
/// Tells trees of woods from those along streets.
const WOODS: u64 = 1 << 63;
/// Crowns keep this far from walls, as a share of their radius: they do not reach as far everywhere.
const CLEAR_OF_WALLS: f64 = 0.92;

/// A tree before it is known how large it can be.
struct Wish {
    kind: &'static TreeKind,
    age: usize,
    variant: u32,
    yaw_rad: f64,
    /// Beyond the edge of the street, metres; `None` at the kerb.
    far_m: Option<f64>,
}

impl Wish {
    fn new(shares: &[f64; 15], far_m: Option<f64>, random: &mut Stream) -> Self {
        let kind = &TREES[draw(random, shares)];
        Self::of(kind, far_m, random)
    }

    fn of(kind: &'static TreeKind, far_m: Option<f64>, random: &mut Stream) -> Self {
        let age = draw(random, &AGES);
        let variant = random.next_u32() % TreeKind::VARIANTS;
        Self { kind, age, variant, yaw_rad: random.uniform(-3.0, 3.0), far_m }
    }
}

/// Trees at the kerbs of streets and in the yards behind, and bushes where there is no sidewalk. What is
/// drawn does not depend on what stands. Crowns keep off `built`, the land with its buildings alone.
pub(crate) fn trees(
    site: &Site<'_>,
    (fronts, uses, paved): (&[Frontage], &Uses, &Forecourts),
    built: &Land<'_>,
    land: &mut Land<'_>,
    drafts: &mut Vec<Draft>,
) {
    let (mut trees, mut bushes) = (Vec::new(), Vec::new());
    let density = site.rules.tree_density;
    let is_warm = is_warm(site);
    let of = |shares| if is_warm { &WARM } else { shares };
    for front in fronts {
        let mut random = Stream::new(site.rules.seed, 0, "world/trees", front.entity);
        let random = &mut random;
        // One species lines a street.
        let street_tree = &TREES[draw(random, of(&STREET))];
        let mut along = random.uniform(2.0, 8.0);
        let mut slot = 0;
        while let Some(spot) = front.at(along).filter(|_| along < front.length_m() - 2.0) {
            slot += 6;
            let mut wishes = Vec::new();
            if spot.walk_m > 0.0 {
                if random.chance(density.min(1.0)) {
                    let at_kerb = spot.walk_m >= WIDE_WALK_M;
                    wishes.push(Wish::of(street_tree, (!at_kerb).then_some(0.9), random));
                }
                // Yards behind the buildings have trees of their own.
                for _ in 0..2 {
                    if random.chance(0.6 * density) {
                        let far_m = random.uniform(5.0, 34.0);
                        wishes.push(Wish::new(of(&YARD), Some(far_m), random));
                    }
                }
                along += random.uniform(8.0, 12.0);
            } else {
                for _ in 0..4 {
                    if random.chance(density) {
                        let far_m = random.uniform(4.5, 34.0);
                        wishes.push(Wish::new(of(&OPEN), Some(far_m), random));
                    }
                }
                if random.chance(0.6 * density) {
                    bushes.push((bush(&spot, random), (front.entity, slot + 5)));
                }
                along += random.uniform(6.0, 12.0);
            }
            for (k, wish) in (0u64..).zip(wishes) {
                trees.extend(beside_street(
                    site,
                    [built, land],
                    uses,
                    &spot,
                    &wish,
                    (front.entity, slot + k),
                ));
            }
        }
    }
    trees.extend(woods(site, uses, [built, land], of(&OPEN)));
    plant(site, paved, settle(trees, land), drafts);
    let bushes = bushes.into_iter().filter(|(bush, _)| !is_tilled(site, uses, bush.x_m, bush.y_m));
    let bushes = bushes.filter_map(|(bush, who)| bush_candidate(site, land, bush, who)).collect();
    plant(site, paved, settle(bushes, land), drafts);
}

/// Whether palms grow in a town.
fn is_warm(site: &Site<'_>) -> bool {
    let roads = site.map.network().roads.len() as u64;
    Stream::new(site.rules.seed, 0, "world/trees/climate", roads).chance(WARM_TOWNS)
}

fn plant(site: &Site<'_>, paved: &Forecourts, kept: Vec<Candidate<Plant>>, drafts: &mut Vec<Draft>) {
    for Candidate { takes, what: plant, .. } in kept {
        let [x, y] = takes.centre_m;
        if site.holds(x, y) {
            let land_m = paved.height(x, y).unwrap_or_else(|| site.levels().height(x, y, plant.near_z_m));
            let xyz = [x, y, land_m - ROOT_M];
            let mut draft = Draft::new(plant.kind, plant.model, plant.tag, plant.size_m, xyz, plant.yaw_rad);
            draft.variant = plant.variant;
            drafts.push(draft);
            if let Some((Pit { model, side_m, height_m }, yaw_rad)) = plant.pit {
                let (size_m, xyz) = ([side_m, side_m, height_m], [x, y, land_m]);
                drafts.push(Draft::new(ActorKind::Prop, model, Tag::Static, size_m, xyz, yaw_rad));
            }
        }
    }
}

/// Whether something grows at a place in rows, which nothing else is put between.
fn is_tilled(site: &Site<'_>, uses: &Uses, x: f64, y: f64) -> bool {
    site.rules.density > 0.0 && uses.at(x, y).is_some_and(Use::is_tilled)
}

/// A tree at a street, on the land beside it or at its kerb.
fn beside_street(
    site: &Site<'_>,
    [built, land]: [&Land<'_>; 2],
    uses: &Uses,
    spot: &Spot,
    wish: &Wish,
    who: (u64, u64),
) -> Option<Candidate<Plant>> {
    let at = spot.beside(wish.far_m.unwrap_or(BEHIND_KERB_M - spot.walk_m), 0.0);
    if !site.near(at.x, at.y, reach_m::TREES) || is_tilled(site, uses, at.x, at.y) {
        return None;
    }
    let at_kerb = wish.far_m.is_none();
    let stem = OrientedRect::square([at.x, at.y], if at_kerb { PIT_M } else { STEM_M });
    let stands = if at_kerb { stands_at_kerb(site, spot, at, &stem, land) } else { land.free(&stem) };
    tree_candidate(site, [built, land], at, (&stem, at_kerb.then_some(spot)), wish, who).filter(|_| stands)
}

/// A tree as old as there is room for its crown, where its stem may stand: at a kerb, or anywhere.
fn tree_candidate(
    site: &Site<'_>,
    [built, land]: [&Land<'_>; 2],
    at: Point3<f64>,
    (stem, kerb): (&OrientedRect, Option<&Spot>),
    wish: &Wish,
    (entity, slot): (u64, u64),
) -> Option<Candidate<Plant>> {
    let square = |half_m: f64| OrientedRect::square([at.x, at.y], half_m);
    // The crown may reach over the street, not into a wall or over rails.
    let fits = |age: usize| {
        let [width, ..] = wish.kind.size_m(age, wish.variant);
        let crown = square(0.5 * CLEAR_OF_WALLS * width);
        built.unused(&crown) && land.off_tracks(&square(0.5 * width))
    };
    let age = (0..=wish.age).rev().find(|age| fits(*age))?;
    let size_m = wish.kind.size_m(age, wish.variant);
    let room = square(if kerb.is_some() { PIT_M } else { (0.22 * size_m[0]).clamp(0.5, APART_M) });
    let plant = Plant {
        kind: ActorKind::Vegetation,
        model: if site.rules.season == Season::Winter { wish.kind.bare } else { wish.kind.model },
        tag: Tag::Vegetation,
        size_m,
        near_z_m: at.z,
        yaw_rad: wish.yaw_rad,
        variant: wish.variant,
        pit: kerb.filter(|_| site.rules.density > 0.0).map(|spot| {
            let pit = match (age, entity % 3) {
                (0, _) if spot.walk_m >= STAKES_WALK_M => STAKED,
                // All along a street alike.
                (_, 0) => GRATE,
                _ => SOIL,
            };
            (pit, spot.facing_yaw())
        }),
    };
    let rank = rank(site.rules.seed, "world/trees/rank", entity, slot);
    land.unused(&room).then_some(Candidate { takes: *stem, needs: room, rank, what: plant })
}

/// Trees of woods, a few metres apart, and of orchards, in rows.
fn woods(
    site: &Site<'_>,
    uses: &Uses,
    [built, land]: [&Land<'_>; 2],
    shares: &[f64; 15],
) -> Vec<Candidate<Plant>> {
    let mut found = Vec::new();
    let area = site.ground.area.grown(reach_m::TREES + PLOT_M);
    let [[i0, j0], [i1, j1]] = [area.min, area.max].map(|p| p.map(|v| (v / PLOT_M).floor() as i32));
    for (i, j) in (j0..=j1).flat_map(|j| (i0..=i1).map(move |i| (i, j))) {
        let [x, y] = [i, j].map(|k| (f64::from(k) + 0.5) * PLOT_M);
        let places: &[[f64; 2]] = match uses.at(x, y) {
            Some(Use::Wood) => &[[-2.0, -2.0], [2.0, 2.0]],
            Some(Use::Orchard) => &[[-2.0, -2.0], [2.0, -2.0], [-2.0, 2.0], [2.0, 2.0]],
            _ => continue,
        };
        let is_wood = places.len() == 2;
        let mut random = uses.stream("world/trees/woods", i, j);
        for (slot, [dx, dy]) in (0u64..).zip(places) {
            let [jx, jy] = [0, 1].map(|_| random.uniform(-1.6, 1.6));
            let mut wish = Wish::new(shares, Some(0.0), &mut random);
            let is_wanted = random.unit() < (if is_wood { 0.85 } else { 0.95 }) * site.rules.density;
            let at = if is_wood {
                [x + dx + jx, y + dy + jy]
            } else {
                // Fruit trees are small and alike.
                wish = Wish { kind: &TREES[CHERRY], age: wish.age.min(1), ..wish };
                [x + dx, y + dy]
            };
            let stem = OrientedRect::square(at, STEM_M);
            if is_wanted && site.near(at[0], at[1], reach_m::TREES) && land.free(&stem.grown(EDGE_M)) {
                let at = Point3::new(at[0], at[1], site.levels().terrain.height(at[0], at[1]));
                let who = (WOODS | Uses::entity(i, j), slot);
                found.extend(tree_candidate(site, [built, land], at, (&stem, None), &wish, who));
            }
        }
    }
    found
}

/// Whether a stem can stand on a sidewalk: no lane for vehicles is there, and nobody turns over it.
fn stands_at_kerb(
    site: &Site<'_>,
    spot: &Spot,
    at: Point3<f64>,
    stem: &OrientedRect,
    land: &Land<'_>,
) -> bool {
    let on_lane = site.levels().cover.at(at.x, at.y).any(|(f, _)| f.ground == Ground::Paved);
    let level = site.levels().height(at.x, at.y, spot.point.z);
    !on_lane
        && (level - spot.point.z).abs() <= 1.0
        && land.unused(stem)
        && !is_swept(site.map, Point3::new(at.x, at.y, spot.point.z), PIT_M)
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
    let plant = Plant { kind, model, tag, size_m, near_z_m: spot.point.z, yaw_rad: 0.0, variant, pit: None };
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
