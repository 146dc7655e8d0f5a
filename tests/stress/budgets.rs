//! Budgets that nobody would choose: one, a walk more or less than a chunk, the largest number there is.

use crate::contained::{contained, one, quietly, unit};
use crate::erased::{Equation, source_fn};
use fredholm::detector::Bins;
use fredholm::deterministic::{Galerkin, Nystrom};
use fredholm::estimator::{Combination, Debias, Metropolis, Survivors};
use fredholm::integral::{Integral, Secondary, Strata, Stratified};
use fredholm::kernel::Tabulated;
use fredholm::sampling::Sobol;
use fredholm::statistics::Study;
use fredholm::transport::{CollisionTally, Histories, Slab};
use fredholm::walk::{ArrayRqmc, Histogram};
use fredholm::{Bidirectional, Error, Estimate, Forward, Walk};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// Every method gives as many scores as asked for, or up to a whole number of replicates more.
#[test]
fn of_few_walks_are_kept_to() {
    let eq = Equation::on_interval(0.0..=1.0, |x| 1.0 + x, |x, y| 0.5 * x * y);
    let (query, bins) = (eq.at(0.5), Bins::new(0.0..=1.0, 3));
    let (seen, integral) = (eq.seen_by(&bins), Integral::new(unit(), source_fn(unit(), |x: &f64| 1.0 + x)));
    let estimator = query.estimator(&Walk::collision()).unwrap();
    let one = |mut cells: Vec<Estimate>| cells.remove(0);
    for n in [1, 2, 3, 5, 127, 1023, 1024, 1025] {
        let sobol = Sobol::new(1).replicates(4);
        for (replicates, e) in [
            (1, query.solve(&Walk::mis().samples_per_cell(n)).unwrap()),
            (4, query.solve(&Walk::mis().sequence(sobol).samples_per_cell(n)).unwrap()),
            (1, one(seen.solve(&Forward::new().walks(n)).unwrap())),
            (4, one(seen.solve(&Forward::new().sequence(sobol).walks(n)).unwrap())),
            (1, query.solve(&Bidirectional::new().samples_per_cell(n)).unwrap()),
            (1, one(seen.solve(&Bidirectional::new().samples_per_cell(n)).unwrap())),
            (4, one(seen.solve(&Bidirectional::new().sequence(sobol).samples_per_cell(n)).unwrap())),
            (1, Combination::new().with(&estimator).samples_per_cell(n).solve().unwrap().remove(0).estimate),
            (1, integral.solve(&Secondary::plain().samples(n)).unwrap()),
            (4, integral.solve(&Secondary::plain().sequence(sobol).samples(n)).unwrap()),
        ] {
            assert_eq!(e.moments.count, n.div_ceil(replicates) * replicates, "{n} walks, {replicates} replicates: {e:?}");
            assert!(e.value.is_finite() && (e.std_error.is_some() || n.div_ceil(replicates) < 2 || replicates > 1), "{n}: {e:?}");
        }
        assert_eq!(query.strategies(&Bidirectional::new().samples_per_cell(n), 0, 1).unwrap()[0].alone.count, n);
    }
}

/// A run of 2⁶⁴ − 1 walks begins like any other: here a function breaks after some ten thousand calls, which no overflow may forestall.
#[test]
fn without_end_do_not_overflow() {
    quietly();
    let (calls, broken) = (AtomicU64::new(0), AtomicBool::new(true));
    let f = |x: f64| if calls.fetch_add(1, Ordering::Relaxed) < 20_000 { 1.0 + x } else { one(&broken) };
    let eq = Equation::on_interval(0.0..=1.0, f, |x, y| 0.5 * x * y);
    let (query, few, many) = (eq.at(0.5), Bins::new(0.0..=1.0, 3), Bins::new(0.0..=1.0, 1 << 15));
    let integral = Integral::new(unit(), source_fn(unit(), |x: &f64| f(*x)));
    let (estimator, depths) = (query.estimator(&Walk::collision()).unwrap(), query.depths().unwrap());
    let most = u64::MAX;
    let pairs = Bidirectional::new().samples_per_cell(most);
    let twice = pairs.sequence(Sobol::new(1).replicates(2));
    let again = |result: &dyn Fn() -> Result<(), Error>| {
        calls.store(0, Ordering::Relaxed);
        contained([result()]);
    };
    again(&|| query.solve(&Walk::mis().samples_per_cell(most)).map(drop));
    again(&|| query.solve(&Walk::mis().sequence(Sobol::new(1).replicates(3)).samples_per_cell(most)).map(drop));
    again(&|| eq.seen_by(&few).solve(&Walk::collision().samples_per_cell(most)).map(drop));
    again(&|| query.rounds(&Walk::collision().samples_per_cell(most))?.try_for_each(|round| round.map(drop)));
    again(&|| eq.seen_by(&few).solve(&Forward::new().walks(most)).map(drop));
    again(&|| eq.seen_by(&few).solve(&pairs).map(drop));
    again(&|| eq.seen_by(&few).solve(&twice).map(drop));
    again(&|| eq.seen_by(&many).solve(&twice).map(drop));
    again(&|| query.solve(&pairs).map(drop));
    again(&|| query.strategies(&pairs, 0, 2).map(drop));
    again(&|| Combination::new().with(&estimator).samples_per_cell(most).solve().map(drop));
    again(&|| Debias::new(&depths).survivors(Survivors::Geometric(0.5)).samples(most).solve().map(drop));
    again(&|| integral.solve(&Secondary::plain().samples(most)).map(drop));
    again(&|| integral.solve(&Stratified::new(Strata::uniform(1 << 12)).samples(most)).map(drop));
}

