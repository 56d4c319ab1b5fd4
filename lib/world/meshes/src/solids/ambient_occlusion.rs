//! How much of sky and ground is seen from places on a body that stands on level ground.
//!
//! Along each of a fixed set of axes the body is drawn as seen from either end; places that something covers
//! do not see that way. This is far cheaper than rays, and as exact as a texel is wide.

use std::f32::consts::PI;

use frames::Aabb;
use frames::math::f32::sin_cos;
use glam::{Vec2, Vec3};

/// Least width of a texel, metres.
const LEAST_TEXEL_M: f32 = 0.01;
/// Places are looked at from so far off their surface, texels: a plane does not shade itself, however it
/// leans.
const OFF: f32 = 1.5;
/// What open ground gives, of what the sky gives: as much as matters for what faces down.
const GROUND: f32 = 0.6;
/// Width of the cells by which ground is more or less open, and how far around a body it is told, metres.
const CELL_M: f32 = 0.2;
const AROUND_M: f32 = 1.2;
/// From lower down nothing is looked at: what is deeper is in the ground.
const LEAST_UP_M: f32 = 0.01;

/// How closely it is looked.
#[derive(Clone, Copy, Debug)]
pub struct OcclusionEstimate {
    /// Along a body's diagonal, at most.
    pub texels: u32,
    /// Lines along which it is looked; a place sees one way along each.
    pub axes: usize,
}

/// The upper end of an axis of some: turned by the golden angle from one to the next, at even heights.
fn axis(number: usize, axes: usize) -> Vec3 {
    const GOLDEN_RAD: f32 = PI * (3.0 - 2.236_068);
    let z = 1.0 - (2 * number + 1) as f32 / (2 * axes) as f32;
    let (sin, cos) = sin_cos(GOLDEN_RAD * number as f32);
    let level = (1.0 - z * z).sqrt();
    Vec3::new(level * cos, level * sin, z)
}

/// A place and the way that its surface faces (unit).
pub type OrientedPoint = (Vec3, Vec3);

/// The share of what sky and open ground give that reaches each of some places on a body, 0 to 1. The body is
/// triangles between `positions`, and stands on the ground at z = 0; that is darker where the body is above
/// it.
#[must_use]
pub fn ambient_visibility(
    positions: &[Vec3],
    triangles: &[[u32; 3]],
    places: &[OrientedPoint],
    estimate: OcclusionEstimate,
) -> Vec<f32> {
    let bounds = Aabb::from_points(positions);
    if triangles.is_empty() || !(bounds.max - bounds.min).is_finite() {
        return vec![1.0; places.len()];
    }
    let mut seen = AxisView::new(positions, triangles, bounds, estimate.texels);
    let places: Vec<OrientedPoint> = places
        .iter()
        .map(|&(place, normal)| {
            let mut off = place + normal * (OFF * seen.texel_m);
            off.z = off.z.max(LEAST_UP_M);
            (off, normal)
        })
        .collect();
    let mut ground = Ground::under(bounds);
    let cells = ground.places();
    let (mut got, mut most) = (vec![0.0f32; places.len()], vec![1e-6f32; places.len()]);
    // Which directions see the ground where, and with what weight.
    let mut below: Vec<(u32, f32, Vec2)> = Vec::new();
    for number in 0..estimate.axes {
        let up = axis(number, estimate.axes);
        seen.view_along(up);
        for (open, place) in ground.open.iter_mut().zip(&cells) {
            *open += up.z * seen.from(*place, true);
        }
        for (number, &(place, normal)) in (0u32..).zip(&places) {
            let at = number as usize;
            let facing = normal.dot(up);
            let free = seen.from(place, facing > 0.0);
            if facing > 0.0 {
                most[at] += facing;
                got[at] += facing * free;
            } else {
                let weight = -facing * GROUND;
                most[at] += weight;
                if free > 0.0 {
                    let landing = place - up * (place.z / up.z);
                    below.push((number, weight * free, landing.truncate()));
                }
            }
        }
    }
    ground.finish(estimate.axes);
    for (place, weight, landing) in below {
        got[place as usize] += weight * ground.at(landing);
    }
    got.iter().zip(&most).map(|(got, most)| got / most).collect()
}

/// A body as it is seen from both ends of an axis.
struct AxisView<'a> {
    positions: &'a [Vec3],
    triangles: &'a [[u32; 3]],
    bounds: Aabb,
    texel_m: f32,
    /// Towards the right, up and the upper onlooker; the first two over a texel's width.
    axes: [Vec3; 3],
    /// Of the first texel's corner, in texels.
    corner: Vec2,
    columns: usize,
    rows: usize,
    /// How far toward the upper onlooker the surface is that is farthest from and that is nearest to them, by
    /// texel.
    reach: Vec<[f32; 2]>,
    /// The positions as seen: column, row, and how far toward the upper onlooker.
    shown: Vec<Vec3>,
}

