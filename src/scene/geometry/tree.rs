//! A tree of boxes, eight to a node; it knows nothing of what is in them.

use super::Ray;
use super::lanes::Lanes;
use crate::scene::vector::{largest, scale, sub};

/// Children of a node.
pub(super) const LANES: usize = 8;
/// Marks the index of a leaf.
const LEAF: u32 = 1 << 31;
/// Nodes that wait on a stack without allocation.
const WAITING: usize = 96;

/// Eight boxes, in single precision and never smaller than what they hold.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(super) struct Node {
    /// `bounds[axis][side][child]`; an absent child has its low side above its high side
    pub(super) bounds: [[[f32; LANES]; 2]; 3],
    /// index of a node, or of a leaf if marked
    pub(super) child: [u32; LANES],
}

impl Node {
    pub(super) const EMPTY: Node = Node { bounds: [[[f32::INFINITY; LANES], [f32::NEG_INFINITY; LANES]]; 3], child: [LEAF; LANES] };

    pub(super) fn leaf(index: u32) -> u32 {
        LEAF | index
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

/// Relative error of a distance to a box: three roundings on either side.
const SLACK: f32 = 1.0 + 4.0 * f32::EPSILON;

impl Slab {
    #[inline(always)]
    pub(super) fn new(ray: &Ray, place: &Place) -> Self {
        let length = largest(ray.direction);
        let d = scale(1.0 / length, ray.direction);
        let far = scale(place.scale, sub(ray.origin, place.centre));
        // from far away the ray first comes near: the tree is within ±1, and the largest coordinate moves at speed 1
        let away = largest(far);
        let start = if away > 4.0 { away - 2.0 } else { 0.0 };
        let o: [f64; 3] = std::array::from_fn(|i| far[i] + start * d[i]);
        let pad = |i: usize| (o[i].abs() * f64::from(2.0 * f32::EPSILON) + away * 4.0 * f64::EPSILON + 1e-20).copysign(d[i]);
        Slab {
            enter: std::array::from_fn(|i| (o[i] + pad(i)) as f32),
            leave: std::array::from_fn(|i| (o[i] - pad(i)) as f32),
            // parallel to a face: steep enough to be never in between, flat enough not to overflow
            inverse: d.map(|x| (1.0 / x.abs().max(1e-30).copysign(x)) as f32),
            near: d.map(|x| usize::from(x.is_sign_negative())),
            rate: length * place.scale,
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
    fn boxes<L: Lanes>(&self, lanes: L, node: &Node, limit: f32) -> (u32, [f32; LANES]) {
        let [x, y, z] = [0, 1, 2].map(|a| &node.bounds[a][self.near[a]]);
        let [fx, fy, fz] = [0, 1, 2].map(|a| &node.bounds[a][1 - self.near[a]]);
        let max = |a: f32, b: f32| if a > b { a } else { b };
        let min = |a: f32, b: f32| if a < b { a } else { b };
        let (e, l, inv) = (&self.enter, &self.leave, &self.inverse);
        let enter: [f32; LANES] =
            std::array::from_fn(|i| max(max((x[i] - e[0]) * inv[0], (y[i] - e[1]) * inv[1]), max((z[i] - e[2]) * inv[2], 0.0)));
        let gap: [f32; LANES] = std::array::from_fn(|i| {
            let leave = min(min((fx[i] - l[0]) * inv[0], (fy[i] - l[1]) * inv[1]), (fz[i] - l[2]) * inv[2]);
            min(leave * SLACK, limit) - enter[i]
        });
        (!lanes.signs(&gap) & 0xff, enter)
    }
}

/// What a traversal does with the leaves it comes to.
pub(super) trait Visitor {
    /// Whether near leaves should come first.
    const NEAREST_FIRST: bool;

    /// Takes leaf `index`, says up to where on the ray others are still wanted: a negative number ends the traversal.
    fn leaf(&mut self, index: u32) -> f32;
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
    pub(super) fn traverse<L: Lanes, V: Visitor>(&self, lanes: L, ray: &Slab, mut limit: f32, visitor: &mut V) {
        let mut stack = Stack::new();
        let mut current = 0;
        loop {
            if current & LEAF != 0 {
                limit = visitor.leaf(current & !LEAF);
            } else {
                let node = &self.nodes[current as usize];
                let (mut met, enter) = ray.boxes(lanes, node, limit);
                let base = stack.reserve();
                while met != 0 {
                    let i = met.trailing_zeros() as usize & 7;
                    met &= met - 1;
                    stack.push((enter[i], node.child[i]));
                    if V::NEAREST_FIRST {
                        stack.sort_last(base);
                    }
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
