//! Crowns against the formula for light through leaves, and levels against one another.

use std::f32::consts::PI;

use frames::math::f32::exp;
use glam::Vec3;
use schema::geometry::{Surface, TriMesh};

use super::crown::Crown;
use super::leaves::Draws;
use super::plant;
use super::species::{SPECIES, Species};
use crate::actors::ActorMesh;

/// Leaf area over the ground that a crown covers, as it is told of grown trees in towns: least and most.
const LAI: [(&str, [f32; 2]); 14] = [
    ("lime", [3.0, 4.0]),
    ("maple", [3.0, 4.0]),
    ("plane", [2.0, 3.0]),
    ("chestnut", [4.0, 5.0]),
    ("robinia", [1.5, 2.5]),
    ("oak", [3.0, 4.0]),
    ("ash", [2.0, 3.0]),
    ("birch", [2.0, 2.0]),
    ("hornbeam", [4.0, 4.0]),
    ("cherry", [2.0, 3.0]),
    ("poplar", [3.0, 3.0]),
    ("willow", [2.0, 3.0]),
    ("spruce", [5.0, 7.0]),
    ("pine", [2.0, 3.0]),
];
/// Share of that area that does not hide behind other leaves of its twig.
const UNHIDDEN: f32 = 0.8;

/// A tree's box at an age, metres.
fn size_m(species: &Species, age: usize, variant: u32) -> Vec3 {
    let name = format!("tree.{}", species.name);
    let kind = land::scenery::TREES.iter().find(|kind| kind.model == name).expect("is planted");
    Vec3::from_array(kind.size_m(age, variant).map(|v| v as f32))
}

/// All ages and variants of a species.
fn all_of(species: &'static Species) -> impl Iterator<Item = (Vec3, u32)> {
    (0..3)
        .flat_map(|age| (0..land::scenery::TreeKind::VARIANTS).map(move |v| (age, v)))
        .map(|(age, variant)| (size_m(species, age, variant), variant))
}

fn tree(species: &Species, size: Vec3, variant: u32) -> ActorMesh {
    plant("tree", species.name, size, variant).expect("is one")
}

/// The meshes of a plant, the finest first.
fn levels(made: &ActorMesh) -> impl Iterator<Item = &TriMesh> {
    std::iter::once(&made.pieces).chain(made.coarser.iter().map(|level| &level.pieces)).map(|p| &*p[0].mesh)
}

/// Triangles of leaves.
fn leaves(mesh: &TriMesh) -> Vec<[Vec3; 3]> {
    let is_leaf = |t: &usize| mesh.part(*t).surface == Surface::Foliage;
    (0..mesh.triangles.len()).filter(is_leaf).map(|t| mesh.corners(t)).collect()
}

fn area_m2(triangles: &[[Vec3; 3]]) -> f32 {
    triangles.iter().map(|[a, b, c]| 0.5 * (*b - *a).cross(*c - *a).length()).sum()
}

/// Triangles seen along a way, by the cells of a grid that they may be in.
struct Seen {
    axes: [Vec3; 2],
    cell_m: f32,
    cells: Vec<Vec<[[f32; 2]; 3]>>,
}

impl Seen {
    /// Cells on a side.
    const SIDE: i32 = 64;

    fn new(leaves: &[[Vec3; 3]], way: Vec3, reach_m: f32) -> Self {
        let u = way.any_orthonormal_vector();
        let cells = vec![Vec::new(); (Self::SIDE * Self::SIDE) as usize];
        let mut seen = Self { axes: [u, way.cross(u)], cell_m: 2.0 * reach_m / Self::SIDE as f32, cells };
        for leaf in leaves {
            let axes = seen.axes;
            let flat = leaf.map(|p| axes.map(|axis| p.dot(axis)));
            let range = |k: usize| {
                let all = flat.map(|p| seen.cell(p[k]));
                all.into_iter().fold(i32::MAX, i32::min)..=all.into_iter().fold(0, i32::max)
            };
            let (rows, columns) = (range(0), range(1));
            for i in rows {
                for j in columns.clone() {
                    seen.cells[(i * Self::SIDE + j) as usize].push(flat);
                }
            }
        }
        seen
    }

    fn cell(&self, at: f32) -> i32 {
        (((at / self.cell_m).floor() as i32) + Self::SIDE / 2).clamp(0, Self::SIDE - 1)
    }

    /// Whether a ray through a place along the way meets none of them.
    fn passes(&self, place: Vec3) -> bool {
        let p = self.axes.map(|axis| place.dot(axis));
        let [i, j] = p.map(|at| self.cell(at));
        !self.cells[(i * Self::SIDE + j) as usize].iter().any(|[a, b, c]| {
            let side =
                |a: &[f32; 2], b: &[f32; 2]| (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]);
            let sides = [side(a, b), side(b, c), side(c, a)];
            sides.iter().all(|s| *s >= 0.0) || sides.iter().all(|s| *s <= 0.0)
        })
    }
}

