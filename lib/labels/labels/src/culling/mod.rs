//! Facts of a scene's meshes, computed once and used for culling in every frame.

use std::sync::Arc;

use frames::Aabb;
use glam::{Affine3A, Vec3A};
use schema::geometry::TriMesh;

/// What culling needs to know of a mesh.
#[derive(Clone, Copy, Debug)]
pub struct MeshFacts {
    /// Middle of its bounding box, object frame.
    centre: Vec3A,
    /// Half the box's extents; negative for a mesh without vertices.
    half: Vec3A,
    /// Bit `n` is set when a part has tag `n`.
    pub tags: u32,
}

impl MeshFacts {
    /// Works out the facts of a mesh.
    #[must_use]
    pub fn of(mesh: &TriMesh) -> Self {
        let bounds = mesh.aabb();
        let tags = mesh.parts.iter().fold(0, |bits, part| bits | 1 << part.tag as u32);
        if bounds.is_empty() {
            return Self { centre: Vec3A::ZERO, half: Vec3A::splat(-1.0), tags: 0 };
        }
        let (min, max) = (Vec3A::from(bounds.min), Vec3A::from(bounds.max));
        Self { centre: 0.5 * (min + max), half: 0.5 * (max - min), tags }
    }

    /// The box around the mesh's own box after an affine map.
    pub fn bounds(&self, to: &Affine3A) -> Aabb {
        if self.half.x < 0.0 {
            return Aabb::EMPTY;
        }
        let centre = to.transform_point3a(self.centre);
        let m = &to.matrix3;
        let half = m.x_axis.abs() * self.half.x + m.y_axis.abs() * self.half.y + m.z_axis.abs() * self.half.z;
        Aabb { min: (centre - half).into(), max: (centre + half).into() }
    }

    /// Middle of the bottom face of the mesh's box, object frame.
    pub fn bottom(&self) -> Vec3A {
        self.centre - Vec3A::Z * self.half.z.max(0.0)
    }

    /// Volume of the mesh's box, cubic metres.
    pub fn volume(&self) -> f32 {
        8.0 * self.half.x * self.half.y * self.half.z
    }
}

/// Remembers the facts of the last scene's meshes.
#[derive(Debug, Default)]
pub struct MeshCache {
    // Holding the meshes keeps their address from being used again for others.
    of: Option<Arc<[Arc<TriMesh>]>>,
    facts: Vec<MeshFacts>,
}

impl MeshCache {
    /// The facts, one per mesh; computed anew only when these are other meshes than last time.
    pub fn facts(&mut self, meshes: &Arc<[Arc<TriMesh>]>) -> &[MeshFacts] {
        if !self.of.as_ref().is_some_and(|known| Arc::ptr_eq(known, meshes)) {
            self.facts = meshes.iter().map(|mesh| MeshFacts::of(mesh)).collect();
            self.of = Some(Arc::clone(meshes));
        }
        &self.facts
    }
}
