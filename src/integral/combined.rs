//! Combined sampling: multiple importance sampling.
//!
//! ```text
//! ⟨I⟩ = Σ_i (1/n_i) Σ_j w_i(ξ_ij) f(ξ_ij)/p_i(ξ_ij),        Σ_i w_i = 1 where f ≠ 0,  w_i = 0 where p_i = 0
//! w_i = (n_i p_i)^β / Σ_k (n_k p_k)^β:   β = 1 balance, 2 power, ∞ maximum (ties to the first), 0 average          theory (4.4.5)
//! V   = ∫ Σ_i w_i² f²/(n_i p_i) − Σ_i (1/n_i) (∫ w_i f)²                                                           theory (4.4.6)
//! V_balance ≤ V_any + (1/min n_i − 1/Σ n_i) I²                                                                     theory (4.4.7)
//! ```
//!
//! One score is a whole multi-sample of n₁ + n₂ + … evaluations. f² stands in V, not f (theory (2.2.2)); ties of the maximum count once (theory
//! (2.2.5)); the average is over techniques that can find the point. Reference: Veach, Guibas, *Optimally combining sampling techniques for Monte
//! Carlo rendering*, SIGGRAPH 1995; Veach (1997), ch. 9.

use super::density::{Density, Erased};
use super::optimal;
use super::predict::{Predict, square_over};
use super::{Integral, Primary};
use crate::domain::{Domain, Node, Point};
use crate::error::Error;
use crate::sampling::{Pcg, Sampler};
use crate::source::Source;
use crate::value::Value;
use crate::walk::Heuristic;
use std::sync::Arc;

/// Several techniques and how their samples share the integral.
///
/// ```
/// use fredholm::integral::{Combined, Integral, Secondary, inverse};
/// use fredholm::walk::Heuristic;
/// let integral = Integral::on_interval(0.0..=1.0, f64::exp);
/// let two = Combined::new(Heuristic::Balance)
///     .technique(inverse(|u| u, |_: &f64| 1.0), 1)
///     .technique(inverse(|u: f64| u.sqrt(), |x| 2.0 * x), 2);
/// assert!(integral.solve(&Secondary::combined(two))?.agrees_with(1f64.exp() - 1.0, 5.0));
/// # Ok::<(), fredholm::Error>(())
/// ```
#[derive(Clone)]
#[must_use]
pub struct Combined<X> {
    pub(super) techniques: Vec<Technique<X>>,
    weights: Weights,
}

/// A density and how many samples it gives to every score.
#[derive(Clone)]
pub(super) struct Technique<X> {
    density: Arc<dyn Erased<X>>,
    pub(super) samples: u32,
}

#[derive(Clone, Debug, PartialEq)]
enum Weights {
    Heuristic(Heuristic),
    /// α unknown yet: this many scores of a pilot
    Pilot(u64),
    /// α_k for every technique, by components
    Mixture(Vec<Vec<f64>>),
}

impl<X> std::fmt::Debug for Combined<X> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let samples: Vec<u32> = self.techniques.iter().map(|t| t.samples).collect();
        f.debug_struct("Combined").field("samples", &samples).field("weights", &self.weights).finish_non_exhaustive()
    }
}

impl<X: Point> Combined<X> {
    /// No techniques yet, weighted by a heuristic.
    pub fn new(heuristic: Heuristic) -> Self {
        Combined { techniques: Vec::new(), weights: Weights::Heuristic(heuristic) }
    }

    /// No techniques yet, with the optimal weights of Kondapaneni et al. (2019), from `pilot` scores on points of their own; see theory (4.4.8).
    pub fn optimal(pilot: u64) -> Self {
        Combined { techniques: Vec::new(), weights: Weights::Pilot(pilot) }
    }

    /// Adds a density that gives `samples` samples to every score.
    pub fn technique(mut self, density: impl Density<X> + 'static, samples: u32) -> Self {
        self.techniques.push(Technique { density: Arc::new(density), samples });
        self
    }

    /// n_k p_k(x) of all techniques.
    pub(super) fn effective<'a>(&'a self, x: &'a X) -> impl Iterator<Item = f64> + Clone + 'a {
        self.techniques.iter().map(move |t| f64::from(t.samples) * t.density.pdf(x))
    }

    /// p_k(x).
    pub(super) fn pdf(&self, k: usize, x: &X) -> f64 {
        self.techniques[k].density.pdf(x)
    }

    /// w_i(x)/(n_i p_i(x)) at a point that technique i has found; NaN if it says that it cannot.
    fn share(&self, heuristic: Heuristic, i: usize, x: &X) -> f64 {
        let own = self.effective(x).nth(i).unwrap_or(f64::NAN);
        // a technique that denies its own point breaks the law of its density: the score must not pass for 0
        if own > 0.0 { heuristic.weight(i, self.effective(x)) / own } else { f64::NAN }
    }

    /// Calls `visit` with every point of a multi-sample and its technique.
    pub(super) fn multisample<S: Sampler>(&self, u: &mut S, mut visit: impl FnMut(usize, &X)) {
        for (i, t) in self.techniques.iter().enumerate() {
            for _ in 0..t.samples {
                visit(i, &t.density.sample(u).point);
            }
        }
    }

