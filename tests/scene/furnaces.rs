//! A closed room of albedo ρ and emission e has the radiance e/(1 − ρ) everywhere, whatever its shape, whatever stands in it as long as it keeps
//! energy, and whoever looks.
//!
//! Walks that score what they hit are asked at ρ up to ½, where roulette is their only noise; the others at ρ up to 0.1: next events of a lamp that is
//! all around are noisy, and it is their share of the radiance that is. The example `furnace` has them all at ½, as closely as one has time for.

use crate::common::{Budget, all_pass};
use crate::{AnyMethod, solve};
use fredholm::estimator::Metropolis;
use fredholm::sampling::{Halton, LatinHypercube, Sobol};
use fredholm::scene::geometry::Mesh;
use fredholm::scene::{Camera, Environment, Material, PhotonDensity, Scene, Sides, shapes};
use fredholm::walk::{Heuristic, Roulette};
use fredholm::{Bidirectional, Error, Forward, Walk};

const ALBEDO: [f64; 3] = [0.1, 0.05, 0.02];

/// Emits 1 where it reflects the albedo.
fn wall(albedo: [f64; 3]) -> Material {
    Material::diffuse(albedo).emitting([1.0; 3])
}

fn room(albedo: [f64; 3]) -> Scene {
    let mut scene = Scene::builder();
    let wall = scene.material(wall(albedo));
    scene.mesh(shapes::room([-1.0; 3], [1.0; 3]).unwrap(), wall).unwrap();
    scene.build().unwrap()
}

/// An octahedron whose faces are cut into 16 and blown up to a sphere, fronts inside.
fn sphere(albedo: [f64; 3]) -> Scene {
    let unit = |p: [f64; 3]| p.map(|x| x / p.iter().map(|c| c * c).sum::<f64>().sqrt());
    let mut triangles: Vec<[[f64; 3]; 3]> = (0..8)
        .map(|k| {
            let [x, y, z] = [0, 1, 2].map(|i| if k >> i & 1 == 0 { 1.0 } else { -1.0 });
            let [a, b, c] = [[x, 0.0, 0.0], [0.0, y, 0.0], [0.0, 0.0, z]];
            if x * y * z > 0.0 { [a, c, b] } else { [a, b, c] }
        })
        .collect();
    for _ in 0..2 {
        let cut = |&[a, b, c]: &[[f64; 3]; 3]| {
            let middle = |p: [f64; 3], q: [f64; 3]| unit(std::array::from_fn(|i| p[i] + q[i]));
            let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
            [[a, ab, ca], [ab, b, bc], [ca, bc, c], [bc, ca, ab]]
        };
        triangles = triangles.iter().flat_map(cut).collect();
    }
    let corners = (0..triangles.len() as u32).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
    let mut scene = Scene::builder();
    let wall = scene.material(wall(albedo).sides(Sides::Front));
    scene.mesh(Mesh::new(triangles.concat(), corners).unwrap(), wall).unwrap();
    scene.build().unwrap()
}

/// A mirror, glass, and a sphere that absorbs as much as it emits.
fn furnished(albedo: [f64; 3]) -> Scene {
    let mut scene = Scene::builder();
    let radiance = albedo.map(|a| 1.0 / (1.0 - a));
    let (wall, lamp) = (scene.material(wall(albedo)), Material::diffuse([0.2; 3]).emitting(radiance.map(|l| 0.8 * l)));
    let lamp = scene.material(lamp.sides(Sides::Front));
    let (mirror, glass) = (scene.material(Material::mirror([1.0; 3])), scene.material(Material::glass(1.5)));
    scene.mesh(shapes::room([-1.0; 3], [1.0; 3]).unwrap(), wall).unwrap();
    scene.sphere([-0.5, 0.3, -0.4], 0.2, mirror).unwrap();
    scene.sphere([-0.4, -0.2, -0.1], 0.2, glass).unwrap();
    scene.sphere([-0.6, 0.5, 0.1], 0.25, lamp).unwrap();
    scene.build().unwrap()
}

fn camera() -> Camera {
    Camera::look_at([0.3, -0.2, 0.4], [-1.0, 0.5, -1.0]).field_of_view(70.0)
}

