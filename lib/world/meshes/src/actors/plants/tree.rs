//! Trees with a stem: boughs, twigs on them, leaves round the twigs.
//!
//! Boughs and twigs follow Weber and Penn (1995): the shape of the crown says how long each bough is. Two
//! triangles are as large as a twig's leaves; their area is that of the leaves less what hides behind others,
//! so that as many rays pass as pass a crown of that leaf area density.

use std::f32::consts::{PI, TAU};

use frames::math::{self, f32::sin_cos};
use glam::Vec3;
use schema::Tag;
use schema::geometry::{MeshPart, Surface, TriMesh};

use super::leaves::{Cluster, Draws, add_cluster, prepare};
use super::levels::{FROM_M, LEVELS, into_levels};
use super::species::Species;
use crate::actors::ActorMesh;
use crate::solids::{MeshBuilder, circle};

/// Share of the area of leaves that does not hide behind other leaves of its twig.
const UNHIDDEN: f32 = 0.8;
/// The most twigs with leaves that a tree has at each level; farther away each stands for several.
const MOST: [f32; 3] = [5000.0, 1900.0, 550.0];
/// Sides of squares of leaves at each level, as multiples.
const LARGER: [f32; 3] = [0.85, 1.4, 2.2];
/// The angle from one bough to the next.
const GOLDEN_RAD: f32 = PI * (3.0 - 2.236_068);
/// Twigs with leaves round the closed bodies of trees that are far away.
const FRINGE: usize = 45;
/// Such a body's size, as a share of the crown's.
const BODY: f32 = 0.84;
/// Of trees with more boughs than this no twigs are shown.
const MANY_BOUGHS: usize = 40;
/// Share of the leaves of each level that are anywhere in the crown; others are round the twigs.
const ANYWHERE: [f32; 3] = [0.65, 0.75, 1.0];
/// Nothing grows beyond this share of the way from the stem to the crown's edge.
const EDGE: f32 = 0.97;

/// From this height on a tree is grown, and how high a crown begins that is pruned, metres.
const GROWN_M: f32 = 8.5;
const OVER_LORRIES_M: f32 = 4.75;
const OVER_PEOPLE_M: f32 = 2.4;
/// Wood of boughs is shown above this height; below, leaves are before it, metres.
const BOUGHS_ABOVE_M: f32 = 2.2;

/// Where a crown is.
#[derive(Clone, Copy, Debug)]
pub(super) struct Crown {
    species: &'static Species,
    pub(super) half_m: Vec3,
    pub(super) base_m: f32,
    pub(super) top_m: f32,
}

impl Crown {
    pub(super) fn new(species: &'static Species, size: Vec3) -> Self {
        // Street trees are pruned: lorries drive below the grown ones, people walk below the young ones.
        let clear_m = match (species.is_pruned(), size.z > GROWN_M) {
            (true, true) => OVER_LORRIES_M,
            (true, false) => OVER_PEOPLE_M,
            (false, _) => 0.0,
        };
        let base_m = (species.bare * size.z).max(clear_m).min(0.6 * size.z);
        Self { species, half_m: 0.5 * size, base_m, top_m: size.z }
    }

    fn height_m(&self) -> f32 {
        self.top_m - self.base_m
    }

    /// Its radius at a height, as a share of its greatest one.
    pub(super) fn share(&self, z: f32) -> f32 {
        if z < self.base_m || z > self.top_m {
            return 0.0;
        }
        self.species.shape.at((z - self.base_m) / self.height_m())
    }

    /// How far from the stem a place is, as a share of the way to the crown's edge.
    pub(super) fn out(&self, p: Vec3) -> f32 {
        let level = Vec3::new(p.x / self.half_m.x, p.y / self.half_m.y, 0.0).length();
        level / self.share(p.z).max(1e-3)
    }

    /// The nearest place in the crown, at the same height if that is one of it.
    fn within(&self, p: Vec3) -> Vec3 {
        let z = p.z.clamp(self.base_m + 0.01 * self.top_m, self.top_m - 0.01 * self.top_m);
        let p = Vec3::new(p.x, p.y, z);
        let out = self.out(p);
        if out > EDGE { Vec3::new(p.x * EDGE / out, p.y * EDGE / out, z) } else { p }
    }

