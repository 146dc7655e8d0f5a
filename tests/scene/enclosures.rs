//! Enclosures with known radiosities: plates, squares, disks, a sphere; from the camera, from the lamp, and from both.
//!
//! A pinhole that looks straight down on a plane sees every part of it alike: a pixel as large as a plate is the mean over the plate. With 2²⁰ samples
//! a bias of 1.1e-3 of the first disk and of 4e-3 of the second would be seen, and none is.

use crate::common::{Budget, Reference, all_pass};
use crate::{AnyMethod, solve};
use fredholm::sampling::Sobol;
use fredholm::scene::geometry::Mesh;
use fredholm::scene::{Camera, Material, Scene, Sides, shapes};
use fredholm::walk::Roulette;
use fredholm::{Bidirectional, Forward, Walk};
use std::f64::consts::{PI, TAU};

/// A pixel of a scene, its radiance, samples, and the relative bias that may hide.
struct Pixel {
    scene: Scene,
    camera: Camera,
    exact: f64,
    samples: u64,
    margin: f64,
}

/// Looks along ±z at a square of sides 2 `half` in the plane `distance` away.
fn above(eye: [f64; 3], down: f64, distance: f64, half: f64) -> Camera {
    Camera::towards(eye, [0.0, 0.0, down]).up([0.0, 1.0, 0.0]).field_of_view(2.0 * (half / distance).atan().to_degrees())
}

/// A plate that scatters and emits upwards or downwards.
fn matt(albedo: f64, emission: f64) -> Material {
    Material::diffuse([albedo; 3]).emitting([emission; 3]).sides(Sides::Front)
}

/// Walks that hit, that connect, along points, with light and both ways.
fn methods(samples: u64) -> Vec<(&'static str, AnyMethod)> {
    let roulette = Roulette::throughput(0.05);
    vec![
        ("collision", Box::new(Walk::collision().roulette(roulette).samples_per_cell(samples).sequence(Sobol::new(1)))),
        ("balance", Box::new(Walk::mis().roulette(roulette).samples_per_cell(samples).sequence(Sobol::new(3)))),
        ("light tracing", Box::new(Forward::new().roulette(roulette).walks(samples).sequence(Sobol::new(4)))),
        ("pairs", Box::new(Bidirectional::new().samples_per_cell(samples).sequence(Sobol::new(5)))),
    ]
}

/// Two plates in a tunnel of mirrors, which make them infinite.
fn infinite_plates() -> Vec<Pixel> {
    let reference = Reference::load("parallel-plates-infinite");
    let p = |name: &str| reference.parameter(name);
    let mut scene = Scene::builder();
    let (floor, ceiling) = (scene.material(matt(p("rho1"), p("E1"))), scene.material(matt(p("rho2"), p("E2"))));
    let mirror = scene.material(Material::mirror([1.0; 3]));
    let (x, y) = ([2.0, 0.0, 0.0], [0.0, 2.0, 0.0]);
    scene.mesh(shapes::parallelogram([-1.0, -1.0, 0.0], x, y).unwrap(), floor).unwrap();
    scene.mesh(shapes::parallelogram([-1.0, -1.0, 2.0], y, x).unwrap(), ceiling).unwrap();
    for (corner, side) in [([-1.0; 2], x), ([-1.0; 2], y), ([-1.0, 1.0], x), ([1.0, -1.0], y)] {
        scene.mesh(shapes::parallelogram([corner[0], corner[1], 0.0], side, [0.0, 0.0, 2.0]).unwrap(), mirror).unwrap();
    }
    let scene = scene.build().unwrap();
    let pixel = |exact, down| Pixel {
        scene: scene.clone(),
        camera: above([0.0, 0.0, 1.0], down, 1.0, 0.95),
        exact,
        samples: 1 << 14,
        margin: 5e-2,
    };
    reference.numbers().into_iter().zip([-1.0, 1.0]).map(|(exact, down)| pixel(exact, down)).collect()
}

/// Two unit squares that face each other.
fn squares() -> Vec<Pixel> {
    let reference = Reference::load("radiosity-opposed-squares");
    let (x, y, h) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], reference.parameter("h"));
    let mut scene = Scene::builder();
    let plate = scene.material(matt(reference.parameter("rho"), 1.0));
    scene.mesh(shapes::parallelogram([0.0; 3], x, y).unwrap(), plate).unwrap();
    scene.mesh(shapes::parallelogram([0.0, 0.0, h], y, x).unwrap(), plate).unwrap();
    let camera = above([0.5, 0.5, 0.8 * h], -1.0, 0.8 * h, 0.5);
    vec![Pixel { scene: scene.build().unwrap(), camera, exact: reference.functional("1"), samples: 1 << 16, margin: 1.2e-2 }]
}

