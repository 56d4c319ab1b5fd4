//! The instances of one frame over their meshes.

use frames::Aabb;
use glam::{Mat3, Vec3};
use rayon::prelude::*;
use schema::geometry::Snapshot;

use crate::bvh::{Bvh, QUICK, Stack};
use crate::meshes::{MeshData, Meshes};
use crate::packet::Packet;
use crate::ray::{Hit, Ray};

/// Rays a packet: two vector registers of eight.
const LANES: usize = 16;
/// Rays a task of the parallel loop.
const RAYS_PER_TASK: usize = 1024;

/// One instance that can be seen.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Placed<'a> {
    pub(crate) mesh: &'a MeshData,
    pub(crate) rotation: Mat3,
    pub(crate) translation: Vec3,
}

/// One frame's instances with a search tree over them.
#[derive(Debug)]
pub struct Scene<'a> {
    snapshot: &'a Snapshot,
    placed: Vec<Option<Placed<'a>>>,
    tree: Bvh,
}

impl<'a> Scene<'a> {
    /// Puts the instances of a snapshot over prepared meshes.
    ///
    /// `meshes` must have been built from (at least) the snapshot's mesh list. Instances of meshes that it does
    /// not hold, of empty meshes, or with poses that are not finite are not seen.
    #[must_use]
    pub fn new(meshes: &'a Meshes, snapshot: &'a Snapshot) -> Self {
        debug_assert!(meshes.len() >= snapshot.meshes.len(), "meshes were appended and not prepared");
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

    /// The snapshot that this scene shows.
    #[must_use]
    pub fn snapshot(&self) -> &'a Snapshot {
        self.snapshot
    }

    pub(crate) fn placed(&self, instance: u32) -> Option<&Placed<'a>> {
        self.placed.get(instance as usize)?.as_ref()
    }

    pub(crate) fn all_placed(&self) -> &[Option<Placed<'a>>] {
        &self.placed
    }

    /// The closest surface along a ray.
    #[must_use]
    pub fn trace(&self, ray: &Ray) -> Option<Hit> {
        let mut packet = Packet::<1>::new(ray.origin, &[ray.direction], ray.t_min, ray.t_max);
        self.follow::<1, false>(&mut packet);
        packet.hit(0)
    }

    /// Whether anything lies along a ray.
    #[must_use]
    pub fn occluded(&self, ray: &Ray) -> bool {
        let mut packet = Packet::<1>::new(ray.origin, &[ray.direction], ray.t_min, ray.t_max);
        self.follow::<1, true>(&mut packet)
    }

    /// The closest surfaces along many rays from one point (a lidar's, a radar's), in parallel.
    ///
    /// Gives what [`Scene::trace`] gives for each, bit for bit. Rays are followed in packets of 16 consecutive
    /// directions: the closer together those are, the faster. Directions beyond the length of `out` are left out
    /// and places beyond the length of `directions` are not written.
    pub fn trace_packet_shared_origin(
        &self,
        origin: Vec3,
        directions: &[Vec3],
        t_min: f32,
        t_max: f32,
        out: &mut [Option<Hit>],
    ) {
        let count = directions.len().min(out.len());
        let tasks = directions[..count].par_chunks(RAYS_PER_TASK);
        tasks.zip(out[..count].par_chunks_mut(RAYS_PER_TASK)).for_each(|(directions, out)| {
            for (directions, out) in directions.chunks(LANES).zip(out.chunks_mut(LANES)) {
                let mut packet = Packet::<LANES>::new(origin, directions, t_min, t_max);
                self.follow::<LANES, false>(&mut packet);
                for (lane, hit) in out.iter_mut().enumerate() {
                    *hit = packet.hit(lane);
                }
            }
        });
    }

    /// Walks the tree of instances front to back; with `ANY`, stops at the first hit and tells whether there is
    /// one.
    fn follow<const N: usize, const ANY: bool>(&self, packet: &mut Packet<N>) -> bool {
        let Some(root) = self.tree.nodes.first() else { return false };
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
                    if let Some(placed) = &self.placed[instance as usize]
                        && packet.visit::<ANY>(instance, placed)
                    {
                        return true;
                    }
                }
            } else {
                packet.push_children(&slabs, &self.tree.nodes, node.child, &mut stack);
            }
        }
        false
    }
}