/// How far a ray through a place goes through a crown, metres.
fn chord_m(crown: &Crown, place: Vec3, way: Vec3) -> f32 {
    let (steps, whole) = (80, 3.0 * crown.half_m.max_element() + 2.0 * (crown.top_m - crown.base_m));
    let inside = |i: &i32| crown.out(place + way * (whole * ((*i as f32 + 0.5) / steps as f32 - 0.5))) <= 1.0;
    (0..steps).filter(inside).count() as f32 / steps as f32 * whole
}

#[test]
fn as_many_rays_pass_a_crown_as_the_formula_says() {
    let mut wrong = Vec::new();
    for species in &SPECIES {
        for (size, variant) in all_of(species) {
            let made = tree(species, size, variant);
            let crown = Crown::new(species, size);
            let triangles: Vec<_> = levels(&made).take(3).map(leaves).collect();
            let density = [0, 1, 2].map(|level| area_m2(&triangles[level]) / crown.volume_m3);
            let (ways, rays) = (24, 120);
            let mut draws = Draws::new(variant, 99);
            let (mut passed, mut expected) = ([0.0; 3], [0.0; 3]);
            for _ in 0..ways {
                // Most of them are about level, as those of sensors on roads are.
                let way = (draws.direction() * Vec3::new(1.0, 1.0, 0.4)).normalize_or(Vec3::X);
                let seen = [0, 1, 2].map(|level| Seen::new(&triangles[level], way, size.length()));
                for _ in 0..rays {
                    let place = std::iter::repeat_with(|| {
                        let [x, y] = [crown.half_m.x, crown.half_m.y].map(|half| draws.uniform(-half, half));
                        Vec3::new(x, y, draws.uniform(crown.base_m, crown.top_m))
                    });
                    let place = place.take(100).find(|p| crown.out(*p) <= 1.0).expect("some are in it");
                    let chord = chord_m(&crown, place, way);
                    for level in 0..3 {
                        expected[level] += exp(-0.5 * density[level] * chord) / (ways * rays) as f32;
                        passed[level] += f32::from(seen[level].passes(place)) / (ways * rays) as f32;
                    }
                }
            }
            for level in 0..3 {
                let (passed, expected) = (passed[level], expected[level]);
                if (passed - expected).abs() >= 0.05 {
                    let name = species.name;
                    wrong.push(format!(
                        "{name} of {size} m, {variant}, level {level}: {passed:.3} where {expected:.3} is due"
                    ));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn crowns_have_the_leaf_area_of_their_species() {
    for species in &SPECIES {
        let (_, [least, most]) = LAI.iter().find(|(name, _)| *name == species.name).expect("is in the table");
        for (size, variant) in all_of(species) {
            let made = tree(species, size, variant);
            for (level, mesh) in levels(&made).take(3).enumerate() {
                let covered = PI * 0.25 * size.x * size.y;
                let lai = area_m2(&leaves(mesh)) / UNHIDDEN / covered;
                let name = species.name;
                assert!(
                    (0.85 * least..1.15 * most).contains(&lai),
                    "{name} of {size} m, {variant}, level {level}: {lai}"
                );
            }
        }
    }
}

#[test]
fn levels_keep_the_area_of_leaves_and_cost_less_and_less() {
    for species in &SPECIES {
        for (size, variant) in all_of(species) {
            let made = tree(species, size, variant);
            let near = area_m2(&leaves(&made.pieces[0].mesh));
            let mut last = 13_000;
            for (number, mesh) in levels(&made).enumerate() {
                let area = area_m2(&leaves(mesh));
                let within = if number < 3 { 0.15 } else { 0.3 };
                assert!((area / near - 1.0).abs() < within, "{} {number}: {area}, {near} m2", species.name);
                assert!(mesh.triangles.len() < last, "{}: {} of {last}", species.name, mesh.triangles.len());
                last = mesh.triangles.len();
            }
            assert!(last < 260, "{}: {last}", species.name);
        }
    }
}

#[test]
fn bare_trees_have_wood_alone_and_cost_less_and_less() {
    for species in &SPECIES {
        let size = size_m(species, 1, 1);
        let bare = plant("tree", &format!("{}.bare", species.name), size, 1);
        let Some(bare) = bare else {
            assert!(species.is_evergreen, "{}", species.name);
            continue;
        };
        let mut last = 10_000;
        for mesh in levels(&bare) {
            assert!(mesh.parts.iter().all(|part| part.surface == Surface::Wood), "{}", species.name);
            assert!(mesh.triangles.len() < last, "{}: {} of {last}", species.name, mesh.triangles.len());
            last = mesh.triangles.len();
        }
        assert!(last < 500, "{}: {last}", species.name);
    }
    assert!(plant("tree", "palm.bare", Vec3::new(5.0, 5.0, 12.0), 1).is_none());
}

#[test]
fn stems_are_clear_where_people_walk_and_lorries_drive() {
    for species in SPECIES.iter().filter(|species| species.is_pruned()) {
        for (size, variant) in all_of(species) {
            let made = tree(species, size, variant);
            let lowest = leaves(&made.pieces[0].mesh).iter().flatten().fold(f32::INFINITY, |z, p| z.min(p.z));
            let clear: f32 = if size.z > 8.5 { 4.0 } else { 1.9 };
            assert!(lowest > clear.min(0.5 * size.z), "{} of {size} m: leaves at {lowest} m", species.name);
        }
    }
}
