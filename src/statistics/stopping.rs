//! Stopping at a target error without losing the coverage of the interval.
//!
//! Looking at the data after every round and stopping at the first short interval under-covers. A *confidence sequence* is valid at all
//! looks at once (theory (4.16.3b)): Waudby-Smith, Arbour, Sinha, Kennedy, Ramdas, *Time-uniform central limit theory and asymptotic confidence
//! sequences*, Ann. Statist. 52 (2024), eq. (5): after t scores of variance σ̂²,
//!
//! ```text
//! |ȳ_t − f| ≤ σ̂ √( 2(tρ²+1)/(t²ρ²) · ln( √(tρ²+1)/α ) )      for all t ≥ t₀, with probability → 1 − α as t₀ → ∞
//! ```
//!
//! ρ is chosen so that the sequence is tightest where it is expected to stop.

use super::Estimate;
use crate::error::Error;
use crate::value::Value;

/// When to stop: half-width of a time-uniform confidence sequence below a target.
///
/// ```
/// # use fredholm::{Equation, Walk, statistics::Target};
/// let eq = Equation::on_interval(0.0..=1.0, |_| 1.0, |x, y| 0.5 * x * y);
/// let target = Target::absolute(2e-3)?;
/// let query = eq.at(0.5);
/// let mut rounds = query.rounds(&Walk::collision().samples_per_cell(1 << 22))?;
/// let f = loop {
///     let round = rounds.next().expect("the target is met before the budget is spent")?;
///     if target.progress(&round.estimates).met { break round.estimates; }
/// };
/// assert!((f.value - 1.15).abs() < 2e-3);
/// # Ok::<(), fredholm::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Target {
    absolute: f64,
    relative: f64,
    confidence: f64,
    minimum: u64,
}

/// How far a run is from its target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// Whether the run may stop.
    pub met: bool,
    /// Half-width of the confidence sequence now: largest over the components. Infinite while unknown.
    pub half_width: f64,
    /// The half-width that is asked for.
    pub wanted: f64,
    /// Share of the work done, by half-width ∝ 1/√N; in [0, 1].
    pub fraction: f64,
}

impl Target {
    /// |value − f| ≤ `error`, in the units of f.
    ///
    /// # Errors
    /// [`Error::Invalid`] unless `error` is positive and finite.
    pub fn absolute(error: f64) -> Result<Self, Error> {
        check("target absolute error", error)?;
        Ok(Target { absolute: error, relative: 0.0, confidence: 0.95, minimum: 1024 })
    }

    /// |value − f| ≤ `error` · |value|, for the largest component.
    ///
    /// # Errors
    /// [`Error::Invalid`] unless `error` is positive and finite.
    pub fn relative(error: f64) -> Result<Self, Error> {
        check("target relative error", error)?;
        Ok(Target { absolute: 0.0, relative: error, confidence: 0.95, minimum: 1024 })
    }

    /// Probability that the interval at the stopping time covers (default 0.95).
    ///
    /// # Errors
    /// [`Error::Invalid`] unless 0 < `confidence` < 1.
    pub fn confidence(self, confidence: f64) -> Result<Self, Error> {
        if !(confidence > 0.0 && confidence < 1.0) {
            return Err(Error::invalid("target confidence", confidence, "must lie strictly between 0 and 1"));
        }
        Ok(Target { confidence, ..self })
    }

    /// Scores before the first look (default 1024): the sequence is asymptotic, skewed scores need more.
    #[must_use]
    pub fn minimum_samples(self, minimum: u64) -> Self {
        Target { minimum: minimum.max(2), ..self }
    }

    /// Half-width at which `estimate` would have to be to stop: also the valid interval at any look.
    pub fn half_width<V: Value>(&self, estimate: &Estimate<V>) -> Option<f64> {
        let se = estimate.std_error?.magnitude();
        // with R replicates the independent scores are the replicates' means
        let t = estimate.degrees_of_freedom as f64 + 1.0;
        let sigma = se * t.sqrt();
        let alpha = 1.0 - self.confidence;
        // ρ must not depend on the data: fixed, tightest at 16 × the minimum
        let best = (16 * self.minimum) as f64;
        // tightest at `best` (Waudby-Smith et al., Appendix B.2)
        let rho2 = (-2.0 * alpha.ln() + (-2.0 * alpha.ln() + 1.0).ln()) / best;
        let a = t * rho2 + 1.0;
        Some(sigma * (2.0 * a / (t * t * rho2) * (a.sqrt() / alpha).ln()).sqrt())
    }

    /// Where this run stands.
    pub fn progress<V: Value>(&self, estimate: &Estimate<V>) -> Progress {
        let wanted = self.absolute + self.relative * estimate.value.magnitude();
        let half_width = self.half_width(estimate).unwrap_or(f64::INFINITY);
        // scores that never varied say nothing yet: zero width after a few walks is not certainty
        let known = estimate.samples() >= self.minimum && estimate.moments.nonzero > 0;
        let met = known && half_width <= wanted;
        let ratio = wanted / half_width;
        let fraction = if met {
            1.0
        } else if ratio.is_finite() {
            (ratio * ratio).min(1.0)
        } else {
            0.0
        };
        Progress { met, half_width, wanted, fraction }
    }
}

fn check(parameter: &'static str, error: f64) -> Result<(), Error> {
    if error.is_finite() && error > 0.0 {
        return Ok(());
    }
    Err(Error::invalid(parameter, error, "must be positive and finite"))
}
