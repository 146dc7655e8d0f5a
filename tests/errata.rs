//! Slips of lecture notes, each a test (theory §2.2); the algebra of theory §8 on small chains; and mutants that the z-tests must kill (T9).

mod common;

use common::{Budget, all_pass};
use fredholm::detector::At;
use fredholm::kernel::{Absorbing, Operator, Step, Transition};
use fredholm::sampling::{Pcg, Sampler, Sequence};
use fredholm::source::Source;
use fredholm::statistics::Moments;
use fredholm::walk::{Ending, Heuristic, Roulette, Survival, Technique};
use fredholm::{Equation, Walk};
use nalgebra::{DMatrix, DVector};
use statrs::distribution::{ContinuousCDF, Normal};

const STATES: usize = 4;

/// f = g + K f on four states, walked by p and surviving with P: the walk of theory §4.1, in exact linear algebra.
#[derive(Clone, Debug)]
struct Chain {
    k: [[f64; STATES]; STATES],
    g: [f64; STATES],
    /// sub-density π = P·p
    pi: [[f64; STATES]; STATES],
}

impl Chain {
    fn example() -> Self {
        let k = [[0.1, 0.2, 0.05, 0.1], [0.15, 0.05, 0.2, 0.1], [0.0, 0.3, 0.1, 0.05], [0.2, 0.1, 0.1, 0.15]];
        let p = [[0.2, 0.4, 0.2, 0.2], [0.3, 0.2, 0.3, 0.2], [0.1, 0.5, 0.2, 0.2], [0.3, 0.3, 0.2, 0.2]];
        let survive = [0.6, 0.7, 0.5, 0.65];
        Chain { k, g: [0.3, 0.1, 0.4, 0.2], pi: std::array::from_fn(|i| p[i].map(|v| v * survive[i])) }
    }

    fn survival(&self, x: usize) -> f64 {
        self.pi[x].iter().sum()
    }

    fn matrix(&self, f: impl Fn(usize, usize) -> f64) -> DMatrix<f64> {
        DMatrix::from_fn(STATES, STATES, f)
    }

    fn solve(&self, t: &DMatrix<f64>, g: &DVector<f64>) -> DVector<f64> {
        (DMatrix::identity(STATES, STATES) - t).lu().solve(g).unwrap()
    }

    fn t(&self) -> DMatrix<f64> {
        self.matrix(|i, j| self.k[i][j])
    }

    /// K²/π (theory (4.1.6)).
    fn k2(&self) -> DMatrix<f64> {
        self.matrix(|i, j| if self.k[i][j] == 0.0 { 0.0 } else { self.k[i][j].powi(2) / self.pi[i][j] })
    }

    fn source(&self) -> DVector<f64> {
        DVector::from_row_slice(&self.g)
    }

    fn f(&self) -> DVector<f64> {
        self.solve(&self.t(), &self.source())
    }

    /// ν(x) of theory (4.3.3).
    fn nu(&self) -> DVector<f64> {
        let f = self.f();
        let h = self.t() * &f;
        self.k2() * f.map(|v| v * v) - h.map(|v| v * v)
    }

    fn equation(self) -> Equation<Chain, Chain> {
        Equation::new(self.clone(), self)
    }
}

impl Operator for Chain {
    type Point = usize;
    type Weight = f64;
}
impl Transition for Chain {
    fn step<S: Sampler>(&self, x: &usize, u: &mut S) -> Option<Step<usize, f64>> {
        let mut u = u.next_1d();
        for y in 0..STATES {
            if u < self.pi[*x][y] {
                return Some(Step::with_pdf(y, self.k[*x][y] / self.pi[*x][y], self.pi[*x][y]));
            }
            u -= self.pi[*x][y];
        }
        None
    }
}
impl Absorbing for Chain {
    fn absorption(&self, x: &usize) -> f64 {
        1.0 - self.survival(*x)
    }
}
impl Source for Chain {
    type Point = usize;
    type Value = f64;
    fn eval(&self, x: &usize) -> f64 {
        self.g[*x]
    }
}

