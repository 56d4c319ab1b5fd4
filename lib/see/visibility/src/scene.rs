//! The instances of one frame over their meshes.

use std::sync::OnceLock;

use frames::Aabb;
use glam::Affine3A;
use rayon::prelude::*;
use renderer::{
    Alone, AloneRays, Hits, PinholeCamera, RayBatch, RenderError, Scene, VisibilityBuffer, pose_before,
};
use schema::geometry::{Instance, Snapshot};

use crate::bvh::{Bvh, QUICK, Stack};
use crate::meshes::Meshes;
use crate::packet::{Boxes, Fan, HitsMut, Packet, Slabs};
use crate::placed::Placed;
use crate::raster::{depths, is_within, rasterize};

/// Rays a packet: two vector registers of eight.
const LANES: usize = 16;
/// Rays a task of the parallel loop.
const RAYS_PER_TASK: usize = 1024;

/// One frame's instances with a search tree over them.
#[derive(Debug)]
pub(crate) struct CpuScene<'a> {
    snapshot: &'a Snapshot,
    /// The instances, and after them what stands behind panes.
    placed: Vec<Option<Placed<'a>>>,
    tree: Bvh,
    /// Over what stands behind panes.
    cabins: Bvh,
    split: OnceLock<Split>,
}

/// The instances of a frame, told apart by whether they moved since the previous one.
#[derive(Debug)]
struct Split {
    still: Bvh,
    still_cabins: Bvh,
    /// Numbers of the others.
    moving: Vec<u32>,
}

/// What rays are followed through: some of a list of instances.
struct Placement<'p, 'a> {
    placed: &'p [Option<Placed<'a>>],
    among: Among<'p>,
}

/// Which instances of a list, by their places in it.
#[derive(Clone, Copy)]
enum Among<'p> {
    /// The leaves of some trees.
    Trees(&'p [&'p Bvh]),
    /// Just these.
    Some(&'p [u32]),
}

