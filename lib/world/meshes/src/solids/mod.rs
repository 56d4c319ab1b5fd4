//! Putting meshes together from closed solids: lofts, bars, ellipsoids, boxes, all facing outward.

mod ambient_occlusion;
mod smooth;

use std::f32::consts::TAU;

use frames::Aabb;
use frames::math::f32::sin_cos;
use glam::Vec3;
use schema::geometry::{MeshPart, TriMesh};

pub use ambient_occlusion::{OcclusionEstimate, OrientedPoint, ambient_visibility};
use smooth::smooth;

/// Cosine of the sharpest bend that is round and no edge: round bars of six sides are round.
const CREASE_COS: f32 = 0.49;

/// How fine meshes are: what is farther away is made of fewer triangles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Detail {
    /// Close by.
    #[default]
    Full,
    /// Farther away.
    Half,
    /// Where little is to be seen.
    Coarse,
}

impl Detail {
    /// All, the finest first.
    pub const ALL: [Self; 3] = [Self::Full, Self::Half, Self::Coarse];

    /// Solids whose longest edge is shorter than this are left out, metres.
    #[must_use]
    pub fn least_m(self) -> f32 {
        match self {
            Self::Full => 0.0,
            Self::Half => 0.035,
            Self::Coarse => 0.12,
        }
    }

    /// What is nearer than this to a straight line between its neighbours is left out, metres.
    #[must_use]
    pub fn tolerance_m(self) -> f32 {
        match self {
            Self::Full => 0.0,
            Self::Half => 0.006,
            Self::Coarse => 0.025,
        }
    }

    /// Corners of something round that has `full` of them close by.
    #[must_use]
    pub fn sides(self, full: usize) -> usize {
        match self {
            Self::Full => full,
            Self::Half => full.min(5).max((2 * full).div_ceil(3)),
            Self::Coarse => full.min(4).max(full.div_ceil(2).min(5)),
        }
    }
}

/// A mesh in the making. Solids added to it are closed and face outward.
#[derive(Clone, Debug, Default)]
pub struct MeshBuilder {
    mesh: TriMesh,
    detail: Detail,
}

impl MeshBuilder {
    /// Nothing yet.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Nothing yet; bars and round bodies have as many corners as that is worth, and small ones are left out.
    #[must_use]
    pub fn at(detail: Detail) -> Self {
        Self { detail, ..Self::default() }
    }

    /// How fine it is.
    #[must_use]
    pub fn detail(&self) -> Detail {
        self.detail
    }

    /// Whether a solid that reaches so far along the axes is worth being there.
    fn is_worth(&self, extent_m: Vec3) -> bool {
        extent_m.max_element() >= self.detail.least_m()
    }