/// The kernel's own absorption is the only ending.
fn analog() -> Walk<fredholm::walk::Collision, fredholm::walk::OwnAbsorption> {
    Walk::new(fredholm::walk::Collision, fredholm::walk::OwnAbsorption)
}

const N: u64 = 400_000;

/// Theory §8, 8.1: m − f² from (4.3.1) equals σ² from (4.3.3).
#[test]
fn second_moment_and_variance_are_one_equation() {
    let c = Chain::example();
    let f = c.f();
    let m = c.solve(&c.k2(), &c.source().zip_map(&f, |g, f| g * (2.0 * f - g)));
    let sigma2 = c.solve(&c.k2(), &c.nu());
    for i in 0..STATES {
        assert!((m[i] - f[i] * f[i] - sigma2[i]).abs() < 1e-14);
        assert!(sigma2[i] > 0.0);
    }
}

/// Theory §8, 8.2–8.4: mean, variance and length of collision and absorption walks, predicted and sampled by the library.
#[test]
fn predicted_moments_are_the_sampled_ones() {
    let mut budget = Budget::of("errata::chains");
    let c = Chain::example();
    let (f, variance) = (c.f(), c.solve(&c.k2(), &c.nu()));
    let ended = c.source().map_with_location(|i, _, g| g * g / (1.0 - c.survival(i)));
    let absorption = c.solve(&c.k2(), &ended).zip_map(&f, |m, f| m - f * f);
    let length = c.solve(&c.matrix(|i, j| c.pi[i][j]), &DVector::from_element(STATES, 1.0));
    let eq = c.clone().equation();
    let mut results = Vec::new();
    for x in 0..STATES {
        let e = eq.at(x).solve(&analog().samples_per_cell(N).seed(11)).unwrap();
        results.push(budget.mean(&format!("collision from {x}"), (e.value, e.std_error.unwrap(), N as f64), f[x], 0.02 * f[x]));
        results.push(variance_agrees(&mut budget, &format!("variance of collision from {x}"), &e.moments, variance[x]));
        let vertices = (e.steps + N) as f64 / N as f64;
        // the length's own variance: 2 steps is more than it is
        results.push(budget.mean(&format!("length from {x}"), (vertices, 2.0 / (N as f64).sqrt(), N as f64), length[x], 0.05));
        let a = eq.at(x).solve(&Walk::absorption().samples_per_cell(N).seed(12)).unwrap();
        results.push(budget.mean(&format!("absorption from {x}"), (a.value, a.std_error.unwrap(), N as f64), f[x], 0.03 * f[x]));
        results.push(variance_agrees(&mut budget, &format!("variance of absorption from {x}"), &a.moments, absorption[x]));
    }
    all_pass(results);
}

/// The sample variance has standard error √((m₄ − m₂²)/N).
fn variance_agrees(budget: &mut Budget, what: &str, m: &Moments<f64>, truth: f64) -> Result<(), String> {
    let n = m.count as f64;
    let error = ((m.m4 / n - (m.m2 / n).powi(2)) / n).sqrt();
    budget.mean(what, (m.variance().unwrap(), error, n), truth, 0.06 * truth)
}

/// Theory §8, 8.5 and (4.9.1): π\* = K f(y)/f(x) makes the absorption score constant.
#[test]
fn the_zero_variance_walk_has_none() {
    let mut c = Chain::example();
    let f = c.f();
    for i in 0..STATES {
        for j in 0..STATES {
            c.pi[i][j] = c.k[i][j] * f[j] / f[i];
        }
    }
    let ended = c.source().map_with_location(|i, _, g| g * g / (1.0 - c.survival(i)));
    let m = c.solve(&c.k2(), &ended);
    let eq = c.clone().equation();
    for x in 0..STATES {
        assert!((m[x] - f[x] * f[x]).abs() < 1e-14);
        let e = eq.at(x).solve(&Walk::absorption().samples_per_cell(4096)).unwrap();
        assert!(e.variance().unwrap() < 1e-24 && (e.value - f[x]).abs() < 1e-13, "{e:?}");
    }
}

