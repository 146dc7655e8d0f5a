//! A value with an honest error.

use super::tail::Suspicion;
use super::{Moments, Tail, student_quantile};
use crate::error::Short;
use crate::value::Value;
use std::fmt;
use std::time::Duration;

/// The bias of walks cut at a fixed depth.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Truncation {
    /// Depth D at which walks are cut: terms T⁰g … T^D g are estimated.
    pub depth: u64,
    /// Walks that were cut while their weight was not zero.
    pub walks: u64,
    /// Bound on |T^{D+1} f| over the domain (theory (4.2.3)); `None` if the kernel cannot be evaluated on a domain, or its series diverges.
    pub bias_bound: Option<f64>,
}

impl fmt::Display for Truncation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.bias_bound {
            Some(b) => write!(f, "cut at depth {} (|bias| ≤ {b:.1e})", self.depth),
            None => write!(f, "cut at depth {} (bias unknown)", self.depth),
        }
    }
}

/// What the diagnostics say, in order of severity.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Verdict {
    /// The interval can be trusted.
    Trustworthy,
    /// The interval may be too short: skewed scores, an unreliable variance, or too few samples.
    Doubtful,
    /// No standard error is known: one sample, one replicate, or walks none of which met anything of the kernel.
    Unmeasured,
    /// No score was different from zero: the value is unknown, not zero (rule of three: with 95 % confidence fewer than 3/N walks score).
    NothingScored,
    /// The scores look as if their variance were infinite; the interval means nothing.
    InfiniteVariance,
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Verdict::Trustworthy => "trustworthy",
            Verdict::Doubtful => "doubtful: the error itself is uncertain; take more samples",
            Verdict::Unmeasured => "no standard error: one sample or one replicate tells none, nor do walks that met nothing of the kernel",
            Verdict::NothingScored => "nothing scored: the value is unknown, not zero",
            Verdict::InfiniteVariance => "infinite variance suspected: do not use the error; change the proposal",
        })
    }
}

/// The result of a Monte Carlo method for one detector cell.
///
/// `Display` prints the value with its standard error in units of the last digits, `1.14984(48)`; `{:#}` adds what is known about it.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Estimate<V = f64> {
    /// The estimate of f(x), or of the detector's functional.
    pub value: V,
    /// Standard error per component; `None` if it cannot be known: one sample, one replicate, or scores that are all g at the start, where what the
    /// kernel adds is not known to be nothing.
    pub std_error: Option<V>,
    /// Degrees of freedom of `std_error`.
    pub degrees_of_freedom: u64,
    /// Moments of the scores of single walks.
    pub moments: Moments<V>,
    /// The largest scores, where they were kept.
    pub tail: Option<Tail>,
    /// Steps of all walks; 0 for a plain integral.
    pub steps: u64,
    /// Evaluations of the kernel (a step counts as one), or of the integrand.
    pub evaluations: u64,
    /// Set if walks were cut at a fixed depth: the estimate is biased.
    pub truncation: Option<Truncation>,
    /// Wall time of the whole run that produced this cell. Never influences a number.
    pub elapsed: Duration,
}

/// Fewer scores show no tail ([`Tail::index`] needs 25 of the largest 5 %): what is not seen cannot be trusted.
const JUDGED: u64 = 500;

/// Randomisations whose means Student's interval can be based on: of two, means of scores with jumps differ by little or nothing too often.
const REPLICATES: u64 = 4;
/// Scores of a smaller kurtosis have no tail that the variance could come from: 3 for normal ones, 9 for exponential ones, ∝ N where it is infinite.
const LIGHT: f64 = 5.0;

impl<V: Value> Estimate<V> {
    /// The estimate of component `i` alone, such as one energy group. Its tail is not known: tails are kept for the largest component.
    ///
    /// ```
    /// use fredholm::{Equation, Spectrum, Walk};
    /// let eq = Equation::on_interval(0.0..=1.0, |_| Spectrum([1.0, 2.0]), |x, y| Spectrum([0.5 * x * y; 2]));
    /// let f = eq.at(0.5).solve(&Walk::collision())?;
    /// assert!(f.component(1).agrees_with(2.3, 5.0));
    /// # Ok::<(), fredholm::Error>(())
    /// ```
    #[must_use]
    pub fn component(&self, i: usize) -> Estimate<f64> {
        Estimate {
            value: self.value.component(i),
            std_error: self.std_error.map(|s| s.component(i)),
            degrees_of_freedom: self.degrees_of_freedom,
            moments: self.moments.component(i),
            tail: None,
            steps: self.steps,
            evaluations: self.evaluations,
            truncation: self.truncation,
            elapsed: self.elapsed,
        }
    }

    /// Number of walks.
    pub fn samples(&self) -> u64 {
        self.moments.count
    }

