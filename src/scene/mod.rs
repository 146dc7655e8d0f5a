//! Scenes: light as one more Fredholm equation.
//!
//! ```text
//! L = Lₑ + T L
//! ```
//!
//! | item | what it is |
//! |---|---|
//! | [`Scene`] | surfaces with materials, and lights; [`Scene::light_transport`] is its equation |
//! | [`LightTransport`], [`Emission`] | the kernel and the source: `Walk::mis()` on them *is* the path tracer |
//! | [`LightTracing`], [`Photon`] | the adjoint kernel and its states: [`Forward::new`](crate::Forward::new) is the light tracer, [`Bidirectional`](crate::Bidirectional) both |
//! | [`PhotonDensity`] | the density of forward walks on surfaces: biased by blur, and finds what nothing else does |
//! | [`Camera`], [`Film`] | the detector: a cell is a pixel |
//! | [`Image`] | the answer: an estimate for every pixel; PNG, EXR |
//! | [`Material`], [`Bsdf`] | how surfaces scatter |
//! | [`Environment`] | light from far away |
//! | [`Patches`], [`Radiosity`] | a diffuse scene as a linear system: the deterministic check |
//! | [`geometry`] | what a ray meets |
//!
//! The module has no integrator: every method of the crate works on the equation.
//!
//! ```
//! use fredholm::{Walk, scene::{Camera, Material, Scene, shapes}};
//! // in a glowing room of albedo ½: L = 1/(1 − ½) everywhere
//! let mut scene = Scene::builder();
//! let wall = scene.material(Material::diffuse([0.5; 3]).emitting([1.0; 3]));
//! scene.mesh(shapes::room([-1.0; 3], [1.0; 3])?, wall)?;
//! let scene = scene.build()?;
//! let film = scene.film(Camera::look_at([0.0; 3], [1.0, 0.2, 0.3]).field_of_view(90.0), 4, 4);
//! let image = scene.light_transport().seen_by(&film).solve(&Walk::mis().samples_per_cell(64))?;
//! assert!(image.pixels().iter().all(|p| p.agrees_with(fredholm::Spectrum([2.0; 3]), 6.0)));
//! # Ok::<(), fredholm::Error>(())
//! ```

mod builder;
mod camera;
mod counters;
mod film;
mod frame;
pub mod geometry;
mod image;
mod importance;
mod light;
mod light_tracing;
mod light_transport;
pub mod load;
mod local;
mod material;
mod photon;
mod photon_density;
mod picture;
mod radiosity;
pub mod shapes;
mod state;
mod texture;
pub(crate) mod vector;

pub use builder::{Attributes, MaterialId, SceneBuilder};
pub use camera::Camera;
pub use counters::Counters;
pub use film::{Film, Filter};
pub use image::Image;
pub use light::Environment;
pub use light_tracing::LightTracing;
pub use light_transport::{Emission, LightTransport};
pub use load::load;
pub use material::{Bsdf, Material, MetallicRoughness, Scattered, Sides, Textures};
pub use photon::Photon;
pub use photon_density::{PhotonDensity, PhotonImage};
pub use radiosity::{Patches, Radiosity};
pub use state::{Place, State};
pub use texture::Texture;

use crate::value::Spectrum;
use frame::Vec3;
use geometry::{Geometry, Hit, Ray, Shape, Surface};
use light::{Births, Lights};
use material::Law;
use std::fmt;
use std::sync::Arc;

/// Red, green and blue, linear.
pub type Rgb = Spectrum<3>;

/// Surfaces and lights, ready to be seen. A handle: copies share the scene.
#[derive(Clone, Debug)]
pub struct Scene(Arc<Inner>);

#[derive(Debug)]
struct Inner {
    geometry: Geometry,
    /// one for each primitive
    facets: Vec<Facet>,
    /// what triangles with normals or texture coordinates of their own have
    details: Vec<Detail>,
    materials: Vec<Material>,
    lights: Lights,
    births: Births,
    environment: Option<Environment>,
    /// whether any surface has holes
    holes: bool,
}

/// No light, no detail.
const NONE: u32 = u32::MAX;

/// What is known of a primitive.
#[derive(Clone, Copy, Debug)]
struct Facet {
    shape: FacetShape,
    /// bound of the rounding error of points on it
    error: [f64; 3],
    material: u32,
    light: u32,
    detail: u32,
    /// light passes through it
    transmits: bool,
}

#[derive(Clone, Copy, Debug)]
enum FacetShape {
    /// Unit normal.
    Flat(Vec3),
    /// Centre and 1/radius.
    Round(Vec3, f64),
}

/// Interpolated over a triangle.
#[derive(Clone, Copy, Debug)]
struct Detail {
    normals: Option<[[f32; 3]; 3]>,
    texcoords: [[f32; 2]; 3],
}

impl Facet {
    /// True unit normal on the front.
    #[inline]
    fn normal(&self, x: &State) -> Vec3 {
        match self.shape {
            FacetShape::Flat(normal) => normal,
            FacetShape::Round(centre, reciprocal) => (Vec3::from(x.position) - centre) * reciprocal,
        }
    }
}

impl Inner {
    /// The normal to shade with.
    #[inline]
    fn smooth_normal(&self, facet: &Facet, x: &State, flat: &Vec3) -> Vec3 {
        if facet.detail == NONE {
            return *flat;
        }
        let Some(normals) = &self.details[facet.detail as usize].normals else { return *flat };
        let [a, b, c] = normals.map(|n| Vec3::from(n.map(f64::from)));
        let (u, v) = (f64::from(x.u), f64::from(x.v));
        let n = (a * (1.0 - u - v) + b * u + c * v).normalize();
        // opposite normals may cancel
        if n.x.is_finite() { n } else { *flat }
    }