impl<'a> AxisView<'a> {
    fn new(positions: &'a [Vec3], triangles: &'a [[u32; 3]], bounds: Aabb, texels: u32) -> Self {
        let texel_m = ((bounds.max - bounds.min).length() / texels.max(1) as f32).max(LEAST_TEXEL_M);
        Self {
            positions,
            triangles,
            bounds,
            texel_m,
            axes: [Vec3::X, Vec3::Y, Vec3::Z],
            corner: Vec2::ZERO,
            columns: 0,
            rows: 0,
            reach: Vec::new(),
            shown: Vec::new(),
        }
    }

    /// Draws the body as seen from far away in a direction and in the opposite one.
    fn view_along(&mut self, to: Vec3) {
        let right = to.cross(if to.z.abs() < 0.9 { Vec3::Z } else { Vec3::X }).normalize();
        let up = to.cross(right);
        self.axes = [right / self.texel_m, up / self.texel_m, to];
        let (mut least, mut most) = (Vec2::INFINITY, Vec2::NEG_INFINITY);
        for number in 0..8 {
            let pick = |axis: usize, low: f32, high: f32| if number >> axis & 1 == 0 { low } else { high };
            let Aabb { min, max } = self.bounds;
            let corner = Vec3::new(pick(0, min.x, max.x), pick(1, min.y, max.y), pick(2, min.z, max.z));
            let flat = Vec2::new(corner.dot(self.axes[0]), corner.dot(self.axes[1]));
            (least, most) = (least.min(flat), most.max(flat));
        }
        // A texel of air all around.
        self.corner = least - Vec2::splat(1.0);
        let size = (most - self.corner).ceil() + Vec2::splat(1.0);
        (self.columns, self.rows) = (size.x as usize, size.y as usize);
        self.reach.clear();
        self.reach.resize(self.columns * self.rows, [f32::INFINITY, f32::NEG_INFINITY]);
        let mut shown = std::mem::take(&mut self.shown);
        shown.clear();
        shown.extend(self.positions.iter().map(|p| self.place(*p)));
        for [a, b, c] in self.triangles {
            self.draw([shown[*a as usize], shown[*b as usize], shown[*c as usize]]);
        }
        self.shown = shown;
    }

    /// Column and row of a place (texels from the corner), and how far toward the upper onlooker it is,
    /// metres.
    fn place(&self, p: Vec3) -> Vec3 {
        let [right, up, to] = self.axes;
        Vec3::new(p.dot(right) - self.corner.x, p.dot(up) - self.corner.y, p.dot(to))
    }

    /// Draws a triangle, from whichever side it is seen, at the middles of texels.
    fn draw(&mut self, [a, b, c]: [Vec3; 3]) {
        let (ab, ac) = (b - a, c - a);
        let area = ab.x * ac.y - ab.y * ac.x;
        if area.abs() < 1e-6 {
            return;
        }
        // How much nearer it is a column and a row on.
        let per_area = 1.0 / area;
        let across = (ab.z * ac.y - ac.z * ab.y) * per_area;
        let down = (ac.z * ab.x - ab.z * ac.x) * per_area;
        let (least, most) = (a.y.min(b.y).min(c.y), a.y.max(b.y).max(c.y));
        // By edge: where it begins and ends downward, and x by y.
        let edges = [(a, b), (b, c), (c, a)].map(|(p, q)| {
            let (top, end) = if p.y < q.y { (p, q) } else { (q, p) };
            let per_row = if end.y > top.y { (end.x - top.x) / (end.y - top.y) } else { 0.0 };
            (top.y, end.y, top.x, per_row)
        });
        // Texels whose middles are from one number on, and before another.
        let from = |v: f32| (v - 0.5).ceil().max(0.0) as usize;
        for row in from(least)..from(most).min(self.rows) {
            let y = row as f32 + 0.5;
            let (mut left, mut right) = (f32::INFINITY, f32::NEG_INFINITY);
            for (top, end, x, per_row) in edges {
                if top <= y && y < end {
                    let x = x + (y - top) * per_row;
                    (left, right) = (left.min(x), right.max(x));
                }
            }
            let (first, end) = (from(left), from(right).min(self.columns));
            if first >= end {
                continue;
            }
            let start = a.z + (y - a.y) * down + (first as f32 + 0.5 - a.x) * across;
            let texels = &mut self.reach[row * self.columns + first..row * self.columns + end];
            for (i, [least, most]) in texels.iter_mut().enumerate() {
                let here = start + i as f32 * across;
                *least = if here < *least { here } else { *least };
                *most = if here > *most { here } else { *most };
            }
        }
    }

