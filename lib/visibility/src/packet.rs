//! Packets of rays with one origin, through boxes and triangles.
//!
//! A single ray is a packet of one lane, so single rays and packets compute the same bits. The loops over lanes
//! are written plainly over fixed arrays; the compiler turns them into vector instructions.
#![allow(clippy::needless_range_loop)] // One index runs through many lane arrays.

use glam::Vec3;
use renderer::{RayBatch, SKY};

use crate::bvh::{Node, Stack};
use crate::placed::Placed;

/// Boxes are entered when a lane misses them by less than this: relative rounding of the slab distances.
const SLACK: f32 = 1.0 + 8.0 * f32::EPSILON;
/// Boxes grow by this times the coordinates' size: the rounding of triangle tests, so that no box hides a
/// triangle that the test would accept.
const PAD: f32 = 4.0 * f32::EPSILON;
/// Directions nearer than this to an axis plane count as this steep in box tests, to keep inverses finite.
const STEEPEST: f32 = 1e-20;

/// Packets whose unit directions differ less than this in every axis meet boxes as one.
const NARROW: f32 = 0.03;

/// Directions, by axis and lane.
#[derive(Clone, Copy)]
pub(crate) struct Lanes<const N: usize>([[f32; N]; 3]);

/// How a packet meets boxes. No way misses a box that a lane of it meets.
pub(crate) trait Boxes<const N: usize> {
    /// For boxes around an origin, of which `reach` is the largest coordinate.
    fn new(lanes: &Lanes<N>, origin: Vec3, reach: f32) -> Self;

    /// A distance before which no lane that may find something enters a box; infinite when none does.
    fn entry(&self, packet: &Packet<N>, node: &Node) -> f32;
}

/// The origin moved up, for lower planes of boxes, and down, for upper planes.
#[derive(Clone, Copy)]
struct Origins {
    up: Vec3,
    down: Vec3,
}

impl Origins {
    fn new(origin: Vec3, reach: f32) -> Self {
        let pad = Vec3::splat(PAD * (origin.abs().max_element() + reach));
        Self { up: origin + pad, down: origin - pad }
    }

    /// Corners of a box from there.
    #[inline(always)]
    fn corners(&self, node: &Node) -> [Vec3; 2] {
        [node.min - self.up, node.max - self.down]
    }
}

/// Lane by lane: the distances to a box's planes are `(plane - origin) * inverse`.
pub(crate) struct Slabs<const N: usize> {
    inverse: [[f32; N]; 3],
    origins: Origins,
}

impl<const N: usize> Boxes<N> for Slabs<N> {
    fn new(lanes: &Lanes<N>, origin: Vec3, reach: f32) -> Self {
        let mut inverse = [[0.0; N]; 3];
        for axis in 0..3 {
            for i in 0..N {
                let d = lanes.0[axis][i];
                inverse[axis][i] = 1.0 / if d.abs() < STEEPEST { STEEPEST.copysign(d) } else { d };
            }
        }
        Self { inverse, origins: Origins::new(origin, reach) }
    }

    #[inline(always)]
    fn entry(&self, packet: &Packet<N>, node: &Node) -> f32 {
        let [lo, hi] = self.origins.corners(node);
        let [ix, iy, iz] = &self.inverse;
        // No distance is negative, so they have the same order as whole numbers, and of those the compiler finds the least in
        // registers.
        let mut least = i32::MAX;
        for i in 0..N {
            let (x0, x1) = (lo.x * ix[i], hi.x * ix[i]);
            let (y0, y1) = (lo.y * iy[i], hi.y * iy[i]);
            let (z0, z1) = (lo.z * iz[i], hi.z * iz[i]);
            let near = max(max(min(x0, x1), min(y0, y1)), max(min(z0, z1), packet.t_min[i]));
            let far = min(min(max(x0, x1), max(y0, y1)), min(max(z0, z1), packet.t[i]));
            // All bits set but the sign: more than any distance.
            let misses = (i32::from(near <= far * SLACK) - 1) & i32::MAX;
            least = least.min(near.to_bits() as i32 | misses);
        }
        if least == i32::MAX { f32::INFINITY } else { f32::from_bits(least as u32) }
    }
}