    /// What fewer than this share of the walks meet is missed with a probability of more than 5 %, and no error tells of it: the rule of three, 3/N.
    ///
    /// ```
    /// use fredholm::{Equation, Walk};
    /// // a peak of mass 1 that no walk has met: f = 3, not 2
    /// let g = |x: f64| 1.0 + (-((x - 0.3) / 1e-8).powi(2)).exp() / (1e-8 * std::f64::consts::PI.sqrt());
    /// let eq = Equation::on_interval(0.0..=1.0, g, |_, _| 0.5);
    /// let f = eq.at(0.5).solve(&Walk::collision())?;
    /// assert!(f.agrees_with(2.0, 5.0) && f.resolution() > 1e-8);
    /// assert!(format!("{f:#}").ends_with("trustworthy but for what fewer than 2e-4 of the walks meet"));
    /// # Ok::<(), fredholm::Error>(())
    /// ```
    pub fn resolution(&self) -> f64 {
        (3.0 / self.samples() as f64).min(1.0)
    }

    /// Sample variance of one walk's score.
    pub fn variance(&self) -> Option<V> {
        self.moments.variance()
    }

    /// Student interval `value ± half_width` that covers the truth with probability `confidence` ∈ (0, 1), per component.
    ///
    /// `None` without a standard error, where nothing scored, or with `confidence` outside (0, 1).
    pub fn half_width(&self, confidence: f64) -> Option<V> {
        if !(confidence > 0.0 && confidence < 1.0) || self.degrees_of_freedom == 0 || self.moments.nonzero == 0 {
            return None;
        }
        let t = student_quantile(self.degrees_of_freedom, 0.5 + confidence / 2.0)?;
        self.std_error.map(|s| s.scale(t))
    }

    /// Component-wise ends of the Student interval.
    pub fn interval(&self, confidence: f64) -> Option<(V, V)> {
        self.half_width(confidence).map(|h| (self.value - h, self.value + h))
    }

    /// Efficiency 1/(V·W), V = squared standard error, W = all kernel evaluations (theory (4.3.7)): machine-independent, and the same for any number
    /// of independent walks. Largest variance of the components.
    pub fn efficiency(&self) -> Option<f64> {
        self.std_error.map(|s| 1.0 / (s.magnitude().powi(2) * self.evaluations.max(1) as f64))
    }

    /// Efficiency 1/(V·T), V = squared standard error, T = wall seconds (theory (4.3.7)).
    pub fn efficiency_per_second(&self) -> Option<f64> {
        self.std_error.map(|s| 1.0 / (s.magnitude().powi(2) * self.elapsed.as_secs_f64()))
    }

    /// Whether every component is within `sigmas` standard errors of `reference`, up to rounding and the truncation bound, if one is known.
    pub fn agrees_with(&self, reference: V, sigmas: f64) -> bool {
        let Some(se) = self.std_error else { return false };
        // an unknown bias excuses nothing: with an infinite allowance everything would agree
        let bias = self.truncation.and_then(|t| t.bias_bound).unwrap_or(0.0);
        (0..V::COMPONENTS).all(|i| {
            let (v, r) = (self.value.component(i), reference.component(i));
            (v - r).abs() <= sigmas * se.component(i) + bias + 16.0 * f64::EPSILON * v.abs().max(r.abs())
        })
    }

    /// (value − reference)/standard error of component `i`; `None` where the standard error is unknown or zero.
    pub fn z_score_of(&self, reference: V, i: usize) -> Option<f64> {
        let se = self.std_error?.component(i);
        (se > 0.0).then(|| (self.value.component(i) - reference.component(i)) / se)
    }

    /// The z-score of largest absolute value among the components.
    pub fn z_score(&self, reference: V) -> Option<f64> {
        (0..V::COMPONENTS).filter_map(|i| self.z_score_of(reference, i)).max_by(|a, b| a.abs().total_cmp(&b.abs()))
    }

    /// No error where walks that made steps all scored one number, and `is_source` says that it is what g scores at the start: nothing of K has been met.
    pub(crate) fn unless(self, is_source: impl FnOnce(V) -> bool) -> Self {
        let constant = self.steps > 0 && self.std_error.is_some() && self.moments.m2.magnitude() == 0.0;
        if constant && is_source(self.value) { Estimate { std_error: None, ..self } } else { self }
    }

    /// Whether powers of the scores are lost below the range of floating point: the fourth where they vary, the square of a rounding error where they do not.
    fn vanishes(&self) -> bool {
        let m = &self.moments;
        (0..V::COMPONENTS).any(|i| {
            let (mean, m2, m4) = (m.mean.component(i).abs(), m.m2.component(i), m.m4.component(i));
            let least = (f64::EPSILON * mean).powi(2);
            (m2 > 0.0 && m4 < f64::MIN_POSITIVE) || (m2 < f64::MIN_POSITIVE && mean > 0.0 && least < f64::MIN_POSITIVE)
        })
    }