    /// How free the way is from a place up or down the axis: the share of the four texels around it that show
    /// nothing on the way.
    fn from(&self, p: Vec3, up: bool) -> f32 {
        let q = self.place(p);
        let (x, y) = (q.x - 0.5, q.y - 0.5);
        if x < 0.0 || y < 0.0 || x >= (self.columns - 1) as f32 || y >= (self.rows - 1) as f32 {
            return 1.0;
        }
        let (column, row) = (x as usize, y as usize);
        let (fx, fy) = (x - column as f32, y - row as f32);
        let at = row * self.columns + column;
        let free = |i: usize| {
            let [least, most] = self.reach[i];
            let is_free = if up { most <= q.z } else { least >= q.z };
            f32::from(u8::from(is_free))
        };
        let lower = free(at) * (1.0 - fx) + free(at + 1) * fx;
        let upper = free(at + self.columns) * (1.0 - fx) + free(at + self.columns + 1) * fx;
        lower * (1.0 - fy) + upper * fy
    }
}

/// How open the ground under and around a body is.
struct Ground {
    corner: Vec2,
    columns: usize,
    rows: usize,
    open: Vec<f32>,
}

impl Ground {
    fn under(bounds: Aabb) -> Self {
        let corner = bounds.min.truncate() - Vec2::splat(AROUND_M);
        let size = (bounds.max.truncate() + Vec2::splat(AROUND_M) - corner) / CELL_M;
        let (columns, rows) = (size.x.ceil() as usize + 1, size.y.ceil() as usize + 1);
        Self { corner, columns, rows, open: vec![0.0; columns * rows] }
    }

    /// The middles of its cells.
    fn places(&self) -> Vec<Vec3> {
        let cells = 0..self.columns * self.rows;
        let place = |i: usize| {
            let cell = Vec2::new((i % self.columns) as f32, (i / self.columns) as f32);
            (self.corner + cell * CELL_M).extend(LEAST_UP_M)
        };
        cells.map(place).collect()
    }

    /// Makes shares of sums over the axes.
    fn finish(&mut self, axes: usize) {
        let all: f32 = (0..axes).map(|number| axis(number, axes).z).sum();
        self.open.iter_mut().for_each(|open| *open /= all);
    }