    /// A place in it, all alike.
    fn anywhere(&self, draws: &mut Draws) -> Vec3 {
        let mut place = Vec3::Z * 0.5 * (self.base_m + self.top_m);
        for _ in 0..12 {
            let z = draws.uniform(self.base_m, self.top_m);
            let x = draws.uniform(-self.half_m.x, self.half_m.x);
            let y = draws.uniform(-self.half_m.y, self.half_m.y);
            place = Vec3::new(x, y, z);
            if self.out(place) <= EDGE {
                break;
            }
        }
        self.within(place)
    }

    /// A place in it near some place.
    fn around(&self, place: Vec3, spread_m: f32, draws: &mut Draws) -> Vec3 {
        let tries = (0..6).map(|_| place + draws.around() * spread_m);
        let inside = |p: &Vec3| p.z > self.base_m && p.z < self.top_m && self.out(*p) <= EDGE;
        tries.into_iter().find(inside).unwrap_or_else(|| self.within(place))
    }

    /// The volume, m3.
    pub(super) fn volume_m3(&self) -> f32 {
        let slices = 40;
        let square = |i: usize| {
            let share = self.species.shape.at((i as f32 + 0.5) / slices as f32);
            share * share
        };
        let mean = (0..slices).map(square).sum::<f32>() / slices as f32;
        PI * self.half_m.x * self.half_m.y * self.height_m() * mean
    }

    /// The area of all triangles of leaves, m2.
    pub(super) fn area_m2(&self) -> f32 {
        UNHIDDEN * self.species.leaves.lai * PI * self.half_m.x * self.half_m.y
    }

    /// The way out at a place (unit): that of an ellipsoid as large as the crown.
    fn outward(&self, p: Vec3) -> Vec3 {
        let middle = 0.5 * (self.base_m + self.top_m);
        let half_z = 0.5 * self.height_m();
        let [x, y] = [self.half_m.x, self.half_m.y];
        Vec3::new(p.x / (x * x), p.y / (y * y), (p.z - middle) / (half_z * half_z)).normalize_or(Vec3::Z)
    }

    /// What of the light of sky and ground gets to a place, 0 to 1: less where more leaves are around it.
    fn open(&self, p: Vec3) -> f32 {
        let density = self.area_m2() / self.volume_m3();
        let inside = (1.0 - self.out(p)).max(0.0) * self.share(p.z) * self.half_m.x;
        let deep_m = inside.min(self.top_m - p.z).max(0.0);
        let high = ((p.z - self.base_m) / self.height_m()).clamp(0.0, 1.0);
        (0.72 + 0.28 * high) * (0.3 + 0.7 / (1.0 + 1.3 * density * deep_m))
    }
}

/// A stem, bough or twig: places along it with its radius there.
#[derive(Clone, Debug)]
struct Stem(Vec<(Vec3, f32)>);

impl Stem {
    /// A bow from one place to another by way of a third.
    fn bow([from, by, to]: [Vec3; 3], [thick, thin]: [f32; 2], pieces: usize) -> Self {
        let at = |i: usize| {
            let t = i as f32 / pieces as f32;
            let s = 1.0 - t;
            (from * (s * s) + by * (2.0 * s * t) + to * (t * t), thick + (thin - thick) * t)
        };
        Self((0..=pieces).map(at).collect())
    }

    fn length_m(&self) -> f32 {
        self.0.windows(2).map(|pair| (pair[1].0 - pair[0].0).length()).sum()
    }

    fn is_above(&self, z: f32) -> bool {
        self.0.iter().all(|(place, _)| place.z >= z)
    }

    /// A place and the way on from there, at a share of the way.
    fn at(&self, share: f32) -> (Vec3, Vec3) {
        let pieces = self.0.len() - 1;
        let along = share.clamp(0.0, 1.0) * pieces as f32;
        let i = (along as usize).min(pieces - 1);
        let (from, to) = (self.0[i].0, self.0[i + 1].0);
        (from + (to - from) * (along - i as f32), (to - from).normalize_or(Vec3::Z))
    }

