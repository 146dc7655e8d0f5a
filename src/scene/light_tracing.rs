//! Light in the direction it travels: the adjoint of [`LightTransport`], and how both directions meet.
//!
//! ```text
//! W₀ = Φ(z₀)/q₀,    W_{n+1} = W_n f*(ωᵢ → ωₒ) |cos θₒ|/pdf(ωₒ)                          z = (point, direction that light comes from)
//! f*(ωᵢ → ωₒ) = f(ωₒ, ωᵢ) |ωᵢ·n_s|/|ωᵢ·n_g|                                              Veach (1997), §5.3
//! K(x, z) = f(x) |cos θₓ| |cos θ_z|/r² V · f*(z)                                          the edge that joins an eye walk with a light walk
//! ```
//!
//! Photons carry power: Φ is π Lₑ on surfaces, I₀ Ω at points, πR² L from outside, and where light starts f* is 1/π, s(ω)/Ω, 1/πR². n_g is the true
//! normal, n_s the one to shade with. The unknown is L/n², so that refraction multiplies a photon by (nᵢ/nₒ)².
//!
//! *Where both directions disagree*: eye walks that see the back of an interpolated normal shade with the true one, and light walks never choose such
//! directions by scattering. Light tracing alone is therefore dark where a camera looks past the horizon of interpolated normals after another scattering;
//! connections are not, and bidirectional weights give those paths to them.

use super::frame::{Frame, Vec3};
use super::geometry::Ray;
use super::material::Bsdf;
use super::photon::Photon;
use super::state::{Place, State};
use super::{Emission, Inner, LightTransport, NONE, Rgb};
use crate::error::Error;
use crate::kernel::{HasAdjoint, Kernel, Operator, Step, Transition, TransitionPdf};
use crate::sampling::Sampler;
use crate::sampling::distribution::{CosineHemisphere, Distribution};
use crate::source::{Birth, Emit, EmitPdf};
use crate::value::{Value, Weight};
use crate::walk::{Beyond, Connect};
use std::f64::consts::FRAC_1_PI;
use std::sync::Arc;

/// The kernel of light walks: one scattering, and the flight to the next surface.
#[derive(Clone, Debug)]
pub struct LightTracing(Arc<Inner>);

impl HasAdjoint for LightTransport {
    type Adjoint = LightTracing;
    fn adjoint(&self) -> Result<LightTracing, Error> {
        Ok(LightTracing(self.0.clone()))
    }
}

impl Emit for Emission {
    type State = Photon;

    /// A light by its power, then a point of it, or a direction from outside.
    #[inline]
    fn emit<S: Sampler>(&self, u: &mut S) -> Birth<Photon, Rgb> {
        let scene = &*self.0;
        match scene.births.sample(&scene.lights, scene.environment.as_ref(), u) {
            None => Birth { point: Photon::NOWHERE, weight: Rgb::ZERO },
            Some(born) => {
                let power = scene.front(&born.photon).scale(born.weight / scene.emitted_share(&born.photon));
                Birth { point: born.photon, weight: power }
            }
        }
    }
}

impl EmitPdf for Emission {
    #[inline]
    fn emit_pdf(&self, z: &Photon) -> f64 {
        let scene = &*self.0;
        match z.place {
            Place::Surface(primitive) => match scene.facets[primitive as usize].light {
                NONE => 0.0,
                light => scene.births.pdf_local(&scene.lights, light),
            },
            Place::Environment => {
                scene.environment.as_ref().map_or(0.0, |e| scene.births.pdf_environment(&scene.lights, e.pdf(&z.from.into())))
            }
            Place::Light(_) => f64::INFINITY,
            Place::Void => 0.0,
        }
    }
}

impl Inner {
    /// Lₑ of an emitting place, on the side that emits.
    #[inline]
    fn front(&self, z: &Photon) -> Rgb {
        match z.place {
            Place::Surface(primitive) => {
                let facet = &self.facets[primitive as usize];
                self.materials[facet.material as usize].radiance(|| self.texcoord(facet, &z.turned()))
            }
            Place::Environment => self.environment.as_ref().map_or(Rgb::ZERO, |e| e.radiance(z.from)),
            Place::Light(light) => self.lights.punctual(light),
            Place::Void => Rgb::ZERO,
        }
    }

