//! Light is a Fredholm equation: this file ties the two together, and there is no other.
//!
//! ```text
//! L(x) = Lₑ(x) + ∫ K(x, y) L(y) dμ(y)                    x = (point, outgoing direction)              Kajiya (1986)
//! K(x, y) = f(ωₒ, ωᵢ) |cos θₓ| |cos θ_y|/r² V(x, y)      ωᵢ from x to y, ωₒ that of x; y sends its light along −ωᵢ
//! ```
//!
//! μ is area on surfaces (on the environment solid angle, where |cos θ_y|/r² is 1; on lights without extent counting, where cos θ_y is 1). L is the
//! radiance over n². What theory calls
//!
//! - a step, is to draw ωᵢ by the scattering law and to trace the ray: π(x, y) = pdf(ωᵢ) |cos θ_y|/r²;
//! - a next event, is to connect x to a point of a light;
//! - a Dirac part of the kernel, is a mirror or clear glass.
//!
//! *What walks from the eye cannot find*: light of points and directions that comes through mirrors or clear glass, for it is neither hit nor connected.
//! Their images lack these caustics; [`Forward`](crate::Forward) and [`Bidirectional`](crate::Bidirectional) have them.
//!
//! So `Walk::mis()` on this equation is the path tracer of Veach (1997), and this module has no integrator.

use super::counters::{Counters, count};
use super::frame::{Frame, Vec3};
use super::geometry::Surface;
use super::local::{Connection, Local};
use super::material::{Bsdf, Sides};
use super::state::{Place, State};
use super::{Inner, Rgb, Scene};
use crate::domain::Node;
use crate::equation::Equation;
use crate::kernel::{Absorbing, Kernel, Operator, Step, Transition, TransitionPdf};
use crate::sampling::Sampler;
use crate::source::{SampleSource, Source};
use crate::value::{Value, Weight};
use std::sync::Arc;

/// The source Lₑ: what surfaces, environment and lights without extent emit.
#[derive(Clone, Debug)]
pub struct Emission(pub(super) Arc<Inner>, Option<Arc<Counters>>);

/// The kernel K: one reflection or refraction, and the flight to the next surface.
#[derive(Clone, Debug)]
pub struct LightTransport(pub(super) Arc<Inner>, Option<Arc<Counters>>);

impl Scene {
    /// The equation of light in this scene.
    #[must_use]
    pub fn light_transport(&self) -> Equation<Emission, LightTransport> {
        self.transport(None)
    }

    pub(super) fn transport(&self, counters: Option<Arc<Counters>>) -> Equation<Emission, LightTransport> {
        Equation::new(Emission(self.0.clone(), counters.clone()), LightTransport(self.0.clone(), counters))
    }
}

impl Inner {
    /// How x scatters; `None` where nothing does: outside, on black backs.
    #[inline]
    pub(super) fn local(&self, x: &State) -> Option<Local> {
        let Place::Surface(primitive) = x.place else { return None };
        let facet = &self.facets[primitive as usize];
        let material = &self.materials[facet.material as usize];
        let outgoing = Vec3::from(x.outgoing);
        let front = facet.normal(x);
        let mut smooth = self.smooth_normal(facet, x, &front);
        let mut normal = front;
        if outgoing.dot(&front) <= 0.0 && !facet.transmits {
            if material.sides == Sides::Front {
                return None;
            }
            (normal, smooth) = (-normal, -smooth);
        }
        // seen from behind the interpolated normal: the true one has to do
        let smooth = if outgoing.dot(&smooth) * outgoing.dot(&normal) > 0.0 { smooth } else { normal };
        Some(Local { bsdf: material.at(|| self.texcoord(facet, x)), outgoing, normal, smooth })
    }

    #[inline]
    pub(super) fn connection(&self, x: &State, y: &State) -> Option<Connection> {
        let outwards = || -Vec3::from(y.outgoing);
        let across = || {
            let d = Vec3::from(y.position) - Vec3::from(x.position);
            let r2 = d.norm_squared();
            (r2 > 0.0).then(|| (d / r2.sqrt(), r2))
        };
        match y.place {
            Place::Surface(primitive) => {
                let (direction, r2) = across()?;
                let cosine = self.facets[primitive as usize].normal(y).dot(&direction).abs();
                Some(Connection { direction, solid_angle: cosine / r2 })
            }
            Place::Light(light) if (light as usize) < self.lights.local.len() => {
                let (direction, r2) = across()?;
                Some(Connection { direction, solid_angle: 1.0 / r2 })
            }
            Place::Light(_) | Place::Environment => Some(Connection { direction: outwards(), solid_angle: 1.0 }),
            Place::Void => None,
        }
    }

    /// V(x, y).
    #[inline]
    fn visible(&self, x: &State, y: &State, direction: &Vec3) -> bool {
        let Place::Surface(primitive) = x.place else { return false };
        let aim = |from: &Surface| match y.place {
            Place::Surface(primitive) => from.segment_to(&self.surface(primitive, y)),
            Place::Light(light) if (light as usize) < self.lights.local.len() => from.segment_to_point(y.position),
            _ => from.spawn((*direction).into()),
        };
        self.clear(aim(&self.surface(primitive, x)), direction, aim)
    }

    /// A point of a primitive with the rounding error of its position.
    #[inline]
    pub(super) fn surface(&self, primitive: u32, x: &State) -> Surface {
        let facet = &self.facets[primitive as usize];
        let (u, v) = (f64::from(x.u), f64::from(x.v));
        Surface { position: x.position, error: facet.error, normal: facet.normal(x).into(), primitive, u, v }
    }

