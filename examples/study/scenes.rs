//! Images: root mean square error of pixels, relative to the mean of the image, by the methods that see light.

use crate::curve::{Curve, Family, Point};
use crate::options::Effort;
use crate::problem::Problem;
use fredholm::scene::{Emission, Film, Image, LightTransport, load};
use fredholm::walk::Roulette;
use fredholm::{Bidirectional, Estimate, Forward, Method, Spectrum, Walk};
use std::time::Instant;

/// Width and height of the stored images.
const SIZE: usize = 64;

type Picture = Image<Estimate<Spectrum<3>>>;
type Any = Box<dyn Method<Emission, LightTransport, Film, Solution = Picture>>;
/// Walks a pixel and seed.
type Make = fn(u64, u64) -> Any;

#[rustfmt::skip]
const METHODS: [(&str, Make); 5] = [
    ("path tracing, no light sampling", |n, seed| Box::new(Walk::collision().roulette(roulette()).samples_per_cell(n).seed(seed))),
    ("path tracing, next event", |n, seed| Box::new(Walk::next_event().roulette(roulette()).samples_per_cell(n).seed(seed))),
    ("path tracing, MIS", |n, seed| Box::new(Walk::mis().roulette(roulette()).samples_per_cell(n).seed(seed))),
    ("light tracing", |n, seed| Box::new(Forward::new().walks(n * (SIZE * SIZE) as u64).seed(seed))),
    ("bidirectional", |n, seed| Box::new(Bidirectional::new().samples_per_cell(n).seed(seed))),
];

fn roulette() -> Roulette {
    Roulette::throughput(0.5).after(1)
}

/// A `.npy` file: a header of 128 bytes, then little-endian values.
fn stored(name: &str) -> Result<Vec<f64>, String> {
    let path = format!("tests/data/scenes/{name}");
    let bytes = std::fs::read(&path).map_err(|e| format!("{path}: {e}"))?;
    let body = bytes.get(128..).ok_or_else(|| format!("{path}: too short"))?;
    match body.len() / (3 * SIZE * SIZE) {
        4 => Ok(body.as_chunks::<4>().0.iter().map(|b| f64::from(f32::from_le_bytes(*b))).collect()),
        8 => Ok(body.as_chunks::<8>().0.iter().map(|b| f64::from_le_bytes(*b)).collect()),
        n => Err(format!("{path}: {n} bytes a number")),
    }
}

/// Scene, reference, its standard errors if it has any.
const SCENES: [(&str, &str, Option<&str>); 3] = [
    ("plates", "plates_exact.npy", None),
    ("cornell", "cornell.npy", Some("cornell_se.npy")),
    ("ajar_door", "ajar_door.npy", Some("ajar_door_se.npy")),
];

/// All methods on all scenes, one after the other.
pub(crate) fn all(effort: Effort) -> impl Iterator<Item = Result<Problem, String>> {
    SCENES.into_iter().map(move |(name, truth, deviation)| {
        let truth = stored(truth)?;
        let noise = deviation.map(stored).transpose()?.map_or(0.0, |se| se.iter().map(|e| e * e).sum::<f64>() / se.len() as f64);
        let loaded = load(format!("tests/data/scenes/{name}.gltf")).map_err(|e| e.to_string())?;
        let scene = loaded.builder.build().map_err(|e| e.to_string())?;
        let film = scene.film(loaded.cameras[0].0, SIZE, SIZE);
        let equation = scene.light_transport();
        let curves = METHODS.iter().map(|(method, make)| {
            let mut curve = Curve::new(method, Family::MonteCarlo);
            let mut n = 1;
            while n <= effort.pixel {
                let clock = Instant::now();
                match equation.seen_by(&film).solve(&*make(n, n)) {
                    Ok(image) => curve.points.push(point(&image, &truth, noise, n, clock.elapsed().as_secs_f64())),
                    Err(e) => curve.refusal = Some(e.to_string()),
                }
                n *= 4;
            }
            curve
        });
        Ok(Problem { name: name.into(), class: "scene".into(), curves: curves.collect() })
    })
}

/// The noise of the reference is taken off the mean square.
fn point(image: &Picture, truth: &[f64], noise: f64, n: u64, seconds: f64) -> Point {
    let ours = image.pixels().iter().flat_map(|p| p.value.0);
    let squares = ours.zip(truth).map(|(a, b)| (a - b).powi(2)).sum::<f64>() / truth.len() as f64;
    let mean = truth.iter().sum::<f64>() / truth.len() as f64;
    let evaluations = image.pixels().iter().map(|p| p.evaluations).sum::<u64>() as f64;
    let error = (squares - noise).max(0.0).sqrt() / mean;
    Point { setting: n.to_string(), seconds, evaluations, error, reported: f64::NAN }
}
