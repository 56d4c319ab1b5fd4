//! Leaves as triangles, and the light on them.

use glam::Vec3;
use random::{Stream, unit_f32};
use schema::Normal;
use schema::geometry::TriMesh;

/// So many blocks of numbers are drawn at once.
const BLOCKS: usize = 16;

/// Numbers of a plant.
pub(super) struct Draws {
    stream: Stream,
    words: [[u32; BLOCKS]; 4],
    used: usize,
    next: u64,
}

impl Draws {
    pub(super) fn new(variant: u32, what: u64) -> Self {
        let stream = Stream::new(u64::from(variant), 0, "world/plant", what);
        Self { stream, words: [[0; BLOCKS]; 4], used: 4 * BLOCKS, next: 0 }
    }

    fn word(&mut self) -> u32 {
        if self.used == 4 * BLOCKS {
            self.words = self.stream.run_at(self.next);
            self.next += BLOCKS as u64;
            self.used = 0;
        }
        let word = self.words[self.used / BLOCKS][self.used % BLOCKS];
        self.used += 1;
        word
    }

    /// Between 0 and 1.
    pub(super) fn unit(&mut self) -> f32 {
        unit_f32(self.word())
    }

    pub(super) fn uniform(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.unit()
    }

    /// One of so many.
    pub(super) fn pick(&mut self, count: usize) -> usize {
        ((u64::from(self.word()) * count as u64) >> 32) as usize
    }

    /// A place in the unit disc, all alike, and the square of its distance from the middle.
    pub(super) fn disc(&mut self) -> ([f32; 2], f32) {
        loop {
            let word = self.word();
            let [x, y] = [word & 0xffff, word >> 16].map(|half| (half as f32 + 0.5) / 32_768.0 - 1.0);
            let square = x * x + y * y;
            if square < 1.0 {
                return ([x, y], square);
            }
        }
    }

    /// Any direction (unit), all alike (Marsaglia 1972).
    pub(super) fn direction(&mut self) -> Vec3 {
        let ([x, y], square) = self.disc();
        let level = 2.0 * (1.0 - square).sqrt();
        Vec3::new(level * x, level * y, 1.0 - 2.0 * square)
    }

    /// A way off a place, about as far in each direction as a normal number with a deviation of one.
    pub(super) fn around(&mut self) -> Vec3 {
        let way = self.direction();
        way * (2.4 * self.unit().sqrt())
    }
}

/// A leaf: a triangle that is long along a way and wide across it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Leaf {
    pub(super) centre: Vec3,
    /// From its foot to its tip (unit).
    along: Vec3,
    /// Across it (unit).
    across: Vec3,
    /// For light: at both ends of its foot, and at its tip.
    normals: [Normal; 2],
    /// What of the light of sky and ground gets there, in 255ths.
    open: u8,
    /// Which of the shades of a plant's leaves it has.
    shade: u8,
}

impl Leaf {
    /// A leaf at a place that faces any direction, so that half of its area is seen from wherever one looks.
    /// It grows along a way as far as it can then. It is lit as the surface of the crown is, whose way out is
    /// `outward`, not by itself: real leaves are small and stand in all directions.
    pub(super) fn any(centre: Vec3, [way, outward]: [Vec3; 2], open: f32, draws: &mut Draws) -> Self {
        let face = draws.direction();
        let face = if face.dot(outward) < 0.0 { -face } else { face };
        let shade = draws.pick(3) as u8;
        Self::facing(centre, [way, face, outward], open, shade)
    }

    /// The same that faces some way (unit).
    pub(super) fn facing(centre: Vec3, [way, face, outward]: [Vec3; 3], open: f32, shade: u8) -> Self {
        let along = (way - face * way.dot(face)).normalize_or(face.any_orthonormal_vector());
        let normal = outward * 0.7 + face * 0.45;
        Self {
            centre,
            along,
            across: along.cross(face),
            normals: [Normal::new(normal), Normal::new(normal + along * 0.25)],
            open: share(open),
            shade,
        }
    }

    /// Adds it as large as half a square of some side, `longer` than wide.
    pub(super) fn add(&self, mesh: &mut TriMesh, shades: [u8; 3], side_m: f32, longer: f32) {
        let long = longer.sqrt() * side_m;
        let half_wide = self.across * (0.5 * long / longer);
        let foot = self.centre - self.along * (0.4 * long);
        let [normal, tip] = self.normals;
        let corners = [foot - half_wide, foot + half_wide, self.centre + self.along * (0.6 * long)];
        push(mesh, shades[usize::from(self.shade)], corners, [normal, normal, tip], [self.open; 3]);
    }
}

/// A share as it is kept.
pub(super) fn share(open: f32) -> u8 {
    (open.clamp(0.0, 1.0) * 255.0 + 0.5) as u8
}

/// Makes room for so many loose triangles.
pub(super) fn reserve(mesh: &mut TriMesh, triangles: usize) {
    mesh.positions.reserve(3 * triangles);
    mesh.triangles.reserve(triangles);
    mesh.triangle_part.reserve(triangles);
    mesh.corner_normals.reserve(triangles);
    mesh.corner_visibility.reserve(triangles);
}

/// Adds a triangle that shares no corner, with its normals for light and what light gets to its corners.
pub(super) fn push(mesh: &mut TriMesh, part: u8, corners: [Vec3; 3], normals: [Normal; 3], open: [u8; 3]) {
    let first = mesh.positions.len() as u32;
    mesh.positions.extend_from_slice(&corners);
    mesh.triangles.push([first, first + 1, first + 2]);
    mesh.triangle_part.push(part);
    mesh.corner_normals.push(normals);
    mesh.corner_visibility.push(open);
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
    let shares: Vec<u8> = mesh.positions.iter().map(|p| share(open(*p))).collect();
    mesh.corner_visibility = mesh.triangles.iter().map(|t| t.map(|v| shares[v as usize])).collect();
}
