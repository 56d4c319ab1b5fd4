//! What the kernel for rays is told: rays, and the instances that they may meet, as the words that
//! `rays.wgsl` reads.

use std::ops::Range;
use std::ptr;

use glam::Vec3;
use render::cpu::{Among, Placement};
use render::prepared::{Bvh, Placed};
use render::{Hits, RayQuery};

use crate::meshes::{DEEPEST, FARTHEST_M, ResidentMeshes};

/// Words before the groups: how many groups, and where groups, queries and instances begin.
const HEADER: usize = 4;
const GROUP_WORDS: usize = 2;
const QUERY_WORDS: usize = 15;
const RECORD_WORDS: usize = 16;
/// Rays that a workgroup follows.
const GROUP_RAYS: usize = 64;
/// Words of an answer.
const ANSWER_WORDS: usize = 5;
/// Rays of a query that are asked for together: a power of two of groups.
const PART_RAYS: usize = 1 << 16;
/// No tree, no list.
const NONE: u32 = u32::MAX;

/// Rays that a device is to follow.
pub(crate) struct AskedRays<'a> {
    query: RayQuery<'a>,
    placement: Placement<'a>,
}

/// Some rays of some queries, in one call of the kernel.
#[derive(Debug)]
pub(crate) struct RayJob {
    /// What the kernel reads.
    pub(crate) words: Vec<u32>,
    /// How many words it answers.
    pub(crate) answers: usize,
    groups: usize,
    parts: Vec<Part>,
}

/// Some rays of a query, and where their answers begin.
#[derive(Clone, Debug)]
struct Part {
    query: usize,
    rays: Range<usize>,
    answer: usize,
}

/// Trees and instances that were written down.
#[derive(Default)]
struct Written<'a> {
    nodes: Vec<u32>,
    records: Vec<u32>,
    /// Where the nodes of each tree begin.
    trees: Vec<(&'a Bvh, u32)>,
}

impl<'a> AskedRays<'a> {
    /// Rays among instances of meshes on the device; `None` if a kernel cannot follow them as the CPU does.
    pub(crate) fn new(
        query: &RayQuery<'a>,
        placement: Placement<'a>,
        meshes: &ResidentMeshes,
    ) -> Option<Self> {
        let can_be_met = |number: u32| match placement.placed.get(number as usize) {
            Some(Some(placed)) => meshes.place(placed.mesh_number).is_some() && reach_m(placed) <= FARTHEST_M,
            _ => true,
        };
        let is_near = query.rays.origin.abs().max_element() <= FARTHEST_M;
        let is_walkable = match placement.among {
            Among::Some(some) => some.iter().all(|&number| can_be_met(number)),
            Among::Trees(trees) => {
                trees.iter().all(|tree| tree.depth() <= DEEPEST && tree.order.iter().all(|&n| can_be_met(n)))
            }
        };
        (is_near && is_walkable).then_some(Self { query: *query, placement })
    }

    pub(crate) fn rays(&self) -> usize {
        self.query.rays.directions.len()
    }
}

