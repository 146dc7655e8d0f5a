//! Randomised truncation: an unbiased estimator from a convergent sequence of biased ones.
//!
//! ```text
//! sum          Y = Σ_{n ≤ N} Δ_n / Pr(N ≥ n)          finite variance iff Σ E(Y_n − Y_∞)² / Pr(N ≥ n) < ∞                  theory (4.12.1)
//! single term  Y = Δ_N / Pr(N = N)                    finite variance iff Σ E Δ_n² / Pr(N = n) < ∞
//! ```
//!
//! Derivation: E Y = Σ_n E Δ_n, since N is independent of the differences Δ_n = Y_n − Y_{n−1}. The expected cost is Σ t_n Pr(N ≥ n) (sum), or Σ t_n Pr(N = n).
//! Both series must converge: a pilot measures how E Δ_n² falls, and what does not converge is refused ([`Error::NotSummable`]) with its slope. The rest
//! ‖Y_∞ − Y_n‖ ≤ Σ_{k > n} ‖Δ_k‖ falls as fast as Δ_n if that is geometric; if it is a power, slower by at most one order (Minkowski), which is assumed. Best
//! is Pr(N ≥ n) ∝ √(E Δ_n²/t_n). Wins where only the limit is unbiased: depth, quadrature level, ratios and other functions of means. The sum over walks of
//! fixed depth is the collision estimator with roulette. Reference: Rhee, Glynn, *Unbiased estimation with square root convergence for SDE models*, Oper.
//! Res. 63 (2015) 1026, Theorem 1; Misso, Bitterli, Georgiev, Jarosz, *Unbiased and consistent rendering using biased estimators*, ACM Trans. Graph. 41 (2022) 48.

use super::levels::Levels;
use super::run::{Block, check_budget, estimate};
use crate::contained::contained;
use crate::error::Error;
use crate::parallel;
use crate::sampling::{Pcg, Sampler, Sequence};
use crate::statistics::{Estimate, Rate};
use crate::value::Value;

/// Which estimator is made of the differences.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Form {
    /// Σ_{n ≤ N} Δ_n/Pr(N ≥ n), all on one point.
    #[default]
    Sum,
    /// Δ_N/Pr(N = N).
    SingleTerm,
}

/// The law of the last level N.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Survivors {
    /// Pr(N ≥ n) = rⁿ.
    Geometric(f64),
    /// Pr(N ≥ n) = (n + 1)^{−α}: for differences that fall like a power.
    Power(f64),
    /// Geometric, with the ratio √(variance ratio/cost ratio) that the pilot finds.
    Fitted,
}

impl Survivors {
    /// Pr(N ≥ n).
    fn at_least(&self, n: u64) -> f64 {
        match self {
            Survivors::Geometric(r) => r.powf(n as f64),
            Survivors::Power(alpha) => (n as f64 + 1.0).powf(-alpha),
            Survivors::Fitted => f64::NAN,
        }
    }

    /// Pr(N ≥ n), or Pr(N = n).
    fn probability(&self, form: Form, n: u64) -> f64 {
        match (form, self) {
            (Form::Sum, _) => self.at_least(n),
            (Form::SingleTerm, Survivors::Geometric(r)) => (1.0 - r) * self.at_least(n),
            // (n+1)^{−α} − (n+2)^{−α} without its cancellation
            (Form::SingleTerm, Survivors::Power(alpha)) => -self.at_least(n) * (-alpha * (1.0 / (n as f64 + 1.0)).ln_1p()).exp_m1(),
            (Form::SingleTerm, Survivors::Fitted) => f64::NAN,
        }
    }

    /// The largest n with Pr(N ≥ n) > v: N by inversion.
    fn draw(&self, v: f64) -> u64 {
        let last = match self {
            Survivors::Geometric(r) => v.ln() / r.ln(),
            Survivors::Power(alpha) => v.powf(-1.0 / alpha) - 1.0,
            Survivors::Fitted => f64::NAN,
        };
        // ⌈·⌉ − 1: the inequality is strict; casts saturate
        (last.ceil() - 1.0).max(0.0) as u64
    }

    /// Along what the terms of the series are lines: (name, abscissa, slope where convergence begins).
    fn abscissa(&self, n: u64) -> f64 {
        if let Survivors::Power(_) = self { (n as f64 + 1.0).ln() } else { n as f64 }
    }

    fn limit(&self) -> (&'static str, f64) {
        if let Survivors::Power(_) = self { ("ln(n + 1)", -1.0) } else { ("n", 0.0) }
    }

    fn validate(&self) -> Result<(), Error> {
        match self {
            Survivors::Geometric(r) if !(*r > 0.0 && *r < 1.0) => Err(Error::invalid("ratio of survivors", *r, "must lie in (0, 1)")),
            Survivors::Power(a) if !(*a > 0.0 && a.is_finite()) => {
                Err(Error::invalid("exponent of survivors", *a, "must be positive and finite"))
            }
            _ => Ok(()),
        }
    }
}