/// All lanes as one fan: by axis, the extreme inverses of those that go up it and of those that go down.
pub(crate) struct Fan {
    /// Of lanes that go up the least and the greatest; huge and zero where there are none.
    up: [Vec3; 2],
    /// Of lanes that go down that nearest to zero and that farthest from it; hugely negative and zero where there are none.
    down: [Vec3; 2],
    origins: Origins,
}

impl<const N: usize> Boxes<N> for Fan {
    fn new(lanes: &Lanes<N>, origin: Vec3, reach: f32) -> Self {
        let [mut up, mut down] = [[Vec3::ZERO; 2]; 2];
        for (axis, lanes) in lanes.0.iter().enumerate() {
            let [lowest, highest] = range(lanes);
            up[0][axis] = 1.0 / max(highest, STEEPEST);
            up[1][axis] = if highest < 0.0 { 0.0 } else { 1.0 / max(lowest, STEEPEST) };
            down[0][axis] = 1.0 / min(lowest, -STEEPEST);
            down[1][axis] = if lowest > 0.0 { 0.0 } else { 1.0 / min(highest, -STEEPEST) };
        }
        Self { up, down, origins: Origins::new(origin, reach) }
    }

    #[inline(always)]
    fn entry(&self, packet: &Packet<N>, node: &Node) -> f32 {
        let [lo, hi] = self.origins.corners(node);
        let [up, down] = [&self.up, &self.down];
        // Where the box is not about the origin, one of the two is not positive, or huge if no lane goes its way.
        let near = |axis: usize| max(lo[axis] * up[0][axis], hi[axis] * down[0][axis]);
        let far = |axis: usize| max(hi[axis] * up[1][axis], lo[axis] * down[1][axis]);
        let near = max(max(max(near(0), near(1)), near(2)), packet.t_nearest);
        let far = min(min(min(far(0), far(1)), far(2)), packet.t_farthest);
        if near <= far * SLACK { near } else { f32::INFINITY }
    }
}

/// Rays in flight (`N` a power of two) and the closest hits so far.
pub(crate) struct Packet<const N: usize> {
    origin: Vec3,
    directions: Lanes<N>,
    /// Nearest distance asked for.
    t_min: [f32; N],
    /// The least of `t_min`.
    t_nearest: f32,
    /// Closest hit, or the farthest distance asked for.
    t: [f32; N],
    /// The largest of `t`.
    t_farthest: f32,
    instance: [u32; N],
    triangle: [u32; N],
    u: [f32; N],
    v: [f32; N],
}

/// The lists of hits of some rays, which said that nothing was hit.
pub(crate) struct HitsMut<'a> {
    pub(crate) t: &'a mut [f32],
    pub(crate) instance: &'a mut [u32],
    pub(crate) triangle: &'a mut [u32],
    pub(crate) u: &'a mut [f32],
    pub(crate) v: &'a mut [f32],
}

/// A triangle as seen from one origin, before any direction is known.
struct SeenTriangle {
    /// Normals of the planes through the origin and an edge, opposite to corner 0, 1, 2. Corners come in as sum
    /// and difference, which makes an edge's normal the exact negative of its neighbour's (Davidovic et al.,
    /// "3D rasterization", 2012; Embree's robust mode): a ray can't slip between two triangles.
    edge: [Vec3; 3],
    normal: Vec3,
    /// Distance of the triangle's plane from the origin, times the normal's length.
    offset: f32,
}

impl SeenTriangle {
    #[inline]
    fn new([a, b, c]: [Vec3; 3], origin: Vec3) -> Self {
        let (a, b, c) = (a - origin, b - origin, c - origin);
        let normal = (b - a).cross(c - a);
        Self {
            edge: [(c - b).cross(c + b), (a - c).cross(a + c), (b - a).cross(b + a)],
            normal,
            offset: a.dot(normal),
        }
    }
}

#[inline(always)]
fn dot(v: Vec3, x: f32, y: f32, z: f32) -> f32 {
    v.x * x + v.y * y + v.z * z
}

