//! Functional expansion: coefficients of orthogonal functions.
//!
//! ```text
//! f̂(x) = g(x) + Σ_{k<m} c_k ψ_k(x),      c_k = E Σ_{n ≥ 1} W_n ψ*_k(Z_n)                                        theory (4.6.5)
//! Legendre               ψ_k = P_k(t),   ψ*_k = (2k + 1)/L · P_k(t)                                     t ∈ [−1, 1] along the interval of length L
//! Chebyshev, 2nd kind    ψ_k = U_k(t),   ψ*_k = 4/(πL) · U_k(t) √(1 − t²)
//! ```
//!
//! The coefficients are unbiased, the truncated sum is not: [`missed`](Expansion::missed) measures what m functions cannot say, given T f from a deterministic
//! solve. g is not expanded: T f is the smoother part. Polynomials of the first kind T_k are left out: their weight 1/√(1 − t²) gives scores of
//! infinite variance. Reference: Griesheimer, Martin, Holloway, *Estimation of Monte Carlo functional expansion tallies*, Nucl. Sci. Eng. 155 (2007) 153.

use super::{PlanOf, Tally, check_points, source_at};
use crate::detector::{Detector, Score, Start};
use crate::deterministic::quadrature::composite_unit_rule;
use crate::domain::{Domain, Interval};
use crate::equation::Equation;
use crate::error::Error;
use crate::kernel::{HasAdjoint, Operator};
use crate::sampling::Sampler;
use crate::source::{Emit, Source};
use crate::statistics::Bias;
use crate::value::{Value, Weight};
use crate::walk::Collided;
use std::f64::consts::PI;

/// Which functions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Basis {
    /// P_k: best in the mean square.
    Legendre,
    /// U_k: bounded scores, for less weight on the ends.
    ChebyshevSecond,
}

/// More coefficients would be noise: that of c_k grows as √k.
const MOST_TERMS: usize = 4096;

/// `terms` coefficients on an interval, summed at points.
#[derive(Clone, Debug, PartialEq)]
pub struct Expansion {
    interval: Interval,
    basis: Basis,
    terms: usize,
    points: Vec<f64>,
}

impl Expansion {
    /// Legendre polynomials of degree below `terms`.
    #[must_use]
    pub fn legendre(interval: impl Into<Interval>, terms: usize, points: &[f64]) -> Self {
        Expansion { interval: interval.into(), basis: Basis::Legendre, terms, points: points.to_vec() }
    }

    /// Chebyshev polynomials of the second kind of degree below `terms`.
    #[must_use]
    pub fn chebyshev_second(interval: impl Into<Interval>, terms: usize, points: &[f64]) -> Self {
        Expansion { basis: Basis::ChebyshevSecond, ..Expansion::legendre(interval, terms, points) }
    }

    /// Calls `f(k, ψ_k(x), ψ*_k(x))` for every k, by the three-term recurrences.
    #[inline]
    fn each(&self, x: f64, mut f: impl FnMut(usize, f64, f64)) {
        let t = 2.0 * self.interval.coordinate(&x, 0) - 1.0;
        let length = self.interval.length();
        let edge = 4.0 / (PI * length) * (1.0 - t * t).max(0.0).sqrt();
        let (mut last, mut now) = (0.0, 1.0);
        for k in 0..self.terms {
            let n = k as f64;
            let (dual, next) = match self.basis {
                Basis::Legendre => ((2.0 * n + 1.0) / length * now, ((2.0 * n + 1.0) * t * now - n * last) / (n + 1.0)),
                Basis::ChebyshevSecond => (edge * now, 2.0 * t * now - last),
            };
            f(k, now, dual);
            (last, now) = (now, next);
        }
    }