    /// Adds it with so many sides, by every `every`-th of its places.
    fn add(&self, b: &mut MeshBuilder, part: MeshPart, sides: usize, every: usize) {
        let last = self.0.len() - 1;
        let rings: Vec<Vec<Vec3>> = (0..=last)
            .filter(|i| i % every == 0 || *i == last)
            .map(|i| {
                let (centre, radius) = self.0[i];
                let way = (self.0[(i + 1).min(last)].0 - self.0[i.saturating_sub(1)].0).normalize_or(Vec3::Z);
                let helper = if way.z.abs() < 0.9 { Vec3::Z } else { Vec3::X };
                let u = way.cross(helper).normalize_or(Vec3::Y);
                let v = way.cross(u);
                circle(sides).map(|(c, s)| centre + radius * (c * u + s * v)).collect()
            })
            .collect();
        b.loft(&rings, |_, _| part, [part; 2]);
    }
}

/// The wood of a tree.
struct Wood {
    trunk: Stem,
    boughs: Vec<Stem>,
    twigs: Vec<Stem>,
}

/// Radius of a stem at its foot, metres.
fn foot_m(height_m: f32) -> f32 {
    0.012 * height_m + 0.025
}

impl Wood {
    fn new(crown: &Crown, draws: &mut Draws) -> Self {
        let species = crown.species;
        let trunk = trunk(crown, draws);
        let [count, on_each] = species.boughs;
        let (mut boughs, mut twigs) = (Vec::new(), Vec::new());
        let ends = species.stem * crown.top_m;
        let starts = crown.base_m + 0.02 * crown.height_m();
        for i in 0..count {
            let up = ((i as f32 + draws.unit()) / count as f32).min(1.0);
            let z = starts + (ends - starts) * up * 0.98;
            let (from, _) = trunk.at(z / ends);
            let (sin, cos) = sin_cos(GOLDEN_RAD * i as f32 + draws.uniform(-0.3, 0.3));
            let bough = bough(crown, [cos, sin], (from, up), draws);
            let (_, first) = bough.0[0];
            for j in 0..on_each {
                twigs.push(twig(crown, &bough, (j, on_each), first, draws));
            }
            boughs.push(bough);
        }
        Self { trunk, boughs, twigs }
    }

    fn mesh(&self, part: MeshPart, level: usize) -> TriMesh {
        let mut b = MeshBuilder::new();
        // Where there are many boughs they are thin.
        let sides = if self.boughs.len() > MANY_BOUGHS { [3, 3, 3] } else { [5, 3, 3] };
        self.trunk.add(&mut b, part, [9, 6, 4, 4][level], [1, 2, 4, 8][level]);
        if level < 3 {
            let boughs = self.boughs.iter().filter(|bough| bough.is_above(BOUGHS_ABOVE_M));
            boughs.for_each(|bough| bough.add(&mut b, part, sides[level], [1, 2, 4][level]));
        }
        if level < 1 && self.boughs.len() <= MANY_BOUGHS {
            let twigs = self.twigs.iter().filter(|twig| twig.is_above(BOUGHS_ABOVE_M));
            twigs.for_each(|twig| twig.add(&mut b, part, 3, 2));
        }
        b.finish()
    }
}

/// A stem that is a little crooked, and wider at its foot.
fn trunk(crown: &Crown, draws: &mut Draws) -> Stem {
    let (pieces, ends) = (8, crown.species.stem * crown.top_m);
    let foot = foot_m(crown.top_m);
    let (sin, cos) = sin_cos(draws.uniform(0.0, TAU));
    let crooked = 0.022 * crown.top_m * (1.5 - crown.species.stem);
    Stem(
        (0..=pieces)
            .map(|i| {
                let t = i as f32 / pieces as f32;
                let (wave, other) = sin_cos(2.6 * PI * t * t);
                let off = crooked * t * Vec3::new(cos * wave + 0.4 * sin * other, sin * wave, 0.0);
                let flare = if i == 0 { 1.25 } else { 1.0 };
                (off + Vec3::Z * t * ends, foot * flare * (1.0 - 0.86 * t))
            })
            .collect(),
    )
}

