//! Is an estimator as good as it says? Repeat it with independent seeds and look.
//!
//! ```text
//! β = E[Î] − I,   V = E[(Î − E Î)²],   MSE = E[(Î − I)²] = V + β²          unbiased: β = 0;  consistent: MSE → 0 as n → ∞
//! ```
//!
//! Coverage is counted: how many of the stated intervals contain the truth (theory §5.3, T2 to T4).

use super::{Estimate, Moments, Rate};
use crate::contained::contained;
use crate::error::Error;
use crate::parallel;
use statrs::distribution::{Beta, ContinuousCDF};

/// A number measured by repetition.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// The number.
    pub value: f64,
    /// Its standard error.
    pub std_error: f64,
}

/// How often intervals contained the truth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Coverage {
    /// Intervals that contained it.
    pub hits: u64,
    /// Intervals.
    pub trials: u64,
    /// Runs that stated no interval: neither hit nor miss.
    pub unknown: u64,
}

impl Coverage {
    /// hits/trials; NaN without trials.
    #[must_use]
    pub fn fraction(&self) -> f64 {
        self.hits as f64 / self.trials as f64
    }

    /// The exact interval of Clopper and Pearson (Biometrika 26 (1934) 404) for the probability of a hit; `None` without trials, or with `confidence`
    /// outside (0, 1).
    #[must_use]
    pub fn interval(&self, confidence: f64) -> Option<(f64, f64)> {
        if self.trials == 0 || !(confidence > 0.0 && confidence < 1.0) {
            return None;
        }
        let (k, n, tail) = (self.hits as f64, self.trials as f64, (1.0 - confidence) / 2.0);
        let quantile = |a: f64, b: f64, q: f64| Beta::new(a, b).ok().map(|d| d.inverse_cdf(q));
        let lower = if self.hits == 0 { Some(0.0) } else { quantile(k, n - k + 1.0, tail) };
        let upper = if self.hits == self.trials { Some(1.0) } else { quantile(k + 1.0, n - k, 1.0 - tail) };
        lower.zip(upper)
    }
}

/// Repetitions of one estimator against the truth.
///
/// ```
/// use fredholm::integral::{Integral, Secondary};
/// use fredholm::statistics::Study;
/// let integral = Integral::on_interval(0.0..=1.0, |x| x * x);
/// let study = Study::run(1.0 / 3.0, 400, |seed| integral.solve(&Secondary::plain().samples(256).seed(seed)))?;
/// let bias = study.bias();
/// assert!(bias.value.abs() < 6.0 * bias.std_error);
/// assert!((study.variance().value / (4.0 / 45.0 / 256.0) - 1.0).abs() < 0.5);
/// assert!(study.coverage(0.95).fraction() > 0.85);
/// # Ok::<(), fredholm::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Study {
    truth: f64,
    runs: Vec<Estimate>,
    errors: Moments<f64>,
    squares: Moments<f64>,
}

impl Study {
    /// Runs `solve` with the seeds 0, 1, …, `repetitions` − 1.
    ///
    /// # Errors
    /// Those of `solve`, the first in order of seeds; [`Error::Invalid`] for fewer than two repetitions or a truth that is not finite.
    pub fn run<F>(truth: f64, repetitions: u64, solve: F) -> Result<Self, Error>
    where
        F: Fn(u64) -> Result<Estimate, Error> + Send + Sync,
    {
        contained(|| {
            if repetitions < 2 {
                return Err(Error::invalid("repetitions", repetitions as f64, "must be at least 2: one run has no spread"));
            }
            Error::held("repetitions", repetitions)?;
            if !truth.is_finite() {
                return Err(Error::invalid("truth", truth, "must be finite"));
            }
            let one: &(dyn Fn(usize) -> Result<Estimate, Error> + Sync) = &|seed| solve(seed as u64);
            let runs = parallel::map(repetitions as usize, one).into_iter().collect::<Result<Vec<_>, _>>()?;
            let errors: Vec<f64> = runs.iter().map(|e| e.value - truth).collect();
            let squares: Vec<f64> = errors.iter().map(|e| e * e).collect();
            Ok(Study { truth, runs, errors: Moments::from_scores(&errors), squares: Moments::from_scores(&squares) })
        })
    }

