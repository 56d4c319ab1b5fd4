//! The instances of one frame over their meshes.

use frames::Aabb;
use glam::Vec3;
use rayon::prelude::*;
use renderer::{Alone, AloneRays, Hits, PinholeCamera, RayBatch, RenderError, Scene, VisibilityBuffer};
use schema::geometry::Snapshot;

use crate::bvh::{Bvh, QUICK, Stack};
use crate::meshes::Meshes;
use crate::packet::{HitsMut, Packet};
use crate::placed::Placed;
use crate::raster::rasterize;

/// Rays a packet: two vector registers of eight.
const LANES: usize = 16;
/// Rays a task of the parallel loop.
const RAYS_PER_TASK: usize = 1024;

/// One frame's instances with a search tree over them.
#[derive(Debug)]
pub(crate) struct CpuScene<'a> {
    snapshot: &'a Snapshot,
    placed: Vec<Option<Placed<'a>>>,
    tree: Bvh,
}

impl Scene for CpuScene<'_> {
    fn snapshot(&self) -> &Snapshot {
        self.snapshot
    }

    fn look(&self, cameras: &[PinholeCamera]) -> Result<Vec<VisibilityBuffer>, RenderError> {
        let all = || (0..).zip(&self.placed);
        Ok(cameras.par_iter().map(|camera| rasterize(all(), camera)).collect())
    }

    fn look_at(&self, shots: &[Alone<'_>]) -> Result<Vec<VisibilityBuffer>, RenderError> {
        let some = |shot: &Alone<'_>| {
            let placed = shot.instances.iter().filter_map(|&i| Some((i, self.placed.get(i as usize)?)));
            rasterize(placed, &shot.camera)
        };
        Ok(shots.par_iter().map(some).collect())
    }

    fn trace(&self, batches: &[RayBatch<'_>]) -> Result<Vec<Hits>, RenderError> {
        Ok(batches.par_iter().map(|batch| self.trace_batch(batch, None)).collect())
    }

    fn trace_at(&self, batches: &[AloneRays<'_>]) -> Result<Vec<Hits>, RenderError> {
        Ok(batches.par_iter().map(|alone| self.trace_batch(&alone.rays, Some(alone.instances))).collect())
    }
}

impl<'a> CpuScene<'a> {
    /// Puts the instances of a snapshot over meshes, which are at least those of its list.
    pub(crate) fn new(meshes: &'a Meshes, snapshot: &'a Snapshot) -> Self {
        let mut boxes = Vec::with_capacity(snapshot.instances.len());
        let mut numbers = Vec::with_capacity(snapshot.instances.len());
        let placed: Vec<Option<Placed<'a>>> = snapshot
            .instances
            .iter()
            .enumerate()
            .map(|(number, instance)| {
                let pose = instance.local_from_object;
                let mesh = meshes.get(instance.mesh)?;
                if mesh.bvh.nodes.is_empty() || !pose.is_finite() {
                    return None;
                }
                let corners = mesh.aabb.corners().map(|c| pose.transform_point3(c));
                boxes.push(Aabb::from_points(&corners));
                numbers.push(number as u32);
                Some(Placed { mesh, rotation: pose.matrix3.into(), translation: pose.translation.into() })
            })
            .collect();
        let mut tree = Bvh::build(&boxes, QUICK);
        for slot in &mut tree.order {
            *slot = numbers[*slot as usize];
        }
        Self { snapshot, placed, tree }
    }

    /// Follows rays, past all instances or some.
    fn trace_batch(&self, batch: &RayBatch<'_>, only: Option<&[u32]>) -> Hits {
        let mut hits = Hits::none(batch.directions.len());
        let directions = batch.directions.par_chunks(RAYS_PER_TASK);
        directions
            .zip(hits.t.par_chunks_mut(RAYS_PER_TASK))
            .zip(hits.instance.par_chunks_mut(RAYS_PER_TASK))
            .zip(hits.triangle.par_chunks_mut(RAYS_PER_TASK))
            .zip(hits.u.par_chunks_mut(RAYS_PER_TASK))
            .zip(hits.v.par_chunks_mut(RAYS_PER_TASK))
            .for_each(|(((((directions, t), instance), triangle), u), v)| {
                let mut out = HitsMut { t, instance, triangle, u, v };
                // A lane's bits do not depend on the other lanes, so a lone ray may have a packet of its own size.
                if directions.len() == 1 {
                    self.follow::<1>(batch, directions, only, &mut out);
                } else {
                    self.follow::<LANES>(batch, directions, only, &mut out);
                }
            });
        hits
    }

    /// Follows rays of a batch in packets of `N`.
    fn follow<const N: usize>(
        &self,
        batch: &RayBatch<'_>,
        directions: &[Vec3],
        only: Option<&[u32]>,
        out: &mut HitsMut<'_>,
    ) {
        let [t_min, t_max] = batch.range_m;
        for (number, directions) in directions.chunks(N).enumerate() {
            let mut packet = Packet::<N>::new(batch.origin, directions, t_min, t_max);
            match only {
                None => self.walk(&mut packet),
                // Few: a tree would cost more than it saves.
                Some(some) => {
                    for &instance in some {
                        if let Some(Some(placed)) = self.placed.get(instance as usize) {
                            packet.visit(instance, placed);
                        }
                    }
                }
            }
            packet.store(directions.len(), number * N, out);
        }
    }

    /// Walks the tree of instances front to back.
    fn walk<const N: usize>(&self, packet: &mut Packet<N>) {
        let Some(root) = self.tree.nodes.first() else { return };
        let reach = root.min.abs().max(root.max.abs()).max_element();
        let (origin, lanes) = packet.lanes_local();
        let slabs = lanes.slabs(origin, reach);
        let mut stack = Stack::new((0u32, 0.0f32));
        stack.push((0, packet.entry(&slabs, root)));
        while let Some((index, entry)) = stack.pop() {
            if !packet.may_be_closer(entry) {
                continue;
            }
            let node = &self.tree.nodes[index as usize];
            if node.child == 0 {
                for &instance in &self.tree.order[node.first as usize..(node.first + node.count) as usize] {
                    if let Some(placed) = &self.placed[instance as usize] {
                        packet.visit(instance, placed);
                    }
                }
            } else {
                packet.push_children(&slabs, &self.tree.nodes, node.child, &mut stack);
            }
        }
    }
}