/// A bough that leaves the stem at a place, `up` of the way from the lowest to the highest one.
fn bough(crown: &Crown, [cos, sin]: [f32; 2], (from, up): (Vec3, f32), draws: &mut Draws) -> Stem {
    let [low, high] = crown.species.rise;
    let rise = low + (high - low) * up;
    let outward = Vec3::new(cos * crown.half_m.x, sin * crown.half_m.y, 0.0);
    let highest = crown.top_m - 0.03 * crown.height_m();
    let lowest = crown.base_m + 0.03 * crown.height_m();
    // Where it meets the crown's edge as it rises.
    let mut tip_z = from.z;
    for _ in 0..3 {
        let reach = crown.share(tip_z) * crown.half_m.x;
        tip_z = (from.z + rise * reach).clamp(lowest, highest);
    }
    let reach = crown.share(tip_z) * draws.uniform(0.8, 0.97);
    let tip = crown.within(Vec3::new(0.0, 0.0, tip_z) + outward * reach);
    // Up first where it hangs in the end, out first where it rises.
    let lift = 0.3 + 0.75 * crown.species.leaves.hang;
    let mut by = from + 0.5 * (tip - from);
    by.z = from.z + lift * (tip.z - from.z) + 0.06 * (tip - from).length();
    let length = (tip - from).length();
    let thick = (0.35 * foot_m(crown.top_m)).min(0.012 * length + 0.012) * draws.uniform(0.8, 1.0);
    Stem::bow([from, by, tip], [thick, 0.3 * thick], 4)
}

/// The `j`-th of some twigs of a bough, to its right and left in turn.
fn twig(crown: &Crown, bough: &Stem, (j, count): (usize, usize), thick: f32, draws: &mut Draws) -> Stem {
    let share = 0.28 + 0.72 * (j as f32 + draws.unit()) / count as f32;
    let (from, along) = bough.at(share);
    let side = along.cross(Vec3::Z).normalize_or(Vec3::X) * if j % 2 == 0 { 1.0 } else { -1.0 };
    let length = bough.length_m() * (0.22 + 0.4 * (1.0 - share)) * draws.uniform(0.7, 1.2);
    let way = along * 0.7 + side * draws.uniform(0.5, 1.1) + Vec3::Z * draws.uniform(-0.25, 0.55);
    let hang = crown.species.leaves.hang;
    let to = from + way.normalize_or(along) * length - Vec3::Z * hang * 1.1 * length;
    let to = crown.within(to);
    let by = from + 0.55 * (to - from) + Vec3::Z * (0.08 + 0.35 * hang) * length;
    let thick = (0.45 * thick).min(0.02);
    Stem::bow([from, by, to], [thick, 0.35 * thick], 2)
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

/// Adds the leaves of a level.
fn add_leaves(mesh: &mut TriMesh, crown: &Crown, wood: &Wood, shades: [u8; 3], level: usize, variant: u32) {
    let mut draws = Draws::new(variant, 10 + level as u64);
    let leaves = &crown.species.leaves;
    let area = crown.area_m2();
    // Smaller trees have smaller twigs.
    let side = leaves.cluster_m * (crown.top_m / 15.0).sqrt().clamp(0.6, 1.2) * LARGER[level];
    let count = (area / (side * side)).clamp(24.0, MOST[level]).floor();
    let side_m = (area / count).sqrt();
    // Twigs carry leaves by the room around them; so do the ends of boughs.
    let room = |stem: &Stem, share: f32| {
        let radius = crown.share(stem.at(share).0.z).max(0.1);
        radius * radius
    };
    let twigs = wood.twigs.iter().map(|twig| (room(twig, 0.7), twig, 0.45));
    let boughs = wood.boughs.iter().map(|bough| (1.6 * room(bough, 0.8), bough, 0.7));
    let ends: Vec<(f32, &Stem, f32)> = twigs.chain(boughs).collect();
    let whole: f32 = ends.iter().map(|(room, ..)| room).sum();
    let spread = 0.7 * math::cbrt(f64::from(crown.volume_m3()) / ends.len() as f64) as f32;
    let hang = leaves.hang;
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
        let (place, way) = stem.at(draws.uniform(*from, 1.05));
        let centre = if draws.unit() < ANYWHERE[level] {
            crown.anywhere(&mut draws)
        } else {
            crown.around(place, spread, &mut draws)
        };
        let along = way * 0.5 + draws.direction() * 0.8 + crown.outward(centre) * 0.3;
        let along = along.normalize_or(way) * (1.0 - hang) - Vec3::Z * hang;
        let cluster = Cluster {
            centre,
            along: along.normalize_or(Vec3::Z),
            side_m: side_m * draws.uniform(0.85, 1.13),
            longer: leaves.longer,
            loose: 0.9 * (1.0 - hang),
            outward: crown.outward(centre),
            open: crown.open(centre),
        };
        let shade = shades[((draws.unit() * 3.0) as usize).min(2)];
        add_cluster(mesh, shade, &cluster, &mut draws);
    }
}

