//! A tolerance instead of a rule.
//!
//! 1. Gauss–Legendre on the whole domain, doubled while it converges geometrically: smooth kernels end here.
//! 2. In one dimension, else: panels with product integration towards the diagonal. A panel is halved where the Legendre tail of f, weighted by
//!    the mass of K on it, or the tail of K(x, ·) for x elsewhere is above the tolerance (both: the kernel, not only f, sets the error of a rule).
//!    f between the nodes is the Nyström interpolant, which shows singular ends of f long before the panels resolve them: one coarse solve
//!    plans all panels.
//! 3. Accepted only if two successive solves of different order agree *and* ‖(I − T)⁻¹‖ × the residual by a rule that shares no node
//!    is within the tolerance (problems §5d: one small difference is not an answer), and a scan of g and of rows of K on 1024 places finds nothing
//!    that the rule missed. Otherwise [`Error::NotConverged`].
//!
//! What is narrower than 1/1024 of the domain and away from the diagonal can still hide: no finite number of values excludes it.

use super::basis::Basis;
use super::grid::{Grid, Panels};
use super::near::{Target, components};
use super::nystrom::{Factorised, Nystrom, graded_breaks};
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

/// Order of the panels, and of the solve that verifies them.
const ORDER: usize = 16;
const VERIFYING: usize = ORDER + 4;
/// No panel is halved below this share of the domain.
const SMALLEST: f64 = 1.0 / (1u64 << 42) as f64;
/// A tail counts as resolved below this share of the tolerance: there are many panels.
const SHARE: f64 = 0.1;
/// Halvings of a panel in one round: T applied to a poor interpolant has kinks of its own at the ends of panels, which must not be refined for ever.
const DEPTH: usize = 3;
const ROUNDS: usize = 18;
const PROBES: u64 = 12;
/// Panels of the scan, of four nodes each.
const SCANNED: f64 = 256.0;

pub(super) fn solve<G, K>(
    equation: &Equation<G, K>,
    settings: &Nystrom,
    tolerance: f64,
    most: usize,
) -> Result<NystromSolution<G, K>, Error>
where
    G: Source + Clone,
    K: Kernel + HasDomain + Operator<Point = G::Point> + Clone,
    K::Weight: Weight<Value = G::Value>,
{
    if !(tolerance > 0.0 && tolerance.is_finite()) {
        return Err(Error::invalid("tolerance", tolerance, "must be positive and finite"));
    }
    let segments = settings.segments(equation.kernel().domain())?;
    let mut search = Search { equation, tolerance, most, evaluations: 0, error: f64::INFINITY, largest: 0 };
    if segments.len() == 2
        && let Some(found) = search.globally()?
    {
        return Ok(found);
    }
    if equation.kernel().domain().dimension() == 1
        && let Some(found) = search.by_panels(&segments)?
    {
        return Ok(found);
    }
    Err(Error::NotConverged { error: search.error, tolerance, unknowns: search.largest })
}

struct Search<'a, G, K> {
    equation: &'a Equation<G, K>,
    tolerance: f64,
    most: usize,
    evaluations: u64,
    /// of the best attempt
    error: f64,
    largest: usize,
}

