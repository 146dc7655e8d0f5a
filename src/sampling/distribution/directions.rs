//! Directions around the axis (0, 0, 1); densities with respect to solid angle.
//!
//! A direction is kept by w = 1 − cos θ, which knows small angles: sin² θ = w (2 − w).

use super::{Distribution, Inverse, UniformDisk};
use crate::error::Error;
use std::f64::consts::{FRAC_1_PI, PI, TAU};

/// The direction with 1 − cos θ = w, turned by v of a full circle.
fn direction(w: f64, v: f64) -> [f64; 3] {
    let (sine, (s, c)) = ((w * (2.0 - w)).max(0.0).sqrt(), (TAU * v).sin_cos());
    [sine * c, sine * s, 1.0 - w]
}

/// w and v of a direction.
fn angles([x, y, z]: [f64; 3]) -> [f64; 2] {
    let w = if z > 0.0 { (x * x + y * y) / (1.0 + z) } else { 1.0 - z };
    [w, (y.atan2(x) / TAU).rem_euclid(1.0)]
}

/// All directions alike: w = 2(1 − u).
///
/// ```
/// use fredholm::sampling::distribution::{Distribution, Inverse, UniformSphere};
/// let d = UniformSphere.sample([0.75, 0.25]);
/// assert!((d[1] - 0.75f64.sqrt()).abs() < 1e-15 && d[2] == 0.5);
/// assert!((UniformSphere.invert(&d).unwrap()[1] - 0.25).abs() < 1e-15);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct UniformSphere;

impl Distribution for UniformSphere {
    type Unit = [f64; 2];
    type Point = [f64; 3];

    fn sample(&self, [u, v]: [f64; 2]) -> [f64; 3] {
        direction(2.0 * (1.0 - u), v)
    }

    fn pdf(&self, _: &[f64; 3]) -> f64 {
        0.25 * FRAC_1_PI
    }
}

impl Inverse for UniformSphere {
    fn invert(&self, d: &[f64; 3]) -> Option<[f64; 2]> {
        let [w, v] = angles(*d);
        Some([1.0 - 0.5 * w, v])
    }
}

/// All directions with z > 0 alike: w = 1 − u.
///
/// ```
/// use fredholm::sampling::distribution::{Distribution, UniformHemisphere};
/// assert_eq!(UniformHemisphere.sample([0.25, 0.0])[2], 0.25);
/// assert_eq!(UniformHemisphere.pdf(&[0.0, 0.0, -1.0]), 0.0);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct UniformHemisphere;

impl Distribution for UniformHemisphere {
    type Unit = [f64; 2];
    type Point = [f64; 3];

    fn sample(&self, [u, v]: [f64; 2]) -> [f64; 3] {
        direction(1.0 - u, v)
    }

    fn pdf(&self, d: &[f64; 3]) -> f64 {
        if d[2] >= 0.0 { 0.5 * FRAC_1_PI } else { 0.0 }
    }
}

impl Inverse for UniformHemisphere {
    fn invert(&self, d: &[f64; 3]) -> Option<[f64; 2]> {
        let [w, v] = angles(*d);
        (d[2] >= 0.0).then_some([1.0 - w, v])
    }
}

/// Density cos θ/π on the hemisphere: the disk lifted up (Malley; Nusselt's analogon).
///
/// ```
/// use fredholm::sampling::distribution::{CosineHemisphere, Distribution, Inverse};
/// let d = CosineHemisphere.sample([0.8, 0.5]);
/// assert!((d[0] - 0.6).abs() < 1e-15 && (d[2] - 0.8).abs() < 1e-15);
/// assert!((CosineHemisphere.pdf(&d) - 0.8 / std::f64::consts::PI).abs() < 1e-15);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CosineHemisphere;

impl Distribution for CosineHemisphere {
    type Unit = [f64; 2];
    type Point = [f64; 3];

    fn sample(&self, u: [f64; 2]) -> [f64; 3] {
        // from r itself: 1 − x² − y² could be negative by rounding (theory (2.2.8)), and z must not be 0, where the density is
        let (r, angle) = UniformDisk::polar(u);
        [r * angle.cos(), r * angle.sin(), ((1.0 - r) * (1.0 + r)).sqrt()]
    }

    fn pdf(&self, d: &[f64; 3]) -> f64 {
        d[2].max(0.0) * FRAC_1_PI
    }
}

impl Inverse for CosineHemisphere {
    fn invert(&self, d: &[f64; 3]) -> Option<[f64; 2]> {
        // a direction in the plane may be longer than 1 by rounding
        let r = d[0].hypot(d[1]).max(1.0);
        (d[2] >= 0.0).then(|| UniformDisk.invert(&[d[0] / r, d[1] / r])).flatten()
    }
}

