//! Places that no rule has as nodes, at which functions are compared with the polynomials through their values at the nodes.
//!
//! On a line: one place in each of 3072 cells, and in each part of a cell that ends of panels or double-exponential nodes cut off. Far out on
//! an infinite domain these are wide: a bump of width w at x is seen if w > x²/3000 in units of the map's scale.

use super::grid::{Grid, Stencil};
use crate::domain::{Domain, Node, Point};
use crate::sampling::{Pcg, Sampler, Sequence};

/// Cells of a line.
const SCANNED: usize = 3072;

/// The largest of numbers that are not negative; NaN counts as infinite, where `f64::max` would drop it.
#[derive(Default)]
pub(super) struct Largest(pub(super) f64);

impl Largest {
    pub(super) fn see(&mut self, value: f64) {
        self.0 = if value.is_nan() { f64::INFINITY } else { self.0.max(value) };
    }
}

/// Places of a jittered lattice, each with its share of the measure.
pub(super) struct Scan<X> {
    pub(super) places: Vec<Node<X>>,
    /// of every place, on a line; made anew for every row elsewhere, where they are long
    stencils: Vec<Option<Stencil>>,
}

impl<X: Point> Scan<X> {
    pub(super) fn of<D: Domain<Point = X>>(domain: &D, grid: &Grid<X>) -> Self {
        let d = domain.dimension();
        let places = if d == 1 { along_line(domain, grid) } else { in_boxes(domain) };
        let stencils = if d == 1 { places.iter().map(|n| grid.stencil(domain, &n.point)).collect() } else { Vec::new() };
        Scan { places, stencils }
    }

    /// |φ − interpolant| at the places, 0 where φ is not given.
    pub(super) fn gaps<D: Domain<Point = X>>(
        &self,
        grid: &Grid<X>,
        domain: &D,
        nodes: &[f64],
        phi: impl Fn(usize) -> Option<f64>,
    ) -> Vec<f64> {
        let gap = |(i, n): (usize, &Node<X>)| {
            let Some(value) = phi(i) else { return 0.0 };
            let made;
            let stencil = match self.stencils.get(i) {
                Some(stencil) => stencil,
                None => {
                    made = grid.stencil(domain, &n.point);
                    &made
                }
            };
            stencil.as_ref().map_or(0.0, |stencil| (value - stencil.apply(|j| nodes[j])).abs())
        };
        self.places.iter().enumerate().map(gap).collect()
    }

    /// ∫ of gaps, and the largest one.
    pub(super) fn sum_and_largest(&self, gaps: &[f64]) -> (f64, f64) {
        let (mut sum, mut largest) = (Largest::default(), Largest::default());
        for (gap, n) in gaps.iter().zip(&self.places) {
            largest.see(*gap);
            sum.see(sum.0 + n.weight * gap);
        }
        (sum.0, largest.0)
    }
}

/// One place in each cell of a lattice, and in each part of it that an end of a panel, or a double-exponential node, cuts off.
fn along_line<D: Domain>(domain: &D, grid: &Grid<D::Point>) -> Vec<Node<D::Point>> {
    // towards infinity a sliver of the coordinate stands for much
    let at_finite_end = |t: &f64| domain.place(0, || t.round()).weight.is_finite();
    let cells = (0..=SCANNED).map(|i| i as f64 / SCANNED as f64);
    let mut cuts: Vec<f64> = cells.chain(grid.cuts().into_iter().filter(at_finite_end)).collect();
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

/// A jittered lattice in more dimensions.
fn in_boxes<D: Domain>(domain: &D) -> Vec<Node<D::Point>> {
    let d = domain.dimension();
    let side: usize = [SCANNED, 64, 16, 8].get(d - 1).copied().unwrap_or(4);
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