/// Theory §8, 8.12 and (4.3.8): with ρ(K²/π) > 1 the variance equation is no variance, and says so by a negative sign somewhere.
#[test]
fn the_variance_equation_means_nothing_beyond_its_radius() {
    let mut c = Chain::example();
    for row in &mut c.pi {
        row[1] *= 0.05;
    }
    let k2 = c.k2();
    let radius = (0..200).fold(DVector::from_element(STATES, 1.0), |v, _| {
        let w = &k2 * v;
        let n = w.amax();
        w / n
    });
    assert!((&k2 * &radius).amax() > 1.0);
    assert!(c.solve(&k2, &c.nu()).iter().any(|v| *v < 0.0));
}

/// (2.2.1): the standard error falls by √N, the variance of the mean by N.
#[test]
fn the_standard_error_falls_by_the_square_root() {
    let eq = Chain::example().equation();
    let error = |n| eq.at(0).solve(&analog().samples_per_cell(n).seed(5)).unwrap().std_error.unwrap();
    let ratio = error(1 << 12) / error(1 << 18);
    assert!((ratio / 8.0 - 1.0).abs() < 0.1, "{ratio}");
}

/// (2.2.3): n = 0 belongs to every sum: with K = 0 every estimator says g(x) exactly.
#[test]
fn the_zeroth_term_is_there() {
    let eq = Equation::on_interval(0.0..=1.0, |x| 2.0 + x, |_, _| 0.0);
    let q = eq.at(0.5);
    let constant = Roulette::constant(0.5);
    let exact = [
        q.solve(&Walk::collision()).unwrap(),
        q.solve(&Walk::fixed_depth(0)).unwrap(),
        q.solve(&Walk::fixed_depth(3)).unwrap(),
        q.solve(&Walk::next_event()).unwrap(),
        q.solve(&Walk::mis()).unwrap(),
        q.solve(&Walk::mis().depth(0)).unwrap(),
    ];
    for e in &exact {
        assert_eq!((e.value, e.std_error), (2.5, Some(0.0)));
    }
    let a = q.solve(&Walk::absorption().roulette(constant)).unwrap();
    assert!(a.agrees_with(2.5, 5.0));
}

/// (2.2.4): with walks that all end at the start, next event still scores Tg there, before the survival test.
#[test]
fn next_event_scores_at_the_vertex_where_the_walk_ends() {
    #[derive(Clone, Copy, Debug)]
    struct Never;
    impl<K: Operator> Ending<K> for Never {
        fn survival(&self, _: &K, _: &K::Point, _: u64, _: f64) -> Survival {
            Survival::with_probability(0.0)
        }
    }
    let eq = Equation::on_interval(0.0..=1.0, |_| 1.0, |_, _| 0.25);
    // g + Tg = 1.25, with certainty
    let e = eq.at(0.5).solve(&Walk::next_event().ending(Never)).unwrap();
    assert_eq!((e.value, e.std_error), (1.25, Some(0.0)));
    // the same for next event cut at depth 1: T⁰g + T¹g, no more, no less
    let e = eq.at(0.5).solve(&Walk::next_event().depth(1)).unwrap();
    assert_eq!((e.value, e.std_error), (1.25, Some(0.0)));
    // and for MIS with a tie at every vertex: half and half
    for h in [Heuristic::Balance, Heuristic::Power(2.0), Heuristic::Maximum, Heuristic::Average] {
        let e = eq.at(0.5).solve(&Walk::mis().heuristic(h).depth(1)).unwrap();
        assert_eq!((e.value, e.std_error), (1.25, Some(0.0)), "{h:?}");
    }
}

/// (2.2.5): ties of the maximum heuristic belong to one technique.
#[test]
fn ties_are_counted_once() {
    for p in [1e-300, 0.3, 1.0, 1e300] {
        let sum = Heuristic::Maximum.share(p, p, Technique::First) + Heuristic::Maximum.share(p, p, Technique::Second);
        assert_eq!(sum, 1.0);
    }
}