/// All directions within an angle of the axis alike: w = (1 − u)(1 − cos θ_max).
///
/// ```
/// use fredholm::sampling::distribution::{Distribution, UniformCone};
/// let cone = UniformCone::new(0.5)?;
/// assert_eq!(cone.sample([0.0, 0.3])[2], 0.5);
/// assert!((cone.pdf(&[0.0, 0.0, 1.0]) * std::f64::consts::PI - 1.0).abs() < 1e-15);
/// # Ok::<(), fredholm::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UniformCone {
    /// 1 − cos θ_max
    height: f64,
}

impl UniformCone {
    /// Within the angle whose cosine is given.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a cosine outside [−1, 1): at 1 there is no solid angle.
    pub fn new(cosine: f64) -> Result<Self, Error> {
        if (-1.0..1.0).contains(&cosine) {
            Ok(UniformCone { height: 1.0 - cosine })
        } else {
            Err(Error::invalid("cosine", cosine, "must lie in [−1, 1)"))
        }
    }
}

impl Distribution for UniformCone {
    type Unit = [f64; 2];
    type Point = [f64; 3];

    fn sample(&self, [u, v]: [f64; 2]) -> [f64; 3] {
        direction((1.0 - u) * self.height, v)
    }

    fn pdf(&self, d: &[f64; 3]) -> f64 {
        // a direction on the rim may be outside by rounding
        if angles(*d)[0] <= self.height * (1.0 + 4.0 * f64::EPSILON) { 1.0 / (TAU * self.height) } else { 0.0 }
    }
}

impl Inverse for UniformCone {
    fn invert(&self, d: &[f64; 3]) -> Option<[f64; 2]> {
        let [w, v] = angles(*d);
        (self.pdf(d) > 0.0).then(|| [(1.0 - w / self.height).max(0.0), v])
    }
}

/// Henyey and Greenstein's phase function of asymmetry g (*Diffuse radiation in the galaxy*, 1941), the axis being the direction before the
/// collision:
///
/// ```text
/// p(cos θ) = (1 − g²)/(4π R³),   R² = 1 + g² − 2g cos θ = (1 − g)² + 2gw
/// w = 2(1 − g)² (1 − u)(1 + gu)/(1 − g + 2gu)²,   u = (1 − g)(1 + cos θ)/(R (1 + g + R))
/// ```
///
/// Neither map divides by g or subtracts like numbers for g ≥ 0; g < 0 is the mirror image. So isotropic and nearly singular scattering are
/// no special cases.
///
/// ```
/// use fredholm::sampling::distribution::{Distribution, HenyeyGreenstein};
/// let forward = HenyeyGreenstein::new(0.9)?;
/// assert!(forward.sample([0.5, 0.0])[2] > 0.98);
/// assert!((HenyeyGreenstein::new(0.0)?.sample([0.5, 0.0])[2]).abs() < 1e-15);
/// # Ok::<(), fredholm::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HenyeyGreenstein {
    g: f64,
}

impl HenyeyGreenstein {
    /// Mean cosine g ∈ (−1, 1).
    ///
    /// # Errors
    /// [`Error::Invalid`] for g outside.
    pub fn new(g: f64) -> Result<Self, Error> {
        if g.abs() < 1.0 { Ok(HenyeyGreenstein { g }) } else { Err(Error::invalid("asymmetry g", g, "must lie in (−1, 1)")) }
    }

    /// |g|, and a direction as |g| sees it.
    fn forward(&self, [x, y, z]: [f64; 3]) -> (f64, [f64; 3]) {
        if self.g < 0.0 { (-self.g, [x, y, -z]) } else { (self.g, [x, y, z]) }
    }
}

fn root(g: f64, w: f64) -> f64 {
    ((1.0 - g).powi(2) + 2.0 * g * w).sqrt()
}

impl Distribution for HenyeyGreenstein {
    type Unit = [f64; 2];
    type Point = [f64; 3];

    fn sample(&self, [u, v]: [f64; 2]) -> [f64; 3] {
        let (g, u) = if self.g < 0.0 { (-self.g, 1.0 - u) } else { (self.g, u) };
        let ratio = (1.0 - g) / (1.0 - g + 2.0 * g * u);
        self.forward(direction((2.0 * ratio * ratio * (1.0 - u) * (1.0 + g * u)).min(2.0), v)).1
    }

    fn pdf(&self, d: &[f64; 3]) -> f64 {
        let (g, d) = self.forward(*d);
        (1.0 - g) * (1.0 + g) / (4.0 * PI * root(g, angles(d)[0]).powi(3))
    }
}

impl Inverse for HenyeyGreenstein {
    fn invert(&self, d: &[f64; 3]) -> Option<[f64; 2]> {
        let (g, d) = self.forward(*d);
        let [w, v] = angles(d);
        let root = root(g, w);
        let u = (1.0 - g) * (2.0 - w) / (root * (1.0 + g + root));
        Some([if self.g < 0.0 { 1.0 - u } else { u }, v])
    }
}
