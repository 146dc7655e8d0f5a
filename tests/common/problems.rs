//! Problems on a line, of known solution, behind one type: every method is compiled once.

#![allow(dead_code, unreachable_pub, reason = "each test file uses its part")]

use crate::common::Reference;
use fredholm::domain::{Domain, HalfLine, Interval, Node};
use fredholm::{ClosureEquation, Equation, Error};
use statrs::function::erf::erf;
use statrs::function::exponential::integral;
use std::f64::consts::PI;
use std::sync::Arc;

/// An interval or a half line: one type, so that the table below needs one instance of every walk.
#[derive(Clone, Copy, Debug)]
pub enum Line {
    Finite(Interval),
    Half(HalfLine),
}

macro_rules! either {
    ($self:ident, $d:ident => $e:expr) => {
        match $self {
            Line::Finite($d) => $e,
            Line::Half($d) => $e,
        }
    };
}

impl Domain for Line {
    type Point = f64;
    fn validate(&self) -> Result<(), Error> {
        either!(self, d => d.validate())
    }
    fn volume(&self) -> f64 {
        either!(self, d => d.volume())
    }
    fn contains(&self, x: &f64) -> bool {
        either!(self, d => d.contains(x))
    }
    fn dimension(&self) -> usize {
        1
    }
    fn place(&self, state: usize, next: impl FnMut() -> f64) -> Node<f64> {
        either!(self, d => d.place(state, next))
    }
    fn coordinate(&self, x: &f64, axis: usize) -> f64 {
        either!(self, d => d.coordinate(x, axis))
    }
    fn density(&self, x: &f64) -> f64 {
        either!(self, d => d.density(x))
    }
}

pub type G = Arc<dyn Fn(f64) -> f64 + Send + Sync>;
pub type K = Arc<dyn Fn(f64, f64) -> f64 + Send + Sync>;

/// Which proposals have finite variance: ρ(K²/π) < 1 (theory §4.1 (V)).
#[derive(Clone, Copy, PartialEq)]
pub enum By {
    /// The uniform one, and a table of so many cells.
    Both(usize),
    /// Only a table: the kernel is too peaked for uniform steps.
    Table(usize),
}

pub struct Problem {
    pub reference: &'static str,
    pub line: Line,
    pub kernel: K,
    pub source: G,
    pub by: By,
    /// survival probability of constant roulettes
    pub constant: f64,
    /// margin of the mean tests, relative to the largest value
    pub margin: f64,
}

fn problem(
    reference: &'static str,
    (a, b): (f64, f64),
    by: By,
    constant: f64,
    kernel: impl Fn(f64, f64) -> f64 + Send + Sync + 'static,
    source: impl Fn(f64) -> f64 + Send + Sync + 'static,
) -> Problem {
    let line = if b.is_finite() { Line::Finite(Interval::from(a..=b)) } else { Line::Half(HalfLine::new(a)) };
    Problem { reference, line, kernel: Arc::new(kernel), source: Arc::new(source), by, constant, margin: 0.02 }
}

/// The one type of all rows: every walk is compiled once.
pub fn equation(
    p: &Problem,
) -> ClosureEquation<
    Line,
    f64,
    f64,
    impl Fn(&f64) -> f64 + Send + Sync + Clone + use<>,
    impl Fn(&f64, &f64) -> f64 + Send + Sync + Clone + use<>,
> {
    let (g, k) = (p.source.clone(), p.kernel.clone());
    Equation::on_domain(p.line, move |x: &f64| g(*x), move |x: &f64, y: &f64| k(*x, *y))
}

/// E₁: the power series below 2, where statrs' continued fraction does not converge everywhere (it gives up in 1 < t < 1.2).
pub fn e1(t: f64) -> f64 {
    if t == 0.0 {
        return f64::INFINITY;
    }
    if t > 2.0 {
        return integral(t, 1).unwrap();
    }
    let (mut term, mut sum) = (1.0, -0.577_215_664_901_532_9 - t.ln());
    for k in 1..40 {
        term *= -t / f64::from(k);
        sum -= term / f64::from(k);
    }
    sum
}

pub const INF: f64 = f64::INFINITY;
pub const UNIT: (f64, f64) = (0.0, 1.0);

impl Problem {
    /// Another margin than 2 %: where walks have heavy tails, and a smaller one would cost minutes.
    fn margin(self, margin: f64) -> Self {
        Problem { margin, ..self }
    }
}