    /// The side that light can come from: zero if it can from all around.
    #[inline]
    fn receiving(&self, local: &Local) -> Vec3 {
        if local.bsdf.transmits() { Vec3::zeros() } else { local.normal }
    }
}

impl Source for Emission {
    type Point = State;
    type Value = Rgb;

    #[inline]
    fn eval(&self, x: &State) -> Rgb {
        let scene = &*self.0;
        match x.place {
            Place::Surface(primitive) => {
                let facet = &scene.facets[primitive as usize];
                if facet.light == super::NONE || Vec3::from(x.outgoing).dot(&facet.normal(x)) <= 0.0 {
                    return Rgb::ZERO;
                }
                scene.materials[facet.material as usize].radiance(|| scene.texcoord(facet, x))
            }
            Place::Environment => scene.environment.as_ref().map_or(Rgb::ZERO, |e| e.radiance(x.outgoing.map(|c| -c))),
            Place::Light(light) => {
                let share = scene.lights.point(light).map_or(1.0, |p| p.share(&x.outgoing.into()));
                scene.lights.punctual(light).scale(share)
            }
            Place::Void => Rgb::ZERO,
        }
    }
}

impl SampleSource for Emission {
    /// Nothing is drawn for mirrors, clear glass and black backs, nor where all lights face away.
    #[inline]
    fn sample_for<S: Sampler>(&self, x: &State, u: &mut S) -> Option<Node<State>> {
        let Emission(scene, counters) = self;
        let Some(local) = scene.local(x).filter(|l| !l.bsdf.is_singular()) else {
            count(counters, |c| &c.mirrors);
            return None;
        };
        let event = scene.lights.sample(&x.position.into(), &scene.receiving(&local), scene.environment.as_ref(), u);
        if event.is_none() {
            count(counters, |c| &c.unseen);
        }
        event
    }

    #[inline]
    fn pdf_for(&self, x: &State, y: &State) -> f64 {
        let scene = &*self.0;
        let light = match y.place {
            Place::Surface(primitive) => scene.facets[primitive as usize].light,
            Place::Light(light) => light,
            Place::Environment | Place::Void => super::NONE,
        };
        if light == super::NONE && y.place != Place::Environment {
            return 0.0;
        }
        let Some(local) = scene.local(x).filter(|l| !l.bsdf.is_singular()) else { return 0.0 };
        match (&scene.environment, y.place) {
            (Some(environment), Place::Environment) => scene.lights.pdf_remote(environment.pdf(&-Vec3::from(y.outgoing))),
            (None, Place::Environment) => 0.0,
            _ if light as usize >= scene.lights.local.len() => scene.lights.pdf_remote(1.0),
            _ => scene.lights.pdf_local(&x.position.into(), &scene.receiving(&local), light, y),
        }
    }
}

impl Operator for LightTransport {
    type Point = State;
    type Weight = Rgb;
}

impl LightTransport {
    /// K(x, y) and what it is made of, if it is not 0. Everything that can be 0 is asked before the shadow ray.
    #[inline]
    fn lit(&self, x: &State, y: &State) -> Option<(Rgb, Local, Connection)> {
        let LightTransport(scene, counters) = self;
        let (local, way) = (scene.local(x)?, scene.connection(x, y)?);
        let value = local.value(&way.direction).scaled(way.solid_angle);
        if value == Rgb::ZERO {
            count(counters, |c| &c.dark);
            return None;
        }
        count(counters, |c| &c.shadow_rays);
        if scene.visible(x, y, &way.direction) {
            return Some((value, local, way));
        }
        count(counters, |c| &c.blocked);
        None
    }
}

impl Kernel for LightTransport {
    #[inline]
    fn eval(&self, x: &State, y: &State) -> Rgb {
        self.lit(x, y).map_or(Rgb::ZERO, |lit| lit.0)
    }
}

impl Transition for LightTransport {
    /// ωᵢ by the scattering law, then the ray. Rays that meet nothing end in the environment, or in the void.
    #[inline]
    fn step<S: Sampler>(&self, x: &State, u: &mut S) -> Option<Step<State, Rgb>> {
        let (local, Place::Surface(primitive)) = (self.0.local(x)?, x.place) else { return None };
        let frame = Frame::around(local.smooth);
        let ray = local.bsdf.scatter(&frame.to_local(&local.outgoing), u)?;
        let direction = frame.to_world(&ray.incoming);
        if ray.weight == Rgb::ZERO || !local.agree(&direction) {
            return Some(Step::regular(State::VOID, Rgb::ZERO));
        }
        count(&self.1, |c| &c.rays);
        let point = self.0.trace(&self.0.surface(primitive, x).spawn(direction.into()), &direction);
        Some(if ray.pdf == f64::INFINITY { Step::singular(point, ray.weight) } else { Step::regular(point, ray.weight) })
    }
}

impl TransitionPdf for LightTransport {
    /// For y that x can see; elsewhere K is 0 whatever the density.
    #[inline]
    fn pdf(&self, x: &State, y: &State) -> f64 {
        let Some(local) = self.0.local(x) else { return 0.0 };
        self.0.connection(x, y).map_or(0.0, |way| local.pdf(y, &way))
    }

    #[inline]
    fn eval_and_pdf(&self, x: &State, y: &State) -> (Rgb, f64) {
        self.lit(x, y).map_or((Rgb::ZERO, 0.0), |(k, local, way)| (k, local.pdf(y, &way)))
    }
}

impl Absorbing for LightTransport {
    /// 1 outside and on black surfaces, 0 elsewhere: what scatters less than it gets says so in the weight.
    fn absorption(&self, x: &State) -> f64 {
        self.0.local(x).map_or(1.0, |l| f64::from(u8::from(l.bsdf == Bsdf::Black)))
    }
}