    /// Whether nothing was added.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.mesh.triangles.is_empty()
    }

    /// The mesh, round where its triangles turn by less than 60 degrees.
    #[must_use]
    pub fn finish(mut self) -> TriMesh {
        smooth(&mut self.mesh, CREASE_COS);
        self.mesh
    }

    /// The mesh, flat in every triangle.
    #[must_use]
    pub fn finish_flat(self) -> TriMesh {
        self.mesh
    }

    /// The index of a part; equal parts are one.
    pub fn part_index(&mut self, part: MeshPart) -> u8 {
        self.mesh.part_index(part)
    }

    /// Adds a vertex and gives its number.
    pub fn vertex(&mut self, position: Vec3) -> u32 {
        self.mesh.add_vertex(position)
    }

    /// A triangle between vertices; without extent it is left out.
    pub fn triangle(&mut self, part: u8, corners: [u32; 3]) {
        self.mesh.add_triangle(part, corners);
    }

    /// A quad of vertices, counter-clockwise seen from outside.
    pub fn quad(&mut self, part: u8, corners: [u32; 4]) {
        let [a, b, c, d] = corners;
        self.triangle(part, [a, b, c]);
        self.triangle(part, [a, c, d]);
    }

    /// A solid between rings of equally many points: each ring runs counter-clockwise seen against the
    /// direction from the first ring to the last (from the far end looking back). `side(k, j)` names the part
    /// between rings `k` and `k + 1`, from point `j` to the next; `caps` those of the first and last ring.
    pub fn loft(
        &mut self,
        rings: &[Vec<Vec3>],
        side: impl Fn(usize, usize) -> MeshPart,
        caps: [MeshPart; 2],
    ) {
        let Some(n) = rings.first().map(Vec::len) else { return };
        if self.detail > Detail::Full {
            let bounds = Aabb::from_points(rings.iter().flatten());
            if !self.is_worth(bounds.max - bounds.min) {
                return;
            }
        }
        let ids: Vec<Vec<u32>> =
            rings.iter().map(|ring| ring.iter().map(|p| self.vertex(*p)).collect()).collect();
        for (k, pair) in ids.windows(2).enumerate() {
            for j in 0..n {
                let next = (j + 1) % n;
                let part = self.part_index(side(k, j));
                self.quad(part, [pair[0][j], pair[0][next], pair[1][next], pair[1][j]]);
            }
        }
        if let (Some(first), Some(last)) = (ids.first(), ids.last()) {
            let [start, end] = caps.map(|p| self.part_index(p));
            self.cap(start, first, true);
            self.cap(end, last, false);
        }
    }

    fn cap(&mut self, part: u8, ring: &[u32], reversed: bool) {
        for i in 1..ring.len().saturating_sub(1) {
            let (a, b, c) = (ring[0], ring[i], ring[i + 1]);
            self.triangle(part, if reversed { [a, c, b] } else { [a, b, c] });
        }
    }

    /// A box along the axes.
    pub fn cuboid(&mut self, part: MeshPart, min: Vec3, max: Vec3) {
        self.tapered(part, min, max, 1.0, 1.0);
    }

    /// A box whose upper face is smaller by the factors `top_x`, `top_y` (about its middle).
    pub fn tapered(&mut self, part: MeshPart, min: Vec3, max: Vec3, top_x: f32, top_y: f32) {
        let middle = 0.5 * (min + max);
        let ring = |z: f32, fx: f32, fy: f32| -> Vec<Vec3> {
            let (hx, hy) = (0.5 * (max.x - min.x) * fx, 0.5 * (max.y - min.y) * fy);
            [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
                .map(|(x, y)| Vec3::new(middle.x + x * hx, middle.y + y * hy, z))
                .to_vec()
        };
        self.loft(&[ring(min.z, 1.0, 1.0), ring(max.z, top_x, top_y)], |_, _| part, [part; 2]);
    }

    /// A round bar from one point to another with the radii at its ends.
    pub fn bar(&mut self, part: MeshPart, from: Vec3, to: Vec3, radii: [f32; 2], sides: usize) {
        let axis = (to - from).normalize_or(Vec3::Z);
        let helper = if axis.z.abs() < 0.9 { Vec3::Z } else { Vec3::X };
        let u = axis.cross(helper).normalize_or(Vec3::Y);
        let v = axis.cross(u);
        let sides = self.detail.sides(sides);
        let ring = |centre: Vec3, radius: f32| -> Vec<Vec3> {
            circle(sides).map(|(c, s)| centre + radius * (c * u + s * v)).collect()
        };
        self.loft(&[ring(from, radii[0]), ring(to, radii[1])], |_, _| part, [part; 2]);
    }

    /// Horizontal ellipses stacked from bottom to top: `(centre, half x, half y)`.
    pub fn stack(&mut self, part: MeshPart, layers: &[(Vec3, f32, f32)], sides: usize) {
        self.stack_with(|_| part, layers, sides);
    }

    /// The same with a part per layer.
    pub fn stack_with(
        &mut self,
        part: impl Fn(usize) -> MeshPart,
        layers: &[(Vec3, f32, f32)],
        sides: usize,
    ) {
        let rings: Vec<Vec<Vec3>> = layers
            .iter()
            .map(|(centre, rx, ry)| {
                circle(sides).map(|(c, s)| *centre + Vec3::new(c * rx, s * ry, 0.0)).collect()
            })
            .collect();
        let caps = [part(0), part(layers.len().saturating_sub(2))];
        self.loft(&rings, |k, _| part(k), caps);
    }

    /// An ellipsoid of `rings` bands.
    pub fn ellipsoid(&mut self, part: MeshPart, centre: Vec3, half: Vec3, rings: usize, sides: usize) {
        self.blob(part, centre, half, rings, sides, |_, _| 1.0);
    }

    /// An ellipsoid whose radius is scaled by `bump(ring, side)`.
    pub fn blob(
        &mut self,
        part: MeshPart,
        centre: Vec3,
        half: Vec3,
        rings: usize,
        sides: usize,
        bump: impl Fn(usize, usize) -> f32,
    ) {
        if !self.is_worth(2.0 * half) {
            return;
        }
        let (finest, sides) = (rings.max(2), self.detail.sides(sides));
        let rings = if self.detail == Detail::Full { finest } else { self.detail.sides(finest).max(2) };
        let index = self.part_index(part);
        let bottom = self.vertex(centre - Vec3::Z * half.z * bump(0, 0));
        let mut previous: Vec<u32> = Vec::new();
        for ring in 1..rings {
            let (s, c) = sin_cos(0.5 * TAU * ring as f32 / rings as f32);
            let ids: Vec<u32> = circle(sides)
                .enumerate()
                .map(|(j, (x, y))| centre + half * Vec3::new(s * x, s * y, -c) * bump(ring, j))
                .collect::<Vec<_>>()
                .into_iter()
                .map(|p| self.vertex(p))
                .collect();
            for j in 0..sides {
                let next = (j + 1) % sides;
                if ring == 1 {
                    self.triangle(index, [bottom, ids[next], ids[j]]);
                } else {
                    self.quad(index, [previous[j], previous[next], ids[next], ids[j]]);
                }
            }
            previous = ids;
        }
        let top = self.vertex(centre + Vec3::Z * half.z * bump(rings, 0));
        for j in 0..sides {
            self.triangle(index, [top, previous[j], previous[(j + 1) % sides]]);
        }
    }

    /// Moves every point.
    pub fn reshape(&mut self, to: impl Fn(Vec3) -> Vec3) {
        self.mesh.positions.iter_mut().for_each(|p| *p = to(*p));
    }

    /// Stretches everything along the axes so that it fills the box from `min` to `max` exactly, and says
    /// how.
    pub fn fit(&mut self, min: Vec3, max: Vec3) -> Fit {
        let bounds = self.mesh.aabb();
        if bounds.is_empty() {
            return Fit { from: min, scale: Vec3::ONE, min };
        }
        let extent = (bounds.max - bounds.min).max(Vec3::splat(1e-6));
        let fit = Fit { from: bounds.min, scale: (max - min) / extent, min };
        for p in &mut self.mesh.positions {
            // The clamp takes back the rounding of the product.
            *p = fit.apply(*p).clamp(min, max);
        }
        fit
    }

    /// A tube: its profile of `(radius, height)` turned about the vertical through `centre`; the profile is
    /// closed and runs counter-clockwise with the radius to the right and the height upward.
    pub fn lathe(&mut self, part: MeshPart, centre: Vec3, profile: &[(f32, f32)], sides: usize) {
        let index = self.part_index(part);
        let rings: Vec<Vec<u32>> = profile
            .iter()
            .map(|(r, z)| {
                circle(sides).map(|(c, s)| centre + Vec3::new(r * c, r * s, *z)).collect::<Vec<_>>()
            })
            .map(|ring| ring.into_iter().map(|p| self.vertex(p)).collect())
            .collect();
        for (k, from) in rings.iter().enumerate() {
            let to = &rings[(k + 1) % rings.len()];
            for j in 0..sides {
                let n = (j + 1) % sides;
                self.quad(index, [from[j], from[n], to[n], to[j]]);
            }
        }
    }

    /// Turns everything so that what stood upright along z lies along x.
    pub fn lay_down(&mut self) {
        for p in &mut self.mesh.positions {
            *p = Vec3::new(p.z, p.y, -p.x);
        }
    }
}