    #[inline]
    fn texcoord(&self, facet: &Facet, x: &State) -> [f64; 2] {
        let (u, v) = (f64::from(x.u), f64::from(x.v));
        if facet.detail == NONE {
            return [u, v];
        }
        let [a, b, c] = self.details[facet.detail as usize].texcoords;
        std::array::from_fn(|i| f64::from(a[i]) * (1.0 - u - v) + f64::from(b[i]) * u + f64::from(c[i]) * v)
    }

    /// What a ray of this unit direction meets, looking back along it.
    #[inline]
    fn trace(&self, ray: &Ray, direction: &Vec3) -> State {
        match self.meet(ray, direction) {
            Some(state) => state,
            None if self.environment.is_some() => State::environment(direction),
            None => State::VOID,
        }
    }

    /// The first surface on a ray, past holes.
    #[inline]
    fn meet(&self, ray: &Ray, direction: &Vec3) -> Option<State> {
        let mut state = self.state(ray, &self.geometry.closest(ray)?, direction);
        while let Some(primitive) = self.hole(&state) {
            let ray = self.surface(primitive, &state).spawn((*direction).into());
            state = self.state(&ray, &self.geometry.closest(&ray)?, direction);
        }
        Some(state)
    }

    /// Whether nothing but holes is on a ray; `aim` sends it on from such a place.
    #[inline]
    fn clear(&self, mut ray: Ray, direction: &Vec3, aim: impl Fn(&Surface) -> Ray) -> bool {
        if !self.holes {
            return !self.geometry.occluded(&ray);
        }
        while let Some(hit) = self.geometry.closest(&ray) {
            let state = self.state(&ray, &hit, direction);
            let Some(primitive) = self.hole(&state) else { return false };
            ray = aim(&self.surface(primitive, &state));
        }
        true
    }

    /// The primitive in whose hole x is, if it is in one.
    #[inline]
    fn hole(&self, x: &State) -> Option<u32> {
        let Place::Surface(primitive) = x.place else { return None };
        if !self.holes {
            return None;
        }
        let facet = &self.facets[primitive as usize];
        self.materials[facet.material as usize].is_hole(|| self.texcoord(facet, x)).then_some(primitive)
    }

    #[inline]
    fn state(&self, ray: &Ray, hit: &Hit, direction: &Vec3) -> State {
        let shape = self.geometry.shape_of(hit.primitive);
        let position = match &self.geometry.shapes()[shape] {
            Shape::Mesh(mesh) => {
                let [a, b, c] = mesh.corners((hit.primitive - self.geometry.first_of(shape)) as usize);
                std::array::from_fn(|i| (1.0 - hit.u - hit.v) * a[i] + hit.u * b[i] + hit.v * c[i])
            }
            Shape::Sphere(_) => self.geometry.surface(ray, hit).position,
        };
        State { place: Place::Surface(hit.primitive), u: hit.u as f32, v: hit.v as f32, position, outgoing: (-direction).into() }
    }
}

impl Scene {
    /// An empty scene, to be filled.
    pub fn builder() -> SceneBuilder {
        SceneBuilder::default()
    }

    /// A film of `width` × `height` pixels behind a camera, with a box filter.
    pub fn film(&self, camera: Camera, width: usize, height: usize) -> Film {
        Film::new(self.clone(), camera, width, height)
    }

    /// What is seen from a point in a direction.
    #[must_use]
    pub fn look(&self, from: [f64; 3], direction: [f64; 3]) -> State {
        let direction = Vec3::from(direction).normalize();
        self.0.trace(&Ray::new(from, direction.into()), &direction)
    }

    /// Whether there is light that walks from the camera neither hit nor connect to; see the head of `light_transport`.
    fn hides_caustics(&self) -> bool {
        let Inner { lights, materials, .. } = &*self.0;
        let count = (lights.local.len() + lights.remote.len()) as u32;
        let punctual = (0..count).any(|light| lights.punctual(light) != Rgb::default());
        punctual && materials.iter().any(|m| m.is_singular() && m.law != Law::Fixed(Bsdf::Black))
    }

    /// The geometry.
    #[must_use]
    pub fn geometry(&self) -> &Geometry {
        &self.0.geometry
    }
}

/// What there is, and what no walk in this scene will ever have to do.
impl fmt::Display for Scene {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Inner { geometry, materials, lights, details, holes, .. } = &*self.0;
        let (local, remote) = (lights.local.len(), lights.remote.len());
        write!(f, "{} primitives, {} materials, {local} lights near and {remote} far", geometry.primitives(), materials.len())?;
        for (skipped, why) in [
            (local + remote == 0, "no light: the image is black"),
            (local + remote == 1, "one light: none is chosen"),
            (!materials.iter().any(Material::textured), "no texture is fetched"),
            (!holes, "no alpha is tested"),
            (details.is_empty(), "all triangles are flat"),
            (materials.iter().all(Material::is_singular), "no diffuse surface: nothing is connected"),
            (self.hides_caustics(), "light of points and directions through mirrors or clear glass: no walk from the camera finds it"),
            (geometry.degenerate() > 0, "triangles without area are never hit"),
        ] {
            if skipped {
                write!(f, "; {why}")?;
            }
        }
        Ok(())
    }
}
