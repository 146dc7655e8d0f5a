//! Scenes in code.

use super::frame::Vec3;
use super::geometry::{Geometry, Mesh, Shape, Sphere};
use super::light::{Births, Lights, Local, PointLight, Remote, SphereLight, TriangleLight};
use super::material::{Bsdf, Law, Material};
use super::{Detail, Environment, Facet, FacetShape, Inner, NONE, Rgb, Scene};
use crate::error::Error;
use crate::value::{Value, Weight};
use std::f64::consts::PI;
use std::sync::Arc;

/// A material of a [`SceneBuilder`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MaterialId(u32);

/// What vertices of a mesh have beside their position.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Attributes {
    /// Normals to shade with; empty for flat triangles.
    pub normals: Vec<[f32; 3]>,
    /// Texture coordinates; empty if no texture is used.
    pub texcoords: Vec<[f32; 2]>,
}

/// Collects shapes, materials and lights. A shape that is there twice is stored twice: there are no instances.
///
/// ```
/// use fredholm::scene::{Material, Scene, Sides, shapes};
/// let mut scene = Scene::builder();
/// let grey = scene.material(Material::diffuse([0.5; 3]));
/// let lamp = scene.material(Material::diffuse([0.0; 3]).emitting([10.0; 3]).sides(Sides::Front));
/// scene.mesh(shapes::parallelogram([-1.0, 0.0, -1.0], [0.0, 0.0, 2.0], [2.0, 0.0, 0.0])?, grey)?;
/// scene.sphere([0.0, 3.0, 0.0], 0.5, lamp)?;
/// let scene = scene.build()?;
/// assert_eq!(scene.geometry().primitives(), 3);
/// # Ok::<(), fredholm::Error>(())
/// ```
#[derive(Clone, Debug, Default)]
#[must_use]
pub struct SceneBuilder {
    materials: Vec<Material>,
    shapes: Vec<(Shape, MaterialId, Attributes)>,
    points: Vec<PointLight>,
    directions: Vec<(Vec3, Rgb)>,
    environment: Option<Environment>,
}

impl SceneBuilder {
    /// Adds a material.
    pub fn material(&mut self, material: Material) -> MaterialId {
        self.materials.push(material);
        MaterialId(self.materials.len() as u32 - 1)
    }

    /// Adds a mesh of flat triangles.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a material of another builder.
    pub fn mesh(&mut self, mesh: Mesh, material: MaterialId) -> Result<(), Error> {
        self.add(mesh.into(), material, Attributes::default())
    }

    /// Adds a mesh with normals, texture coordinates, or both.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a material of another builder, attributes whose number is not that of the vertices, and numbers that are not finite.
    pub fn smooth_mesh(&mut self, mesh: Mesh, material: MaterialId, attributes: Attributes) -> Result<(), Error> {
        let vertices = mesh.vertices().len();
        for count in [attributes.normals.len(), attributes.texcoords.len()] {
            if count != 0 && count != vertices {
                return Err(Error::invalid("number of vertex attributes", count as f64, "must be that of the vertices, or 0"));
            }
        }
        let numbers = attributes.normals.iter().flatten().chain(attributes.texcoords.iter().flatten());
        if let Some(bad) = numbers.copied().find(|x| !x.is_finite()) {
            return Err(Error::invalid("vertex attribute", f64::from(bad), "must be finite"));
        }
        self.add(mesh.into(), material, attributes)
    }

    /// Adds a sphere.
    ///
    /// # Errors
    /// Those of [`Sphere::new`], and [`Error::Invalid`] for a material of another builder.
    pub fn sphere(&mut self, centre: [f64; 3], radius: f64, material: MaterialId) -> Result<(), Error> {
        self.add(Sphere::new(centre, radius)?.into(), material, Attributes::default())
    }

    fn add(&mut self, shape: Shape, material: MaterialId, attributes: Attributes) -> Result<(), Error> {
        if material.0 as usize >= self.materials.len() {
            return Err(Error::invalid("material", f64::from(material.0), "must be one of this builder's"));
        }
        self.shapes.push((shape, material, attributes));
        Ok(())
    }

    /// Adds a light without extent, of the same intensity in all directions. No ray hits it: only next events find it, so do not use
    /// `Walk::collision` with it; what comes through mirrors or clear glass is found by `Forward` and `Bidirectional` alone.
    ///
    /// # Errors
    /// [`Error::Invalid`] for coordinates that are not finite and intensities that are negative or not finite.
    pub fn point_light(&mut self, position: [f64; 3], intensity: [f64; 3]) -> Result<(), Error> {
        finite("position of a light", position)?;
        self.points.push(PointLight::all_around(position.into(), radiance("intensity", intensity)?));
        Ok(())
    }

