//! Images: root mean square error of pixels, relative to the mean of the image, by the methods that see light. The example `methods` adds Metropolis' walk
//! and photon density, and takes any scene.

use crate::curve::{Curve, Family, Point};
use crate::options::Effort;
use crate::peers::Peers;
use crate::problem::Problem;
use fredholm::sampling::{Layout, Sobol};
use fredholm::scene::{Emission, Film, Image, LightTransport, load};
use fredholm::walk::Roulette;
use fredholm::{Bidirectional, Estimate, Forward, Method, Spectrum, Walk};
use std::time::Instant;

/// What makes the problem hard.
pub(crate) const CLASS: &str = "scene";
/// Width and height of the stored images.
const SIZE: usize = 64;

type Picture = Image<Estimate<Spectrum<3>>>;
type Any = Box<dyn Method<Emission, LightTransport, Film, Solution = Picture>>;
/// Walks a pixel and seed.
type Make = fn(u64, u64) -> Any;

#[rustfmt::skip]
const METHODS: [(&str, Family, Make); 6] = [
    ("path tracing, no light sampling", Family::MonteCarlo, |n, seed| Box::new(Walk::collision().roulette(roulette()).samples_per_cell(n).seed(seed))),
    ("path tracing, next event", Family::MonteCarlo, |n, seed| Box::new(Walk::next_event().roulette(roulette()).samples_per_cell(n).seed(seed))),
    ("path tracing, MIS", Family::MonteCarlo, |n, seed| Box::new(Walk::mis().roulette(roulette()).samples_per_cell(n).seed(seed))),
    ("path tracing, MIS, Sobol'", Family::Quasi, |n, seed| Box::new(Walk::mis().roulette(roulette()).samples_per_cell(n).sequence(points(seed)))),
    ("light tracing", Family::MonteCarlo, |n, seed| Box::new(Forward::new().walks(n * (SIZE * SIZE) as u64).seed(seed))),
    ("bidirectional", Family::MonteCarlo, |n, seed| Box::new(Bidirectional::new().samples_per_cell(n).seed(seed))),
];

fn roulette() -> Roulette {
    Roulette::throughput(0.5).after(1)
}

/// Three numbers an event from the third on: the first two place the pixel's ray.
fn points(seed: u64) -> Sobol {
    Sobol::new(seed).replicates(1).layout(Layout::of_dimension(3).start(2))
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

/// A scene, its image, and the standard errors of that if it has any.
pub(crate) struct Stored {
    pub name: &'static str,
    image: &'static str,
    deviation: Option<&'static str>,
}

pub(crate) const SCENES: [Stored; 4] = [
    Stored { name: "plates", image: "plates_exact.npy", deviation: None },
    Stored { name: "cornell", image: "cornell.npy", deviation: Some("cornell_se.npy") },
    Stored { name: "many_lights", image: "many_lights.npy", deviation: Some("many_lights_se.npy") },
    Stored { name: "ajar_door", image: "ajar_door.npy", deviation: Some("ajar_door_se.npy") },
];

/// What images are compared with.
struct Truth {
    values: Vec<f64>,
    mean: f64,
    /// Mean square of its standard errors.
    noise: f64,
}

impl Stored {
    fn truth(&self) -> Result<Truth, String> {
        let values = stored(self.image)?;
        let noise = self.deviation.map(stored).transpose()?.map_or(0.0, |se| se.iter().map(|e| e * e).sum::<f64>() / se.len() as f64);
        Ok(Truth { mean: values.iter().sum::<f64>() / values.len() as f64, values, noise })
    }

    /// All methods on it, and what other programs have measured.
    pub(crate) fn problem(&self, effort: Effort, peers: &Peers) -> Result<Problem, String> {
        let truth = self.truth()?;
        let loaded = load(format!("tests/data/scenes/{}.gltf", self.name)).map_err(|e| e.to_string())?;
        let scene = loaded.builder.build().map_err(|e| e.to_string())?;
        let film = scene.film(loaded.cameras[0].0, SIZE, SIZE);
        let equation = scene.light_transport();
        // what is prepared once for all methods is in the time of none
        equation.seen_by(&film).solve(&*METHODS[0].2(1, 1)).map_err(|e| e.to_string())?;
        let curves = METHODS.iter().map(|(method, family, make)| {
            let mut curve = Curve::new(method, *family);
            let mut n = 1;
            while n <= effort.pixel {
                let clock = Instant::now();
                match equation.seen_by(&film).solve(&*make(n, n)) {
                    Ok(image) => curve.points.push(point(&image, &truth, n, clock.elapsed().as_secs_f64())),
                    Err(e) => curve.refusal = Some(e.to_string()),
                }
                n *= 4;
            }
            curve
        });
        let curves = curves.chain(peers.curves(self.name, truth.mean)).collect();
        Ok(Problem { name: self.name.into(), class: CLASS.into(), curves })
    }
}

/// The noise of the reference is taken off the mean square.
fn point(image: &Picture, Truth { values, mean, noise }: &Truth, n: u64, seconds: f64) -> Point {
    let (ours, count) = (image.pixels().iter().flat_map(|p| p.value.0), values.len() as f64);
    let squares = ours.zip(values).map(|(a, b)| (a - b).powi(2)).sum::<f64>() / count;
    let evaluations = image.pixels().iter().map(|p| p.evaluations).sum::<u64>() as f64;
    let error = (squares - noise).max(0.0).sqrt() / mean;
    let stated = image.pixels().iter().flat_map(|p| p.std_error.map_or([f64::NAN; 3], |s| s.0)).map(|e| e * e).sum::<f64>();
    Point { setting: n.to_string(), seconds, evaluations, error, reported: (stated / count).sqrt() / mean }
}
