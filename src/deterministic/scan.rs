//! Places that no rule has as nodes, at which functions are compared with the polynomials through their values at the nodes.
//!
//! On a line: one place in each of 3072 cells, the outermost halved 20 times towards finite ends, and in each part of a cell that ends of panels or
//! double-exponential nodes cut off. Towards infinity, where such cells are wide, one in each cell of twice the map's scale as far out as 2^14 scales, and 32 in
//! every octave up to 2^20: a bump of width w at x is seen there if w > x/32.
//!
//! A function of one variable is looked at in all places. Of K(x, ·), for many x, each row has some of them only, in turn: those of all rows together make a
//! lattice in the plane without gaps (x_i, {i φ}), φ the golden ratio.

use super::grid::Grid;
use crate::domain::{Domain, Node, Point};
use crate::parallel;
use crate::sampling::{Pcg, Sampler, Sequence};

/// Cells of a line.
const SCANNED: usize = 3072;
/// The outermost are halved so often towards an end: boundary layers.
const TOWARDS_END: i32 = 20;
/// Towards infinity: length of a cell in units of the map's scale, how far, and cells of an octave everywhere.
const CELL: f64 = 2.0;
const FAR: f64 = (1u64 << 28) as f64;
const OCTAVE: f64 = 32.0;
const FARTHEST: f64 = 1.0 / (1u64 << 20) as f64;
/// Places of a row of K at least, for every state: on an interval, and elsewhere.
const OF_A_ROW: usize = 128;
const MORE_OF_A_ROW: usize = 512;
/// Stencils made by one task.
const BATCH: usize = 256;
const GOLDEN: f64 = 0.618_033_988_749_895;

/// Width of a cell, as a share of a coordinate.
pub(super) fn resolution(dimension: usize) -> f64 {
    1.0 / side(dimension) as f64
}

/// Cells along a coordinate.
fn side(dimension: usize) -> usize {
    [SCANNED, 64, 16, 8].get(dimension - 1).copied().unwrap_or(4)
}

/// The largest of numbers that are not negative; NaN counts as infinite, where `f64::max` would drop it.
#[derive(Default)]
pub(super) struct Largest(pub(super) f64);

impl Largest {
    #[inline]
    pub(super) fn see(&mut self, value: f64) {
        self.0 = if value.is_nan() { f64::INFINITY } else { self.0.max(value) };
    }
}

/// Places of a jittered lattice, each with its share of the measure and the weights of the interpolant there.
pub(super) struct Scan<X> {
    pub(super) places: Vec<Node<X>>,
    width: usize,
    first: Vec<Option<usize>>,
    weights: Vec<f64>,
    stride: usize,
}

/// Every `stride`-th place.
#[derive(Clone, Copy)]
pub(super) struct Part {
    start: usize,
    pub(super) stride: usize,
}

impl Part {
    pub(super) fn of(self, count: usize) -> impl Iterator<Item = usize> {
        (self.start..count).step_by(self.stride)
    }
}

impl<X: Point> Scan<X> {
    pub(super) fn of<D: Domain<Point = X>>(domain: &D, grid: &Grid<X>) -> Self {
        let places = if domain.dimension() == 1 { along_line(domain, grid) } else { in_boxes(domain) };
        let width = grid.stencil_width();
        let mut weights = vec![0.0; width * places.len()];
        let batch = |i: usize, weights: &mut [f64]| {
            let places = &places[i * BATCH..];
            places.iter().zip(weights.chunks_exact_mut(width)).map(|(n, w)| grid.stencil_into(domain, &n.point, w)).collect::<Vec<_>>()
        };
        let first = if width == 0 { vec![None; places.len()] } else { parallel::chunks(&mut weights, BATCH * width, batch).concat() };
        let of_a_row = match domain.dimension() {
            1 if domain.volume().is_finite() => grid.nodes.len().max(OF_A_ROW * domain.states()),
            1 => grid.nodes.len().max(MORE_OF_A_ROW * domain.states()),
            _ => MORE_OF_A_ROW * domain.states(),
        };
        let stride = (places.len() / of_a_row).max(1);
        Scan { places, width, first, weights, stride }
    }

    /// All places.
    pub(super) fn all(&self) -> Part {
        Part { start: 0, stride: 1 }
    }

    /// Those of row `i`.
    pub(super) fn of_row(&self, i: usize) -> Part {
        Part { start: ((i as f64 * GOLDEN).fract() * self.stride as f64) as usize, stride: self.stride }
    }

    /// The node from which the interpolant at place `i` has its first value, and the interpolant; `None` for composite rules.
    #[inline]
    pub(super) fn interpolant(&self, i: usize, nodes: &[f64]) -> Option<(usize, f64)> {
        let first = self.first[i]?;
        let weights = &self.weights[i * self.width..(i + 1) * self.width];
        // four sums at once: nothing waits for the last product
        let (mut sums, mut w, mut v) = ([0.0; 4], weights.chunks_exact(4), nodes[first..].chunks_exact(4));
        for (w, v) in w.by_ref().zip(v.by_ref()) {
            (0..4).for_each(|k| sums[k] += w[k] * v[k]);
        }
        let rest: f64 = w.remainder().iter().zip(&nodes[first + self.width / 4 * 4..]).map(|(w, v)| w * v).sum();
        Some((first, sums.iter().sum::<f64>() + rest))
    }