/// A closed body as large as the crown.
fn add_lump(b: &mut MeshBuilder, crown: &Crown, green: MeshPart, draws: &mut Draws) {
    let sides = 8;
    let mut ring = |share: f32| -> Vec<Vec3> {
        let z = crown.base_m + share * crown.height_m();
        let radius = crown.share(z).max(0.03) * BODY;
        circle(sides)
            .map(|(c, s)| {
                let bump = radius * draws.uniform(0.8, 1.1);
                Vec3::new(c * crown.half_m.x * bump, s * crown.half_m.y * bump, z)
            })
            .collect()
    };
    let rings: Vec<Vec<Vec3>> = [0.02, 0.15, 0.35, 0.6, 0.82, 0.97].map(&mut ring).into();
    b.loft(&rings, |_, _| green, [green; 2]);
}

/// Adds leaves that stand out of such a body, so that its outline is none of a body.
fn add_fringe(mesh: &mut TriMesh, crown: &Crown, shades: [u8; 3], draws: &mut Draws) {
    for _ in 0..FRINGE {
        let z = draws.uniform(crown.base_m, crown.top_m - 0.02 * crown.height_m());
        let (sin, cos) = sin_cos(draws.uniform(0.0, TAU));
        let reach = crown.share(z) * EDGE;
        let centre = Vec3::new(cos * crown.half_m.x * reach, sin * crown.half_m.y * reach, z);
        let outward = crown.outward(centre);
        let along = (outward + draws.direction() * 0.8).normalize_or(outward);
        let side_m = 0.2 * crown.half_m.x.max(0.1 * crown.height_m());
        let cluster =
            Cluster { centre, along, side_m, longer: 1.2, loose: 0.6, outward, open: crown.open(centre) };
        let shade = shades[((draws.unit() * 3.0) as usize).min(2)];
        add_cluster(mesh, shade, &cluster, draws);
    }
}

/// A tree of a species; it fills its box.
pub(super) fn tree(species: &'static Species, size: Vec3, variant: u32) -> ActorMesh {
    let crown = Crown::new(species, size);
    let mut draws = Draws::new(variant, 1);
    let wood = Wood::new(&crown, &mut draws);
    let bark = MeshPart::new(Tag::Vegetation, Surface::Wood, species.bark);
    let greens = greens(species, &mut draws);
    let meshes = (0..LEVELS).map(|level| {
        let mut mesh = wood.mesh(bark, level);
        if level + 1 == LEVELS {
            let mut b = MeshBuilder::new();
            wood.trunk.add(&mut b, bark, 4, 8);
            add_lump(&mut b, &crown, greens[1], &mut draws);
            let mut mesh = b.finish();
            prepare(&mut mesh, |p| if p.z < crown.base_m { 0.9 } else { crown.open(p) });
            let shades = greens.map(|green| mesh.part_index(green));
            add_fringe(&mut mesh, &crown, shades, &mut draws);
            return mesh;
        }
        prepare(&mut mesh, |p| if p.z < crown.base_m { 0.9 } else { crown.open(p) });
        let shades = greens.map(|green| mesh.part_index(green));
        add_leaves(&mut mesh, &crown, &wood, shades, level, variant);
        mesh
    });
    into_levels(meshes.collect(), size, FROM_M)
}
