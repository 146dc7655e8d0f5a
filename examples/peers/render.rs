//! A scene by path tracing along Sobol' points, one randomisation a pixel: the smallest error for the time, and none that is stated.

use fredholm::scene::{self, Image};
use fredholm::sampling::{Layout, Sobol};
use fredholm::{Error, Estimate, Spectrum, Walk, walk::Roulette};
use std::time::Instant;

/// What the scenes of the protocol are rendered at.
const SIZE: usize = 64;

pub(crate) fn render(file: &str, samples: u64, seed: u64, out: &str) -> Result<(), Error> {
    let loaded = scene::load(file)?;
    let camera = loaded.cameras.first().map_or_else(|| scene::Camera::look_at([0.0, 0.0, 5.0], [0.0; 3]), |c| c.0);
    let scene = loaded.builder.build()?;
    let (equation, film) = (scene.light_transport(), scene.film(camera, SIZE, SIZE));
    let clock = Instant::now();
    // a pixel takes two coordinates, a step and a next event three each
    let points = Sobol::new(seed).replicates(1).layout(Layout::of_dimension(3).start(2));
    let walk = Walk::mis().roulette(Roulette::throughput(0.5)).samples_per_cell(samples).sequence(points);
    let image: Image<Estimate<Spectrum<3>>> = equation.seen_by(&film).solve(&walk)?;
    println!("seconds={}", clock.elapsed().as_secs_f64());
    let bytes: Vec<u8> = image.pixels().iter().flat_map(|p| p.value.0).flat_map(|v| (v as f32).to_le_bytes()).collect();
    std::fs::write(out, bytes).map_err(|e| Error::Io { path: out.into(), message: e.to_string() })
}
