//! Lofts of rounded slices, the stuff that bodies are made of, and strips that lie on them.

use std::f32::consts::TAU;

use crate::solids::{Detail, MeshBuilder, curve_at};
use frames::math::f32::{pow, sin_cos};
use glam::Vec3;
use schema::Normal;
use schema::geometry::{MeshPart, TriMesh};

use crate::people::appearance::{Appearance, Build, Top};
use crate::people::figure::Figure;

/// A horizontal slice: its height, the place it is about, and how far it reaches ahead, back and to either
/// side.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Slice {
    pub(crate) z: f32,
    pub(crate) x: f32,
    pub(crate) y: f32,
    pub(crate) front: f32,
    pub(crate) back: f32,
    pub(crate) half: f32,
}

/// A slice about the bone's axis.
pub(crate) fn slice(z: f32, front: f32, back: f32, half: f32) -> Slice {
    Slice { z, x: 0.0, y: 0.0, front, back, half }
}

/// A round slice about the bone's axis.
pub(crate) fn round(z: f32, radius: f32) -> Slice {
    slice(z, radius, radius, radius)
}

impl Slice {
    pub(crate) fn at(self, x: f32, y: f32) -> Self {
        Self { x, y, ..self }
    }

    /// The same, larger by a factor across.
    pub(crate) fn wider(self, by: f32) -> Self {
        Self { front: by * self.front, back: by * self.back, half: by * self.half, ..self }
    }

    /// How far it is off the straight way between two others, metres.
    fn off(&self, low: &Self, high: &Self) -> f32 {
        let w = if high.z == low.z { 0.0 } else { (self.z - low.z) / (high.z - low.z) };
        let [mine, a, b] = [self, low, high].map(|s| [s.x + s.front, s.x - s.back, s.half, s.y]);
        let off = |k: usize| (mine[k] - (a[k] + w * (b[k] - a[k]))).abs();
        [0, 1, 2, 3].map(off).into_iter().fold(0.0, f32::max)
    }

    /// Its outline, counter-clockwise from above; the middle of the last side looks ahead. `square`: 1 an
    /// ellipse, less a rounder box.
    fn outline(&self, sides: usize, square: f32) -> Vec<Vec3> {
        (0..sides).map(|j| self.at_angle((j as f32 + 0.5) * TAU / sides as f32, square)).collect()
    }

    /// The place on its outline at an angle from ahead to the left.
    pub(crate) fn at_angle(&self, angle: f32, square: f32) -> Vec3 {
        let bent = |v: f32| v.signum() * if square < 1.0 { pow(v.abs(), square) } else { v.abs() };
        let (s, c) = sin_cos(angle);
        let (c, s) = (bent(c), bent(s));
        let reach = if c > 0.0 { self.front } else { self.back };
        Vec3::new(self.x + c * reach, self.y + s * self.half, self.z)
    }
}

/// 1 at the middle and 0 from the end on, smooth at both: `u` is the distance from the middle over that to
/// the end.
pub(crate) fn bump(u: f32) -> f32 {
    let v = (1.0 - u * u).max(0.0);
    v * v
}

/// How far two angles are apart, radians.
pub(crate) fn apart(a: f32, b: f32) -> f32 {
    let turn = (a - b).abs() % TAU;
    turn.min(TAU - turn)
}

/// A solid with relief: close by it runs smoothly through its slices, with more of them and more sides, and
/// swells and sinks as `relief` says of a height and an angle from ahead to the left, metres. Farther away it
/// is a plain loft.
pub(crate) struct Shaped<'a> {
    pub(crate) slices: &'a [Slice],
    /// Sides close by, and those of which [`lofted`] leaves fewer out farther away.
    pub(crate) sides: [usize; 2],
    pub(crate) square: f32,
    /// Slices put between each two.
    pub(crate) between: usize,
    pub(crate) relief: &'a dyn Fn(f32, f32) -> f32,
}

