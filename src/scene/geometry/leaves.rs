//! Primitives four by four, with or without a tree above them.

use super::build::{Bounds, IN_LEAF, build};
use super::lanes::Lanes;
use super::tree::{Slab, Tree, Visitor};
use super::triangle::Frame;
use super::{Hit, Sphere};
use std::array::from_fn;

/// Some primitives of a kind.
pub(super) trait Leaf {
    /// Calls `found` with every hit before about `until`; later ones may be among them.
    fn hits<L: Lanes>(&self, lanes: L, ray: &Frame, until: f64, found: impl FnMut(Hit));

    /// Brings it near.
    fn prefetch<L: Lanes>(&self, lanes: L);
}

/// Four triangles, their corners in single precision where that is exact.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub(super) struct Triangles<S> {
    /// `corner[corner][axis][lane]`; NaN, which nothing hits, in lanes left over
    corner: [[[S; IN_LEAF]; 3]; 3],
    primitive: [u32; IN_LEAF],
}

/// A number that a corner can be kept in.
pub(super) trait Coordinate: Copy + Into<f64> {
    const NOWHERE: Self;
    fn from_f64(x: f64) -> Self;
}

impl Coordinate for f32 {
    const NOWHERE: f32 = f32::NAN;
    fn from_f64(x: f64) -> f32 {
        x as f32
    }
}

impl Coordinate for f64 {
    const NOWHERE: f64 = f64::NAN;
    fn from_f64(x: f64) -> f64 {
        x
    }
}

impl<S: Coordinate> Triangles<S> {
    pub(super) fn new(triangles: impl IntoIterator<Item = (u32, [[f64; 3]; 3])>) -> Self {
        let mut leaf = Triangles { corner: [[[S::NOWHERE; IN_LEAF]; 3]; 3], primitive: [u32::MAX; IN_LEAF] };
        for (lane, (primitive, corners)) in triangles.into_iter().enumerate() {
            leaf.primitive[lane] = primitive;
            for (k, corner) in corners.iter().enumerate() {
                for (axis, &x) in corner.iter().enumerate() {
                    leaf.corner[k][axis][lane] = S::from_f64(x);
                }
            }
        }
        leaf
    }

    #[inline(always)]
    fn corners(&self, lane: usize) -> [[f64; 3]; 3] {
        from_fn(|k| from_fn(|axis| self.corner[k][axis][lane].into()))
    }

    /// One corner of all triangles in the coordinates of the ray: [`Frame::sheared`] in lanes.
    #[inline(always)]
    fn sheared(&self, corner: usize, ray: &Frame) -> [Four; 3] {
        let corner = &self.corner[corner];
        let [x, y, z] = ray.axes.map(|axis| &corner[axis]);
        let o = ray.axes.map(|axis| ray.origin[axis]);
        let z: Four = from_fn(|i| z[i].into() - o[2]);
        [from_fn(|i| (x[i].into() - o[0]) - ray.shear[0] * z[i]), from_fn(|i| (y[i].into() - o[1]) - ray.shear[1] * z[i]), z]
    }

    /// The triangles that the ray may hit before `until`, as bits: [`Frame::hit`] in lanes, without its division and error.
    #[inline(always)]
    fn candidates<L: Lanes>(&self, lanes: L, ray: &Frame, until: f64) -> u32 {
        let (a, b, c) = (self.sheared(0, ray), self.sheared(1, ray), self.sheared(2, ray));
        let (u, v, w) = (edge(&c, &b), edge(&a, &c), edge(&b, &a));
        let mut outside = [0.0; IN_LEAF];
        for i in 0..IN_LEAF {
            let low = if u[i] < v[i] { u[i] } else { v[i] };
            let high = if u[i] > v[i] { u[i] } else { v[i] };
            let low = if low < w[i] { low } else { w[i] };
            let high = if high > w[i] { high } else { w[i] };
            outside[i] = if (low >= 0.0) | (high <= 0.0) { 1.0 } else { -1.0 };
        }
        let within = !lanes.below64(&outside) & 0xf;
        if within == 0 {
            return 0;
        }
        for i in 0..IN_LEAF {
            let sum = u[i] + v[i] + w[i];
            let t = (u[i] * a[2][i] + v[i] * b[2][i] + w[i] * c[2][i]) * ray.stretch.copysign(ray.stretch * sum);
            outside[i] = if (t > 0.0) & (t <= until * sum.abs()) { 1.0 } else { -1.0 };
        }
        within & !lanes.below64(&outside)
    }
}

type Four = [f64; IN_LEAF];

#[inline(always)]
fn edge(p: &[Four; 3], q: &[Four; 3]) -> Four {
    let mut edge = [0.0; IN_LEAF];
    for i in 0..IN_LEAF {
        edge[i] = p[0][i] * q[1][i] - p[1][i] * q[0][i];
    }
    edge
}

