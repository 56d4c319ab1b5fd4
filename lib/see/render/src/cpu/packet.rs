//! Packets of rays with one origin, through boxes and triangles.
//!
//! A single ray is a packet of one lane, so single rays and packets compute the same bits. The loops over
//! lanes are written plainly over fixed arrays; the compiler turns them into vector instructions.
#![allow(clippy::needless_range_loop, reason = "one index runs through many lane arrays")]

use crate::{RayBatch, SKY};
use glam::{DVec3, Vec3};

use crate::prepared::{BLOCK, MeshData, Node, Outlines, Placed, Stack, inside, near_reciprocal};

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
pub(crate) struct PacketVec3<const N: usize>([[f32; N]; 3]);

/// How a packet meets boxes. No way misses a box that a lane of it meets.
pub(crate) trait Boxes<const N: usize> {
    /// For boxes around an origin, of which `reach` is the largest coordinate.
    fn new(lanes: &PacketVec3<N>, origin: Vec3, reach: f32) -> Self;

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
    fn new(lanes: &PacketVec3<N>, origin: Vec3, reach: f32) -> Self {
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
        // No distance is negative, so they have the same order as whole numbers, and of those the compiler
        // finds the least in registers.
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
    /// Of lanes that go down that nearest to zero and that farthest from it; hugely negative and zero where
    /// there are none.
    down: [Vec3; 2],
    origins: Origins,
}

impl<const N: usize> Boxes<N> for Fan {
    fn new(lanes: &PacketVec3<N>, origin: Vec3, reach: f32) -> Self {
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
        // Where the box is not about the origin, one of the two is not positive, or huge if no lane goes its
        // way.
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
    directions: PacketVec3<N>,
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

/// Triangles that are set up at once.
const SETUP: usize = 4;

/// [`Outlines`] for directions in single precision.
struct SeenTriangles {
    edges: [[[f32; SETUP]; 3]; 3],
    normal: [[f32; SETUP]; 3],
    offset: [f32; SETUP],
}

impl SeenTriangles {
    /// Of a block's lanes, from one on.
    #[inline]
    fn new(mesh: &MeshData, block: usize, first: usize, origin: DVec3) -> Self {
        let corners = mesh.blocks[block].0.each_ref().map(|corner| {
            let mut from_origin = [[0.0; SETUP]; 3];
            for axis in 0..3 {
                for i in 0..SETUP {
                    from_origin[axis][i] = f64::from(corner[axis][first + i]) - origin[axis];
                }
            }
            from_origin
        });
        let Outlines { edges, normal, offset } = Outlines::new(&corners);
        let single = |numbers: [f64; SETUP]| numbers.map(|number| number as f32);
        Self { edges: edges.map(|edge| edge.map(single)), normal: normal.map(single), offset: single(offset) }
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
        let mut lanes = PacketVec3([[0.0; N]; 3]);
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
    pub(crate) fn lanes_local(&self) -> (Vec3, PacketVec3<N>) {
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
        // In double precision: the difference of two places far from the local origin loses nothing.
        let object_from_local = placed.rotation.as_dmat3().transpose();
        let origin = object_from_local * (self.origin.as_dvec3() - placed.translation.as_dvec3());
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
            PacketVec3(lanes)
        };
        let reach = mesh.aabb.min.abs().max(mesh.aabb.max.abs()).max_element();
        let boxes = B::new(&lanes, origin.as_vec3(), reach);
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
            let (mut slot, end) = (node.first as usize, (node.first + node.count) as usize);
            while slot < end {
                let (block, lane) = (slot / BLOCK, slot % BLOCK);
                let first = lane.min(BLOCK - SETUP);
                let seen = SeenTriangles::new(mesh, block, first, origin);
                for i in lane - first..SETUP.min(end - block * BLOCK - first) {
                    self.meet(&lanes, &seen, i, instance, mesh.bvh.order[slot]);
                    slot += 1;
                }
            }
        }
    }

    /// Keeps the triangle in the lanes that hit it closest.
    #[inline(always)]
    fn meet(
        &mut self,
        lanes: &PacketVec3<N>,
        seen: &SeenTriangles,
        which: usize,
        instance: u32,
        triangle: u32,
    ) {
        let offset = seen.offset[which];
        if offset == 0.0 {
            return; // Seen edge-on.
        }
        let vector = |axes: &[[f32; SETUP]; 3]| Vec3::from_array(axes.map(|axis| axis[which]));
        let (edges, normal) = (seen.edges.each_ref().map(vector), vector(&seen.normal));
        let [dx, dy, dz] = &lanes.0;
        let products = |i: usize| edges.map(|edge| dot(edge, dx[i], dy[i], dz[i]));
        let mut through = [0u32; N];
        let mut any = 0;
        for i in 0..N {
            // A ray through an edge may hit both neighbours, so that none slips through.
            through[i] = u32::from(inside(products(i), [0.0; 3]));
            any |= through[i];
        }
        if any == 0 {
            return;
        }
        let mut closer = [0u32; N];
        let mut t = [0.0; N];
        any = 0;
        for i in 0..N {
            t[i] = offset * near_reciprocal(dot(normal, dx[i], dy[i], dz[i]));
            // Distances that are not numbers compare false.
            closer[i] = through[i] & u32::from((t[i] >= self.t_min[i]) & (t[i] <= self.t[i]));
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
            let [e0, e1, e2] = products(i);
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
