//! The wood of trees: a stem, boughs, twigs on them, shoots on those.
//!
//! Boughs and twigs follow Weber and Penn (1995): the shape of the crown says how long each bough is.

use std::f32::consts::{PI, TAU};

use frames::math::f32::sin_cos;
use glam::Vec3;
use schema::Normal;
use schema::geometry::{MeshPart, TriMesh};

use super::crown::Crown;
use super::leaves::{Draws, share};
use super::levels::LEVELS;
use crate::solids::circle;

/// The angle from one bough to the next.
const GOLDEN_RAD: f32 = PI * (3.0 - 2.236_068);
/// Of trees with more boughs than this no twigs are shown.
const MANY_BOUGHS: usize = 40;
/// Wood of boughs is shown above this height; below, leaves are before it, metres.
const BOUGHS_ABOVE_M: f32 = 2.2;
/// The most sides of wood.
const SIDES: usize = 9;
/// Sides of the stem by level, and how many of its places are kept: every so many.
const TRUNK: [[usize; 2]; LEVELS] = [[9, 1], [6, 2], [4, 4], [4, 6], [4, 8]];
/// Shoots of a bare tree by level, and how much thicker than close by they are.
const SHOOTS: [(usize, f32); LEVELS] = [(1200, 1.0), (420, 1.8), (80, 4.0), (20, 6.0), (0, 0.0)];

/// A stem, bough or twig: places along it with its radius there.
#[derive(Clone, Debug)]
pub(super) struct Stem(Vec<(Vec3, f32)>);

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
    pub(super) fn at(&self, share: f32) -> (Vec3, Vec3) {
        let pieces = self.0.len() - 1;
        let along = share.clamp(0.0, 1.0) * pieces as f32;
        let i = (along as usize).min(pieces - 1);
        let (from, to) = (self.0[i].0, self.0[i + 1].0);
        (from + (to - from) * (along - i as f32), (to - from).normalize_or(Vec3::Z))
    }
}

/// Wood in the making: closed stems that end in a point.
struct Carver<'a> {
    mesh: TriMesh,
    /// Of the stem, and of limbs.
    parts: [u8; 2],
    crown: &'a Crown,
    normals: Vec<Normal>,
    shares: Vec<u8>,
}

impl<'a> Carver<'a> {
    fn new(crown: &'a Crown, parts: [MeshPart; 2]) -> Self {
        let mut mesh = TriMesh::default();
        let parts = parts.map(|part| mesh.part_index(part));
        Self { mesh, parts, crown, normals: Vec::new(), shares: Vec::new() }
    }

    fn vertex(&mut self, at: Vec3, normal: Vec3, open: u8) -> u32 {
        self.normals.push(Normal::new(normal));
        self.shares.push(open);
        self.mesh.add_vertex(at)
    }

    fn triangle(&mut self, part: u8, corners: [u32; 3]) {
        self.mesh.triangles.push(corners);
        self.mesh.triangle_part.push(part);
        self.mesh.corner_normals.push(corners.map(|v| self.normals[v as usize]));
        self.mesh.corner_visibility.push(corners.map(|v| self.shares[v as usize]));
    }

    /// Adds a stem with so many sides, by every `every`-th of its places, so many times as thick.
    fn stem(&mut self, stem: &Stem, part: u8, [sides, every]: [usize; 2], thicker: f32) {
        let last = stem.0.len() - 1;
        let mut corners = [(0.0, 0.0); SIDES];
        corners.iter_mut().zip(circle(sides)).for_each(|(corner, at)| *corner = at);
        let (first, n) = (self.mesh.positions.len() as u32, sides as u32);
        let mut rings = 0;
        let mut helper = None;
        for i in (0..last).step_by(every) {
            let (centre, radius) = stem.0[i];
            let way = (stem.0[(i + 1).min(last)].0 - stem.0[i.saturating_sub(1)].0).normalize_or(Vec3::Z);
            let helper = *helper.get_or_insert(if way.z.abs() < 0.9 { Vec3::Z } else { Vec3::X });
            let u = way.cross(helper).normalize_or(Vec3::Y);
            let v = way.cross(u);
            let open = share(self.crown.open_wood(centre));
            for (c, s) in &corners[..sides] {
                let off = *c * u + *s * v;
                self.vertex(centre + thicker * radius * off, off, open);
            }
            rings += 1;
        }
        let (tip, _) = stem.0[last];
        let (_, way) = stem.at(1.0);
        let tip = self.vertex(tip, way, share(self.crown.open_wood(tip)));
        for ring in 0..rings {
            for j in 0..n {
                let [a, b] = [j, (j + 1) % n].map(|j| first + ring * n + j);
                if ring + 1 < rings {
                    self.triangle(part, [a, b, b + n]);
                    self.triangle(part, [a, b + n, a + n]);
                } else {
                    self.triangle(part, [a, b, tip]);
                }
            }
        }
        for j in 1..n - 1 {
            self.triangle(part, [first, first + j + 1, first + j]);
        }
    }
}

