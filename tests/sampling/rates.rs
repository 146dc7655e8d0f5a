//! How fast means converge: the slope of the root mean square error over independent randomisations, with its error.

use crate::any::{Any, points};
use fredholm::sampling::{Halton, Hammersley, LatinHypercube, Pcg, Sequence, Sobol, Stratified, VanDerCorput};
use fredholm::statistics::Rate;

/// ∏ (1 + (x_j − ½) + (x_j² − ⅓)): smooth, of mean 1.
fn smooth(x: &[f64]) -> f64 {
    x.iter().map(|x| 1.0 + (x - 0.5) + (x * x - 1.0 / 3.0)).product()
}

fn rms(sequence: Any, n: u64, d: usize, repetitions: u64) -> f64 {
    let error = |seed: u64| points(sequence.with_seed(1000 * n + seed), 0, n, d).iter().map(|x| smooth(x)).sum::<f64>() / n as f64 - 1.0;
    ((0..repetitions).map(|s| error(s).powi(2)).sum::<f64>() / repetitions as f64).sqrt()
}

/// The slope, and ±6 standard errors around it: a false alarm would be one in 10⁸ (normal tails).
fn slope(sizes: std::ops::RangeInclusive<u32>, d: usize, sequence: impl Fn(u64) -> Any) -> [f64; 2] {
    let fit = Rate::fit(sizes.map(|k| (f64::from(1u32 << k), rms(sequence(1 << k), 1 << k, d, 100)))).unwrap();
    [fit.slope - 6.0 * fit.std_error, fit.slope + 6.0 * fit.std_error]
}

fn holds(range: [f64; 2], value: f64) -> bool {
    range[0] <= value && value <= range[1] && range[1] - range[0] < 0.8
}

/// −1/2 for independent points; −1/2 − 1/d for jittered ones; near −1 or steeper for Halton and Hammersley; −3/2 for scrambled van der
/// Corput and Sobol' points (up to logarithms), ≤ −1.4; −1/2 for Latin hypercubes in several variables, with a constant smaller by the
/// additive part.
#[test]
fn slopes_are_those_of_the_theory() {
    let pcg = slope(4..=11, 2, |_| Any::Pcg(Pcg::new(0)));
    assert!(holds(pcg, -0.5), "PCG {pcg:?}");
    let jittered = slope(4..=10, 1, |n| Any::Stratified(Stratified::new(n, 1).unwrap()));
    assert!(holds(jittered, -1.5), "jittered 1-D {jittered:?}");
    let jittered = slope(2..=5, 2, |n| Any::Stratified(Stratified::new((n as f64).sqrt() as u64, 2).unwrap()));
    assert!(jittered[0] < -0.5, "jittered 2-D {jittered:?}");
    let corput = slope(4..=10, 1, |_| Any::VanDerCorput(VanDerCorput::new(2).unwrap()));
    assert!(holds(corput, -1.5), "van der Corput {corput:?}");
    let sobol = slope(5..=11, 2, |_| Any::Sobol(Sobol::new(0)));
    assert!(sobol[0] < -1.4 && sobol[1] < -1.2 && holds(sobol, (sobol[0] + sobol[1]) / 2.0), "Sobol' {sobol:?}");
    let sobol = slope(6..=11, 4, |_| Any::Sobol(Sobol::new(0)));
    assert!(sobol[0] < -1.0 && sobol[1] < -0.6, "Sobol' 4-D {sobol:?}");
    for (name, slope) in [
        ("Halton", slope(5..=11, 2, |_| Any::Halton(Halton::new(0)))),
        ("Hammersley", slope(5..=11, 2, |n| Any::Hammersley(Hammersley::new(n).unwrap()))),
    ] {
        assert!(slope[0] < -0.95 && slope[1] < -0.8, "{name} {slope:?}");
    }
}

/// Owen's bound for Latin hypercubes, Var ≤ σ²/(n − 1) for any f, and far less for sums of functions of one variable (theory (4.14.5)).
#[test]
fn latin_hypercubes_keep_their_bound() {
    let n = 64;
    // one factor is g = 1/6 + x + x², ∫g² = 1/36 + 1/3 + 1/5 + 2(1/12 + 1/18 + 1/4)
    let one: f64 = 1.0 / 36.0 + 1.0 / 3.0 + 0.2 + 2.0 * (1.0 / 12.0 + 1.0 / 18.0 + 0.25);
    let variance = one.powi(3) - 1.0;
    let hypercube = rms(Any::LatinHypercube(LatinHypercube::new(n).unwrap()), n, 3, 2000).powi(2);
    // 2000 repetitions: the relative error of a variance is about √(2/2000), 6 of which are 19 %
    assert!(hypercube < 1.19 * variance / (n - 1) as f64, "{hypercube} against {}", variance / (n - 1) as f64);
    assert!(hypercube < 0.5 * variance / n as f64, "the additive part is most of the variance here");
}