    /// Adds a light without extent and with a beam along `direction`: full intensity within `inner` degrees from the axis, none beyond `outer`, and
    /// s² with s linear in the cosine between. Found as [`point_light`](Self::point_light).
    ///
    /// ```
    /// let mut scene = fredholm::scene::Scene::builder();
    /// scene.spot_light([0.0, 2.0, 0.0], [0.0, -1.0, 0.0], [5.0; 3], [20.0, 30.0])?;
    /// assert!(scene.spot_light([0.0; 3], [0.0, -1.0, 0.0], [5.0; 3], [40.0, 30.0]).is_err());
    /// # Ok::<(), fredholm::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Invalid`] for angles that are not 0 ≤ inner ≤ outer ≤ 90 with outer > 0, and as [`point_light`](Self::point_light) and
    /// [`directional_light`](Self::directional_light).
    pub fn spot_light(
        &mut self,
        position: [f64; 3],
        direction: [f64; 3],
        intensity: [f64; 3],
        [inner, outer]: [f64; 2],
    ) -> Result<(), Error> {
        finite("position of a light", position)?;
        if !(outer > 0.0 && outer <= 90.0) {
            return Err(Error::invalid("outer angle of a spot light", outer, "must lie in (0, 90] degrees"));
        }
        if !(inner >= 0.0 && inner <= outer) {
            return Err(Error::invalid("inner angle of a spot light", inner, "must lie between 0 and the outer angle"));
        }
        let (axis, intensity) = (unit(direction)?, radiance("intensity", intensity)?);
        let cosines = [inner, outer].map(|a| a.to_radians().cos());
        self.points.push(PointLight { position: position.into(), intensity, axis, cosines });
        Ok(())
    }

    /// Adds parallel light that travels in a direction; `irradiance` is that of a surface across it. Found only by next events, as
    /// [`point_light`](Self::point_light).
    ///
    /// # Errors
    /// [`Error::Invalid`] for a direction of no length and irradiances that are negative or not finite.
    pub fn directional_light(&mut self, direction: [f64; 3], irradiance: [f64; 3]) -> Result<(), Error> {
        finite("direction of a light", direction)?;
        self.directions.push((unit(direction)?, radiance("irradiance", irradiance)?));
        Ok(())
    }

    /// Sets what rays see that meet nothing.
    pub fn environment(&mut self, environment: Environment) {
        self.environment = Some(environment);
    }

    /// Whether nothing emits.
    #[must_use]
    pub fn is_dark(&self) -> bool {
        let glows = self.shapes.iter().any(|(_, material, _)| mean_emission(&self.materials[material.0 as usize]) != Rgb::ZERO);
        !glows && self.points.is_empty() && self.directions.is_empty() && self.environment.as_ref().is_none_or(Environment::is_black)
    }

    /// Checks everything, finds the lights, builds the tree.
    ///
    /// # Errors
    /// [`Error::Invalid`] naming what is wrong: albedos outside [0, 1], negative emission, …; [`Error::TooManyPrimitives`].
    pub fn build(self) -> Result<Scene, Error> {
        let SceneBuilder { mut materials, shapes, points, directions, environment } = self;
        materials.iter().try_for_each(Material::validate)?;
        materials.iter_mut().for_each(simplify);
        if let Some(e) = &environment {
            e.validate()?;
        }
        let environment = environment.filter(|e| !e.is_black());
        let geometry = Geometry::new(shapes.iter().map(|(shape, ..)| shape.clone()).collect())?;
        let mut parts = Parts { facets: Vec::with_capacity(geometry.primitives() as usize), details: Vec::new(), lights: Vec::new() };
        for (shape, material, attributes) in &shapes {
            parts.add(&geometry, shape, material.0, &materials[material.0 as usize], attributes);
        }
        let Parts { facets, details, mut lights } = parts;
        lights.extend(points.into_iter().map(|p| (Local::Point(p), p.solid_angle() * p.intensity.magnitude())));
        let remote = directions.into_iter().map(|(d, e)| Remote::Direction(d, e));
        let remote = remote.chain(environment.is_some().then_some(Remote::Environment)).collect();
        let power: Vec<f64> = lights.iter().map(|(_, power)| *power).collect();
        let total: f64 = power.iter().sum();
        if !total.is_finite() {
            return Err(Error::invalid("power of the lights", total, "must be finite"));
        }
        let lights = Lights::new(lights, remote);
        let births = Births::new(&lights, &power, environment.as_ref(), ball(&shapes));
        let holes = materials.iter().any(|m| m.mask.is_some());
        Ok(Scene(Arc::new(Inner { geometry, facets, details, materials, lights, births, environment, holes })))
    }
}

/// Centre and radius of a ball around all shapes, a little larger so that rounding leaves nothing outside.
fn ball(shapes: &[(Shape, MaterialId, Attributes)]) -> (Vec3, f64) {
    let boxes = || {
        shapes.iter().flat_map(|(shape, ..)| match shape {
            Shape::Mesh(mesh) => mesh.vertices().iter().map(|v| (Vec3::from(*v), 0.0)).collect(),
            Shape::Sphere(sphere) => vec![(Vec3::from(sphere.centre()), sphere.radius())],
        })
    };
    let far = Vec3::repeat(f64::INFINITY);
    let (low, high) = boxes().fold((far, -far), |(l, h), (p, r)| (l.inf(&(p - Vec3::repeat(r))), h.sup(&(p + Vec3::repeat(r)))));
    let centre = (low + high) / 2.0;
    let radius = boxes().fold(0.0, |m: f64, (p, r)| m.max((p - centre).norm() + r));
    if radius > 0.0 { (centre, radius * (1.0 + 1e-6)) } else { (Vec3::zeros(), 1.0) }
}

