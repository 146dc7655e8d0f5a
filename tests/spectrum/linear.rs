//! Systems that are too large for elimination: what is chosen, and that it solves the same equation.

use crate::erased::{Equation, source_fn};
use fredholm::Error;
use fredholm::deterministic::{Nystrom, NystromSolution};
use fredholm::domain::Interval;
use fredholm::kernel::HasDomain;
use std::f64::consts::PI;

type Kernel = fn(f64, f64) -> f64;

/// f by a rule, what the solution says of its linear algebra, and f at some places.
fn solved(k: Kernel, rule: &Nystrom) -> Result<(String, Vec<f64>), Error> {
    let eq = Equation::on_interval(-1.0..=1.0, |x: f64| x.cos(), k);
    let f = eq.solve(rule)?;
    fits(&f);
    assert!(f.to_string().contains(f.linear_algebra()));
    Ok((f.linear_algebra().to_string(), [-1.0, -0.3, 0.0, 0.72, 1.0].map(|x| f.eval(x)).to_vec()))
}

/// f_j = g(x_j) + Σ w K f at some nodes, by rows of the kernel itself.
fn fits<G, K>(f: &NystromSolution<G, K>)
where
    G: fredholm::source::Source<Point = f64, Value = f64>,
    K: fredholm::kernel::Kernel<Point = f64, Weight = f64> + HasDomain,
{
    let n = f.values().len();
    for (x, value) in f.nodes().zip(f.values()).step_by(n / 7) {
        let residual = (x.cos() + f.integral_term(x).unwrap() - value).abs();
        assert!(residual < 1e-12 * f.magnitude() * f.condition(), "{x}: {residual:e}");
    }
}

fn love(x: f64, y: f64) -> f64 {
    0.1 / (PI * (0.01 + (x - y) * (x - y)))
}

#[test]
fn the_choice_follows_the_kernel() {
    let small = Nystrom::composite(300, 8);
    for (kernel, rule, words) in [
        (love as Kernel, Nystrom::composite(9001, 1), "FFT and GMRES with a coarse inverse"),
        (|x, y| 0.3 * (x * y).exp(), Nystrom::composite(500, 8), "a kernel of rank 1"),
        (|x, y| 1.0 + x - y * x * x, Nystrom::composite(4000, 1), "a kernel of rank "),
        (|x, y: f64| 0.4 * f64::exp(-(x - y).abs()) * (2.0 + x), Nystrom::composite(400, 8), "LU"),
    ] {
        let (how, values) = solved(kernel, &rule).unwrap();
        assert!(how.starts_with(words), "{how}, not {words}");
        let (_, known) = solved(kernel, &small).unwrap();
        // midpoints and kinks: second order
        assert!(values.iter().zip(&known).all(|(v, k)| (v - k).abs() < 2e-5 * k.abs().max(1.0)), "{how}: {values:?} {known:?}");
    }
}

#[test]
fn gmres_beyond_elimination() {
    let kernel: Kernel = |x, y| 5.4 * f64::exp(-3.0 * (x - y).abs()) * (x * y).cos();
    let (how, values) = solved(kernel, &Nystrom::composite(760, 8)).unwrap();
    assert!(how.starts_with("GMRES with a coarse inverse of"), "{how}");
    let (_, known) = solved(kernel, &Nystrom::graded(8, 12).levels(0)).unwrap();
    assert!(values.iter().zip(&known).all(|(v, k)| (v - k).abs() < 1e-5 * k.abs()), "{values:?} {known:?}");
}

#[test]
fn many_sources_share_the_work() {
    let eq = Equation::on_interval(-1.0..=1.0, |_| 1.0, love);
    let factors = eq.factorise(&Nystrom::composite(20_000, 1)).unwrap();
    let ones = factors.solve(eq.source()).unwrap();
    // problems §2 B: f(0), f(½) of Love's equation with d = 0.1
    assert!((ones.eval(0.0) - 11.169_543_954_298_8).abs() < 1e-7 && (ones.eval(0.5) - 9.908_244_460_184_26).abs() < 1e-7);
    let linear = factors.solve(&source_fn(Interval::from(-1.0..=1.0), |x: &f64| 2.0 - x)).unwrap();
    let odd = factors.solve(&source_fn(Interval::from(-1.0..=1.0), |x: &f64| *x)).unwrap();
    let difference = |x: f64| (linear.eval(x) + odd.eval(x) - 2.0 * ones.eval(x)).abs();
    assert!([-0.9, 0.1, 0.66].iter().all(|x| difference(*x) < 1e-11));
    assert!(factors.rcond() > 1e-3 && factors.unknowns() == 20_000 && ones.evaluations() < 100 * 20_000);
    assert!((ones.inverse_norm() / 11.17 - 1.0).abs() < 0.05, "{}", ones.inverse_norm());
}

#[test]
fn refusals() {
    // no structure, and no room
    let kink = Equation::on_interval(-1.0..=1.0, |_| 1.0, |x: f64, y: f64| 0.1 * (x - y).abs() * (x * x + y).exp());
    let refused = kink.solve(&Nystrom::composite(20_000, 1));
    assert!(matches!(refused, Err(Error::Invalid { parameter: "unknowns", value: 20_000.0, .. })), "{refused:?}");
    let endless = kink.solve(&Nystrom::composite(usize::MAX / 4, 1));
    assert!(matches!(endless, Err(Error::Invalid { parameter: "unknowns", .. })));
    // 1 in the spectrum: constants
    let singular = Equation::on_interval(0.0..=1.0, |_| 1.0, |_, _| 1.0).solve(&Nystrom::composite(5000, 1));
    assert!(
        matches!(&singular, Err(Error::Singular { alternative: Some(a), .. }) if a.null.len() == 1 && !a.is_solvable()),
        "{singular:?}"
    );
    // infinite on the diagonal, and off it
    let log = Equation::on_interval(0.0..=1.0, |_| 1.0, |x: f64, y: f64| (x - y).abs().ln());
    assert!(matches!(log.solve(&Nystrom::composite(5000, 1)), Err(Error::NonFiniteKernel { .. })));
    let broken = Equation::on_interval(0.0..=1.0, |_| 1.0, |x: f64, y: f64| if (x - y).abs() > 0.9 { f64::NAN } else { 0.1 });
    assert!(matches!(broken.solve(&Nystrom::composite(5000, 1)), Err(Error::NonFiniteKernel { .. })));
}

#[cfg(feature = "parallel")]
#[test]
fn threads_do_not_change_a_bit() {
    let kink: Kernel = |x, y| 0.4 * f64::exp(-(x - y).abs()) * (2.0 + x);
    for (kernel, rule) in [
        (love as Kernel, Nystrom::composite(4000, 1)),
        (|x, y| 0.3 * (x * y).exp(), Nystrom::composite(500, 8)),
        (kink, Nystrom::composite(755, 8)),
    ] {
        let bits = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| solved(kernel, &rule)).unwrap().1.iter().map(|v| v.to_bits()).collect::<Vec<_>>()
        };
        assert_eq!(bits(1), bits(3));
    }
}
