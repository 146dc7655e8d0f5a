//! Is a Nyström solution as good as the tolerance asks? Two independent checks and a scan (problems §5d: one small difference is not an answer).
//!
//! 1. The change between two solves of different order, at every node of the finer one.
//! 2. The residual r = g + T f̃ − f̃ by a rule that shares no nodes with the solve, carried to an error by e = (I − T_n)⁻¹ r.
//! 3. What f and the rows of K are at thousands of places beside the polynomials through their values at the nodes, times ‖(I − T)⁻¹‖: a jump or a peak
//!    between nodes.
//!
//! What is narrower than the lattice of places can still hide: 1/3072 of a line away from the diagonal, 1/64 of the side of a square, 1/16 of a cube's, and
//! in x, where K is localised in both variables, 1/62 of a line. No finite number of values excludes it.

use super::grid::Grid;
use super::near::{Target, components};
use super::scan::{Largest, Scan};
use super::solution::NystromSolution;
use crate::domain::{Domain, Node};
use crate::equation::Equation;
use crate::error::Error;
use crate::kernel::{HasDomain, Kernel, Operator};
use crate::parallel;
use crate::sampling::{Pcg, Sequence};
use crate::source::Source;
use crate::value::{Value, Weight};

/// Places off the nodes.
const PROBES: u64 = 14;
/// Rows scanned beside those of the probes, on a line.
const ROWS: usize = 48;
/// What of a row is more than interpolation, which the rule squares: a feature that the nodes do not have.
const FEATURE: f64 = 1e-5;
/// f between nodes may be that of polynomials that leave less than this share of what is allowed.
const POLYNOMIAL: f64 = 0.01;
/// An error found by defect correction is known to its own order of magnitude.
const SAFETY: f64 = 1.5;

/// Values of K, taken to be good to 2 ε, and those of g err alike in both rules: neither check can see what that does.
pub(super) const ROUNDING: f64 = 4.0;

/// What the checks found.
pub(super) struct Verdict {
    /// Estimated largest |error|; infinite if something could not be checked.
    pub(super) error: f64,
    /// Panels on which the two solves differ by more than is allowed.
    pub(super) doubtful: Vec<usize>,
}

pub(super) fn verify<G, K>(
    equation: &Equation<G, K>,
    coarse: &NystromSolution<G, K>,
    fine: &NystromSolution<G, K>,
    allowed: f64,
) -> Result<Verdict, Error>
where
    G: Source + Clone,
    K: Kernel + HasDomain + Operator<Point = G::Point> + Clone,
    K::Weight: Weight<Value = G::Value>,
{
    let check = Check { equation, fine };
    let probes: Vec<K::Point> = (0..PROBES).filter_map(|i| check.probe(i)).chain(check.towards_ends()).collect();
    let (change, doubtful) = check.change(coarse, &probes, allowed)?;
    if !(change <= allowed && allowed.is_finite()) {
        return Ok(Verdict { error: change, doubtful });
    }
    fine.prepare_residuals(POLYNOMIAL * allowed);
    let residual = check.residual(&probes)?;
    let unseen = check.unseen(&probes, allowed)?;
    let mut error = Largest::default();
    let held = check.held_off(coarse)?;
    [change, residual, unseen, held, ROUNDING * rounding(fine)].into_iter().for_each(|e| error.see(e));
    Ok(Verdict { error: error.0, doubtful: Vec::new() })
}

/// What one rounding of every value of K in the same direction does to f: ½ε (I − T)⁻¹ T f.
pub(super) fn rounding<G, K>(f: &NystromSolution<G, K>) -> f64
where
    G: Source,
    K: Kernel + HasDomain + Operator<Point = G::Point>,
    K::Weight: Weight<Value = G::Value>,
{
    let nodes = f.system().grid.nodes.iter();
    let image: Vec<G::Value> = nodes.zip(f.values()).map(|(n, v)| *v - f.source().eval(&n.point)).collect();
    let mut worst = Largest::default();
    f.system().inverse_of(&image).iter().for_each(|e| worst.see(e.magnitude()));
    0.5 * f64::EPSILON * (f.magnitude() + worst.0)
}

