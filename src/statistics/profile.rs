//! f along many points from one set of walks, with what their common randomness does to its errors.

use super::band::{self, Band};
use super::{Estimate, Moments, Truncation, Verdict};
use crate::value::Value;
use std::fmt;

/// What the values of a [`Profile`] estimate, where that is not f(x): an error that no number of walks removes by itself.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Bias {
    /// None: the expectation of a value is f(x).
    None,
    /// Means of f over cells of this width.
    CellMeans {
        /// Width of a cell.
        width: f64,
    },
    /// T f smoothed over this distance to each side; vanishes as its square.
    Smoothing {
        /// Half the width of the smoothing kernel.
        bandwidth: f64,
    },
    /// T f projected on so many basis functions.
    Projection {
        /// Number of coefficients.
        terms: usize,
    },
}

impl fmt::Display for Bias {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Bias::None => f.write_str("unbiased at every point"),
            Bias::CellMeans { width } => write!(f, "means over cells of width {width:.3}"),
            Bias::Smoothing { bandwidth } => write!(f, "biased: smoothed over ± {bandwidth:.3}"),
            Bias::Projection { terms } => write!(f, "biased: projected on {terms} functions"),
        }
    }
}

/// f at many points, estimated from the same walks: values, errors, covariances, and bands that hold for all points at once.
///
/// Values of one profile are correlated, often strongly: the curve is smooth and may lie above or below f as a whole. Intervals at single points, however
/// many, are no statement about the curve; [`band`](Profile::band) is.
///
/// ```
/// use fredholm::{Equation, Forward, walk::KernelTally};
/// let eq = Equation::on_interval(0.0..=1.0, |_| 1.0, |x, y| 0.5 * x * y);                // f = 1 + 3x/10
/// let xs: Vec<f64> = (0..=20).map(|i| f64::from(i) / 20.0).collect();
/// let f = eq.solve(&Forward::new().profile(KernelTally::at(&xs)))?;
/// let band = f.band(0.99).expect("more than one batch of walks");
/// assert!(xs.iter().zip(&band.lower).skip(1).all(|(x, l)| *l < 1.0 + 0.3 * x));
/// assert_eq!(f.values()[0], 1.0);                                                         // K(0, ·) = 0: g alone
/// # Ok::<(), fredholm::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Profile<X, V = f64> {
    points: Vec<X>,
    values: Vec<V>,
    std_errors: Option<Vec<V>>,
    /// deviations of the batches from the values, batch by batch
    deviations: Vec<Vec<V>>,
    verdicts: Vec<Verdict>,
    cells: Vec<Estimate<V>>,
    bias: Bias,
    /// largest error of what was added without walks
    source_error: f64,
}

impl<X: Copy, V: Value> Profile<X, V> {
    /// From the values of independent, equally large batches (at least one).
    pub(crate) fn of_batches(points: Vec<X>, batches: Vec<Vec<V>>, verdicts: Vec<Verdict>, cells: Vec<Estimate<V>>, bias: Bias) -> Self {
        let at = |i: usize| Moments::from_scores(&batches.iter().map(|b| b[i]).collect::<Vec<_>>());
        let moments: Vec<_> = (0..points.len()).map(at).collect();
        let values: Vec<_> = moments.iter().map(|m| m.mean).collect();
        let std_errors = moments.iter().map(Moments::std_error).collect();
        let deviations = batches.iter().map(|b| b.iter().zip(&values).map(|(y, mean)| *y - *mean).collect()).collect();
        Profile { points, values, std_errors, deviations, verdicts, cells, bias, source_error: 0.0 }
    }

    /// Adds a known function, whose values err by at most `error`.
    pub(crate) fn shifted(mut self, known: &[V], error: f64) -> Self {
        self.values.iter_mut().zip(known).for_each(|(v, g)| *v += *g);
        Profile { source_error: error, ..self }
    }

    /// Where.
    pub fn points(&self) -> &[X] {
        &self.points
    }

    /// The estimates of f there.
    pub fn values(&self) -> &[V] {
        &self.values
    }

