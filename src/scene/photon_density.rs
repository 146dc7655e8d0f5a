//! Photon density: the radiance of surfaces from the photons that arrive near by.
//!
//! ```text
//! L(x) ≈ Lₑ(x) + 1/(πr²) Σ_{|z − x| < r} f*(ωᵢ → ωₓ) W            z, ωᵢ, W the photons of forward walks on the side of x
//! ```
//!
//! *Derivation.* W f* is the light that leaves z towards ωₓ, per area across: summed over photons its expectation is ∫ (T L)(z, ωₓ) dz (theory (4.6.1)). So
//! this is exactly the mean of T L over a disk around x, which is *biased*: shadows and caustics are blurred over r, and near edges and on curved surfaces less than
//! a disk is there. The bias vanishes as r², the variance grows as 1/r².
//!
//! *Wins* where light reaches a surface through mirrors or clear glass and is seen through others: no unbiased method of this crate finds such paths if the
//! lamp is small, and none if it is a point. *Fails* where a disk is not a disk, and for sharp images at small cost.
//!
//! Jensen, *Global illumination using photon maps* (1996); with the points that are seen as the map: Havran, Herzog, Seidel, *Fast final gathering via reverse
//! photon mapping*, Comput. Graph. Forum 24 (2005) 323.

use super::frame::Vec3;
use super::light_transport::{Emission, LightTransport};
use super::material::Bsdf;
use super::photon::Photon;
use super::state::{Place, State};
use super::{Film, Image, Rgb};
use crate::detector::{Detector, Score, Start};
use crate::equation::{Equation, Method};
use crate::error::Error;
use crate::kernel::Transition;
use crate::parallel;
use crate::sampling::{Pcg, Purpose, Sampler, Sequence};
use crate::source::Source;
use crate::statistics::{Bias, Estimate, Moments, Pooled};
use crate::value::{Value, Weight};
use crate::walk::{Collided, Forward, Roulette};
use std::collections::HashMap;
use std::f64::consts::PI;
use std::time::Instant;

/// Images by photon density; see the head of this file for formula and bias.
///
/// Defaults: 16 images of 65 536 photons each, 4 rays a pixel, seed 0. Every image has its own photons and its own rays, so that the error, from
/// the spread of the images, holds for both; the bias is not in it.
///
/// ```
/// use fredholm::scene::{Camera, Material, PhotonDensity, Scene, shapes};
/// // in a glowing room of albedo ½ a disk in the middle of a wall sees what its centre does: L = 1/(1 − ½)
/// let mut scene = Scene::builder();
/// let wall = scene.material(Material::diffuse([0.5; 3]).emitting([1.0; 3]));
/// scene.mesh(shapes::room([-1.0; 3], [1.0; 3])?, wall)?;
/// let scene = scene.build()?;
/// let film = scene.film(Camera::look_at([0.0; 3], [1.0, 0.0, 0.0]).field_of_view(30.0), 1, 1);
/// let found = scene.light_transport().seen_by(&film).solve(&PhotonDensity::new(0.4).photons(1 << 10))?;
/// assert!(found.image[(0, 0)].agrees_with(fredholm::Spectrum([2.0; 3]), 5.0));
/// assert_eq!(found.bias.to_string(), "biased: smoothed over ± 0.400");
/// # Ok::<(), fredholm::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[must_use]
pub struct PhotonDensity {
    radius: f64,
    photons: u64,
    rays: u64,
    images: u32,
    seed: u64,
}

/// What photon density finds.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct PhotonImage {
    /// Its errors are those of photons and rays alone.
    pub image: Image<Estimate<Rgb>>,
    /// What the values estimate instead of radiance.
    pub bias: Bias,
}

impl PhotonDensity {
    /// With disks of this radius.
    pub fn new(radius: f64) -> Self {
        PhotonDensity { radius, photons: 1 << 16, rays: 4, images: 16, seed: 0 }
    }

    /// Photons that start, in each image.
    pub fn photons(self, photons: u64) -> Self {
        PhotonDensity { photons, ..self }
    }

    /// Rays through a pixel, in each image.
    pub fn rays_per_pixel(self, rays: u64) -> Self {
        PhotonDensity { rays, ..self }
    }

