//! A closed room of albedo ρ and emission e has the radiance e/(1 − ρ) everywhere, whatever its shape, whatever stands in it as long as it keeps
//! energy, and whoever looks.

use crate::common::{Budget, all_pass};
use crate::{methods, scene_file, solve};
use fredholm::scene::{Camera, Environment, Material, Scene, Sides, load, shapes};

/// Name, scene, camera, radiance.
fn furnaces() -> Vec<(&'static str, Scene, Camera, [f64; 3])> {
    let inside = Camera::look_at([0.3, -0.2, 0.4], [-1.0, 0.5, -1.0]).field_of_view(70.0);
    let file = |name: &str| load(scene_file(name)).unwrap().builder.build().unwrap();
    vec![
        ("sphere of triangles", file("furnace_sphere.gltf"), inside, [2.0, 2.5, 2.5]),
        ("furnished room", furnished(), inside, [2.0; 3]),
        ("white in white light", under_white_sky(), Camera::look_at([0.0, 1.0, 5.0], [0.0; 3]).field_of_view(40.0), [1.0; 3]),
    ]
}

/// A mirror, glass, and a sphere that absorbs as much as it emits.
fn furnished() -> Scene {
    let mut scene = Scene::builder();
    let wall = scene.material(Material::diffuse([0.5; 3]).emitting([1.0; 3]));
    let lamp = scene.material(Material::diffuse([0.2; 3]).emitting([1.6; 3]).sides(Sides::Front));
    let (mirror, glass) = (scene.material(Material::mirror([1.0; 3])), scene.material(Material::glass(1.5)));
    scene.mesh(shapes::room([-1.0; 3], [1.0; 3]).unwrap(), wall).unwrap();
    scene.sphere([-0.5, 0.3, -0.4], 0.2, mirror).unwrap();
    scene.sphere([-0.4, -0.2, -0.1], 0.2, glass).unwrap();
    scene.sphere([-0.6, 0.5, 0.1], 0.25, lamp).unwrap();
    scene.build().unwrap()
}

fn under_white_sky() -> Scene {
    let mut scene = Scene::builder();
    let white = scene.material(Material::diffuse([1.0; 3]));
    scene.sphere([0.0, 0.5, 0.0], 0.8, white).unwrap();
    scene.mesh(shapes::parallelogram([-2.0, -0.5, -2.0], [0.0, 0.0, 4.0], [4.0, 0.0, 0.0]).unwrap(), white).unwrap();
    scene.environment(Environment::map(4, 2, vec![[1.0; 3]; 8]).unwrap());
    scene.build().unwrap()
}

#[test]
fn closed_rooms_are_uniform() {
    let mut budget = Budget::of("scene::furnaces");
    let mut results = Vec::new();
    for (name, scene, camera, exact) in furnaces() {
        let (equation, film) = (scene.light_transport(), scene.film(camera, 1, 1));
        // white surfaces lose nothing: their walks end in the sky
        for (method, walk) in methods(1 << 15, 0.05) {
            let pixel = &solve(&equation, &film, &walk)[(0, 0)];
            let (error, freedom) = (pixel.std_error.unwrap(), pixel.degrees_of_freedom as f64);
            // next event alone is the noisiest
            let margin = if method == "next event" { 0.06 } else { 0.02 };
            for i in 0..3 {
                let (mean, error) = (pixel.value[i], error[i]);
                results.push(budget.mean(&format!("{name}, {method}, {i}"), (mean, error, freedom), exact[i], margin * exact[i]));
            }
        }
    }
    all_pass(results);
}