/// What the pilot saw of one level.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Level {
    /// E Δ_n², largest component.
    pub square: f64,
    /// Cost of Δ_n: alone, or on top of those before it.
    pub cost: f64,
    /// Pr(N ≥ n), or Pr(N = n).
    pub probability: f64,
}

/// An unbiased estimate and the pilot's evidence that its variance and its cost are finite.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Debiased<V = f64> {
    /// The estimate; its `evaluations` are units of cost.
    pub estimate: Estimate<V>,
    /// The law of N; what was fitted, if it was.
    pub survivors: Survivors,
    /// The pilot's levels 0, 1, ….
    pub levels: Vec<Level>,
    /// Slope of the logarithm of the variance's terms: below 0 in n for geometric survivors, below −1 in ln(n + 1) for a power. `None` if fewer than three
    /// levels differ.
    pub variance_slope: Option<f64>,
    /// The same for the cost.
    pub cost_slope: Option<f64>,
}

/// Debiases a sequence of [`Levels`].
///
/// ```
/// use fredholm::{Equation, estimator::{Debias, Survivors}};
/// let eq = Equation::on_interval(0.0..=1.0, |_| 1.0, |x, y| 0.5 * x * y);
/// let query = eq.at(0.5);
/// let f = Debias::new(query.depths()?).survivors(Survivors::Geometric(0.5)).solve()?;
/// assert!(f.estimate.agrees_with(1.15, 5.0));
/// assert!(f.variance_slope.unwrap() < 0.0);
/// # Ok::<(), fredholm::Error>(())
/// ```
///
/// A function of a mean, (E X)² from the means of 2ⁿ samples and of both halves of them:
///
/// ```
/// use fredholm::estimator::{Debias, levels_fn};
/// let levels = levels_fn(2.0, |n, u| {
///     let (half, mut sums) = (1u64 << n >> 1, [0.0; 2]);
///     if n == 0 {
///         return u.next_1d().powi(2);
///     }
///     (0..2 * half).for_each(|i| sums[(i % 2) as usize] += u.next_1d() / half as f64);
///     ((sums[0] + sums[1]) / 2.0).powi(2) - (sums[0].powi(2) + sums[1].powi(2)) / 2.0
/// });
/// assert!(Debias::new(levels).solve()?.estimate.agrees_with(0.25, 5.0));
/// # Ok::<(), fredholm::Error>(())
/// ```
#[derive(Clone, Copy, Debug)]
#[must_use]
pub struct Debias<L> {
    levels: L,
    form: Form,
    survivors: Survivors,
    samples: u64,
    pilot: (u64, u64),
    seed: u64,
}

/// Streams of the main run: the last level, the points; and of the pilot.
const LAST: u64 = 0;
const POINTS: u64 = 1;
const PILOT: u64 = 2;

impl<L: Levels> Debias<L> {
    /// The sum, with fitted geometric survivors; 16 384 scores, a pilot of 512 points on 10 levels, seed 0.
    pub fn new(levels: L) -> Self {
        Debias { levels, form: Form::Sum, survivors: Survivors::Fitted, samples: 1 << 14, pilot: (10, 512), seed: 0 }
    }

    /// Sum or single term.
    pub fn form(self, form: Form) -> Self {
        Debias { form, ..self }
    }

    /// The law of the last level.
    pub fn survivors(self, survivors: Survivors) -> Self {
        Debias { survivors, ..self }
    }

    /// Scores.
    pub fn samples(self, samples: u64) -> Self {
        Debias { samples, ..self }
    }

    /// Levels 0, …, `levels` − 1 and points of the pilot.
    pub fn pilot(self, levels: u64, points: u64) -> Self {
        Debias { pilot: (levels, points), ..self }
    }

    /// Sets the seed.
    pub fn seed(self, seed: u64) -> Self {
        Debias { seed, ..self }
    }