/// One line a problem: reference, domain, proposals, survival of constant roulettes, K, g.
#[rustfmt::skip]
pub fn problems() -> Vec<Problem> {
    use By::{Both, Table};
    let p = |name: &str, parameter: &str| Reference::load(name).parameter(parameter);
    let step = |z: f64| f64::from(z > 0.0);
    let (d1, d01) = (p("lieb-liniger-gamma1", "d"), p("lieb-liniger-gamma0.1", "d"));
    let peak = |d: f64| move |x: f64, y: f64| d / (PI * (d * d + (x - y).powi(2)));
    let green = |l: f64| move |x: f64, y: f64| l * (x.min(y) - x * y);
    let manufactured = |l: f64| move |x: f64| x.exp() - l * ((x + 1.0).exp() - 1.0) / (x + 1.0);
    let s = 0.01;
    vec![
        // smooth
        problem("expxy-g1-lam0.5", UNIT, Both(16), 0.8, |x, y| 0.5 * (x * y).exp(), |_| 1.0),
        problem("expxy-manufactured-lam-0.6", UNIT, Both(16), 0.85, |x, y| -0.6 * (x * y).exp(), manufactured(-0.6)),
        problem("gaussian-g1", UNIT, Both(16), 0.8, |x, y| 0.9 * (-(x - y).powi(2)).exp(), |_| 1.0),
        problem("hilbert-type-manufactured", UNIT, Both(16), 0.8, |x, y| 0.8 / (1.0 + x + y), |x| 1.0 - 0.8 * ((2.0 + x) / (1.0 + x)).ln()),
        problem("nonsymmetric-exp-xy2", UNIT, Both(16), 0.8, |x, y| 0.7 * (-x * y * y).exp() * (1.0 + x - y), |x| 1.0 + x * x),
        problem("lieb-liniger-gamma1", (-1.0, 1.0), Both(16), 0.8, peak(d1), |_| 0.5 / PI),
        problem("love-minus-d1", (-1.0, 1.0), Both(16), 0.8, move |x, y| -peak(1.0)(x, y), |_| 1.0),
        problem("integrating-sphere-rho0.5", (-1.0, 1.0), Both(8), 0.6, |_, _| 0.25, |z| 1.0 + 0.5 * z),
        problem("degenerate-rank3", UNIT, Both(16), 0.8, |x, y| 1.0 / 3.0 + 0.5 * x * y - 0.75 * (x * y).powi(2), |x| x),
        // peaked
        problem("lieb-liniger-gamma0.1", (-1.0, 1.0), Table(64), 0.9, peak(d01), |_| 0.5 / PI),
        problem("gaussian-peaked-s0.01-manufactured", UNIT, Table(256), 0.9,
            move |x, y| 0.8 * (-(x - y).powi(2) / (2.0 * s * s)).exp() / (s * (2.0 * PI).sqrt()),
            move |x| 1.0 - 0.4 * (erf((1.0 - x) / (s * 2f64.sqrt())) + erf(x / (s * 2f64.sqrt())))).margin(0.03),
        // kinks and jumps
        problem("expkernel-lam0.5-b2", UNIT, Both(32), 0.7, |x, y| 0.5 * (-2.0 * (x - y).abs()).exp(), |_| 1.0),
        problem("expkernel-lam-2-b5", UNIT, Both(32), 0.95, |x, y| -2.0 * (-5.0 * (x - y).abs()).exp(), |_| 1.0),
        problem("green-bridge-lam5", UNIT, Both(32), 0.8, green(5.0), |_| 1.0),
        problem("green-min-lam1", UNIT, Both(16), 0.8, |x, y| x.min(y), |_| 1.0),
        problem("green-max-lam0.5", UNIT, Both(16), 0.8, |x, y| 0.5 * x.max(y), |_| 1.0),
        problem("volterra-step-lam1", UNIT, Both(32), 0.8, move |x, y| step(x - y), |_| 1.0),
        problem("volterra-exp", UNIT, Both(32), 0.9, move |x, y| 3.0 * (-2.0 * (x - y)).exp() * step(x - y), |_| 1.0).margin(0.04),
        problem("tube-effective-emissivity-eps0.5-L4", (0.0, 4.0), Both(32), 0.8, |x, y| {
            let t = (x - y).abs();
            0.25 * (1.0 - (t.powi(3) + 6.0 * t) / (t * t + 4.0).powf(1.5))
        }, |_| 0.5),
        // sign-changing, oscillatory
        problem("signchanging-nonsym", UNIT, Both(32), 0.9, |x, y| 1.2 * (5.0 * x - 3.0 * y).sin() * (-x * y).exp(), f64::cos),
        problem("degenerate-trig-rank4", UNIT, Both(32), 0.9, |x, y| (PI * (x - y)).cos() + 0.5 * (2.0 * PI * (x - y)).cos(), |x| x * x),
        problem("osc-cos-w10-lam1.2", UNIT, Both(64), 0.9, |x, y| 1.2 * (10.0 * (x - y)).cos(), |_| 1.0),
        // transport: logarithmic singularity
        problem("slab-c0.9-a1-uniform", (0.0, 1.0), Both(32), 0.8, |x, y| 0.45 * e1((x - y).abs()), |_| 1.0),
        problem("slab-c0.5-a1-beam0.3", (0.0, 1.0), Both(32), 0.8, |x, y| 0.25 * e1((x - y).abs()), |x| (-x / 0.3).exp()),
        problem("hetero-cx-sine", (0.0, 4.0), Table(64), 0.9, |x, y| 0.5 * (0.5 + 0.45 * (PI * x / 4.0).sin()) * e1((x - y).abs()), |_| 1.0),
        problem("twolayer-c0.5-c0.95", (0.0, 3.0), Table(48), 0.9, move |x, y| 0.5 * (0.5 + 0.45 * step(x - 1.0)) * e1((x - y).abs()), |_| 1.0),
        // half lines
        problem("halfline-exp-lam0.3", (0.0, INF), Table(64), 0.8, |x, y| 0.3 * (-(x - y).abs()).exp(), |_| 1.0),
        problem("halfspace-c0.5-mu1", (0.0, INF), Table(64), 0.8, |x, y| 0.25 * e1((x - y).abs()), |x| (-x).exp()),
    ]
}
