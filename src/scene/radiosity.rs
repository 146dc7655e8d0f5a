//! Radiosity: the Nyström method on a diffuse scene, as a check of the walks (Goral et al., *Modeling the interaction of light between diffuse
//! surfaces*, SIGGRAPH 1984).
//!
//! ```text
//! Lᵢ = eᵢ + Σⱼ Kᵢⱼ Lⱼ,     Kᵢⱼ = 1/Aᵢ ∫_{Aᵢ} ∫_{Aⱼ} K(x, y) dy dx
//! ```
//!
//! on patches i of constant radiance Lᵢ; K is the kernel of the walks, shadow ray and all. Both integrals are of degree 2; patches near x are cut until
//! they are small beside their distance. The error is that of the patches, of first order in their size, plus that of shadow boundaries: compare two sizes.

use super::frame::Vec3;
use super::geometry::{Geometry, Shape};
use super::light_transport::{Emission, LightTransport};
use super::material::{Bsdf, Law, Sides};
use super::{Place, Rgb, Scene, State};
use crate::detector::{Detector, Start};
use crate::deterministic::linear::Factor;
use crate::equation::{Equation, Method};
use crate::error::Error;
use crate::kernel::Kernel;
use crate::parallel;
use crate::sampling::Sampler;
use crate::source::Source;
use crate::value::Value;
use nalgebra::DVector;

/// The triangles of a scene, cut into small ones, each side that scatters or emits for itself: as a detector, the mean radiance that leaves each.
///
/// ```
/// use fredholm::{Walk, scene::{Material, Radiosity, Scene, Sides, shapes}};
/// let mut scene = Scene::builder();
/// let wall = scene.material(Material::diffuse([0.5; 3]).emitting([1.0; 3]).sides(Sides::Front));
/// scene.mesh(shapes::room([0.0; 3], [1.0; 3])?, wall)?;
/// let scene = scene.build()?;
/// let (equation, patches) = (scene.light_transport(), scene.patches(0.6)?);
/// let exact = equation.seen_by(&patches).solve(&Radiosity)?;
/// let walked = equation.seen_by(&patches).solve(&Walk::mis().samples_per_cell(256))?;
/// assert!(exact.iter().all(|l| (l[0] - 2.0).abs() < 0.02));
/// assert!(walked.iter().all(|l| l.agrees_with(fredholm::Spectrum([2.0; 3]), 6.0)));
/// # Ok::<(), fredholm::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Patches(Vec<Patch>);

/// A triangle of a triangle, seen from one side.
#[derive(Clone, Copy, Debug)]
struct Patch {
    primitive: u32,
    corners: [[f64; 3]; 3],
    /// barycentric coordinates of the corners in the primitive
    places: [[f64; 2]; 3],
    /// unit normal of the side
    normal: [f64; 3],
}

/// Solves for the radiance of [`Patches`] as one linear system a colour.
#[derive(Clone, Copy, Debug, Default)]
pub struct Radiosity;

/// More patches would need more than half a gigabyte.
const MOST: usize = 8192;
/// A patch is integrated over as three points if its longest side is at most this share of the distance.
const SMALL: f64 = 1.0;
/// Cuts of a patch that touches x.
const CUTS: u32 = 6;

impl Scene {
    /// Patches whose sides are at most `size` long.
    ///
    /// # Errors
    /// [`Error::Invalid`] for spheres and surfaces that are not of Lambert's law on all their points, for a size that is not positive, and for more than
    /// 8192 patches.
    pub fn patches(&self, size: f64) -> Result<Patches, Error> {
        if !(size > 0.0) {
            return Err(Error::invalid("size of patches", size, "must be positive"));
        }
        let mut patches = Vec::new();
        for primitive in 0..self.0.geometry.primitives() {
            let facet = &self.0.facets[primitive as usize];
            let material = &self.0.materials[facet.material as usize];
            if !matches!(material.law, Law::Fixed(Bsdf::Lambertian { .. } | Bsdf::Black))
                || material.textured()
                || facet.detail != super::NONE
            {
                return Err(Error::invalid("primitive", f64::from(primitive), "radiosity needs flat, untextured, diffuse surfaces"));
            }
            let Some((corners, normal)) = triangle(&self.0.geometry, primitive)? else { continue };
            let front = Patch { primitive, corners, places: [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]], normal };
            let back = Patch { normal: normal.map(|x| -x), ..front };
            let sides = [Some(front), (material.sides == Sides::Both && material.law != Law::Fixed(Bsdf::Black)).then_some(back)];
            for side in sides.into_iter().flatten() {
                side.cut_to(size, &mut patches);
                if patches.len() > MOST {
                    return Err(Error::invalid("size of patches", size, "gives more than 8192 patches"));
                }
            }
        }
        Ok(Patches(patches))
    }
}

/// Corners and normal; `None` without area.
fn triangle(geometry: &Geometry, primitive: u32) -> Result<Option<([[f64; 3]; 3], [f64; 3])>, Error> {
    let shape = geometry.shape_of(primitive);
    match &geometry.shapes()[shape] {
        Shape::Mesh(mesh) => {
            let k = (primitive - geometry.first_of(shape)) as usize;
            Ok(mesh.normal(k).map(|normal| (mesh.corners(k), normal)))
        }
        Shape::Sphere(_) => Err(Error::invalid("primitive", f64::from(primitive), "is a sphere; radiosity needs triangles")),
    }
}