    /// Independent images, of which the mean is taken.
    pub fn images(self, images: u32) -> Self {
        PhotonDensity { images, ..self }
    }

    /// Sets the seed.
    pub fn seed(self, seed: u64) -> Self {
        PhotonDensity { seed, ..self }
    }

    fn validate(&self) -> Result<(), Error> {
        if !(self.radius > 0.0 && self.radius.is_finite()) {
            return Err(Error::invalid("radius", self.radius, "must be positive and finite"));
        }
        let counts = [("photons", self.photons), ("rays per pixel", self.rays), ("images", u64::from(self.images))];
        match counts.iter().find(|c| c.1 == 0) {
            Some((parameter, _)) => Err(Error::invalid(parameter, 0.0, "must be at least 1")),
            None => Ok(()),
        }
    }

    /// One image: value, steps and evaluations of each pixel.
    fn image(&self, equation: &Equation<Emission, LightTransport>, film: &Film, number: u32) -> Result<Vec<(Rgb, u64, u64)>, Error> {
        let (points, emitted) = Seen::from(self, equation, film, number)?;
        // each image has photons of its own, seeded by a cell that no ray of the film reads
        let seed = Pcg::new(self.seed).point(u64::MAX, number, 0).next_1d().to_bits();
        let forward = Forward::scoring(Collided, Roulette::throughput(1.0)).walks(self.photons).seed(seed);
        let found = equation.seen_by(&points).solve(&forward)?;
        Ok(found.iter().zip(emitted).map(|(f, e)| (f.value + e, f.steps, f.evaluations)).collect())
    }
}

impl Method<Emission, LightTransport, Film> for PhotonDensity {
    type Solution = PhotonImage;

    fn solve(&self, equation: &Equation<Emission, LightTransport>, film: &Film) -> Result<PhotonImage, Error> {
        let clock = Instant::now();
        self.validate()?;
        film.validate()?;
        let images = (0..self.images).map(|i| self.image(equation, film, i)).collect::<Result<Vec<_>, Error>>()?;
        let elapsed = clock.elapsed();
        let pixel = |cell: usize| {
            let values: Vec<Rgb> = images.iter().map(|image| image[cell].0).collect();
            let (steps, evaluations) = images.iter().fold((0, 0), |(s, e), image| (s + image[cell].1, e + image[cell].2));
            let Pooled { moments, std_error, degrees_of_freedom } = Pooled::independent(&[Moments::from_scores(&values)]);
            let value = moments.mean;
            Estimate { value, std_error, degrees_of_freedom, moments, tail: None, steps, evaluations, truncation: None, elapsed }
        };
        let image = film.answer((0..film.cells()).map(pixel).collect());
        Ok(PhotonImage { image, bias: Bias::Smoothing { bandwidth: self.radius } })
    }
}

/// A point that a pixel sees, perhaps through mirrors.
#[derive(Clone, Debug)]
struct Spot {
    cell: usize,
    position: Vec3,
    outgoing: Vec3,
    /// true unit normal on the side of `outgoing`
    normal: Vec3,
    weight: Rgb,
}

/// All points that a film sees, in a grid whose boxes are as wide as a disk.
#[derive(Debug)]
struct Seen<'a> {
    film: &'a Film,
    radius: f64,
    spots: Vec<Spot>,
    grid: HashMap<[i64; 3], Vec<u32>>,
}

/// Mirrors that a ray may meet one after the other.
const MIRRORS: u64 = 1000;

/// What a ray of the camera sees before it comes to a surface that is no mirror, and that surface.
fn look<S: Sampler>(
    equation: &Equation<Emission, LightTransport>,
    film: &Film,
    (cell, ray): (usize, u64),
    u: &mut S,
) -> Result<(Rgb, Option<Spot>), Error> {
    let (mut x, mut weight, mut emitted) = (film.start(cell, u).point, Rgb::ONE, Rgb::ZERO);
    for vertex in 0..MIRRORS {
        emitted += weight.apply(equation.source().eval(&x));
        let Some(local) = equation.kernel().0.local(&x).filter(|l| l.bsdf != Bsdf::Black) else { return Ok((emitted, None)) };
        if !local.bsdf.is_singular() {
            let facing = local.normal * local.normal.dot(&local.outgoing).signum();
            return Ok((emitted, Some(Spot { cell, position: x.position.into(), outgoing: local.outgoing, normal: facing, weight })));
        }
        u.seek(vertex, Purpose::Move);
        let Some(step) = equation.kernel().step(&x, u) else { return Ok((emitted, None)) };
        (x, weight) = (step.point(), weight.then(step.weight()));
        if weight == Rgb::ZERO {
            return Ok((emitted, None));
        }
    }
    Err(Error::WalkTooLong { cell, walk: ray, steps: MIRRORS })
}