impl<G, K> Search<'_, G, K>
where
    G: Source + Clone,
    K: Kernel + HasDomain + Operator<Point = G::Point> + Clone,
    K::Weight: Weight<Value = G::Value>,
{
    fn domain(&self) -> &K::Domain {
        self.equation.kernel().domain()
    }

    fn attempt(&mut self, grid: Grid<K::Point>) -> Result<NystromSolution<G, K>, Error> {
        self.largest = self.largest.max(grid.nodes.len() * G::Value::COMPONENTS);
        let f = Factorised::on_grid(self.equation.kernel(), grid)?.solve(self.equation.source())?;
        self.evaluations += f.evaluations();
        Ok(f)
    }

    fn affordable(&self, nodes: f64) -> bool {
        nodes * G::Value::COMPONENTS as f64 <= self.most as f64
    }

    fn allowed(&self, f: &NystromSolution<G, K>) -> f64 {
        self.tolerance * f.magnitude().max(1.0)
    }

    /// The error of `fine` if both checks can be made: difference to `coarse` and amplified residual.
    fn verify(&mut self, coarse: &NystromSolution<G, K>, fine: &NystromSolution<G, K>) -> Result<f64, Error> {
        let difference = self.difference(coarse, fine)?;
        if difference > self.allowed(fine) {
            self.error = self.error.min(difference);
            return Ok(difference);
        }
        let residuals = parallel::map(PROBES as usize, |i| self.probe(i as u64).map(|x| fine.residual(x).map(|r| r.magnitude())));
        let mut residual = 0.0f64;
        for r in residuals.into_iter().flatten() {
            residual = residual.max(r?);
        }
        let unseen = if self.domain().dimension() == 1 { self.unseen(fine) } else { 0.0 };
        // NaN from the scan must not pass: `f64::max` would drop it
        let error = if unseen.is_nan() { f64::INFINITY } else { difference.max(fine.inverse_norm() * residual.max(unseen)) };
        self.error = self.error.min(error);
        Ok(error)
    }

    /// What a scan finds in ∫ g and ∫ K(x, ·) max |f| that the rule of `f` did not, panel by panel.
    fn unseen(&self, f: &NystromSolution<G, K>) -> f64 {
        let (kernel, domain) = (self.equation.kernel(), self.domain());
        let whole = ([0.0, 1.0].as_slice(), unit_rule(f.values().len() / domain.states()));
        let (breaks, rule) = f.system().grid.panels().map_or(whole, |p| (p.breaks.as_slice(), p.basis.rule().to_vec()));
        let gap = |skip: &dyn Fn((f64, f64)) -> bool, phi: &dyn Fn(f64) -> f64| {
            let panels = breaks.windows(2).map(|e| (e[0], e[1])).filter(|p| (p.1 - p.0) * SCANNED > 1.0 && !skip(*p));
            panels.map(|p| gap_on(p, &rule, phi)).sum::<f64>()
        };
        let mut gaps = Vec::new();
        for state in 0..domain.states() {
            let place = |t: f64| domain.place(state, || t);
            for i in 0..G::Value::COMPONENTS {
                gaps.push(gap(&|_| false, &|t| self.equation.source().eval(&place(t).point).component(i)));
            }
            let c = components::<K>();
            for (x, e) in (0..PROBES).filter_map(|i| self.probe(i)).flat_map(|x| (0..c * c).map(move |e| (x, e))) {
                let target = Target::new(kernel, &x);
                let near = |panel| f.system().grid.panels().is_some() && target.is_near(panel);
                let entry = |t: f64| {
                    let y = place(t);
                    kernel.eval(&x, &y.point).entry(e / c, e % c) * y.weight
                };
                gaps.push(f.magnitude() * gap(&near, &entry));
            }
        }
        gaps.iter().fold(0.0, |m: f64, g| if g.is_nan() { f64::NAN } else { m.max(*g) })
    }

    fn difference(&self, coarse: &NystromSolution<G, K>, fine: &NystromSolution<G, K>) -> Result<f64, Error> {
        let mut worst = 0.0f64;
        for x in (0..PROBES).filter_map(|i| self.probe(i)) {
            worst = worst.max((coarse.try_eval(&x)? - fine.try_eval(&x)?).magnitude());
        }
        Ok(worst)
    }

    /// A place that no rule has as a node: random, and in one dimension close to both ends as well.
    fn probe(&self, i: u64) -> Option<K::Point> {
        let domain = self.domain();
        let random = domain.sample(&mut Pcg::default().point(u64::MAX - 1, 0, i)).point;
        if domain.dimension() > 1 || i >= 4 {
            return Some(random);
        }
        let t = [1.3e-7, 1.1e-3, 0.998_7, 1.0 - 1.7e-7][i as usize];
        let x = domain.place(domain.state(&random), || t).point;
        domain.contains(&x).then_some(x)
    }

    fn globally(&mut self) -> Result<Option<NystromSolution<G, K>>, Error> {
        let (dimension, states) = (self.domain().dimension(), self.domain().states());
        let orders: &[usize] = match dimension {
            1 => &[12, 24, 48, 96, 192],
            2 => &[5, 8, 12, 18, 27, 40],
            3 => &[3, 5, 7, 9, 12],
            _ => &[2, 3, 4, 5, 6],
        };
        let (mut last, mut change): (Option<NystromSolution<G, K>>, f64) = (None, f64::INFINITY);
        for &order in orders {
            if !self.affordable((order as f64).powi(dimension as i32) * states as f64) {
                break;
            }
            let grid = Grid::plain(self.domain(), 1, order)?;
            let fine = match self.attempt(grid) {
                // singular on the diagonal: panels never evaluate it there
                Err(Error::NonFiniteKernel { .. }) if dimension == 1 => return Ok(None),
                Err(Error::Singular { .. }) if order != orders[orders.len() - 1] => continue,
                other => other?,
            };
            if let Some(coarse) = last {
                let error = self.verify(&coarse, &fine)?;
                if error <= self.allowed(&fine) {
                    return Ok(Some(fine.with_error(error, self.evaluations)));
                }
                // not geometric: panels will do better
                if dimension == 1 && order > 24 && error > 0.03 * change {
                    return Ok(None);
                }
                change = error;
            }
            last = Some(fine);
        }
        Ok(None)
    }

    fn by_panels(&mut self, segments: &[f64]) -> Result<Option<NystromSolution<G, K>>, Error> {
        let states = self.domain().states() as f64;
        let mut breaks = graded_breaks(segments, 4, 0);
        for _ in 0..ROUNDS {
            if !self.affordable((breaks.len() - 1) as f64 * VERIFYING as f64 * states) {
                self.largest = self.largest.max(((breaks.len() - 1) as f64 * VERIFYING as f64 * states) as usize);
                return Ok(None);
            }
            let coarse = self.attempt(Grid::panelled(self.domain(), breaks.clone(), ORDER)?)?;
            let finer = self.refine(&coarse)?;
            if finer.len() > breaks.len() {
                breaks = finer;
                continue;
            }
            let fine = self.attempt(Grid::panelled(self.domain(), breaks.clone(), VERIFYING)?)?;
            let error = self.verify(&coarse, &fine)?;
            if error <= self.allowed(&fine) {
                return Ok(Some(fine.with_error(error, self.evaluations)));
            }
            breaks = halved(&breaks);
        }
        Ok(None)
    }

    /// The panels that f and K ask for.
    fn refine(&self, f: &NystromSolution<G, K>) -> Result<Vec<f64>, Error> {
        let panels = f.system().grid.panels().expect("solved on panels");
        let allowed = SHARE * self.allowed(f);
        let mut breaks = vec![panels.breaks[0]];
        for p in 0..panels.count() {
            let (a, b) = panels.panel(p);
            if b - a > SMALLEST && self.kernel_tail(panels, p)? * f.magnitude() > allowed {
                let middle = 0.5 * (a + b);
                self.halve(f, &panels.basis, (a, middle), allowed, DEPTH - 1, &mut breaks)?;
                self.halve(f, &panels.basis, (middle, b), allowed, DEPTH - 1, &mut breaks)?;
            } else {
                self.halve(f, &panels.basis, (a, b), allowed, DEPTH, &mut breaks)?;
            }
        }
        Ok(breaks)
    }

    /// Appends the ends of the panels into which [a, b] must be cut for f, at most `depth` times in half.
    fn halve(
        &self,
        f: &NystromSolution<G, K>,
        basis: &Basis,
        panel: (f64, f64),
        allowed: f64,
        depth: usize,
        breaks: &mut Vec<f64>,
    ) -> Result<(), Error> {
        let (a, b) = panel;
        if depth > 0 && b - a > SMALLEST && self.source_tail(f, basis, panel)? > allowed {
            let middle = 0.5 * (a + b);
            self.halve(f, basis, (a, middle), allowed, depth - 1, breaks)?;
            return self.halve(f, basis, (middle, b), allowed, depth - 1, breaks);
        }
        breaks.push(b);
        Ok(())
    }

    /// Legendre tail of f on a panel × the mass of K there: what the unresolved part of f does elsewhere.
    fn source_tail(&self, f: &NystromSolution<G, K>, basis: &Basis, (a, b): (f64, f64)) -> Result<f64, Error> {
        let domain = self.domain();
        let place = |state: usize, u: f64| domain.place(state, || a + (b - a) * u).point;
        let mut worst = 0.0f64;
        for state in 0..domain.states() {
            let values = parallel::map(basis.len(), |k| f.try_eval(&place(state, basis.rule()[k].point)));
            let values = values.into_iter().collect::<Result<Vec<_>, _>>()?;
            let component = |i: usize| basis.tail(&values.iter().map(|v| v.component(i)).collect::<Vec<_>>());
            let tail = (0..G::Value::COMPONENTS).map(component).fold(0.0, f64::max);
            let mut mass = 0.0f64;
            for from in 0..domain.states() {
                let x = place(from, 0.5);
                let c = components::<K>();
                let mut moments = vec![0.0; basis.len() * c * c];
                Target::new(self.equation.kernel(), &x).moments(state, (a, b), basis, basis, &mut moments)?;
                mass = mass.max(moments.iter().map(|m| m.abs()).sum());
            }
            worst = worst.max(tail * mass.min(1.0));
        }
        Ok(worst)
    }

    /// What Gauss nodes on panel `p` miss of ∫ K(x, ·) for x on panels that count it as far: Gauss integrates twice the degree it interpolates,
    /// hence the square of the tail.
    fn kernel_tail(&self, panels: &Panels, p: usize) -> Result<f64, Error> {
        let (kernel, domain) = (self.equation.kernel(), self.domain());
        let (a, b) = panels.panel(p);
        let c = components::<K>();
        let nodes: Vec<Vec<Node<K::Point>>> =
            (0..domain.states()).map(|s| panels.basis.rule().iter().map(|n| domain.place(s, || a + (b - a) * n.point)).collect()).collect();
        let mut worst = 0.0f64;
        for q in 0..panels.count() {
            let (low, high) = panels.panel(q);
            for from in 0..domain.states() {
                let x = domain.place(from, || low + 0.5 * (high - low)).point;
                if Target::new(kernel, &x).is_near((a, b)) {
                    continue;
                }
                for (row, e) in nodes.iter().flat_map(|row| (0..c * c).map(move |e| (row, e))) {
                    let values: Vec<f64> = row.iter().map(|y| kernel.eval(&x, &y.point).entry(e / c, e % c) * y.weight * (b - a)).collect();
                    let largest = values.iter().fold(0.0f64, |m, v| m.max(v.abs()));
                    if largest > 0.0 {
                        worst = worst.max(panels.basis.tail(&values).powi(2) / largest);
                    }
                }
            }
        }
        Ok(worst)
    }
}

/// |∫ φ by the rule − ∫ φ by many small panels| over one panel.
fn gap_on((a, b): (f64, f64), rule: &[Node<f64>], phi: &dyn Fn(f64) -> f64) -> f64 {
    let integral = |rule: &[Node<f64>]| rule.iter().map(|n| n.weight * (b - a) * phi(a + (b - a) * n.point)).sum::<f64>();
    let parts = ((b - a) * SCANNED).ceil() as usize;
    (integral(rule) - integral(&composite_unit_rule(parts, 4))).abs()
}

fn halved(breaks: &[f64]) -> Vec<f64> {
    let mut out = vec![breaks[0]];
    for ends in breaks.windows(2) {
        out.extend([0.5 * (ends[0] + ends[1]), ends[1]]);
    }
    out
}