/// What shapes are turned into.
struct Parts {
    facets: Vec<Facet>,
    details: Vec<Detail>,
    lights: Vec<(Local, f64)>,
}

impl Parts {
    fn add(&mut self, geometry: &Geometry, shape: &Shape, number: u32, material: &Material, attributes: &Attributes) {
        let emission = mean_emission(material).magnitude();
        for k in 0..shape.primitives() {
            let primitive = self.facets.len() as u32;
            let (light, form) = match shape {
                Shape::Mesh(mesh) => {
                    let normal = mesh.normal(k).unwrap_or([0.0; 3]);
                    let light = || (Local::Triangle(primitive, TriangleLight::new(mesh.corners(k))), mesh.area(k));
                    // no ray hits a triangle without area, and it emits nothing
                    ((emission > 0.0 && mesh.normal(k).is_some()).then(light), FacetShape::Flat(normal.into()))
                }
                Shape::Sphere(sphere) => {
                    let (centre, radius) = (Vec3::from(sphere.centre()), sphere.radius());
                    let light = || (Local::Sphere(primitive, SphereLight { centre, radius }), 4.0 * PI * radius * radius);
                    ((emission > 0.0).then(light), FacetShape::Round(centre, 1.0 / radius))
                }
            };
            let facet = Facet {
                shape: form,
                error: worst_error(geometry, primitive),
                material: number,
                light: if light.is_some() { self.lights.len() as u32 } else { NONE },
                detail: self.detail(shape, k, attributes),
                transmits: material.transmits(),
            };
            self.facets.push(facet);
            self.lights.extend(light.map(|(light, area)| (light, PI * area * emission)));
        }
    }

    fn detail(&mut self, shape: &Shape, triangle: usize, attributes: &Attributes) -> u32 {
        let Shape::Mesh(mesh) = shape else { return NONE };
        if attributes.normals.is_empty() && attributes.texcoords.is_empty() {
            return NONE;
        }
        let corners = mesh.triangles()[triangle].map(|i| i as usize);
        let normals = (!attributes.normals.is_empty()).then(|| corners.map(|i| attributes.normals[i]));
        let texcoords = if attributes.texcoords.is_empty() { [[0.0; 2]; 3] } else { corners.map(|i| attributes.texcoords[i]) };
        self.details.push(Detail { normals, texcoords });
        self.details.len() as u32 - 1
    }
}

/// What is known of a law beforehand is not asked at every step.
fn simplify(material: &mut Material) {
    // a matt dielectric without a coat is Lambert's law
    if let Law::MetallicRoughness { base, metallic: 0.0, coat: Rgb::ZERO, grazing: 0.0, .. } = material.law {
        material.law = Law::Fixed(Bsdf::Lambertian { albedo: base });
    }
    // facets between equals bend nothing: light goes straight on, which is no density
    if let Law::Fixed(Bsdf::RoughDielectric { index: 1.0, tint, .. }) = material.law {
        material.law = Law::Fixed(Bsdf::Dielectric { index: 1.0, tint });
    }
    if let Law::Fixed(Bsdf::Lambertian { albedo: Rgb::ZERO } | Bsdf::Mirror { reflectance: Rgb::ZERO }) = material.law {
        material.law = Law::Fixed(Bsdf::Black);
    }
}

fn mean_emission(material: &Material) -> Rgb {
    let texture = material.textures.emission.as_ref().map_or(Rgb::ONE, |t| t.mean());
    material.emission.apply(texture)
}

/// Errors grow linearly between corners.
fn worst_error(geometry: &Geometry, primitive: u32) -> [f64; 3] {
    let corners = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]].map(|[u, v]| geometry.surface_at(primitive, u, v).error);
    std::array::from_fn(|i| corners.iter().fold(0.0, |m: f64, e| m.max(e[i])))
}

fn finite(parameter: &'static str, values: [f64; 3]) -> Result<(), Error> {
    values.iter().find(|v| !v.is_finite()).map_or(Ok(()), |v| Err(Error::invalid(parameter, *v, "must be finite")))
}

fn unit(direction: [f64; 3]) -> Result<Vec3, Error> {
    let length = Vec3::from(direction).norm();
    if length > 0.0 && length.is_finite() {
        Ok(Vec3::from(direction) / length)
    } else {
        Err(Error::invalid("length of a direction", length, "must be positive and finite"))
    }
}

fn radiance(parameter: &'static str, values: [f64; 3]) -> Result<Rgb, Error> {
    match values.iter().find(|v| !(**v >= 0.0 && v.is_finite())) {
        Some(v) => Err(Error::invalid(parameter, *v, "must be finite and not negative")),
        None => Ok(crate::Spectrum(values)),
    }
}
