//! Primitives four by four, with or without a tree above them.

use super::build::{Bounds, IN_LEAF, build};
use super::lanes::prefetch;
use super::tree::{Slab, Tree, Visitor};
use super::triangle::{Coordinate, Frame};
use super::{Hit, Sphere};
use crate::parallel;
use fearless_simd::Simd;

/// One to four primitives that follow each other, in 31 bits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Leaf(pub(super) u32);

impl Leaf {
    /// Primitives that can be numbered.
    pub(super) const END: usize = 1 << 29;

    pub(super) fn new(first: usize, count: usize) -> Self {
        Leaf((first as u32) << 2 | (count as u32 - 1))
    }

    #[inline(always)]
    pub(super) fn first(self) -> usize {
        (self.0 >> 2) as usize
    }

    #[inline(always)]
    pub(super) fn count(self) -> usize {
        (self.0 & 3) as usize + 1
    }
}

/// Primitives of a kind, leaf by leaf.
pub(super) trait Leaves {
    /// Calls `found` with every hit before about `until`; later ones may be among them.
    fn hits<S: Simd>(&self, simd: S, leaf: Leaf, ray: &Frame, until: f64, found: impl FnMut(Hit));

    /// Brings it near.
    fn prefetch(&self, leaf: Leaf);
}

/// Triangles, their corners in single precision where that is exact.
#[derive(Clone, Debug)]
pub(super) struct Triangles<C> {
    /// nine coordinates of the first triangle, …: within a leaf, the first coordinate of all its triangles, the second, …
    corners: Vec<C>,
    primitive: Vec<u32>,
}

/// Coordinates of a full leaf.
pub(super) const BLOCK: usize = 9 * IN_LEAF;

impl<C: Coordinate> Triangles<C> {
    /// Items `order[first]`, `order[first + 1]`, … in each leaf.
    pub(super) fn new(leaves: &[Leaf], order: &[u32], triangle: impl Fn(u32) -> (u32, [[f64; 3]; 3]) + Send + Sync) -> Self {
        // coordinate k of item i of a leaf of n comes to k·n + i
        let block = |leaf: &Leaf| {
            let (n, mut block) = (leaf.count(), [C::from_f64(0.0); BLOCK]);
            for (i, &item) in order[leaf.first()..leaf.first() + n].iter().enumerate() {
                let corners = triangle(item).1;
                (0..9).for_each(|k| block[k * n + i] = C::from_f64(corners[k / 3][k % 3]));
            }
            block
        };
        let mut corners = Vec::with_capacity(9 * order.len() + BLOCK);
        for (leaf, block) in leaves.iter().zip(parallel::map_short(leaves.len(), |i| block(&leaves[i]))) {
            corners.extend_from_slice(&block[..9 * leaf.count()]);
        }
        // a leaf is read as if it was full
        corners.extend([C::from_f64(0.0); BLOCK]);
        Triangles { corners, primitive: order.iter().map(|&i| triangle(i).0).collect() }
    }
}

impl<C: Coordinate> Leaves for Triangles<C> {
    #[inline(always)]
    fn prefetch(&self, leaf: Leaf) {
        // most leaves are in two lines of a cache
        let (first, in_line) = (9 * leaf.first(), 64 / size_of::<C>());
        prefetch(&self.corners[first]);
        prefetch(&self.corners[first + in_line]);
    }

    #[inline(always)]
    fn hits<S: Simd>(&self, simd: S, leaf: Leaf, ray: &Frame, until: f64, mut found: impl FnMut(Hit)) {
        let first = leaf.first();
        if let Some(corners) = self.corners[9 * first..].first_chunk() {
            ray.hits(simd, corners, leaf.count(), until, |lane, t, u, v| found(Hit { primitive: self.primitive[first + lane], t, u, v }));
        }
    }
}

/// Spheres with their numbers.
#[derive(Clone, Debug)]
pub(super) struct Spheres(pub(super) Vec<(u32, Sphere)>);

impl Leaves for Spheres {
    fn prefetch(&self, _: Leaf) {}

    #[inline]
    fn hits<S: Simd>(&self, _: S, leaf: Leaf, ray: &Frame, until: f64, mut found: impl FnMut(Hit)) {
        for (primitive, sphere) in &self.0[leaf.first()..leaf.first() + leaf.count()] {
            if let Some(t) = sphere.hit(&ray.ray().until(until)) {
                found(Hit { primitive: *primitive, t, u: 0.0, v: 0.0 });
            }
        }
    }
}

