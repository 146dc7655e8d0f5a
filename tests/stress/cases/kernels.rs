//! Hard kernels: close to critical, huge and tiny, cancelling, peaked, singular, oscillating, far away.

#![allow(unreachable_pub, reason = "a module of the example `stress`")]

use super::table::{Happened, Known, Row, Should, all_ways, known};
use Should::{Answer, AnswerOrRefuse, Blind, Refuse};
use fredholm::deterministic::Nystrom;
use fredholm::domain::Interval;
use fredholm::kernel::{Proposed, Singularity, Uniform, split_fn};
use fredholm::source::source_fn;
use fredholm::transport::Slab;
use fredholm::{Equation, Error};
use std::f64::consts::PI;

/// All rows of this file.
pub fn rows() -> Vec<Row> {
    let mut rows = Vec::new();
    near_critical(&mut rows);
    slabs(&mut rows);
    scaled(&mut rows);
    cancelling(&mut rows);
    peaks(&mut rows);
    singular(&mut rows);
    oscillating(&mut rows);
    far_away(&mut rows);
    ill_conditioned(&mut rows);
    rows
}

/// K = 3ρxy has the radius ρ; f = 1 + 3ρAx, A = ∫ y f = ½/(1 − ρ).
fn product(radius: f64) -> Known {
    known(move |x, y| 3.0 * radius * x * y, |_| 1.0, (0.5, 1.0 + 0.75 * radius / (1.0 - radius)))
}

fn near_critical(rows: &mut Vec<Row>) {
    for radius in [0.9, 0.99, 0.999, 0.9999, 0.99999] {
        let input = format!("spectral radius {radius}: K = 3ρxy");
        // guided walks of 10³ steps and more: a few thousand do not show their spread
        let guided = if radius < 0.999 { Answer } else { AnswerOrRefuse };
        // uniform steps: ρ(K²/p) = 9ρ²/5 > 1
        all_ways(rows, &input, &product(radius), 1e-9, [Answer, Refuse, guided]);
    }
    for radius in [1.0 + 1e-6, 1.5, 100.0] {
        all_ways(rows, &format!("spectral radius {radius}: K = 3ρxy"), &product(radius), 1e-9, [Answer, Refuse, Refuse]);
    }
    all_ways(rows, "spectral radius 1: K = 3xy", &product(1.0), 1e-9, [Refuse; 3]);
}

/// φ(a/2) of slabs 100 mean free paths thick (reference, 14 digits).
fn slabs(rows: &mut Vec<Row>) {
    for (c, file) in [(0.99, "slab-c0.99-a100-uniform"), (0.999, "slab-c0.999-a100-uniform"), (1.0, "slab-c1-a100-uniform")] {
        let (x, truth) = super::middle(file);
        let input = format!("slab of thickness 100, c = {c}");
        rows.push(Row::new(input.clone(), "adaptive Nyström", Answer, move |_| {
            let slab = Slab::new(100.0).scattering(c);
            let f = Equation::new(slab.uniform(1.0), slab.clone()).solve(&Nystrom::adaptive().tolerance(1e-9))?;
            Ok(Happened::solved(f.try_eval(&x)?, truth, f.error_estimate(), f.resolution()))
        }));
        rows.push(Row::new(input, "own walk, collision", Answer, move |s| {
            let slab = Slab::new(100.0).scattering(c);
            let eq = Equation::new(slab.uniform(1.0), slab.clone());
            Ok(Happened::of(&eq.at(x).solve(&fredholm::Walk::collision().samples_per_cell(s.walks / 8))?, truth))
        }));
    }
}

fn scaled(rows: &mut Vec<Row>) {
    // K = s·xy: f = 1 + (s/2) x/(1 − s/3)
    for (s, truth) in [(1e-150, 1.0), (1e150, 0.25), (-1e150, 0.25), (1e12, 0.25)] {
        let small = if s == 1e-150 { Answer } else { AnswerOrRefuse };
        let walks = if s == 1e-150 { Answer } else { Refuse };
        all_ways(rows, &format!("K = {s:e}·xy"), &known(move |x, y| s * x * y, |_| 1.0, (0.5, truth)), 1e-9, [small, walks, walks]);
    }
    for g in [1e150, 1e-150, 1e300, 1e-300, 4e-310] {
        let problem = known(|x, y| 0.5 * x * y, move |_| g, (0.5, 1.15 * g));
        // fourth powers of the scores leave the range of floating point: their spread is not known
        all_ways(rows, &format!("g = {g:e}"), &problem, 1e-9, [Answer, AnswerOrRefuse, AnswerOrRefuse]);
    }
    let mixed = known(|x, y| 0.5 * x * y, |x| if x < 0.5 { 1e300 } else { 1e-300 }, (0.5, 0.3e300 * 0.25));
    // A = ∫ y g /(1 − 1/6) = 0.15e300; f(½) = g(½) + A/4
    let mixed = Known { at: (0.5, 1e-300 + 0.0375e300), ..mixed };
    all_ways(rows, "g = 1e300 on one half, 1e−300 on the other", &mixed, 1e-9, [Answer, AnswerOrRefuse, AnswerOrRefuse]);
}

