//! Trees with a stem: wood, leaves round its twigs.
//!
//! Two triangles are as large as a twig's leaves; their area is that of the leaves less what hides behind
//! others, so that as many rays pass as pass a crown of that leaf area density.

use frames::math;
use glam::Vec3;
use schema::Tag;
use schema::geometry::{MeshPart, Surface, TriMesh};

use super::crown::Crown;
use super::leaves::{Draws, Leaf, reserve};
use super::levels::{FROM_M, LEVELS, into_levels};
use super::species::Species;
use super::wood::{Stem, Wood};
use crate::actors::ActorMesh;

/// The most twigs with leaves that a tree has at each level; farther away each stands for several.
const MOST: [f32; LEVELS] = [5000.0, 1900.0, 550.0, 240.0, 90.0];
/// Sides of squares of leaves at each level, as multiples.
const LARGER: [f32; LEVELS] = [0.85, 1.4, 2.2, 3.0, 4.4];
/// How far apart the two leaves of a twig are, as a share of their side.
const APART: f32 = 1.35;
/// How much longer than wide leaves are at most at the last level.
const LONGEST_FAR: f32 = 1.8;
/// Share of the leaves that are anywhere in the crown; others are round the twigs.
const ANYWHERE: f32 = 0.7;

/// Multiples of it are spread evenly between whole numbers, any of them in a row.
const GOLDEN: f32 = 0.618_034;

/// A leaf at a place, from a twig that grows some way there.
fn leaf(crown: &Crown, centre: Vec3, way: Vec3, draws: &mut Draws) -> Leaf {
    let (outward, hang) = (crown.outward(centre), crown.species.leaves.hang);
    // Leaves look out and down from their twigs.
    let way = (way + outward * 0.6 - Vec3::Z * 0.3) * (1.0 - hang) - Vec3::Z * hang;
    Leaf::any(centre, [way, outward], crown.open(centre), draws)
}

/// Shades of the leaves of one tree, the darkest first.
fn greens(species: &Species, draws: &mut Draws) -> [MeshPart; 3] {
    // No two trees have the same green.
    let tint = [draws.uniform(0.85, 1.2), draws.uniform(0.92, 1.08), draws.uniform(0.8, 1.15)];
    [0.78, 1.0, 1.22].map(|shade| {
        let rgb = [0, 1, 2].map(|k| shade * tint[k] * species.leaves.rgb[k]);
        MeshPart::new(Tag::Vegetation, Surface::Foliage, rgb)
    })
}

/// The bark of the stem, and that of what is younger: it is not white yet.
fn bark(species: &Species) -> [MeshPart; 2] {
    let young = species.bark.map(|c| c.min(0.19));
    [species.bark, young].map(|rgb| MeshPart::new(Tag::Vegetation, Surface::Wood, rgb))
}

/// The leaves of a tree close by, and the side of a square as large as two of them.
struct Foliage {
    leaves: Vec<Leaf>,
    side_m: f32,
}

impl Foliage {
    fn new(crown: &Crown, wood: &Wood, variant: u32) -> Self {
        let mut draws = Draws::new(variant, 10);
        let kind = &crown.species.leaves;
        let area = crown.area_m2();
        // Smaller trees have smaller twigs.
        let side = kind.cluster_m * (crown.top_m / 15.0).sqrt().clamp(0.6, 1.2);
        let count = twigs(area, side, 0);
        let side_m = (area / count).sqrt();
        // Twigs carry leaves by the room around them; so do the ends of boughs.
        let room = |stem: &Stem, share: f32| {
            let radius = crown.share(stem.at(share).0.z).max(0.1);
            radius * radius
        };
        let on_twigs = wood.twigs.iter().map(|twig| (room(twig, 0.7), twig, 0.45));
        let on_boughs = wood.boughs.iter().map(|bough| (1.6 * room(bough, 0.8), bough, 0.7));
        let ends: Vec<(f32, &Stem, f32)> = on_twigs.chain(on_boughs).collect();
        let whole: f32 = ends.iter().map(|(room, ..)| room).sum();
        let spread = 0.7 * math::cbrt(f64::from(crown.volume_m3) / ends.len() as f64) as f32;
        let start = draws.unit();
        let mut leaves = Vec::with_capacity(2 * count as usize);
        let mut next = ends.iter();
        let (mut end, mut passed) = (next.next(), 0.0);
        for i in 0..count as usize {
            let wanted = whole * (i as f32 + 0.5) / count;
            while let Some((room, ..)) = end
                && passed + room < wanted
            {
                passed += room;
                end = next.next();
            }
            let Some((_, stem, from)) = end else { break };
            let is_anywhere = draws.unit() < ANYWHERE;
            let (centre, way) = if is_anywhere {
                // Evenly by height, of any of them in a row (multiples of the golden ratio).
                let below = (GOLDEN * i as f32 + start).fract();
                (crown.anywhere(below, kind.shell, &mut draws), Vec3::ZERO)
            } else {
                let (place, way) = stem.at(draws.uniform(*from, 1.05));
                (crown.around(place, spread, &mut draws), way)
            };
            let off = draws.direction() * (0.5 * APART * side_m);
            leaves.extend([off, -off].map(|off| leaf(crown, centre + off, way, &mut draws)));
        }
        Self { leaves, side_m }
    }

