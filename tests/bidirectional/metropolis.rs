//! Metropolis in primary sample space.

use crate::common::{Budget, all_pass};
use crate::{erased, stated};
use fredholm::detector::Bins;
use fredholm::estimator::{Combination, LargeSteps, Metropolis, OneCell, estimator_fn};
use fredholm::statistics::Study;
use fredholm::walk::Roulette;
use fredholm::{Error, Estimate, Forward, Walk};

/// Five cells of very different brightness, one of them negative: ∫ of 2^c·x, minus for cell 1.
fn truth(cell: usize) -> f64 {
    let sign = if cell == 1 { -1.0 } else { 1.0 };
    sign * 0.5 * 2f64.powi(cell as i32)
}

fn cells() -> impl fredholm::estimator::Estimator<Value = f64> {
    estimator_fn(5, |cell, u| 2.0 * truth(cell) * u.next_1d())
}

#[test]
fn chains_are_unbiased() {
    let mut budget = Budget::of("bidirectional::metropolis");
    let mut results = Vec::new();
    for large_steps in [LargeSteps::Proposals, LargeSteps::Combined] {
        // short chains from tiny pools: any start-up bias would show
        let m = Metropolis::new().chains(4096).pool(4).mutations(64).large_steps(large_steps).seed(2);
        let found = m.solve(&cells()).unwrap();
        for (cell, e) in found.cells.iter().enumerate() {
            let what = format!("{large_steps:?} cell {cell}");
            results.push(budget.mean(&what, stated(e), truth(cell), 0.4 * truth(cell).abs().max(1.0)));
        }
        let b: f64 = (0..5).map(|c| truth(c).abs()).sum();
        results.push(budget.mean("b", stated(&found.normalisation), b, 0.1 * b));
    }
    // a walk behind it: f = 1 + 3x/10 seen by cells
    let eq = erased!((0.0, 1.0), |_| 1.0, |x: f64, y: f64| 0.5 * x * y);
    let bins = Bins::new(0.0..=1.0, 4);
    let query = eq.seen_by(&bins);
    let found = Metropolis::new().chains(64).mutations(4096).seed(3).solve(&query.estimator(&Walk::mis()).unwrap()).unwrap();
    for (cell, e) in found.cells.iter().enumerate() {
        results.push(budget.mean(&format!("walk cell {cell}"), stated(e), 1.0 + 0.3 * bins.centre(cell), 0.12));
    }
    all_pass(results);
}

/// One point scores in many cells: forward walks, alone, in cells, and along chains.
#[test]
fn forward_walks_are_tallies() {
    let mut budget = Budget::of("bidirectional::forward");
    let mut results = Vec::new();
    let eq = erased!((0.0, 1.0), |_| 1.0, |x: f64, y: f64| 0.5 * x * y);
    let bins = Bins::new(0.0..=1.0, 4);
    let query = eq.seen_by(&bins);
    let walk = Forward::new().roulette(Roulette::constant(0.7));
    let found = Metropolis::new().chains(64).mutations(4096).seed(5).solve(&query.tally(&walk).unwrap()).unwrap();
    let both = Combination::new()
        .with(query.estimator(&Walk::collision()).unwrap())
        .with(OneCell(query.tally(&walk).unwrap()))
        .samples_per_cell(1 << 15)
        .solve()
        .unwrap();
    for (cell, (chains, combined)) in found.cells.iter().zip(&both).enumerate() {
        let truth = 1.0 + 0.3 * bins.centre(cell);
        results.push(budget.mean(&format!("chains, cell {cell}"), stated(chains), truth, 0.2));
        results.push(budget.mean(&format!("combined, cell {cell}"), stated(&combined.estimate), truth, 0.05));
    }
    all_pass(results);
    let error = query.tally(&Forward::new().depth(3)).map(drop).unwrap_err();
    assert!(matches!(error, Error::Invalid { parameter: "depth", .. }), "{error}");
    let long = query.tally(&walk.max_steps(1)).unwrap();
    assert!(matches!(Metropolis::new().solve(&long), Err(Error::WalkTooLong { steps: 1, .. })));
}