/// How [`MeshBuilder::fit`] stretched a mesh.
#[derive(Clone, Copy, Debug)]
pub struct Fit {
    from: Vec3,
    scale: Vec3,
    min: Vec3,
}

impl Fit {
    /// Where a point of the mesh went to.
    pub fn apply(&self, p: Vec3) -> Vec3 {
        self.min + (p - self.from) * self.scale
    }
}

/// Cosine and sine of the corners of a regular polygon.
pub fn circle(sides: usize) -> impl Iterator<Item = (f32, f32)> {
    (0..sides).map(move |j| {
        let (s, c) = sin_cos(TAU * j as f32 / sides as f32);
        (c, s)
    })
}

/// The value of a chain of `(x, y)` points, ascending in x, at some x; constant beyond its ends.
pub fn chain_at(chain: &[(f32, f32)], x: f32) -> f32 {
    let Some(first) = chain.first() else { return 0.0 };
    if x <= first.0 {
        return first.1;
    }
    for pair in chain.windows(2) {
        let ((x0, y0), (x1, y1)) = (pair[0], pair[1]);
        if x <= x1 {
            return if x1 > x0 { y0 + (y1 - y0) * (x - x0) / (x1 - x0) } else { y1 };
        }
    }
    chain[chain.len() - 1].1
}

