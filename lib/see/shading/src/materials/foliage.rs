//! Leaves.

use schema::geometry::{MeshPart, Surface};
use simd::Vec3x8;

use super::pattern::PatternSet;
use super::shaded_triangle::{BrdfSample, Points};

/// Whether a part stands for leaves.
pub(crate) fn is_leaf(part: &MeshPart) -> bool {
    part.surface == Surface::Foliage
}

/// The look of eight points of any leaves, whose triangles look along normals (object frame) and have colours
/// (linear RGB).
#[inline]
pub(crate) fn foliage(
    PatternSet { noise, textures }: PatternSet,
    normals_object: &Vec3x8,
    rgb: &Vec3x8,
    p: &Points,
) -> BrdfSample {
    let (o, w) = (&p.object_m, p.footprint_m);
    // Seen along the axis that the triangle faces most: leaves hide where that changes.
    let [nx, ny, nz] = [normals_object.x.abs(), normals_object.y.abs(), normals_object.z.abs()];
    let (faces_up, faces_x) = (nz.simd_ge(nx.fast_max(ny)), nx.simd_gt(ny));
    let x = faces_up.select(o.x, faces_x.select(o.y, o.x));
    let y = faces_up.select(o.y, o.z);
    let leaves = textures.leaves.at(x, y, w);
    let clump = noise.at_all((o.x - o.z * 0.47) * 9.0, (o.y - o.z * 0.71) * 9.0, w * 9.0);
    let yellow = Vec3x8::new(leaves.tint * 0.7 + 1.0, leaves.tint * 0.25 + 1.0, simd::F32x8::ONE);
    let shade = leaves.shade * (clump * 0.6 + 0.55);
    BrdfSample::leaning(*rgb * shade * yellow, leaves.lean)
}
