//! A tree of boxes, eight to a node; it knows nothing of what is in them.

use super::lanes::prefetch;
use super::leaves::Leaf;
use super::triangle::Frame;
use crate::scene::vector::{largest, scale, sub};
use fearless_simd::{Simd, f32x8, prelude::*};
use std::array::from_fn;

/// Children of a node.
pub(super) const LANES: usize = 8;
/// Marks the index of a leaf.
const LEAF: u32 = 1 << 31;
/// Nodes that wait on a stack without allocation.
const WAITING: usize = 56;

/// Eight boxes, in single precision and never smaller than what they hold.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(super) struct Node {
    /// `bounds[axis][side][child]`; an absent child has its low side above its high side
    bounds: [[[f32; LANES]; 2]; 3],
    /// index of a node, or a leaf if marked
    pub(super) child: [u32; LANES],
}

impl Node {
    pub(super) const EMPTY: Node = Node { bounds: [[[f32::INFINITY; LANES], [f32::NEG_INFINITY; LANES]]; 3], child: [LEAF; LANES] };

    pub(super) fn leaf(leaf: Leaf) -> u32 {
        LEAF | leaf.0
    }

    /// At most eight boxes.
    pub(super) fn around(boxes: &[[[f32; 3]; 2]]) -> Self {
        let mut node = Node::EMPTY;
        for (lane, [low, high]) in boxes.iter().enumerate() {
            for axis in 0..3 {
                node.bounds[axis][0][lane] = low[axis];
                node.bounds[axis][1][lane] = high[axis];
            }
        }
        node
    }
}

/// Where the tree's own coordinates are: (x − centre)·scale is within ±1 for everything in it, so that single precision suits every scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Place {
    pub(super) centre: [f64; 3],
    /// a power of two
    pub(super) scale: f64,
}

/// A ray in the tree's coordinates, between two parallel ones: boxes are entered no later and left no earlier than by the true ray.
///
/// Ize (2013), Robust BVH ray traversal, JCGT 2(2), with the rounding of the origin to single precision.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slab {
    enter: [f32; 3],
    leave: [f32; 3],
    inverse: [f32; 3],
    near: [usize; 3],
    /// t of the tree = rate·t − start
    rate: f64,
    start: f64,
}

/// Relative error of a distance along the ray.
const SLACK: f32 = 1.0 + 6.0 * f32::EPSILON;

impl Slab {
    #[inline(always)]
    pub(super) fn new(ray: &Frame, place: &Place) -> Self {
        let d = scale(ray.stretch.abs(), ray.direction);
        let far = scale(place.scale, sub(ray.origin, place.centre));
        // from far away the ray first comes near: the tree is within ±1, and the largest coordinate moves at speed 1
        let away = largest(far);
        let start = if away > 4.0 { away - 2.0 } else { 0.0 };
        let o: [f64; 3] = from_fn(|i| far[i] + start * d[i]);
        // the rounding of o, and four of each distance, of up to |o| + 1, to a plane
        let pad = |i: usize| ((o[i].abs() + 2.0) * f64::from(8.0 * f32::EPSILON) + away * 4.0 * f64::EPSILON + 1e-20).copysign(d[i]);
        // parallel to a face: steep enough to be never in between, flat enough not to overflow
        let inverse: [f32; 3] = from_fn(|i| 1.0 / (d[i] as f32).abs().max(1e-30).copysign(d[i] as f32));
        Slab {
            enter: from_fn(|i| (o[i] + pad(i)) as f32),
            leave: from_fn(|i| (o[i] - pad(i)) as f32),
            inverse,
            near: from_fn(|i| usize::from(d[i].is_sign_negative())),
            rate: ray.length * place.scale,
            start,
        }
    }

    /// t in the tree, no smaller than the true one.
    #[inline(always)]
    pub(super) fn limit(&self, t: f64) -> f32 {
        (self.rate * t - self.start + 4.0 * f64::EPSILON * self.start) as f32 * SLACK
    }

    /// The boxes that the ray meets before `limit`, as bits, and where it enters them.
    #[inline(always)]
    fn boxes<S: Simd>(&self, simd: S, node: &Node, limit: f32) -> (u32, [f32; LANES]) {
        let (enter_x, leave_x) = self.plane(simd, node, 0);
        let (enter_y, leave_y) = self.plane(simd, node, 1);
        let (enter_z, leave_z) = self.plane(simd, node, 2);
        let enter = enter_x.max(enter_y).max(enter_z.max(0.0));
        let leave = leave_x.min(leave_y).min(leave_z.min(limit));
        (enter.simd_le(leave).to_bitmask() as u32, *enter)
    }