/// The value of a smooth curve through `(x, y)` points, ascending in x, at some x: between neighbours it
/// neither overshoots nor turns back (cubic Hermite pieces with the harmonic mean of both slopes, after
/// Fritsch and Butland); constant beyond its ends.
pub fn curve_at(points: &[(f32, f32)], x: f32) -> f32 {
    let last = points.len().saturating_sub(1);
    let Some(i) = points.windows(2).position(|pair| x <= pair[1].0) else { return chain_at(points, x) };
    let ((x0, y0), (x1, y1)) = (points[i], points[i + 1]);
    if x <= x0 || x1 <= x0 {
        return chain_at(points, x);
    }
    let slope = |k: usize| (points[k + 1].1 - points[k].1) / (points[k + 1].0 - points[k].0).max(1e-9);
    let tangent = |k: usize| {
        let (before, after) = (slope(k.saturating_sub(1)), slope(k.min(last - 1)));
        if before * after <= 0.0 { 0.0 } else { 2.0 * before * after / (before + after) }
    };
    let (width, t) = (x1 - x0, (x - x0) / (x1 - x0));
    let (t2, t3) = (t * t, t * t * t);
    (2.0 * t3 - 3.0 * t2 + 1.0) * y0
        + (t3 - 2.0 * t2 + t) * width * tangent(i)
        + (3.0 * t2 - 2.0 * t3) * y1
        + (t3 - t2) * width * tangent(i + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curves_go_through_their_points_and_never_overshoot() {
        let points = [(0.0, 0.4), (0.2, 0.5), (0.3, 0.52), (0.45, 0.95), (0.6, 1.0), (0.8, 0.9), (1.0, 0.6)];
        for (x, y) in points {
            assert!((curve_at(&points, x) - y).abs() < 1e-6, "{x}");
        }
        for pair in points.windows(2) {
            let ((x0, y0), (x1, y1)) = (pair[0], pair[1]);
            for k in 0..=20 {
                let y = curve_at(&points, x0 + (x1 - x0) * k as f32 / 20.0);
                assert!(y >= y0.min(y1) - 1e-6 && y <= y0.max(y1) + 1e-6, "{y} between {y0} and {y1}");
            }
        }
        // A straight line stays one, and slopes on both sides of a point agree.
        assert!((curve_at(&[(0.0, 1.0), (1.0, 3.0), (2.0, 5.0)], 0.3) - 1.6).abs() < 1e-6);
        let slope = |x: f32| (curve_at(&points, x + 1e-4) - curve_at(&points, x - 1e-4)) / 2e-4;
        assert!((slope(0.3 - 2e-4) - slope(0.3 + 2e-4)).abs() < 0.1);
        assert_eq!([curve_at(&points, -1.0), curve_at(&points, 2.0), curve_at(&[], 0.5)], [0.4, 0.6, 0.0]);
    }
}
