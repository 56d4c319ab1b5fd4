//! The instances of one frame over their meshes.

use std::sync::OnceLock;

use crate::{
    CameraQuery, Hits, PinholeCamera, RayBatch, RayQuery, RenderError, Scene, VisibilityBuffer, pose_before,
};
use frames::Aabb;
use glam::Affine3A;
use rayon::prelude::*;
use schema::geometry::{HORIZON, Instance, Snapshot};

use crate::cpu::packet::{Boxes, Fan, HitsMut, Packet, Slabs};
use crate::cpu::raster::rasterize;
use crate::prepared::{Bvh, Meshes, Placed, QUICK, Stack, TiledView, is_within};

/// Rays a packet: two vector registers of eight.
const LANES: usize = 16;
/// Rays a task of the parallel loop.
const RAYS_PER_TASK: usize = 1024;

/// One frame's instances with a search tree over them.
#[derive(Debug)]
pub struct CpuScene<'a> {
    snapshot: &'a Snapshot,
    /// The instances, and after them objects behind panes.
    placed: Vec<Option<Placed<'a>>>,
    /// Over instances, and over objects behind panes: made when rays are first followed.
    trees: OnceLock<[Bvh; 2]>,
    split: OnceLock<Split>,
}

/// The instances of a frame, told apart by whether they moved since the previous one.
#[derive(Debug)]
struct Split {
    still: Bvh,
    still_cabins: Bvh,
    /// Numbers of the others.
    moving: Vec<u32>,
    /// The same of what is behind panes.
    moving_cabins: Vec<u32>,
}

/// The instances of a frame at a moment before it.
struct Moment<'a> {
    /// 0 is the frame, 1 the previous one.
    before: f32,
    placed: Vec<Option<Placed<'a>>>,
    split: &'a Split,
    moving: Bvh,
    moving_cabins: Bvh,
}

/// A tree over nothing.
static NOTHING: Bvh = Bvh { nodes: Vec::new(), order: Vec::new() };

/// What the rays of some queries are followed through.
pub struct Placements<'s> {
    scene: &'s CpuScene<'s>,
    moments: Vec<Moment<'s>>,
}

/// What rays are followed through: some of a list of instances.
pub struct Placement<'p> {
    /// The list; `None` where there is nothing to be met.
    pub placed: &'p [Option<Placed<'p>>],
    /// Which of it.
    pub among: Among<'p>,
}

