//! The law of the randomisations: every coordinate uniform, pairs of points as Owen's nested uniform scrambling has them, coordinates
//! independent.

use crate::any::{Any, randomised};
use crate::common::{Budget, all_pass};
use fredholm::sampling::{Halton, Pcg, Purpose, Sampler, Sequence, Sobol, VanDerCorput};

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

/// Randomised points are part of the results' bits: two fresh numbers, two of a move, one beyond the coordinates, in units of 2⁻⁵³.
#[test]
fn golden_numbers() {
    let golden: [(&str, [u64; 5]); 8] = [
        ("PCG", [2_009_716_109_990_635, 8_614_672_167_499_489, 2_228_572_822_676_631, 797_436_720_825_951, 1_276_306_450_371_785]),
        ("Sobol'", [8_596_089_330_132_571, 3_575_446_148_579_867, 1_116_956_565_859_061, 2_597_896_437_281_653, 7_411_569_137_803_467]),
        ("Halton", [260_086_626_893_171, 8_265_443_474_405_843, 7_136_993_509_602_591, 2_150_153_736_611_547, 7_411_569_137_803_467]),
        ("Hammersley", [1_407_181_605_864_375, 6_341_709_082_798_543, 4_827_231_145_898_679, 3_084_263_246_752_185, 5_319_106_025_425_255]),
        (
            "van der Corput 2",
            [6_049_014_027_191_653, 3_555_662_042_594_269, 6_525_264_125_072_453, 6_463_471_492_274_417, 7_411_569_137_803_467],
        ),
        (
            "van der Corput 10",
            [5_733_762_053_275_717, 3_555_662_042_594_269, 6_525_264_125_072_453, 6_463_471_492_274_417, 7_411_569_137_803_467],
        ),
        (
            "Latin hypercube",
            [7_847_556_150_229_177, 5_198_509_454_687_519, 6_412_367_239_611_585, 5_109_978_434_751_751, 2_490_458_640_141_473],
        ),
        ("stratified", [4_368_626_836_693_733, 7_644_314_951_704_311, 7_635_070_448_964_351, 5_376_775_571_996_091, 954_635_305_824_897]),
    ];
    let all = [("PCG", Any::Pcg(Pcg::new(0)))].into_iter().chain(randomised(4));
    let found: Vec<(&str, [u64; 5])> = all
        .map(|(name, sequence)| {
            let mut u = sequence.with_seed(2026).point(3, 2, 11);
            let mut read = |place: Option<(u64, Purpose)>| {
                place.into_iter().for_each(|(vertex, purpose)| u.seek(vertex, purpose));
                (u.next_1d() * 2f64.powi(53)) as u64
            };
            let step = Some((5, Purpose::Move));
            (name, [read(None), read(None), read(step), read(None), read(Some((900, Purpose::Event)))])
        })
        .collect();
    assert_eq!(found, golden);
}