/// What would be held in memory all at once is refused by name: an allocation that fails would end the program.
#[test]
fn beyond_memory_are_refused() {
    let eq = Equation::on_interval(0.0..=1.0, |x| 1.0 + x, |x, y| 0.5 * x * y);
    let query = eq.at(0.5);
    let estimator = query.estimator(&Walk::collision()).unwrap();
    let tally = query.estimator(&Walk::collision()).unwrap();
    let slab = Slab::new(1.0).scattering(0.5);
    let kernel = eq.kernel().kernel();
    let seen = |bins: usize| eq.seen_by(Box::leak(Box::new(Bins::new(0.0..=1.0, bins))));
    let sobol = Sobol::new(1).replicates(u32::MAX);
    for most in [1 << 40, u64::MAX] {
        let cells = most as usize;
        let refused = [
            query.solve(&Walk::mis().sequence(sobol)).map(drop),
            query.solve(&ArrayRqmc::new(Walk::mis().samples_per_cell(most))).map(drop),
            query.solve(&ArrayRqmc::new(Walk::mis().sequence(sobol))).map(drop),
            query.solve(&Bidirectional::new().sequence(sobol)).map(drop),
            seen(cells).solve(&Walk::collision()).map(drop),
            seen(cells).solve(&Forward::new()).map(drop),
            seen(cells).solve(&Bidirectional::new()).map(drop),
            seen(3).solve(&Forward::new().sequence(sobol)).map(drop),
            eq.solve(&Forward::new().walks(most).profile(Histogram::new(0.0..=1.0, 4)).batches(most)).map(drop),
            query.optimal(&Walk::mis(), most).map(drop),
            Combination::new().with(&estimator).pilot(most).solve().map(drop),
            Combination::new().sequence(sobol).with(&estimator).solve().map(drop),
            Debias::new(query.depths().unwrap()).pilot(most, most).solve().map(drop),
            Metropolis::new().chains(most).solve(&seen(3).tally(&Forward::new()).unwrap()).map(drop),
            Metropolis::new().solve(&seen(cells).tally(&Forward::new()).unwrap()).map(drop),
            Metropolis::new().solve(&tally).map(drop),
            Study::run(1.0, most, |_| query.solve(&Walk::collision())).map(drop),
            Histories::new(CollisionTally).batches(most).run(&slab, &source_fn(unit(), |x: &f64| *x)).map(drop),
            Tabulated::new(kernel, cells).map(drop),
            eq.clone().tabulated_source(cells).map(drop),
            eq.solve(&Nystrom::gauss_legendre(cells)).map(drop),
            eq.solve(&Nystrom::composite(cells, 2)).map(drop),
            eq.solve(&Nystrom::graded(cells, 2)).map(drop),
            eq.solve(&Galerkin::elements(cells)).map(drop),
        ];
        for (i, result) in refused.into_iter().enumerate() {
            assert!(matches!(&result, Err(Error::Invalid { .. })), "number {i} of these: {result:?}");
        }
    }
}

/// NaN where one walk in a hundred thousand comes by: every method says where, none averages over it.
#[test]
fn of_many_walks_meet_what_is_not_finite() {
    let at = 0.7;
    let g = move |x: f64| if (x - at).abs() < 5e-6 { f64::NAN } else { 1.0 + x };
    let k = move |x: f64, y: f64| if (y - at).abs() < 5e-6 { f64::INFINITY } else { 0.5 * x * y };
    let (source, kernel) = (Equation::on_interval(0.0..=1.0, g, |x, y| 0.5 * x * y), Equation::on_interval(0.0..=1.0, |x| 1.0 + x, k));
    let (bins, away, most) = (Bins::new(0.0..=1.0, 2), Bins::new(0.0..=0.5, 2), 1 << 20);
    for (what, eq) in [("NaN", &source), ("inf", &kernel)] {
        let (query, seen) = (eq.at(0.5), eq.seen_by(&bins));
        let combined = |e| Combination::new().with(e).samples_per_cell(most).solve();
        for (i, result) in [
            query.solve(&Walk::collision().samples_per_cell(most)).map(drop),
            query.solve(&Walk::mis().samples_per_cell(most)).map(drop),
            seen.solve(&Forward::new().walks(most)).map(drop),
            query.solve(&ArrayRqmc::new(Walk::collision().samples_per_cell(most))).map(drop),
            seen.solve(&Bidirectional::new().samples_per_cell(most)).map(drop),
            query.solve(&Bidirectional::new().samples_per_cell(most)).map(drop),
            query.strategies(&Bidirectional::new().samples_per_cell(most), 0, 2).map(drop),
            query.estimator(&Walk::collision()).and_then(combined).map(drop),
            Debias::new(query.depths().unwrap()).survivors(Survivors::Geometric(0.5)).samples(most).solve().map(drop),
            seen.tally(&Forward::new()).and_then(|tally| Metropolis::new().mutations(1 << 15).solve(&tally)).map(drop),
            eq.solve(&Forward::new().walks(most).profile(Histogram::new(0.0..=1.0, 4))).map(drop),
            // nobody looks there
            eq.seen_by(&away).solve(&Forward::new().walks(most)).map(drop),
        ]
        .into_iter()
        .enumerate()
        {
            let Err(message) = result.map_err(|e| e.to_string()) else { panic!("number {i}, {what}: no error") };
            let place = message.contains("0.70000") || message.contains("0.69999");
            // differences of levels do not say where
            assert!(message.contains(what) && (place || i == 8), "number {i}, {what}: {message}");
        }
    }
}
