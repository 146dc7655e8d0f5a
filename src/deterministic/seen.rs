//! Rows and columns of K over places that no rule has as nodes.
//!
//! Interpolation of a smooth row errs by its Legendre tail, which a Gauss rule squares: only what stands out from that is a feature that the nodes do not have.

use super::basis::Basis;
use super::grid::Grid;
use super::near::{Target, components};
use super::scan::{Largest, Part, Scan};
use crate::domain::{Domain, Point};
use crate::kernel::{HasDomain, Kernel};
use crate::parallel;
use crate::sampling::{Pcg, Sequence};
use crate::value::Weight;
use std::collections::BTreeSet;

/// Rows and columns beside those asked for: on a line, and in more dimensions.
const ROWS: usize = 64;
const FEWER_ROWS: usize = 32;
/// Most rows at peaks of columns.
const PEAKS: usize = 64;
/// What of a row is more than interpolation: as a multiple of its Legendre tail, and as shares of its largest value at least and at most.
const OUTSTANDING: f64 = 100.0;
const LEAST_FEATURE: f64 = 1e-12;
const FEATURE: f64 = 1e-5;

/// Which variable of K runs over the scan.
#[derive(Clone, Copy)]
enum Along {
    /// y
    Row,
    /// x
    Column,
}

/// An entry of one row or column of K over the scan.
pub(super) struct Line {
    /// the place where it is largest, far from the diagonal
    pub(super) highest: usize,
    /// largest |K| where it is far from the diagonal
    pub(super) size: f64,
    /// ∫ |K|
    pub(super) mass: f64,
    /// ∫ |K − interpolant| where it is more than interpolation
    pub(super) gap: f64,
    /// the place where it is most
    pub(super) at: usize,
}

/// What the scan of a kernel found.
pub(super) struct Seen<X> {
    /// places x of the rows
    pub(super) at: Vec<X>,
    pub(super) rows: Vec<Line>,
    pub(super) columns: Vec<Line>,
    /// sup |K| far from the diagonal, sup ∫ |K(x, ·)|, sup ∫ of what rows and columns have beside interpolation
    pub(super) largest: f64,
    pub(super) mass: f64,
    pub(super) row: f64,
    pub(super) column: f64,
}

/// A kernel and the nodes of a rule.
pub(super) struct Sight<'a, K: HasDomain> {
    pub(super) kernel: &'a K,
    pub(super) grid: &'a Grid<K::Point>,
}

impl<K: Kernel + HasDomain> Sight<'_, K> {
    /// Rows and columns at `probes` and more.
    pub(super) fn look(&self, scan: &Scan<K::Point>, probes: &[K::Point]) -> Seen<K::Point> {
        let mut at = self.rows(probes);
        let columns = self.lines(scan, Along::Column, &at);
        // K narrow in x, whatever its rows: the rows where columns are largest count
        let mut peaks: BTreeSet<usize> = columns.iter().filter(|line| line.gap > 0.0).map(|line| line.highest).take(PEAKS).collect();
        peaks.extend(columns.iter().max_by(|a, b| a.size.total_cmp(&b.size)).map(|line| line.highest));
        let spread = at.len() * components::<K>().pow(2);
        at.extend(peaks.into_iter().map(|i| scan.places[i].point));
        let rows = self.lines(scan, Along::Row, &at);
        let sup = |values: &mut dyn Iterator<Item = f64>| {
            let mut largest = Largest::default();
            values.for_each(|v| largest.see(v));
            largest.0
        };
        // a row at a place of the scan has its peak there, and far out that place stands for much: no sample of its integral
        let trusted = if self.kernel.domain().volume().is_finite() { rows.len() } else { spread };
        Seen {
            largest: sup(&mut columns.iter().chain(&rows).map(|line| line.size)),
            mass: sup(&mut rows[..trusted].iter().map(|line| line.mass)),
            row: sup(&mut rows.iter().map(|line| line.gap)),
            column: sup(&mut columns.iter().map(|line| line.gap)),
            at,
            rows,
            columns,
        }
    }

    /// The panel of a place.
    pub(super) fn panel(&self, scan: &Scan<K::Point>, place: usize) -> Option<usize> {
        self.grid.panels().map(|panels| panels.at(self.kernel.domain().coordinate(&scan.places[place].point, 0)))
    }

    /// Those of the probes and more.
    fn rows(&self, probes: &[K::Point]) -> Vec<K::Point> {
        let domain = self.kernel.domain();
        let count = match domain.dimension() {
            1 => ROWS,
            _ if self.grid.is_centred() => 0,
            _ => FEWER_ROWS,
        };
        let row = |i: usize| match domain.dimension() {
            1 => domain.place(i % domain.states(), || (i as f64 + 0.37) / ROWS as f64).point,
            _ => domain.sample(&mut Pcg::default().point(u64::MAX - 7, 0, i as u64)).point,
        };
        probes.iter().copied().chain((0..count).map(row)).collect()
    }

    /// Rows or columns of K at places, entry by entry, each over its part of the scan.
    fn lines(&self, scan: &Scan<K::Point>, along: Along, at: &[K::Point]) -> Vec<Line> {
        parallel::map(at.len(), |i| self.line(scan, along, &at[i], scan.of_row(i))).into_iter().flatten().collect()
    }

    /// Where rows are integrated towards the diagonal, what they do is not the rule's to resolve.
    fn line(&self, scan: &Scan<K::Point>, along: Along, x: &K::Point, part: Part) -> Vec<Line> {
        let (kernel, grid, c) = (self.kernel, self.grid, components::<K>());
        let near = near(kernel, grid, x);
        let centred = grid.is_centred();
        let far = |y: &K::Point| match grid.panels() {
            Some(panels) => !near[panels.at(kernel.domain().coordinate(y, 0))],
            None => !centred,
        };
        let k = |y: &K::Point| match along {
            Along::Row => kernel.eval(x, y),
            Along::Column => kernel.eval(y, x),
        };
        let values: Vec<(usize, K::Weight, bool)> =
            part.of(scan.places.len()).map(|i| (i, &scan.places[i].point)).map(|(i, y)| (i, k(y), far(y))).collect();
        let at_nodes: Vec<Option<K::Weight>> = grid.nodes.iter().map(|n| far(&n.point).then(|| k(&n.point))).collect();
        let entry = |e: usize| {
            let at_nodes: Vec<f64> = at_nodes.iter().map(|k| k.map_or(0.0, |k| k.entry(e / c, e % c))).collect();
            let values = values.iter().map(|(i, k, far)| (*i, k.entry(e / c, e % c), *far));
            line(scan, part, &at_nodes, values, |size| levels(grid, &at_nodes, size), centred)
        };
        (0..c * c).map(entry).collect()
    }
}

