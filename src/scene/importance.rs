//! The film as light walks see it: the way from a photon to a pixel.
//!
//! ```text
//! h_j(z) = φ(r − r_j)/(A_pixel cos³θ) |cos θ_z|/r²           φ the filter around the middle r_j of pixel j, r where the photon is seen;
//!                                                             A_pixel on the plane at distance 1; on the environment without |cos θ_z|/r²
//! ```
//!
//! ∫ h dμ over what the camera sees is 1, as the rays of a pixel have density h. Through a lens this holds for each of its points, drawn uniformly in both
//! directions. Veach (1997), §8.2; Pharr, Jakob, Humphreys, *Physically based rendering*, 3rd edition (2016), §16.1.

use super::frame::Vec3;
use super::geometry::{Ray, Surface};
use super::photon::Photon;
use super::state::{Place, State};
use super::{Film, Filter, Rgb};
use crate::detector::{Score, StartPdf};
use crate::sampling::Sampler;
use crate::value::{Value, Weight};
use crate::walk::{Meet, Met};
use std::f64::consts::TAU;
use std::ops::Range;

/// Box and Muller's logarithm of a double ends here, in units of σ: starts never come from further away.
const FARTHEST: f64 = 8.6;

impl Filter {
    /// φ per pixel area, at an offset from the middle of the pixel.
    #[inline]
    fn density(self, [x, y]: [f64; 2]) -> f64 {
        let each = |f: fn(f64, f64) -> f64, width: f64| f(x, width) * f(y, width);
        match self {
            Filter::Box => each(|x, _| f64::from(u8::from((-0.5..0.5).contains(&x))), 1.0),
            Filter::Tent(radius) => each(|x, r| (1.0 - x.abs() / r).max(0.0) / r, radius),
            Filter::Gaussian(sigma) => each(|x, s| (-0.5 * (x / s).powi(2)).exp() / (TAU.sqrt() * s), sigma),
        }
    }

    /// The pixels of a row of `count` whose filter reaches x.
    #[inline]
    fn reached(self, x: f64, count: usize) -> Range<usize> {
        let radius = match self {
            Filter::Box => 0.5,
            Filter::Tent(radius) => radius,
            Filter::Gaussian(sigma) => FARTHEST * sigma,
        };
        // middles within the radius
        let [first, last] = [(x - 0.5 - radius).ceil(), (x - 0.5 + radius).floor() + 1.0].map(|c| c.clamp(0.0, count as f64) as usize);
        first..last.max(first)
    }
}

/// A place of the film, seen along a direction.
struct Sight {
    /// pixel coordinates
    at: [f64; 2],
    /// dr/dμ
    scale: f64,
}

impl Film {
    /// Calls `each` with the pixels that see a place of the film, and φ.
    #[inline]
    fn pixels(&self, [x, y]: [f64; 2], mut each: impl FnMut(usize, f64)) {
        for row in self.filter.reached(y, self.height) {
            for column in self.filter.reached(x, self.width) {
                each(row * self.width + column, self.phi(row * self.width + column, [x, y]));
            }
        }
    }

    #[inline]
    fn phi(&self, cell: usize, [x, y]: [f64; 2]) -> f64 {
        self.filter.density([x - (cell % self.width) as f64 - 0.5, y - (cell / self.width) as f64 - 0.5])
    }

    /// x, whose light goes to `from` on the lens.
    #[inline]
    fn sight(&self, from: &Vec3, x: &State) -> Option<Sight> {
        let direction = -Vec3::from(x.outgoing);
        let (at, density) = self.view.project(from, &direction)?;
        let scale = match x.place {
            Place::Surface(primitive) => {
                let cosine = self.scene.0.facets[primitive as usize].normal(x).dot(&direction).abs();
                cosine / (Vec3::from(x.position) - from).norm_squared()
            }
            Place::Environment => 1.0,
            Place::Light(_) | Place::Void => return None,
        };
        Some(Sight { at, scale: density * scale })
    }

    /// The point of the lens that sees x.
    #[inline]
    fn lens_of(&self, x: &State) -> Vec3 {
        // a start in the environment keeps its lens point for a position
        let there = x.position.into();
        if x.place == Place::Environment { there } else { self.view.lens_along(&there, &x.outgoing.into()) }
    }

