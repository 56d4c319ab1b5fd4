//! Bushes and hedges: leaves round a body that no light passes.

use glam::Vec3;
use schema::Tag;
use schema::geometry::{MeshPart, Surface, TriMesh};

use super::leaves::{Draws, Leaf, prepare, reserve};
use super::levels::into_levels;
use crate::actors::ActorMesh;
use crate::solids::MeshBuilder;

/// From where on the coarser levels are there, metres.
const FROM_M: [f64; 2] = [18.0, 40.0];
/// Sides of squares of leaves at the finer levels, metres.
const SIDES_M: [f32; 2] = [0.13, 0.24];
/// Area of leaves over that of the body they stand on.
const COVER: f32 = 1.5;
/// The body's size, as a share of the plant's.
const BODY: f32 = 0.86;

fn greens(draws: &mut Draws) -> [MeshPart; 3] {
    let greens: [[f32; 3]; 4] =
        [[0.08, 0.141, 0.06], [0.109, 0.171, 0.075], [0.062, 0.113, 0.055], [0.12, 0.154, 0.072]];
    let rgb = greens[draws.pick(4)];
    [0.6, 1.0, 1.25].map(|shade| MeshPart::new(Tag::Vegetation, Surface::Foliage, rgb.map(|c| shade * c)))
}

/// A body with leaves around it, by levels. `body` makes it in a share of its size; `surface` gives a place
/// on it and the way out there, by two numbers from 0 to 1. Nothing reaches beyond `ends_m` along x.
fn with_leaves(
    body: impl Fn(f32, MeshPart) -> TriMesh,
    surface: impl Fn([f32; 2]) -> (Vec3, Vec3),
    (area_m2, ends_m): (f32, f32),
    (size, variant): (Vec3, u32),
) -> ActorMesh {
    let mut draws = Draws::new(variant, 2);
    let greens = greens(&mut draws);
    let open = |p: Vec3| 0.45 + 0.55 * (p.z / size.z).clamp(0.0, 1.0);
    let mut meshes = Vec::new();
    for side_m in SIDES_M {
        let mut mesh = body(BODY, greens[0]);
        prepare(&mut mesh, |p| 0.6 * open(p));
        let [_, middle, light] = greens.map(|green| mesh.part_index(green));
        let shades = [middle, middle, light];
        let count = (COVER * area_m2 / (side_m * side_m)).clamp(30.0, 3000.0) as usize;
        let mut draws = Draws::new(variant, 3);
        reserve(&mut mesh, 2 * count);
        for _ in 0..count {
            let (place, outward) = surface([draws.unit(), draws.unit()]);
            let centre = place + draws.around() * (0.3 * side_m) + outward * (0.2 * side_m);
            let open = open(centre);
            let off = draws.direction() * (0.65 * side_m);
            for off in [off, -off] {
                let way = outward * 0.7 + Vec3::Z * 0.3;
                Leaf::any(centre + off, [way, outward], open, &mut draws).add(&mut mesh, shades, side_m, 1.6);
            }
        }
        // What would reach into the ground lies on it.
        mesh.positions.iter_mut().for_each(|p| *p = Vec3::new(p.x.clamp(-ends_m, ends_m), p.y, p.z.max(0.0)));
        meshes.push(mesh);
    }
    meshes.push(body(1.0, greens[1]));
    into_levels(meshes, size, FROM_M)
}

/// A round bush.
pub(super) fn bush(size: Vec3, variant: u32) -> ActorMesh {
    let half = 0.5 * size;
    let (centre, radii) = (Vec3::Z * 0.45 * size.z, Vec3::new(half.x, half.y, 0.55 * size.z));
    let body = |share: f32, green: MeshPart| {
        let mut bumps = Draws::new(variant, 4);
        let bumps: Vec<f32> = (0..80).map(|_| bumps.uniform(0.88, 1.06)).collect();
        let mut b = MeshBuilder::new();
        b.blob(green, centre, radii * share, 6, 9, |ring, side| bumps[(9 * ring + side) % 80]);
        b.reshape(|p| Vec3::new(p.x, p.y, p.z.max(0.0)));
        b.finish()
    };
    let surface = |[u, v]: [f32; 2]| {
        // The part above the ground, by height.
        let z = -0.75 + 1.75 * u;
        let (sin, cos) = frames::math::f32::sin_cos(std::f32::consts::TAU * v);
        let level = (1.0 - z * z).max(0.0).sqrt();
        let way = Vec3::new(cos * level, sin * level, z);
        (centre + 0.93 * radii * way, (way / radii).normalize_or(Vec3::Z))
    };
    let area_m2 = std::f32::consts::PI * (half.x + half.y) * (half.x + half.y) * 0.85;
    with_leaves(body, surface, (area_m2, f32::INFINITY), (size, variant))
}

/// A hedge that is cut square.
pub(super) fn hedge(size: Vec3, variant: u32) -> ActorMesh {
    let half = 0.5 * size;
    let body = |share: f32, green: MeshPart| {
        let inset = 0.5 * (1.0 - share) * size.y.min(size.z);
        // Leaves stand before the ends, too.
        let [x, y] = [(half.x - 0.04).max(0.9 * half.x), half.y - inset];
        let mut b = MeshBuilder::new();
        b.tapered(green, Vec3::new(-x, -y, 0.0), Vec3::new(x, y, size.z - inset), 0.99, 0.93);
        b.finish()
    };
    // Both sides and the top, by their areas, and the ends: other hedges may stand there, or none.
    let around = 2.0 * size.z + size.y;
    let (sides, ends) = (around * size.x, 2.0 * size.y * size.z);
    let surface = |[u, v]: [f32; 2]| {
        let u = u * (sides + ends) / sides;
        if u > 1.0 {
            let way = if v < 0.5 { -1.0 } else { 1.0 };
            let z = (u - 1.0) * sides / ends;
            let y = (4.0 * v + if v < 0.5 { -1.0 } else { -3.0 }) * half.y * 0.95;
            return (Vec3::new(way * half.x * 0.985, y, z * size.z), Vec3::X * way);
        }
        let x = (2.0 * v - 1.0) * half.x * 0.995;
        let along = u * around;
        let y = half.y * 0.95;
        if along < size.z {
            (Vec3::new(x, -y, along), -Vec3::Y)
        } else if along < 2.0 * size.z {
            (Vec3::new(x, y, along - size.z), Vec3::Y)
        } else {
            (Vec3::new(x, (along - 2.0 * size.z) - half.y, size.z * 0.97), Vec3::Z)
        }
    };
    // A row of them has no gaps.
    with_leaves(body, surface, (sides + ends, half.x), (size, variant))
}