impl Shaped<'_> {
    /// The slice at a height, on smooth curves through those that are known.
    pub(crate) fn slice_at(&self, z: f32) -> Slice {
        let curve = |of: &dyn Fn(&Slice) -> f32| {
            let points: Vec<(f32, f32)> = self.slices.iter().map(|s| (s.z, of(s))).collect();
            curve_at(&points, z)
        };
        Slice {
            z,
            x: curve(&|s| s.x),
            y: curve(&|s| s.y),
            front: curve(&|s| s.front),
            back: curve(&|s| s.back),
            half: curve(&|s| s.half),
        }
    }

    /// The place on the surface at a height and an angle, so much farther out.
    pub(crate) fn surface(&self, z: f32, angle: f32, out: f32) -> Vec3 {
        self.raised(&self.slice_at(z), angle, out)
    }

    fn raised(&self, slice: &Slice, angle: f32, out: f32) -> Vec3 {
        let (s, c) = sin_cos(angle);
        slice.at_angle(angle, self.square) + Vec3::new(c, s, 0.0) * ((self.relief)(slice.z, angle) + out)
    }

    /// Adds it; `part` is that above a slice.
    pub(crate) fn add(&self, b: &mut MeshBuilder, part: impl Fn(usize) -> MeshPart) {
        if b.detail() != Detail::Full {
            lofted(b, self.slices, self.sides[1], self.square, |k, _| part(k));
            return;
        }
        let mut rings: Vec<Slice> = Vec::new();
        for pair in self.slices.windows(2) {
            rings.push(pair[0]);
            let steps = self.between + 1;
            let height = |i: usize| pair[0].z + (pair[1].z - pair[0].z) * i as f32 / steps as f32;
            rings.extend((1..steps).map(|i| self.slice_at(height(i))));
        }
        rings.extend(self.slices.last());
        let sides = self.sides[0];
        let ring = |slice: &Slice| -> Vec<Vec3> {
            (0..sides).map(|j| self.raised(slice, j as f32 * TAU / sides as f32, 0.0)).collect()
        };
        let rings: Vec<Vec<Vec3>> = rings.iter().map(ring).collect();
        let caps = [part(0), part(self.slices.len().saturating_sub(2))];
        b.loft(&rings, |k, _| part(k / (self.between + 1)), caps);
    }
}

/// A flat band along pairs of places, on a body whose axis is the frame's z axis: its face looks away from
/// that, and it is a wedge as deep as `deep` behind. The last pair is joined to the first if it is `closed`.
/// Only close by: farther away nothing is so thin.
pub(crate) fn strip(b: &mut MeshBuilder, part: MeshPart, pairs: &[[Vec3; 2]], deep: f32, closed: bool) {
    let n = pairs.len();
    if b.detail() != Detail::Full || n < 2 {
        return;
    }
    let mut outward = Vec::with_capacity(n);
    for i in 0..n {
        let (next, before) =
            if closed { ((i + 1) % n, (i + n - 1) % n) } else { ((i + 1).min(n - 1), i.saturating_sub(1)) };
        let along = pairs[next][0] + pairs[next][1] - pairs[before][0] - pairs[before][1];
        outward.push((pairs[i][1] - pairs[i][0]).cross(along).normalize_or(Vec3::X));
    }
    let middle = |i: usize| 0.5 * (pairs[i][0] + pairs[i][1]);
    let looks_out: f32 = (0..n).map(|i| outward[i].dot(middle(i) * Vec3::new(1.0, 1.0, 0.0))).sum();
    let index = b.part_index(part);
    let ids: Vec<[u32; 3]> = (0..n)
        .map(|i| {
            let out = if looks_out < 0.0 { -outward[i] } else { outward[i] };
            let [low, high] = if looks_out < 0.0 { [1, 0] } else { [0, 1] };
            [pairs[i][low], pairs[i][high], middle(i) - out * deep].map(|p| b.vertex(p))
        })
        .collect();
    let steps = if closed { n } else { n - 1 };
    for i in 0..steps {
        let (here, next) = (ids[i], ids[(i + 1) % n]);
        for [p, q] in [[0, 1], [1, 2], [2, 0]] {
            b.quad(index, [here[p], here[q], next[q], next[p]]);
        }
    }
    if !closed {
        let (first, last) = (ids[0], ids[n - 1]);
        b.triangle(index, [first[0], first[2], first[1]]);
        b.triangle(index, last);
    }
}

