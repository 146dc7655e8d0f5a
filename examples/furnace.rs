//! The furnace: in a closed room of albedo ρ and emission e the radiance is e/(1 − ρ) everywhere, whatever stands in it and keeps energy.
//!
//! Equation: L = e + T L with T1 = ρ. Answer: L = e/(1 − ρ) = 2.
//!
//! `cargo run --release --example furnace -- [--samples 65536]`
#![allow(clippy::print_stdout)]

use fredholm::scene::{Camera, Material, Scene, Sides, shapes};
use fredholm::walk::{Heuristic, Roulette};
use fredholm::{Error, Method, Spectrum, Walk, sampling::Sobol};

fn main() -> Result<(), Error> {
    let mut arguments = std::env::args().skip_while(|a| a != "--samples");
    let samples = arguments.nth(1).and_then(|a| a.parse().ok()).unwrap_or(1 << 16);
    let mut scene = Scene::builder();
    let wall = scene.material(Material::diffuse([0.5; 3]).emitting([1.0; 3]));
    // absorbs 0.8 of what it gets and emits as much
    let lamp = scene.material(Material::diffuse([0.2; 3]).emitting([1.6; 3]).sides(Sides::Front));
    let (mirror, glass) = (scene.material(Material::mirror([1.0; 3])), scene.material(Material::glass(1.5)));
    scene.mesh(shapes::room([-1.0; 3], [1.0; 3])?, wall)?;
    scene.sphere([-0.5, 0.3, -0.4], 0.2, mirror)?;
    scene.sphere([-0.4, -0.2, -0.1], 0.2, glass)?;
    scene.sphere([-0.6, 0.5, 0.1], 0.25, lamp)?;
    let scene = scene.build()?;
    let film = scene.film(Camera::look_at([0.3, -0.2, 0.4], [-1.0, 0.5, -1.0]).field_of_view(70.0), 1, 1);
    let roulette = Roulette::throughput(0.05);
    let mis = Walk::mis().roulette(roulette).samples_per_cell(samples);
    println!("exact      2");
    for (name, method) in [
        ("collision ", &Walk::collision().roulette(roulette).samples_per_cell(samples) as &dyn Method<_, _, _, Solution = _>),
        ("next event", &Walk::next_event().roulette(roulette).samples_per_cell(samples)),
        ("balance   ", &mis),
        ("power     ", &mis.heuristic(Heuristic::Power(2.0))),
        ("maximum   ", &mis.heuristic(Heuristic::Maximum)),
        ("Sobol'    ", &mis.sequence(Sobol::new(1))),
    ] {
        let image: fredholm::scene::Image<fredholm::Estimate<Spectrum<3>>> = scene.light_transport().seen_by(&film).solve(method)?;
        let pixel = &image[(0, 0)];
        println!("{name} {pixel}   {}", pixel.agrees_with(Spectrum([2.0; 3]), 4.0));
    }
    Ok(())
}
