//! How fast means converge: the slope of the root mean square error over independent randomisations, with its error.

use crate::any::{Any, points};
use crate::common::{Budget, all_pass, slope};
use fredholm::sampling::{Halton, Hammersley, LatinHypercube, Pcg, Sequence, Sobol, Stratified, VanDerCorput};
use std::ops::RangeInclusive;

const REPETITIONS: u64 = 200;

/// ∏ (1 + (x_j − ½) + (x_j² − ⅓)): smooth, of mean 1.
fn smooth(x: &[f64]) -> f64 {
    x.iter().map(|x| 1.0 + (x - 0.5) + (x * x - 1.0 / 3.0)).product()
}

fn errors(sequence: Any, n: u64, d: usize, repetitions: u64) -> Vec<f64> {
    let mean = |seed: u64| points(sequence.with_seed(1000 * n + seed), 0, n, d).iter().map(|x| smooth(x)).sum::<f64>() / n as f64;
    (0..repetitions).map(|seed| mean(seed) - 1.0).collect()
}

/// −1/2 for independent points; −1/2 − 1/d for jittered ones; −3/2 for scrambled van der Corput numbers; at most −1.4 for Sobol' points in the plane, where
/// −3/2 is neared from above by logarithms, and at most −1 in four dimensions; near −1 or steeper for Halton and Hammersley.
#[test]
fn slopes_are_those_of_the_theory() {
    let mut budget = Budget::of("sampling::slopes");
    let measured = |sizes: RangeInclusive<u32>, d: usize, sequence: &dyn Fn(u64) -> Any| {
        slope(&sizes.map(|k| (f64::from(1u32 << k), errors(sequence(1 << k), 1 << k, d, REPETITIONS))).collect::<Vec<_>>())
    };
    let jittered = |m: u64, axes: u32| Any::Stratified(Stratified::new(m, axes).unwrap());
    // squares: n = m²
    let squares: Vec<_> = [4u64, 8, 16, 32].map(|m| ((m * m) as f64, errors(jittered(m, 2), m * m, 2, REPETITIONS))).into();
    let corput = Any::VanDerCorput(VanDerCorput::new(2).unwrap());
    all_pass([
        budget.mean("PCG", measured(4..=11, 2, &|_| Any::Pcg(Pcg::new(0))), -0.5, 0.2),
        budget.mean("jittered line", measured(4..=10, 1, &|n| jittered(n, 1)), -1.5, 0.2),
        budget.mean("jittered plane", slope(&squares), -1.0, 0.25),
        budget.mean("van der Corput", measured(4..=10, 1, &|_| corput), -1.5, 0.2),
        budget.at_most("Sobol', plane", measured(5..=12, 2, &|_| Any::Sobol(Sobol::new(0))), -1.4, 0.2),
        budget.at_most("Sobol', four dimensions", measured(6..=11, 4, &|_| Any::Sobol(Sobol::new(0))), -1.0, 0.25),
        budget.at_most("Halton", measured(5..=11, 2, &|_| Any::Halton(Halton::new(0))), -0.9, 0.25),
        budget.at_most("Hammersley", measured(5..=11, 2, &|n| Any::Hammersley(Hammersley::new(n).unwrap())), -0.9, 0.25),
    ]);
}

/// Owen's bound for Latin hypercubes, Var ≤ σ²/(n − 1) for any f, and far less for sums of functions of one variable (theory (4.14.5)): here, where the
/// additive part is most of the variance, at most half of it.
#[test]
fn latin_hypercubes_keep_their_bound() {
    let mut budget = Budget::of("sampling::rooks");
    let n = 64;
    // one factor is g = 1/6 + x + x², ∫g² = 1/36 + 1/3 + 1/5 + 2(1/12 + 1/18 + 1/4)
    let one: f64 = 1.0 / 36.0 + 1.0 / 3.0 + 0.2 + 2.0 * (1.0 / 12.0 + 1.0 / 18.0 + 0.25);
    let bound = (one.powi(3) - 1.0) / (n - 1) as f64;
    let squares: Vec<f64> = errors(Any::LatinHypercube(LatinHypercube::new(n).unwrap()), n, 3, 2000).iter().map(|e| e * e).collect();
    let mean = squares.iter().sum::<f64>() / 2000.0;
    let scatter = (squares.iter().map(|s| (s - mean).powi(2)).sum::<f64>() / 1999.0 / 2000.0).sqrt();
    budget.at_most("n = 64", (mean, scatter, 1e6), 0.5 * bound, 0.2 * bound).unwrap();
}
