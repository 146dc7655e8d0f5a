//! Light forwards, backwards and both ways: the same image.
//!
//! ```text
//! ⟨h, L⟩ = ⟨Φ, Lₑ⟩,     L = e/(1 − ρ) in a furnace
//! ```

use crate::common::Budget;
use crate::{AnyMethod, solve};
use fredholm::estimator::Metropolis;
use fredholm::scene::{
    Attributes, Camera, Environment, Film, Filter, Material, PhotonDensity, Scene, SceneBuilder, Sides, Texture, geometry::Mesh, shapes,
};
use fredholm::walk::{Heuristic, Roulette};
use fredholm::{Bidirectional, Error, Estimate, Forward, Spectrum, Walk};
use std::sync::Arc;

const SQUARE: [[f64; 3]; 2] = [[0.6, 0.0, 0.0], [0.0, 0.0, 0.6]];

/// A room with a lamp under the ceiling, and something in it.
fn room(furnish: impl FnOnce(&mut SceneBuilder)) -> Scene {
    let mut scene = Scene::builder();
    let wall = scene.material(Material::diffuse([0.6, 0.5, 0.3]));
    let lamp = scene.material(Material::diffuse([0.2; 3]).emitting([10.0, 8.0, 5.0]).sides(Sides::Front));
    scene.mesh(shapes::room([-1.0; 3], [1.0; 3]).unwrap(), wall).unwrap();
    scene.mesh(shapes::parallelogram([-0.3, 0.95, -0.3], SQUARE[0], SQUARE[1]).unwrap(), lamp).unwrap();
    furnish(&mut scene);
    scene.build().unwrap()
}

fn ball(scene: &mut SceneBuilder, material: Material) {
    let material = scene.material(material);
    scene.sphere([0.0, -0.4, 0.1], 0.45, material).unwrap();
}