impl Scene for CpuScene<'_> {
    fn snapshot(&self) -> &Snapshot {
        self.snapshot
    }

    fn look(&self, cameras: &[PinholeCamera]) -> Result<Vec<VisibilityBuffer>, RenderError> {
        let all = || self.instances();
        Ok(cameras.par_iter().map(|camera| rasterize(all(), camera)).collect())
    }

    fn look_at(&self, shots: &[Alone<'_>]) -> Result<Vec<VisibilityBuffer>, RenderError> {
        let some = |shot: &Alone<'_>| rasterize(self.numbered(shot.instances), &shot.camera);
        Ok(shots.par_iter().map(some).collect())
    }

    fn depths(&self, camera: &PinholeCamera, among: Option<&[u32]>) -> Result<Vec<f32>, RenderError> {
        Ok(match among {
            None => depths(self.instances(), camera, false),
            Some(some) => depths(self.numbered(some), camera, false),
        })
    }

    fn depths_through_panes(
        &self,
        camera: &PinholeCamera,
        among: Option<&[u32]>,
    ) -> Result<Vec<f32>, RenderError> {
        Ok(match among {
            None => depths(self.instances(), camera, true),
            Some(some) => depths(self.numbered(some), camera, true),
        })
    }

    fn beyond(&self, camera: &PinholeCamera, inner_px: f32, instances: &[u32]) -> Vec<u32> {
        let reaches_out = |placed: &Option<Placed<'_>>| {
            placed.as_ref().is_some_and(|placed| !is_within(placed, camera, inner_px))
        };
        self.numbered(instances).filter(|(_, placed)| reaches_out(placed)).map(|(number, _)| number).collect()
    }

    fn trace(&self, batches: &[RayBatch<'_>]) -> Result<Vec<Hits>, RenderError> {
        let all = Placement { placed: &self.placed, among: Among::Trees(&[&self.tree]) };
        Ok(batches.par_iter().map(|batch| all.trace(batch)).collect())
    }

    fn trace_at(&self, batches: &[AloneRays<'_>]) -> Result<Vec<Hits>, RenderError> {
        let alone = |one: &AloneRays<'_>| {
            Placement { placed: &self.placed, among: Among::Some(one.instances) }.trace(&one.rays)
        };
        Ok(batches.par_iter().map(alone).collect())
    }

    fn trace_before(&self, before: f32, batches: &[RayBatch<'_>]) -> Result<Vec<Hits>, RenderError> {
        Ok(self.trace_moment(before, self.snapshot.instances.len(), batches))
    }

    fn trace_behind(&self, before: f32, batches: &[RayBatch<'_>]) -> Result<Vec<Hits>, RenderError> {
        if before != 0.0 {
            return Ok(self.trace_moment(before, self.placed.len(), batches));
        }
        let all = Placement { placed: &self.placed, among: Among::Trees(&[&self.tree, &self.cabins]) };
        Ok(batches.par_iter().map(|batch| all.trace(batch)).collect())
    }
}

impl CpuScene<'_> {
    /// The closest surface along every ray at a moment, of those numbered below `end`.
    fn trace_moment(&self, before: f32, end: usize, batches: &[RayBatch<'_>]) -> Vec<Hits> {
        let split = self.split.get_or_init(|| self.split());
        let mut placed = self.placed.clone();
        let (mut numbers, mut boxes) = (Vec::new(), Vec::new());
        for &number in split.moving.iter().filter(|number| (**number as usize) < end) {
            let Some(there) = &mut placed[number as usize] else { continue };
            let Some(instance) = self.snapshot.behind(number) else { continue };
            let pose = pose_before(&instance.previous_local_from_object, &instance.local_from_object, before);
            let around = around(there, &pose);
            // Of many that drive about a town few are within a lidar's reach.
            if batches.iter().any(|batch| reaches(batch, &around)) {
                *there = Placed::new(there.mesh, &pose);
                boxes.push(around);
                numbers.push(number);
            }
        }
        let moving = tree_over(&numbers, &boxes);
        let with_cabins = [&split.still, &moving, &split.still_cabins];
        let trees = if end > self.snapshot.instances.len() { &with_cabins[..] } else { &with_cabins[..2] };
        let then = Placement { placed: &placed, among: Among::Trees(trees) };
        batches.par_iter().map(|batch| then.trace(batch)).collect()
    }
}

/// The box around an instance where it is.
fn around(placed: &Placed<'_>, pose: &Affine3A) -> Aabb {
    Aabb::from_points(&placed.mesh.aabb.corners().map(|corner| pose.transform_point3(corner)))
}

/// Whether something in a box may be met by rays of a batch.
fn reaches(batch: &RayBatch<'_>, around: &Aabb) -> bool {
    let nearest = batch.origin.clamp(around.min, around.max);
    let away = nearest.distance(batch.origin);
    // A hair more than their range: distances are rounded. Not a number reaches.
    away <= batch.range_m[1] * 1.001 || away.is_nan()
}

/// A tree whose leaves are instances.
fn tree_over(numbers: &[u32], boxes: &[Aabb]) -> Bvh {
    let mut tree = Bvh::build(boxes, QUICK);
    for slot in &mut tree.order {
        *slot = numbers[*slot as usize];
    }
    tree
}

impl<'a> CpuScene<'a> {
    /// Puts the instances of a snapshot over meshes, which are at least those of its list.
    pub(crate) fn new(meshes: &'a Meshes, snapshot: &'a Snapshot) -> Self {
        let mut placed = Vec::with_capacity(snapshot.instances.len() + snapshot.cabins.len());
        let [tree, cabins] = [&snapshot.instances, &snapshot.cabins].map(|instances| {
            let (mut numbers, mut boxes) = (Vec::with_capacity(instances.len()), Vec::new());
            boxes.reserve_exact(instances.len());
            for instance in instances {
                let mut there = place(meshes, instance);
                if let Some(there) = &mut there
                    && !there.mesh.panes.is_empty()
                {
                    there.has_cabin = snapshot.has_cabin(instance.object);
                }
                if let Some(there) = &there {
                    boxes.push(around(there, &instance.local_from_object));
                    numbers.push(placed.len() as u32);
                }
                placed.push(there);
            }
            tree_over(&numbers, &boxes)
        });
        Self { snapshot, placed, tree, cabins, split: OnceLock::new() }
    }

    /// The instances with their numbers, without what stands behind panes.
    fn instances<'s>(&'s self) -> impl Iterator<Item = (u32, &'s Option<Placed<'a>>)> {
        (0..).zip(&self.placed[..self.snapshot.instances.len()])
    }

    /// Some of the instances, with their numbers.
    fn numbered<'s>(&'s self, some: &'s [u32]) -> impl Iterator<Item = (u32, &'s Option<Placed<'a>>)> {
        some.iter().filter_map(|&i| Some((i, self.placed.get(i as usize)?)))
    }

    fn split(&self) -> Split {
        let mut moving = Vec::new();
        let mut number = 0;
        let [still, still_cabins] = [&self.snapshot.instances, &self.snapshot.cabins].map(|instances| {
            let (mut numbers, mut boxes) = (Vec::new(), Vec::new());
            for instance in instances {
                if let Some(placed) = &self.placed[number as usize] {
                    let (now, previous) = (&instance.local_from_object, &instance.previous_local_from_object);
                    // From a pose that is not finite nothing came.
                    if now == previous || !previous.is_finite() {
                        numbers.push(number);
                        boxes.push(around(placed, now));
                    } else {
                        moving.push(number);
                    }
                }
                number += 1;
            }
            tree_over(&numbers, &boxes)
        });
        Split { still, still_cabins, moving }
    }
}

