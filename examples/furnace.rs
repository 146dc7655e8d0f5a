//! The furnace: in a closed room of albedo ρ and emission e the radiance is e/(1 − ρ) everywhere, whatever stands in it and keeps energy.
//!
//! Equation: L = e + T L with T1 = ρ. Answer: L = e/(1 − ρ) = 2, by every method and sequence; beside each the half-width of its 95 % interval.
//!
//! `cargo run --release --example furnace -- [--samples 65536]`
#![allow(clippy::print_stdout)]

use fredholm::estimator::Metropolis;
use fredholm::sampling::{Halton, LatinHypercube, Sobol};
use fredholm::scene::{Camera, Film, Image, Material, Scene, Sides, shapes};
use fredholm::walk::{Heuristic, Roulette};
use fredholm::{Bidirectional, Error, Estimate, Forward, Method, Spectrum, Walk};

/// A mirror, glass, and a lamp that absorbs 0.8 of what it gets and emits as much.
fn furnished() -> Result<Scene, Error> {
    let mut scene = Scene::builder();
    let wall = scene.material(Material::diffuse([0.5; 3]).emitting([1.0; 3]));
    let lamp = scene.material(Material::diffuse([0.2; 3]).emitting([1.6; 3]).sides(Sides::Front));
    let (mirror, glass) = (scene.material(Material::mirror([1.0; 3])), scene.material(Material::glass(1.5)));
    scene.mesh(shapes::room([-1.0; 3], [1.0; 3])?, wall)?;
    scene.sphere([-0.5, 0.3, -0.4], 0.2, mirror)?;
    scene.sphere([-0.4, -0.2, -0.1], 0.2, glass)?;
    scene.sphere([-0.6, 0.5, 0.1], 0.25, lamp)?;
    scene.build()
}

fn show(name: &str, pixel: &Estimate<Spectrum<3>>) {
    let Some(width) = pixel.half_width(0.95).map(|w| w[0] / 2.0) else { return println!("{name:24} no interval") };
    let deviation = pixel.value[0] / 2.0 - 1.0;
    println!("{name:24} {:.6}   off by {deviation:+.1e}, interval ± {width:.1e}   {:.1} s", pixel.value[0], pixel.elapsed.as_secs_f64());
    // a fixed depth has no noise, and the rounding of its sum
    assert!(pixel.agrees_with(Spectrum([2.0; 3]), 6.0) || deviation.abs() < 1e-12, "{name}: {pixel} is not 2");
}

fn main() -> Result<(), Error> {
    sigpipe::reset();
    let mut arguments = std::env::args().skip_while(|a| a != "--samples");
    let samples = arguments.nth(1).and_then(|a| a.parse().ok()).unwrap_or(1 << 16);
    let scene = furnished()?;
    let film = |target| scene.film(Camera::look_at([0.3, -0.2, 0.4], target).field_of_view(70.0), 2, 1);
    // the second film sees neither mirror nor glass, from which light tracing finds nothing
    let (all, walls) = (film([-1.0, 0.5, -1.0]), film([1.0, -0.5, 1.0]));
    let (equation, roulette) = (scene.light_transport(), Roulette::throughput(0.05));
    let (hit, mis) =
        (Walk::collision().roulette(roulette).samples_per_cell(samples), Walk::mis().roulette(roulette).samples_per_cell(samples));
    let next_event = Walk::next_event().roulette(roulette).samples_per_cell(samples);
    let (strata, pairs) = (LatinHypercube::new((samples / 16).max(1))?, Bidirectional::new().samples_per_cell(samples));
    let forward = Forward::new().walks(16 * samples);
    println!("exact                    2");
    type Any<'a> =
        &'a dyn Method<fredholm::scene::Emission, fredholm::scene::LightTransport, Film, Solution = Image<Estimate<Spectrum<3>>>>;
    for (name, film, method) in [
        ("collision", &all, &hit as Any),
        ("collision, Sobol'", &all, &hit.sequence(Sobol::new(1))),
        ("constant roulette", &all, &hit.roulette(Roulette::constant(0.9))),
        ("fixed depth", &all, &hit.depth(64)),
        ("next event", &all, &next_event),
        ("next event, Sobol'", &all, &next_event.sequence(Sobol::new(2))),
        ("balance", &all, &mis),
        ("power", &all, &mis.heuristic(Heuristic::Power(2.0))),
        ("maximum", &all, &mis.heuristic(Heuristic::Maximum)),
        ("balance, Sobol'", &all, &mis.sequence(Sobol::new(3))),
        ("balance, Halton", &all, &mis.sequence(Halton::new(4))),
        ("balance, Latin hypercube", &all, &mis.sequence(strata)),
        ("pairs", &all, &pairs),
        ("pairs, Sobol'", &all, &pairs.sequence(Sobol::new(5))),
        ("light tracing", &walls, &forward),
        ("light tracing, Sobol'", &walls, &forward.sequence(Sobol::new(6))),
    ] {
        show(name, &equation.seen_by(film).solve(method)?[(0, 0)]);
    }
    let mutations = (samples / 32).max(64);
    let chains = Metropolis::new().mutations(mutations).pool(mutations).solve(&equation.seen_by(&all).bidirectional(&pairs)?.shared())?;
    show("Metropolis", &chains.cells[0]);
    Ok(())
}