/// Pixel (0, 0) of each method against the exact radiance; margins are relative.
fn judge(
    what: &str,
    (scene, camera, exact): (&Scene, Camera, [f64; 3]),
    methods: Vec<(&'static str, AnyMethod, f64)>,
    budget: &mut Budget,
) -> Vec<Result<(), String>> {
    let (equation, film) = (scene.light_transport(), scene.film(camera, 1, 1));
    let mut results = Vec::new();
    for (name, method, margin) in methods {
        let pixel = &solve(&equation, &film, &method)[(0, 0)];
        let (error, freedom) = (pixel.std_error.unwrap(), pixel.degrees_of_freedom as f64);
        results.extend((0..3).map(|i| {
            let (mean, error) = (pixel.value[i], error[i]);
            budget.mean(&format!("{what}, {name}, {i}"), (mean, error, freedom), exact[i], margin * exact[i])
        }));
    }
    results
}

/// Walks that score what they hit; cut at depth 64, where 2⁻⁶⁴ is left.
fn hitting(samples: u64) -> Vec<(&'static str, AnyMethod, f64)> {
    let walk = Walk::collision().roulette(Roulette::throughput(0.01)).samples_per_cell(samples);
    vec![
        ("collision", Box::new(walk.seed(1)), 1e-3),
        ("constant roulette", Box::new(walk.roulette(Roulette::constant(0.9)).seed(2)), 2e-2),
        ("fixed depth", Box::new(walk.depth(64).samples_per_cell(samples / 16).seed(3)), 1e-3),
        ("collision, Sobol'", Box::new(walk.sequence(Sobol::new(4))), 1e-3),
    ]
}

/// Walks that connect; margins are in units of that of the balance heuristic.
fn connecting(samples: u64, margin: f64) -> Vec<(&'static str, AnyMethod, f64)> {
    let roulette = Roulette::throughput(0.01);
    let mis = Walk::mis().roulette(roulette).samples_per_cell(samples);
    let next_event = Walk::next_event().roulette(roulette).samples_per_cell(samples);
    let strata = LatinHypercube::new(samples / 16).unwrap();
    vec![
        ("next event", Box::new(next_event.seed(2)), 4.0 * margin),
        ("next event, Sobol'", Box::new(next_event.sequence(Sobol::new(2))), 3.0 * margin),
        ("balance", Box::new(mis.seed(3)), margin),
        ("power", Box::new(mis.heuristic(Heuristic::Power(2.0)).seed(4)), margin),
        ("maximum", Box::new(mis.heuristic(Heuristic::Maximum).seed(5)), 2.0 * margin),
        ("fixed depth", Box::new(mis.depth(8).seed(6)), margin),
        ("Sobol'", Box::new(mis.sequence(Sobol::new(7))), margin),
        ("Halton", Box::new(mis.sequence(Halton::new(8))), margin),
        ("Latin hypercube", Box::new(mis.sequence(strata)), 1.2 * margin),
        ("pairs, Sobol'", Box::new(Bidirectional::new().samples_per_cell(samples).sequence(Sobol::new(9))), 4.0 * margin),
    ]
}

#[test]
fn closed_rooms_are_uniform() {
    let mut budget = Budget::of("scene::furnaces");
    let half = [0.5, 0.3, 0.1];
    let radiance = |albedo: [f64; 3]| albedo.map(|a| 1.0 / (1.0 - a));
    let mut results = Vec::new();
    let rooms = [
        ("room", room as fn([f64; 3]) -> Scene, 1 << 16, 1e-3),
        ("sphere", sphere, 1 << 16, 1e-3),
        ("furnished room", furnished, 1 << 15, 2e-3),
    ];
    for (what, scene, samples, margin) in rooms {
        results.extend(judge(what, (&scene(half), camera(), radiance(half)), hitting(1 << 14), &mut budget));
        results.extend(judge(what, (&scene(ALBEDO), camera(), radiance(ALBEDO)), connecting(samples, margin), &mut budget));
    }
    let walks = Forward::new().walks(1 << 19).sequence(Sobol::new(10));
    for (what, scene) in [("room", room(ALBEDO)), ("sphere", sphere(ALBEDO))] {
        let light = vec![("light tracing", Box::new(walks) as AnyMethod, 5e-3)];
        results.extend(judge(what, (&scene, camera(), radiance(ALBEDO)), light, &mut budget));
    }
    all_pass(results);
}

/// White things under a white sky lose nothing: walks end in the sky with all their weight.
#[test]
fn white_is_white() {
    let mut budget = Budget::of("scene::furnaces white");
    let mut scene = Scene::builder();
    let white = scene.material(Material::diffuse([1.0; 3]));
    scene.sphere([0.0, 0.5, 0.0], 0.8, white).unwrap();
    scene.mesh(shapes::parallelogram([-2.0, -0.5, -2.0], [0.0, 0.0, 4.0], [4.0, 0.0, 0.0]).unwrap(), white).unwrap();
    scene.environment(Environment::map(4, 2, vec![[1.0; 3]; 8]).unwrap());
    let scene = scene.build().unwrap();
    let methods = |samples| -> Vec<(&'static str, AnyMethod, f64)> {
        let mis = Walk::mis().samples_per_cell(samples);
        vec![
            ("collision", Box::new(Walk::collision().samples_per_cell(256)), 1e-3),
            ("balance", Box::new(mis.seed(1)), 2e-2),
            ("Sobol'", Box::new(mis.sequence(Sobol::new(2))), 2e-2),
            ("pairs", Box::new(Bidirectional::new().samples_per_cell(samples).sequence(Sobol::new(3))), 2e-2),
        ]
    };
    let view = Camera::look_at([0.0, 1.0, 5.0], [0.0; 3]).field_of_view(40.0);
    all_pass(judge("white", (&scene, view, [1.0; 3]), methods(1 << 15), &mut budget));
}

/// A disk in the middle of a wall sees what its centre does: there the density of photons has no bias.
#[test]
fn photons_in_the_middle_of_a_wall() {
    let mut budget = Budget::of("scene::furnaces photons");
    let scene = room(ALBEDO);
    let film = scene.film(Camera::look_at([0.0; 3], [1.0, 0.0, 0.0]).field_of_view(30.0), 1, 1);
    let found = scene.light_transport().seen_by(&film).solve(&PhotonDensity::new(0.6)).unwrap();
    let pixel = &found.image[(0, 0)];
    let (error, freedom) = (pixel.std_error.unwrap(), pixel.degrees_of_freedom as f64);
    all_pass((0..3).map(|i| {
        let truth = 1.0 / (1.0 - ALBEDO[i]);
        budget.mean(&format!("photons, {i}"), (pixel.value[i], error[i], freedom), truth, 5e-3 * truth)
    }));
    let refused = scene.light_transport().seen_by(&film).solve(&PhotonDensity::new(-1.0));
    assert!(matches!(refused, Err(Error::Invalid { parameter: "radius", .. })), "{refused:?}");
}

/// Chains over path samples, and over pairs.
#[test]
fn chains_in_a_room() {
    let mut budget = Budget::of("scene::furnaces chains");
    let scene = room(ALBEDO);
    let (film, equation) = (scene.film(camera(), 2, 1), scene.light_transport());
    let (query, walk) = (equation.seen_by(&film), Walk::mis().roulette(Roulette::throughput(0.1)));
    let metropolis = Metropolis::new().mutations(1 << 11).pool(1 << 11);
    let paths = metropolis.seed(1).solve(&query.estimator(&walk).unwrap()).unwrap();
    let pairs = metropolis.seed(2).solve(&query.bidirectional(&Bidirectional::new()).unwrap().shared()).unwrap();
    let mut results = Vec::new();
    for (name, chains) in [("paths", paths), ("pairs", pairs)] {
        for pixel in &chains.cells {
            let (truth, error) = (1.0 / (1.0 - ALBEDO[0]), pixel.std_error.unwrap()[0]);
            let found = (pixel.value[0], error, pixel.degrees_of_freedom as f64);
            results.push(budget.mean(name, found, truth, 0.1 * truth));
        }
    }
    all_pass(results);
}