    /// Σ_k α_k p_k(x).
    fn mixture<V: Value>(&self, alpha: &[Vec<f64>], x: &X) -> V {
        let pdfs = || self.techniques.iter().map(|t| t.density.pdf(x));
        V::from_components(|c| alpha.iter().zip(pdfs()).map(|(a, p)| a[c] * p).sum())
    }
}

impl<D: Domain, V: Value> Primary<D, V> for Combined<D::Point> {
    fn score<S: Sampler>(&self, domain: &D, f: &impl Fn(&D::Point) -> V, u: &mut S) -> V {
        let mut score = V::ZERO;
        match &self.weights {
            Weights::Heuristic(h) => self.multisample(u, |i, x| score += f(x).scale(self.share(*h, i, x))),
            Weights::Mixture(alpha) => {
                score = V::from_components(|c| alpha.iter().map(|a| a[c]).sum());
                self.multisample(u, |i, x| {
                    score += (f(x) - self.mixture(alpha, x)).scale(self.share(Heuristic::Balance, i, x));
                });
            }
            // without α: balance
            Weights::Pilot(_) => return Combined { weights: Weights::Heuristic(Heuristic::Balance), ..self.clone() }.score(domain, f, u),
        }
        score
    }

    fn validate(&self) -> Result<(), Error> {
        if self.techniques.is_empty() {
            return Err(Error::invalid("techniques", 0.0, "there must be at least one"));
        }
        if self.techniques.iter().any(|t| t.samples == 0) {
            return Err(Error::invalid("samples of a technique", 0.0, "must be at least 1"));
        }
        match self.weights {
            Weights::Heuristic(h) => h.validate(),
            Weights::Pilot(n) if n < 2 => Err(Error::invalid("pilot samples", n as f64, "must be at least 2")),
            _ => Ok(()),
        }
    }

    fn tuned<G>(&self, integral: &Integral<D, G>, points: &Pcg) -> Result<(Self, u64), Error>
    where
        G: Source<Point = D::Point, Value = V>,
    {
        let Weights::Pilot(n) = self.weights else { return Ok((self.clone(), 0)) };
        let (alpha, spent) = optimal::pilot(self, integral, points, n)?;
        Ok((Combined { weights: Weights::Mixture(alpha), ..self.clone() }, spent))
    }
}

impl<X: Point> Combined<X> {
    /// Refuses techniques with mass outside the domain: f is 0 there, the mixture of optimal weights is not.
    fn stays_inside(&self, nodes: &[Node<X>]) -> Result<(), Error> {
        for t in &self.techniques {
            let outside = 1.0 - nodes.iter().map(|n| n.weight * t.density.pdf(&n.point)).sum::<f64>();
            if !(outside.abs() < 1e-6) {
                let requirement = "must be 0 to predict the variance of optimal weights, by a rule that integrates the density to 1e-6";
                return Err(Error::invalid("mass of a technique outside the domain", outside, requirement));
            }
        }
        Ok(())
    }

    /// ∫ f and theory (4.4.6).
    fn heuristic_moments<V: Value>(&self, heuristic: Heuristic, nodes: &[Node<X>], f: &dyn Fn(&X) -> V) -> (V, V) {
        let (mut mean, mut variance) = (V::ZERO, V::ZERO);
        for n in nodes {
            mean += f(&n.point).scale(n.weight);
        }
        for (i, t) in self.techniques.iter().enumerate() {
            let mut part = V::ZERO;
            for n in nodes {
                let own = f64::from(t.samples) * t.density.pdf(&n.point);
                let wf = f(&n.point).scale(heuristic.weight(i, self.effective(&n.point)));
                part += wf.scale(n.weight);
                variance += wf.map(|wf| square_over(wf, own)).scale(n.weight);
            }
            variance = variance - part.map(|p| p * p / f64::from(t.samples));
        }
        // what no technique can find is missed without a trace: no variance would tell
        let missed = nodes.iter().any(|n| f(&n.point).magnitude() > 0.0 && self.effective(&n.point).sum::<f64>() == 0.0);
        (mean, if missed { V::from_components(|_| f64::INFINITY) } else { variance })
    }
}

impl<D: Domain, V: Value> Predict<D, V> for Combined<D::Point> {
    fn moments(&self, _: &D, nodes: &[Node<D::Point>], f: &dyn Fn(&D::Point) -> V) -> Result<(V, V), Error> {
        if !matches!(self.weights, Weights::Heuristic(_)) {
            self.stays_inside(nodes)?;
        }
        let alpha = match &self.weights {
            Weights::Heuristic(h) => return Ok(self.heuristic_moments(*h, nodes, f)),
            Weights::Mixture(alpha) => alpha.clone(),
            Weights::Pilot(_) => optimal::by_quadrature(self, nodes, f),
        };
        // balance for f − Σ α_k p_k, and a constant
        let (mean, variance) = self.heuristic_moments(Heuristic::Balance, nodes, &|x| f(x) - self.mixture(&alpha, x));
        Ok((mean + V::from_components(|c| alpha.iter().map(|a| a[c]).sum()), variance))
    }
}