    /// The estimates, in order of seeds.
    #[must_use]
    pub fn runs(&self) -> &[Estimate] {
        &self.runs
    }

    /// β.
    #[must_use]
    pub fn bias(&self) -> Measured {
        Measured { value: self.errors.mean, std_error: self.errors.std_error().unwrap_or(f64::NAN) }
    }

    /// V, unbiased; its error from the fourth moment, Var s² = (μ₄ − σ⁴ (R − 3)/(R − 1))/R.
    #[must_use]
    pub fn variance(&self) -> Measured {
        let r = self.errors.count as f64;
        let value = self.errors.variance().unwrap_or(f64::NAN);
        let fourth = self.errors.m4 / r - value * value * (r - 3.0) / (r - 1.0);
        Measured { value, std_error: (fourth.max(0.0) / r).sqrt() }
    }

    /// MSE = V + β².
    #[must_use]
    pub fn mse(&self) -> Measured {
        Measured { value: self.squares.mean, std_error: self.squares.std_error().unwrap_or(f64::NAN) }
    }

    /// Root mean square of the true error.
    #[must_use]
    pub fn rmse(&self) -> f64 {
        self.squares.mean.sqrt()
    }

    /// Mean of the squared standard errors that the runs state: what they believe V to be. NaN if one states none.
    #[must_use]
    pub fn stated_variance(&self) -> Measured {
        let stated: Vec<f64> = self.runs.iter().map(|e| e.std_error.map_or(f64::NAN, |s| s * s)).collect();
        let m = Moments::from_scores(&stated);
        Measured { value: m.mean, std_error: m.std_error().unwrap_or(f64::NAN) }
    }

    /// How many of the stated Student intervals contain the truth.
    #[must_use]
    pub fn coverage(&self, confidence: f64) -> Coverage {
        let mut out = Coverage { hits: 0, trials: 0, unknown: 0 };
        for run in &self.runs {
            match run.half_width(confidence) {
                Some(half) => {
                    out.trials += 1;
                    // an exact answer is right to rounding, not to the last bit
                    let rounding = 16.0 * f64::EPSILON * self.truth.abs();
                    out.hits += u64::from((run.value - self.truth).abs() <= half + rounding);
                }
                None => out.unknown += 1,
            }
        }
        out
    }
}

/// One study for every number of samples: is the estimator consistent, and how fast?
///
/// ```
/// use fredholm::integral::{Integral, Secondary};
/// use fredholm::statistics::Sweep;
/// let integral = Integral::on_interval(0.0..=1.0, |x| x * x);
/// let sweep = Sweep::run(1.0 / 3.0, &[64, 256, 1024, 4096], 100, |n, seed| integral.solve(&Secondary::plain().samples(n).seed(seed)))?;
/// assert!((sweep.rate()?.slope + 0.5).abs() < 0.1);
/// # Ok::<(), fredholm::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Sweep {
    studies: Vec<(u64, Study)>,
}

impl Sweep {
    /// Runs `solve(n, seed)` for every n of `samples`, `repetitions` times, no seed twice.
    ///
    /// # Errors
    /// Those of [`Study::run`].
    pub fn run<F>(truth: f64, samples: &[u64], repetitions: u64, solve: F) -> Result<Self, Error>
    where
        F: Fn(u64, u64) -> Result<Estimate, Error> + Send + Sync,
    {
        let study = |(i, n): (usize, &u64)| Ok((*n, Study::run(truth, repetitions, |r| solve(*n, i as u64 * repetitions + r))?));
        Ok(Sweep { studies: samples.iter().enumerate().map(study).collect::<Result<_, Error>>()? })
    }

    /// The studies, by number of samples.
    #[must_use]
    pub fn studies(&self) -> &[(u64, Study)] {
        &self.studies
    }

    /// Pairs (samples, root mean square error), as [`plot::Convergence`](crate::plot) draws them.
    pub fn errors(&self) -> impl Iterator<Item = (f64, f64)> {
        self.studies.iter().map(|(n, study)| (*n as f64, study.rmse()))
    }

    /// The rate at which the root mean square error falls with the number of samples.
    ///
    /// # Errors
    /// Those of [`Rate::fit`]: fewer than three numbers of samples, or an error that is exactly zero.
    pub fn rate(&self) -> Result<Rate, Error> {
        Rate::fit(self.errors())
    }
}