/// All primitives of a kind.
#[derive(Clone, Debug)]
pub(super) struct Forest<B> {
    tree: Option<Tree>,
    /// of a forest without a tree
    plain: Vec<Leaf>,
    leaves: B,
    count: usize,
}

/// A first hit in the making.
#[derive(Clone, Copy, Debug)]
pub(super) struct Nearest {
    pub(super) hit: Option<Hit>,
    pub(super) until: f64,
}

impl Nearest {
    #[inline(always)]
    fn offer(&mut self, hit: Hit) {
        if hit.t < self.until || self.hit.is_some_and(|b| hit.t == b.t && hit.primitive < b.primitive) {
            self.until = hit.t;
            self.hit = Some(hit);
        }
    }
}

impl<B: Leaves> Forest<B> {
    /// Items with their boxes, made into leaves; a tree above them if they are more than `plain`.
    pub(super) fn new(bounds: &[Bounds], plain: usize, leaves: impl Fn(&[Leaf], &[u32]) -> B) -> Self {
        let count = bounds.len();
        if count <= plain {
            let order: Vec<u32> = (0..count as u32).collect();
            let all: Vec<Leaf> = (0..count).step_by(IN_LEAF).map(|first| Leaf::new(first, IN_LEAF.min(count - first))).collect();
            return Forest { tree: None, leaves: leaves(&all, &order), plain: all, count };
        }
        let (tree, all, order) = build(bounds);
        Forest { tree: Some(tree), plain: Vec::new(), leaves: leaves(&all, &order), count }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.count == 0
    }

    #[inline(always)]
    pub(super) fn nearest<S: Simd>(&self, simd: S, ray: &Frame, nearest: &mut Nearest) {
        match &self.tree {
            None => {
                for &leaf in &self.plain {
                    self.leaves.hits(simd, leaf, ray, nearest.until, |hit| nearest.offer(hit));
                }
            }
            Some(tree) => {
                let slab = Slab::new(ray, &tree.place);
                let limit = slab.limit(nearest.until);
                tree.traverse(simd, &slab, limit, &mut Closest { simd, ray, leaves: &self.leaves, slab: &slab, nearest });
            }
        }
    }

    #[inline(always)]
    pub(super) fn any<S: Simd>(&self, simd: S, ray: &Frame, until: f64) -> bool {
        let mut found = false;
        match &self.tree {
            None => {
                for &leaf in &self.plain {
                    self.leaves.hits(simd, leaf, ray, until, |hit| found |= hit.t < until);
                }
            }
            Some(tree) => {
                let slab = Slab::new(ray, &tree.place);
                let limit = slab.limit(until);
                tree.traverse(simd, &slab, limit, &mut Any { simd, ray, leaves: &self.leaves, until, limit, found: &mut found });
            }
        }
        found
    }
}

struct Closest<'a, S, B> {
    simd: S,
    ray: &'a Frame,
    leaves: &'a B,
    slab: &'a Slab,
    nearest: &'a mut Nearest,
}

impl<S: Simd, B: Leaves> Visitor for Closest<'_, S, B> {
    const NEAREST_FIRST: bool = true;

    #[inline(always)]
    fn expect(&self, leaf: Leaf) {
        self.leaves.prefetch(leaf);
    }

    #[inline(always)]
    fn leaf(&mut self, leaf: Leaf) -> f32 {
        self.leaves.hits(self.simd, leaf, self.ray, self.nearest.until, |hit| self.nearest.offer(hit));
        self.slab.limit(self.nearest.until)
    }
}

struct Any<'a, S, B> {
    simd: S,
    ray: &'a Frame,
    leaves: &'a B,
    until: f64,
    limit: f32,
    found: &'a mut bool,
}

impl<S: Simd, B: Leaves> Visitor for Any<'_, S, B> {
    const NEAREST_FIRST: bool = false;

    #[inline(always)]
    fn expect(&self, leaf: Leaf) {
        self.leaves.prefetch(leaf);
    }

    #[inline(always)]
    fn leaf(&mut self, leaf: Leaf) -> f32 {
        self.leaves.hits(self.simd, leaf, self.ray, self.until, |hit| *self.found |= hit.t < self.until);
        if *self.found { -1.0 } else { self.limit }
    }
}
