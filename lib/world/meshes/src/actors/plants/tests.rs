//! Crowns against the formula for light through leaves, and levels against one another.

use glam::Vec3;
use schema::geometry::{Surface, TriMesh};

use super::leaves::Draws;
use super::plant;
use super::species::{SPECIES, Species};
use super::tree::Crown;

/// A grown tree's box, metres.
fn grown(species: &Species) -> Vec3 {
    let name = format!("tree.{}", species.name);
    let kind = land::scenery::TREES.iter().find(|kind| kind.model == name).expect("is planted");
    let [x, y, z] = kind.size_m(1, 1).map(|v| v as f32);
    Vec3::new(x, y, z)
}

/// Triangles of leaves.
fn leaves(mesh: &TriMesh) -> Vec<[Vec3; 3]> {
    let is_leaf = |t: &usize| mesh.part(*t).surface == Surface::Foliage;
    (0..mesh.triangles.len()).filter(is_leaf).map(|t| mesh.corners(t)).collect()
}

fn area_m2(triangles: &[[Vec3; 3]]) -> f32 {
    triangles.iter().map(|[a, b, c]| 0.5 * (*b - *a).cross(*c - *a).length()).sum()
}

/// Whether a ray meets a triangle (Moeller and Trumbore 1997).
fn meets(origin: Vec3, way: Vec3, [a, b, c]: &[Vec3; 3]) -> bool {
    let (ab, ac) = (*b - *a, *c - *a);
    let p = way.cross(ac);
    let det = ab.dot(p);
    let from = origin - *a;
    let u = from.dot(p) / det;
    let q = from.cross(ab);
    let v = way.dot(q) / det;
    u >= 0.0 && v >= 0.0 && u + v <= 1.0 && ac.dot(q) / det > 0.0
}

#[test]
fn as_many_rays_pass_a_crown_as_the_formula_says() {
    let mut wrong = Vec::new();
    for species in &SPECIES {
        let size = grown(species);
        let made = plant("tree", species.name, size, 1).expect("is one");
        let crown = Crown::new(species, size);
        let levels =
            std::iter::once(&made.pieces).chain(made.coarser.iter().take(2).map(|level| &level.pieces));
        for (level, pieces) in levels.enumerate() {
            let leaves = leaves(&pieces[0].mesh);
            // Tips of leaves fill the box: the crown is where their middles are.
            let mut outs: Vec<f32> = leaves.iter().map(|[a, b, c]| crown.out((*a + *b + *c) / 3.0)).collect();
            outs.sort_unstable_by(f32::total_cmp);
            let edge = outs[outs.len() * 98 / 100].min(1.0);
            let density = area_m2(&leaves) / (crown.volume_m3() * edge * edge);
            // The share of the leaves' area that is seen along a way: half of it where they stand in all
            // directions.
            let whole = area_m2(&leaves);
            let facing = |way: Vec3| {
                let seen = |[a, b, c]: &[Vec3; 3]| 0.5 * (*b - *a).cross(*c - *a).dot(way).abs();
                leaves.iter().map(seen).sum::<f32>() / whole
            };
            assert!((0.42..0.65).contains(&facing(Vec3::X)), "{}: {}", species.name, facing(Vec3::X));
            let mut draws = Draws::new(7, 99);
            let (rays, steps) = (2000, 160);
            let (mut passed, mut expected) = (0, 0.0);
            for _ in 0..rays {
                // Level and slanting rays by a place in the crown.
                let z = draws.uniform(crown.base_m, crown.top_m);
                let way = draws.direction() * Vec3::new(1.0, 1.0, 0.4);
                let way = way.normalize_or(Vec3::X);
                let reach = crown.share(z) * 0.8;
                let place = Vec3::new(
                    draws.uniform(-reach, reach) * crown.half_m.x,
                    draws.uniform(-reach, reach) * crown.half_m.y,
                    z,
                );
                let origin = place - way * 2.0 * size.max_element();
                let whole = 4.0 * size.max_element();
                let inside =
                    |i: i32| crown.out(origin + way * (whole * (i as f32 + 0.5) / steps as f32)) <= edge;
                let chord = (0..steps).filter(|i| inside(*i)).count() as f32 / steps as f32 * whole;
                expected += frames::math::f32::exp(-facing(way) * density * chord);
                passed += i32::from(!leaves.iter().any(|leaf| meets(origin, way, leaf)));
            }
            let (passed, expected) = (passed as f32 / rays as f32, expected / rays as f32);
            let name = species.name;
            if (passed - expected).abs() >= 0.05 {
                wrong.push(format!("{name} at level {level}: {passed:.3} where {expected:.3} is due"));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn levels_keep_the_area_of_leaves_and_cost_less_and_less() {
    for species in &SPECIES {
        let size = grown(species);
        let made = plant("tree", species.name, size, 2).expect("is one");
        let wanted = Crown::new(species, size).area_m2();
        let near = area_m2(&leaves(&made.pieces[0].mesh));
        assert!((near / wanted - 1.0).abs() < 0.25, "{}: {near} of {wanted} m2", species.name);
        let mut last = made.pieces[0].mesh.triangles.len();
        assert!(last < 13_000, "{}: {last}", species.name);
        for (number, level) in made.coarser.iter().enumerate() {
            let mesh = &level.pieces[0].mesh;
            if number < 2 {
                let area = area_m2(&leaves(mesh));
                assert!((area / near - 1.0).abs() < 0.15, "{}: {area} of {near} m2", species.name);
            }
            assert!(mesh.triangles.len() < last, "{}: {} of {last}", species.name, mesh.triangles.len());
            last = mesh.triangles.len();
        }
        assert!(last < 260, "{}: {last}", species.name);
    }
}

#[test]
fn stems_are_clear_where_people_walk_and_lorries_drive() {
    for kind in land::scenery::TREES {
        let name = kind.model.trim_start_matches("tree.");
        let Some(species) = Species::named(name).filter(|species| species.is_pruned()) else { continue };
        for age in 0..3 {
            let size = Vec3::from_array(kind.size_m(age, 0).map(|v| v as f32));
            let made = plant("tree", name, size, 0).expect("is one");
            let lowest = leaves(&made.pieces[0].mesh).iter().flatten().fold(f32::INFINITY, |z, p| z.min(p.z));
            let clear: f32 = if size.z > 8.5 { 4.0 } else { 1.9 };
            assert!(lowest > clear.min(0.5 * size.z), "{} of age {age}: leaves at {lowest} m", species.name);
        }
    }
}
