//! Light from infinitely far away, from all directions.

use crate::domain::Interval;
use crate::error::Error;
use crate::sampling::distribution::{Distribution, PiecewiseConstant2d, UniformSphere};
use crate::scene::Rgb;
use crate::scene::frame::Vec3;
use crate::value::Value;
use std::f64::consts::{FRAC_1_PI, PI, TAU};

/// Radiance from every direction: the same from all, or from a map.
///
/// A map is equirectangular: rows from the top (+y) down, columns once around, the middle of the image at −z. It is constant on texels, and sampled by
/// radiance times solid angle. Radiances are kept in single precision, as images have them.
///
/// ```
/// use fredholm::scene::Environment;
/// let sky = Environment::constant([0.5, 0.75, 1.0]);
/// assert_eq!(sky.radiance([0.0, 1.0, 0.0]).0, [0.5, 0.75, 1.0]);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Environment {
    width: usize,
    height: usize,
    texels: Vec<[f32; 3]>,
    /// texels with the weight of their brightest component; `None` if all directions are alike
    density: Option<PiecewiseConstant2d>,
}

impl Environment {
    /// The same radiance from everywhere.
    #[must_use]
    pub fn constant(radiance: [f64; 3]) -> Self {
        Environment { width: 1, height: 1, texels: vec![radiance.map(|c| c as f32)], density: None }
    }

    /// From an equirectangular image.
    ///
    /// # Errors
    /// [`Error::Invalid`] for an empty or black image, a wrong number of texels, and radiances that are negative or not finite.
    pub fn map(width: usize, height: usize, texels: Vec<[f32; 3]>) -> Result<Self, Error> {
        if width == 0 || height == 0 || width.checked_mul(height) != Some(texels.len()) {
            return Err(Error::invalid("number of texels", texels.len() as f64, "must be width times height, and not 0"));
        }
        let row = |j: usize| -> Vec<f64> {
            // solid angle of the texels of a row, up to a factor
            let (above, below) = (PI * j as f64 / height as f64, PI * (j + 1) as f64 / height as f64);
            let size = above.cos() - below.cos();
            texels[j * width..(j + 1) * width].iter().map(|t| f64::from(t.iter().fold(0.0f32, |m, c| m.max(*c))) * size).collect()
        };
        let unit = || Interval::from(0.0..=1.0);
        let density = PiecewiseConstant2d::on([unit(), unit()], &(0..height).map(row).collect::<Vec<_>>())?;
        let environment = Environment { width, height, texels, density: Some(density) };
        environment.validate().map(|()| environment)
    }

    pub(crate) fn validate(&self) -> Result<(), Error> {
        match self.texels.iter().flatten().find(|t| !(**t >= 0.0 && t.is_finite())) {
            Some(t) => Err(Error::invalid("radiance of the environment", f64::from(*t), "must be finite and not negative")),
            None => Ok(()),
        }
    }

    pub(crate) fn is_black(&self) -> bool {
        self.texels.iter().flatten().all(|t| *t == 0.0)
    }

    /// The radiance that comes from a direction.
    #[inline]
    #[must_use]
    pub fn radiance(&self, towards: [f64; 3]) -> Rgb {
        let texel = match self.density {
            None => self.texels[0],
            Some(_) => {
                let [u, v] = place(&towards.into());
                let cell = |x: f64, n: usize| ((x * n as f64) as usize).min(n - 1);
                self.texels[cell(v, self.height) * self.width + cell(u, self.width)]
            }
        };
        Rgb::from_components(|i| f64::from(texel[i]))
    }

    /// A direction and 1/density per solid angle.
    #[inline]
    pub(crate) fn sample(&self, u: [f64; 2]) -> (Vec3, f64) {
        let Some(density) = &self.density else { return (Vec3::from(UniformSphere.sample(u)), 4.0 * PI) };
        // heights of a row are equally likely in cos θ only: the texel from the table, the place in it by solid angle
        let [x, y] = density.sample(u);
        let row = ((y * self.height as f64) as usize).min(self.height - 1);
        let share = (y * self.height as f64 - row as f64).clamp(0.0, 1.0);
        let (above, below) = self.row(row);
        let (cosine, (s, c)) = (above + share * (below - above), (TAU * (x - 0.5)).sin_cos());
        let sine = ((1.0 - cosine) * (1.0 + cosine)).max(0.0).sqrt();
        let direction = Vec3::new(sine * s, cosine, -sine * c);
        (direction, 1.0 / self.density_at(density, x, row, above - below))
    }