    /// z as the lens point `from` sees it, if nothing is between; `None` off the film.
    #[inline]
    fn look(&self, z: &Photon, from: &Vec3) -> Option<(State, Sight)> {
        let y = match z.place {
            Place::Environment => State { position: (*from).into(), ..z.seen(&-Vec3::from(z.from)) },
            Place::Surface(_) => z.seen(&(from - Vec3::from(z.position)).normalize()),
            // no ray hits lights without extent
            Place::Light(_) | Place::Void => return None,
        };
        let sight = self.sight(from, &y)?;
        let inside = |x: f64, count: usize| !self.filter.reached(x, count).is_empty();
        (inside(sight.at[0], self.width) && inside(sight.at[1], self.height)).then_some((y, sight))
    }

    #[inline]
    fn hidden(&self, z: &Photon, y: &State, from: &Vec3) -> bool {
        let scene = &*self.scene.0;
        !match z.place {
            Place::Surface(primitive) => {
                let aim = |at: &Surface| at.segment_to_point((*from).into());
                scene.clear(aim(&scene.surface(primitive, y)), &y.outgoing.into(), aim)
            }
            // from the camera to where light comes from
            _ => scene.clear(Ray::new((*from).into(), z.from), &z.from.into(), |at| at.spawn(z.from)),
        }
    }

    /// What leaves z, in all pixels that see it: one shadow ray, if it is not 0.
    #[inline]
    fn expose<S: Sampler>(&self, z: &Photon, u: &mut S, leaving: impl FnOnce(&State) -> Rgb, mut found: impl FnMut(Met<State, Rgb>)) {
        let from = if self.camera.has_lens() { self.view.lens_point(u.next_2d()) } else { self.view.eye() };
        let Some((point, Sight { at, scale })) = self.look(z, &from) else { return };
        let leaving = leaving(&point);
        if leaving == Rgb::ZERO || self.hidden(z, &point, &from) {
            return;
        }
        self.pixels(at, |cell, phi| {
            let pdf = scale * phi;
            found(Met { cell, point, score: leaving.scale(pdf), pdf });
        });
    }
}

impl StartPdf for Film {
    /// Through a lens: of the place, given the point of the lens.
    #[inline]
    fn start_pdf(&self, cell: usize, x: &State) -> f64 {
        self.sight(&self.lens_of(x), x).map_or(0.0, |s| s.scale * self.phi(cell, s.at))
    }

    #[inline]
    fn importance(&self, cell: usize, x: &State) -> f64 {
        self.start_pdf(cell, x)
    }

    #[inline]
    fn near(&self, x: &State, mut each: impl FnMut(usize)) {
        if let Some(sight) = self.sight(&self.lens_of(x), x) {
            self.pixels(sight.at, |cell, _| each(cell));
        }
    }
}

impl Meet<Photon, Rgb> for Film {
    #[inline]
    fn meet<S: Sampler>(&self, z: &Photon, load: Rgb, u: &mut S, found: impl FnMut(Met<State, Rgb>)) {
        self.expose(z, u, |y| self.scene.0.leaving(z, y).apply(load), found);
    }
}

/// Light tracing: every photon is seen by the camera.
///
/// What a mirror or clear glass sends there is not: no photon goes exactly to a pinhole, nor is one drawn to a point of a lens. Rather than dark pixels,
/// a photon on such a place in sight is an error that names it; [`Bidirectional`](crate::Bidirectional) gives these paths to walks from the camera, and
/// [`PhotonDensity`](super::PhotonDensity) looks through mirrors.
impl Score<Photon, Rgb> for Film {
    #[inline]
    fn score<S: Sampler>(&self, z: &Photon, load: Rgb, u: &mut S, mut add: impl FnMut(usize, Rgb)) {
        let scene = &*self.scene.0;
        let not_found = Rgb::from_components(|_| f64::NAN);
        let leaving = |y: &State| if scene.mirrors(z, y) { not_found } else { scene.leaving(z, y).apply(load) };
        self.expose(z, u, leaving, |Met { cell, score, .. }| add(cell, score));
    }

    fn refusal(&self, z: &Photon) -> Option<&'static str> {
        let why = "no connection finds the light that a mirror or clear glass sends to the camera; `Bidirectional` and `PhotonDensity` do";
        self.scene.0.mirrors(z, &z.turned()).then_some(why)
    }
}
