//! Scenes: materials against their laws, furnaces and plates against closed forms, images against stored references, files against nonsense.
#![cfg(feature = "scene")]

#[path = "../common/mod.rs"]
mod common;
mod directions;
mod enclosures;
mod files;
mod furnaces;
mod images;
mod materials;
mod radiosity;
mod references;

use fredholm::scene::{Emission, Film, Image, LightTransport};
use fredholm::{Equation, Estimate, Method, Spectrum};

/// Every method of these tests, erased: one compilation for all of them.
type AnyMethod = Box<dyn Method<Emission, LightTransport, Film, Solution = Image<Estimate<Spectrum<3>>>>>;

fn scene_file(name: &str) -> String {
    format!("{}/tests/data/scenes/{name}", env!("CARGO_MANIFEST_DIR"))
}

/// One film and method applied to an equation.
fn solve(equation: &Equation<Emission, LightTransport>, film: &Film, method: &AnyMethod) -> Image<Estimate<Spectrum<3>>> {
    equation.seen_by(film).solve(method.as_ref()).unwrap()
}