    /// What skewness, variance of the variance and tail index say (theory (4.16.1), (4.16.2), §5.2).
    pub fn verdict(&self) -> Verdict {
        if self.moments.nonzero == 0 && self.samples() > 0 {
            // scores that are all exactly zero may be right (g = 0): the caller knows, we do not
            return Verdict::NothingScored;
        }
        if self.std_error.is_none() {
            return Verdict::Unmeasured;
        }
        let n = self.samples() as f64;
        let m = &self.moments;
        if ![m.mean, m.m2, m.m3, m.m4].iter().all(V::all_finite) || self.vanishes() {
            return Verdict::Doubtful; // powers of the scores overflow or underflow: nothing is known about their spread
        }
        // lumps of light scores look like anything to a tail that is fitted to them
        match self.tail.as_ref().filter(|_| m.kurtosis().magnitude() > LIGHT).map(Tail::suspicion) {
            Some(Suspicion::Infinite) => return Verdict::InfiniteVariance,
            // the variance of the variance needs α > 4; it is trusted only where the tail does not speak against it
            Some(Suspicion::Possible) => return Verdict::Doubtful,
            Some(Suspicion::None) | None => {}
        }
        if self.degrees_of_freedom < REPLICATES - 1 {
            return Verdict::Doubtful; // the means of so few randomisations need not be normal
        }
        let skew = self.moments.skewness().magnitude() / n.sqrt();
        if self.samples() < JUDGED || self.moments.variance_of_variance().magnitude() > 0.1 || skew > 0.3 {
            return Verdict::Doubtful;
        }
        Verdict::Trustworthy
    }
}

/// `value(error)` with two digits of the error, one component.
fn parenthesised(value: f64, error: f64) -> String {
    if !(error > 0.0) || !error.is_finite() || !value.is_finite() {
        return format!("{}({})", Short(value), Short(error));
    }
    let mut exponent = error.log10().floor() as i32 - 1;
    // 0.0996 rounds to 0.10, which has its first digit one place further left
    if (error / 10f64.powi(exponent)).round() >= 100.0 {
        exponent += 1;
    }
    if (-12..=0).contains(&exponent) {
        let digits = exponent.unsigned_abs() as usize;
        return format!("{value:.digits$}({:.0})", error / 10f64.powi(exponent));
    }
    // far from 1: factor out a power of ten
    let power = if value == 0.0 { error } else { value.abs().max(error) }.log10().floor() as i32;
    let scale = 10f64.powi(power);
    let digits = (power - exponent).max(0) as usize;
    format!("{:.digits$}({:.0})e{power}", value / scale, error / 10f64.powi(exponent))
}

impl<V: Value> fmt::Display for Estimate<V> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let one = |i: usize| match self.std_error {
            // an error of 0 of scores that are all 0 is none: the value is unknown
            Some(se) if self.value.component(i) == 0.0 && se.component(i) == 0.0 => "0(?)".into(),
            // an error below the rounding of the value has no digit that could be printed
            Some(se) if se.component(i) <= 0.25 * f64::EPSILON * self.value.component(i).abs() => {
                format!("{}(0)", Short(self.value.component(i)))
            }
            Some(se) => parenthesised(self.value.component(i), se.component(i)),
            None => format!("{}(?)", Short(self.value.component(i))),
        };
        let text = if V::COMPONENTS == 1 { one(0) } else { format!("[{}]", (0..V::COMPONENTS).map(one).collect::<Vec<_>>().join(", ")) };
        if !f.alternate() {
            return f.pad(&text);
        }
        match self.steps {
            0 => write!(f, "{text}, {} samples", self.samples())?,
            steps => write!(f, "{text}, {} walks, {steps} steps", self.samples())?,
        }
        if let Some(t) = self.truncation {
            write!(f, ", {t}")?;
        }
        let verdict = self.verdict();
        write!(f, ", {verdict}")?;
        if verdict == Verdict::Trustworthy {
            let units = if self.steps == 0 { "samples" } else { "walks" };
            write!(f, " but for what fewer than {:.0e} of the {units} meet", self.resolution())?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::parenthesised;

    #[test]
    fn two_digits_of_the_error() {
        assert_eq!(parenthesised(1.149_84, 0.000_48), "1.14984(48)");
        assert_eq!(parenthesised(0.2871, 0.000_996), "0.2871(10)");
        assert_eq!(parenthesised(123.4, 7.5), "123.4(75)");
        assert_eq!(parenthesised(12345.0, 1234.0), "1.23(12)e4");
        assert_eq!(parenthesised(1.5e-20, 2.5e-22), "1.500(25)e-20");
        assert_eq!(parenthesised(-3.0, 0.25), "-3.00(25)");
        assert_eq!(parenthesised(1e300, f64::INFINITY), "1e300(inf)");
    }
}