/// An instance over its mesh; none if there is nothing to be seen of it.
fn place<'a>(meshes: &'a Meshes, instance: &Instance) -> Option<Placed<'a>> {
    let mesh = meshes.get(instance.mesh)?;
    let pose = &instance.local_from_object;
    (!mesh.bvh.nodes.is_empty() && pose.is_finite()).then(|| Placed::new(mesh, pose))
}

impl Placement<'_, '_> {
    fn trace(&self, batch: &RayBatch<'_>) -> Hits {
        let mut hits = Hits::none(batch.directions.len());
        hits.t
            .par_chunks_mut(RAYS_PER_TASK)
            .zip(hits.instance.par_chunks_mut(RAYS_PER_TASK))
            .zip(hits.triangle.par_chunks_mut(RAYS_PER_TASK))
            .zip(hits.u.par_chunks_mut(RAYS_PER_TASK))
            .zip(hits.v.par_chunks_mut(RAYS_PER_TASK))
            .enumerate()
            .for_each(|(task, ((((t, instance), triangle), u), v))| {
                let first = task * RAYS_PER_TASK;
                let mut out = HitsMut { t, instance, triangle, u, v };
                // A lane's bits do not depend on the other lanes, so a lone ray may have a packet of its own size.
                if out.t.len() == 1 {
                    self.follow::<1>(batch, first, &mut out);
                } else {
                    self.follow::<LANES>(batch, first, &mut out);
                }
            });
        hits
    }

    /// Follows rays of a batch from one on in packets of `N`.
    fn follow<const N: usize>(&self, batch: &RayBatch<'_>, first: usize, out: &mut HitsMut<'_>) {
        let rays = out.t.len();
        for at in (0..rays).step_by(N) {
            let mut packet = Packet::<N>::new(batch, first + at);
            if packet.is_narrow() {
                self.meet::<N, Fan>(&mut packet);
            } else {
                self.meet::<N, Slabs<N>>(&mut packet);
            }
            packet.store(N.min(rays - at), at, out);
        }
    }

    /// Follows a packet, which meets boxes by one of the ways to do so.
    fn meet<const N: usize, B: Boxes<N>>(&self, packet: &mut Packet<N>) {
        match self.among {
            Among::Trees(trees) => trees.iter().for_each(|tree| self.walk::<N, B>(tree, packet)),
            // Few: a tree would cost more than it saves.
            Among::Some(some) => {
                for &instance in some {
                    if let Some(Some(placed)) = self.placed.get(instance as usize) {
                        packet.visit::<B>(instance, placed);
                    }
                }
            }
        }
    }

    /// Walks a tree of instances front to back.
    fn walk<const N: usize, B: Boxes<N>>(&self, tree: &Bvh, packet: &mut Packet<N>) {
        let Some(root) = tree.nodes.first() else { return };
        let reach = root.min.abs().max(root.max.abs()).max_element();
        let (origin, lanes) = packet.lanes_local();
        let boxes = B::new(&lanes, origin, reach);
        let mut stack = Stack::new((0u32, 0.0f32));
        stack.push((0, boxes.entry(packet, root)));
        while let Some((index, entry)) = stack.pop() {
            if !packet.may_be_closer(entry) {
                continue;
            }
            let node = &tree.nodes[index as usize];
            if node.child == 0 {
                for &instance in &tree.order[node.first as usize..(node.first + node.count) as usize] {
                    if let Some(placed) = &self.placed[instance as usize] {
                        packet.visit::<B>(instance, placed);
                    }
                }
            } else {
                packet.push_children(&boxes, &tree.nodes, node.child, &mut stack);
            }
        }
    }
}
