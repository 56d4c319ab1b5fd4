//! Palms: fronds round the top of a bare stem.

use frames::math::f32::sin_cos;
use glam::Vec3;
use schema::geometry::{MeshPart, Surface, TriMesh};
use schema::{Normal, Tag};

use super::leaves::{Draws, prepare, push, share};
use super::levels::{FROM_M, LEVELS, into_levels};
use crate::actors::ActorMesh;
use crate::solids::{MeshBuilder, circle};

const BARK: MeshPart = MeshPart::new(Tag::Vegetation, Surface::Wood, [0.2, 0.16, 0.12]);
const GREEN: MeshPart = MeshPart::new(Tag::Vegetation, Surface::Foliage, [0.105, 0.152, 0.071]);
/// Fronds, pieces of each and leaflets on each side of it, by level.
const FRONDS: [[usize; 3]; LEVELS] = [[30, 5, 16], [26, 4, 8], [20, 3, 4], [16, 2, 3], [12, 2, 2]];

/// Adds a leaflet or a part of a blade, lit as it lies.
fn add_blade(mesh: &mut TriMesh, part: u8, [a, b, c]: [Vec3; 3]) {
    let normal = (b - a).cross(c - a).normalize_or(Vec3::Z);
    push(mesh, part, [a, b, c], [Normal::new(normal); 3], [share(0.92); 3]);
}

/// A palm; it fills its box.
pub(super) fn palm(size: Vec3, variant: u32) -> ActorMesh {
    let half = 0.5 * size;
    let crown = Vec3::Z * 0.84 * size.z;
    let foot = 0.012 * size.z + 0.05;
    let meshes = FRONDS.iter().enumerate().map(|(level, &[fronds, pieces, leaflets])| {
        let mut b = MeshBuilder::new();
        b.bar(BARK, Vec3::ZERO, crown, [1.15 * foot, 0.8 * foot], [9, 7, 5, 4, 4][level]);
        let mut mesh = b.finish();
        prepare(&mut mesh, |_| 0.9);
        let part = mesh.part_index(GREEN);
        for (i, (c, s)) in circle(fronds).enumerate() {
            // All levels draw the same for a frond that they share.
            let mut draws = Draws::new(variant, 40 + i as u64);
            let turn = draws.uniform(-0.15, 0.15);
            let out = Vec3::new(c - turn * s, s + turn * c, 0.0) * half;
            let rise = size.z * draws.uniform(-0.03, 0.16);
            let reach = draws.uniform(0.85, 1.0);
            let at = |t: f32| {
                let (sin, _) = sin_cos(2.4 * t);
                crown + out * (t * reach) + Vec3::Z * (rise * sin - 0.1 * size.z * t * t)
            };
            let across = Vec3::new(-out.y, out.x, 0.0).normalize_or(Vec3::Y);
            let long = 0.16 * size.x;
            for k in 0..leaflets {
                let t = 0.12 + 0.88 * (k as f32 + 0.5) / leaflets as f32;
                let (from, to) = (at(t - 0.5 / leaflets as f32), at(t + 0.4 / leaflets as f32));
                let (taper, _) = sin_cos(0.35 + 2.5 * t);
                for side in [1.0, -1.0] {
                    let tip = 0.5 * (from + to) + across * (side * long * taper) + (to - from) * 1.6
                        - Vec3::Z * 0.35 * long * taper;
                    let corners = if side > 0.0 { [from, to, tip] } else { [from, tip, to] };
                    // Facing up.
                    let [a, b, c] = corners;
                    let is_up = (b - a).cross(c - a).z >= 0.0;
                    add_blade(&mut mesh, part, if is_up { corners } else { [a, c, b] });
                }
            }
            for k in 0..pieces {
                let (from, to) = (at(k as f32 / pieces as f32), at((k + 1) as f32 / pieces as f32));
                let wide = across * 0.02 * size.x;
                add_blade(&mut mesh, part, [from - wide, to, from + wide]);
            }
        }
        mesh
    });
    into_levels(meshes.collect(), size, FROM_M)
}
