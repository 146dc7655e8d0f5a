//! The largest scores and what they say about the variance.
//!
//! Hill, *A simple general approach to inference about the tail of a distribution*, Ann. Statist. 3 (1975) 1163; theory (4.16.2), §5.2. Hill's estimate is
//! blind where a constant is added to the scores, as g(x) is at a point: what exceeds a threshold is fitted as well, by Zhang, Stephens, *A new and
//! efficient estimation method for the generalized Pareto distribution*, Technometrics 51 (2009) 316.

use crate::value::Value;

/// Largest scores kept.
const KEPT: usize = 256;
/// Excesses that tell ξ of exponential tails to ± 0.125.
const FITTED: usize = 64;

/// The largest |y| of all scores, exact and independent of how the work was split.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Tail {
    /// Descending.
    largest: Vec<f64>,
    /// Scores different from zero.
    count: u64,
}

/// What a tail says about the variance.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Suspicion {
    None,
    /// Infinite within two standard errors.
    Possible,
    /// Infinite by two standard errors.
    Infinite,
}

impl Tail {
    /// The tail of one block of scores, `count` of them not zero, unordered, given that scores up to `threshold` cannot belong to the largest of all.
    pub(crate) fn of_block<V: Value>(scores: &[V], count: u64, threshold: f64) -> Self {
        // most blocks of a long run hold no candidate: one vectorised pass finds out
        if !scores.iter().fold(false, |any, y| any | (y.magnitude() > threshold)) {
            return Tail { largest: Vec::new(), count };
        }
        let mut largest: Vec<f64> = scores.iter().map(Value::magnitude).filter(|m| *m > threshold).collect();
        if largest.len() > KEPT {
            largest.select_nth_unstable_by(KEPT - 1, |a, b| b.total_cmp(a));
            largest.truncate(KEPT);
        }
        Tail { largest, count }
    }

