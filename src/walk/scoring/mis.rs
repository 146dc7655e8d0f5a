//! Next event combined with the walk's own hits by multiple importance sampling.
//!
//! ```text
//! Y = g(X₀) + Σ_n W_n [ w_q(X_n, ζ_n) (K g/q)(ζ_n)  +  1{survive} w_π(X_n, X_{n+1}) (K/π)(X_n, X_{n+1}) g(X_{n+1}) ]      theory (4.4.4)
//! w_i = p_i^β / Σ_k p_k^β,      p_q = q,  p_π = π = P · pdf                                                                theory (4.4.5)
//! ```
//!
//! Derivation: both techniques estimate (Tg)(X_n); weights that add up to 1 wherever K g ≠ 0, and vanish where their technique has no density,
//! keep the sum unbiased. The survival probability belongs into π.
//!
//! Wins whenever neither technique is good everywhere: the balance heuristic is never worse than the better one by more than a bounded amount
//! (theory (4.4.7)). Reference: Veach, Guibas, *Optimally combining sampling techniques for Monte Carlo rendering*, SIGGRAPH 1995.

use super::next_event::{along, unstated};
use super::{Arrival, Scoring, Visit, evaluated, scored};
use crate::equation::Equation;
use crate::error::Error;
use crate::kernel::{Density, Kernel, Operator, TransitionPdf};
use crate::sampling::Sampler;
use crate::source::SampleSource;
use crate::value::{Value, Weight};
use crate::walk::{Ending, Observer};

/// How two techniques share a point (theory (4.4.5)).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Heuristic {
    /// w ∝ p (β = 1).
    Balance,
    /// w ∝ p^β; β = 2 is the usual choice.
    Power(f64),
    /// All to the larger density, ties to the next event (β = ∞, theory (2.2.5)).
    Maximum,
    /// Equal shares among the techniques with p > 0 (β = 0).
    Average,
}

impl Heuristic {
    /// Weight of the technique of density `own` against one of density `other`; `first` breaks ties of the maximum.
    ///
    /// Law: `share(a, b, First) + share(b, a, Second) = 1` unless both are 0, and `share(0, b, _) = 0`.
    ///
    /// ```
    /// use fredholm::walk::{Heuristic, Technique};
    /// assert_eq!(Heuristic::Balance.share(1.0, 3.0, Technique::First), 0.25);
    /// assert_eq!(Heuristic::Power(2.0).share(1.0, 3.0, Technique::First), 0.1);
    /// ```
    #[inline]
    #[must_use]
    pub fn share(&self, own: f64, other: f64, technique: Technique) -> f64 {
        if own <= 0.0 {
            return 0.0;
        }
        if other <= 0.0 {
            return 1.0;
        }
        // from the ratio: p^β would overflow (theory §6.2, MIS)
        let ratio = other / own;
        match self {
            Heuristic::Balance => 1.0 / (1.0 + ratio),
            Heuristic::Power(beta) => 1.0 / (1.0 + if *beta == 2.0 { ratio * ratio } else { ratio.powf(*beta) }),
            Heuristic::Maximum => match technique {
                Technique::First => f64::from(own >= other),
                Technique::Second => f64::from(own > other),
            },
            Heuristic::Average => 0.5,
        }
    }
}

