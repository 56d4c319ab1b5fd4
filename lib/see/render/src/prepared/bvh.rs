//! Binary bounding volume hierarchies, built by `obvhs` and laid out depth first.
//!
//! Depth-first order makes the primitives below any node one contiguous range, so a traversal may stop at an
//! inner node and take the whole range in batches.

use frames::Aabb;
use glam::Vec3;
use obvhs::{BvhBuildParams, ploc::PlocSearchDistance};

/// One box of the tree and the primitives below it.
#[derive(Clone, Copy, Debug)]
pub struct Node {
    /// Lower corner.
    pub min: Vec3,
    /// Upper corner.
    pub max: Vec3,
    /// First primitive below, as an index into [`Bvh::order`].
    pub first: u32,
    /// How many primitives are below.
    pub count: u32,
    /// Index of the left child, the right one follows it; 0 marks a leaf (the root is nobody's child).
    pub child: u32,
}

/// A tree over boxes.
#[derive(Clone, Debug, Default)]
pub struct Bvh {
    /// Root first; empty when there are no primitives.
    pub nodes: Vec<Node>,
    /// Primitive numbers, depth first.
    pub order: Vec<u32>,
}

/// For trees that live as long as a scene.
pub(crate) const THOROUGH: BvhBuildParams =
    BvhBuildParams { max_prims_per_leaf: 4, ..BvhBuildParams::medium_build() };

/// For trees that live for one frame: one primitive a leaf, no optimisation passes.
pub(crate) const QUICK: BvhBuildParams = BvhBuildParams {
    ploc_search_distance: PlocSearchDistance::Low,
    search_depth_threshold: 2,
    ..BvhBuildParams::fastest_build()
};

struct Boxed(obvhs::aabb::Aabb);

impl obvhs::Boundable for Boxed {
    fn aabb(&self) -> obvhs::aabb::Aabb {
        self.0
    }
}

impl Bvh {
    /// How many nodes lie between the root and the one farthest below it.
    #[must_use]
    pub fn depth(&self) -> u32 {
        let mut depth = vec![0u32; self.nodes.len()];
        for (at, node) in self.nodes.iter().enumerate() {
            // Children come after their parents.
            if node.child != 0 {
                let (child, below) = (node.child as usize, depth[at] + 1);
                depth[child..child + 2].fill(below);
            }
        }
        depth.into_iter().max().unwrap_or(0)
    }

    /// Builds a tree; the boxes must be finite and not empty.
    pub(crate) fn build(boxes: &[Aabb], params: BvhBuildParams) -> Self {
        if boxes.is_empty() {
            return Self::default();
        }
        let primitives: Vec<Boxed> =
            boxes.iter().map(|b| Boxed(obvhs::aabb::Aabb { min: b.min.into(), max: b.max.into() })).collect();
        let tree = obvhs::bvh2::builder::build_bvh2(&primitives, params, &mut std::time::Duration::default());
        Self::from_obvhs(&tree)
    }

    fn from_obvhs(tree: &obvhs::bvh2::Bvh2) -> Self {
        enum Step {
            Enter { source: usize, target: usize },
            Leave { target: usize },
        }
        let empty = Node { min: Vec3::ZERO, max: Vec3::ZERO, first: 0, count: 0, child: 0 };
        let mut nodes = Vec::with_capacity(tree.nodes.len());
        nodes.push(empty);
        let mut order = Vec::with_capacity(tree.primitive_indices.len());
        // An explicit stack: a tree over many equal boxes can be deeper than the call stack allows.
        let mut steps = vec![Step::Enter { source: 0, target: 0 }];
        while let Some(step) = steps.pop() {
            match step {
                Step::Enter { source, target } => {
                    let from = &tree.nodes[source];
                    let first = from.first_index as usize;
                    nodes[target] = Node {
                        min: from.aabb.min.into(),
                        max: from.aabb.max.into(),
                        first: order.len() as u32,
                        count: from.prim_count,
                        child: 0,
                    };
                    if from.is_leaf() {
                        order.extend_from_slice(
                            &tree.primitive_indices[first..first + from.prim_count as usize],
                        );
                    } else {
                        let child = nodes.len();
                        nodes[target].child = child as u32;
                        nodes.extend([empty; 2]);
                        steps.push(Step::Leave { target });
                        steps.push(Step::Enter { source: first + 1, target: child + 1 });
                        steps.push(Step::Enter { source: first, target: child });
                    }
                }
                Step::Leave { target } => nodes[target].count = order.len() as u32 - nodes[target].first,
            }
        }
        Self { nodes, order }
    }
}

/// A traversal stack: fixed room, and a heap behind it for trees of unusual depth.
pub(crate) struct Stack<T> {
    fixed: [T; 64],
    len: usize,
    spill: Vec<T>,
}

impl<T: Copy> Stack<T> {
    /// An empty stack; `filler` is never returned.
    pub(crate) fn new(filler: T) -> Self {
        Self { fixed: [filler; 64], len: 0, spill: Vec::new() }
    }

    #[inline]
    pub(crate) fn push(&mut self, item: T) {
        if let Some(slot) = self.fixed.get_mut(self.len) {
            *slot = item;
            self.len += 1;
        } else {
            self.spill.push(item);
        }
    }

    #[inline]
    pub(crate) fn pop(&mut self) -> Option<T> {
        if let Some(item) = self.spill.pop() {
            return Some(item);
        }
        self.len = self.len.checked_sub(1)?;
        Some(self.fixed[self.len])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(bvh: &Bvh, boxes: &[Aabb]) {
        let mut seen: Vec<u32> = bvh.order.clone();
        seen.sort_unstable();
        assert_eq!(seen, (0..boxes.len() as u32).collect::<Vec<_>>());
        for node in &bvh.nodes {
            for &p in &bvh.order[node.first as usize..(node.first + node.count) as usize] {
                let b = boxes[p as usize];
                assert!(node.min.cmple(b.min).all() && node.max.cmpge(b.max).all());
            }
            if node.child != 0 {
                let (l, r) = (&bvh.nodes[node.child as usize], &bvh.nodes[node.child as usize + 1]);
                assert_eq!((l.first, l.count + r.count), (node.first, node.count));
                assert_eq!(r.first, l.first + l.count);
            }
        }
    }

    #[test]
    fn every_node_holds_its_contiguous_range() {
        let mut stream = random::Stream::new(1, 2, "bvh", 3);
        for count in [1usize, 2, 3, 17, 400] {
            let boxes: Vec<Aabb> = (0..count)
                .map(|_| {
                    let min = Vec3::from_array(std::array::from_fn(|_| stream.uniform(-50.0, 50.0) as f32));
                    Aabb { min, max: min + Vec3::splat(stream.uniform(0.0, 5.0) as f32) }
                })
                .collect();
            check(&Bvh::build(&boxes, THOROUGH), &boxes);
            check(&Bvh::build(&boxes, QUICK), &boxes);
        }
        assert!(Bvh::build(&[], QUICK).nodes.is_empty());
        let equal = vec![Aabb { min: Vec3::ZERO, max: Vec3::ONE }; 300];
        check(&Bvh::build(&equal, QUICK), &equal);
    }

    #[test]
    fn the_stack_spills_in_order() {
        let mut stack = Stack::new(0u32);
        (0..200).for_each(|i| stack.push(i));
        let popped: Vec<u32> = std::iter::from_fn(|| stack.pop()).collect();
        assert_eq!(popped, (0..200).rev().collect::<Vec<_>>());
    }
}
