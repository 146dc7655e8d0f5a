//! Every sequence in every walk: unbiased, with intervals that cover.

use crate::any::{Any, randomised};
use crate::common::{Budget, all_pass};
use crate::erased::Equation;
use fredholm::sampling::{Layout, Pcg, Sequence, Sobol};
use fredholm::walk::Roulette;
use fredholm::{Estimate, Method, Walk};

/// f(x) = 1 + ∫₀¹ ½xy f(y) dy = 1 + 3x/10, ∫f = 1.15.
const EXACT: f64 = 1.15;

/// The six presets, 16 replicates of 256 walks.
#[test]
fn every_walk_takes_every_sequence() {
    let mut budget = Budget::of("sampling::walks");
    let eq = Equation::on_interval(0.0..=1.0, |_| 1.0, |x, y| 0.5 * x * y).tabulated(8).unwrap();
    let mut results = Vec::new();
    for (name, sequence) in randomised(16) {
        let n = 16 * 256;
        let walks: [(&str, &dyn Method<_, _, _, Solution = Estimate>); 6] = [
            ("collision", &Walk::collision().sequence(sequence).samples_per_cell(n)),
            ("next event", &Walk::next_event().sequence(sequence).samples_per_cell(n)),
            ("MIS", &Walk::mis().sequence(sequence).samples_per_cell(n)),
            ("subcritical", &Walk::subcritical().sequence(sequence).samples_per_cell(n)),
            ("fixed depth", &Walk::fixed_depth(12).sequence(sequence).samples_per_cell(n)),
            ("absorption", &Walk::absorption().roulette(Roulette::constant(0.5)).sequence(sequence).samples_per_cell(n)),
        ];
        for (walk, method) in walks {
            let f = eq.at(0.5).solve(method).unwrap();
            assert_eq!((f.samples(), f.degrees_of_freedom), (n, 15), "{name}, {walk}");
            results.push(budget.mean(&format!("{name}, {walk}"), (f.value, f.std_error.unwrap(), 15.0), EXACT, 0.25));
        }
    }
    all_pass(results);
}

/// 95 % intervals hold the truth in about 95 % of 500 runs, for every sequence; 99 % ones too.
#[test]
fn replicate_intervals_cover() {
    let mut budget = Budget::of("sampling::coverage");
    let eq = Equation::on_interval(0.0..=1.0, |_| 1.0, |x, y| 0.5 * x * y).tabulated(8).unwrap();
    let query = eq.at(0.5);
    let mut results = Vec::new();
    for (name, sequence) in randomised(6) {
        let runs = 500;
        let (mut hits, mut wide) = (0, 0);
        for seed in 0..runs {
            let walk = Walk::collision().sequence(sequence.with_seed(seed)).samples_per_cell(16 * 36);
            let f = query.solve(&walk).unwrap();
            hits += u64::from((f.value - EXACT).abs() <= f.half_width(0.95).unwrap());
            wide += u64::from((f.value - EXACT).abs() <= f.half_width(0.99).unwrap());
        }
        results.push(budget.frequency(&format!("{name}, 95 %"), hits, runs, 0.93, 0.97));
        results.push(budget.frequency(&format!("{name}, 99 %"), wide, runs, 0.975, 0.998));
    }
    all_pass(results);
}

/// With one replicate, or points of the textbook, there is no error, and none is invented.
#[test]
fn one_replicate_has_no_error() {
    let eq = Equation::on_interval(0.0..=1.0, |_| 1.0, |x, y| 0.5 * x * y);
    for sobol in [Sobol::new(3).replicates(1), Sobol::new(3).unscrambled()] {
        let f = eq.at(0.5).solve(&Walk::collision().sequence(sobol)).unwrap();
        assert_eq!((f.std_error, f.half_width(0.95)), (None, None));
        assert!((f.value - EXACT).abs() < 0.01, "{f}");
    }
    assert!(eq.at(0.5).solve(&Walk::collision().sequence(Sobol::new(3).replicates(0))).is_err());
}

/// What low discrepancy is for: a walk of two steps without roulette is a smooth function of two coordinates.
#[test]
fn low_discrepancy_pays_in_walks() {
    let eq = Equation::on_interval(0.0..=1.0, |_| 1.0, |x, y| 0.5 * x * y);
    let line = Layout::of_dimension(1).start(0).survival(0).event(0);
    let error = |sequence: Any| {
        let walk = Walk::fixed_depth(6).sequence(sequence).samples_per_cell(16 << 10);
        eq.at(0.5).solve(&walk).unwrap().std_error.unwrap()
    };
    let (pcg, sobol) = (error(Any::Pcg(Pcg::new(5))), error(Any::Sobol(Sobol::new(5).layout(line))));
    assert!(sobol < 0.02 * pcg, "Sobol' {sobol:.1e}, PCG {pcg:.1e}");
}
