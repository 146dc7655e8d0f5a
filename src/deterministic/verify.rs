//! Is a Nyström solution as good as the tolerance asks? Two independent checks and a scan (problems §5d: one small difference is not an answer).
//!
//! 1. The change between two solves of different order, at every node of the finer one.
//! 2. The residual r = g + T f̃ − f̃ by a rule that shares no nodes with the solve, carried to an error by e = (I − T_n)⁻¹ r.
//! 3. What f and the rows of K are at thousands of places beside the polynomials through their values at the nodes, times ‖(I − T)⁻¹‖: a jump or a peak
//!    between nodes.
//!
//! What is narrower than the lattice of places can still hide: 1/3072 of a line away from the diagonal and its ends, 1/64 of the side of a square, 1/16 of a
//! cube's, and of K on a line what covers less than about 1/5000 of the square. No finite number of values excludes it.

use super::grid::Grid;
use super::scan::Largest;
use super::solution::NystromSolution;
use crate::domain::Domain;
use crate::equation::Equation;
use crate::error::Error;
use crate::kernel::{HasDomain, Kernel, Operator};
use crate::parallel;
use crate::sampling::{Pcg, Sequence};
use crate::source::Source;
use crate::value::{Value, Weight};

/// Places off the nodes.
const PROBES: u64 = 14;
/// f between nodes may be that of polynomials that leave less than this share of what is allowed.
const POLYNOMIAL: f64 = 0.01;
/// Towards ends where K(x, ·) is unbounded both rules err alike.
const AT_UNBOUNDED_ENDS: f64 = 3.0;
/// An error found by defect correction is known to its own order of magnitude.
const SAFETY: f64 = 1.5;

/// Values of K, taken to be good to 2 ε, and those of g err alike in both rules: neither check can see what that does.
pub(super) const ROUNDING: f64 = 4.0;

/// What the checks found.
pub(super) struct Verdict {
    /// Estimated largest |error|; infinite if something could not be checked.
    pub(super) error: f64,
    /// Panels on which the two solves differ by more than is allowed, or have something between nodes.
    pub(super) doubtful: Vec<usize>,
    /// Intervals of the coordinate that hold what is between nodes.
    pub(super) features: Vec<(f64, f64)>,
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
        return Ok(Verdict { error: change, doubtful, features: Vec::new() });
    }
    fine.prepare_residuals(POLYNOMIAL * allowed);
    let residual = check.residual(&probes)?;
    let unseen = check.unseen(&probes, allowed)?;
    let mut error = Largest::default();
    let held = check.held_off(coarse)?;
    [change, residual, unseen.error, held, ROUNDING * rounding(fine)].into_iter().for_each(|e| error.see(e));
    let close = if fine.system().grid.ends().unbounded == [false; 2] { 1.0 } else { AT_UNBOUNDED_ENDS };
    Ok(Verdict { error: close * error.0, doubtful: unseen.panels.into_iter().collect(), features: unseen.features })
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

/// Whether two rules agree on how close 1 is to the spectrum: where g has nothing of the null function, f does not tell.
pub(super) fn same_resolvent<G, K>(coarse: &NystromSolution<G, K>, fine: &NystromSolution<G, K>) -> bool
where
    G: Source,
    K: Kernel + HasDomain + Operator<Point = G::Point>,
    K::Weight: Weight<Value = G::Value>,
{
    const HARMLESS: f64 = 1e4;
    const SAME: f64 = 3.0;
    let (a, b) = (coarse.inverse_norm(), fine.inverse_norm());
    b < HARMLESS || (b < SAME * a && a < SAME * b)
}

pub(super) struct Check<'a, G: Source, K: Operator> {
    pub(super) equation: &'a Equation<G, K>,
    pub(super) fine: &'a NystromSolution<G, K>,
}

impl<G, K> Check<'_, G, K>
where
    G: Source + Clone,
    K: Kernel + HasDomain + Operator<Point = G::Point> + Clone,
    K::Weight: Weight<Value = G::Value>,
{
    pub(super) fn grid(&self) -> &Grid<K::Point> {
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
        self.fine.value_at(&x).is_ok().then_some(x)
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
            worst.see((coarse.value_at(x)? - self.fine.value_at(x)?).magnitude());
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
}
