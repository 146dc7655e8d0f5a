//! Scenes: materials against their laws, furnaces and plates against closed forms, images against stored references, files against nonsense.
#![cfg(feature = "scene")]

#[path = "../common/mod.rs"]
mod common;
mod directions;
mod files;
mod furnaces;
mod images;
mod materials;
mod radiosity;
mod references;

use fredholm::scene::{Emission, Film, Image, LightTransport};
use fredholm::walk::{Heuristic, Roulette};
use fredholm::{Equation, Estimate, Method, Spectrum, Walk, sampling::Sobol};

/// Every method of these tests, erased: one compilation for all of them.
type AnyMethod = Box<dyn Method<Emission, LightTransport, Film, Solution = Image<Estimate<Spectrum<3>>>>>;

fn scene_file(name: &str) -> String {
    format!("{}/tests/data/scenes/{name}", env!("CARGO_MANIFEST_DIR"))
}

/// The path tracers: by its own hits, by next event, by both under three heuristics, along Sobol' points.
fn methods(samples: u64, reference: f64) -> Vec<(&'static str, AnyMethod)> {
    let roulette = Roulette::throughput(reference);
    let mis = Walk::mis().roulette(roulette).samples_per_cell(samples);
    vec![
        ("collision", Box::new(Walk::collision().roulette(roulette).samples_per_cell(samples).seed(1))),
        ("next event", Box::new(Walk::next_event().roulette(roulette).samples_per_cell(samples).seed(2))),
        ("MIS balance", Box::new(mis.seed(3))),
        ("MIS power", Box::new(mis.heuristic(Heuristic::Power(2.0)).seed(4))),
        ("MIS maximum", Box::new(mis.heuristic(Heuristic::Maximum).seed(5))),
        ("MIS Sobol'", Box::new(mis.sequence(Sobol::new(6)))),
    ]
}

/// One film and method applied to an equation.
fn solve(equation: &Equation<Emission, LightTransport>, film: &Film, method: &AnyMethod) -> Image<Estimate<Spectrum<3>>> {
    equation.seen_by(film).solve(method.as_ref()).unwrap()
}
