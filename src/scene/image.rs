//! The answer of a film: something for every pixel.

use super::Rgb;
use crate::statistics::Estimate;

/// Pixels, row by row from the top left.
///
/// ```no_run
/// # use fredholm::{Walk, scene::{Camera, Scene}};
/// # let scene = Scene::builder().build()?;
/// let film = scene.film(Camera::look_at([0.0, 1.0, 5.0], [0.0; 3]), 320, 240);
/// let image = scene.light_transport().seen_by(&film).solve(&Walk::mis().samples_per_cell(64))?;
/// println!("{}", image[(160, 120)]);                        // [0.1234(56), …]: every pixel has its error
/// image.write_png("image.png")?;
/// # Ok::<(), fredholm::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Image<T> {
    pub(super) width: usize,
    pub(super) pixels: Vec<T>,
}

impl<T> Image<T> {
    /// Rows of `width` ≥ 1 pixels.
    pub(crate) fn of(width: usize, pixels: Vec<T>) -> Self {
        Image { width, pixels }
    }

    /// Pixels in a row.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> usize {
        self.pixels.len() / self.width
    }

    /// All pixels, row by row.
    pub fn pixels(&self) -> &[T] {
        &self.pixels
    }

    /// An image of what `f` makes of each pixel.
    pub fn map<U>(&self, f: impl FnMut(&T) -> U) -> Image<U> {
        Image { width: self.width, pixels: self.pixels.iter().map(f).collect() }
    }
}

/// The pixel in column x and row y.
impl<T> std::ops::Index<(usize, usize)> for Image<T> {
    type Output = T;
    fn index(&self, (x, y): (usize, usize)) -> &T {
        assert!(x < self.width, "column {x} of an image of {}", self.width);
        &self.pixels[y * self.width + x]
    }
}

impl Image<Estimate<Rgb>> {
    /// The values alone.
    #[must_use]
    pub fn values(&self) -> Image<Rgb> {
        self.map(|p| p.value)
    }

    /// Standard errors, NaN in pixels that no walk has brought light to: theirs is unknown. `None` if no pixel has one.
    #[must_use]
    pub fn errors(&self) -> Option<Image<Rgb>> {
        let unknown = crate::Spectrum([f64::NAN; 3]);
        let pixels = self.pixels.iter().map(|p| p.std_error.unwrap_or(unknown)).collect();
        self.pixels.iter().any(|p| p.std_error.is_some()).then_some(Image { width: self.width, pixels })
    }

    /// Largest root mean square, over the components, of the pixels' standard errors over the mean value of the image: what a progress bar shows.
    /// Pixels whose error is unknown are left out.
    #[must_use]
    pub fn relative_error(&self) -> Option<f64> {
        let errors: Vec<Rgb> = self.pixels.iter().filter_map(|p| p.std_error).collect();
        if errors.is_empty() {
            return None;
        }
        let relative = |i: usize| {
            let mean = self.pixels.iter().map(|p| p.value[i]).sum::<f64>() / self.pixels.len() as f64;
            let square = errors.iter().map(|e| e[i] * e[i]).sum::<f64>() / errors.len() as f64;
            if mean > 0.0 { square.sqrt() / mean } else { 0.0 }
        };
        Some((0..3).map(relative).fold(0.0, f64::max))
    }
}