    /// Adds the leaves of a level: fewer and larger ones of the same area.
    fn add(&self, mesh: &mut TriMesh, crown: &Crown, shades: [u8; 3], (level, variant): (usize, u32)) {
        let mut draws = Draws::new(variant, 20 + level as u64);
        let kind = &crown.species.leaves;
        let all = self.leaves.len();
        let count =
            if level == 0 { all } else { (2.0 * twigs(crown.area_m2(), self.near_m(), level)) as usize };
        let count = count.clamp(1, all.max(1));
        let side_m = self.side_m * (all as f32 / count as f32).sqrt();
        // They reach no farther out.
        let inward = 1.0 - (0.2 * (side_m - self.side_m) / crown.half_m.x).min(0.2);
        // The largest stand for a whole piece of the crown.
        let longer = if level + 1 < LEVELS { kind.longer } else { kind.longer.min(LONGEST_FAR) };
        reserve(mesh, count);
        for j in 0..count.min(all) {
            let mut leaf = if level < 2 {
                self.leaves[j * all / count]
            } else {
                // No longer the same ones: few stand evenly only if they are drawn so.
                let centre = crown.anywhere((GOLDEN * j as f32).fract(), kind.shell, &mut draws);
                leaf(crown, centre, Vec3::ZERO, &mut draws)
            };
            leaf.centre.x *= inward;
            leaf.centre.y *= inward;
            leaf.centre.z = leaf.centre.z.min(crown.top_m - 0.3 * side_m);
            leaf.add(mesh, shades, side_m, longer);
        }
    }

    /// The side that was wanted close by, before it was said how many there are.
    fn near_m(&self) -> f32 {
        self.side_m / LARGER[0]
    }
}

/// How many twigs have leaves at a level, where a square of the leaves of one has about some side.
fn twigs(area_m2: f32, side_m: f32, level: usize) -> f32 {
    let side_m = side_m * LARGER[level];
    (area_m2 / (side_m * side_m)).clamp(24.0, MOST[level]).floor()
}

/// A tree of a species, in leaf; it fills its box.
pub(super) fn tree(species: &'static Species, size: Vec3, variant: u32) -> ActorMesh {
    let crown = Crown::new(species, size);
    let mut draws = Draws::new(variant, 1);
    let wood = Wood::new(&crown, &mut draws);
    let bark = bark(species);
    let greens = greens(species, &mut draws);
    let foliage = Foliage::new(&crown, &wood, variant);
    let meshes = (0..LEVELS).map(|level| {
        let mut mesh = wood.mesh(&crown, bark, level);
        let shades = greens.map(|green| mesh.part_index(green));
        foliage.add(&mut mesh, &crown, shades, (level, variant));
        mesh
    });
    into_levels(meshes.collect(), size, FROM_M)
}

/// The same without leaves, if it sheds them.
pub(super) fn bare(species: &'static Species, size: Vec3, variant: u32) -> Option<ActorMesh> {
    if species.is_evergreen {
        return None;
    }
    let crown = Crown::new(species, size);
    let wood = Wood::new(&crown, &mut Draws::new(variant, 1));
    let bark = bark(species);
    let meshes = (0..LEVELS).map(|level| wood.bare(&crown, bark, level, variant)).collect();
    Some(into_levels(meshes, size, FROM_M))
}