    /// Density per solid angle.
    #[inline]
    pub(crate) fn pdf(&self, direction: &Vec3) -> f64 {
        let Some(density) = &self.density else { return 0.25 * FRAC_1_PI };
        let [u, v] = place(direction);
        let row = ((v * self.height as f64) as usize).min(self.height - 1);
        let (above, below) = self.row(row);
        self.density_at(density, u, row, above - below)
    }

    /// cos θ at the upper and the lower edge of a row.
    #[inline]
    fn row(&self, row: usize) -> (f64, f64) {
        let edge = |j: usize| (PI * j as f64 / self.height as f64).cos();
        (edge(row), edge(row + 1))
    }

    /// Table density of the row at u, spread over its solid angle.
    #[inline]
    fn density_at(&self, density: &PiecewiseConstant2d, u: f64, row: usize, height: f64) -> f64 {
        density.pdf(&[u, (row as f64 + 0.5) / self.height as f64]) / (self.height as f64 * TAU * height)
    }
}

/// Image coordinates of a direction, in [0, 1].
#[inline]
fn place(d: &Vec3) -> [f64; 2] {
    [0.5 + d.x.atan2(-d.z) / TAU, d.y.clamp(-1.0, 1.0).acos() * FRAC_1_PI]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// ∫ pdf dω = 1, weights are 1/pdf, and the mean of weight·radiance is the integral of the radiance.
    #[test]
    fn a_map_is_sampled_by_its_density() {
        let texels: Vec<[f32; 3]> = (0..8 * 4).map(|k| [(k % 5) as f32, (k % 3) as f32, 1.0]).collect();
        let sky = Environment::map(8, 4, texels).unwrap();
        const N: usize = 256;
        let (mut total, mut blue) = (0.0, 0.0);
        for k in 0..N * N {
            let u = [(k % N) as f64 + 0.5, (k / N) as f64 + 0.5].map(|c| c / N as f64);
            let (d, weight) = sky.sample(u);
            assert!((weight * sky.pdf(&d) - 1.0).abs() < 1e-9);
            blue += weight * sky.radiance(d.into())[2] / (N * N) as f64;
            total += sky.pdf(&Vec3::from(UniformSphere.sample(u))) * 4.0 * PI / (N * N) as f64;
        }
        assert!((blue / (4.0 * PI) - 1.0).abs() < 1e-2 && (total - 1.0).abs() < 2e-2, "{blue} {total}");
        // texel by texel: the density times the solid angle is the share of the samples, and all shares are 1
        let mut counts = [0.0; 32];
        for k in 0..N * N {
            let u = [(k % N) as f64 + 0.5, (k / N) as f64 + 0.5].map(|c| c / N as f64);
            let [x, y] = place(&sky.sample(u).0);
            counts[(y * 4.0) as usize * 8 + (x * 8.0) as usize] += 1.0 / (N * N) as f64;
        }
        let share = |k: usize| {
            let (above, below) = sky.row(k / 8);
            let (cosine, angle) = (0.5 * (above + below), TAU * ((k % 8) as f64 + 0.5 - 4.0) / 8.0);
            let sine = ((1.0 - cosine) * (1.0 + cosine)).sqrt();
            sky.pdf(&Vec3::new(sine * angle.sin(), cosine, -sine * angle.cos())) * (above - below) * TAU / 8.0
        };
        let shares: Vec<f64> = (0..32).map(share).collect();
        assert!((shares.iter().sum::<f64>() - 1.0).abs() < 1e-12);
        assert!(counts.iter().zip(&shares).all(|(a, b)| (a - b).abs() < 2.0 / N as f64), "{counts:?} {shares:?}");
        assert!(Environment::map(1, 1, vec![[f32::NAN; 3]]).is_err());
        assert!(Environment::map(2, 1, vec![[1.0; 3]]).is_err());
    }
}