fn cancelling(rows: &mut Vec<Row>) {
    // f = x − ½ + 10⁻⁶ for K = ½: g = f − ½·10⁻⁶; the walk adds numbers a million times larger than f(½)
    let problem = known(|_, _| 0.5, |x| x - 0.5 + 0.5e-6, (0.5, 1e-6));
    all_ways(rows, "f(½) = 1e−6 from terms of size 1", &problem, 1e-9, [Answer, Answer, Answer]);
    // f = 1, as K(x, ·) = 10⁶ P₁ is orthogonal to it; |K| has the radius 5·10⁵
    let wild = known(|_, y| 1e6 * (2.0 * y - 1.0), |_| 1.0, (0.5, 1.0));
    all_ways(rows, "K = 1e6 (2y − 1): ∫ K f = 0", &wild, 1e-9, [AnswerOrRefuse, Refuse, Refuse]);
    let wave = known(|x, y| 1e6 * (2.0 * PI * y).sin() * x, |_| 1.0, (0.5, 1.0 + 0.5 * wave_moment()));
    all_ways(rows, "K = 1e6 x sin 2πy", &wave, 1e-6, [Answer, Refuse, Refuse]);
}

/// f = 1 + Cx, C = 10⁶ ∫ sin(2πy)(1 + Cy) dy = −10⁶ C/(2π): C = 0.
fn wave_moment() -> f64 {
    0.0
}

fn peaks(rows: &mut Vec<Row>) {
    let w = 1e-8;
    // a Gaussian of mass ½ along the diagonal: f = 2 inside
    let ridge = known(move |x, y| 0.5 * (-((x - y) / w).powi(2)).exp() / (w * PI.sqrt()), |_| 1.0, (0.5, 2.0));
    // no uniform point, of a step or of the source, hits the ridge: a prediction sees it, the scores only that they met nothing
    let input = "K a ridge of width 1e−8 along the diagonal";
    all_ways(rows, input, &ridge, 1e-9, [Answer, Refuse, Refuse]);
    let (table, predicted) = (ridge.clone(), ridge);
    rows.push(Row::new(input, "walks, uniform, predicted first", Refuse, move |s| predicted.predicted(s.walks)));
    rows.push(Row::new(input, "walks, guided, collision", Answer, move |s| table.collision(s.walks)));
    let column = known(move |_, y| 0.5 * (-((y - 0.3) / w).powi(2)).exp() / (w * PI.sqrt()), |_| 1.0, (0.5, 2.0));
    all_ways(rows, "K a peak of width 1e−8 in y", &column, 1e-9, [Blind(w); 3]);
    // K ends between the places that a table asks for
    let window = known(|_, y| if (0.501..0.511).contains(&y) { 50.0 } else { 0.0 }, |_| 1.0, (0.5, 2.0));
    all_ways(rows, "K = 50 for 0.501 < y < 0.511", &window, 1e-9, [Answer, Refuse, AnswerOrRefuse]);
    let band = known(|x, y| if (x - y).abs() < 1e-3 { 250.0 } else { 0.0 }, |x| 1.0 - 250.0 * band_width(x), (0.5, 1.0));
    all_ways(rows, "K = 250 for |x − y| < 1e−3, f = 1", &band, 1e-9, [AnswerOrRefuse, Refuse, AnswerOrRefuse]);
    for (input, problem) in [("K = 50 for 0.501 < y < 0.511", window), ("K = 250 for |x − y| < 1e−3, f = 1", band)] {
        rows.push(Row::new(input, "walks, guided, collision", AnswerOrRefuse, move |s| problem.collision(s.walks)));
    }
    // a lamp of mass 1: ∫ f = 1 + ½ ∫ f, f(½) = ½ ∫ f = 1
    let lamp = move |x: f64| (-((x - 0.3) / w).powi(2)).exp() / (w * PI.sqrt());
    let declared = known(|_, _| 0.5, lamp, (0.5, 1.0));
    rows.push(Row::new("g a peak of width 1e−8 at a breakpoint", "adaptive Nyström", Answer, {
        let declared = declared.clone();
        move |_| declared.adaptive(1e-9, &[0.3])
    }));
    all_ways(rows, "g nothing but a peak of width 1e−8", &declared, 1e-9, [Blind(w), Refuse, Refuse]);
    let hidden = known(|_, _| 0.5, move |x| 1.0 + lamp(x), (0.5, 3.0));
    all_ways(rows, "g = 1 + a peak of width 1e−8", &hidden, 1e-9, [Blind(w); 3]);
}

