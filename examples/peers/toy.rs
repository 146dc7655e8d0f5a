//! Two short walks, timed by the step.

use crate::timed;
use fredholm::domain::Interval;
use fredholm::kernel::{Operator, Step, Transition};
use fredholm::sampling::Sampler;
use fredholm::source::source_fn;
use fredholm::walk::{Collision, OwnAbsorption, Roulette};
use fredholm::{Equation, Error, Estimate, Walk};

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

pub(crate) fn toy(scheme: &str, walks: u64, repetitions: usize, threads: usize) -> Result<(), Error> {
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
