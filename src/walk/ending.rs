//! When a walk ends: the survival probability P of every vertex.
//!
//! Roulette belongs to the method, absorption to the kernel. The weight is divided by P, so every ending is unbiased except a fixed
//! depth, whose bias is bounded and reported.

use crate::error::Error;
use crate::kernel::{Operator, RowMass};
use std::fmt::Debug;

/// Whether a walk goes on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Survival {
    /// P = 1; no random number is spent.
    Certain,
    /// P = `probability` ∈ [0, 1]; the weight of survivors is multiplied by `reciprocal` = 1/P.
    Chance {
        /// P.
        probability: f64,
        /// 1/P.
        reciprocal: f64,
    },
}

impl Survival {
    /// Survival with probability `p` ∈ [0, 1]; certain from 1 on. The driver refuses negative and NaN probabilities with the place.
    #[inline]
    #[must_use]
    pub fn with_probability(p: f64) -> Self {
        if p >= 1.0 { Survival::Certain } else { Survival::Chance { probability: p, reciprocal: 1.0 / p } }
    }

    /// P.
    #[inline]
    #[must_use]
    pub fn probability(&self) -> f64 {
        match self {
            Survival::Certain => 1.0,
            Survival::Chance { probability, .. } => *probability,
        }
    }
}

/// The survival probability of a vertex.
pub trait Ending<K: Operator>: Copy + Debug + Send + Sync + 'static {
    /// P ∈ [0, 1] at the vertex number `depth` (0 = start) at x, where the walk carries weights of magnitude `throughput`.
    ///
    /// Law: a function of the walk so far only; 0 where the walk may still score means bias, declared by [`cut`](Ending::cut).
    fn survival(&self, kernel: &K, x: &K::Point, depth: u64, throughput: f64) -> Survival;

    /// The depth at which walks are cut whatever their weight.
    fn cut(&self) -> Option<u64> {
        None
    }

    /// Whether the walk can always end, P ≤ sup P < 1; the absorption estimator needs it where the kernel never absorbs.
    fn always_may_end(&self) -> bool {
        false
    }

    /// Whether this ending ever ends a walk.
    fn ends(&self) -> bool {
        true
    }

    /// P(x) where survival depends on the place alone: what the variance can be predicted for (theory §4.3).
    fn survival_at(&self, kernel: &K, x: &K::Point) -> Option<f64> {
        let _ = (kernel, x);
        None
    }

    /// Refuses probabilities outside (0, 1] and the like.
    ///
    /// # Errors
    /// [`Error::Invalid`] naming the parameter and its value.
    fn validate(&self) -> Result<(), Error> {
        Ok(())
    }
}

/// Russian roulette (theory §4.11): constant, or by throughput P = min(1, |W|/W_ref).
///
/// ```
/// use fredholm::{Equation, Walk, walk::Roulette};
/// let eq = Equation::on_interval(0.0..=1.0, |_| 1.0, |x, y| 0.5 * x * y);
/// for roulette in [Roulette::constant(0.5), Roulette::throughput(1.0), Roulette::constant(0.3).after(4)] {
///     assert!(eq.at(0.5).solve(&Walk::collision().roulette(roulette))?.agrees_with(1.15, 5.0));
/// }
/// # Ok::<(), fredholm::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Roulette {
    rule: Rule,
    after: u64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Rule {
    Constant(f64),
    Throughput(f64),
}

impl Roulette {
    /// Survive with probability `p` ∈ (0, 1] at every vertex. Finite variance needs ρ(K²/(p·proposal)) < 1 (theory (4.1.7)).
    #[must_use]
    pub fn constant(p: f64) -> Self {
        Roulette { rule: Rule::Constant(p), after: 0 }
    }

    /// Survive with probability min(1, |W|/`reference`) (theory (4.11.1)): weights that survive are at least `reference`.
    #[must_use]
    pub fn throughput(reference: f64) -> Self {
        Roulette { rule: Rule::Throughput(reference), after: 0 }
    }

    /// No roulette at the first `depth` vertices.
    #[must_use]
    pub fn after(self, depth: u64) -> Self {
        Roulette { after: depth, ..self }
    }
}

impl<K: Operator> Ending<K> for Roulette {
    #[inline]
    fn survival(&self, _: &K, _: &K::Point, depth: u64, throughput: f64) -> Survival {
        if depth < self.after {
            return Survival::Certain;
        }
        match self.rule {
            Rule::Constant(p) => Survival::with_probability(p),
            // a weight that is not finite ends the walk, whose score then tells
            Rule::Throughput(_) if !throughput.is_finite() => Survival::with_probability(0.0),
            Rule::Throughput(reference) if throughput >= reference => Survival::Certain,
            Rule::Throughput(reference) => Survival::Chance { probability: throughput / reference, reciprocal: reference / throughput },
        }
    }

    fn survival_at(&self, _: &K, _: &K::Point) -> Option<f64> {
        match self.rule {
            Rule::Constant(p) if self.after == 0 => Some(p),
            _ => None,
        }
    }

    fn always_may_end(&self) -> bool {
        self.after == 0 && matches!(self.rule, Rule::Constant(p) if p < 1.0)
    }

    fn ends(&self) -> bool {
        !matches!(self.rule, Rule::Constant(p) if p >= 1.0)
    }

    fn validate(&self) -> Result<(), Error> {
        match self.rule {
            Rule::Constant(p) if !(p > 0.0 && p <= 1.0) => Err(Error::invalid("roulette survival probability", p, "must lie in (0, 1]")),
            Rule::Throughput(r) if !(r > 0.0 && r.is_finite()) => {
                Err(Error::invalid("roulette reference throughput", r, "must be positive and finite"))
            }
            _ => Ok(()),
        }
    }
}

/// Cut every walk after `depth` steps: estimates Σ_{n ≤ depth} Tⁿg, with the bias bound printed (theory (4.2.3)).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FixedDepth(pub u64);

impl<K: Operator> Ending<K> for FixedDepth {
    #[inline]
    fn survival(&self, _: &K, _: &K::Point, depth: u64, _: f64) -> Survival {
        if depth < self.0 { Survival::Certain } else { Survival::with_probability(0.0) }
    }
    fn cut(&self) -> Option<u64> {
        Some(self.0)
    }
}

/// Only the kernel's own absorption ends walks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct OwnAbsorption;

impl<K: Operator> Ending<K> for OwnAbsorption {
    #[inline]
    fn survival(&self, _: &K, _: &K::Point, _: u64, _: f64) -> Survival {
        Survival::Certain
    }
    fn survival_at(&self, _: &K, _: &K::Point) -> Option<f64> {
        Some(1.0)
    }
    fn ends(&self) -> bool {
        false
    }
}

/// Subcritical survival P(x) = min(1, M(x)) (theory (4.2.5)); with a proposal ∝ |K| the weights stay near ±1.
///
/// Where M(x) > 1 the walk survives and carries the weight on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Subcritical;

impl<K: RowMass> Ending<K> for Subcritical {
    #[inline]
    fn survival(&self, kernel: &K, x: &K::Point, _: u64, _: f64) -> Survival {
        let mass = kernel.mass(x);
        // a mass that is NaN or negative is no probability: the driver refuses it with the place
        if mass >= 1.0 { Survival::Certain } else { Survival::with_probability(mass) }
    }

    fn survival_at(&self, kernel: &K, x: &K::Point) -> Option<f64> {
        Some(kernel.mass(x).min(1.0))
    }
}