impl Patch {
    fn side(&self) -> f64 {
        let [a, b, c] = self.corners.map(Vec3::from);
        (b - a).norm().max((c - b).norm()).max((a - c).norm())
    }

    fn area(&self) -> f64 {
        let [a, b, c] = self.corners.map(Vec3::from);
        0.5 * (b - a).cross(&(c - a)).norm()
    }

    /// The four triangles between corners and middles of sides.
    fn quarters(&self) -> [Patch; 4] {
        let middle = |i: usize, j: usize| (between(self.corners[i], self.corners[j]), between(self.places[i], self.places[j]));
        let corner = |i: usize| (self.corners[i], self.places[i]);
        let (ab, bc, ca) = (middle(0, 1), middle(1, 2), middle(2, 0));
        [[corner(0), ab, ca], [ab, corner(1), bc], [ca, bc, corner(2)], [bc, ca, ab]].map(|t| Patch {
            corners: t.map(|p| p.0),
            places: t.map(|p| p.1),
            ..*self
        })
    }

    fn cut_to(self, size: f64, patches: &mut Vec<Patch>) {
        // one beyond the limit is enough to be refused
        if patches.len() > MOST {
            return;
        }
        if self.side() <= size { patches.push(self) } else { self.quarters().into_iter().for_each(|q| q.cut_to(size, patches)) }
    }

    /// The point (1 − u − v)a + u b + v c, looked at from its side.
    fn at(&self, [u, v]: [f64; 2]) -> State {
        let mix = |[a, b, c]: [f64; 3]| (1.0 - u - v) * a + u * b + v * c;
        let place = [0, 1].map(|i| mix(self.places.map(|p| p[i])));
        State {
            place: Place::Surface(self.primitive),
            u: place[0] as f32,
            v: place[1] as f32,
            position: std::array::from_fn(|i| mix(self.corners.map(|p| p[i]))),
            outgoing: self.normal,
        }
    }

    fn middle(&self) -> State {
        self.at([1.0 / 3.0; 2])
    }

    /// Three points of equal weight, exact for polynomials of degree 2 (Hammer, Marlowe, Stroud, *Numerical integration over simplexes and cones*, 1956).
    fn nodes(&self) -> [State; 3] {
        const A: f64 = 1.0 / 6.0;
        [[A, A], [4.0 * A, A], [A, 4.0 * A]].map(|place| self.at(place))
    }

    /// ∫ K(x, y) dy over the patch.
    fn seen_from(&self, x: &State, kernel: &LightTransport, cuts: u32) -> Rgb {
        let d = Vec3::from(x.position) - Vec3::from(self.corners[0]);
        // the other side faces away
        if d.dot(&Vec3::from(self.normal)) <= 0.0 {
            return Rgb::ZERO;
        }
        if cuts < CUTS && self.side() > SMALL * (Vec3::from(x.position) - Vec3::from(self.middle().position)).norm() {
            return self.quarters().iter().fold(Rgb::ZERO, |sum, q| sum + q.seen_from(x, kernel, cuts + 1));
        }
        self.nodes().iter().fold(Rgb::ZERO, |sum, y| sum + kernel.eval(x, y)).scale(self.area() / 3.0)
    }
}

fn between<const N: usize>(a: [f64; N], b: [f64; N]) -> [f64; N] {
    std::array::from_fn(|i| 0.5 * (a[i] + b[i]))
}

impl Patches {
    /// Area of each patch.
    pub fn areas(&self) -> Vec<f64> {
        self.0.iter().map(Patch::area).collect()
    }

    /// The middle of each patch, on its side.
    pub fn middles(&self) -> Vec<State> {
        self.0.iter().map(Patch::middle).collect()
    }
}

impl Detector for Patches {
    type Point = State;
    type Answer<T> = Vec<T>;

    fn cells(&self) -> usize {
        self.0.len()
    }

    #[inline]
    fn start<S: Sampler>(&self, cell: usize, u: &mut S) -> Start<State> {
        let [u, v] = u.next_2d();
        let root = u.sqrt();
        Start { point: self.0[cell].at([root * (1.0 - v), root * v]), weight: 1.0 }
    }

    fn norm(&self) -> Option<f64> {
        Some(1.0)
    }

    fn answer<T>(&self, cells: Vec<T>) -> Vec<T> {
        cells
    }
}

impl Method<Emission, LightTransport, Patches> for Radiosity {
    type Solution = Vec<Rgb>;

    fn solve(&self, equation: &Equation<Emission, LightTransport>, Patches(patches): &Patches) -> Result<Vec<Rgb>, Error> {
        let n = patches.len();
        let rows: Vec<Vec<Rgb>> = parallel::map(n, |i| {
            let points = patches[i].nodes();
            let mean =
                |j: usize| points.iter().fold(Rgb::ZERO, |sum, x| sum + patches[j].seen_from(x, equation.kernel(), 0)).scale(1.0 / 3.0);
            (0..n).map(mean).collect()
        });
        let emission: Vec<Rgb> = patches.iter().map(|p| equation.source().eval(&p.middle())).collect();
        let mut solution = vec![Rgb::ZERO; n];
        for c in 0..3 {
            let factor = Factor::identity_minus(rows.iter().flatten().map(|k| k[c]).collect(), n)?;
            let radiance = factor.try_solve(&DVector::from_iterator(n, emission.iter().map(|e| e[c])))?;
            solution.iter_mut().zip(radiance.iter()).for_each(|(s, r)| s[c] = *r);
        }
        Ok(solution)
    }
}
