//! Is a Nyström solution as good as the tolerance asks? Two independent checks and a scan (problems §5d: one small difference is not an answer).
//!
//! 1. The change between two solves of different order, at every node of the finer one.
//! 2. The residual r = g + T f̃ − f̃ by a rule that shares no nodes with the solve, carried to an error by e = (I − T_n)⁻¹ r.
//! 3. What thousands of places of g, of rows of K and, where g is doubtful, of f show that the rule did not see, times ‖(I − T)⁻¹‖: a jump or a peak between nodes.
//!
//! What is narrower than 1/3000 of the domain and away from the diagonal can still hide: no finite number of values excludes it.

use super::grid::Grid;
use super::near::{Target, components};
use super::quadrature::{composite_unit_rule, unit_rule};
use super::solution::NystromSolution;
use crate::domain::{Domain, Node};
use crate::equation::Equation;
use crate::error::Error;
use crate::kernel::{HasDomain, Kernel, Operator};
use crate::parallel;
use crate::sampling::{Pcg, Sequence};
use crate::source::Source;
use crate::value::{Value, Weight};
use nalgebra::DVector;

/// Places off the nodes.
const PROBES: u64 = 14;
/// Panels of the scan.
const SCANNED: f64 = 256.0;
/// Nodes a panel of the scan where a value is cheap: a kernel singular at the distance of the panel's length is resolved to rounding. And where it is not.
const FINE: usize = 12;
const COARSE: usize = 4;
/// An error found by defect correction is known to its own order of magnitude.
const SAFETY: f64 = 2.0;

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
    let probes: Vec<K::Point> = (0..PROBES).filter_map(|i| check.probe(i)).collect();
    let (change, doubtful) = check.change(coarse, &probes, allowed)?;
    if !(change <= allowed) {
        return Ok(Verdict { error: change, doubtful });
    }
    let residual = check.residual(&probes)?;
    let unseen = if equation.kernel().domain().dimension() == 1 { fine.inverse_norm() * check.unseen(&probes, allowed)? } else { 0.0 };
    let found = [change, residual, unseen];
    // NaN must not pass: `f64::max` would drop it
    let error = if found.iter().any(|e| e.is_nan()) { f64::INFINITY } else { found.into_iter().fold(0.0, f64::max) };
    // values of K, taken to be good to 2ε, err alike in both rules: neither check can see what that does
    let error = error.max(4.0 * rounding(fine));
    Ok(Verdict { error, doubtful: Vec::new() })
}

