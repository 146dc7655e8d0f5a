//! This crate beside other programs: answers the benchmark protocol of the peers' scripts through the public API alone.
//!
//! ```text
//! cargo build --release --example peers
//! target/release/examples/peers toy A pcg64 2000000 7 1      f(x) = 1 + ∫₀¹ ½e^{−|x−y|} f(y) dy at ½ = 1.625: uniform proposal, roulette ½
//! target/release/examples/peers toy B pcg64 2000000 7 1      the same, walked by its own Laplace step, weight 1
//! target/release/examples/peers slab 200000 7 1              analog histories, c = 0.9, a = 10, 100 flux bins, 50 batches
//! ```
//!
//! Prints one comma-separated line a run: name, fredholm, variant, threads, samples, best and median seconds, rates, results.

#![allow(clippy::print_stdout, clippy::print_stderr)]

use fredholm::domain::Interval;
use fredholm::kernel::{Operator, Step, Transition};
use fredholm::sampling::Sampler;
use fredholm::source::source_fn;
use fredholm::transport::{CollisionTally, Flux, Histories, Outcome, Slab, Tally, TrackTally};
use fredholm::walk::{Collision, OwnAbsorption, Roulette};
use fredholm::{Equation, Error, Estimate, Walk};
use std::process::ExitCode;
use std::time::Instant;

/// y = x ± Exp(1), absorbed outside [0, 1]: the kernel ½e^{−|x−y|} is its own sub-density, so weights are 1.
struct Laplace;

impl Operator for Laplace {
    type Point = f64;
    type Weight = f64;
}

impl Transition for Laplace {
    #[inline]
    fn step<S: Sampler>(&self, x: &f64, u: &mut S) -> Option<Step<f64, f64>> {
        let v = u.next_1d();
        let y = x + if v < 0.5 { (2.0 * v).ln() } else { -(2.0 - 2.0 * v).ln() };
        (0.0..=1.0).contains(&y).then(|| Step::new(y, 1.0))
    }
}

/// Seconds of `repetitions` runs, ascending, and the last result.
fn timed<T>(repetitions: usize, mut run: impl FnMut() -> Result<T, Error>) -> Result<(Vec<f64>, T), Error> {
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

fn toy(scheme: &str, walks: u64, repetitions: usize, threads: usize) -> Result<(), Error> {
    let (seconds, e): (Vec<f64>, Estimate) = if scheme == "A" {
        let eq = Equation::on_interval(0.0..=1.0, |_| 1.0, |x, y| 0.5 * f64::exp(-f64::abs(x - y)));
        let walk = Walk::collision().roulette(Roulette::constant(0.5)).samples_per_cell(walks);
        // known after the first solve; a hand-written loop does not ask whether its series converges
        eq.at(0.5).solve(&walk.samples_per_cell(1))?;
        timed(repetitions, || eq.at(0.5).solve(&walk))?
    } else {
        let eq = Equation::new(source_fn(Interval::from(0.0..=1.0), |_: &f64| 1.0), Laplace);
        let walk = Walk::new(Collision, OwnAbsorption).samples_per_cell(walks);
        timed(repetitions, || eq.at(0.5).solve(&walk))?
    };
    let (best, median) = (seconds[0], seconds[repetitions / 2]);
    // scheme B counts the last, absorbed step as the loops do
    let steps = (e.steps + if scheme == "B" { e.samples() } else { 0 }) as f64;
    let (error, variance) = (e.std_error.unwrap_or(f64::NAN), e.variance().unwrap_or(f64::NAN));
    println!(
        "toy{scheme},fredholm,pcg64,{threads},{},{best:.6e},{median:.6e},{:.3},{:.3},{:.4e},{:.10},{error:.3e},{variance:.6}",
        e.samples(),
        best / steps * 1e9,
        median / steps * 1e9,
        e.samples() as f64 / best,
        e.value
    );
    Ok(())
}

fn slab_line<T: Tally>(
    name: &str,
    tally: T,
    sizes: (u64, usize, usize),
    flux: impl Fn(&T::Flux) -> [Option<&Flux>; 2],
) -> Result<(), Error> {
    let (histories, repetitions, threads) = sizes;
    let slab = Slab::new(10.0).scattering(0.9);
    let source = slab.uniform(1.0);
    let method = Histories::new(tally).bins(100).batches(50).histories(histories);
    let (seconds, run): (_, Outcome<T::Flux>) = timed(repetitions, || method.run(&slab, &source))?;
    let (best, median) = (seconds[0], seconds[repetitions / 2]);
    let n = run.histories as f64;
    let merit = |flux: Option<&Flux>| {
        let rv = flux.and_then(Flux::relative_variance).unwrap_or(f64::NAN);
        format!("rv {rv:.3e} FOM {:.4e}", 1.0 / (rv * median))
    };
    let [collision, track] = flux(&run.flux).map(merit);
    println!(
        "slab,fredholm,{name},{threads},{},{best:.6e},{median:.6e},{:.4e},{:.4e},{:.2},{},col {collision},trk {track}",
        run.histories,
        n / best,
        n / median,
        best / run.collisions as f64 * 1e9,
        run.collisions
    );
    Ok(())
}

fn slab(histories: u64, repetitions: usize, threads: usize) -> Result<(), Error> {
    let sizes = (histories, repetitions, threads);
    slab_line("collision", CollisionTally, sizes, |f| [Some(f), None])?;
    slab_line("track", TrackTally, sizes, |f| [None, Some(f)])?;
    slab_line("both", (CollisionTally, TrackTally), sizes, |(c, t)| [Some(c), Some(t)])
}

const USAGE: &str = "usage: peers toy A|B pcg64 WALKS REPETITIONS THREADS | peers slab HISTORIES REPETITIONS THREADS";

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
            on_threads(threads, || toy(scheme, walks, repetitions, threads))
        }
        ["toy", "A" | "B", generator, ..] => Err(format!("generator '{generator}' is not offered: walks draw from pcg64")),
        ["slab", histories, repetitions, threads] => {
            let (histories, repetitions, threads) = (count(histories)?, count(repetitions)?, count(threads)?);
            on_threads(threads, || slab(histories, repetitions, threads))
        }
        [command @ ("determ" | "lu" | "matvec" | "assemble" | "rng" | "render" | "rays"), ..] => {
            Err(format!("'{command}' is not there yet: this program answers toy and slab"))
        }
        _ => Err(USAGE.to_string()),
    }
}

fn main() -> ExitCode {
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
