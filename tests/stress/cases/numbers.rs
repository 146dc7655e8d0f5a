//! Hard numbers: sums of 10⁹ scores, long walks, weights beyond the range of floating point, heavy tails.

#![allow(unreachable_pub, reason = "a module of the example `stress`")]

use super::table::{Happened, Row, Should, known};
use Should::{Answer, AnswerOrRefuse, Refuse};
use fredholm::domain::Interval;
use fredholm::integral::Secondary;
use fredholm::source::source_fn;
use fredholm::statistics::Moments;
use fredholm::{Equation, Integral, Walk};

/// All rows of this file.
pub fn rows() -> Vec<Row> {
    let mut rows = Vec::new();
    sums(&mut rows);
    long_walks(&mut rows);
    weights(&mut rows);
    tails(&mut rows);
    rows
}

/// Block of scores offset + k mod 7, k = 0 … 6999: mean offset + 3, variance 4 with n in the denominator.
fn pattern(offset: f64) -> Vec<f64> {
    (0..7000).map(|k| offset + f64::from(k % 7)).collect()
}

fn sums(rows: &mut Vec<Row>) {
    for offset in [0.0, 1e6, -1e9] {
        let merged = move |s: super::Scale| {
            let block = Moments::from_scores(&pattern(offset));
            let mut all = Moments::default();
            (0..s.scores / 7000).for_each(|_| all.merge(&block));
            all
        };
        let input = |what: &str| format!("{what} of 10⁹ scores {offset:e} + (k mod 7) (2·10⁷ if small)");
        rows.push(Row::new(input("mean"), "moments", Answer, move |s| {
            Ok(Happened::solved(merged(s).mean, offset + 3.0, Some(4.0 * f64::EPSILON * offset.abs().max(1.0)), None))
        }));
        // a rounding of the mean by ε|offset| a merge could leave a drift of its square: none may be seen
        rows.push(Row::new(input("variance"), "moments", Answer, move |s| {
            let all = merged(s);
            Ok(Happened::solved(all.m2 / all.count as f64, 4.0, Some(1e-11 + f64::EPSILON * offset.abs()), None))
        }));
        rows.push(Row::new(input("fourth moment"), "moments", Answer, move |s| {
            let all = merged(s);
            Ok(Happened::solved(all.m4 / all.count as f64, 28.0, Some(1e-9 + 1e2 * f64::EPSILON * offset.abs()), None))
        }));
    }
}

fn long_walks(rows: &mut Vec<Row>) {
    let rho = 1.0 - 1e-6;
    // every vertex scores 1, walks of 10⁶ steps in the mean
    let long = known(move |_, _| rho, |_| 1.0, (0.5, 1e6));
    let short = long.clone();
    rows.push(Row::new("walks of 10⁶ steps", "constant roulette", AnswerOrRefuse, move |s| long.constant(rho, s.long_walks)));
    rows.push(Row::new("walks of 10⁶ steps, at most 10⁶ allowed", "throughput roulette", Refuse, move |s| short.uniform(s.long_walks)));
    let never = |_: super::Scale| {
        let eq = Equation::on_interval(0.0..=1.0, |_| 1.0, |_, _| 1.0);
        Ok(Happened::of(&eq.at(0.5).solve(&Walk::collision().accept_divergence().samples_per_cell(16).max_steps(100_000))?, f64::INFINITY))
    };
    rows.push(Row::new("K = 1: walks that never end", "throughput roulette", Refuse, never));
}

/// K = size from quarter i + 1 to quarter i: nilpotent, T⁴ = 0. f on the last quarter = Σ (size/4)ⁿ, n = 0 … 3.
fn stairs(size: f64) -> super::Known {
    let quarter = |x: f64| (4.0 * x) as i32;
    let f = (0..4).map(|n| (size / 4.0).powi(n)).sum();
    known(move |x, y| if quarter(x) == quarter(y) + 1 { size } else { 0.0 }, |_| 1.0, (0.9, f))
}

fn weights(rows: &mut Vec<Row>) {
    for size in [1e-200, 1e90, 1e120] {
        let problem = stairs(size);
        let input = format!("K = {size:e} down a stair of four: weights of {:.0e}", size.powi(3));
        let should = if size < 1.0 { Answer } else { AnswerOrRefuse };
        super::all_ways(rows, &input, &problem, 1e-9, [should; 3]);
    }
    let fading = known(|x, y| 1e-160 * (x + y), |_| 1.0, (0.5, 1.0));
    super::all_ways(rows, "K = 1e−160 (x + y): weights underflow", &fading, 1e-9, [Answer; 3]);
}

/// Scores that show a tail: a finite variance of index 2.1 is told from an infinite one by none, but suspected in nine of ten runs of this size.
const JUDGED: u64 = 1 << 16;

fn tails(rows: &mut Vec<Row>) {
    for (index, should) in [(1.5, Refuse), (2.1, Refuse), (4.5, Answer)] {
        // g(U) has the tail index α; f(x) = g(x) + ∫ g for K = ½
        let g = move |x: f64| x.powf(-1.0 / index);
        let mass = 1.0 / (1.0 - 1.0 / index);
        let problem = known(|_, _| 0.5, g, (0.5, g(0.5) + mass));
        rows.push(Row::new(format!("scores of tail index {index}"), "walks, uniform", should, move |_| problem.uniform(JUDGED)));
        rows.push(Row::new(format!("∫ x^(−1/{index}) dx"), "plain integral", should, move |_| {
            let integral = Integral::on_interval(0.0..=1.0, g);
            Ok(Happened::of(&integral.solve(&Secondary::plain().samples(JUDGED))?, mass))
        }));
    }
    // Wₙ = (0.9/P)ⁿ with probability Pⁿ: tail index ln P/ln(P/0.9), and all scores of walks of n steps are the same
    for survival in [0.6, 0.8] {
        let problem = known(|_, _| 0.9, |_| 1.0, (0.5, 10.0));
        let input = format!("K = 0.9, survival {survival}: weights {:.3}ⁿ without a variance", 0.9 / survival);
        rows.push(Row::new(input, "constant roulette", Refuse, move |s| problem.constant(survival, s.walks)));
    }
    let rare = |s: super::Scale| {
        let lamp = source_fn(Interval::from(0.0..=1.0), |x: &f64| f64::from(*x < 1e-9) * 1e9);
        let eq = Equation::on_interval(0.0..=1.0, |_| 1.0, |_, _| 0.5).with_source(lamp);
        Ok(Happened::of(&eq.at(0.5).solve(&Walk::collision().samples_per_cell(s.walks))?, 1.0))
    };
    rows.push(Row::new("a lamp that one walk in 10⁹ finds", "walks, uniform", Refuse, rare));
}