impl Heuristic {
    /// Weight of technique `i` among any number of them, from n_k p_k of each; the first wins ties of the maximum (theory (2.2.5)).
    ///
    /// Law: over all `i` the weights add up to 1, unless all densities are 0; where its own density is 0 a technique has weight 0.
    ///
    /// ```
    /// use fredholm::walk::Heuristic;
    /// let p = [1.0, 0.0, 3.0];
    /// assert_eq!(Heuristic::Balance.weight(2, p.iter().copied()), 0.75);
    /// assert_eq!(Heuristic::Average.weight(0, p.iter().copied()), 0.5);
    /// ```
    #[inline]
    #[must_use]
    pub fn weight(&self, i: usize, densities: impl Iterator<Item = f64> + Clone) -> f64 {
        let own = densities.clone().nth(i).unwrap_or(0.0);
        if own <= 0.0 {
            return 0.0;
        }
        // from the ratios: p^β would overflow (theory §6.2, MIS)
        let ratios = densities.clone().enumerate().filter(|(_, p)| *p > 0.0).map(|(k, p)| if k == i { (k, 1.0) } else { (k, p / own) });
        match self {
            Heuristic::Balance => 1.0 / ratios.map(|r| r.1).sum::<f64>(),
            Heuristic::Power(beta) => 1.0 / ratios.map(|r| if *beta == 2.0 { r.1 * r.1 } else { r.1.powf(*beta) }).sum::<f64>(),
            // compared, not divided: a ratio of densities one ulp apart may round to 1 in one direction only
            Heuristic::Maximum => f64::from(u8::from(!densities.enumerate().any(|(k, p)| p > own || (p == own && k < i)))),
            Heuristic::Average => 1.0 / ratios.count() as f64,
        }
    }

    /// Refuses exponents that are none.
    pub(crate) fn validate(&self) -> Result<(), Error> {
        match self {
            Heuristic::Power(beta) if !(*beta > 0.0 && beta.is_finite()) => {
                Err(Error::invalid("power heuristic exponent", *beta, "must be positive and finite"))
            }
            _ => Ok(()),
        }
    }
}

/// Which of two techniques a weight is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Technique {
    /// Next event: wins ties of the maximum heuristic.
    First,
    /// The walk's own step.
    Second,
}

/// Next event and the walk's own hits, weighted by a [`Heuristic`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mis(pub Heuristic);

impl<G, K> Scoring<G, K> for Mis
where
    G: SampleSource,
    K: Kernel + TransitionPdf + Operator<Point = G::Point>,
    K::Weight: Weight<Value = G::Value>,
{
    const EVALUATIONS: u64 = 1;

    #[inline]
    fn arrival<O: Observer<K::Point, K::Weight>>(
        &self,
        equation: &Equation<G, K>,
        visit: &Visit<K::Point, K::Weight>,
        arrival: Arrival<K::Point, K::Weight>,
        score: &mut G::Value,
        observer: &mut O,
    ) {
        if arrival.density() == Density::Unstated {
            *score += unstated::<G, K, O>(visit, arrival, "multiple importance sampling", observer);
            return;
        }
        let g = evaluated(equation, visit, observer);
        // most points of a scene emit nothing: no density is asked for there
        if g == G::Value::ZERO {
            return;
        }
        let share = match (arrival.density(), &arrival) {
            (Density::Known(pdf), Arrival::Step { from, .. }) => {
                self.0.share(pdf, equation.source().pdf_for(from, &visit.point), Technique::Second)
            }
            (Density::Deferred(survival), Arrival::Step { from, .. }) => {
                let pdf = survival * equation.kernel().pdf(from, &visit.point);
                self.0.share(pdf, equation.source().pdf_for(from, &visit.point), Technique::Second)
            }
            _ => 1.0,
        };
        *score += scored(visit, g, share, observer);
    }

    #[inline]
    fn vertex<S: Sampler, O: Observer<K::Point, K::Weight>>(
        &self,
        equation: &Equation<G, K>,
        visit: &Visit<K::Point, K::Weight>,
        u: &mut S,
        score: &mut G::Value,
        observer: &mut O,
    ) {
        let Some(event) = equation.source().sample_for(&visit.point, u) else { return };
        let (k, pdf) = equation.kernel().eval_and_pdf(&visit.point, &event.point);
        observer.kernel(&visit.point, &event.point, &k);
        let share = self.0.share(1.0 / event.weight, visit.survival * pdf, Technique::First);
        *score += along(equation, visit, (&event.point, k), share * event.weight, observer);
    }

    fn validate<E: Ending<K>>(&self, _: &Equation<G, K>, _: &E) -> Result<(), Error> {
        self.0.validate()
    }
}
