//! Do a kernel, a source, a proposal of your own keep their laws?
//!
//! Each function tests laws of [`kernel`](crate::kernel) and [`source`](crate::source) at several places x and returns a [`Report`] that says in
//! words which law broke, where, and by how much.
//!
//! | function | laws |
//! |---|---|
//! | [`transition`] | E[weight · φ(point)] = (Tφ)(x) against quadrature of K, for several φ; weight · pdf = K(x, y); arguments not swapped |
//! | [`density`] | the density a step states = `pdf(x, y)`; ∫ pdf = P(step ≠ None); χ² of the points |
//! | [`absorption`] | `absorption(x)` = observed frequency of `None` |
//! | [`row_mass`] | `mass(x)` = ∫ \|K(x, y)\| dμ(y), and > 0 wherever the row is not 0 |
//! | [`proposal`] | weight · pdf = 1, ∫ pdf = 1, χ² of the points |
//! | [`source`] | weight · pdf_for = 1, ∫ pdf_for = 1, χ² of the points |
//! | [`support`] | pdf > 0 wherever K(x, y) Σ\|T\|ⁿ\|g\| ≠ 0 (condition (S) of theory §4.1) |
//! | [`connections`] | pdf_for > 0 wherever K(x, y) g(y) ≠ 0 |
//! | [`equation`] | all of these that closures on a domain have |
//!
//! Statistical tests share a false-alarm level (Bonferroni, theory §5.3 T1): a flawless kernel is blamed with probability below
//! [`Settings::false_alarm`]. What a test could not have seen is stated too: [`Report::resolution`] (theory §5.3 T2).
//!
//! ```
//! use fredholm::{check, domain::Interval, kernel::{kernel_fn, Proposed, Uniform}};
//! let k = kernel_fn(Interval::from(0.0..=1.0), |x: &f64, y: &f64| 0.5 * x * y);
//! let good = Proposed::new(k, Uniform::on(Interval::from(0.0..=1.0)));
//! let report = check::transition(&good, check::Settings::default())?;
//! assert!(report.is_ok(), "{report}");
//!
//! // a proposal that never looks at the right half
//! let blind = Proposed::new(k, Uniform::on(Interval::from(0.0..=0.5)));
//! let report = check::transition(&blind, check::Settings::default())?;
//! assert!(report.breaks(check::Law::Expectation));
//! # Ok::<(), fredholm::Error>(())
//! ```

mod density;
mod integral;
mod report;
mod sampled;
mod support;
mod tester;
mod transition;

pub use density::{absorption, density, proposal, source};
pub use report::{Issue, Law, Report};
pub use support::{connections, support};
pub use transition::{row_mass, transition};

use crate::equation::Equation;
use crate::error::Error;
use crate::kernel::{Absorbing, HasDomain, Kernel, Operator, TransitionPdf};
use crate::source::SampleSource;
use crate::value::Weight;

/// How hard to look.
///
/// ```
/// use fredholm::check::Settings;
/// let thorough = Settings::default().seed(3).places(32).samples(1 << 18).false_alarm(1e-9);
/// # assert_ne!(thorough, Settings::default());
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    seed: u64,
    places: usize,
    samples: u64,
    false_alarm: f64,
    tolerance: f64,
}

impl Default for Settings {
    /// Seed 0, 8 places, 65 536 draws a place, false alarms below 10⁻⁶, row masses to 10 %.
    fn default() -> Self {
        Settings { seed: 0, places: 8, samples: 1 << 16, false_alarm: 1e-6, tolerance: 0.1 }
    }
}

impl Settings {
    /// Seed of the draws and of the places.
    #[must_use]
    pub fn seed(self, seed: u64) -> Self {
        Settings { seed, ..self }
    }

    /// Number of places x that are looked at.
    #[must_use]
    pub fn places(self, places: usize) -> Self {
        Settings { places, ..self }
    }

    /// Draws at every place.
    #[must_use]
    pub fn samples(self, samples: u64) -> Self {
        Settings { samples, ..self }
    }

    /// Probability, over seeds, that a flawless object is blamed by one call.
    #[must_use]
    pub fn false_alarm(self, false_alarm: f64) -> Self {
        Settings { false_alarm, ..self }
    }

    /// Relative error allowed in [`RowMass`](crate::kernel::RowMass), where an approximation costs variance, never bias.
    #[must_use]
    pub fn tolerance(self, tolerance: f64) -> Self {
        Settings { tolerance, ..self }
    }

    fn validate(&self) -> Result<(), Error> {
        if self.places == 0 {
            return Err(Error::invalid("check places", 0.0, "must be at least 1"));
        }
        if self.samples < 1000 {
            return Err(Error::invalid("check samples", self.samples as f64, "must be at least 1000"));
        }
        if !(self.false_alarm > 0.0 && self.false_alarm < 1.0) {
            return Err(Error::invalid("check false alarm", self.false_alarm, "must lie strictly between 0 and 1"));
        }
        if !(self.tolerance > 0.0 && self.tolerance.is_finite()) {
            return Err(Error::invalid("check tolerance", self.tolerance, "must be positive and finite"));
        }
        Ok(())
    }
}

/// Everything an equation with all capabilities promises; the false-alarm level is shared.
///
/// ```
/// use fredholm::{check, Equation};
/// let eq = Equation::on_interval(0.0..=1.0, |_| 1.0, |x, y| 0.5 * x * y);
/// let report = check::equation(&eq, check::Settings::default())?;
/// assert!(report.is_ok(), "{report}");
/// # Ok::<(), fredholm::Error>(())
/// ```
///
/// # Errors
/// [`Error::Invalid`] for settings or domains outside their range.
pub fn equation<G, K>(equation: &Equation<G, K>, settings: Settings) -> Result<Report, Error>
where
    G: SampleSource,
    K: Kernel + TransitionPdf + Absorbing + HasDomain + Operator<Point = G::Point>,
    K::Weight: Weight<Value = G::Value>,
{
    settings.validate()?;
    equation.validate()?;
    let share = settings.false_alarm(settings.false_alarm / 4.0);
    let kernel = equation.kernel();
    let mut report = transition(kernel, share)?;
    report.append(density(kernel, share)?);
    report.append(absorption(kernel, share)?);
    report.append(source(equation.source(), kernel.domain(), share)?);
    report.append(support(equation, share)?);
    report.append(connections(equation, share)?);
    Ok(report)
}
