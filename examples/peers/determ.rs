//! One-dimensional equations by deterministic methods: time of assembly and solution, and f at 41 equispaced points, ends included.
//!
//! | key | K | f = |
//! |---|---|---|
//! | a | ½ e^{xy} on [0, 1] | eˣ |
//! | b*d* | (d/π)/(d² + (x − y)²) on [−1, 1], g = 1 (Love) | |
//! | c | 5 min(x, y) (1 − max(x, y)), g = 1 (a Green's function) | cos(√5 (x − ½))/cos(√5/2) |
//! | d1 | 0.2 |x − y|^{−1/2}, g = 1 | |
//! | d2 | −0.3 ln |x − y|, g = 1 | |
//! | e*a*_*c* | (c/2) E₁(|x − y|) on [0, a], g = 1 (a slab) | |

use fredholm::deterministic::{Nystrom, NystromSolution};
use fredholm::kernel::{HasDomain, Kernel};
use fredholm::source::Source;
use fredholm::transport::Slab;
use fredholm::{Equation, Error};
use std::f64::consts::PI;
use std::time::Instant;

/// A label and the rule.
type Methods = Vec<(String, Nystrom)>;

pub(crate) fn determ(key: &str) -> Result<(), String> {
    match key {
        "a" => {
            let g = |x: f64| x.exp() - 0.5 * (x + 1.0).exp_m1() / (x + 1.0);
            answer(&Equation::on_interval(0.0..=1.0, g, |x: f64, y: f64| 0.5 * (x * y).exp()), (0.0, 1.0), &smooth(&[8, 12, 16, 32], &[]));
        }
        "c" => {
            let k = |x: f64, y: f64| 5.0 * x.min(y) * (1.0 - x.max(y));
            answer(&Equation::on_interval(0.0..=1.0, |_| 1.0, k), (0.0, 1.0), &graded(&[(1, 8, 0), (2, 12, 0), (4, 12, 0)]));
        }
        "d1" => {
            let k = |x: f64, y: f64| 0.2 / (x - y).abs().sqrt();
            answer(
                &Equation::on_interval(0.0..=1.0, |_| 1.0, k),
                (0.0, 1.0),
                &graded(&[(2, 4, 5), (2, 6, 8), (2, 8, 16), (2, 12, 24), (2, 16, 36)]),
            );
        }
        "d2" => {
            let k = |x: f64, y: f64| -0.3 * (x - y).abs().ln();
            answer(
                &Equation::on_interval(0.0..=1.0, |_| 1.0, k),
                (0.0, 1.0),
                &graded(&[(2, 5, 4), (2, 6, 6), (2, 8, 12), (2, 12, 16), (2, 16, 20)]),
            );
        }
        _ => return family(key),
    }
    Ok(())
}

/// b*d* and e*a*_*c*.
fn family(key: &str) -> Result<(), String> {
    let number = |text: &str| text.parse::<f64>().ok().filter(|v| *v > 0.0 && v.is_finite());
    if let Some(d) = key.strip_prefix('b').and_then(number) {
        let k = move |x: f64, y: f64| d / PI / (d * d + (x - y) * (x - y));
        let n = |factor: f64| (factor / d).ceil() as usize;
        let methods = smooth(&[n(6.0).max(16), n(12.8).max(24), n(24.0).max(32)], &[(n(1.0).max(2), 16), (n(2.0).max(4), 16)]);
        answer(&Equation::on_interval(-1.0..=1.0, |_| 1.0, k), (-1.0, 1.0), &methods);
        return Ok(());
    }
    if let Some((a, c)) = key.strip_prefix('e').and_then(|k| k.split_once('_'))
        && let (Some(a), Some(c)) = (number(a), number(c))
    {
        let slab = Slab::new(a).scattering(c);
        let panels = 2 + a.sqrt().ceil() as usize;
        let methods = graded(&[(panels, 4, 4), (panels, 6, 6), (panels, 8, 12), (panels, 12, 16), (2 * panels, 16, 20)]);
        answer(&Equation::new(slab.uniform(1.0), slab.clone()), (0.0, a), &methods);
        return Ok(());
    }
    Err(format!("no problem '{key}': a, b1.0, b0.1, b0.01, c, d1, d2, e1_0.5, e10_0.9, …"))
}

fn smooth(nodes: &[usize], panels: &[(usize, usize)]) -> Methods {
    let gauss = nodes.iter().map(|n| (format!("fredholm gauss {n}"), Nystrom::gauss_legendre(*n)));
    let composite = panels.iter().map(|(p, n)| (format!("fredholm composite {p} x {n}"), Nystrom::composite(*p, *n)));
    gauss.chain(composite).chain(adaptive()).collect()
}

/// Panels, order, levels at the ends.
fn graded(rules: &[(usize, usize, usize)]) -> Methods {
    let label = |(p, n, l): (usize, usize, usize)| format!("fredholm graded {p} x {n}, {l} levels");
    rules.iter().map(|r| (label(*r), Nystrom::graded(r.0, r.1).levels(r.2))).chain(adaptive()).collect()
}

fn adaptive() -> impl Iterator<Item = (String, Nystrom)> {
    [1e-6, 1e-9, 1e-12].into_iter().map(|tolerance| (format!("fredholm adaptive {tolerance:e}"), Nystrom::adaptive().tolerance(tolerance)))
}

/// One line a method; what a method refuses to answer goes to standard error.
fn answer<G, K>(equation: &Equation<G, K>, ends: (f64, f64), methods: &Methods)
where
    G: Source<Point = f64, Value = f64> + Clone,
    K: Kernel<Point = f64, Weight = f64> + HasDomain + Clone,
{
    for (label, method) in methods {
        match line(equation, ends, method) {
            Ok(rest) => println!("{label};{rest}"),
            Err(e) => eprintln!("peers: {label}: {e}"),
        }
    }
}

fn line<G, K>(equation: &Equation<G, K>, ends: (f64, f64), method: &Nystrom) -> Result<String, Error>
where
    G: Source<Point = f64, Value = f64> + Clone,
    K: Kernel<Point = f64, Weight = f64> + HasDomain + Clone,
{
    let (seconds, f) = clock(|| equation.solve(method))?;
    let (a, b) = ends;
    let at = |i: i32| f.try_eval(&if i == 40 { b } else { a + (b - a) * f64::from(i) / 40.0 }).map(|v| format!("{v:.17e}"));
    let values = (0..=40).map(at).collect::<Result<Vec<_>, _>>()?;
    Ok(format!("{};{:.6e};{:.6e};{}", f.unknowns(), seconds[0], seconds[seconds.len() / 2], values.join(" ")))
}

/// A first run outside the clock, then 3 to 7 of them within a quarter of a second, as the other programs are timed.
fn clock<G: Source, K: fredholm::kernel::Operator>(
    solve: impl Fn() -> Result<NystromSolution<G, K>, Error>,
) -> Result<(Vec<f64>, NystromSolution<G, K>), Error> {
    let mut f = solve()?;
    let (begin, mut seconds) = (Instant::now(), Vec::new());
    while seconds.len() < 3 || (begin.elapsed().as_secs_f64() < 0.25 && seconds.len() < 7) {
        let lap = Instant::now();
        f = solve()?;
        seconds.push(lap.elapsed().as_secs_f64());
    }
    seconds.sort_by(f64::total_cmp);
    Ok((seconds, f))
}
