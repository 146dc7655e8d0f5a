//! Where light starts: a light chosen by power, a point or direction of it.
//!
//! ```text
//! Φ = π A ⟨Lₑ⟩ for a surface,   I Ω for a point with a beam of solid angle Ω,   πR² E and πR² ∫ L dω for light from outside, R the radius of a ball around the scene
//! ```
//!
//! A photon starts with the power Φ/q, q the density of its start: then scattering multiplies it by albedos, and roulette by throughput means the same
//! at every scale.

use super::{Environment, Lights, Local, Remote};
use crate::sampling::Sampler;
use crate::sampling::distribution::{Discrete, Distribution, UniformDisk, UniformSphere};
use crate::scene::frame::{Frame, Vec3};
use crate::scene::photon::Photon;
use crate::scene::state::{Place, State};
use crate::value::Value;
use std::f64::consts::PI;

/// Lights by power; see [`Lights`] for their numbers.
#[derive(Clone, Debug)]
pub(crate) struct Births {
    /// `None` in the dark
    table: Option<Discrete>,
    centre: Vec3,
    radius: f64,
}

/// A start: the photon and 1/q per area, solid angle or count.
pub(crate) struct Born {
    pub(crate) photon: Photon,
    pub(crate) weight: f64,
}

impl Births {
    /// `power` of each local light; the ball holds the scene.
    pub(crate) fn new(lights: &Lights, power: &[f64], environment: Option<&Environment>, (centre, radius): (Vec3, f64)) -> Self {
        let disk = PI * radius * radius;
        let remote = lights.remote.iter().map(|light| match light {
            Remote::Direction(_, irradiance) => disk * irradiance.magnitude(),
            Remote::Environment => environment.map_or(0.0, |e| {
                // directions are drawn by the brightest component: one tells the integral
                let (direction, weight) = e.sample([0.5; 2]);
                disk * weight * e.radiance(direction.into()).magnitude()
            }),
        });
        let power: Vec<f64> = power.iter().copied().chain(remote).collect();
        Births { table: Discrete::new(&power).ok(), centre, radius }
    }

    /// Area of the disk that light from outside comes through.
    #[inline]
    pub(crate) fn disk(&self) -> f64 {
        PI * self.radius * self.radius
    }

    /// A point of the disk across a direction, before the scene.
    #[inline]
    pub(crate) fn before(&self, direction: &Vec3, u: [f64; 2]) -> Vec3 {
        let [a, b] = UniformDisk.sample(u);
        self.centre + (Frame::around(*direction).to_world(&Vec3::new(a, b, -1.0))) * self.radius
    }

    #[inline]
    pub(crate) fn sample<S: Sampler>(&self, lights: &Lights, environment: Option<&Environment>, u: &mut S) -> Option<Born> {
        let table = self.table.as_ref()?;
        let (choice, point) = (u.next_1d(), u.next_2d());
        let (k, _) = table.split(choice);
        let chosen = 1.0 / table.pdf(&k);
        if let Some(light) = lights.local.get(k) {
            let (state, area) = light.point(k as u32, point);
            return Some(Born { photon: Photon::emitted(&state), weight: area * chosen });
        }
        let state = |place, outgoing: [f64; 3]| State { place, outgoing, ..State::VOID };
        match &lights.remote[k - lights.local.len()] {
            Remote::Direction(direction, _) => {
                Some(Born { photon: Photon::emitted(&state(Place::Light(k as u32), (*direction).into())), weight: chosen })
            }
            Remote::Environment => {
                let (direction, weight) = environment?.sample(point);
                Some(Born { photon: Photon::emitted(&State::environment(&direction)), weight: weight * chosen })
            }
        }
    }

    /// Density of a start at a point of local light `light`.
    #[inline]
    pub(crate) fn pdf_local(&self, lights: &Lights, light: u32) -> f64 {
        self.table.as_ref().map_or(0.0, |t| t.pdf(&(light as usize)) / lights.local[light as usize].area())
    }

    /// Density of a start in the environment, the last of the remote lights.
    #[inline]
    pub(crate) fn pdf_environment(&self, lights: &Lights, within: f64) -> f64 {
        self.table.as_ref().map_or(0.0, |t| t.pdf(&(lights.local.len() + lights.remote.len() - 1)) * within)
    }
}

impl Local {
    /// A point of this light, number `light`, uniform in its area, which comes with it; 1 for a light without extent.
    #[inline]
    fn point(&self, light: u32, [u, v]: [f64; 2]) -> (State, f64) {
        match self {
            Local::Triangle(primitive, t) => {
                let root = u.sqrt();
                let [b, c] = [root * (1.0 - v), root * v];
                let position = t.corner + t.sides[0] * b + t.sides[1] * c;
                let (u, v) = (b as f32, c as f32);
                (State { place: Place::Surface(*primitive), u, v, position: position.into(), ..State::VOID }, t.area)
            }
            Local::Sphere(primitive, s) => {
                let position = s.centre + Vec3::from(UniformSphere.sample([u, v])) * s.radius;
                (State { place: Place::Surface(*primitive), position: position.into(), ..State::VOID }, self.area())
            }
            Local::Point(p) => (State { place: Place::Light(light), position: p.position.into(), ..State::VOID }, 1.0),
        }
    }

    fn area(&self) -> f64 {
        match self {
            Local::Triangle(_, t) => t.area,
            Local::Sphere(_, s) => 4.0 * PI * s.radius * s.radius,
            Local::Point(..) => 1.0,
        }
    }
}
