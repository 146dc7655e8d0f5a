//! Cameras: which ray a point of the image plane sees.

use super::frame::Vec3;
use super::geometry::Ray;
use crate::error::Error;
use crate::sampling::distribution::{Distribution, UniformDisk};

/// A pinhole, or a thin lens.
///
/// ```
/// use fredholm::scene::Camera;
/// let pinhole = Camera::look_at([278.0, 273.0, -800.0], [278.0, 273.0, 0.0]).field_of_view(39.3);
/// let lens = pinhole.lens(5.0, 1000.0);
/// # let _ = lens;
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[must_use]
pub struct Camera {
    eye: Vec3,
    forward: Vec3,
    up: Vec3,
    /// vertical field of view in degrees
    degrees: f64,
    lens_radius: f64,
    focus: f64,
}

impl Camera {
    /// At `eye`, looking at `target`, +y up; a pinhole with 45° from top to bottom.
    pub fn look_at(eye: [f64; 3], target: [f64; 3]) -> Self {
        Camera::towards(eye, (Vec3::from(target) - Vec3::from(eye)).into())
    }

    /// At `eye`, looking in a direction.
    pub fn towards(eye: [f64; 3], direction: [f64; 3]) -> Self {
        Camera { eye: eye.into(), forward: direction.into(), up: Vec3::y(), degrees: 45.0, lens_radius: 0.0, focus: 1.0 }
    }

    /// With another direction up.
    pub fn up(self, up: [f64; 3]) -> Self {
        Camera { up: up.into(), ..self }
    }

    /// Degrees from top to bottom of the image.
    pub fn field_of_view(self, degrees: f64) -> Self {
        Camera { degrees, ..self }
    }

    /// A thin lens: what lies at distance `focus` along the axis is sharp. Radius 0 is a pinhole.
    pub fn lens(self, radius: f64, focus: f64) -> Self {
        Camera { lens_radius: radius, focus, ..self }
    }

    /// Whether the place on the lens matters.
    pub(crate) fn has_lens(&self) -> bool {
        self.lens_radius > 0.0
    }

    pub(crate) fn validate(&self) -> Result<(), Error> {
        if let Some(x) = self.eye.iter().chain(&self.forward).chain(&self.up).find(|x| !x.is_finite()) {
            return Err(Error::invalid("coordinate of the camera", *x, "must be finite"));
        }
        let across = self.forward.normalize().cross(&self.up.normalize()).norm();
        if !(across > 1e-9) {
            return Err(Error::invalid("sine between the camera's direction and up", across, "must not be 0"));
        }
        if !(self.degrees > 0.0 && self.degrees < 180.0) {
            return Err(Error::invalid("field of view", self.degrees, "must lie in (0, 180) degrees"));
        }
        if !(self.lens_radius >= 0.0 && self.lens_radius.is_finite()) {
            return Err(Error::invalid("lens radius", self.lens_radius, "must be finite and not negative"));
        }
        if !(self.focus > 0.0 && self.focus.is_finite()) {
            return Err(Error::invalid("focus distance", self.focus, "must be positive and finite"));
        }
        Ok(())
    }

    /// What is needed for every ray of an image of this shape.
    pub(crate) fn ready(&self, width: usize, height: usize) -> View {
        let forward = self.forward.normalize();
        let right = forward.cross(&self.up).normalize();
        let up = right.cross(&forward);
        let half = (self.degrees.to_radians() / 2.0).tan();
        let pixel = 2.0 * half / height as f64;
        let corner = forward - right * (half * width as f64 / height as f64) + up * half;
        View {
            eye: self.eye,
            forward,
            corner,
            right: right * pixel,
            down: -up * pixel,
            lens: [right, up].map(|v| v * self.lens_radius),
            focus: self.focus,
        }
    }
}

/// A camera with its image plane at distance 1.
#[derive(Clone, Copy, Debug)]
pub(crate) struct View {
    eye: Vec3,
    forward: Vec3,
    corner: Vec3,
    /// one pixel
    right: Vec3,
    down: Vec3,
    lens: [Vec3; 2],
    focus: f64,
}

impl View {
    /// The ray through pixel coordinates (x, y), counted from the top left corner, and its unit direction.
    #[inline]
    pub(crate) fn pinhole(&self, [x, y]: [f64; 2]) -> (Ray, Vec3) {
        let direction = (self.corner + self.right * x + self.down * y).normalize();
        (Ray::new(self.eye.into(), direction.into()), direction)
    }

    /// The same from a point of the lens.
    #[inline]
    pub(crate) fn thin_lens(&self, [x, y]: [f64; 2], u: [f64; 2]) -> (Ray, Vec3) {
        let sharp = self.eye + (self.corner + self.right * x + self.down * y) * self.focus;
        let from = self.lens_point(u);
        let direction = (sharp - from).normalize();
        (Ray::new(from.into(), direction.into()), direction)
    }

    /// The pinhole, or the middle of the lens.
    #[inline]
    pub(crate) fn eye(&self) -> Vec3 {
        self.eye
    }

    /// A point of the lens, uniform.
    #[inline]
    pub(crate) fn lens_point(&self, u: [f64; 2]) -> Vec3 {
        let [a, b] = UniformDisk.sample(u);
        self.eye + self.lens[0] * a + self.lens[1] * b
    }

    /// Where light that leaves p meets the lens.
    #[inline]
    pub(crate) fn lens_along(&self, p: &Vec3, direction: &Vec3) -> Vec3 {
        if self.lens == [Vec3::zeros(); 2] {
            return self.eye;
        }
        p + direction * ((self.eye - p).dot(&self.forward) / direction.dot(&self.forward))
    }

    /// The pixel coordinates that `from`, a point of the lens, sees in a direction, and their density per solid angle.
    #[inline]
    pub(crate) fn project(&self, from: &Vec3, direction: &Vec3) -> Option<([f64; 2], f64)> {
        let cosine = direction.dot(&self.forward);
        if !(cosine > 0.0) {
            return None;
        }
        // from the corner of the image plane at distance 1
        let plane = (from - self.eye) / self.focus + direction / cosine - self.corner;
        let area = self.right.norm_squared();
        let at = [self.right, self.down].map(|axis| plane.dot(&axis) / area);
        Some((at, 1.0 / (area * cosine * cosine * cosine)))
    }
}
