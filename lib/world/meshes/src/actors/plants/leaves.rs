//! Leaves as triangles, and the light in a crown.

use frames::math::f32::sin_cos;
use glam::Vec3;
use random::Stream;
use schema::Normal;
use schema::geometry::TriMesh;

/// The leaves of a twig: two triangles stand for them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cluster {
    pub(super) centre: Vec3,
    /// The way that the twig grows (unit).
    pub(super) along: Vec3,
    /// The side of a square of the same area, metres.
    pub(super) side_m: f32,
    /// How much longer than wide its leaves are.
    pub(super) longer: f32,
    /// How far the leaves stand off the twig's way: 0 not at all, 1 by 45 degrees and more.
    pub(super) loose: f32,
    /// The way out of the crown there (unit).
    pub(super) outward: Vec3,
    /// What of the light of sky and ground gets there, 0 to 1.
    pub(super) open: f32,
}

/// Numbers of a plant.
pub(super) struct Draws(Stream);

impl Draws {
    pub(super) fn new(variant: u32, what: u64) -> Self {
        Self(Stream::new(u64::from(variant), 0, "world/plant", what))
    }

    /// Between 0 and 1.
    pub(super) fn unit(&mut self) -> f32 {
        self.0.unit() as f32
    }

    pub(super) fn uniform(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.unit()
    }

    /// Any direction (unit), all alike.
    pub(super) fn direction(&mut self) -> Vec3 {
        let z = self.uniform(-1.0, 1.0);
        let (sin, cos) = sin_cos(self.uniform(0.0, std::f32::consts::TAU));
        let level = (1.0 - z * z).max(0.0).sqrt();
        Vec3::new(level * cos, level * sin, z)
    }

    /// About normal in each direction, with a deviation of one.
    pub(super) fn around(&mut self) -> Vec3 {
        let mut one = || 2.0 * (self.unit() + self.unit() + self.unit() - 1.5);
        Vec3::new(one(), one(), one())
    }
}

/// How far apart the two leaves of a cluster are, as a share of its side.
const APART: f32 = 1.35;

/// Adds two leaves, which are triangles. Those of a crown are lit as its surface is, not each by itself: real
/// leaves stand in all directions.
pub(super) fn add_cluster(mesh: &mut TriMesh, part: u8, cluster: &Cluster, draws: &mut Draws) {
    let long = cluster.longer.sqrt() * cluster.side_m;
    let wide = long / cluster.longer;
    for _ in 0..2 {
        let centre = cluster.centre + draws.direction() * (APART * cluster.side_m);
        let along = (cluster.along + draws.direction() * cluster.loose).normalize_or(cluster.along);
        // The face looks out of the crown, more or less.
        let facing = cluster.outward * 0.45 + Vec3::Z * 0.2 + draws.direction();
        let across = along.cross(facing).normalize_or(along.any_orthonormal_vector());
        let face = across.cross(along);
        let foot = centre - along * (0.4 * long);
        let corners =
            [foot - across * (0.5 * wide), foot + across * (0.5 * wide), centre + along * (0.6 * long)];
        let normal = (cluster.outward * 0.7 + face * 0.45).normalize_or(face);
        let tip = (cluster.outward * 0.7 + face * 0.45 + along * 0.25).normalize_or(face);
        add_leaf(mesh, part, corners, [normal, normal, tip], cluster.open);
    }
}

/// Adds a triangle with its normals for light, and what light gets there.
pub(super) fn add_leaf(mesh: &mut TriMesh, part: u8, corners: [Vec3; 3], normals: [Vec3; 3], open: f32) {
    let before = mesh.triangles.len();
    let corners = corners.map(|corner| mesh.add_vertex(corner));
    mesh.add_triangle(part, corners);
    if mesh.triangles.len() > before {
        mesh.corner_normals.push(normals.map(Normal::new));
        mesh.corner_visibility.push([(open.clamp(0.0, 1.0) * 255.0 + 0.5) as u8; 3]);
    }
}

/// Gives what is there the light that an open place has, and normals where it has none, so that leaves can be
/// added.
pub(super) fn prepare(mesh: &mut TriMesh, open: impl Fn(Vec3) -> f32) {
    if mesh.corner_normals.is_empty() {
        let flat = |t: usize| {
            let [a, b, c] = mesh.corners(t);
            [Normal::new((b - a).cross(c - a).normalize_or(Vec3::Z)); 3]
        };
        mesh.corner_normals = (0..mesh.triangles.len()).map(flat).collect();
    }
    let shares = |t: usize| mesh.corners(t).map(|p| (open(p).clamp(0.0, 1.0) * 255.0 + 0.5) as u8);
    mesh.corner_visibility = (0..mesh.triangles.len()).map(shares).collect();
}