    /// What radiance is to the power of a photon where it starts.
    #[inline]
    fn emitted_share(&self, z: &Photon) -> f64 {
        match z.place {
            Place::Surface(_) => FRAC_1_PI,
            Place::Light(light) => self.lights.point(light).map_or(1.0 / self.births.disk(), |p| 1.0 / p.solid_angle()),
            _ => 1.0 / self.births.disk(),
        }
    }

    /// f*: the part of a photon's power that leaves towards y, per area across and solid angle.
    #[inline]
    pub(super) fn leaving(&self, z: &Photon, y: &State) -> Rgb {
        let Place::Surface(primitive) = z.place else {
            let beam = match z.place {
                Place::Light(light) => self.lights.point(light).map_or(1.0, |p| p.share(&y.outgoing.into())),
                _ => 1.0,
            };
            return if z.emitted { Rgb::ONE.scaled(beam * self.emitted_share(z)) } else { Rgb::ZERO };
        };
        let normal = self.facets[primitive as usize].normal(y);
        if z.emitted {
            let front = normal.dot(&Vec3::from(y.outgoing)) > 0.0;
            return if front { Rgb::ONE.scaled(FRAC_1_PI) } else { Rgb::ZERO };
        }
        let from = Vec3::from(z.from);
        let (Some(local), cosine) = (self.local(y), normal.dot(&from).abs()) else { return Rgb::ZERO };
        let value = local.value(&from);
        if value == Rgb::ZERO { Rgb::ZERO } else { value.scaled(1.0 / cosine) }
    }

    /// Whether light leaves z towards y by Dirac parts alone, so that no connection finds it.
    #[inline]
    pub(super) fn mirrors(&self, z: &Photon, y: &State) -> bool {
        !z.emitted && self.local(y).is_some_and(|local| local.bsdf.is_singular() && local.bsdf != Bsdf::Black)
    }

    /// The photon at the end of its flight; `None` if it leaves the scene.
    #[inline]
    fn fly(&self, ray: &Ray, direction: &Vec3) -> Option<Photon> {
        self.meet(ray, direction).map(|state| Photon::arrived(&state, &-direction))
    }

    #[inline]
    fn emission_step<S: Sampler>(&self, z: &Photon, u: &mut S) -> Option<Step<Photon, Rgb>> {
        let (point, mut beam) = (u.next_2d(), 1.0);
        let (ray, direction) = match z.place {
            Place::Void => return None,
            Place::Surface(primitive) => {
                let surface = self.surface(primitive, &z.turned());
                let direction = Frame::around(surface.normal.into()).to_world(&CosineHemisphere.sample(point).into());
                (surface.spawn(direction.into()), direction)
            }
            Place::Light(light) if self.lights.point(light).is_some() => {
                let light = self.lights.point(light)?;
                let direction = light.sample(point);
                beam = light.share(&direction);
                (Ray::new(z.position, direction.into()), direction)
            }
            Place::Light(_) | Place::Environment => {
                let direction = -Vec3::from(z.from);
                (Ray::new(self.births.before(&direction, point).into(), direction.into()), direction)
            }
        };
        self.fly(&ray, &direction).map(|next| Step::regular(next, Rgb::ONE.scaled(beam)))
    }

    /// Directions are drawn as eye walks draw them, by reciprocity.
    #[inline]
    fn scattering_step<S: Sampler>(&self, z: &Photon, u: &mut S) -> Option<Step<Photon, Rgb>> {
        let (turned, Place::Surface(primitive)) = (z.turned(), z.place) else { return None };
        let local = self.local(&turned)?;
        let frame = Frame::around(local.smooth);
        let incident = frame.to_local(&local.outgoing);
        let ray = local.bsdf.scatter(&incident, u)?;
        let direction = frame.to_world(&ray.incoming);
        if ray.weight == Rgb::ZERO || !local.agree(&direction) {
            return None;
        }
        // eye walks choose the normal to shade with by ωₒ, this one by ωᵢ: where these differ, f(ωₒ, ωᵢ) = 0
        let smooth = self.facets[primitive as usize].detail != NONE;
        if smooth && self.local(&z.seen(&direction)).is_none_or(|other| other.smooth != local.smooth) {
            return None;
        }
        let across = incident.z * local.normal.dot(&direction) / (ray.incoming.z * local.normal.dot(&local.outgoing));
        let weight = ray.weight.scaled(across.abs() * local.bsdf.adjoint_factor(&incident, &ray.incoming));
        let next = self.fly(&self.surface(primitive, &turned).spawn(direction.into()), &direction)?;
        Some(if ray.pdf == f64::INFINITY { Step::singular(next, weight) } else { Step::regular(next, weight) })
    }