    fn at(&self, p: Vec2) -> f32 {
        let q = (p - self.corner) / CELL_M;
        if !(q.x >= 0.0 && q.y >= 0.0 && q.x < (self.columns - 1) as f32 && q.y < (self.rows - 1) as f32) {
            return 1.0;
        }
        let (column, row) = (q.x as usize, q.y as usize);
        let (fx, fy) = (q.x - column as f32, q.y - row as f32);
        let at = row * self.columns + column;
        let lower = self.open[at] * (1.0 - fx) + self.open[at + 1] * fx;
        let upper = self.open[at + self.columns] * (1.0 - fx) + self.open[at + self.columns + 1] * fx;
        lower * (1.0 - fy) + upper * fy
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rectangles, each by a corner and two edges.
    fn soup(rectangles: &[[Vec3; 3]]) -> (Vec<Vec3>, Vec<[u32; 3]>) {
        let (mut positions, mut triangles) = (Vec::new(), Vec::new());
        for [corner, u, v] in rectangles {
            let first = positions.len() as u32;
            positions.extend([*corner, *corner + *u, *corner + *u + *v, *corner + *v]);
            triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
        }
        (positions, triangles)
    }

    fn seen(rectangles: &[[Vec3; 3]], place: Vec3, normal: Vec3) -> f32 {
        let (positions, triangles) = soup(rectangles);
        ambient_visibility(
            &positions,
            &triangles,
            &[(place, normal)],
            OcclusionEstimate { texels: 256, axes: 24 },
        )[0]
    }

    #[test]
    fn closed_forms_hold() {
        // Beside a wall that has no end in sight half of the sky is left, before it all; between two walls a
        // strip.
        let wall = |x: f32| [Vec3::new(x, -60.0, 0.0), Vec3::Y * 120.0, Vec3::Z * 60.0];
        let beside = seen(&[wall(0.0)], Vec3::new(1.0, 0.0, 0.0), Vec3::Z);
        assert!((beside - 0.5).abs() < 0.04, "{beside}");
        let before = seen(&[wall(0.0)], Vec3::new(0.0, 0.0, 20.0), Vec3::X);
        assert!(before > 0.99, "{before}");
        // A street as wide as its walls are high: the sine of half the angle of the strip, atan(1 / 2).
        let wall = |x: f32| [Vec3::new(x, -24.0, 0.0), Vec3::Y * 48.0, Vec3::Z * 8.0];
        let street = seen(&[wall(-4.0), wall(4.0)], Vec3::ZERO, Vec3::Z);
        assert!((street - 0.447).abs() < 0.08, "{street}");
        // Under a square roof as far up as half its width: all but 1 - 0.554.
        let roof = [Vec3::new(-2.0, -2.0, 2.0), Vec3::X * 4.0, Vec3::Y * 4.0];
        let under = seen(&[roof], Vec3::ZERO, Vec3::Z);
        assert!((under - 0.446).abs() < 0.04, "{under}");
        // Its underside sees ground that is as open below its edge as below half a roof, and less within.
        let down = seen(&[roof], Vec3::new(0.0, 0.0, 2.0), -Vec3::Z);
        assert!(down > 0.5 && down < 0.8, "{down}");
        assert!(seen(&[roof], Vec3::new(0.0, 0.0, 2.0), Vec3::Z) > 0.99);
    }

    /// Share of the light by rays, as many as there are pairs.
    fn by_rays(positions: &[Vec3], triangles: &[[u32; 3]], place: Vec3, normal: Vec3) -> f32 {
        let stopped = |from: Vec3, to: Vec3| {
            triangles.iter().any(|corners| {
                let [a, b, c] = corners.map(|v| positions[v as usize]);
                let (u, v) = (b - a, c - a);
                let p = to.cross(v);
                let det = u.dot(p);
                let s = (from - a).dot(p) / det;
                let q = (from - a).cross(u);
                let t = to.dot(q) / det;
                s >= 0.0 && t >= 0.0 && s + t <= 1.0 && v.dot(q) / det > 0.0
            })
        };
        let number = 900;
        let sum = |from: Vec3, normal: Vec3, ground: &dyn Fn(Vec3) -> f32| {
            let (mut got, mut most) = (0.0, 0.0);
            for i in 0..number {
                let z = 1.0 - (2 * i + 1) as f32 / number as f32;
                let (sin, cos) = sin_cos(2.4 * i as f32);
                let to = Vec3::new((1.0 - z * z).sqrt() * cos, (1.0 - z * z).sqrt() * sin, z);
                let weight = normal.dot(to).max(0.0) * if z > 0.0 { 1.0 } else { GROUND };
                most += weight;
                if weight > 0.0 && !stopped(from, to) {
                    got += weight * if z > 0.0 { 1.0 } else { ground(from + to * (from.z / -z)) };
                }
            }
            got / most
        };
        let open = |at: Vec3| sum(at + Vec3::Z * 0.003, Vec3::Z, &|_| 1.0);
        sum(place + normal * 0.003, normal, &open)
    }

    #[test]
    fn shares_are_those_of_rays() {
        // A table with a shelf and an upright board: a body with an inside.
        let (positions, triangles) = soup(&[
            [Vec3::new(-0.8, -0.5, 0.7), Vec3::X * 1.6, Vec3::Y * 1.0],
            [Vec3::new(-0.8, -0.5, 0.3), Vec3::X * 0.9, Vec3::Y * 1.0],
            [Vec3::new(0.1, -0.5, 0.0), Vec3::Y * 1.0, Vec3::Z * 0.7],
        ]);
        let (mut worst, mut sum, mut count) = (0.0f32, 0.0, 0);
        let mut places = Vec::new();
        for x in [-0.7, -0.45, -0.2, 0.02] {
            for (z, up) in [(0.7, 1.0), (0.7, -1.0), (0.3, 1.0), (0.3, -1.0)] {
                places.push((Vec3::new(x, 0.13, z), Vec3::Z * up));
            }
        }
        for z in [0.08, 0.2, 0.4, 0.62] {
            places.push((Vec3::new(0.1, -0.2, z), Vec3::X));
            places.push((Vec3::new(0.1, -0.2, z), -Vec3::X));
        }
        let got =
            ambient_visibility(&positions, &triangles, &places, OcclusionEstimate { texels: 160, axes: 24 });
        for ((place, normal), got) in places.iter().zip(got) {
            let rays = by_rays(&positions, &triangles, *place, *normal);
            assert!((got - rays).abs() < 0.12, "{place} {normal}: {got} {rays}");
            worst = worst.max((got - rays).abs());
            sum += (got - rays).abs();
            count += 1;
        }
        assert!(sum / (count as f32) < 0.04, "{} on average, {worst} at most", sum / count as f32);
    }
}
