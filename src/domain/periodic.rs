//! An interval whose ends are one point.

use super::{Domain, Interval, Node};
use crate::error::Error;
use std::ops::RangeInclusive;

/// A period [a, b] of functions that continue periodically, with Lebesgue measure: rules are trapezoidal, which for analytic functions converge
/// geometrically with the smallest constant there is (Kress, *Linear integral equations*, §12.1; Trefethen, Weideman, *SIAM Review* 56 (2014) 385).
///
/// ```
/// use fredholm::{domain::Periodic, Equation, deterministic::Nystrom};
/// // an ellipse's double layer (Mikhlin, Smolitskiy): f = 8.5 + (128/17) cos 2x
/// let circle = Periodic::from(-std::f64::consts::PI..=std::f64::consts::PI);
/// let k = |x: &f64, y: &f64| -0.3 / std::f64::consts::PI / (1.0 - 0.64 * (0.5 * (x + y)).cos().powi(2));
/// let eq = Equation::on_domain(circle, |x: &f64| 25.0 - 16.0 * x.sin().powi(2), k);
/// let f = eq.solve(&Nystrom::gauss_legendre(48))?;          // 48 equidistant nodes
/// assert!((f.eval(1.0) - 8.5 - 128.0 / 17.0 * 2f64.cos()).abs() < 1e-13);
/// # Ok::<(), fredholm::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Periodic {
    period: Interval,
}

impl From<RangeInclusive<f64>> for Periodic {
    fn from(range: RangeInclusive<f64>) -> Self {
        Periodic { period: Interval::from(range) }
    }
}

impl Periodic {
    /// The period as an interval.
    pub fn period(&self) -> &Interval {
        &self.period
    }
}

impl Domain for Periodic {
    type Point = f64;

    fn validate(&self) -> Result<(), Error> {
        self.period.validate()
    }

    #[inline]
    fn volume(&self) -> f64 {
        self.period.volume()
    }

    #[inline]
    fn contains(&self, x: &f64) -> bool {
        self.period.contains(x)
    }

    fn dimension(&self) -> usize {
        1
    }

    fn is_periodic(&self, _: usize) -> bool {
        true
    }

    #[inline]
    fn place(&self, state: usize, next: impl FnMut() -> f64) -> Node<f64> {
        self.period.place(state, next)
    }

    #[inline]
    fn density(&self, x: &f64) -> f64 {
        self.period.density(x)
    }

    fn locate(&self, x: f64) -> Option<f64> {
        self.period.locate(x)
    }

    #[inline]
    fn coordinate(&self, x: &f64, axis: usize) -> f64 {
        self.period.coordinate(x, axis)
    }

    fn displaced(&self, x: &f64, state: usize, d: f64) -> Node<f64> {
        self.period.displaced(x, state, d)
    }

    fn separation(&self, x: &f64, y: &f64) -> f64 {
        self.period.separation(x, y)
    }
}
