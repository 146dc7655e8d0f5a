//! Images on surfaces.

use super::Rgb;
use crate::error::Error;
use crate::value::Value;

/// Linear colours in [0, 1] on the unit square, repeated over the plane, interpolated between the middles of texels. Row 0 is at v = 0.
///
/// ```
/// use fredholm::{Spectrum, scene::Texture};
/// let t = Texture::new(2, 1, vec![Spectrum([0.0; 3]), Spectrum([1.0; 3])])?;
/// assert_eq!((t.at([0.25, 0.5]), t.at([0.5, 0.0])), (Spectrum([0.0; 3]), Spectrum([0.5; 3])));
/// # Ok::<(), fredholm::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Texture {
    width: usize,
    height: usize,
    texels: Vec<[f32; 3]>,
}

impl Texture {
    /// Row by row.
    ///
    /// # Errors
    /// [`Error::Invalid`] for an empty image, a wrong number of texels, and colours outside [0, 1].
    pub fn new(width: usize, height: usize, texels: Vec<Rgb>) -> Result<Self, Error> {
        if width == 0 || height == 0 || width.checked_mul(height) != Some(texels.len()) {
            return Err(Error::invalid("number of texels", texels.len() as f64, "must be width times height, and not 0"));
        }
        if let Some(t) = texels.iter().flat_map(|t| t.0).find(|t| !(0.0..=1.0).contains(t)) {
            return Err(Error::invalid("texel", t, "must lie in [0, 1]"));
        }
        Ok(Texture { width, height, texels: texels.iter().map(|t| t.0.map(|c| c as f32)).collect() })
    }

    /// The colour at a point of the plane.
    #[inline]
    #[must_use]
    pub fn at(&self, [u, v]: [f64; 2]) -> Rgb {
        let axis = |x: f64, n: usize| {
            let t = (x - x.floor()) * n as f64 - 0.5;
            let (low, share) = (t.floor(), t - t.floor());
            // half a texel before the first is the last one
            let first = if low < 0.0 { n - 1 } else { (low as usize).min(n - 1) };
            (first, (first + 1) % n, share)
        };
        let ((x0, x1, s), (y0, y1, t)) = (axis(u, self.width), axis(v, self.height));
        let texel = |x: usize, y: usize, i: usize| f64::from(self.texels[y * self.width + x][i]);
        let row = |y: usize, i: usize| texel(x0, y, i) + s * (texel(x1, y, i) - texel(x0, y, i));
        Rgb::from_components(|i| row(y0, i) + t * (row(y1, i) - row(y0, i)))
    }

    /// The mean colour.
    #[must_use]
    pub fn mean(&self) -> Rgb {
        let sum = self.texels.iter().fold([0.0; 3], |s, t| std::array::from_fn(|i| s[i] + f64::from(t[i])));
        crate::Spectrum(sum.map(|s| s / self.texels.len() as f64))
    }
}