    /// Where y is as seen from x; 0 if nowhere else.
    #[inline]
    fn towards(&self, x: &State, y: &State) -> Vec3 {
        self.connection(x, y).map_or_else(Vec3::zeros, |c| c.direction)
    }
}

impl Operator for LightTracing {
    type Point = Photon;
    type Weight = Rgb;
}

impl Transition for LightTracing {
    /// A direction, then the ray. Photons that leave the scene are absorbed.
    #[inline]
    fn step<S: Sampler>(&self, z: &Photon, u: &mut S) -> Option<Step<Photon, Rgb>> {
        if z.emitted { self.0.emission_step(z, u) } else { self.0.scattering_step(z, u) }
    }
}

impl TransitionPdf for LightTracing {
    /// For places that z can see.
    #[inline]
    fn pdf(&self, z: &Photon, w: &Photon) -> f64 {
        let (scene, Place::Surface(primitive)) = (&*self.0, w.place) else { return 0.0 };
        let (here, there) = (z.turned(), w.turned());
        match z.place {
            Place::Surface(own) => scene.connection(&here, &there).map_or(0.0, |c| {
                let density = if z.emitted {
                    scene.facets[own as usize].normal(&here).dot(&c.direction).max(0.0) * FRAC_1_PI
                } else {
                    scene.local(&here).map_or(0.0, |local| local.density(&c.direction))
                };
                density * c.solid_angle
            }),
            Place::Light(light) if scene.lights.point(light).is_some() => scene.connection(&here, &there).map_or(0.0, |c| {
                let density = scene.lights.point(light).map_or(0.0, |p| p.pdf(&c.direction));
                density * c.solid_angle
            }),
            Place::Light(_) | Place::Environment => {
                scene.facets[primitive as usize].normal(&there).dot(&Vec3::from(z.from)).abs() / scene.births.disk()
            }
            Place::Void => 0.0,
        }
    }
}

impl Connect<LightTracing> for LightTransport {
    const LOOKS_BEYOND: bool = true;

    #[inline]
    fn join(&self, x: &State, z: &Photon) -> Rgb {
        let y = <Self as Connect<LightTracing>>::backward(self, z, Beyond::Other(x));
        let leaving = self.0.leaving(z, &y);
        if leaving == Rgb::ZERO { Rgb::ZERO } else { self.eval(x, &y).then(leaving) }
    }

    #[inline]
    fn forward(&self, x: &State, from: Beyond<'_, State, Photon>) -> Photon {
        match from {
            Beyond::Own(y) => Photon::arrived(x, &self.0.towards(x, y)),
            Beyond::Other(z) => Photon::arrived(x, &self.0.towards(x, &z.seen(&-Vec3::from(z.from)))),
            Beyond::Start => Photon::emitted(x),
        }
    }

    /// From nowhere, nothing is seen.
    #[inline]
    fn backward(&self, z: &Photon, from: Beyond<'_, Photon, State>) -> State {
        let to = match (z.place, from) {
            (Place::Environment | Place::Void, _) => return z.seen(&-Vec3::from(z.from)),
            (Place::Light(light), _) if light as usize >= self.0.lights.local.len() => return z.seen(&-Vec3::from(z.from)),
            (_, Beyond::Own(w)) => w.position,
            (_, Beyond::Other(x)) => x.position,
            (_, Beyond::Start) => return State::VOID,
        };
        let d = Vec3::from(to) - Vec3::from(z.position);
        let length = d.norm();
        z.seen(&if length > 0.0 { d / length } else { d })
    }
}