/// ≥ 400 repetitions: Student's intervals over 20 chains contain the truth as often as they say.
#[test]
fn intervals_from_chains_cover() {
    let mut budget = Budget::of("bidirectional::metropolis coverage");
    let mut results = Vec::new();
    for (large_steps, cell) in [(LargeSteps::Proposals, 1), (LargeSteps::Proposals, 4), (LargeSteps::Combined, 2)] {
        let solve = |seed| -> Result<Estimate, Error> {
            let m = Metropolis::new().chains(20).pool(32).mutations(256).large_steps(large_steps).seed(seed);
            Ok(m.solve(&cells())?.cells.swap_remove(cell))
        };
        let coverage = Study::run(truth(cell), 600, solve).unwrap().coverage(0.95);
        results.push(budget.frequency(&format!("{large_steps:?} cell {cell}"), coverage.hits, coverage.trials, 0.93, 0.97));
    }
    all_pass(results);
}

/// A peak in a corner of the cube: small steps stay in it, so that the share of mutations that score is far above that of random points.
#[test]
fn chains_stay_where_the_target_is() {
    let peak = estimator_fn(2, |cell, u| {
        let [a, b] = u.next_2d();
        let (d2, s) = ((a - 0.3).powi(2) + (b - 0.6).powi(2), 0.02f64);
        (1.0 + cell as f64) * if d2 < s * s { 1.0 } else { 0.0 }
    });
    let truth = std::f64::consts::PI * 4e-4;
    let m = Metropolis::new().chains(32).pool(4096).mutations(1 << 13).seed(4).solve(&peak).unwrap();
    assert!(m.cells[0].agrees_with(truth, 6.0) && m.cells[1].agrees_with(2.0 * truth, 6.0), "{} {}", m.cells[0], m.cells[1]);
    let scored = |e: &Estimate| e.moments.nonzero as f64 / e.moments.count as f64;
    assert!(scored(&m.cells[0]) + scored(&m.cells[1]) > 0.3);
    let (small, large) = (m.acceptance.unwrap(), m.large_acceptance.unwrap());
    assert!(small > 0.4 && large < 0.01, "{small} {large}");
}

/// Pools are paid for: by the normalisation alone, and by every cell. No small steps have no acceptance.
#[test]
fn what_pools_cost_is_counted() {
    for (large_steps, pools) in [(LargeSteps::Proposals, 1), (LargeSteps::Combined, 2)] {
        let m = Metropolis::new().pool(100).mutations(50).large_steps(large_steps).large_step_probability(1.0);
        let m = m.solve(&cells()).unwrap();
        assert_eq!(m.normalisation.evaluations, 3200);
        // every chain's start is walked once more
        assert_eq!(m.cells[0].evaluations, 32 * (pools * 100 + 1 + 50));
        assert_eq!(m.acceptance, None);
        assert!(m.large_acceptance.unwrap() > 0.0);
    }
}

#[test]
fn the_same_bits_for_any_number_of_threads() {
    let solve = || Metropolis::new().mutations(200).solve(&cells()).unwrap();
    let run = |threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(solve);
    let (one, three) = (run(1), run(3));
    for (a, b) in one.cells.iter().zip(&three.cells) {
        assert_eq!((a.value, a.std_error), (b.value, b.std_error));
    }
}

#[test]
fn refusals() {
    let zero = estimator_fn(3, |_, _| 0.0);
    let small = Metropolis::new().mutations(16).pool(8);
    assert_eq!(small.solve(&zero).unwrap_err(), Error::ZeroTarget { samples: 256 });
    assert_eq!(small.large_steps(LargeSteps::Combined).solve(&zero).unwrap_err(), Error::ZeroTarget { samples: 256 });
    let one = estimator_fn(1, |_, u| u.next_1d());
    let error = small.solve(&one).unwrap_err();
    assert!(error.to_string().contains("single number"), "{error}");
    for (bad, name) in [
        (small.chains(19), "chains"),
        (small.mutations(0), "mutations"),
        (small.pool(0), "pool"),
        (small.large_step_probability(0.0), "large step probability"),
        (small.small_steps(0.1, 0.01), "least small step"),
        (small.small_steps(0.1, 0.6), "largest small step"),
    ] {
        assert!(matches!(bad.solve(&cells()), Err(Error::Invalid { parameter, .. }) if parameter == name), "{name}");
    }
    let nan = estimator_fn(2, |_, u| if u.next_1d() < 0.1 { f64::NAN } else { 1.0 });
    assert!(matches!(small.solve(&nan), Err(Error::NonFiniteScore { .. })));
}