/// A solid through slices, from the lowest up; `part(k, j)` is that of side j above slice k. Of less detail,
/// it has fewer slices and sides, and those are so much farther out that it is as thick.
pub(crate) fn lofted(
    b: &mut MeshBuilder,
    slices: &[Slice],
    sides: usize,
    square: f32,
    part: impl Fn(usize, usize) -> MeshPart,
) {
    let fewer = b.detail().sides(sides);
    let area = |n: usize| n as f32 * sin_cos(TAU / n as f32).0;
    let by = if fewer < sides { (area(sides) / area(fewer)).sqrt() } else { 1.0 };
    let kept = worth(slices, b.detail().tolerance_m());
    let rings: Vec<Vec<Vec3>> = kept.iter().map(|k| slices[*k].wider(by).outline(fewer, square)).collect();
    let side = |j: usize| ((j + 1) * sides + fewer / 2) / fewer % sides;
    let caps = [part(0, 0), part(slices.len().saturating_sub(2), 0)];
    b.loft(&rings, |k, j| part(kept[k], (side(j) + sides - 1) % sides), caps);
}

/// The slices without which a solid would be farther off than a tolerance: first and last, and between two
/// the one that is farthest off (Douglas and Peucker 1973).
fn worth(slices: &[Slice], tolerance_m: f32) -> Vec<usize> {
    let mut kept = vec![0];
    let mut ends = vec![slices.len().saturating_sub(1)];
    while let Some(last) = ends.last().copied() {
        let first = kept[kept.len() - 1];
        let off = |k: usize| slices[k].off(&slices[first], &slices[last]);
        let farthest = (first + 1..last).max_by(|a, b| off(*a).total_cmp(&off(*b)));
        match farthest.filter(|k| off(*k) >= tolerance_m) {
            Some(k) => ends.push(k),
            None => {
                kept.push(last);
                ends.pop();
            }
        }
    }
    kept.dedup();
    kept
}

/// The same of one part.
pub(crate) fn solid(b: &mut MeshBuilder, part: MeshPart, slices: &[Slice], sides: usize) {
    lofted(b, slices, sides, 1.0, |_, _| part);
}

/// Turns the light at joints so that two limbs are one surface while they are straight: there normals look
/// straight away from the bone. `joints` are heights, and how far from them that fades out.
pub(crate) fn level_at(mesh: &mut TriMesh, joints: &[[f32; 2]]) {
    for (normals, corners) in mesh.corner_normals.iter_mut().zip(&mesh.triangles) {
        for (normal, vertex) in normals.iter_mut().zip(corners) {
            let z = mesh.positions[*vertex as usize].z;
            let near = joints.iter().map(|[at, reach]| bump((z - at) / reach)).fold(0.0, f32::max);
            if near > 0.0 {
                let n = normal.get();
                *normal = Normal::new(Vec3::new(n.x, n.y, n.z * (1.0 - near)).normalize_or(n));
            }
        }
    }
}

/// How thick the clothes on the trunk are, as a factor.
pub(crate) fn cloth(look: &Appearance) -> f32 {
    match look.top {
        Top::Coat => 1.09,
        Top::Jacket | Top::Hoodie | Top::HiVis => 1.07,
        Top::Suit | Top::Uniform => 1.04,
        _ => 1.0,
    }
}

/// How thick somebody's limbs are.
pub(crate) fn stout(f: &Figure) -> f32 {
    let build = match f.look.build {
        Build::Slim => 0.90,
        Build::Average => 1.0,
        Build::Heavy => 1.14,
    };
    build * if f.look.woman { 0.92 } else { 1.0 }
}

/// Turns the light on hips as if the legs reached up into them: `hip_y` is how far a leg's axis is aside, the
/// rest as of [`level_at`].
pub(crate) fn part_in_two(mesh: &mut TriMesh, hip_y: f32, [at, reach]: [f32; 2]) {
    for (normals, corners) in mesh.corner_normals.iter_mut().zip(&mesh.triangles) {
        let middle = corners.iter().map(|v| mesh.positions[*v as usize].y).sum::<f32>();
        for (normal, vertex) in normals.iter_mut().zip(corners) {
            let p = mesh.positions[*vertex as usize];
            let near = if p.z < at { 1.0 } else { bump((p.z - at) / reach) };
            let leg = Vec3::new(p.x, p.y - hip_y * middle.signum(), 0.0).normalize_or(Vec3::X);
            *normal = Normal::new(normal.get().lerp(leg, near).normalize_or(leg));
        }
    }
}

/// Slices of a limb, their heights as shares of its length, all else of the stature.
pub(crate) fn limb(f: &Figure, length: f32, by: f32, shape: &[(f32, f32, f32, f32)]) -> Vec<Slice> {
    let h = f.stature;
    shape
        .iter()
        .map(|(z, front, back, half)| slice(z * length, front * h, back * h, half * h).wider(by))
        .collect()
}