/// The wood of a tree.
pub(super) struct Wood {
    trunk: Stem,
    pub(super) boughs: Vec<Stem>,
    pub(super) twigs: Vec<Stem>,
}

/// Radius of a stem at its foot, metres.
fn foot_m(height_m: f32) -> f32 {
    0.012 * height_m + 0.025
}

impl Wood {
    pub(super) fn new(crown: &Crown, draws: &mut Draws) -> Self {
        let species = crown.species;
        let trunk = trunk(crown, draws);
        let [count, on_each] = species.boughs;
        let (mut boughs, mut twigs) = (Vec::with_capacity(count), Vec::with_capacity(count * on_each));
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

    /// The wood of a tree in leaf at a level.
    pub(super) fn mesh(&self, crown: &Crown, parts: [MeshPart; 2], level: usize) -> TriMesh {
        let mut carver = Carver::new(crown, parts);
        let [bark, young] = carver.parts;
        // Where there are many boughs they are thin.
        let sides = if self.boughs.len() > MANY_BOUGHS { [3, 3, 3] } else { [5, 3, 3] };
        carver.stem(&self.trunk, bark, TRUNK[level], 1.0);
        if level < 3 {
            let boughs = self.boughs.iter().filter(|bough| bough.is_above(BOUGHS_ABOVE_M));
            boughs.for_each(|bough| carver.stem(bough, young, [sides[level], [1, 2, 4][level]], 1.0));
        }
        if level < 1 && self.boughs.len() <= MANY_BOUGHS {
            let twigs = self.twigs.iter().filter(|twig| twig.is_above(BOUGHS_ABOVE_M));
            twigs.for_each(|twig| carver.stem(twig, young, [3, 2], 1.0));
        }
        carver.mesh
    }

    /// The wood of a tree without leaves at a level: with shoots close by, with fewer but thicker twigs far
    /// off.
    pub(super) fn bare(&self, crown: &Crown, parts: [MeshPart; 2], level: usize, variant: u32) -> TriMesh {
        let mut carver = Carver::new(crown, parts);
        let [bark, young] = carver.parts;
        carver.stem(&self.trunk, bark, TRUNK[level], 1.0);
        for bough in &self.boughs {
            carver.stem(
                bough,
                young,
                [[5, 3, 3, 3, 3][level], [1, 2, 2, 2, 2][level]],
                [1.0, 1.1, 1.3, 1.4, 1.6][level],
            );
        }
        let twigs = || self.twigs.iter().step_by([1, 1, 2, 3, 5][level]);
        for twig in twigs() {
            carver.stem(twig, young, [3, [1, 2, 2, 2, 2][level]], [1.25, 1.7, 2.5, 3.0, 3.5][level]);
        }
        let (count, thicker) = SHOOTS[level];
        let mut draws = Draws::new(variant, 60);
        // Long limbs have more of them.
        let limbs: Vec<(f32, &Stem)> =
            twigs().chain(&self.boughs).map(|limb| (limb.length_m(), limb)).collect();
        let whole: f32 = limbs.iter().map(|(length, _)| length).sum();
        let (mut i, mut passed) = (0, 0.0);
        for k in 0..count {
            let wanted = whole * (k as f32 + 0.5) / count as f32;
            while i + 1 < limbs.len() && passed + limbs[i].0 < wanted {
                passed += limbs[i].0;
                i += 1;
            }
            carver.stem(&shoot(crown, limbs[i].1, &mut draws), young, [3, 1], thicker);
        }
        carver.mesh
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
    // Where there are many they are thin.
    let thick = thick * (20.0 / crown.species.boughs[0] as f32).min(1.0);
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

/// A shoot on a twig or a bough.
fn shoot(crown: &Crown, limb: &Stem, draws: &mut Draws) -> Stem {
    let (from, along) = limb.at(draws.uniform(0.3, 1.0));
    let length = (0.065 * crown.height_m()).clamp(0.3, 1.2) * draws.uniform(0.5, 1.4);
    let hang = crown.species.leaves.hang;
    let way = along * 0.8 + draws.direction() * 0.7 + Vec3::Z * (0.35 - 2.0 * hang);
    let to = crown.within(from + way.normalize_or(along) * length);
    Stem(vec![(from, 0.007 + 0.007 * length), (to, 0.004)])
}