impl RayJob {
    /// All rays, in calls that answer no more than so many words (some rays at least).
    pub(crate) fn split(asked: &[AskedRays<'_>], meshes: &ResidentMeshes, most_words: usize) -> Vec<Self> {
        let mut jobs = Vec::new();
        let (mut parts, mut answers) = (Vec::new(), 0);
        for (query, of_query) in asked.iter().enumerate() {
            for first in (0..of_query.rays()).step_by(PART_RAYS) {
                let rays = first..of_query.rays().min(first + PART_RAYS);
                let words = ANSWER_WORDS * rays.len();
                if !parts.is_empty() && answers + words > most_words {
                    jobs.push(Self::of(asked, meshes, std::mem::take(&mut parts), answers));
                    answers = 0;
                }
                parts.push(Part { query, rays, answer: answers });
                answers += words;
            }
        }
        if !parts.is_empty() {
            jobs.push(Self::of(asked, meshes, parts, answers));
        }
        jobs
    }

    /// Workgroups: one for some rays.
    pub(crate) fn workgroups(&self) -> u32 {
        self.groups as u32
    }

    fn of(asked: &[AskedRays<'_>], meshes: &ResidentMeshes, parts: Vec<Part>, answers: usize) -> Self {
        let mut written = Written::default();
        let (mut groups, mut rays, mut queries) = (Vec::new(), Vec::new(), Vec::new());
        for (number, part) in parts.iter().enumerate() {
            let AskedRays { query, placement } = &asked[part.query];
            let batch = &query.rays;
            let starts = (0..part.rays.len()).step_by(GROUP_RAYS);
            groups.extend(starts.flat_map(|first| [number as u32, first as u32]));
            let directions_at = rays.len() as u32;
            let of_part = &batch.directions[part.rays.clone()];
            rays.extend(of_part.iter().flat_map(|direction| direction.to_array().map(f32::to_bits)));
            let nearest_at = (!batch.nearest_m.is_empty()).then_some(rays.len() as u32);
            let nearest_m = |ray: usize| batch.nearest_m(ray).max(0.0).to_bits();
            if nearest_at.is_some() {
                rays.extend(part.rays.clone().map(nearest_m));
            }
            let (trees, some) = written.among(placement, meshes);
            queries.push((directions_at, nearest_at, trees, some));
        }
        let groups_at = HEADER;
        let queries_at = groups_at + groups.len();
        let nodes_at = queries_at + QUERY_WORDS * queries.len();
        let rays_at = nodes_at + written.nodes.len();
        let records_at = rays_at + rays.len();
        let count = groups.len() / GROUP_WORDS;
        let mut words = vec![count as u32, groups_at as u32, queries_at as u32, records_at as u32];
        words.extend(groups);
        let from = |at: usize, word: Option<u32>| word.map_or(NONE, |word| at as u32 + word);
        for (part, (directions_at, nearest_at, trees, some)) in parts.iter().zip(queries) {
            let batch = &asked[part.query].query.rays;
            // A finite bound also rejects the infinite distances of rays within a triangle's plane.
            let ends = [batch.range_m[1].min(f32::MAX), batch.range_m[0].max(0.0)];
            words.extend(batch.origin.to_array().into_iter().chain(ends).map(f32::to_bits));
            words.extend([part.rays.len() as u32, from(rays_at, Some(directions_at))]);
            words.extend([from(rays_at, nearest_at), part.answer as u32]);
            words.extend(trees.map(|tree| from(nodes_at, tree)));
            words.extend([some.start, some.len() as u32]);
        }
        let Written { nodes, records, .. } = written;
        words.extend([nodes, rays, records].into_iter().flatten());
        Self { words, answers, groups: count, parts }
    }

    /// Puts a query's answers into its list.
    pub(crate) fn store(&self, answers: &[u32], query: usize, to: &mut Hits) {
        for part in self.parts.iter().filter(|part| part.query == query) {
            let rays = part.rays.len();
            let words = |plane: usize| &answers[part.answer + plane * rays..][..rays];
            to.t[part.rays.clone()].copy_from_slice(bytemuck::cast_slice(words(0)));
            to.instance[part.rays.clone()].copy_from_slice(words(1));
            to.triangle[part.rays.clone()].copy_from_slice(words(2));
            to.u[part.rays.clone()].copy_from_slice(bytemuck::cast_slice(words(3)));
            to.v[part.rays.clone()].copy_from_slice(bytemuck::cast_slice(words(4)));
        }
    }
}

impl<'a> Written<'a> {
    /// Where the trees of a placement begin, and its instances that are in no tree.
    fn among(
        &mut self,
        placement: &Placement<'a>,
        meshes: &ResidentMeshes,
    ) -> ([Option<u32>; 4], Range<u32>) {
        let Placement { placed, among } = placement;
        match among {
            Among::Trees(trees) => (trees.map(|tree| self.tree(tree, placed, meshes)), 0..0),
            Among::Some(some) => {
                let first = self.count();
                // Of nothing there is nothing to be met.
                let there =
                    some.iter().filter_map(|&number| Some((number, placed.get(number as usize)?.as_ref()?)));
                there.for_each(|(number, placed)| self.record(number, placed, meshes));
                ([None; 4], first..self.count())
            }
        }
    }

    /// Where a tree over instances begins, unless it is empty. One tree is always about the same instances at
    /// the same places.
    fn tree(&mut self, tree: &'a Bvh, placed: &[Option<Placed<'_>>], meshes: &ResidentMeshes) -> Option<u32> {
        if tree.nodes.is_empty() {
            return None;
        }
        if let Some((_, at)) = self.trees.iter().find(|(known, _)| ptr::eq(*known, tree)) {
            return Some(*at);
        }
        let (at, first_record) = (self.nodes.len() as u32, self.count());
        for node in &tree.nodes {
            let [first, count] =
                if node.child == 0 { [first_record + node.first, node.count] } else { [node.child, 0] };
            let corner = |p: Vec3, word| [p.x.to_bits(), p.y.to_bits(), p.z.to_bits(), word];
            self.nodes.extend(corner(node.min, first));
            self.nodes.extend(corner(node.max, count));
        }
        for &number in &tree.order {
            // Leaves of trees are there.
            if let Some(Some(placed)) = placed.get(number as usize) {
                self.record(number, placed, meshes);
            }
        }
        self.trees.push((tree, at));
        Some(at)
    }

    fn record(&mut self, number: u32, placed: &Placed<'_>, meshes: &ResidentMeshes) {
        let Placed { rotation, translation, mesh, mesh_number, .. } = placed;
        let turned = rotation.to_cols_array().into_iter().chain(translation.to_array());
        self.records.extend(turned.map(f32::to_bits));
        // It was asked whether it is there.
        let (node, slot) = meshes.place(*mesh_number).map_or((0, 0), |place| (place.node, place.slot));
        let reach_m = mesh.aabb.min.abs().max(mesh.aabb.max.abs()).max_element();
        self.records.extend([node, slot, number, reach_m.to_bits()]);
    }

    fn count(&self) -> u32 {
        (self.records.len() / RECORD_WORDS) as u32
    }
}

/// The largest coordinate of an instance, in the object's and in the local frame.
fn reach_m(placed: &Placed<'_>) -> f32 {
    let aabb = &placed.mesh.aabb;
    aabb.min.abs().max(aabb.max.abs()).max_element() + placed.translation.abs().max_element()
}
