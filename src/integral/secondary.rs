//! The secondary estimator: the mean of n primary ones.
//!
//! ```text
//! Î = (1/n) Σ_i ⟨I⟩_i,   E Î = I,   Var Î = V/n: the variance falls by n, the standard error by √n                  theory (2.2.1)
//! ```

use super::combined::Combined;
use super::draw::draw;
use super::{Importance, Integral, Integrator, Plain, Predict, Predictable};
use crate::domain::{Domain, Point};
use crate::error::Error;
use crate::integral::Gauss;
use crate::sampling::{Pcg, Sampler, Sequence, pilot_points};
use crate::source::Source;
use crate::statistics::{Estimate, Pooled};
use crate::value::Value;
use std::fmt::Debug;
use std::time::Instant;

/// A primary estimator: one unbiased score of ∫ f dμ from one point of the cube.
///
/// Laws: the expectation of a score is ∫_Ω f dμ, for every f that the estimator is meant for; linear in f for the same point.
pub trait Primary<D: Domain, V: Value>: Clone + Debug + Send + Sync {
    /// A score. `f` is 0 outside the domain. Coordinates are read in order from the first.
    fn score<S: Sampler>(&self, domain: &D, f: &impl Fn(&D::Point) -> V, u: &mut S) -> V;

    /// Refuses parameters outside their range.
    ///
    /// # Errors
    /// [`Error::Invalid`] naming the parameter and its value.
    fn validate(&self) -> Result<(), Error> {
        Ok(())
    }

    /// The same estimator with everything fixed that a pilot finds, and the evaluations that the pilot took. `points` are independent of the main run:
    /// what the scores themselves choose is biased (theory (4.4.8)).
    ///
    /// # Errors
    /// Those of the pilot.
    fn tuned<G>(&self, integral: &Integral<D, G>, points: &Pcg) -> Result<(Self, u64), Error>
    where
        G: Source<Point = D::Point, Value = V>,
    {
        let _ = (integral, points);
        Ok((self.clone(), 0))
    }
}

/// The mean of the scores of a primary estimator. Defaults: 16 384 samples, PCG with seed 0.
#[derive(Clone, Copy, Debug, PartialEq)]
#[must_use]
pub struct Secondary<P = Plain, Q = Pcg> {
    primary: P,
    sequence: Q,
    samples: u64,
}

impl<P> Secondary<P> {
    /// The mean of your own primary estimator.
    pub fn new(primary: P) -> Self {
        Secondary { primary, sequence: Pcg::default(), samples: 1 << 14 }
    }
}

impl Secondary {
    /// Points by the domain's own map.
    pub fn plain() -> Self {
        Secondary::new(Plain)
    }
}

impl<P> Secondary<Importance<P>> {
    /// Points from a density ([`Density`](super::Density)).
    pub fn importance(density: P) -> Self {
        Secondary::new(Importance(density))
    }
}

impl<X: Point> Secondary<Combined<X>> {
    /// Points from several densities, combined by weights.
    pub fn combined(techniques: Combined<X>) -> Self {
        Secondary::new(techniques)
    }
}

impl<P, Q: Sequence> Secondary<P, Q> {
    /// Scores in all replicates together; rounded up to a multiple of the replicates.
    pub fn samples(self, samples: u64) -> Self {
        Secondary { samples, ..self }
    }

    /// Sets the seed.
    pub fn seed(self, seed: u64) -> Self {
        Secondary { sequence: self.sequence.with_seed(seed), ..self }
    }

    /// Draws from another sequence.
    pub fn sequence<R: Sequence>(self, sequence: R) -> Secondary<P, R> {
        Secondary { primary: self.primary, sequence, samples: self.samples }
    }
}

/// Refuses empty budgets.
pub(super) fn validate(samples: u64, replicates: Option<u32>) -> Result<(), Error> {
    if samples == 0 {
        return Err(Error::invalid("samples", 0.0, "must be at least 1"));
    }
    if replicates == Some(0) {
        return Err(Error::invalid("replicates", 0.0, "must be at least 1"));
    }
    Error::held("replicates", replicates.map_or(1, u64::from))
}

impl<D, G, P, Q> Integrator<D, G> for Secondary<P, Q>
where
    D: Domain,
    G: Source<Point = D::Point>,
    P: Primary<D, G::Value>,
    Q: Sequence,
{
    type Solution = Estimate<G::Value>;

    fn solve(&self, integral: &Integral<D, G>) -> Result<Estimate<G::Value>, Error> {
        let clock = Instant::now();
        integral.validate()?;
        self.primary.validate()?;
        let randomisations = self.sequence.replicates();
        validate(self.samples, randomisations)?;
        let (primary, spent) = self.primary.tuned(integral, &pilot_points(&self.sequence))?;
        let replicates = randomisations.unwrap_or(1);
        let count = self.samples.div_ceil(u64::from(replicates));
        let (parts, tail, evaluations) = draw(integral, &self.sequence, 0, (replicates, count), &|probe, u: &mut Q::Sampler| {
            primary.score(integral.domain(), &|x| probe.eval(x), u)
        })?;
        let Pooled { moments, std_error, degrees_of_freedom } = Pooled::of(randomisations, &parts);
        Ok(Estimate {
            value: moments.mean,
            std_error,
            degrees_of_freedom,
            moments,
            tail: Some(tail),
            steps: 0,
            evaluations: evaluations + spent,
            truncation: None,
            elapsed: clock.elapsed(),
        })
    }
}

/// V/n, for independent points.
impl<D, G, P> Predictable<D, G> for Secondary<P, Pcg>
where
    D: Domain,
    G: Source<Point = D::Point>,
    P: Predict<D, G::Value>,
{
    fn predict(&self, integral: &Integral<D, G>, rule: &Gauss) -> Result<G::Value, Error> {
        self.primary.validate()?;
        validate(self.samples, None)?;
        let nodes = rule.nodes(integral)?;
        let (_, variance) = self.primary.moments(integral.domain(), &nodes, &|x| integral.integrand().eval(x))?;
        Ok(variance.scale(1.0 / self.samples as f64))
    }
}