struct Check<'a, G: Source, K: Operator> {
    equation: &'a Equation<G, K>,
    fine: &'a NystromSolution<G, K>,
}

impl<G, K> Check<'_, G, K>
where
    G: Source + Clone,
    K: Kernel + HasDomain + Operator<Point = G::Point> + Clone,
    K::Weight: Weight<Value = G::Value>,
{
    fn grid(&self) -> &Grid<K::Point> {
        &self.fine.system().grid
    }

    /// What is known of f at ends where [rows cannot be trusted](Grid::is_held_off): it is extrapolated, and from panels of two orders d^0.2 comes out 8 times
    /// closer than either is.
    fn held_off(&self, coarse: &NystromSolution<G, K>) -> Result<f64, Error> {
        let (domain, grid) = (self.equation.kernel().domain(), self.grid());
        let mut worst = Largest::default();
        for (end, state) in [0.0, 1.0].into_iter().flat_map(|end| (0..domain.states()).map(move |s| (end, s))) {
            let at = domain.place(state, || end).point;
            if grid.is_held_off(domain, &at) {
                worst.see(8.0 * (coarse.integral_term(at)? - self.fine.integral_term(at)?).magnitude());
                // nodes whose rows are those of another place
                let first = if end == 0.0 { grid.nodes.first() } else { grid.nodes.last() };
                if first.is_some_and(|n| grid.is_held_off(domain, &n.point)) {
                    worst.see(f64::INFINITY);
                }
            }
        }
        Ok(worst.0)
    }

    /// Places towards ends where K(x, ·) is unbounded.
    fn towards_ends(&self) -> impl Iterator<Item = K::Point> {
        let (domain, ends) = (self.equation.kernel().domain(), self.grid().ends());
        let unbounded = [0.0, 1.0].into_iter().filter(move |end| ends.unbounded[*end as usize]);
        let at = unbounded.flat_map(move |end| (0..domain.states()).map(move |state| (end, state)));
        at.flat_map(move |(end, state)| (2..13).map(move |k| domain.place(state, || (end - 0.17 * 0.3f64.powi(k)).abs()).point))
    }

    /// A place that no rule has as a node: random, and in one dimension at both ends and close to them as well.
    fn probe(&self, i: u64) -> Option<K::Point> {
        let domain = self.equation.kernel().domain();
        let random = domain.sample(&mut Pcg::default().point(u64::MAX - 1, 0, i)).point;
        if domain.dimension() > 1 || i >= 6 {
            return Some(random);
        }
        let t = [0.0, 1.0, 1.3e-7, 1.0 - 1.7e-7, 1.1e-3, 0.998_7][i as usize];
        let x = domain.place(domain.state(&random), || t).point;
        // g or K may have no value at an end
        self.fine.try_eval(&x).is_ok().then_some(x)
    }

    /// Largest difference of the two solves over the nodes of the coarser and the probes, and the panels where it is too large.
    fn change(&self, coarse: &NystromSolution<G, K>, probes: &[K::Point], allowed: f64) -> Result<(f64, Vec<usize>), Error> {
        let places: Vec<K::Point> = coarse.nodes().collect();
        let fine = self.fine.between_nodes(&places, POLYNOMIAL * allowed)?;
        let at_nodes = fine.iter().zip(coarse.values()).map(|(f, c)| (*f - *c).magnitude());
        let mut worst = Largest::default();
        let mut doubtful = Vec::new();
        for (j, difference) in at_nodes.enumerate() {
            worst.see(difference);
            if let Some(panels) = coarse.system().grid.panels()
                && !(difference <= 0.3 * allowed)
            {
                doubtful.push(j / panels.basis.len() % panels.count());
            }
        }
        for x in probes {
            worst.see((coarse.try_eval(x)? - self.fine.try_eval(x)?).magnitude());
        }
        doubtful.dedup();
        Ok((worst.0, doubtful))
    }

    /// The error by defect correction from residuals at the nodes, and the residuals themselves elsewhere.
    fn residual(&self, probes: &[K::Point]) -> Result<f64, Error> {
        let at_nodes = parallel::map(self.grid().nodes.len(), |j| self.fine.residual_at_node(j));
        let at_nodes = at_nodes.into_iter().collect::<Result<Vec<_>, _>>()?;
        let (mut worst, mut elsewhere) = (Largest::default(), Largest::default());
        self.fine.system().inverse_of(&at_nodes).iter().for_each(|e| worst.see(e.magnitude()));
        let probes: Vec<&K::Point> = probes.iter().filter(|x| !self.grid().is_held_off(self.equation.kernel().domain(), x)).collect();
        for residual in parallel::map(probes.len(), |i| self.fine.residual(*probes[i])) {
            elsewhere.see(residual?.magnitude());
        }
        Ok(SAFETY * (worst.0 + elsewhere.0))
    }

    /// ∫ |δ| over places that no rule has as nodes, times what T and (I − T)⁻¹ make of it; δ is what f and the rows of K are beside the polynomials through
    /// their values at the nodes.
    fn unseen(&self, probes: &[K::Point], allowed: f64) -> Result<f64, Error> {
        let (domain, c) = (self.equation.kernel().domain(), components::<K>());
        let scan = Scan::of(domain, self.grid());
        let more = if domain.dimension() == 1 { ROWS } else { 0 };
        let more = (0..more).map(|i| domain.place(i % domain.states(), || (i as f64 + 0.37) / ROWS as f64).point);
        let rows: Vec<K::Point> = probes.iter().copied().chain(more).collect();
        let lines = |along, at: &[K::Point]| parallel::map(at.len() * c * c, |i| self.line(&scan, along, &at[i / (c * c)], i % (c * c)));
        let (mut largest, mut mass, mut row, mut column) = (Largest::default(), Largest::default(), Largest::default(), Largest::default());
        // K narrow in x, whatever its rows: f has what the columns have, and the rows where they are largest count
        let columns = lines(Along::Column, &rows);
        let highest: Vec<usize> = columns.iter().map(|line| line.highest).collect::<std::collections::BTreeSet<_>>().into_iter().collect();
        let spread = rows.len() * c * c;
        let rows: Vec<K::Point> = rows.into_iter().chain(highest.iter().map(|i| scan.places[*i].point)).collect();
        for Line { size, gap, .. } in columns {
            largest.see(size);
            column.see(gap);
        }
        for (i, Line { size, mass: m, gap, .. }) in lines(Along::Row, &rows).into_iter().enumerate() {
            largest.see(size);
            row.see(gap);
            // a row at a place of the scan has its peak there, and far out that place stands for much: no sample of its integral
            if i < spread || domain.volume().is_finite() {
                mass.see(m);
            }
        }
        let (largest, mass, row) = (largest.0, mass.0, row.0);
        let of_columns = largest * column.0 * self.fine.magnitude() * self.fine.inverse_norm();
        let ask_f = self.grid().panels().is_none() || !(of_columns <= 0.1 * allowed);
        // |Tδ| ≤ sup|K| ∫|δ| and ≤ ‖T‖ sup|δ|: the second where the domain is infinite
        let image = |gaps: &[f64]| {
            let (gap, worst) = scan.sum_and_largest(gaps);
            let bound = (largest * gap).min(mass * worst);
            // K may be unbounded and gaps are anything at the very ends: row by row
            if self.grid().is_double_exponential() { bound.min(self.image(&scan, &rows, gaps)) } else { bound }
        };
        let mut unseen = Largest(self.fine.magnitude() * row);
        let mut scanned: Option<Vec<G::Value>> = None;
        for a in 0..c {
            let g = |x: &K::Point| self.equation.source().eval(x).component(a);
            let at_nodes: Vec<f64> = self.grid().nodes.iter().map(|n| g(&n.point)).collect();
            let of_g = scan.gaps(self.grid(), domain, &at_nodes, |i| Some(g(&scan.places[i].point)));
            // a singularity of g that T f takes away is none of f: ask f, which costs more
            if ask_f || !(image(&of_g) * self.fine.inverse_norm() <= 0.1 * allowed) {
                // once for all components
                let values = match scanned.take() {
                    Some(values) => values,
                    None => parallel::map(scan.places.len(), |i| self.fine.try_eval(&scan.places[i].point))
                        .into_iter()
                        .collect::<Result<_, _>>()?,
                };
                let at_nodes: Vec<f64> = self.fine.values().iter().map(|f| f.component(a)).collect();
                unseen.see(image(&scan.gaps(self.grid(), domain, &at_nodes, |i| Some(values[i].component(a)))));
                scanned = Some(values);
            }
        }
        Ok(self.fine.inverse_norm() * unseen.0)
    }

    /// Largest ∫ |K(x, ·)| gaps of the rows, entry by entry; what is not finite counts as nothing, being at an end.
    fn image(&self, scan: &Scan<K::Point>, rows: &[K::Point], gaps: &[f64]) -> f64 {
        let (kernel, c) = (self.equation.kernel(), components::<K>());
        let of_row = |i: usize| {
            let k = |n: &Node<K::Point>| kernel.eval(&rows[i / (c * c)], &n.point).entry(i % (c * c) / c, i % c).abs();
            scan.places.iter().zip(gaps).map(|(n, gap)| n.weight * k(n) * gap).filter(|v| v.is_finite()).sum::<f64>()
        };
        let images = parallel::map(rows.len() * c * c, of_row);
        images.into_iter().fold(0.0, f64::max)
    }

    /// Entry `e` of a row or column of K at x over the scan. Where rows are integrated towards the diagonal, what they do is not the rule's to resolve.
    fn line(&self, scan: &Scan<K::Point>, along: Along, x: &K::Point, e: usize) -> Line {
        let (kernel, domain, c) = (self.equation.kernel(), self.equation.kernel().domain(), components::<K>());
        let near: Vec<bool> = self.grid().panels().map_or_else(Vec::new, |panels| {
            let target = Target::new(kernel, x);
            (0..panels.count()).map(|p| self.grid().is_product(&target, p)).collect()
        });
        let centred = self.grid().is_centred();
        let far = |y: &K::Point| !centred && self.grid().panels().is_none_or(|panels| !near[panels.at(domain.coordinate(y, 0))]);
        let k = |y: &K::Point| match along {
            Along::Row => kernel.eval(x, y).entry(e / c, e % c),
            Along::Column => kernel.eval(y, x).entry(e / c, e % c),
        };
        let values: Vec<(f64, bool)> = scan.places.iter().map(|n| (k(&n.point), far(&n.point))).collect();
        let counts = |(k, far): &&(f64, bool)| *far || (centred && k.is_finite());
        let size = values.iter().filter(counts).fold(0.0f64, |m, (k, _)| m.max(k.abs()));
        let mass = scan.places.iter().zip(&values).map(|(n, (k, _))| n.weight * k.abs()).filter(|k| k.is_finite()).sum();
        let at_nodes: Vec<f64> = self.grid().nodes.iter().map(|n| if far(&n.point) { k(&n.point) } else { 0.0 }).collect();
        let gaps = scan.gaps(self.grid(), domain, &at_nodes, |i| Some(values[i].0).filter(|_| values[i].1));
        let (gap, worst) = scan.sum_and_largest(&gaps);
        let highest = (0..values.len()).filter(|i| values[*i].1).max_by(|i, j| values[*i].0.abs().total_cmp(&values[*j].0.abs()));
        Line { highest: highest.unwrap_or(0), size, mass, gap: if worst > FEATURE * size { gap } else { 0.0 } }
    }
}

/// Which variable of K runs over the scan.
#[derive(Clone, Copy)]
enum Along {
    /// y
    Row,
    /// x
    Column,
}

/// One row or column of K over the scan.
struct Line {
    /// the place where it is largest, far from the diagonal
    highest: usize,
    /// largest |K| where it is far from the diagonal
    size: f64,
    /// ∫ |K|
    mass: f64,
    /// ∫ |K − interpolant|, if it is more than interpolation
    gap: f64,
}