    /// Standard errors of single values, from the spread of the batches; `None` with one batch. They do not make a band: see [`band`](Profile::band).
    pub fn std_errors(&self) -> Option<&[V]> {
        self.std_errors.as_deref()
    }

    /// Estimated covariance of two values, component by component; `None` with one batch.
    pub fn covariance(&self, i: usize, j: usize) -> Option<V> {
        let batches = self.deviations.len() as f64;
        let product = |d: &Vec<V>| d[i].zip(d[j], |a, b| a * b);
        let sum = self.deviations.iter().map(product).fold(V::ZERO, |sum, p| sum + p);
        (batches > 1.0).then(|| sum.scale(1.0 / (batches * (batches - 1.0))))
    }

    /// Independent batches that the errors come from.
    pub fn batches(&self) -> usize {
        self.deviations.len()
    }

    /// The *simultaneous* band: with probability `confidence` it contains the whole curve (of what is estimated, see [`bias`](Profile::bias)), at all points
    /// and in all components at once. `None` with one batch, or with `confidence` outside (0, 1). Infinitely wide where nothing scored.
    ///
    /// By the sup-t method: value ± c · standard error, c the quantile of the largest |t| over the points, from a multiplier bootstrap of the batches
    /// (Montiel Olea, Plagborg-Møller, *Simultaneous confidence bands*, J. Appl. Econometrics 34 (2019) 1; theory (4.6.7)), with Student's factor for few batches.
    pub fn band(&self, confidence: f64) -> Option<Band<V>> {
        let errors = self.std_errors()?;
        if !(confidence > 0.0 && confidence < 1.0) {
            return None;
        }
        let critical = band::critical(&self.deviations, errors, confidence)?;
        let half = |i: usize| match self.verdicts[i] {
            Verdict::NothingScored => V::from_components(|_| f64::INFINITY),
            _ => errors[i].map(|e| critical * e + self.source_error),
        };
        let half: Vec<V> = (0..self.points.len()).map(half).collect();
        let ends = |sign: f64| self.values.iter().zip(&half).map(|(v, h)| *v + h.scale(sign)).collect();
        Some(Band { confidence, critical, lower: ends(-1.0), upper: ends(1.0) })
    }

    /// What the values estimate, if not f.
    pub fn bias(&self) -> Bias {
        self.bias
    }

    /// Bound on the error of what was added to the walks' share, such as the means of g over cells by quadrature: already in the bands.
    pub fn source_error(&self) -> f64 {
        self.source_error
    }

    /// Set if walks were cut at a fixed depth: a bias besides [`bias`](Profile::bias), and not in the bands.
    pub fn truncation(&self) -> Option<Truncation> {
        self.cells.first().and_then(|cell| cell.truncation)
    }

    /// What the scores behind each value say about its error.
    pub fn verdicts(&self) -> &[Verdict] {
        &self.verdicts
    }

    /// The worst of them.
    pub fn verdict(&self) -> Verdict {
        self.verdicts.iter().copied().max().unwrap_or(Verdict::NothingScored)
    }

    /// The estimates of single walks behind the values: (T f)(x) at points, means of T f over cells, coefficients of T f. Their numbers of evaluations and
    /// times are those of the whole run.
    pub fn cells(&self) -> &[Estimate<V>] {
        &self.cells
    }

    /// Largest standard error of a value divided by the largest value; `None` with one batch.
    pub fn relative_error(&self) -> Option<f64> {
        let largest = |values: &[V]| values.iter().map(Value::magnitude).fold(0.0, f64::max);
        self.std_errors().map(|e| largest(e) / largest(&self.values))
    }
}

impl<X: Copy, V: Value> fmt::Display for Profile<X, V> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} points, {} batches, {}", self.points.len(), self.deviations.len(), self.bias)?;
        if let Some(truncation) = self.truncation() {
            write!(f, ", {truncation}")?;
        }
        match self.relative_error() {
            Some(error) => write!(f, ", standard errors ≤ {:.1e} of the maximum", error)?,
            None => write!(f, ", errors unknown")?,
        }
        write!(f, ", {}", self.verdict())
    }
}