/// What one rounding of every value of K in the same direction does to f: ½ε (I − T)⁻¹ T f.
pub(super) fn rounding<G, K>(f: &NystromSolution<G, K>) -> f64
where
    G: Source,
    K: Kernel + HasDomain + Operator<Point = G::Point>,
    K::Weight: Weight<Value = G::Value>,
{
    let (nodes, c) = (&f.system().grid.nodes, G::Value::COMPONENTS);
    let mut image = DVector::zeros(c * nodes.len());
    for (j, n) in nodes.iter().enumerate() {
        let tf = f.values()[j] - f.source().eval(&n.point);
        (0..c).for_each(|a| image[c * j + a] = tf.component(a));
    }
    0.5 * f64::EPSILON * (f.magnitude() + f.system().factor.solve(&image).amax())
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

    /// A place that no rule has as a node: random, and in one dimension at both ends and close to them as well.
    fn probe(&self, i: u64) -> Option<K::Point> {
        let domain = self.equation.kernel().domain();
        let random = domain.sample(&mut Pcg::default().point(u64::MAX - 1, 0, i)).point;
        if domain.dimension() > 1 || i >= 6 {
            return Some(random);
        }
        let t = [0.0, 1.0, 1.3e-7, 1.0 - 1.7e-7, 1.1e-3, 0.998_7][i as usize];
        let x = domain.place(domain.state(&random), || t).point;
        // g may have no value at an end
        (domain.contains(&x) && self.equation.source().eval(&x).all_finite()).then_some(x)
    }

    /// Largest difference of the two solves over the nodes of the finer and the probes, and the panels where it is too large.
    fn change(&self, coarse: &NystromSolution<G, K>, probes: &[K::Point], allowed: f64) -> Result<(f64, Vec<usize>), Error> {
        let mut worst = 0.0f64;
        for x in probes {
            worst = worst.max((coarse.try_eval(x)? - self.fine.try_eval(x)?).magnitude());
        }
        let (nodes, values) = (&self.grid().nodes, self.fine.values());
        let at_nodes = parallel::map(nodes.len(), |j| coarse.try_eval(&nodes[j].point).map(|v| (v - values[j]).magnitude()));
        let mut doubtful = Vec::new();
        for (j, difference) in at_nodes.into_iter().enumerate() {
            let difference = difference?;
            worst = if difference.is_nan() { f64::INFINITY } else { worst.max(difference) };
            if let Some(panels) = self.grid().panels()
                && !(difference <= 0.3 * allowed)
            {
                doubtful.push(j / panels.basis.len() % panels.count());
            }
        }
        doubtful.dedup();
        Ok((worst, doubtful))
    }

    /// The error by defect correction from residuals at the nodes, and the residuals themselves elsewhere.
    fn residual(&self, probes: &[K::Point]) -> Result<f64, Error> {
        let (nodes, c) = (&self.grid().nodes, G::Value::COMPONENTS);
        let at_nodes = parallel::map(nodes.len(), |j| self.fine.residual_at_node(j));
        let mut r = DVector::zeros(c * nodes.len());
        for (j, residual) in at_nodes.into_iter().enumerate() {
            let residual = residual?;
            (0..c).for_each(|a| r[c * j + a] = residual.component(a));
        }
        let e = self.fine.system().factor.solve(&r);
        let mut elsewhere = 0.0f64;
        for residual in parallel::map(probes.len(), |i| self.fine.residual(probes[i])) {
            let residual = residual?.magnitude();
            elsewhere = if residual.is_nan() { f64::INFINITY } else { elsewhere.max(residual) };
        }
        Ok(SAFETY * (e.iter().fold(0.0f64, |m, v| if v.is_nan() { f64::NAN } else { m.max(v.abs()) }) + elsewhere))
    }

    /// What a scan finds in ∫ f and ∫ K(x, ·) max |f| that the rule did not, panel by panel.
    fn unseen(&self, probes: &[K::Point], allowed: f64) -> Result<f64, Error> {
        let (kernel, domain) = (self.equation.kernel(), self.equation.kernel().domain());
        let whole = ([0.0, 1.0].as_slice(), unit_rule(self.fine.values().len() / domain.states()));
        let (breaks, rule) = self.grid().panels().map_or(whole, |p| (p.breaks.as_slice(), p.basis.rule().to_vec()));
        let panels = || breaks.windows(2).map(|e| (e[0], e[1])).filter(|p| (p.1 - p.0) * SCANNED > 1.0);
        let c = components::<K>();
        let mut worst = 0.0f64;
        let mut note = |gap: f64| worst = if gap.is_nan() || worst.is_nan() { f64::NAN } else { worst.max(gap) };
        for state in 0..domain.states() {
            let place = |t: f64| domain.place(state, || t);
            for i in 0..c {
                let mut sum = 0.0;
                for panel in panels() {
                    let gap = gap_on(panel, &rule, FINE, |t| Ok(self.equation.source().eval(&place(t).point).component(i)))?;
                    // a singularity of g that T f takes away is none of f: ask f, which costs more
                    if !(gap * self.fine.inverse_norm() <= 0.1 * allowed) {
                        sum += gap_on(panel, &rule, COARSE, |t| Ok(self.fine.try_eval(&place(t).point)?.component(i)))?;
                    }
                }
                note(sum);
            }
            for (x, e) in probes.iter().flat_map(|x| (0..c * c).map(move |e| (x, e))) {
                let target = Target::new(kernel, x);
                let mut sum = 0.0;
                for panel in panels().filter(|p| self.grid().panels().is_none() || !target.is_near(*p)) {
                    sum += gap_on(panel, &rule, FINE, |t| {
                        let y = place(t);
                        Ok(kernel.eval(x, &y.point).entry(e / c, e % c) * y.weight)
                    })?;
                }
                note(self.fine.magnitude() * sum);
            }
        }
        Ok(worst)
    }
}

/// |∫ φ by the rule − ∫ φ by many small panels of `nodes` nodes| over one panel.
fn gap_on((a, b): (f64, f64), rule: &[Node<f64>], nodes: usize, phi: impl Fn(f64) -> Result<f64, Error> + Sync) -> Result<f64, Error> {
    let integral = |rule: &[Node<f64>]| -> Result<f64, Error> {
        let values = parallel::map(rule.len(), |i| phi(a + (b - a) * rule[i].point).map(|v| rule[i].weight * (b - a) * v));
        values.into_iter().sum()
    };
    let parts = ((b - a) * SCANNED).ceil() as usize;
    Ok((integral(rule)? - integral(&composite_unit_rule(parts, nodes))?).abs())
}