/// Panels on which the row at x is integrated piece by piece.
fn near<K: Kernel + HasDomain>(kernel: &K, grid: &Grid<K::Point>, x: &K::Point) -> Vec<bool> {
    grid.panels().map_or_else(Vec::new, |panels| {
        let target = Target::new(kernel, x);
        (0..panels.count()).map(|p| grid.is_product(&target, p)).collect()
    })
}

/// What interpolation may leave of a row with these values, polynomial by polynomial.
fn levels<X: Point>(grid: &Grid<X>, at_nodes: &[f64], size: f64) -> Vec<f64> {
    let level = |values: &[f64], basis: &Basis| (OUTSTANDING * basis.tail(values)).clamp(LEAST_FEATURE * size, FEATURE * size);
    match grid.polynomials() {
        Some(basis) if size.is_finite() => at_nodes.chunks_exact(basis.len()).map(|values| level(values, basis)).collect(),
        _ => vec![FEATURE * size; at_nodes.len().min(1)],
    }
}

/// From the values at the places of a part: place, K, and whether it is far from the diagonal.
fn line<X: Point>(
    scan: &Scan<X>,
    part: Part,
    at_nodes: &[f64],
    values: impl Iterator<Item = (usize, f64, bool)> + Clone,
    levels: impl Fn(f64) -> Vec<f64>,
    centred: bool,
) -> Line {
    let stand_for = |i: usize| part.stride as f64 * scan.places[i].weight;
    let (mut size, mut highest, mut mass) = (0.0f64, 0, 0.0);
    for (i, k, far) in values.clone() {
        if (far || (centred && k.is_finite())) && k.abs() > size {
            (size, highest) = (k.abs(), i);
        }
        mass += Some(stand_for(i) * k.abs()).filter(|m| m.is_finite()).unwrap_or(0.0);
    }
    let levels = levels(size);
    let block = (at_nodes.len() / levels.len().max(1)).max(1);
    let (mut gap, mut largest, mut at) = (Largest::default(), 0.0, highest);
    for (i, k, _) in values.filter(|(_, _, far)| *far) {
        let Some((first, interpolant)) = scan.interpolant(i, at_nodes) else { continue };
        let here = (k - interpolant).abs();
        let level = if levels.len() == 1 { levels[0] } else { levels[first / block] };
        if !(here <= level) {
            gap.see(gap.0 + stand_for(i) * here);
            if !(stand_for(i) * here <= largest) {
                (largest, at) = (stand_for(i) * here, i);
            }
        }
    }
    Line { highest, size, mass, gap: gap.0, at }
}
