//! The film: a detector whose cells are pixels.
//!
//! ```text
//! pixel = ∫ h(r) L(ray r) dr,   h the reconstruction filter around the middle of the pixel, ∫ h = 1
//! ```
//!
//! Rays are drawn ∝ h, so that walks start with weight 1.

use super::camera::View;
use super::{Camera, Image, Place, Scene, State};
use crate::detector::{Detector, Start};
use crate::error::Error;
use crate::sampling::Sampler;
use std::f64::consts::TAU;

/// How a pixel weighs rays near its middle; lengths in pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Filter {
    /// The same everywhere in the pixel.
    Box,
    /// 1 − |x|/radius in each coordinate.
    Tent(f64),
    /// e^{−x²/2σ²} in each coordinate, uncut.
    Gaussian(f64),
}

impl Filter {
    /// Where to look, from the middle of the pixel.
    #[inline]
    fn sample(self, [u, v]: [f64; 2]) -> [f64; 2] {
        match self {
            Filter::Box => [u - 0.5, v - 0.5],
            Filter::Tent(radius) => [u, v].map(|u| radius * if u < 0.5 { (2.0 * u).sqrt() - 1.0 } else { 1.0 - (2.0 - 2.0 * u).sqrt() }),
            Filter::Gaussian(sigma) => {
                // Box, Muller, Ann. Math. Statist. 29 (1958) 610
                let (r, (s, c)) = (sigma * (-2.0 * u.ln()).sqrt(), (TAU * v).sin_cos());
                [r * c, r * s]
            }
        }
    }

    fn validate(self) -> Result<(), Error> {
        match self {
            Filter::Box => Ok(()),
            Filter::Tent(r) if r > 0.0 && r.is_finite() => Ok(()),
            Filter::Gaussian(s) if s > 0.0 && s.is_finite() => Ok(()),
            Filter::Tent(width) | Filter::Gaussian(width) => {
                Err(Error::invalid("width of the filter", width, "must be positive and finite"))
            }
        }
    }
}

/// Pixels behind a camera; see [`Scene::film`].
#[derive(Clone, Debug)]
#[must_use]
pub struct Film {
    pub(super) scene: Scene,
    pub(super) camera: Camera,
    pub(super) view: View,
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) filter: Filter,
}

/// Images beyond this many pixels are refused: an estimate takes some hundred bytes.
const MOST_PIXELS: usize = 1 << 26;

impl Film {
    pub(super) fn new(scene: Scene, camera: Camera, width: usize, height: usize) -> Self {
        Film { scene, camera, view: camera.ready(width, height), width, height, filter: Filter::Box }
    }

    /// With another reconstruction filter.
    pub fn filter(self, filter: Filter) -> Self {
        Film { filter, ..self }
    }

    /// Pixels in a row.
    #[must_use]
    pub fn width(&self) -> usize {
        self.width
    }

    /// Rows.
    #[must_use]
    pub fn height(&self) -> usize {
        self.height
    }
}

impl Detector for Film {
    type Point = State;
    type Answer<T> = Image<T>;

    fn cells(&self) -> usize {
        self.width * self.height
    }

    #[inline]
    fn start<S: Sampler>(&self, cell: usize, u: &mut S) -> Start<State> {
        let [x, y] = self.filter.sample(u.next_2d());
        let at = [(cell % self.width) as f64 + 0.5 + x, (cell / self.width) as f64 + 0.5 + y];
        let (ray, direction) = if self.camera.has_lens() { self.view.thin_lens(at, u.next_2d()) } else { self.view.pinhole(at) };
        let mut point = self.scene.0.trace(&ray, &direction);
        if point.place() == Place::Environment {
            // which point of the lens looks there
            point.position = ray.origin;
        }
        Start { point, weight: 1.0 }
    }

    fn norm(&self) -> Option<f64> {
        Some(1.0)
    }

    fn answer<T>(&self, cells: Vec<T>) -> Image<T> {
        Image::of(self.width, cells)
    }

    fn validate(&self) -> Result<(), Error> {
        for (name, size) in [("image width", self.width), ("image height", self.height)] {
            if size == 0 {
                return Err(Error::invalid(name, 0.0, "must be at least 1"));
            }
        }
        if self.width.checked_mul(self.height).is_none_or(|n| n > MOST_PIXELS) {
            return Err(Error::invalid("number of pixels", self.width as f64 * self.height as f64, "must be at most 2^26"));
        }
        self.filter.validate()?;
        self.camera.validate()
    }
}
