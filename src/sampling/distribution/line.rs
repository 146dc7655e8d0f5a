//! Powers and exponentials.

use super::{Distribution, Inverse};
use crate::error::Error;

/// Density (n + 1) xⁿ on (0, 1).
///
/// ```
/// use fredholm::sampling::distribution::{Distribution, Inverse, Power};
/// let d = Power::new(2.0)?;
/// assert_eq!((d.sample(0.125), d.pdf(&0.5), d.invert(&0.5)), (0.5, 0.75, Some(0.125)));
/// assert!(Power::new(-1.0).is_err());
/// # Ok::<(), fredholm::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Power {
    exponent: f64,
}

impl Power {
    /// The exponent n.
    ///
    /// # Errors
    /// [`Error::Invalid`] for n below −0.94 (the density is integrable above −1, but closer to it the smallest numbers would be rounded to
    /// 0, where it is infinite) and n that is not finite.
    pub fn new(exponent: f64) -> Result<Self, Error> {
        if exponent >= -0.94 && exponent.is_finite() {
            Ok(Power { exponent })
        } else {
            Err(Error::invalid("exponent", exponent, "must be finite and at least −0.94"))
        }
    }
}

impl Distribution for Power {
    type Unit = f64;
    type Point = f64;

    fn sample(&self, u: f64) -> f64 {
        u.powf(1.0 / (self.exponent + 1.0))
    }

    fn pdf(&self, x: &f64) -> f64 {
        if (0.0..=1.0).contains(x) { (self.exponent + 1.0) * x.powf(self.exponent) } else { 0.0 }
    }
}

impl Inverse for Power {
    fn invert(&self, x: &f64) -> Option<f64> {
        (0.0..=1.0).contains(x).then(|| x.powf(self.exponent + 1.0))
    }
}

/// Density λ e^{−λx} on x > 0.
///
/// ```
/// use fredholm::sampling::distribution::{Distribution, Exponential, Inverse};
/// let d = Exponential::new(2.0)?;
/// let x = d.sample(1e-20);                                  // no digit is lost near 0
/// assert!((x / 5e-21 - 1.0).abs() < 1e-15 && (d.invert(&x).unwrap() / 1e-20 - 1.0).abs() < 1e-15);
/// assert_eq!(d.pdf(&-1.0), 0.0);
/// # Ok::<(), fredholm::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exponential {
    rate: f64,
}

impl Exponential {
    /// The rate λ.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a rate that is not positive and finite.
    pub fn new(rate: f64) -> Result<Self, Error> {
        if rate > 0.0 && rate.is_finite() {
            Ok(Exponential { rate })
        } else {
            Err(Error::invalid("rate", rate, "must be positive and finite"))
        }
    }
}

impl Distribution for Exponential {
    type Unit = f64;
    type Point = f64;

    fn sample(&self, u: f64) -> f64 {
        -(-u).ln_1p() / self.rate
    }

    fn pdf(&self, x: &f64) -> f64 {
        if *x >= 0.0 { self.rate * (-self.rate * x).exp() } else { 0.0 }
    }
}

impl Inverse for Exponential {
    fn invert(&self, x: &f64) -> Option<f64> {
        (*x >= 0.0).then(|| -(-self.rate * x).exp_m1())
    }
}
