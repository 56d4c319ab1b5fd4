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

/// Directions, by axis and lane.
#[derive(Clone, Copy)]
pub(crate) struct Lanes<const N: usize>([[f32; N]; 3]);

/// What the box test needs of a packet: the distances to a box's planes are `(plane - origin) * inverse`.
pub(crate) struct Slabs<const N: usize> {
    inverse: [[f32; N]; 3],
    /// The origin moved up, for lower planes, and down, for upper planes.
    origin_up: Vec3,
    origin_down: Vec3,
}

impl<const N: usize> Lanes<N> {
    /// `reach` is the largest coordinate of the boxes that will be tested.
    pub(crate) fn slabs(&self, origin: Vec3, reach: f32) -> Slabs<N> {
        let pad = Vec3::splat(PAD * (origin.abs().max_element() + reach));
        let mut inverse = [[0.0; N]; 3];
        for axis in 0..3 {
            for i in 0..N {
                let d = self.0[axis][i];
                inverse[axis][i] = 1.0 / if d.abs() < STEEPEST { STEEPEST.copysign(d) } else { d };
            }
        }
        Slabs { inverse, origin_up: origin + pad, origin_down: origin - pad }
    }
}

/// Rays in flight (`N` a power of two) and the closest hits so far.
pub(crate) struct Packet<const N: usize> {
    origin: Vec3,
    directions: Lanes<N>,
    /// Nearest distance asked for.
    t_min: [f32; N],
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
    v.x.mul_add(x, v.y.mul_add(y, v.z * z))
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
        let mut lanes = Lanes([[0.0; N], [0.0; N], [1.0; N]]);
        let mut t = [-1.0; N];
        let mut t_min = [0.0; N];
        for (i, direction) in directions.iter().take(N).enumerate() {
            for (axis, value) in lanes.0.iter_mut().zip(direction.to_array()) {
                axis[i] = value;
            }
            // A finite bound also rejects the infinite distances of rays within a triangle's plane.
            t[i] = t_max.min(f32::MAX);
            t_min[i] = batch.nearest_m(first + i).max(0.0);
        }
        Self {
            origin,
            directions: lanes,
            t_min,
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

    /// Origin and directions in the local frame.
    pub(crate) fn lanes_local(&self) -> (Vec3, Lanes<N>) {
        (self.origin, self.directions)
    }

    /// Whether a box entered at this distance may hold something closer.
    #[inline]
    pub(crate) fn may_be_closer(&self, entry: f32) -> bool {
        entry <= self.t_farthest * SLACK && entry < f32::INFINITY
    }

    /// The smallest distance at which a lane that may find something enters a box; infinite when none does.
    #[inline(always)]
    pub(crate) fn entry(&self, slabs: &Slabs<N>, node: &Node) -> f32 {
        let (lo, hi) = (node.min - slabs.origin_up, node.max - slabs.origin_down);
        let [ix, iy, iz] = &slabs.inverse;
        // None is negative, so they have the same order as whole numbers, and of those the compiler finds the least in registers.
        let mut least = [0; N];
        for i in 0..N {
            let (x0, x1) = (lo.x * ix[i], hi.x * ix[i]);
            let (y0, y1) = (lo.y * iy[i], hi.y * iy[i]);
            let (z0, z1) = (lo.z * iz[i], hi.z * iz[i]);
            let near = max(max(min(x0, x1), min(y0, y1)), max(min(z0, z1), self.t_min[i]));
            let far = min(min(max(x0, x1), max(y0, y1)), min(max(z0, z1), self.t[i]));
            let misses = i32::from(near <= far * SLACK) - 1;
            // All bits set but the sign: more than any distance.
            least[i] = near.to_bits() as i32 | (misses & i32::MAX);
        }
        let least = least.into_iter().fold(i32::MAX, i32::min);
        if least == i32::MAX { f32::INFINITY } else { f32::from_bits(least as u32) }
    }

    /// Pushes the children that may hold something, the nearer one last.
    #[inline(always)]
    pub(crate) fn push_children(
        &self,
        slabs: &Slabs<N>,
        nodes: &[Node],
        child: u32,
        stack: &mut Stack<(u32, f32)>,
    ) {
        let left = (child, self.entry(slabs, &nodes[child as usize]));
        let right = (child + 1, self.entry(slabs, &nodes[child as usize + 1]));
        let (near, far) = if left.1 <= right.1 { (left, right) } else { (right, left) };
        if far.1 < f32::INFINITY {
            stack.push(far);
        }
        if near.1 < f32::INFINITY {
            stack.push(near);
        }
    }

    /// Tests the triangles of one instance.
    pub(crate) fn visit(&mut self, instance: u32, placed: &Placed<'_>) {
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
        let slabs = lanes.slabs(origin, reach);
        let nodes = &mesh.bvh.nodes;
        let mut stack = Stack::new((0u32, 0.0f32));
        stack.push((0, self.entry(&slabs, &nodes[0])));
        while let Some((index, entry)) = stack.pop() {
            if !self.may_be_closer(entry) {
                continue;
            }
            let node = &nodes[index as usize];
            if node.child != 0 {
                self.push_children(&slabs, nodes, node.child, &mut stack);
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
            // Not negative but for lanes without a ray, which are all the same: as whole numbers, as above.
            let farthest = self.t.iter().fold(i32::MIN, |most, t| most.max(t.to_bits() as i32));
            self.t_farthest = f32::from_bits(farthest as u32);
        }
    }
}