// ---------------------------------------------------------------- mutants (T9)

/// One walk of the equation f = g + Tf with K = 0.6 e^{−|x−y|}·(1 + x)/2 on [0, 1], g = 1 + y: written out by hand, with one line wrong.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Mutant {
    None,
    /// the n = 0 term is forgotten (2.2.3)
    DropsStart,
    /// next event after the survival test (2.2.4)
    NextEventAfterRoulette,
    /// the survival probability is missing from the weight
    NoSurvivalInWeight,
    /// K(y, x) for K(x, y)
    SwappedArguments,
    /// both techniques take ties of the maximum (2.2.5)
    TiesTwice,
    /// p instead of P·p in the MIS weights
    PdfWithoutSurvival,
    /// the walk's hit of g is scored again on top of next event
    HitsScoredTwice,
    /// the absorption score forgets 1/(1 − P)
    AbsorptionUndivided,
    /// average weights of 1/2 for a technique that cannot sample the point
    AverageOfImpossible,
    /// a roulette that kills weights below the threshold and gives nothing back
    RouletteWithoutGain,
    /// the roulette uses 1 − P for P
    InvertedRoulette,
}

const P: f64 = 0.7;

fn kernel(x: f64, y: f64) -> f64 {
    0.3 * (1.0 + x) * (-(x - y).abs()).exp()
}

fn lamp(y: f64) -> f64 {
    1.0 + y
}

fn mutant_walk(mutant: Mutant, u: &mut impl Sampler) -> f64 {
    use Mutant::*;
    let next_event = matches!(mutant, NextEventAfterRoulette | HitsScoredTwice);
    let mis = matches!(mutant, TiesTwice | PdfWithoutSurvival | AverageOfImpossible);
    let (mut x, mut w) = (0.5f64, 1.0f64);
    let mut score = if matches!(mutant, DropsStart | AbsorptionUndivided) { 0.0 } else { lamp(x) };
    loop {
        // next event draws from [0, 1], or from [0, 1/2] only for the technique that cannot see everything
        let half = if mutant == AverageOfImpossible { 0.5 } else { 1.0 };
        let zeta = half * u.next_1d();
        let (q, pi) = (1.0 / half, if mutant == PdfWithoutSurvival { 1.0 } else { P });
        let share = match mutant {
            TiesTwice => 1.0,
            AverageOfImpossible => 0.5,
            _ => q / (q + pi),
        };
        let event = w * kernel(x, zeta) * lamp(zeta) / q * if mis { share } else { 1.0 };
        if (next_event && mutant != NextEventAfterRoulette) || mis {
            score += event;
        }
        let lives = u.next_1d() < if mutant == InvertedRoulette { 1.0 - P } else { P };
        if !lives {
            if mutant == AbsorptionUndivided {
                score += w * lamp(x);
            }
            return score;
        }
        if mutant == NextEventAfterRoulette {
            score += event;
        }
        let y = u.next_1d();
        let k = if mutant == SwappedArguments { kernel(y, x) } else { kernel(x, y) };
        w *= if mutant == NoSurvivalInWeight { k } else { k / P };
        if mutant == RouletteWithoutGain && w < 0.05 {
            return score;
        }
        x = y;
        if !next_event && !mis && mutant != AbsorptionUndivided || mutant == HitsScoredTwice {
            score += w * lamp(x);
        }
        if mis {
            let own = match mutant {
                TiesTwice => 1.0,
                AverageOfImpossible => 0.5,
                // the walk uses the right π for its own share, next event does not: the shares do not add up to 1
                _ => P / (P + 1.0),
            };
            score += w * lamp(x) * own;
        }
    }
}

/// The truth, by Nyström on 400 midpoints with Richardson's step: good to 1e-7.
fn truth() -> f64 {
    let solve = |n: usize| {
        let y = |j: usize| (j as f64 + 0.5) / n as f64;
        let a = DMatrix::from_fn(n, n, |i, j| f64::from(u8::from(i == j)) - kernel(y(i), y(j)) / n as f64);
        let f = a.lu().solve(&DVector::from_fn(n, |i, _| lamp(y(i)))).unwrap();
        lamp(0.5) + (0..n).map(|j| kernel(0.5, y(j)) * f[j] / n as f64).sum::<f64>()
    };
    (4.0 * solve(400) - solve(200)) / 3.0
}

