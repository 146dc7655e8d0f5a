//! Error against time of every method of this crate that makes an image of a scene.
//!
//! Equation: L = Lₑ + T L. Answer: for each method the root mean square error of the pixels over the mean of the image, against an image `NAME.npy` or
//! `NAME_exact.npy` beside the scene (64 × 64), or else against a longer run; as CSV and plot. Photon density keeps the bias of its disks.
//!
//! `cargo run --release --example methods -- tests/data/scenes/cornell.gltf [--seconds 4] [--disk 10]`
#![allow(clippy::print_stdout)]

use fredholm::detector::Detector;
use fredholm::estimator::Metropolis;
use fredholm::sampling::{Layout, Sobol};
use fredholm::scene::{self, Emission, Film, Image, LightTransport, PhotonDensity};
use fredholm::walk::Roulette;
use fredholm::{Bidirectional, Equation, Error, Estimate, Forward, Spectrum, Walk, plot::Convergence};
use std::{fmt::Write, path::Path, time::Instant};

type Picture = Image<Estimate<Spectrum<3>>>;
type Light = Equation<Emission, LightTransport>;

const NAMES: [&str; 8] =
    ["hits", "next event", "MIS", "MIS along Sobol'", "light tracing", "pairs", "Metropolis on pairs", "photon density"];

/// An image by method `k` with about `n` walks a pixel.
fn image(k: usize, (light, film): (&Light, &Film), n: u64, disk: f64) -> Result<Picture, Error> {
    let (query, roulette, walks) = (light.seen_by(film), Roulette::throughput(0.5), n * film.cells() as u64);
    let mis = Walk::mis().roulette(roulette).samples_per_cell(n);
    match k {
        0 => query.solve(&Walk::collision().roulette(roulette).samples_per_cell(n)),
        1 => query.solve(&Walk::next_event().roulette(roulette).samples_per_cell(n)),
        2 => query.solve(&mis),
        3 => query.solve(&mis.sequence(Sobol::new(1).replicates(1).layout(Layout::of_dimension(3).start(2)))),
        4 => query.solve(&Forward::new().walks(walks)),
        5 => query.solve(&Bidirectional::new().samples_per_cell(n)),
        6 => {
            let chains = Metropolis::new().mutations(walks / 32).pool(walks / 64);
            Ok(film.answer(chains.solve(&query.bidirectional(&Bidirectional::new())?.shared())?.cells))
        }
        _ => Ok(query.solve(&PhotonDensity::new(disk).photons(walks / 16).rays_per_pixel(n.div_ceil(16)))?.image),
    }
}

/// A `.npy` file of 64 × 64 colours in single or double precision: 128 bytes, then the numbers.
fn stored(file: &str) -> Option<Vec<f64>> {
    let read = |ending: &str| std::fs::read(Path::new(file).with_extension("").to_string_lossy().into_owned() + ending).ok();
    let single =
        |b: Vec<u8>| b.get(128..).unwrap_or_default().as_chunks::<4>().0.iter().map(|b| f64::from(f32::from_le_bytes(*b))).collect();
    let double = |b: Vec<u8>| b.get(128..).unwrap_or_default().as_chunks::<8>().0.iter().map(|b| f64::from_le_bytes(*b)).collect();
    read("_exact.npy").map(double).or_else(|| read(".npy").map(single)).filter(|n: &Vec<f64>| n.len() == 3 * 64 * 64)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    sigpipe::reset();
    let option = |name: &str| std::env::args().skip_while(|a| a != name).nth(1).map(|v| v.parse::<f64>());
    let file = std::env::args().nth(1).unwrap_or_else(|| "tests/data/scenes/cornell.gltf".into());
    let (seconds, disk) = (option("--seconds").unwrap_or(Ok(4.0))?, option("--disk").unwrap_or(Ok(10.0))?);
    let loaded = scene::load(&file)?;
    let (camera, scene) = (loaded.cameras.first().ok_or("the file has no camera")?.0, loaded.builder.build()?);
    let (light, film) = (scene.light_transport(), scene.film(camera, 64, 64));
    let values = |p: &Picture| p.pixels().iter().flat_map(|p| p.value.0).collect::<Vec<f64>>();
    let truth = stored(&file).map_or_else(|| image(3, (&light, &film), 1 << 12, disk).map(|p| values(&p)), Ok)?;
    let name = Path::new(&file).file_stem().and_then(|s| s.to_str()).unwrap_or("scene");
    let mut plot = Convergence::against_time(&format!("{name}: every method")).error_label("rms error of a pixel / mean of the image");
    let mut table = String::from("method,walks a pixel,seconds,error\n");
    for (k, method) in NAMES.iter().enumerate() {
        let (mut points, begin) = (Vec::new(), Instant::now());
        for n in (2..).map(|i| 1 << i).take_while(|n| *n == 4 || begin.elapsed().as_secs_f64() < 0.5 * seconds) {
            let clock = Instant::now();
            let found = values(&image(k, (&light, &film), n, disk)?);
            let square: f64 = found.iter().zip(&truth).map(|(a, b)| (a - b).powi(2)).sum();
            let error = (square * truth.len() as f64).sqrt() / truth.iter().sum::<f64>();
            points.push((clock.elapsed().as_secs_f64(), error));
            println!("{method:18} {n:6} walks a pixel {:8.3} s, error {error:.4}", clock.elapsed().as_secs_f64());
            writeln!(table, "{method},{n},{},{error}", clock.elapsed().as_secs_f64())?;
        }
        plot = plot.series(method, points);
    }
    let (picture, csv) = (format!("target/plots/methods-{name}.png"), format!("target/plots/methods-{name}.csv"));
    plot.save(picture)?;
    std::fs::write(&csv, table).map_err(|e| format!("{csv}: {e}"))?;
    println!("wrote target/plots/methods-{name}.png and methods-{name}.csv");
    Ok(())
}
