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
use super::solution::NystromSolution;
use crate::domain::{Domain, Node, Point};
use crate::equation::Equation;
use crate::error::Error;
use crate::kernel::{HasDomain, Kernel, Operator};
use crate::parallel;
use crate::sampling::{Pcg, Sampler, Sequence};
use crate::source::Source;
use crate::value::{Value, Weight};
use nalgebra::DVector;

/// Places off the nodes.
const PROBES: u64 = 14;
/// Places of the scan on a line.
const SCANNED: usize = 3072;
/// Rows scanned beside those of the probes, on a line.
const ROWS: usize = 48;
/// What of a row is more than interpolation, which the rule squares: a feature that the nodes do not have.
const FEATURE: f64 = 1e-5;
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
    if !(change <= allowed && allowed.is_finite()) {
        return Ok(Verdict { error: change, doubtful });
    }
    let residual = check.residual(&probes)?;
    let unseen = check.unseen(&probes, allowed)?;
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
        // g or K may have no value at an end
        self.fine.try_eval(&x).is_ok().then_some(x)
    }

    /// Largest difference of the two solves over the nodes of the finer and the probes, and the panels where it is too large.
    fn change(&self, coarse: &NystromSolution<G, K>, probes: &[K::Point], allowed: f64) -> Result<(f64, Vec<usize>), Error> {
        let mut worst = 0.0f64;
        for x in probes {
            let difference = (coarse.try_eval(x)? - self.fine.try_eval(x)?).magnitude();
            worst = if difference.is_nan() { f64::INFINITY } else { worst.max(difference) };
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

    /// Whether rows are integrated towards the diagonal where y lies: what they do there is not the rule's to resolve.
    fn is_near(&self, target: Option<&Target<'_, K>>, y: &K::Point) -> bool {
        let (Some(target), Some(panels)) = (target, self.grid().panels()) else { return false };
        target.is_near(panels.panel(panels.at(self.equation.kernel().domain().coordinate(y, 0))))
    }

    /// ∫ |δ| over places that no rule has as nodes, times what T and (I − T)⁻¹ make of it; δ is what f and the rows of K are beside the polynomials through
    /// their values at the nodes.
    fn unseen(&self, probes: &[K::Point], allowed: f64) -> Result<f64, Error> {
        let (kernel, domain, c) = (self.equation.kernel(), self.equation.kernel().domain(), components::<K>());
        let scan = Scan::of(domain);
        let along_line = domain.dimension() == 1;
        let more =
            (0..if along_line { ROWS } else { 0 }).map(|i| scan.places[(i * scan.places.len() + scan.places.len() / 2) / ROWS].point);
        let rows: Vec<K::Point> = probes.iter().copied().chain(more).collect();
        let found = parallel::map(rows.len() * c * c, |i| {
            let (x, e) = (&rows[i / (c * c)], i % (c * c));
            let target = along_line.then(|| Target::new(kernel, x));
            let k = |y: &K::Point| kernel.eval(x, y).entry(e / c, e % c);
            let far = |y: &K::Point| !self.is_near(target.as_ref(), y);
            let size = scan.places.iter().filter(|n| far(&n.point)).fold(0.0f64, |m, n| m.max(k(&n.point).abs()));
            let at_nodes: Vec<f64> = self.grid().nodes.iter().map(|n| if far(&n.point) { k(&n.point) } else { 0.0 }).collect();
            let mass: f64 = scan.places.iter().map(|n| n.weight * k(&n.point).abs()).filter(|k| k.is_finite()).sum();
            let (gap, worst) = scan.gap(self.grid(), domain, |j| at_nodes[j], |y| Some(k(y)).filter(|_| far(y)));
            (size, mass, if worst > FEATURE * size { gap } else { 0.0 })
        });
        let largest = found.iter().fold(0.0f64, |m, (size, ..)| m.max(*size));
        let mass = found.iter().fold(0.0f64, |m, (_, mass, _)| m.max(*mass));
        let row = found.iter().fold(0.0f64, |m, (.., gap)| if gap.is_nan() { f64::NAN } else { m.max(*gap) });
        // |Tδ| ≤ sup|K| ∫|δ| and ≤ ‖T‖ sup|δ|: the second where the domain is infinite
        let image = |(gap, worst): (f64, f64)| if gap.is_nan() { f64::NAN } else { (largest * gap).min(mass * worst) };
        let mut unseen = self.fine.magnitude() * row;
        for a in 0..c {
            let g = |x: &K::Point| self.equation.source().eval(x).component(a);
            let nodes = &self.grid().nodes;
            let of_g = scan.gap(self.grid(), domain, |j| g(&nodes[j].point), |x| Some(g(x)));
            // a singularity of g that T f takes away is none of f: ask f, which costs more
            if !(image(of_g) * self.fine.inverse_norm() <= 0.1 * allowed) {
                let values = parallel::map(scan.places.len(), |i| self.fine.try_eval(&scan.places[i].point).map(|v| v.component(a)));
                let values = values.into_iter().collect::<Result<Vec<_>, _>>()?;
                let of_f = scan.gap_of(self.grid(), domain, |j| self.fine.values()[j].component(a), |i| Some(values[i]));
                unseen = if image(of_f).is_nan() { f64::NAN } else { unseen.max(image(of_f)) };
            }
        }
        Ok(self.fine.inverse_norm() * unseen)
    }
}

/// Places of a jittered lattice, each with its share of the measure.
struct Scan<X> {
    places: Vec<Node<X>>,
}

impl<X: Point> Scan<X> {
    fn of<D: Domain<Point = X>>(domain: &D) -> Self {
        let d = domain.dimension();
        let side = [SCANNED, 64, 16, 8].get(d - 1).copied().unwrap_or(4);
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
        Scan { places: (0..domain.states()).flat_map(|s| (0..count).map(move |i| (s, i))).map(|(s, i)| place(s, i)).collect() }
    }

    /// ∫ |φ − interpolant| over the places where φ is given, and the largest |φ − interpolant|.
    fn gap<D: Domain<Point = X>>(
        &self,
        grid: &Grid<X>,
        domain: &D,
        nodes: impl Fn(usize) -> f64,
        phi: impl Fn(&X) -> Option<f64>,
    ) -> (f64, f64) {
        self.gap_of(grid, domain, nodes, |i| phi(&self.places[i].point))
    }

    fn gap_of<D: Domain<Point = X>>(
        &self,
        grid: &Grid<X>,
        domain: &D,
        nodes: impl Fn(usize) -> f64,
        phi: impl Fn(usize) -> Option<f64>,
    ) -> (f64, f64) {
        let (mut sum, mut largest) = (0.0, 0.0f64);
        for (i, n) in self.places.iter().enumerate() {
            let Some(value) = phi(i) else { continue };
            let Some(interpolated) = grid.interpolate(domain, &n.point, &nodes) else { continue };
            let gap = (value - interpolated).abs();
            largest = if gap.is_nan() { f64::INFINITY } else { largest.max(gap) };
            sum += n.weight * gap;
        }
        (sum, largest)
    }
}
