//! Error against cost.

use fredholm::statistics::Rate;

/// How the points of a curve came about, and how far it may be continued.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Family {
    /// Root mean square error over seeds, falls as N^(−1/2).
    MonteCarlo,
    /// The same for points that are not independent: falls at least so fast.
    Quasi,
    /// The same for walks that are cut: falls to a floor, not continued.
    Biased,
    /// True error of every setting.
    Deterministic,
    /// Times and errors of another program.
    Peer,
}

/// One setting of a method.
#[derive(Clone, Debug)]
pub(crate) struct Point {
    /// Walks, unknowns, or the tolerance asked for.
    pub setting: String,
    /// Set-up included.
    pub seconds: f64,
    pub evaluations: f64,
    /// True error relative to max |f|.
    pub error: f64,
    /// What the method itself says of it, in the same unit; NaN where it says nothing.
    pub reported: f64,
}

/// A method on a problem.
#[derive(Clone, Debug)]
pub(crate) struct Curve {
    pub method: String,
    pub family: Family,
    /// Seconds before the first walk: tables, spectral radius. Part of every point.
    pub set_up: f64,
    pub points: Vec<Point>,
    /// Why there are no (more) points.
    pub refusal: Option<String>,
}

/// The cost of an accuracy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Reach {
    /// The cheapest setting that was that accurate.
    Measured(f64),
    /// Continued from the largest size with the slope −1/2.
    Continued(f64),
}

impl Reach {
    pub(crate) fn cost(self) -> f64 {
        match self {
            Reach::Measured(c) | Reach::Continued(c) => c,
        }
    }
}

impl Curve {
    pub(crate) fn new(method: &str, family: Family) -> Self {
        Curve { method: method.into(), family, set_up: 0.0, points: Vec::new(), refusal: None }
    }

    pub(crate) fn refused(method: &str, family: Family, why: &dyn std::fmt::Display) -> Self {
        Curve { refusal: Some(why.to_string()), ..Curve::new(method, family) }
    }

    /// Seconds to an error of at most `error`; `None` where the method does not get there.
    pub(crate) fn seconds_to(&self, error: f64) -> Option<Reach> {
        let reached = self.points.iter().filter(|p| p.error <= error).map(|p| p.seconds).min_by(f64::total_cmp);
        if let Some(seconds) = reached {
            return Some(Reach::Measured(seconds));
        }
        let last = self.points.last().filter(|p| p.error.is_finite())?;
        let random = matches!(self.family, Family::MonteCarlo | Family::Quasi);
        random.then(|| Reach::Continued(self.set_up + (last.seconds - self.set_up).max(0.0) * (last.error / error).powi(2)))
    }

    /// The same by the method's own word alone, which must be true: for who does not know f.
    pub(crate) fn seconds_to_known(&self, error: f64) -> Option<Reach> {
        let known = self.points.iter().filter(|p| p.reported.max(p.error) <= error && !p.reported.is_nan());
        known.map(|p| p.seconds).min_by(f64::total_cmp).map(Reach::Measured)
    }

    /// Slope of ln error against ln evaluations, with its standard error.
    pub(crate) fn slope(&self) -> Option<(f64, f64)> {
        let points = self.points.iter().filter(|p| p.evaluations > 0.0 && p.error > 0.0).map(|p| (p.evaluations, p.error));
        Rate::fit(points).ok().map(|r| (r.slope, r.std_error))
    }
}
