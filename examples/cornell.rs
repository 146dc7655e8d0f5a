//! The Cornell box, built in code, by three estimators; a progress bar, PNG, EXR and a convergence plot.
//!
//! Equation: L = Lₑ + T L, radiance in a room. Answer: an image with an error for every pixel (Goral et al., SIGGRAPH 1984).
//!
//! `cargo run --release --example cornell -- [--size 256] [--samples 256]`
#![allow(clippy::print_stdout)]

use fredholm::scene::{Camera, Emission, Film, LightTransport, Material, Scene, Sides, geometry::Mesh, shapes};
use fredholm::walk::{Ending, Roulette, Scoring};
use fredholm::{Error, Walk, plot::Convergence};
use indicatif::{ProgressBar, ProgressStyle};
use std::time::Instant;

fn option(name: &str, default: u64) -> u64 {
    let value = std::env::args().skip_while(|a| a != name).nth(1);
    value.map_or(default, |v| v.parse().unwrap_or_else(|_| panic!("{name} needs a whole number, not {v}")))
}

/// An upright block: a parallelogram of the floor, raised.
fn block(corners: [[f64; 2]; 4], height: f64) -> Result<Mesh, Error> {
    let vertices = [0.0, height].iter().flat_map(|y| corners.map(|[x, z]| [x, *y, z])).collect();
    let side = |i: u32| [[i, 4 + i, 4 + (i + 1) % 4], [i, 4 + (i + 1) % 4, (i + 1) % 4]];
    Mesh::new(vertices, (0..4).flat_map(side).chain([[4, 7, 6], [4, 6, 5]]).collect())
}

fn cornell() -> Result<Scene, Error> {
    let mut scene = Scene::builder();
    let white = scene.material(Material::diffuse([0.725, 0.71, 0.68]));
    let (green, red) = (scene.material(Material::diffuse([0.14, 0.45, 0.091])), scene.material(Material::diffuse([0.63, 0.065, 0.05])));
    let lamp = scene.material(Material::diffuse([0.78; 3]).emitting([17.0, 12.0, 4.0]).sides(Sides::Front));
    let (w, h, d) = (556.0, 548.8, 559.2);
    scene.mesh(shapes::parallelogram([0.0; 3], [0.0, 0.0, d], [w, 0.0, 0.0])?, white)?;
    scene.mesh(shapes::parallelogram([0.0, h, 0.0], [w, 0.0, 0.0], [0.0, 0.0, d])?, white)?;
    scene.mesh(shapes::parallelogram([0.0, 0.0, d], [0.0, h, 0.0], [w, 0.0, 0.0])?, white)?;
    scene.mesh(shapes::parallelogram([0.0; 3], [0.0, h, 0.0], [0.0, 0.0, d])?, green)?;
    scene.mesh(shapes::parallelogram([w, 0.0, 0.0], [0.0, 0.0, d], [0.0, h, 0.0])?, red)?;
    scene.mesh(shapes::parallelogram([213.0, h - 0.5, 227.0], [130.0, 0.0, 0.0], [0.0, 0.0, 105.0])?, lamp)?;
    scene.mesh(block([[130.0, 65.0], [82.0, 225.0], [240.0, 272.0], [290.0, 114.0]], 165.0)?, white)?;
    scene.mesh(block([[423.0, 247.0], [265.0, 296.0], [314.0, 456.0], [472.0, 406.0]], 330.0)?, white)?;
    scene.build()
}

/// Renders in rounds; returns (seconds, relative error) after each.
fn render<C, E>(scene: &Scene, film: &Film, name: &str, walk: Walk<C, E>) -> Result<Vec<(f64, f64)>, Box<dyn std::error::Error>>
where
    C: Scoring<Emission, LightTransport>,
    E: Ending<LightTransport>,
{
    let bar = ProgressBar::new(1000).with_style(ProgressStyle::with_template("{prefix:10} {bar:40} {percent:>3} %  {msg}")?);
    bar.set_prefix(name.to_string());
    let (clock, equation, mut points, mut written) = (Instant::now(), scene.light_transport(), Vec::new(), Ok(()));
    for round in equation.seen_by(film).rounds(&walk)? {
        let round = round?;
        let (seconds, error) = (clock.elapsed().as_secs_f64(), round.estimates.relative_error().unwrap_or(f64::NAN));
        points.push((seconds, error));
        bar.set_position((1000.0 * round.fraction) as u64);
        bar.set_message(format!("{} walks a pixel, error {:.2} %", round.samples, 100.0 * error));
        let exr = round.estimates.write_exr(format!("target/plots/cornell-{name}.exr"));
        written = exr.and(round.estimates.write_png(format!("target/plots/cornell-{name}.png")).map(drop));
    }
    bar.finish();
    let (seconds, error) = points.last().copied().ok_or("no walks")?;
    println!("{name:10} {seconds:.2} s, relative error of a pixel {:.2} %", 100.0 * error);
    Ok(written.map(|()| points)?)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    sigpipe::reset();
    let (size, samples) = (option("--size", 256) as usize, option("--samples", 256));
    let scene = cornell()?;
    let film = scene.film(Camera::look_at([278.0, 273.0, -800.0], [278.0, 273.0, 0.0]).field_of_view(39.3), size, size);
    let roulette = Roulette::throughput(0.5).after(2);
    let plot = Convergence::against_time("The Cornell box").error_label("relative error of a pixel");
    plot.series("collision", render(&scene, &film, "collision", Walk::collision().roulette(roulette).samples_per_cell(samples))?)
        .series("next event", render(&scene, &film, "next-event", Walk::next_event().roulette(roulette).samples_per_cell(samples))?)
        .series("MIS", render(&scene, &film, "MIS", Walk::mis().roulette(roulette).samples_per_cell(samples))?)
        .save("target/plots/cornell-convergence.png")?;
    println!("wrote target/plots/cornell-*.png, cornell-*.exr, cornell-convergence.png");
    Ok(())
}
