//! A scene by the method that suits it: hits where everything shines, MIS, or light tracing where lights are hidden. A few walks of each, on a picture of a
//! sixteenth of the pixels, find out. The clock runs all the while; the choice is printed.
//!
//! Backward walks go along Sobol' points, one randomisation a pixel: the smallest error for the time, and none that is stated.

use fredholm::sampling::{Layout, Sobol};
use fredholm::scene::{self, Emission, Film, Image, LightTransport};
use fredholm::{Equation, Error, Estimate, Forward, Spectrum, Walk, detector::Detector, walk::Roulette};
use std::time::Instant;

type Picture = Image<Estimate<Spectrum<3>>>;
type Question<'a> = (&'a Equation<Emission, LightTransport>, &'a Film);

/// What the scenes of the protocol are rendered at.
const SIZE: usize = 64;
const METHODS: [&str; 3] = ["hits", "MIS", "light tracing"];

/// The image by method `k` with so many walks a pixel.
fn image(k: usize, (light, film): Question<'_>, samples: u64, randomisations: u32, seed: u64) -> Result<Picture, Error> {
    let (query, roulette) = (light.seen_by(film), Roulette::throughput(0.5));
    // a pixel takes two coordinates, a step and a next event three each
    let (layout, points) = (Layout::of_dimension(3).start(2), Sobol::new(seed).replicates(randomisations));
    match k {
        0 => query.solve(&Walk::collision().roulette(roulette).samples_per_cell(samples).sequence(points.layout(layout.event(0)))),
        1 => query.solve(&Walk::mis().roulette(roulette).samples_per_cell(samples).sequence(points.layout(layout))),
        _ => query.solve(&Forward::new().walks(samples * film.cells() as u64).seed(seed)),
    }
}

/// Its squared error times seconds, which more walks do not change; infinite where nothing was found.
fn price(k: usize, question: Question<'_>, seed: u64) -> Result<f64, Error> {
    let clock = Instant::now();
    let tried = image(k, question, 4, 4, seed)?;
    let square = |e: Spectrum<3>| e.0.iter().map(|e| e * e).sum::<f64>();
    let price = tried.pixels().iter().filter_map(|p| p.std_error).map(square).sum::<f64>() * clock.elapsed().as_secs_f64();
    Ok(if price > 0.0 { price } else { f64::INFINITY })
}

/// The cheapest method on a picture of a sixteenth of the pixels.
fn choice(question: Question<'_>, seed: u64) -> Result<usize, Error> {
    let prices = (0..METHODS.len()).map(|k| price(k, question, seed)).collect::<Result<Vec<_>, _>>()?;
    Ok((0..METHODS.len()).min_by(|&a, &b| prices[a].total_cmp(&prices[b])).unwrap_or(1))
}

pub(crate) fn render(file: &str, samples: u64, seed: u64, out: &str) -> Result<(), Error> {
    let loaded = scene::load(file)?;
    let camera = loaded.cameras.first().map_or_else(|| scene::Camera::look_at([0.0, 0.0, 5.0], [0.0; 3]), |c| c.0);
    let scene = loaded.builder.build()?;
    let (light, film) = (scene.light_transport(), scene.film(camera, SIZE, SIZE));
    let clock = Instant::now();
    let best = choice((&light, &scene.film(camera, SIZE / 4, SIZE / 4)), !seed)?;
    let image = image(best, (&light, &film), samples, 1, seed)?;
    println!("method={}\nseconds={}", METHODS[best], clock.elapsed().as_secs_f64());
    let bytes: Vec<u8> = image.pixels().iter().flat_map(|p| p.value.0).flat_map(|v| (v as f32).to_le_bytes()).collect();
    std::fs::write(out, bytes).map_err(|e| Error::Io { path: out.into(), message: e.to_string() })
}