/// Length of |x − y| < 10⁻³ in [0, 1].
fn band_width(x: f64) -> f64 {
    (x + 1e-3).min(1.0) - (x - 1e-3).max(0.0)
}

fn singular(rows: &mut Vec<Row>) {
    // g chosen so that f = 1
    for (alpha, l) in [(0.5, 0.1), (0.9, 0.02), (0.99, 0.001)] {
        let mass = move |x: f64| l * (x.powf(1.0 - alpha) + (1.0 - x).powf(1.0 - alpha)) / (1.0 - alpha);
        let problem = known(move |x: f64, y: f64| l * (x - y).abs().powf(-alpha), move |x| 1.0 - mass(x), (0.5, 1.0));
        let input = format!("K = {l} |x − y|^−{alpha}, f = 1");
        // from values of K alone
        let solved = if alpha < 0.95 { Answer } else { AnswerOrRefuse };
        all_ways(rows, &input, &problem, 1e-6, [solved, AnswerOrRefuse, AnswerOrRefuse]);
        rows.push(Row::new(input.clone(), "walks, guided, collision", AnswerOrRefuse, move |s| problem.collision(s.walks)));
        // the last with integrals that cannot be told from none
        rows.push(Row::new(input, "adaptive Nyström, singularity declared", solved, move |_| declared(l, alpha, move |x| 1.0 - mass(x))));
    }
    let mass = |x: f64| 0.3 * (1.0 - x * x.ln() - (1.0 - x) * (1.0 - x).ln());
    let log = known(|x: f64, y: f64| -0.3 * (x - y).abs().ln(), move |x| 1.0 - mass(x), (0.5, 1.0));
    all_ways(rows, "K = −0.3 ln|x − y|, f = 1", &log, 1e-9, [Answer; 3]);
    let pole = known(|x: f64, y: f64| 0.01 / (x - y).abs(), |_| 1.0, (0.5, f64::NAN));
    all_ways(rows, "K = 0.01/|x − y|: no integral", &pole, 1e-6, [Refuse; 3]);
}

/// K = l |x − y|^−α by `split_fn`, f(½) = 1.
fn declared(l: f64, alpha: f64, source: impl Fn(f64) -> f64 + Clone + Send + Sync) -> Result<Happened, Error> {
    let domain = Interval::from(0.0..=1.0);
    let kernel = split_fn(domain, Singularity::Power { exponent: alpha }, move |_: &f64, _: &f64| l, |_: &f64, _: &f64| 0.0);
    let eq = Equation::new(source_fn(domain, move |x: &f64| source(*x)), Proposed::new(kernel, Uniform::on(domain)));
    let f = eq.solve(&Nystrom::adaptive().tolerance(1e-6))?;
    Ok(Happened::solved(f.try_eval(&0.5)?, 1.0, f.error_estimate(), f.resolution()))
}

fn oscillating(rows: &mut Vec<Row>) {
    // K = ½ cos ω(x − y), g = 1: f = 1 + a cos ωx + b sin ωx by the system of rank two
    for omega in [1e2, 1e4] {
        let problem = known(move |x: f64, y: f64| 0.5 * (omega * (x - y)).cos(), |_| 1.0, (0.5, rank_two(omega)));
        let solved = if omega < 1e3 { Answer } else { AnswerOrRefuse };
        all_ways(rows, &format!("K = ½ cos {omega:e}(x − y)"), &problem, 1e-8, [solved, Answer, Answer]);
    }
}

