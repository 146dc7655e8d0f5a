//! Critical slabs: when does a chain reaction sustain itself?
//!
//! ```text
//! ρ(a) φ(x) = ½ ∫₀ᵃ E₁(|x − y|) φ(y) dy,        critical:  c ρ(a) = 1
//! dρ/da = ρ φ(a)²/∫φ²
//! ```
//!
//! The derivative follows from the Rayleigh quotient of φ continued by φ(a) beyond a; Newton's iteration for the thickness starts from the infinite
//! medium, c arctan(B) = B, less the extrapolated distance 0.7104/c on both sides (Davison, *Neutron transport theory* (1957), §6). Both
//! quantities carry the error of the eigenvalue, δc = c² δρ and δa = δρ/(dρ/da).

use super::Slab;
use crate::deterministic::{Eigenpair, Nystrom, eigenpairs};
use crate::error::Error;
use crate::kernel::Operator;

/// A slab that is just critical.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Critical {
    /// c.
    pub multiplication: f64,
    /// a, in mean free paths.
    pub thickness: f64,
    /// Estimated |error| of what was asked for, c or a.
    pub error: f64,
    /// The flux, scaled to a maximum of 1 over the nodes, and 1/c as its eigenvalue.
    pub flux: Eigenpair<Slab>,
}

/// Newton steps; the start is within a tenth.
const STEPS: usize = 30;

impl Critical {
    /// The c at which a slab of this thickness is critical, to relative `tolerance`.
    ///
    /// ```
    /// let c = fredholm::transport::Critical::at_thickness(1.0, 1e-11)?;
    /// assert!((c.multiplication - 1.615_378_537_136_864).abs() < 1e-11);
    /// let edge = c.flux.eval(0.0).re / c.flux.eval(0.5).re;
    /// assert!((edge - 0.555_546_387_320_434).abs() < 1e-9);
    /// # Ok::<(), fredholm::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Invalid`] for thicknesses that are not positive; [`Error::NotConverged`].
    pub fn at_thickness(thickness: f64, tolerance: f64) -> Result<Self, Error> {
        let flux = flux(thickness, tolerance)?;
        let multiplication = 1.0 / flux.value().re;
        Ok(Critical { multiplication, thickness, error: multiplication * multiplication * flux.error(), flux })
    }

    /// The thickness at which a slab of c > 1 is critical, to relative `tolerance`.
    ///
    /// ```
    /// let slab = fredholm::transport::Critical::at_multiplication(1.5, 1e-11)?;
    /// assert!((0.5 * slab.thickness - 0.605_056_519_266_29).abs() < 1e-11);       // half of it
    /// # Ok::<(), fredholm::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Invalid`] for c ≤ 1: no slab is thick enough; [`Error::NotConverged`].
    pub fn at_multiplication(multiplication: f64, tolerance: f64) -> Result<Self, Error> {
        let c = multiplication;
        if !(c > 1.0 && c.is_finite()) {
            return Err(Error::invalid("multiplication", c, "must be finite and above 1: below, no slab is critical"));
        }
        let (mut a, mut last) = (guess(c), f64::INFINITY);
        for _ in 0..STEPS {
            // far from the root a few digits are enough
            let precision = if last > 1e-3 { 1e-6f64.max(tolerance) } else { tolerance };
            let flux = flux(a, precision)?;
            let (rho, edge) = (flux.value().re, flux.eval(a).re);
            let slope = rho * edge * edge / flux.norm_squared();
            // 1/ρ is nearly straight in 1/a², and log a never leaves the positive numbers
            let step = ((1.0 / c - rho) / (slope * a)).clamp(-0.7, 0.7);
            if precision == tolerance && step.abs() <= tolerance {
                return Ok(Critical { multiplication: c, thickness: a * step.exp(), error: flux.error() / slope + a * step * step, flux });
            }
            if precision == tolerance && step.abs() >= last {
                return Err(Error::NotConverged { error: a * step.abs(), tolerance: a * tolerance, unknowns: flux.unknowns() });
            }
            last = step.abs();
            a *= step.exp();
        }
        Err(Error::NotConverged { error: a * last, tolerance: a * tolerance, unknowns: 0 })
    }
}

/// The fundamental mode of c = 1.
fn flux(thickness: f64, tolerance: f64) -> Result<Eigenpair<Slab>, Error> {
    let slab = Slab::new(thickness).scattering(1.0);
    slab.validate()?;
    let pairs = eigenpairs(&slab, &Nystrom::adaptive().tolerance(tolerance), 1)?;
    let [flux] =
        <[_; 1]>::try_from(pairs).map_err(|_| Error::invalid("slab thickness", thickness, "is too small: the eigenvalue underflows"))?;
    Ok(flux)
}

/// π/B less the extrapolated distances.
fn guess(c: f64) -> f64 {
    let (mut low, mut high) = (0.0, std::f64::consts::FRAC_PI_2 * c);
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if c * middle.atan() > middle { low = middle } else { high = middle }
    }
    let infinite = std::f64::consts::PI / low;
    (infinite - 1.4208 / c).max(0.2 * infinite)
}