    /// Estimates.
    ///
    /// # Errors
    /// [`Error::NotSummable`] where the pilot sees that the variance or the cost is infinite; [`Error::Invalid`] for parameters outside their range;
    /// [`Error::NonFiniteScore`].
    pub fn solve(&self) -> Result<Debiased<L::Value>, Error> {
        contained(|| {
            self.survivors.validate()?;
            check_budget("samples", self.samples, None)?;
            if self.pilot.0 < 4 || self.pilot.1 < 2 {
                return Err(Error::invalid("pilot", self.pilot.0.min(self.pilot.1) as f64, "must be at least 4 levels and 2 points"));
            }
            Error::held("levels × points of the pilot", self.pilot.0.saturating_mul(self.pilot.1))?;
            let mut levels = self.look()?;
            let survivors = if self.survivors == Survivors::Fitted { self.fit(&levels)? } else { self.survivors };
            (0..).zip(&mut levels).for_each(|(n, level)| level.probability = survivors.probability(self.form, n));
            let rest = if let (Form::Sum, Survivors::Power(_)) = (self.form, survivors) { 2.0 } else { 0.0 };
            let variance_slope = slope(&survivors, &levels, |l| l.square / l.probability).map(|slope| slope + rest);
            let cost_slope = slope(&survivors, &levels, |l| l.cost * l.probability);
            for (series, slope) in [("variance", variance_slope), ("cost", cost_slope)] {
                let (variable, limit) = survivors.limit();
                if let Some(slope) = slope.filter(|slope| *slope >= limit) {
                    return Err(Error::NotSummable { series, slope, variable, limit });
                }
            }
            let sequence = Pcg::new(self.seed);
            let estimate = estimate(None, self.samples, &|_, indices| {
                let first = indices.start;
                let mut block = Block { scores: Vec::with_capacity((indices.end - first) as usize), steps: 0, evaluations: 0 };
                for i in indices {
                    let last = survivors.draw(sequence.point(LAST, 0, i).next_1d());
                    let levels = if self.form == Form::Sum { 0..=last } else { last..=last };
                    let (mut score, cost) = (L::Value::ZERO, self.levels.cost(levels.clone()));
                    let weigh = &mut |n, d: L::Value| score += d.scale(1.0 / survivors.probability(self.form, n));
                    self.levels.differences(levels, sequence.point(POINTS, 0, i), weigh);
                    if !score.scale(self.samples as f64).all_finite() {
                        return Err(Error::NonFiniteScore { sample: i, replicate: 0, score: format!("{score:?}") });
                    }
                    block.scores.push(score);
                    block.evaluations += cost.round() as u64;
                }
                Ok(block)
            })?;
            Ok(Debiased { estimate, survivors, levels, variance_slope, cost_slope })
        })
    }

    /// The pilot.
    fn look(&self) -> Result<Vec<Level>, Error> {
        let (count, points) = self.pilot;
        let one = |i: usize| {
            let mut d = vec![L::Value::ZERO; count as usize];
            self.levels.differences(0..=count - 1, Pcg::new(self.seed).point(PILOT, 0, i as u64), &mut |n, v| d[n as usize] = v);
            d
        };
        let mut square = vec![L::Value::ZERO; count as usize];
        for (i, d) in (0..).zip(parallel::map(points as usize, one)) {
            square.iter_mut().zip(&d).for_each(|(sum, d)| *sum += d.map(|d| d * d / points as f64));
            if !d.iter().all(Value::all_finite) {
                return Err(Error::NonFiniteScore { sample: i, replicate: 0, score: format!("{d:?}") });
            }
        }
        let cost = |n: u64| match self.form {
            Form::SingleTerm => self.levels.cost(n..=n),
            Form::Sum if n == 0 => self.levels.cost(0..=0),
            Form::Sum => self.levels.cost(0..=n) - self.levels.cost(0..=n - 1),
        };
        let level = |(n, square): (u64, &L::Value)| Level { square: square.magnitude(), cost: cost(n), probability: f64::NAN };
        Ok((0..).zip(&square).map(level).collect())
    }

    /// √(variance ratio/cost ratio) as the ratio of geometric survivors; both series then fall by √(variance ratio · cost ratio).
    fn fit(&self, levels: &[Level]) -> Result<Survivors, Error> {
        let along = Survivors::Geometric(0.5);
        let (variance, cost) = (slope(&along, levels, |l| l.square), slope(&along, levels, |l| l.cost).unwrap_or(0.0));
        // differences that vanish after the first ones: any ratio serves
        let Some(variance) = variance else { return Ok(Survivors::Geometric(0.5)) };
        let (variable, limit) = along.limit();
        if variance + cost >= limit || variance >= cost {
            return Err(Error::NotSummable { series: "variance", slope: variance + cost.max(0.0), variable, limit });
        }
        Ok(Survivors::Geometric((0.5 * (variance - cost)).exp()))
    }
}

/// Slope of the logarithm of the terms, the first quarter of the levels left out, which may not have settled.
/// `None` if fewer than three terms are positive.
fn slope(survivors: &Survivors, levels: &[Level], term: impl Fn(&Level) -> f64) -> Option<f64> {
    let points = (0..).zip(levels).skip(levels.len() / 4).map(|(n, l)| (survivors.abscissa(n).exp(), term(l)));
    let points: Vec<_> = points.filter(|p| p.1 > 0.0 && p.1.is_finite()).collect();
    Rate::fit(points).ok().map(|rate| rate.slope)
}