/// The least and the greatest of some numbers.
#[inline(always)]
fn range<const N: usize>(numbers: &[f32; N]) -> [f32; 2] {
    // By whole numbers of the same order: the compiler finds the extremes of those within registers.
    let order = |bits: i32| bits ^ ((bits >> 31) & i32::MAX);
    let (mut least, mut greatest) = (i32::MAX, i32::MIN);
    for number in numbers {
        let place = order(number.to_bits() as i32);
        (least, greatest) = (least.min(place), greatest.max(place));
    }
    [least, greatest].map(|place| f32::from_bits(order(place) as u32))
}

/// Like the processor's instruction, without the care of `f32::min` for NaN.
#[inline(always)]
fn min(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

#[inline(always)]
fn max(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

impl<const N: usize> Packet<N> {
    /// At most `N` rays of a batch, from one on; lanes without one never hit anything.
    pub(crate) fn new(batch: &RayBatch<'_>, first: usize) -> Self {
        let directions = &batch.directions[first..];
        let (origin, t_max) = (batch.origin, batch.range_m[1]);
        let mut lanes = Lanes([[0.0; N]; 3]);
        let mut t = [-1.0; N];
        let mut t_min = [f32::MAX; N];
        // Lanes without a ray go where the first one goes: no box is tested for their sake.
        let filler = directions.first().copied().filter(|direction| direction.is_finite()).unwrap_or(Vec3::Z);
        for i in 0..N {
            let direction = directions.get(i).copied().filter(|direction| direction.is_finite());
            if direction.is_some() {
                // A finite bound also rejects the infinite distances of rays within a triangle's plane.
                t[i] = t_max.min(f32::MAX);
                t_min[i] = batch.nearest_m(first + i).max(0.0);
            }
            for (axis, value) in lanes.0.iter_mut().zip(direction.unwrap_or(filler).to_array()) {
                axis[i] = value;
            }
        }
        Self {
            origin,
            directions: lanes,
            t_min,
            t_nearest: range(&t_min)[0],
            t,
            t_farthest: t_max.min(f32::MAX),
            instance: [SKY; N],
            triangle: [SKY; N],
            u: [0.0; N],
            v: [0.0; N],
        }
    }

    /// Writes what the first lanes hit, from a place in the lists on.
    #[inline]
    pub(crate) fn store(&self, lanes: usize, first: usize, out: &mut HitsMut<'_>) {
        for lane in 0..lanes {
            if self.instance[lane] != SKY {
                out.t[first + lane] = self.t[lane];
                out.instance[first + lane] = self.instance[lane];
                out.triangle[first + lane] = self.triangle[lane];
                out.u[first + lane] = self.u[lane];
                out.v[first + lane] = self.v[lane];
            }
        }
    }

    /// Whether all lanes go nearly the same way.
    pub(crate) fn is_narrow(&self) -> bool {
        self.directions.0.iter().map(range).all(|[lowest, highest]| highest - lowest < NARROW)
    }

    /// Origin and directions in the local frame.
    pub(crate) fn lanes_local(&self) -> (Vec3, Lanes<N>) {
        (self.origin, self.directions)
    }

    /// Whether a box entered at this distance may hold something closer.
    #[inline]
    pub(crate) fn may_be_closer(&self, entry: f32) -> bool {
        entry <= self.t_farthest * SLACK && entry < f32::INFINITY
    }

    /// Pushes the children that may hold something, the nearer one last.
    #[inline(always)]
    pub(crate) fn push_children(
        &self,
        boxes: &impl Boxes<N>,
        nodes: &[Node],
        child: u32,
        stack: &mut Stack<(u32, f32)>,
    ) {
        let left = (child, boxes.entry(self, &nodes[child as usize]));
        let right = (child + 1, boxes.entry(self, &nodes[child as usize + 1]));
        let (near, far) = if left.1 <= right.1 { (left, right) } else { (right, left) };
        if far.1 < f32::INFINITY {
            stack.push(far);
        }
        if near.1 < f32::INFINITY {
            stack.push(near);
        }
    }

    /// Tests the triangles of one instance.
    pub(crate) fn visit<B: Boxes<N>>(&mut self, instance: u32, placed: &Placed<'_>) {
        let mesh = placed.mesh;
        let origin = placed.rotation.transpose() * (self.origin - placed.translation);
        let lanes = {
            let mut lanes = [[0.0; N]; 3];
            let [dx, dy, dz] = &self.directions.0;
            for (axis, column) in [placed.rotation.x_axis, placed.rotation.y_axis, placed.rotation.z_axis]
                .into_iter()
                .enumerate()
            {
                for i in 0..N {
                    lanes[axis][i] = dot(column, dx[i], dy[i], dz[i]);
                }
            }
            Lanes(lanes)
        };
        let reach = mesh.aabb.min.abs().max(mesh.aabb.max.abs()).max_element();
        let boxes = B::new(&lanes, origin, reach);
        let nodes = &mesh.bvh.nodes;
        let mut stack = Stack::new((0u32, 0.0f32));
        stack.push((0, boxes.entry(self, &nodes[0])));
        while let Some((index, entry)) = stack.pop() {
            if !self.may_be_closer(entry) {
                continue;
            }
            let node = &nodes[index as usize];
            if node.child != 0 {
                self.push_children(&boxes, nodes, node.child, &mut stack);
                continue;
            }
            for slot in node.first..node.first + node.count {
                let seen = SeenTriangle::new(mesh.corners(slot), origin);
                self.meet(&lanes, &seen, instance, mesh.bvh.order[slot as usize]);
            }
        }
    }

    /// Keeps the triangle in the lanes that hit it closest.
    #[inline(always)]
    fn meet(&mut self, lanes: &Lanes<N>, seen: &SeenTriangle, instance: u32, triangle: u32) {
        let [dx, dy, dz] = &lanes.0;
        let mut inside = [0u32; N];
        let mut any = 0;
        for i in 0..N {
            let e0 = dot(seen.edge[0], dx[i], dy[i], dz[i]);
            let e1 = dot(seen.edge[1], dx[i], dy[i], dz[i]);
            let e2 = dot(seen.edge[2], dx[i], dy[i], dz[i]);
            // Inside when all three agree, whichever side is seen; on an edge belongs to both neighbours.
            let (low, high) = (min(min(e0, e1), e2), max(max(e0, e1), e2));
            inside[i] = u32::from((low >= 0.0) | (high <= 0.0));
            any |= inside[i];
        }
        if any == 0 {
            return;
        }
        let mut closer = [0u32; N];
        let mut t = [0.0; N];
        any = 0;
        for i in 0..N {
            t[i] = seen.offset / dot(seen.normal, dx[i], dy[i], dz[i]);
            // Distances that are not numbers compare false.
            closer[i] = inside[i] & u32::from((t[i] >= self.t_min[i]) & (t[i] <= self.t[i]));
            any |= closer[i];
        }
        if any == 0 {
            return;
        }
        let mut kept = 0;
        for i in 0..N {
            let smaller = (instance < self.instance[i])
                | ((instance == self.instance[i]) & (triangle < self.triangle[i]));
            let keep = (closer[i] != 0) & ((t[i] < self.t[i]) | smaller);
            let e0 = dot(seen.edge[0], dx[i], dy[i], dz[i]);
            let e1 = dot(seen.edge[1], dx[i], dy[i], dz[i]);
            let e2 = dot(seen.edge[2], dx[i], dy[i], dz[i]);
            let sum = e0 + e1 + e2;
            // A ray through a corner within rounding can have three zero edges; any weights do.
            let scale = if sum == 0.0 { 0.0 } else { 1.0 / sum };
            self.t[i] = if keep { t[i] } else { self.t[i] };
            self.instance[i] = if keep { instance } else { self.instance[i] };
            self.triangle[i] = if keep { triangle } else { self.triangle[i] };
            self.u[i] = if keep { e1 * scale } else { self.u[i] };
            self.v[i] = if keep { e2 * scale } else { self.v[i] };
            kept |= u32::from(keep);
        }
        if kept != 0 {
            [_, self.t_farthest] = range(&self.t);
        }
    }
}
