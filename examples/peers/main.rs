//! This crate beside other programs: answers the benchmark protocol of the peers' scripts through the public API alone.
//!
//! ```text
//! cargo build --release --example peers
//! target/release/examples/peers toy A pcg64 2000000 7 1      f(x) = 1 + ∫₀¹ ½e^{−|x−y|} f(y) dy at ½ = 1.625: uniform proposal, roulette ½
//! target/release/examples/peers toy B pcg64 2000000 7 1      the same, walked by its own Laplace step, weight 1
//! target/release/examples/peers slab 200000 7 1              analog histories, c = 0.9, a = 10, 100 flux bins, 50 batches
//! target/release/examples/peers determ b0.1                  Love's equation, d = 0.1, by several deterministic methods
//! target/release/examples/peers lu 1000 2000                 a dense system: assembly, factorisation, condition number, solution
//! target/release/examples/peers rng 20000000                 uniforms, Sobol' and other points by the number
//! target/release/examples/peers render tests/data/scenes/cornell.gltf 64 1 1 out.f32      a scene at 64 × 64, 64 walks a pixel
//! target/release/examples/peers qmc 32                       discrepancies and integration errors of point sets, over 32 randomisations
//! target/release/examples/peers rays folder cornell 5        closest and any hits a second, single and two threads; JSON lines
//! ```
//!
//! Prints one comma-separated line a run: name, fredholm, variant, threads, samples, best and median seconds, rates, results; `determ`:
//! method;unknowns;best s;median s;f at 41 points. Deterministic runs use all cores, or RAYON_NUM_THREADS of them.

#![allow(clippy::print_stdout, clippy::print_stderr)]

mod determ;
mod linalg;
mod qmc;
mod rays;
mod render;
mod rng;
mod slab;
mod toy;

use fredholm::Error;
use std::process::ExitCode;
use std::time::Instant;

/// Seconds of `repetitions` runs, ascending, and the last result.
pub(crate) fn timed<T>(repetitions: usize, mut run: impl FnMut() -> Result<T, Error>) -> Result<(Vec<f64>, T), Error> {
    let mut once = || {
        let clock = Instant::now();
        run().map(|r| (clock.elapsed().as_secs_f64(), r))
    };
    let (first, mut result) = once()?;
    let mut seconds = vec![first];
    for _ in 1..repetitions {
        let (s, r) = once()?;
        seconds.push(s);
        result = r;
    }
    seconds.sort_by(f64::total_cmp);
    Ok((seconds, result))
}

const USAGE: &str = "usage: peers toy A|B pcg64 WALKS REPETITIONS THREADS | peers slab HISTORIES REPETITIONS THREADS | peers determ KEY | \
                     peers lu|matvec|assemble N… | peers rng COUNT | peers qmc RANDOMISATIONS | peers rays FOLDER SCENE REPETITIONS | \
                     peers render SCENE.gltf SAMPLES SEED THREADS OUT.f32";

fn count<T: std::str::FromStr + PartialOrd + From<u8>>(argument: &str) -> Result<T, String> {
    argument.parse().ok().filter(|n| *n >= T::from(1)).ok_or(format!("'{argument}' is not a positive whole number\n{USAGE}"))
}

fn on_threads(threads: usize, run: impl FnOnce() -> Result<(), Error> + Send) -> Result<(), String> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().map_err(|e| e.to_string())?;
    pool.install(run).map_err(|e| e.to_string())
}

fn answer(arguments: &[&str]) -> Result<(), String> {
    match arguments {
        ["toy", scheme @ ("A" | "B"), "pcg64", walks, repetitions, threads] => {
            let (walks, repetitions, threads) = (count(walks)?, count(repetitions)?, count(threads)?);
            on_threads(threads, || toy::toy(scheme, walks, repetitions, threads))
        }
        ["toy", "A" | "B", generator, ..] => Err(format!("generator '{generator}' is not offered: walks draw from pcg64")),
        ["slab", histories, repetitions, threads] => {
            let (histories, repetitions, threads) = (count(histories)?, count(repetitions)?, count(threads)?);
            on_threads(threads, || slab::slab(histories, repetitions, threads))
        }
        ["determ", key] => determ::determ(key),
        [command @ ("lu" | "matvec" | "assemble"), sizes @ ..] if !sizes.is_empty() => {
            let sizes = sizes.iter().map(|n| count(n)).collect::<Result<Vec<usize>, _>>()?;
            linalg::linalg(command, &sizes).map_err(|e| e.to_string())
        }
        ["rng", numbers] => rng::rng(count(numbers)?).map_err(|e| e.to_string()),
        ["render", file, samples, seed, threads, out] => {
            let (samples, threads) = (count(samples)?, count(threads)?);
            let seed = seed.parse().map_err(|_| format!("'{seed}' is not a seed"))?;
            on_threads(threads, || render::render(file, samples, seed, out))
        }
        ["qmc", randomisations] => qmc::qmc(count(randomisations)?).map_err(|e| e.to_string()),
        ["rays", folder, scene, repetitions] => rays::rays(folder, scene, count(repetitions)?),
        _ => Err(USAGE.to_string()),
    }
}

fn main() -> ExitCode {
    sigpipe::reset();
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match answer(&arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("peers: {message}");
            ExitCode::from(2)
        }
    }
}