/// f(½): (I − ½M)(a, b) = ½ (∫cos, ∫sin), M the Gram matrix of cos ωx, sin ωx.
fn rank_two(w: f64) -> f64 {
    let (c, s) = (w.cos(), w.sin());
    let (cc, ss, cs) = (0.5 + s * c / (2.0 * w), 0.5 - s * c / (2.0 * w), s * s / (2.0 * w));
    let (p, q) = (0.5 * s / w, 0.5 * (1.0 - c) / w);
    let (a11, a12, a22) = (1.0 - 0.5 * cc, -0.5 * cs, 1.0 - 0.5 * ss);
    let det = a11 * a22 - a12 * a12;
    let (a, b) = ((p * a22 - q * a12) / det, (a11 * q - a12 * p) / det);
    1.0 + a * (0.5 * w).cos() + b * (0.5 * w).sin()
}

fn far_away(rows: &mut Vec<Row>) {
    // on [o, o + 1]: K = ½ e^{−|x − y|}, f = 3/2 + t(1 − t)/2
    for origin in [1e3, 1e8, 1e12, 1e15] {
        // fewer than 2²⁰ numbers between the ends
        let should = if origin < 1e9 { Answer } else { Refuse };
        let problem =
            Known { ends: (origin, origin + 1.0), ..known(|x: f64, y: f64| 0.5 * (-(x - y).abs()).exp(), |_| 1.0, (origin + 0.5, 1.625)) };
        all_ways(rows, &format!("K = ½ e^−|x − y| on [{origin:e}, {origin:e} + 1]"), &problem, 1e-6, [should; 3]);
    }
    let wide = Known { ends: (-1e150, 1e150), ..known(|_, _| 0.25e-150, |_| 1.0, (0.0, 2.0)) };
    all_ways(rows, "K = 1/4·1e−150 on [−1e150, 1e150]", &wide, 1e-9, [Answer; 3]);
    let narrow = Known { ends: (1.0, 1.0 + 1e-12), ..known(|_, _| 0.5e12, |_| 1.0, (1.0, 2.0)) };
    all_ways(rows, "K = ½·1e12 on [1, 1 + 1e−12]", &narrow, 1e-9, [Refuse; 3]);
}

fn ill_conditioned(rows: &mut Vec<Row>) {
    for delta in [1e-4, 1e-8, 1e-11, 1e-13, 1e-14] {
        let problem = known(move |_, _| 1.0 - delta, |_| 1.0, (0.5, 1.0 / (1.0 - (1.0 - delta))));
        let loose = problem.clone();
        let input = format!("condition {:.0e}: K = 1 − {delta:e}", 1.0 / delta);
        // as many digits as the condition number leaves; at 10¹⁴ none that could be told
        let [tight, wide] = [1e-7, 1e-13].map(|least| if delta > 0.5 * least { Answer } else { AnswerOrRefuse });
        rows.push(Row::new(input.clone(), "adaptive Nyström, 1e−9", tight, move |_| problem.adaptive(1e-9, &[])));
        rows.push(Row::new(input, "adaptive Nyström, 1e−2", wide, move |_| loose.adaptive(1e-2, &[])));
    }
    // the prolate kernel: 1 − λ₀ = 2.1250e−6 and 3.56e−13 (theory of Slepian, Pollak 1961); the answer is not known, but bounded
    for c in [8.0, 16.0] {
        let sinc = move |x: f64, y: f64| if x == y { c / PI } else { (c * (x - y)).sin() / (PI * (x - y)) };
        let problem = Known { ends: (-1.0, 1.0), ..known(sinc, move |y| prolate_source(c, y), (0.5, 1.0)) };
        let should = if c < 16.0 { Answer } else { AnswerOrRefuse };
        rows.push(Row::new(format!("prolate kernel, c = {c}, f = 1"), "adaptive Nyström", should, move |_| problem.adaptive(1e-6, &[])));
    }
}

/// 1 − ∫_{−1}^{1} sin c(x − y)/(π(x − y)) dy = 1 − (Si(c(1 − x)) + Si(c(1 + x)))/π.
fn prolate_source(c: f64, x: f64) -> f64 {
    1.0 - (sine_integral(c * (1.0 - x)) + sine_integral(c * (1.0 + x))) / PI
}

/// Si(x) = ∫₀ˣ sin t/t dt by Gauss–Legendre on panels.
fn sine_integral(x: f64) -> f64 {
    let rule = fredholm::deterministic::quadrature::composite_unit_rule(16, 16);
    rule.iter().map(|n| n.weight * x * (n.point * x).sin() / (n.point * x)).sum()
}