fn sample(mutant: Mutant, n: u64, seed: u64) -> Moments<f64> {
    let scores: Vec<f64> = (0..n).map(|i| mutant_walk(mutant, &mut Pcg::new(seed).point(0, 0, i))).collect();
    Moments::from_scores(&scores)
}

#[test]
fn z_tests_kill_every_mutant_and_spare_the_original() {
    use Mutant::*;
    let mut budget = Budget::of("errata::mutants");
    let truth = truth();
    // the library itself agrees with this truth
    let eq = Equation::on_interval(0.0..=1.0, lamp, kernel);
    for e in
        [eq.at(0.5).solve(&Walk::mis().samples_per_cell(N)).unwrap(), eq.at(0.5).solve(&Walk::collision().samples_per_cell(N)).unwrap()]
    {
        budget.mean("library", (e.value, e.std_error.unwrap(), N as f64), truth, 0.02 * truth).unwrap();
    }
    let m = sample(None, N, 1);
    budget.mean("original", (m.mean, m.std_error().unwrap(), N as f64), truth, 0.03 * truth).unwrap();
    let mutants = [
        DropsStart,
        NextEventAfterRoulette,
        NoSurvivalInWeight,
        SwappedArguments,
        TiesTwice,
        PdfWithoutSurvival,
        HitsScoredTwice,
        AbsorptionUndivided,
        AverageOfImpossible,
        RouletteWithoutGain,
        InvertedRoulette,
    ];
    let survivors: Vec<_> = mutants
        .into_iter()
        .filter(|mutant| {
            let m = sample(*mutant, N, 1);
            budget.mean("mutant", (m.mean, m.std_error().unwrap(), N as f64), truth, f64::INFINITY).is_ok()
        })
        .collect();
    assert!(survivors.is_empty(), "survived: {survivors:?}");
    // stopping at the first look that pleases: such intervals under-cover, which a test of coverage must see
    let hits = (0..2000).filter(|i| covered_after_peeking(*i, truth)).count() as u64;
    assert!(budget.frequency("peeking", hits, 2000, 0.94, 1.0).is_err(), "{hits} of 2000");
}

/// Looks after every 50 walks, and stops as soon as the interval excludes the truth: twenty chances to be wrong for the price of one.
fn covered_after_peeking(repetition: u64, truth: f64) -> bool {
    let scores: Vec<f64> = (0..1000).map(|i| mutant_walk(Mutant::None, &mut Pcg::new(2 + repetition).point(1, 0, i))).collect();
    let z = Normal::standard().inverse_cdf(0.975);
    (1..=20).map(|k| Moments::from_scores(&scores[..50 * k])).all(|m| (m.mean - truth).abs() <= z * m.std_error().unwrap())
}

/// n − 1, not n, in the variance (theory (6.1.10)): exact over all samples of size 3 from three values.
#[test]
fn the_variance_estimator_is_unbiased() {
    let values = [0.0, 1.0, 5.0];
    let mean = values.iter().sum::<f64>() / 3.0;
    let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / 3.0;
    let mut sum = 0.0;
    for a in values {
        for b in values {
            for c in values {
                sum += Moments::from_scores(&[a, b, c]).variance().unwrap() / 27.0;
            }
        }
    }
    assert!((sum - variance).abs() < 1e-14);
}

/// The walk's trace adds up, and `At` starts where it says.
#[test]
fn a_trace_tells_the_whole_score() {
    let eq = Chain::example().equation();
    for walk in 0..50 {
        let t = analog().seed(3).trace(&eq, &At(2usize), 0, walk).unwrap();
        assert_eq!(t.vertices[0].point, 2);
        assert!((t.score - t.vertices.iter().map(|v| v.score).sum::<f64>()).abs() < 1e-15);
    }
}