/// A polygon of 128 sides with the area πR² of the disk: what differs is of fourth order in the side.
fn disk(radius: f64, height: f64, up: bool) -> Mesh {
    const N: u32 = 128;
    let angle = TAU / f64::from(N);
    let reach = radius * (angle / angle.sin()).sqrt();
    let corner = |k: u32| {
        let (s, c) = (angle * f64::from(k)).sin_cos();
        [reach * c, reach * s, height]
    };
    let vertices = (0..N).map(corner).chain([[0.0, 0.0, height]]).collect();
    let face = |k: u32| if up { [N, k, (k + 1) % N] } else { [N, (k + 1) % N, k] };
    Mesh::new(vertices, (0..N).map(face).collect()).unwrap()
}

/// Two disks that face each other, black around: pixels see a square that holds one.
fn disks() -> Vec<Pixel> {
    let reference = Reference::load("radiosity-coaxial-disks");
    let p = |name: &str| reference.parameter(name);
    let mut scene = Scene::builder();
    let (low, high) = (scene.material(matt(p("rho1"), p("E1"))), scene.material(matt(p("rho2"), p("E2"))));
    scene.mesh(disk(p("R1"), 0.0, true), low).unwrap();
    scene.mesh(disk(p("R2"), p("h"), false), high).unwrap();
    let scene = scene.build().unwrap();
    let (half, h) = (1.1, p("h"));
    [("int over disk 1 of B1", 0.8, -1.0, 8e-3), ("int over disk 2 of B2", 0.2, 1.0, 4e-2)]
        .map(|(functional, z, down, margin)| {
            let camera = above([0.0, 0.0, z * h], down, 0.8 * h, half);
            Pixel { scene: scene.clone(), camera, exact: reference.functional(functional) / (4.0 * half * half), samples: 1 << 16, margin }
        })
        .into()
}

/// A sphere with a point of light in its middle, as bright as gives the walls a first radiance of 1: every reflection is uniform, and walks have no noise
/// but that of roulette.
fn sphere(albedo: [f64; 3]) -> Scene {
    let mut scene = Scene::builder();
    let wall = scene.material(Material::diffuse(albedo));
    scene.sphere([0.0; 3], 2.0, wall).unwrap();
    scene.point_light([0.0; 3], albedo.map(|a| PI * 4.0 / a)).unwrap();
    scene.build().unwrap()
}

#[test]
fn integrating_spheres() {
    let mut budget = Budget::of("scene::spheres");
    let references = ["0.5", "0.95", "0.999"].map(|rho| Reference::load(&format!("integrating-sphere-rho{rho}")));
    let exact = references.each_ref().map(|r| r.functional("1/2"));
    let camera = Camera::towards([0.3, 0.2, 0.1], [0.0, 0.0, 1.0]).field_of_view(120.0);
    let mut results = Vec::new();
    let mut judge = |name: &str, method: AnyMethod, albedo: [f64; 3], components: usize, margin: f64| {
        let scene = sphere(albedo);
        let pixel = &solve(&scene.light_transport(), &scene.film(camera, 1, 1), &method)[(0, 0)];
        let (error, freedom) = (pixel.std_error.unwrap(), pixel.degrees_of_freedom as f64);
        results.extend(
            (0..components).map(|i| budget.mean(&format!("{name}, {i}"), (pixel.value[i], error[i], freedom), exact[i], margin * exact[i])),
        );
    };
    let walk = Walk::mis().roulette(Roulette::throughput(3e-4));
    let all = references.each_ref().map(|r| r.parameter("rho"));
    judge("balance", Box::new(walk.samples_per_cell(1 << 5).seed(1)), all, 3, 1e-3);
    judge("Sobol'", Box::new(walk.samples_per_cell(1 << 5).sequence(Sobol::new(2))), all, 3, 1e-3);
    let half = [all[0]; 3];
    judge("light tracing", Box::new(Forward::new().walks(1 << 18).sequence(Sobol::new(3))), half, 1, 1.5e-2);
    judge("pairs", Box::new(Bidirectional::new().samples_per_cell(1 << 16).sequence(Sobol::new(4))), half, 1, 1e-2);
    all_pass(results);
}

#[test]
fn plates_and_disks() {
    let mut budget = Budget::of("scene::enclosures");
    let mut results = Vec::new();
    for (k, Pixel { scene, camera, exact, samples, margin }) in infinite_plates().into_iter().chain(squares()).chain(disks()).enumerate() {
        let (equation, film) = (scene.light_transport(), scene.film(camera, 1, 1));
        for (name, method) in methods(samples) {
            let pixel = &solve(&equation, &film, &method)[(0, 0)];
            let found = (pixel.value[0], pixel.std_error.unwrap()[0], pixel.degrees_of_freedom as f64);
            results.push(budget.mean(&format!("{k}, {name}"), found, exact, margin * exact));
        }
    }
    all_pass(results);
}
