//! Dense systems: Love's kernel, d = 0.1, on the midpoints of N equal panels of [−1, 1], and g = 1.
//!
//! `lu` starts from the kernel: assembly on all cores, factorisation, estimated condition number, solution. `lu-solve` is one more source for the
//! same factors. `matvec` and `assemble` form the rows of T again, one at a time and on one core, and apply them: nothing is kept.

use crate::timed;
use fredholm::deterministic::{Nystrom, NystromSolution};
use fredholm::kernel::{HasDomain, Kernel};
use fredholm::source::Source;
use fredholm::{Equation, Error};
use std::f64::consts::PI;

pub(crate) fn linalg(command: &str, sizes: &[usize]) -> Result<(), Error> {
    for &n in sizes {
        match command {
            "lu" => lu(n)?,
            "matvec" => {
                let eq = Equation::on_interval(-1.0..=1.0, |_| 1.0, love);
                apply("matvec rows of the kernel", &eq.solve(&Nystrom::composite(n, 1))?)?;
            }
            _ => {
                let exponential = Equation::on_interval(-1.0..=1.0, |_| 1.0, |x: f64, y: f64| 0.5 * (-(x - y).abs()).exp());
                let product = Equation::on_interval(-1.0..=1.0, |_| 1.0, |x: f64, y: f64| (x * y).exp());
                apply("assemble love", &Equation::on_interval(-1.0..=1.0, |_| 1.0, love).solve(&Nystrom::composite(n, 1))?)?;
                apply("assemble exp(-|t|)", &exponential.solve(&Nystrom::composite(n, 1))?)?;
                apply("assemble exp(xy)", &product.solve(&Nystrom::composite(n, 1))?)?;
            }
        }
    }
    Ok(())
}

fn love(x: f64, y: f64) -> f64 {
    0.1 / (PI * (0.01 + (x - y) * (x - y)))
}

fn lu(n: usize) -> Result<(), Error> {
    let repetitions = match n {
        0..=100 => 201,
        101..=300 => 51,
        301..=1000 => 7,
        1001..=2000 => 5,
        _ => 1,
    };
    let eq = Equation::on_interval(-1.0..=1.0, |_| 1.0, love);
    let method = Nystrom::composite(n, 1);
    let (seconds, f) = timed(repetitions, || eq.factorise(&method)?.solve(eq.source()))?;
    let mut residual = 0.0f64;
    for (x, value) in f.nodes().zip(f.values()) {
        residual = residual.max((1.0 + f.integral_term(x)? - value).abs());
    }
    let threads = rayon::current_num_threads();
    print("lu", threads, n, &seconds, residual);
    let factors = eq.factorise(&method)?;
    let (seconds, _) = timed(repetitions, || factors.solve(eq.source()))?;
    print("lu-solve", 1, n, &seconds, residual);
    Ok(())
}

/// T f at all nodes.
fn apply<G, K>(what: &str, f: &NystromSolution<G, K>) -> Result<(), Error>
where
    G: Source<Value = f64, Point = f64>,
    K: Kernel<Point = f64, Weight = f64> + HasDomain,
{
    let n = f.unknowns();
    let repetitions = (100_000_000 / (n * n)).clamp(3, 501);
    let (seconds, values) = timed(repetitions, || f.nodes().map(|x| f.integral_term(x)).collect::<Result<Vec<_>, _>>())?;
    print(what, 1, n, &seconds, values[n / 2]);
    Ok(())
}

fn print(what: &str, threads: usize, n: usize, seconds: &[f64], check: f64) {
    println!("{what},fredholm,{threads},{n},{},{:.6e},{:.6e},{check:.3e}", seconds.len(), seconds[0], seconds[seconds.len() / 2]);
}