/// Which instances of a list, by their places in it.
#[derive(Clone, Copy, Debug)]
pub enum Among<'p> {
    /// The leaves of some trees, which may be empty.
    Trees([&'p Bvh; 4]),
    /// Just these.
    Some(&'p [u32]),
}

impl Scene for CpuScene<'_> {
    fn snapshot(&self) -> &Snapshot {
        self.snapshot
    }

    fn render(&self, queries: &[CameraQuery<'_>]) -> Result<Vec<VisibilityBuffer>, RenderError> {
        Ok(queries.par_iter().map(|query| rasterize(&self.tiled(query), query.outputs)).collect())
    }

    fn trace(&self, queries: &[RayQuery<'_>]) -> Result<Vec<Hits>, RenderError> {
        let placements = self.placements(queries);
        Ok(queries.par_iter().map(|query| placements.of(query).trace(&query.rays)).collect())
    }

    fn beyond(&self, camera: &PinholeCamera, inner_px: f32, instances: &[u32]) -> Vec<u32> {
        let reaches_out = |placed: &Option<Placed<'_>>| {
            placed.as_ref().is_some_and(|placed| !is_within(placed, camera, inner_px))
        };
        self.numbered(instances).filter(|(_, placed)| reaches_out(placed)).map(|(number, _)| number).collect()
    }
}

impl CpuScene<'_> {
    /// What the rays of queries are followed through.
    #[must_use]
    pub fn placements(&self, queries: &[RayQuery<'_>]) -> Placements<'_> {
        let mut before: Vec<f32> =
            queries.iter().map(|query| query.before).filter(|before| *before != 0.0).collect();
        before.sort_by(f32::total_cmp);
        before.dedup_by_key(|before| before.to_bits());
        let moment = |&before: &f32| {
            self.moment(before, queries.iter().filter(|query| query.before.to_bits() == before.to_bits()))
        };
        Placements { scene: self, moments: before.par_iter().map(moment).collect() }
    }

    /// The instances at a moment before this frame, as far as rays asked about it may meet them.
    fn moment<'q>(&self, before: f32, queries: impl Iterator<Item = &'q RayQuery<'q>> + Clone) -> Moment<'_> {
        let split = self.split.get_or_init(|| self.split());
        let with_cabins = queries.clone().any(|query| query.cabins || query.among.is_some());
        let mut placed = self.placed.clone();
        let mut moved = |moving: &[u32]| {
            let (mut numbers, mut boxes) = (Vec::new(), Vec::new());
            for &number in moving {
                let Some(there) = &mut placed[number as usize] else { continue };
                let Some(instance) = self.snapshot.behind(number) else { continue };
                let pose =
                    pose_before(&instance.previous_local_from_object, &instance.local_from_object, before);
                let around = around(there, &pose);
                // Of many that drive about a town few are within a lidar's reach.
                if queries.clone().any(|query| reaches(&query.rays, &around)) {
                    *there = Placed::new((there.mesh_number, there.mesh), &pose);
                    boxes.push(around);
                    numbers.push(number);
                }
            }
            tree_over(&numbers, &boxes)
        };
        let moving = moved(&split.moving);
        let moving_cabins = if with_cabins { moved(&split.moving_cabins) } else { Bvh::default() };
        Moment { before, placed, split, moving, moving_cabins }
    }
}

impl Placements<'_> {
    /// What the rays of a query are followed through, which was among those asked about.
    #[must_use]
    pub fn of<'p>(&'p self, query: &RayQuery<'p>) -> Placement<'p> {
        let moment = self.moments.iter().find(|moment| moment.is_of(query));
        let (placed, trees) = match moment {
            None => {
                let [tree, cabins] = self.scene.trees();
                (&self.scene.placed, [tree, cabins, &NOTHING, &NOTHING])
            }
            Some(Moment { placed, moving, moving_cabins, split, .. }) => {
                (placed, [&split.still, &split.still_cabins, moving, moving_cabins])
            }
        };
        let [all, cabins, moving, moving_cabins] = trees;
        let among = match query.among {
            Some(some) => Among::Some(some),
            None if query.cabins => Among::Trees([all, moving, cabins, moving_cabins]),
            None => Among::Trees([all, moving, &NOTHING, &NOTHING]),
        };
        Placement { placed, among }
    }
}

impl Moment<'_> {
    fn is_of(&self, query: &RayQuery<'_>) -> bool {
        self.before.to_bits() == query.before.to_bits()
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
        for instance in snapshot.instances.iter().chain(&snapshot.cabins) {
            let mut there = place(meshes, instance);
            if let Some(there) = &mut there
                && !there.mesh.panes.is_empty()
            {
                there.has_cabin = snapshot.has_cabin(instance.object);
            }
            placed.push(there);
        }
        Self { snapshot, placed, trees: OnceLock::new(), split: OnceLock::new() }
    }

    fn trees(&self) -> &[Bvh; 2] {
        self.trees.get_or_init(|| {
            let mut number = 0;
            [&self.snapshot.instances, &self.snapshot.cabins].map(|instances| {
                let (mut numbers, mut boxes) = (Vec::with_capacity(instances.len()), Vec::new());
                for instance in instances {
                    if let Some(there) = &self.placed[number as usize]
                        && instance.object != HORIZON
                    {
                        boxes.push(around(there, &instance.local_from_object));
                        numbers.push(number);
                    }
                    number += 1;
                }
                tree_over(&numbers, &boxes)
            })
        })
    }

    /// What a camera may see, tile by tile.
    #[must_use]
    pub fn tiled(&self, query: &CameraQuery<'_>) -> TiledView<'a> {
        match query.among {
            None => TiledView::new(self.instances(), &query.camera, query.panes),
            Some(some) => TiledView::new(self.numbered(some), &query.camera, query.panes),
        }
    }

    /// The instances with their numbers, without objects behind panes.
    fn instances<'s>(&'s self) -> impl Iterator<Item = (u32, &'s Option<Placed<'a>>)> {
        (0..).zip(&self.placed[..self.snapshot.instances.len()])
    }

    /// Some of the instances, with their numbers.
    fn numbered<'s>(&'s self, some: &'s [u32]) -> impl Iterator<Item = (u32, &'s Option<Placed<'a>>)> {
        some.iter().filter_map(|&i| Some((i, self.placed.get(i as usize)?)))
    }

    fn split(&self) -> Split {
        let mut number = 0;
        let [(still, moving), (still_cabins, moving_cabins)] =
            [&self.snapshot.instances, &self.snapshot.cabins].map(|instances| {
                let (mut numbers, mut boxes, mut moving) = (Vec::new(), Vec::new(), Vec::new());
                for instance in instances {
                    if let Some(placed) = &self.placed[number as usize]
                        && instance.object != HORIZON
                    {
                        let (now, previous) =
                            (&instance.local_from_object, &instance.previous_local_from_object);
                        // An instance whose previous pose is not finite has just appeared: it did not move.
                        if now == previous || !previous.is_finite() {
                            numbers.push(number);
                            boxes.push(around(placed, now));
                        } else {
                            moving.push(number);
                        }
                    }
                    number += 1;
                }
                (tree_over(&numbers, &boxes), moving)
            });
        Split { still, still_cabins, moving, moving_cabins }
    }
}

/// An instance over its mesh; none if there is nothing to be seen of it.
fn place<'a>(meshes: &'a Meshes, instance: &Instance) -> Option<Placed<'a>> {
    let mesh = meshes.get(instance.mesh)?;
    let pose = &instance.local_from_object;
    (!mesh.bvh.nodes.is_empty() && pose.is_finite()).then(|| Placed::new((instance.mesh, mesh), pose))
}

impl Placement<'_> {
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
                // A lane's bits do not depend on the other lanes, so a lone ray may have a packet of its own
                // size.
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
