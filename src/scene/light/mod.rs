//! Where light comes from, and how a surface finds it.
//!
//! Emitting triangles, spheres and points are chosen by a [tree](tree::LightTree) that knows the receiving point; what is infinitely far away, an
//! [`Environment`] or a direction, is chosen with the same probability as the tree. Densities are with respect to the measure of the states: area
//! on surfaces, solid angle on the environment, counting on lights without extent.

mod births;
mod environment;
mod point;
mod sphere;
mod tree;
mod triangle;

pub(crate) use births::Births;
pub use environment::Environment;
pub(crate) use point::PointLight;
pub(crate) use sphere::SphereLight;
pub(crate) use triangle::TriangleLight;

use super::Rgb;
use super::frame::Vec3;
use super::state::{Place, State};
use crate::domain::Node;
use crate::sampling::Sampler;
use crate::value::Value;
use std::f64::consts::PI;
use tree::{LightBounds, LightTree};

/// A light at finite distance.
#[derive(Clone, Debug)]
pub(crate) enum Local {
    Triangle(u32, TriangleLight),
    Sphere(u32, SphereLight),
    Point(PointLight),
}

/// A light infinitely far away.
#[derive(Clone, Debug)]
pub(crate) enum Remote {
    /// Where it travels to, and the irradiance of a surface across it.
    Direction(Vec3, Rgb),
    Environment,
}

/// All lights of a scene.
#[derive(Clone, Debug, Default)]
pub(crate) struct Lights {
    pub(crate) local: Vec<Local>,
    pub(crate) remote: Vec<Remote>,
    tree: LightTree,
    /// probability of each remote light
    share: f64,
}

impl Lights {
    /// `power` of each local light: its brightest component.
    pub(crate) fn new(local: Vec<(Local, f64)>, remote: Vec<Remote>) -> Self {
        let bounds: Vec<LightBounds> = local.iter().map(|(light, power)| light.bounds(*power)).collect();
        let groups = remote.len() + usize::from(!local.is_empty());
        let local = local.into_iter().map(|(light, _)| light).collect();
        Lights { local, remote, tree: LightTree::new(&bounds), share: 1.0 / groups.max(1) as f64 }
    }

    /// Whether there is nothing to choose.
    fn is_single(&self) -> bool {
        self.local.len() + self.remote.len() == 1
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.local.is_empty() && self.remote.is_empty()
    }

    /// A point that may send light to x, whose normal is zero if light arrives from all around.
    #[inline]
    pub(crate) fn sample<S: Sampler>(&self, x: &Vec3, normal: &Vec3, environment: Option<&Environment>, u: &mut S) -> Option<Node<State>> {
        if self.is_empty() {
            return None;
        }
        let choice = if self.is_single() { 0.5 } else { u.next_1d() };
        let point = u.next_2d();
        let far = self.share * self.remote.len() as f64;
        if choice < far {
            let k = ((choice / self.share) as usize).min(self.remote.len() - 1);
            return self.remote(k, environment, point);
        }
        let (light, probability) = self.tree.sample(x, normal, (choice - far) / (1.0 - far))?;
        let node = self.local[light as usize].sample(light, x, point)?;
        Some(Node { weight: node.weight / (probability * (1.0 - far)), ..node })
    }

    fn remote(&self, k: usize, environment: Option<&Environment>, u: [f64; 2]) -> Option<Node<State>> {
        match &self.remote[k] {
            Remote::Environment => {
                let (direction, weight) = environment?.sample(u);
                Some(Node { point: State::environment(&direction), weight: weight / self.share })
            }
            Remote::Direction(direction, _) => {
                let place = Place::Light((self.local.len() + k) as u32);
                Some(Node { point: State { place, outgoing: (*direction).into(), ..State::VOID }, weight: 1.0 / self.share })
            }
        }
    }

    /// Density of `sample` at a point of local light `light`.
    #[inline]
    pub(crate) fn pdf_local(&self, x: &Vec3, normal: &Vec3, light: u32, y: &State) -> f64 {
        let within = self.local[light as usize].pdf(x, y);
        let chosen = if self.is_single() { 1.0 } else { self.tree.probability(x, normal, light) };
        chosen * (1.0 - self.share * self.remote.len() as f64) * within
    }

    /// Density of `sample` at a remote light of density `within`.
    #[inline]
    pub(crate) fn pdf_remote(&self, within: f64) -> f64 {
        self.share * within
    }

    /// The point that is light `light`, if it is one.
    #[inline]
    pub(crate) fn point(&self, light: u32) -> Option<&PointLight> {
        match self.local.get(light as usize) {
            Some(Local::Point(point)) => Some(point),
            _ => None,
        }
    }

    /// What a light without extent emits; in the middle of its beam, if it has one.
    pub(crate) fn punctual(&self, light: u32) -> Rgb {
        match (self.point(light), self.remote.get((light as usize).wrapping_sub(self.local.len()))) {
            (Some(point), _) => point.intensity,
            (None, Some(Remote::Direction(_, irradiance))) => *irradiance,
            _ => Rgb::ZERO,
        }
    }
}

impl Local {
    /// A state on this light, number `light`, whose light goes to x.
    #[inline]
    fn sample(&self, light: u32, x: &Vec3, u: [f64; 2]) -> Option<Node<State>> {
        let (place, position, coordinates, weight) = match self {
            Local::Triangle(primitive, t) => {
                // the back emits nothing
                let ([b, c], weight) = t.faces(x).then(|| t.sample(x, u)).flatten()?;
                (Place::Surface(*primitive), t.corner + t.sides[0] * b + t.sides[1] * c, [b, c], weight)
            }
            Local::Sphere(primitive, s) => {
                let (normal, weight) = s.faces(x).then(|| s.sample(x, u)).flatten()?;
                (Place::Surface(*primitive), s.centre + normal * s.radius, [0.0; 2], weight)
            }
            // beyond the beam is dark
            Local::Point(p) if p.share(&(x - p.position).normalize()) == 0.0 => return None,
            Local::Point(p) => (Place::Light(light), p.position, [0.0; 2], 1.0),
        };
        let outgoing = (x - position).normalize();
        let [u, v] = coordinates.map(|c| c as f32);
        Some(Node { point: State { place, u, v, position: position.into(), outgoing: outgoing.into() }, weight })
    }

    #[inline]
    fn pdf(&self, x: &Vec3, y: &State) -> f64 {
        let position = Vec3::from(y.position);
        match self {
            Local::Triangle(_, t) if t.faces(x) => t.pdf(x, &position),
            Local::Sphere(_, s) if s.faces(x) => s.pdf(x, &position, &((position - s.centre) / s.radius)),
            Local::Point(..) => 1.0,
            _ => 0.0,
        }
    }

    fn bounds(&self, power: f64) -> LightBounds {
        match self {
            Local::Triangle(_, t) => {
                let corners = [t.corner, t.corner + t.sides[0], t.corner + t.sides[1]];
                let (low, high) = corners[1..].iter().fold((corners[0], corners[0]), |(l, h), p| (l.inf(p), h.sup(p)));
                LightBounds { low, high, power, axis: t.normal, spread: 0.0 }
            }
            Local::Sphere(_, s) => {
                let r = Vec3::repeat(s.radius);
                LightBounds { low: s.centre - r, high: s.centre + r, power, axis: Vec3::z(), spread: PI }
            }
            Local::Point(p) => {
                // a beam is narrower than the half space that a surface lights
                let spread = if p.cosines[1] >= 0.0 { 0.0 } else { PI };
                LightBounds { low: p.position, high: p.position, power, axis: p.axis, spread }
            }
        }
    }
}