impl<S: Coordinate> Leaf for Triangles<S> {
    #[inline(always)]
    fn prefetch<L: Lanes>(&self, lanes: L) {
        let in_line = 64 / size_of::<[S; IN_LEAF]>();
        self.corner.as_flattened().iter().step_by(in_line).for_each(|part| lanes.prefetch(part));
    }

    #[inline(always)]
    fn hits<L: Lanes>(&self, lanes: L, ray: &Frame, until: f64, mut found: impl FnMut(Hit)) {
        // rounded sums may be a little beyond
        let mut lanes_left = self.candidates(lanes, ray, until * (1.0 + 16.0 * f64::EPSILON));
        while lanes_left != 0 {
            let lane = lanes_left.trailing_zeros() as usize & 3;
            lanes_left &= lanes_left - 1;
            if let Some((t, u, v)) = ray.hit(&self.corners(lane)) {
                found(Hit { primitive: self.primitive[lane], t, u, v });
            }
        }
    }
}

/// Up to four spheres.
#[derive(Clone, Debug)]
pub(super) struct Spheres(pub(super) Vec<(u32, Sphere)>);

impl Leaf for Spheres {
    fn prefetch<L: Lanes>(&self, lanes: L) {
        lanes.prefetch(self);
    }

    #[inline]
    fn hits<L: Lanes>(&self, _: L, ray: &Frame, until: f64, mut found: impl FnMut(Hit)) {
        for (primitive, sphere) in &self.0 {
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
    leaves: Vec<B>,
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

impl<B: Leaf> Forest<B> {
    /// Items with their boxes, made into leaves; a tree above them if they are more than `plain`.
    pub(super) fn new(bounds: &[Bounds], plain: usize, leaf: impl Fn(&[u32]) -> B) -> Self {
        if bounds.len() <= plain {
            let all: Vec<u32> = (0..bounds.len() as u32).collect();
            return Forest { tree: None, leaves: all.chunks(IN_LEAF).map(leaf).collect() };
        }
        let (tree, leaves) = build(bounds);
        Forest { tree: Some(tree), leaves: leaves.iter().map(|items| leaf(items)).collect() }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.leaves.is_empty()
    }

    #[inline(always)]
    pub(super) fn nearest<L: Lanes>(&self, lanes: L, ray: &Frame, nearest: &mut Nearest) {
        match &self.tree {
            None => self.leaves.iter().for_each(|leaf| leaf.hits(lanes, ray, nearest.until, |hit| nearest.offer(hit))),
            Some(tree) => {
                let slab = Slab::new(ray, &tree.place);
                let limit = slab.limit(nearest.until);
                tree.traverse(lanes, &slab, limit, &mut Closest { lanes, ray, leaves: &self.leaves, slab: &slab, nearest });
            }
        }
    }

    #[inline(always)]
    pub(super) fn any<L: Lanes>(&self, lanes: L, ray: &Frame, until: f64) -> bool {
        let mut found = false;
        let hit = |leaf: &B| {
            let mut found = false;
            leaf.hits(lanes, ray, until, |hit| found |= hit.t < until);
            found
        };
        match &self.tree {
            None => return self.leaves.iter().any(hit),
            Some(tree) => {
                let slab = Slab::new(ray, &tree.place);
                let limit = slab.limit(until);
                tree.traverse(lanes, &slab, limit, &mut Any { lanes, ray, leaves: &self.leaves, until, limit, found: &mut found });
            }
        }
        found
    }
}

struct Closest<'a, L, B> {
    lanes: L,
    ray: &'a Frame,
    leaves: &'a [B],
    slab: &'a Slab,
    nearest: &'a mut Nearest,
}

impl<L: Lanes, B: Leaf> Visitor for Closest<'_, L, B> {
    const NEAREST_FIRST: bool = true;

    #[inline(always)]
    fn expect(&self, index: u32) {
        self.leaves[index as usize].prefetch(self.lanes);
    }
    #[inline(always)]
    fn leaf(&mut self, index: u32) -> f32 {
        self.leaves[index as usize].hits(self.lanes, self.ray, self.nearest.until, |hit| self.nearest.offer(hit));
        self.slab.limit(self.nearest.until)
    }
}

struct Any<'a, L, B> {
    lanes: L,
    ray: &'a Frame,
    leaves: &'a [B],
    until: f64,
    limit: f32,
    found: &'a mut bool,
}

impl<L: Lanes, B: Leaf> Visitor for Any<'_, L, B> {
    const NEAREST_FIRST: bool = false;

    #[inline(always)]
    fn expect(&self, index: u32) {
        self.leaves[index as usize].prefetch(self.lanes);
    }
    #[inline(always)]
    fn leaf(&mut self, index: u32) -> f32 {
        self.leaves[index as usize].hits(self.lanes, self.ray, self.until, |hit| *self.found |= hit.t < self.until);
        if *self.found { -1.0 } else { self.limit }
    }
}