/// An octahedron whose normals are those of the sphere around it.
fn smooth(scene: &mut SceneBuilder, material: Material) {
    let corners = [[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, -1.0]];
    let faces = vec![[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
    let normals = corners.map(|c| c.map(|x| x as f32)).to_vec();
    let vertices = corners.map(|[x, y, z]| [0.5 * x, 0.5 * y - 0.4, 0.5 * z]).to_vec();
    let material = scene.material(material);
    scene.smooth_mesh(Mesh::new(vertices, faces).unwrap(), material, Attributes { normals, texcoords: Vec::new() }).unwrap();
}

/// A shelf under the lamp whose first half is a hole.
fn shelf(scene: &mut SceneBuilder) {
    let mask = Texture::new(2, 1, vec![Spectrum([0.0; 3]), Spectrum([1.0; 3])]).unwrap();
    let material = scene.material(Material::diffuse([0.7; 3]).cut_out(Arc::new(mask), 0.5));
    let texcoords = vec![[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]];
    let sheet = shapes::parallelogram([-0.5, 0.3, -0.5], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]).unwrap();
    scene.smooth_mesh(sheet, material, Attributes { normals: Vec::new(), texcoords }).unwrap();
}

#[test]
fn light_passes_holes() {
    let scene = room(shelf);
    let height = |x: f64| scene.look([x, 0.0, 0.1], [0.0, 1.0, 0.0]).position()[1];
    assert!((height(-0.4) - 0.95).abs() < 1e-12 || (height(-0.4) - 1.0).abs() < 1e-12, "{}", height(-0.4));
    assert!((height(0.4) - 0.3).abs() < 1e-12, "{}", height(0.4));
    // as if only the other half were there
    let half = room(|s| {
        let material = s.material(Material::diffuse([0.7; 3]));
        s.mesh(shapes::parallelogram([0.0, 0.3, -0.5], [0.0, 0.0, 1.0], [0.5, 0.0, 0.0]).unwrap(), material).unwrap();
    });
    let walk: AnyMethod = Box::new(Walk::mis().samples_per_cell(1 << 12));
    let [cut, whole] = [&scene, &half].map(|s| solve(&s.light_transport(), &s.film(camera(), 4, 4), &walk));
    // the same walks, up to the rounding of barycentric coordinates
    assert!(cut.pixels().iter().zip(whole.pixels()).all(|(a, b)| (a.value[0] / b.value[0] - 1.0).abs() < 0.05));
}

fn outdoors() -> Scene {
    let mut scene = Scene::builder();
    let stone = scene.material(Material::diffuse([0.6, 0.5, 0.3]));
    scene.mesh(shapes::parallelogram([-2.0, -1.0, -2.0], [0.0, 0.0, 4.0], [4.0, 0.0, 0.0]).unwrap(), stone).unwrap();
    scene.sphere([0.0, 0.0, 0.0], 0.5, stone).unwrap();
    let texels = (0..8 * 4).map(|k| [(k % 5) as f32, (k % 3) as f32, 1.0]).collect();
    scene.environment(Environment::map(8, 4, texels).unwrap());
    scene.directional_light([0.3, -1.0, 0.2], [2.0; 3]).unwrap();
    scene.point_light([0.8, 0.5, 0.8], [0.5; 3]).unwrap();
    scene.spot_light([-0.9, 1.0, 0.4], [0.6, -1.0, -0.3], [2.0; 3], [20.0, 50.0]).unwrap();
    scene.build().unwrap()
}

fn camera() -> Camera {
    Camera::look_at([0.1, 0.2, 0.95], [0.0, -0.3, 0.0]).field_of_view(60.0)
}

/// Both directions, and both together.
fn methods(samples: u64) -> Vec<(&'static str, AnyMethod)> {
    let pairs = Bidirectional::new().samples_per_cell(samples);
    vec![
        ("forward", Box::new(Forward::new().walks(24 * samples).seed(11))),
        ("balance", Box::new(pairs.seed(12))),
        ("power", Box::new(pairs.heuristic(Heuristic::Power(2.0)).seed(13))),
        ("maximum", Box::new(pairs.heuristic(Heuristic::Maximum).seed(14))),
        ("constant roulette", Box::new(pairs.roulette(Roulette::constant(0.7)).seed(15))),
    ]
}

/// Image of a method minus that of the path tracer, pixel by pixel in the first component; forward walks where they see all (`sees`).
fn agree(budget: &mut Budget, (what, scene, sees): (&str, &Scene, bool), film: &Film, samples: u64, margin: f64) -> Vec<String> {
    let equation = scene.light_transport();
    let reference: AnyMethod = Box::new(Walk::mis().roulette(Roulette::throughput(1.0)).samples_per_cell(4 * samples).seed(10));
    let reference = solve(&equation, film, &reference);
    let mut wrong = Vec::new();
    for (name, method) in methods(samples) {
        if name == "forward" && !sees {
            continue;
        }
        let image = solve(&equation, film, &method);
        for (k, (a, b)) in image.pixels().iter().zip(reference.pixels()).enumerate() {
            let error = a.std_error.unwrap()[0].hypot(b.std_error.unwrap()[0]);
            let (difference, allowed) = (a.value[0] - b.value[0], margin * b.value[0]);
            let named = format!("{what}, {name}, pixel {k} of {:.4}", b.value[0]);
            wrong.extend(budget.mean(&named, (difference, error, samples as f64), 0.0, allowed).err());
        }
    }
    wrong
}

#[test]
fn furnace() {
    let mut budget = Budget::of("scene::directions furnace");
    let mut scene = Scene::builder();
    let wall = scene.material(Material::diffuse([0.5; 3]).emitting([1.0; 3]));
    scene.mesh(shapes::room([-1.0; 3], [1.0; 3]).unwrap(), wall).unwrap();
    let scene = scene.build().unwrap();
    let film = scene.film(camera(), 2, 1);
    let mut wrong = Vec::new();
    for (name, method) in methods(1 << 14) {
        for pixel in solve(&scene.light_transport(), &film, &method).pixels() {
            let found = (pixel.value[0], pixel.std_error.unwrap()[0], pixel.degrees_of_freedom as f64);
            wrong.extend(budget.mean(name, found, 2.0, 0.1).err());
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// Every strategy alone finds all paths of a diffuse room: ⟨h, Tᵐ Lₑ⟩, whatever the number of vertices from either side.
#[test]
fn strategies_of_a_diffuse_room() {
    let mut budget = Budget::of("scene::directions strategies");
    let scene = room(|_| {});
    let film = scene.film(camera(), 1, 1);
    let equation = scene.light_transport();
    let table = equation.seen_by(&film).strategies(&Bidirectional::new().samples_per_cell(1 << 16).seed(20), 0, 3).unwrap();
    let mut wrong = Vec::new();
    for order in 1..=3 {
        let of_order = || table.iter().filter(|s| s.order() == order);
        // where all share the paths, the error is small
        let truth: f64 = of_order().map(|s| s.weighted.mean[0]).sum();
        for strategy in of_order() {
            let error = strategy.alone.std_error().unwrap()[0];
            let what = format!("s = {}, t = {}", strategy.s, strategy.t);
            wrong.extend(budget.mean(&what, (strategy.alone.mean[0], error, strategy.alone.count as f64), truth, 0.5 * truth).err());
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn images_agree() {
    let mut budget = Budget::of("scene::directions images");
    let cases = [
        ("diffuse", room(|s| ball(s, Material::diffuse([0.7; 3]))), true),
        ("mirror", room(|s| ball(s, Material::mirror([0.9; 3]))), false),
        ("glass", room(|s| ball(s, Material::glass(1.5))), false),
        ("frosted", room(|s| ball(s, Material::frosted(1.5, 0.5))), true),
        ("metal", room(|s| ball(s, Material::metal([0.9, 0.7, 0.3], 0.4))), true),
        ("interpolated normals", room(|s| smooth(s, Material::metallic_roughness([0.9, 0.7, 0.3], 0.3, 0.5))), true),
        ("outdoors", outdoors(), true),
        ("holes", room(shelf), true),
    ];
    let mut wrong = Vec::new();
    for (what, scene, sees) in &cases {
        let film = scene.film(camera(), 2, 1).filter(Filter::Tent(0.8));
        wrong.extend(agree(&mut budget, (what, scene, *sees), &film, 1 << 13, 0.4));
    }
    let lens = room(|s| ball(s, Material::diffuse([0.7; 3])));
    let film = lens.film(camera().lens(0.1, 0.8), 2, 1).filter(Filter::Gaussian(0.5));
    wrong.extend(agree(&mut budget, ("lens", &lens, true), &film, 1 << 13, 0.3));
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// Light that a mirror sends to the camera is missed by connections: an error, not darkness.
#[test]
fn light_tracing_refuses_mirrors_in_sight() {
    let scene = room(|s| ball(s, Material::mirror([0.9; 3])));
    let film = scene.film(camera(), 2, 1);
    let found = scene.light_transport().seen_by(&film).solve(&Forward::new());
    assert!(matches!(&found, Err(e @ Error::NotScored { .. }) if e.to_string().contains("Bidirectional")), "{found:?}");
    // unless it is out of sight
    let up = scene.film(Camera::look_at([0.1, 0.2, 0.95], [0.1, 0.9, 0.0]).field_of_view(20.0), 1, 1);
    assert!(scene.light_transport().seen_by(&up).solve(&Forward::new()).is_ok());
}

/// A point that lights a floor through a ball of glass: pairs and light tracing agree where it gathers the light, photon density is near, and walks from
/// the camera, which find nothing of it, are said not to.
#[test]
fn the_caustic_of_a_point() {
    let mut budget = Budget::of("scene::directions caustic");
    let mut scene = Scene::builder();
    let (floor, glass) = (scene.material(Material::diffuse([0.6; 3])), scene.material(Material::glass(1.5)));
    scene.mesh(shapes::parallelogram([-2.0, 0.0, -2.0], [0.0, 0.0, 4.0], [4.0, 0.0, 0.0]).unwrap(), floor).unwrap();
    scene.sphere([0.0, 1.0, 0.0], 0.5, glass).unwrap();
    scene.point_light([0.0, 3.0, 0.0], [5.0; 3]).unwrap();
    let scene = scene.build().unwrap();
    assert!(scene.to_string().contains("no walk from the camera finds it"), "{scene}");
    // under the ball, so that it is not in sight
    let equation = scene.light_transport();
    let film = scene.film(Camera::look_at([0.5, 0.3, 0.0], [0.0; 3]).up([0.0, 0.0, 1.0]).field_of_view(20.0), 1, 1);
    let solved = |method: AnyMethod| solve(&equation, &film, &method).pixels()[0].clone();
    let light = solved(Box::new(Forward::new().walks(1 << 20).seed(41)));
    let pairs = solved(Box::new(Bidirectional::new().samples_per_cell(1 << 20).seed(42)));
    let error = |e: &Estimate<Spectrum<3>>| e.std_error.unwrap()[0];
    let difference = (light.value[0] - pairs.value[0], error(&light).hypot(error(&pairs)), 1e5);
    let bright = light.value[0];
    let traced = solved(Box::new(Walk::mis().samples_per_cell(1 << 12).seed(43)));
    assert!(traced.value[0] < 0.1 * bright, "{} of {bright}", traced.value[0]);
    let density = equation.seen_by(&film).solve(&PhotonDensity::new(0.05).photons(1 << 17).seed(44)).unwrap().image;
    assert!((density[(0, 0)].value[0] / bright - 1.0).abs() < 0.3, "{} of {bright}", density[(0, 0)]);
    budget.mean("light tracing − pairs", difference, 0.0, 0.2 * bright).unwrap();
}

/// Chains of pairs, which score wherever they come to.
#[test]
fn metropolis() {
    let mut budget = Budget::of("scene::directions metropolis");
    let scene = room(|s| ball(s, Material::glass(1.5)));
    let (film, equation) = (scene.film(camera(), 2, 2), scene.light_transport());
    let reference: AnyMethod = Box::new(Walk::mis().roulette(Roulette::throughput(1.0)).samples_per_cell(1 << 16).seed(30));
    let reference = solve(&equation, &film, &reference);
    let query = equation.seen_by(&film);
    let pairs = query.bidirectional(&Bidirectional::new()).unwrap().shared();
    let chains = Metropolis::new().mutations(1 << 11).seed(31).solve(&pairs).unwrap();
    let mut wrong = Vec::new();
    for (found, truth) in chains.cells.iter().zip(reference.pixels()) {
        let error = found.std_error.unwrap()[0].hypot(truth.std_error.unwrap()[0]);
        let (difference, freedom) = (found.value[0] - truth.value[0], found.degrees_of_freedom as f64);
        wrong.extend(budget.mean("pixel", (difference, error, freedom), 0.0, 0.5 * truth.value[0]).err());
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// Optimal weights ask for densities along edges that a shelf may cut.
#[test]
fn optimal_weights_in_half_shadow() {
    let mut budget = Budget::of("scene::optimal");
    let mut scene = Scene::builder();
    let wall = scene.material(Material::diffuse([0.6; 3]));
    let lamp = scene.material(Material::diffuse([0.0; 3]).emitting([4.0; 3]));
    scene.mesh(shapes::room([-1.0; 3], [1.0; 3]).unwrap(), wall).unwrap();
    scene.mesh(shapes::parallelogram([-0.8, -0.8, 0.9], [0.0, 1.6, 0.0], [1.6, 0.0, 0.0]).unwrap(), lamp).unwrap();
    scene.mesh(shapes::parallelogram([-0.5, -0.5, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]).unwrap(), wall).unwrap();
    let scene = scene.build().unwrap();
    let film = scene.film(Camera::look_at([0.0, -0.9, -0.3], [0.0, 0.45, -1.0]).field_of_view(30.0), 1, 1);
    let transport = scene.light_transport();
    let (query, walk) = (transport.seen_by(&film), Walk::mis().depth(2).samples_per_cell(1 << 16));
    let balance = query.solve(&walk).unwrap()[(0, 0)].component(0);
    let best = query.solve(&query.optimal(&walk.seed(5), 4096).unwrap()).unwrap()[(0, 0)].component(0);
    let error = best.std_error.unwrap().hypot(balance.std_error.unwrap());
    let freedom = (best.degrees_of_freedom + balance.degrees_of_freedom) as f64;
    budget.mean("optimal less balance", (best.value - balance.value, error, freedom), 0.0, 0.01).unwrap();
    assert!(best.variance() < balance.variance());
}
