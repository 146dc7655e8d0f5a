//! Any glTF or OBJ file by path tracing, with a progress bar; stops at a target error.
//!
//! Equation: L = Lₑ + T L, radiance in the scene. Answer: an image as PNG and EXR, with the standard error of every pixel as a layer.
//!
//! `cargo run --release --example render -- scene.gltf [--width 320] [--samples 1024] [--error 0.02] [--environment sky.exr]`
#![allow(clippy::print_stdout)]

use fredholm::scene::{self, Camera, Environment};
use fredholm::{Walk, walk::Roulette};
use indicatif::{ProgressBar, ProgressStyle};
use std::{path::Path, str::FromStr};

fn option<T: FromStr>(name: &str, default: T) -> T {
    let value = std::env::args().skip_while(|a| a != name).nth(1);
    value.map_or(default, |v| v.parse().unwrap_or_else(|_| panic!("{name} needs a number, not {v}")))
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    sigpipe::reset();
    let file = std::env::args().nth(1).unwrap_or_else(|| "tests/data/scenes/cornell.gltf".into());
    let mut loaded = scene::load(&file)?;
    println!("{file}: {}", loaded.report);
    let (camera, aspect) = loaded.cameras.first().copied().unwrap_or_else(|| {
        println!("no camera: looking at the origin from (3, 2, 5)");
        (Camera::look_at([3.0, 2.0, 5.0], [0.0; 3]), None)
    });
    let sky = std::env::args().skip_while(|a| a != "--environment").nth(1);
    if let Some(sky) = &sky {
        let hdr = sky.to_ascii_lowercase().ends_with(".hdr");
        loaded.builder.environment(if hdr { Environment::read_hdr(sky)? } else { Environment::read_exr(sky)? });
    } else if loaded.builder.is_dark() {
        println!("no light: under a white sky");
        loaded.builder.environment(Environment::constant([1.0; 3]));
    }
    let scene = loaded.builder.build()?;
    println!("{scene}");
    let width: usize = option("--width", 320);
    let height = (width as f64 / aspect.unwrap_or(4.0 / 3.0)).round().max(1.0) as usize;
    let (film, equation) = (scene.film(camera, width, height), scene.light_transport());
    let walk = Walk::mis().roulette(Roulette::throughput(0.5).after(2)).samples_per_cell(option("--samples", 1024));
    let (wanted, query) = (option("--error", 0.02), equation.seen_by(&film));
    let bar = ProgressBar::new(1000).with_style(ProgressStyle::with_template("{bar:40} {percent:>3} %  {msg}")?);
    let mut image = None;
    for round in query.rounds(&walk)? {
        let round = round?;
        let error = round.estimates.relative_error().unwrap_or(f64::INFINITY);
        // the error falls as n^(−1/2): what is done is n over the n that it takes
        bar.set_position((1000.0 * round.fraction.max((wanted / error).powi(2)).min(1.0)) as u64);
        bar.set_message(format!("{} walks a pixel, error {:.2} % of {:.2} %", round.samples, 100.0 * error, 100.0 * wanted));
        image = Some(round.estimates);
        if error <= wanted {
            break;
        }
    }
    bar.abandon();
    let image = image.ok_or("no walks were asked for")?;
    let name = Path::new(&file).file_stem().and_then(|s| s.to_str()).unwrap_or("scene");
    println!("mean error of a pixel {:.2} %", 100.0 * image.relative_error().unwrap_or(f64::NAN));
    let clipped = image.write_png(format!("target/plots/{name}.png"))?;
    image.write_exr(format!("target/plots/{name}.exr"))?;
    println!("wrote target/plots/{name}.png ({clipped} pixels outside [0, 1]) and {name}.exr");
    Ok(())
}
