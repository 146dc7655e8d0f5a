//! The law of the randomisations: every coordinate uniform, pairs of points as Owen's nested uniform scrambling has them, coordinates
//! independent.

use crate::any::randomised;
use crate::common::{Budget, all_pass};
use fredholm::sampling::{Halton, Purpose, Sampler, Sequence, Sobol, VanDerCorput};

fn nth_number(u: &mut impl Sampler, n: usize) -> f64 {
    (0..n).for_each(|_| _ = u.next_1d());
    u.next_1d()
}

/// Over randomisations, every coordinate of every point is uniform: its own coordinates, those beyond, those of late vertices.
#[test]
fn every_number_is_uniform() {
    let mut budget = Budget::of("sampling::uniform");
    let mut results = Vec::new();
    for (name, sequence) in randomised(6) {
        for (index, vertex, purpose, nth) in
            [(0, 0, Purpose::Move, 0), (13, 0, Purpose::Start, 1), (35, 3, Purpose::Move, 2), (36, 9, Purpose::Event, 9)]
        {
            let draw = |seed: u64| {
                let mut u = sequence.with_seed(seed).point(5, 1, index);
                u.seek(vertex, purpose);
                nth_number(&mut u, nth)
            };
            let values: Vec<f64> = (0..20_000).map(draw).collect();
            results.push(budget.uniform(&format!("{name}, point {index}, {nth}th number of {purpose:?} at vertex {vertex}"), &values));
        }
    }
    all_pass(results);
}

/// Two points in one coordinate, in cells of width b⁻²: as nested uniform scrambling has it, they share the digits that they shared before,
/// differ in the next, and are independent after.
#[test]
fn pairs_follow_the_law_of_nested_scrambling() {
    let mut budget = Budget::of("sampling::pairs");
    let mut results = Vec::new();
    let draws = 200_000;
    let mut pair = |what: &str, base: usize, digits: u32, draw: &dyn Fn(u64) -> [f64; 2], shared: u32| {
        let cells = base.pow(digits);
        let mut counts = vec![0u64; cells * cells];
        for seed in 0..draws {
            let [a, b] = draw(seed).map(|x| (x * cells as f64) as usize);
            counts[a * cells + b] += 1;
        }
        let prefix = |cell: usize, k: u32| cell / base.pow(digits - k);
        let allowed = |c: usize| {
            let (a, b) = (c / cells, c % cells);
            prefix(a, shared) == prefix(b, shared) && prefix(a, shared + 1) != prefix(b, shared + 1)
        };
        let count = (0..cells * cells).filter(|c| allowed(*c)).count();
        assert!((0..cells * cells).all(|c| allowed(c) || counts[c] == 0), "{what}: not nested");
        let (seen, expected): (Vec<u64>, Vec<f64>) =
            (0..cells * cells).filter(|c| allowed(*c)).map(|c| (counts[c], draws as f64 / count as f64)).unzip();
        results.push(budget.counts(what, &seen, &expected));
    };
    for (other, coordinate) in [(1u64, 0usize), (2, 0), (4, 0), (1, 1), (3, 7), (6, 300)] {
        for first in [0, 5] {
            let read = |sobol: Sobol| {
                [first, first ^ other].map(|i| {
                    let mut u = sobol.point(0, 0, i);
                    nth_number(&mut u, coordinate)
                })
            };
            let [x, y] = read(Sobol::new(0).unscrambled()).map(|x| (x * 16.0) as u32);
            let shared = (x ^ y).leading_zeros() - 28;
            let draw = |seed| read(Sobol::new(seed));
            pair(&format!("Sobol' {coordinate} sharing {shared}, from {first}"), 2, 4, &draw, shared);
        }
    }
    for (shared, coordinate, base) in [(0u32, 1, 3usize), (1, 1, 3), (0, 2, 5), (1, 2, 5)] {
        let draw = |seed| {
            [4, 4 + base.pow(shared) as u64].map(|i| {
                let mut u = Halton::new(seed).point(0, 0, i);
                nth_number(&mut u, coordinate)
            })
        };
        pair(&format!("Halton {base} sharing {shared}"), base, 2, &draw, shared);
    }
    for (shared, base) in [(0u32, 6usize), (1, 6), (0, 4), (1, 10)] {
        let draw =
            |seed| [0, base.pow(shared) as u64].map(|i| VanDerCorput::new(base as u32).unwrap().with_seed(seed).point(0, 0, i).next_1d());
        pair(&format!("van der Corput {base} sharing {shared}"), base, 2, &draw, shared);
    }
    all_pass(results);
}

/// Coordinates of one point are independent over randomisations: an 8 × 8 table for several pairs, those beyond the table among them.
#[test]
fn coordinates_are_independent() {
    let mut budget = Budget::of("sampling::independent");
    let mut results = Vec::new();
    for (name, sequence) in randomised(8) {
        for (a, b) in [
            ((0, Purpose::Move, 0), (0, Purpose::Move, 1)),
            ((1, Purpose::Survival, 0), (2, Purpose::Event, 0)),
            ((0, Purpose::Move, 0), (400, Purpose::Move, 3)),
        ] {
            let mut counts = vec![0u64; 64];
            for seed in 0..40_000 {
                let mut u = sequence.with_seed(seed).point(0, 0, 21);
                let [x, y] = [a, b].map(|(vertex, purpose, nth)| {
                    u.seek(vertex, purpose);
                    (8.0 * nth_number(&mut u, nth)) as usize
                });
                counts[8 * x + y] += 1;
            }
            results.push(budget.counts(&format!("{name} {a:?} {b:?}"), &counts, &[625.0; 64]));
        }
    }
    all_pass(results);
}