impl<'a> Seen<'a> {
    /// The points of an image, and the mean emission of what each pixel sees.
    fn from(
        settings: &PhotonDensity,
        equation: &Equation<Emission, LightTransport>,
        film: &'a Film,
        number: u32,
    ) -> Result<(Self, Vec<Rgb>), Error> {
        let (rays, sequence) = (settings.rays, Pcg::new(settings.seed));
        let share = 1.0 / rays as f64;
        let cells = parallel::map(film.cells(), |cell| {
            let ray = |k| look(equation, film, (cell, k), &mut sequence.point(cell as u64, number, k));
            (0..rays).map(ray).collect::<Result<Vec<_>, Error>>()
        });
        let mut seen = Seen { film, radius: settings.radius, spots: Vec::new(), grid: HashMap::new() };
        let mut emitted = Vec::with_capacity(cells.len());
        for cell in cells {
            let cell = cell?;
            emitted.push(cell.iter().fold(Rgb::ZERO, |sum, ray| sum + ray.0).scale(share));
            cell.into_iter().filter_map(|ray| ray.1).for_each(|spot| seen.add(Spot { weight: spot.weight.scaled(share), ..spot }));
        }
        Ok((seen, emitted))
    }

    fn place(&self, p: Vec3) -> [i64; 3] {
        p.map(|c| (c / (2.0 * self.radius)).floor() as i64).into()
    }

    /// Into every box of the grid that the ball of the disk touches.
    fn add(&mut self, spot: Spot) {
        let r = Vec3::repeat(self.radius);
        let ([x, y, z], [i, j, k]) = (self.place(spot.position - r), self.place(spot.position + r));
        let number = self.spots.len() as u32;
        for place in (x..=i).flat_map(|x| (y..=j).flat_map(move |y| (z..=k).map(move |z| [x, y, z]))) {
            self.grid.entry(place).or_default().push(number);
        }
        self.spots.push(spot);
    }
}

impl Score<Photon, Rgb> for Seen<'_> {
    #[inline]
    fn score<S: Sampler>(&self, z: &Photon, load: Rgb, _: &mut S, mut add: impl FnMut(usize, Rgb)) {
        let (scene, Place::Surface(primitive)) = (&*self.film.scene.0, z.place) else { return };
        let position = Vec3::from(z.position);
        let Some(near) = self.grid.get(&self.place(position)) else { return };
        let square = self.radius * self.radius;
        for spot in near.iter().map(|i| &self.spots[*i as usize]) {
            if (spot.position - position).norm_squared() >= square {
                continue;
            }
            let y = z.seen(&spot.outgoing);
            let normal = scene.facets[primitive as usize].normal(&y);
            // round a corner, or on the other side, is not near
            if normal.dot(&spot.normal) * normal.dot(&spot.outgoing) <= 0.0 {
                continue;
            }
            let leaving = scene.leaving(z, &y);
            if leaving != Rgb::ZERO {
                add(spot.cell, spot.weight.then(leaving).apply(load).scale(1.0 / (PI * square)));
            }
        }
    }
}

impl Detector for Seen<'_> {
    type Point = State;
    type Answer<T> = Vec<T>;

    fn cells(&self) -> usize {
        self.film.cells()
    }

    /// Walks from the camera need no disks.
    fn start<S: Sampler>(&self, cell: usize, u: &mut S) -> Start<State> {
        self.film.start(cell, u)
    }

    fn answer<T>(&self, cells: Vec<T>) -> Vec<T> {
        cells
    }
}