    /// |φ − interpolant| at the places of a part, 0 elsewhere and where there is none.
    pub(super) fn gaps(&self, part: Part, nodes: &[f64], phi: impl Fn(usize) -> f64) -> Vec<f64> {
        let mut gaps = vec![0.0; self.places.len()];
        for i in part.of(self.places.len()) {
            if let Some((_, value)) = self.interpolant(i, nodes) {
                gaps[i] = (phi(i) - value).abs();
            }
        }
        gaps
    }

    /// ∫ of gaps over a part, and the largest one.
    pub(super) fn sum_and_largest(&self, part: Part, gaps: &[f64]) -> (f64, f64) {
        let (mut sum, mut largest) = (Largest::default(), Largest::default());
        for i in part.of(gaps.len()) {
            largest.see(gaps[i]);
            sum.see(sum.0 + part.stride as f64 * self.places[i].weight * gaps[i]);
        }
        (sum.0, largest.0)
    }
}

/// One place in each cell of a lattice, and in each part of it that an end of a panel, or a double-exponential node, cuts off.
fn along_line<D: Domain>(domain: &D, grid: &Grid<D::Point>) -> Vec<Node<D::Point>> {
    // towards infinity a sliver of the coordinate stands for much
    let at_finite_end = |t: &f64| domain.place(0, || t.round()).weight.is_finite();
    let mut cuts: Vec<f64> = (0..=SCANNED).map(|i| i as f64 / SCANNED as f64).collect();
    if !domain.volume().is_finite() {
        cuts = cuts.windows(2).flat_map(|ends| cells_towards_infinity(domain, (ends[0], ends[1]))).chain([1.0]).collect();
    }
    let towards_end = |end: f64| (1..=TOWARDS_END).map(move |k| (end - 0.5f64.powi(k) / SCANNED as f64).abs());
    // where K(x, ·) is unbounded its values are those of rounded distances
    let bounded = |end: &f64| !grid.is_double_exponential() && !grid.ends().unbounded[*end as usize];
    cuts.extend([0.0, 1.0].into_iter().filter(at_finite_end).filter(bounded).flat_map(towards_end));
    cuts.extend(grid.cuts().into_iter().filter(at_finite_end));
    cuts.sort_by(f64::total_cmp);
    cuts.dedup();
    let place = |state: usize, i: usize| {
        let (a, b) = (cuts[i], cuts[i + 1]);
        let u = Pcg::default().point(u64::MAX - 3, state as u32, i as u64).next_1d();
        let n = domain.place(state, || a + (b - a) * u);
        Node { point: n.point, weight: n.weight * (b - a) }
    };
    (0..domain.states()).flat_map(|s| (0..cuts.len() - 1).map(move |i| (s, i))).map(|(s, i)| place(s, i)).collect()
}

/// Lower ends of the cells into which one is cut on an infinite domain.
fn cells_towards_infinity<D: Domain>(domain: &D, (a, b): (f64, f64)) -> Vec<f64> {
    let infinite = [0.0, 1.0].map(|end| !domain.place(0, || end).weight.is_finite());
    // |dμ/dt| where the map is densest is its scale
    let scale = domain.place(0, || if infinite == [true; 2] { 0.5 } else { f64::from(u8::from(infinite[0])) }).weight;
    let mut cells = Vec::new();
    let mut left = vec![(a, b)];
    while let Some((a, b)) = left.pop() {
        let middle = 0.5 * (a + b);
        let rest = if infinite[0] && (middle < 0.5 || !infinite[1]) { middle } else { 1.0 - middle };
        let weight = domain.place(0, || middle).weight;
        let coarse = (b - a) * weight > CELL * scale && weight < FAR * scale;
        if rest > FARTHEST && (b - a > rest / OCTAVE || coarse) {
            left.extend([(middle, b), (a, middle)]);
        } else {
            cells.push(a);
        }
    }
    cells
}

/// A jittered lattice in more dimensions.
fn in_boxes<D: Domain>(domain: &D) -> Vec<Node<D::Point>> {
    let d = domain.dimension();
    let side = side(d);
    let count = side.pow(d as u32);
    let place = |state: usize, i: usize| {
        let (mut rest, mut u) = (i, Pcg::default().point(u64::MAX - 3, state as u32, i as u64));
        let n = domain.place(state, || {
            let cell = rest % side;
            rest /= side;
            (cell as f64 + u.next_1d()) / side as f64
        });
        Node { point: n.point, weight: n.weight / count as f64 }
    };
    (0..domain.states()).flat_map(|s| (0..count).map(move |i| (s, i))).map(|(s, i)| place(s, i)).collect()
}