    /// Joins the tails of many blocks.
    pub(crate) fn merge<'a>(&mut self, blocks: impl IntoIterator<Item = &'a Tail>) {
        for block in blocks {
            self.count += block.count;
            self.largest.extend_from_slice(&block.largest);
        }
        self.keep_the_largest();
    }

    /// A function of its own: sorting is compiled once, not for every iterator of blocks.
    fn keep_the_largest(&mut self) {
        self.largest.sort_unstable_by(|a, b| b.total_cmp(a));
        self.largest.truncate(KEPT);
    }

    /// Scores at or below this cannot enter.
    pub(crate) fn threshold(&self) -> f64 {
        if self.largest.len() < KEPT { 0.0 } else { self.largest[KEPT - 1] }
    }

    /// The largest |y|, descending; at most 256.
    pub fn largest(&self) -> &[f64] {
        &self.largest
    }

    /// Hill's estimate of the tail index α (the variance is finite iff α > 2) and its standard error α/√k.
    ///
    /// From the k = min(256, 2√M, M/20) largest of the M scores different from zero: zeros are no tail. `None` if k < 25, or if half of
    /// these scores are equal to a neighbour: counts and scores piled up at a bound have no tail that the estimate could see.
    pub fn index(&self) -> Option<(f64, f64)> {
        self.judged().and_then(|k| self.hill(k))
    }

    /// From the k largest.
    fn hill(&self, k: usize) -> Option<(f64, f64)> {
        let reference = self.largest[k].ln();
        let mean = self.largest[..k].iter().map(|y| y.ln() - reference).sum::<f64>() / k as f64;
        (mean > 0.0).then(|| (1.0 / mean, 1.0 / mean / (k as f64).sqrt()))
    }

    /// The shape ξ of the generalised Pareto distribution of what exceeds the same threshold, 1 − F(z) = (1 + ξz/σ)^{−1/ξ}, and its standard error
    /// (1 + ξ)/√k: the variance is finite iff ξ = 1/α < ½; 0 for exponential tails, below it for bounded scores.
    ///
    /// Unlike [`index`](Tail::index) it does not change when a constant is added to all scores; `None` where that is `None`.
    ///
    /// ```
    /// use fredholm::{Equation, Walk};
    /// // scores g(½) + ∫ g by one point: tail index 1.5
    /// let eq = Equation::on_interval(0.0..=1.0, |x: f64| x.powf(-1.0 / 1.5), |_, _| 0.5);
    /// let f = eq.at(0.5).solve(&Walk::collision().samples_per_cell(1 << 16))?;
    /// let (shape, error) = f.tail.as_ref().and_then(|t| t.shape()).unwrap();
    /// assert!((shape - 1.0 / 1.5).abs() < 3.0 * error);
    /// # Ok::<(), fredholm::Error>(())
    /// ```
    pub fn shape(&self) -> Option<(f64, f64)> {
        let k = self.judged()?;
        let excess: Vec<f64> = self.largest[..k].iter().rev().map(|y| y - self.largest[k]).collect();
        let shape = pareto_shape(&excess)?;
        Some((shape, (1.0 + shape) / (k as f64).sqrt()))
    }

    /// By the index and by the shape: whichever suspects more.
    pub(super) fn suspicion(&self) -> Suspicion {
        let (index, shape) = (self.index(), self.shape());
        if index.is_some_and(|(a, e)| a + 2.0 * e < 2.0) || shape.is_some_and(|(xi, e)| xi - 2.0 * e > 0.5) {
            return Suspicion::Infinite;
        }
        // weights rⁿ of walks of n steps are tied, and may yet have no variance: no index to be stated, but one to be doubted
        let lumps = if index.is_none() { self.large().and_then(|k| self.hill(k)) } else { None };
        // of many scores a finite variance is asked to be plain, by two standard errors; of few, α and ξ are too uncertain to be held against the scores
        let (of_index, of_shape) = if self.judged() >= Some(FITTED) { (2.0, 2.0) } else { (1.0, 0.0) };
        if index.or(lumps).is_some_and(|(a, e)| a - of_index * e < 2.0) || shape.is_some_and(|(xi, e)| xi + of_shape * e > 0.5) {
            return Suspicion::Possible;
        }
        Suspicion::None
    }

    /// How many of the largest scores are tail; `None` if too few, or tied.
    fn judged(&self) -> Option<usize> {
        let k = self.large()?;
        let ties = self.largest[..=k].windows(2).filter(|pair| pair[0] == pair[1]).count();
        (2 * ties < k).then_some(k)
    }

    /// How many of the largest scores are tail, tied or not.
    fn large(&self) -> Option<usize> {
        let wanted = (2.0 * (self.count as f64).sqrt()).min(self.count as f64 / 20.0) as usize;
        let k = wanted.min(self.largest.len().saturating_sub(1));
        (k >= 25).then_some(k)
    }
}

/// Zhang, Stephens (2009): the mean of θ = −ξ/σ under its profile likelihood on a grid, ξ(θ) = mean ln(1 − θz). `excess` ascends.
fn pareto_shape(excess: &[f64]) -> Option<f64> {
    let n = excess.len() as f64;
    let (quarter, largest) = (excess[(n / 4.0 + 0.5) as usize - 1], excess[excess.len() - 1]);
    if !(quarter > 0.0 && largest.is_finite()) {
        return None;
    }
    let shape = |theta: f64| excess.iter().map(|z| (-theta * z).ln_1p()).sum::<f64>() / n;
    let points = 30.0 + n.sqrt().floor();
    let grid = (1..=points as u32).map(|j| 1.0 / largest + (1.0 - (points / (f64::from(j) - 0.5)).sqrt()) / (3.0 * quarter));
    let profile: Vec<(f64, f64)> = grid
        .map(|theta| {
            let xi = shape(theta);
            (theta, n * ((-theta / xi).ln() - xi - 1.0))
        })
        .filter(|(_, likelihood)| likelihood.is_finite())
        .collect();
    let best = profile.iter().map(|p| p.1).reduce(f64::max)?;
    let weight = |likelihood: f64| (likelihood - best).exp();
    let sum: f64 = profile.iter().map(|p| weight(p.1)).sum();
    let xi = shape(profile.iter().map(|p| p.0 * weight(p.1)).sum::<f64>() / sum);
    xi.is_finite().then_some(xi)
}