    /// Where the ray crosses the near and the far sides of boxes across an axis.
    #[inline(always)]
    fn plane<S: Simd>(&self, simd: S, node: &Node, axis: usize) -> (f32x8<S>, f32x8<S>) {
        let (bounds, near, inverse) = (&node.bounds[axis], self.near[axis], self.inverse[axis]);
        let enter = (f32x8::simd_from(simd, bounds[near & 1]) - self.enter[axis]) * inverse;
        let leave = (f32x8::simd_from(simd, bounds[!near & 1]) - self.leave[axis]) * inverse;
        (enter, leave)
    }
}

/// What a traversal does with the leaves it comes to.
pub(super) trait Visitor {
    /// Whether near leaves should come first.
    const NEAREST_FIRST: bool;

    /// Brings a leaf near that will be visited soon.
    fn expect(&self, leaf: Leaf);

    /// Takes a leaf, says up to where on the ray others are still wanted: a negative number ends the traversal.
    fn leaf(&mut self, leaf: Leaf) -> f32;
}

/// The tree.
#[derive(Clone, Debug)]
pub(super) struct Tree {
    pub(super) nodes: Vec<Node>,
    pub(super) place: Place,
}

impl Tree {
    /// Shows the visitor every leaf whose box the ray meets before `limit`.
    #[inline(always)]
    pub(super) fn traverse<S: Simd, V: Visitor>(&self, simd: S, ray: &Slab, mut limit: f32, visitor: &mut V) {
        let mut stack = Stack::new();
        let mut current = 0;
        loop {
            if current & LEAF != 0 {
                limit = visitor.leaf(Leaf(current & !LEAF));
            } else {
                let node = &self.nodes[current as usize];
                prefetch(&node.child);
                let (met, enter) = ray.boxes(simd, node, limit);
                if met != 0 {
                    current = self.descend(node, met, &enter, &mut stack, visitor);
                    continue;
                }
            }
            loop {
                let Some((enter, child)) = stack.pop() else { return };
                if enter <= limit {
                    current = child;
                    break;
                }
            }
        }
    }

    /// Puts the children that are met on the stack, but for the one to go on with.
    #[inline(always)]
    fn descend<V: Visitor>(&self, node: &Node, met: u32, enter: &[f32; LANES], stack: &mut Stack, visitor: &V) -> u32 {
        let i = met.trailing_zeros() as usize & 7;
        let mut rest = met & (met - 1);
        let mut next = (enter[i], node.child[i]);
        self.expect(next.1, visitor);
        if rest == 0 {
            return next.1;
        }
        let base = stack.reserve();
        while rest != 0 {
            let i = rest.trailing_zeros() as usize & 7;
            rest &= rest - 1;
            let mut other = (enter[i], node.child[i]);
            if V::NEAREST_FIRST && other.0 < next.0 {
                std::mem::swap(&mut next, &mut other);
            }
            self.expect(other.1, visitor);
            stack.push(other);
            if V::NEAREST_FIRST {
                stack.sort_last(base);
            }
        }
        next.1
    }

    /// Large scenes wait for memory most of the time: reads begin as soon as their places are known.
    #[inline(always)]
    fn expect<V: Visitor>(&self, child: u32, visitor: &V) {
        if child & LEAF == 0 {
            self.nodes[child as usize].bounds.iter().for_each(prefetch);
        } else {
            visitor.expect(Leaf(child & !LEAF));
        }
    }
}

/// Nodes still to visit, the next one last.
struct Stack {
    waiting: [(f32, u32); WAITING],
    len: usize,
    /// in trees deeper than any reasonable scene has
    below: Vec<(f32, u32)>,
}

impl Stack {
    #[inline(always)]
    fn new() -> Self {
        Stack { waiting: [(0.0, 0); WAITING], len: 0, below: Vec::new() }
    }

    /// Makes room for the children of a node, says where they begin.
    #[inline(always)]
    fn reserve(&mut self) -> usize {
        if self.len > WAITING - LANES {
            self.below.extend_from_slice(&self.waiting[..self.len]);
            self.len = 0;
        }
        self.len
    }

    #[inline(always)]
    fn push(&mut self, entry: (f32, u32)) {
        self.waiting[self.len] = entry;
        self.len += 1;
    }

    /// Moves the last entry down to its place among those from `base` on: far ones first.
    #[inline(always)]
    fn sort_last(&mut self, base: usize) {
        let mut k = self.len - 1;
        let entry = self.waiting[k];
        while k > base && self.waiting[k - 1].0 < entry.0 {
            self.waiting[k] = self.waiting[k - 1];
            k -= 1;
        }
        self.waiting[k] = entry;
    }

    #[inline(always)]
    fn pop(&mut self) -> Option<(f32, u32)> {
        if self.len == 0 {
            return self.below.pop();
        }
        self.len -= 1;
        Some(self.waiting[self.len])
    }
}
