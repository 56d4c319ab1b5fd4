//! Small meshes, and snapshots of them.

use std::collections::BTreeMap;
use std::f32::consts::{PI, TAU};
use std::sync::Arc;

use frames::LocalOrigin;
use frames::math::f32::sin_cos;
use glam::{Affine3A, Vec3};
use schema::geometry::{Instance, MeshPart, ObjectMotion, Snapshot, Surface, TriMesh};
use schema::{ObjectId, Tag};

/// Collects triangles part by part.
#[derive(Clone, Debug, Default)]
pub struct MeshBuilder {
    mesh: TriMesh,
}

impl MeshBuilder {
    /// Adds a part and gives its number.
    pub fn part(&mut self, tag: Tag, surface: Surface, rgb: [f32; 3]) -> u8 {
        self.mesh.parts.push(MeshPart { tag, surface, rgb });
        (self.mesh.parts.len() - 1) as u8
    }

    /// A quadrilateral, corners counter-clockwise from outside.
    pub fn quad(&mut self, part: u8, corners: [Vec3; 4]) {
        let first = self.mesh.positions.len() as u32;
        self.mesh.positions.extend(corners);
        self.mesh.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
        self.mesh.triangle_part.extend([part, part]);
    }

    /// A box whose top may be smaller and shifted; `[x0, x1, y0, y1]` below and above.
    pub fn frustum(&mut self, part: u8, bottom: [f32; 4], z0: f32, top: [f32; 4], z1: f32) {
        let ring = |[x0, x1, y0, y1]: [f32; 4], z: f32| {
            [Vec3::new(x0, y0, z), Vec3::new(x1, y0, z), Vec3::new(x1, y1, z), Vec3::new(x0, y1, z)]
        };
        let (b, t) = (ring(bottom, z0), ring(top, z1));
        for i in 0..4 {
            let j = (i + 1) % 4;
            self.quad(part, [b[i], b[j], t[j], t[i]]);
        }
        self.quad(part, t);
        self.quad(part, [b[3], b[2], b[1], b[0]]);
    }

    /// A box along the axes.
    pub fn cuboid(&mut self, part: u8, min: [f32; 3], max: [f32; 3]) {
        let sides = [min[0], max[0], min[1], max[1]];
        self.frustum(part, sides, min[2], sides, max[2]);
    }

    /// A ball, or an egg.
    pub fn ball(&mut self, part: u8, centre: Vec3, radius: Vec3, rings: u32) {
        let at = |i: u32, j: u32| {
            let (s, c) = sin_cos(PI * i as f32 / rings as f32);
            let (sa, ca) = sin_cos(PI * j as f32 / rings as f32);
            centre + radius * Vec3::new(s * ca, s * sa, c)
        };
        for i in 0..rings {
            for j in 0..2 * rings {
                self.quad(part, [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
            }
        }
    }

    /// A wheel: a disc with its axle along y.
    pub fn wheel(&mut self, part: u8, centre: Vec3, radius: f32, width: f32) {
        let n = 14;
        let at = |i: u32, y: f32| {
            let (s, c) = sin_cos(TAU * i as f32 / n as f32);
            centre + Vec3::new(radius * c, y, radius * s)
        };
        for i in 0..n {
            let (l, r) = (-0.5 * width, 0.5 * width);
            self.quad(part, [at(i, l), at(i + 1, l), at(i + 1, r), at(i, r)]);
            for y in [l, r] {
                self.quad(part, [centre + Vec3::Y * y, at(i, y), at(i + 1, y), centre + Vec3::Y * y]);
            }
        }
    }

    /// The mesh.
    #[must_use]
    pub fn finish(self) -> Arc<TriMesh> {
        Arc::new(self.mesh)
    }
}

/// A flat square around the origin at a height, metres.
#[must_use]
pub fn plane(half_m: f32, z: f32, tag: Tag, surface: Surface) -> Arc<TriMesh> {
    let mut b = MeshBuilder::default();
    let part = b.part(tag, surface, [0.1; 3]);
    let h = half_m;
    b.quad(part, [Vec3::new(-h, -h, z), Vec3::new(h, -h, z), Vec3::new(h, h, z), Vec3::new(-h, h, z)]);
    b.finish()
}

/// A box of one surface that stands on the origin; length, width, height in metres.
#[must_use]
pub fn block(size: [f32; 3], tag: Tag, surface: Surface) -> Arc<TriMesh> {
    let mut b = MeshBuilder::default();
    let part = b.part(tag, surface, [0.4; 3]);
    b.cuboid(part, [-0.5 * size[0], -0.5 * size[1], 0.0], [0.5 * size[0], 0.5 * size[1], size[2]]);
    b.finish()
}

/// A mesh in a place where it also was one frame before, grey and without lights.
#[must_use]
pub fn instance(mesh: u32, object: ObjectId, local_from_object: Affine3A) -> Instance {
    Instance {
        mesh,
        object,
        local_from_object,
        previous_local_from_object: local_from_object,
        paint: [0.5; 3],
        lights: 0,
        glow: [1.0; 3],
    }
}

/// The world around the world's origin; an object moves as its first instance does.
#[must_use]
pub fn snapshot(meshes: Vec<Arc<TriMesh>>, instances: Vec<Instance>) -> Snapshot {
    let motions = motions(&instances);
    Snapshot {
        origin: LocalOrigin::near([0.0; 3]),
        meshes: meshes.into(),
        instances,
        cabins: Vec::new(),
        motions,
    }
}

fn motions(instances: &[Instance]) -> Vec<ObjectMotion> {
    let bodies: BTreeMap<ObjectId, &Instance> = instances.iter().rev().map(|i| (i.object, i)).collect();
    let motion = |(object, body): (ObjectId, &Instance)| ObjectMotion {
        object,
        local_from_object: body.local_from_object,
        previous_local_from_object: body.previous_local_from_object,
    };
    bodies.into_iter().map(motion).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Six times the volume that a closed mesh holds.
    fn six_volumes(mesh: &TriMesh) -> f32 {
        let corners = (0..mesh.triangles.len()).map(|i| mesh.corners(i));
        corners.map(|[a, b, c]| a.dot(b.cross(c))).sum()
    }

    #[test]
    fn solids_are_closed_and_face_outward() {
        let size = [2.0, 3.0, 4.0];
        let block = block(size, Tag::Building, Surface::Plain);
        assert_eq!(
            (block.aabb().min, block.aabb().max),
            (Vec3::new(-1.0, -1.5, 0.0), Vec3::new(1.0, 1.5, 4.0))
        );
        assert!((six_volumes(&block) - 6.0 * 24.0).abs() < 1e-3);
        let mut b = MeshBuilder::default();
        let part = b.part(Tag::Vegetation, Surface::Foliage, [0.5; 3]);
        b.ball(part, Vec3::new(5.0, 0.0, 0.0), Vec3::splat(1.0), 40);
        let ball = 4.0 / 3.0 * PI;
        assert!((six_volumes(&b.finish()) / 6.0 - ball).abs() < 0.02 * ball);
    }
}