    /// The L² norm over the interval of what the basis cannot say of `tf`, and that of `tf` itself; NaN for more terms than a solve accepts.
    ///
    /// ```
    /// use fredholm::{Equation, deterministic::Nystrom, walk::Expansion};
    /// let eq = Equation::on_interval(0.0..=1.0, |_| 1.0, |x: f64, y: f64| 0.5 * (x * y).exp());
    /// let f = eq.solve(&Nystrom::gauss_legendre(16))?;
    /// let (missed, all) = Expansion::legendre(0.0..=1.0, 4, &[]).missed(|x| f.eval(x) - 1.0);
    /// assert!(missed < 1e-3 * all);
    /// # Ok::<(), fredholm::Error>(())
    /// ```
    pub fn missed<V: Value>(&self, tf: impl Fn(f64) -> V) -> (f64, f64) {
        if self.terms > MOST_TERMS {
            return (f64::NAN, f64::NAN);
        }
        let rule = composite_unit_rule(8 + self.terms / 4, 12);
        let nodes: Vec<_> = rule.iter().map(|n| (self.interval.at(n.point), n.weight * self.interval.length())).collect();
        let values: Vec<V> = nodes.iter().map(|n| tf(n.0)).collect();
        let mut coefficients = vec![V::ZERO; self.terms];
        for ((x, w), v) in nodes.iter().zip(&values) {
            self.each(*x, |k, _, dual| coefficients[k] += v.scale(w * dual));
        }
        let norm = |v: V| (0..V::COMPONENTS).map(|i| v.component(i).powi(2)).sum::<f64>();
        let (mut missed, mut all) = (0.0, 0.0);
        for ((x, w), v) in nodes.iter().zip(&values) {
            let mut rest = *v;
            self.each(*x, |k, psi, _| rest = rest - coefficients[k].scale(psi));
            missed += w * norm(rest);
            all += w * norm(*v);
        }
        (missed.sqrt(), all.sqrt())
    }
}

/// The cells are the coefficients.
impl Detector for Expansion {
    type Point = f64;
    type Answer<T> = Vec<T>;
    fn cells(&self) -> usize {
        self.terms
    }
    fn start<S: Sampler>(&self, cell: usize, u: &mut S) -> Start<f64> {
        let node = self.interval.sample(u);
        let mut weight = 0.0;
        self.each(node.point, |k, _, dual| {
            if k == cell {
                weight = dual * node.weight
            }
        });
        Start { point: node.point, weight }
    }
    fn answer<T>(&self, cells: Vec<T>) -> Vec<T> {
        cells
    }
    fn validate(&self) -> Result<(), Error> {
        self.interval.validate()?;
        match self.terms {
            0 => Err(Error::invalid("terms", 0.0, "must be at least 1")),
            terms if terms > MOST_TERMS => Err(Error::invalid("terms", terms as f64, "must be at most 4096")),
            _ => Ok(()),
        }
    }
}

impl<V: Value> Score<f64, V> for Expansion {
    const EVERY_CELL: bool = true;
    #[inline]
    fn score<S: Sampler>(&self, z: &f64, load: V, _: &mut S, mut add: impl FnMut(usize, V)) {
        if self.interval.contains(z) {
            self.each(*z, |k, _, dual| add(k, load.scale(dual)));
        }
    }
}

impl<G, K> Tally<G, K> for Expansion
where
    G: Emit<State = f64> + Source<Point = f64>,
    K: HasAdjoint + Operator<Point = f64>,
    K::Weight: Weight<Value = G::Value>,
{
    type Point = f64;
    type Detector = Expansion;
    type Scoring = Collided;

    fn plan(&self, equation: &Equation<G, K>, _: u64) -> Result<PlanOf<G, K, Self>, Error> {
        check_points(self.interval, &self.points)?;
        self.validate()?;
        let known = source_at(equation.source(), &self.points)?;
        let row = |x: &f64| {
            let mut row = vec![0.0; self.terms];
            self.each(*x, |k, psi, _| row[k] = psi);
            row
        };
        let matrix = Some(self.points.iter().map(row).collect());
        let (points, bias) = (self.points.clone(), Bias::Projection { terms: self.terms });
        Ok(super::Plan { points, detector: self.clone(), scoring: Collided, known, known_error: 0.0, matrix, bias })
    }
}
