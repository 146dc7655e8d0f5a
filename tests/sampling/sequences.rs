//! Known points, nets, strata, and cursors that find their place again.

use crate::any::{Any, points, randomised};
use fredholm::sampling::{Halton, Hammersley, Pcg, Purpose, Sampler, Sequence, Sobol, Stratified, VanDerCorput};
use std::collections::{BTreeMap, BTreeSet};

const HALF_CELL: f64 = f64::EPSILON / 2.0;

fn close(x: f64, known: f64) -> bool {
    (x - known).abs() <= 2.0 * HALF_CELL
}

/// The order of Gray's code, in which other programs count.
fn gray(i: u64) -> u64 {
    i ^ (i >> 1)
}

/// `scipy.stats.qmc.Sobol(5, scramble=False)` 1.17.1, and single coordinates of its points 1234 and 4095 in 1111 dimensions.
#[test]
fn sobol_points_are_those_of_scipy() {
    let known = [
        [0.0, 0.0, 0.0, 0.0, 0.0],
        [0.5, 0.5, 0.5, 0.5, 0.5],
        [0.75, 0.25, 0.25, 0.25, 0.75],
        [0.25, 0.75, 0.75, 0.75, 0.25],
        [0.375, 0.375, 0.625, 0.875, 0.375],
        [0.875, 0.875, 0.125, 0.375, 0.875],
        [0.625, 0.125, 0.875, 0.625, 0.625],
        [0.125, 0.625, 0.375, 0.125, 0.125],
    ];
    let sobol = Sobol::new(0).unscrambled();
    for (i, known) in known.iter().enumerate() {
        let mut u = sobol.point(0, 0, gray(i as u64));
        assert!(known.iter().all(|x| close(u.next_1d(), *x)), "point {i}");
    }
    let columns = [0, 1, 2, 10, 100, 500, 999, 1110];
    let rows = [
        (1234, [0.86474609375, 0.41943359375, 0.82666015625, 0.27099609375, 0.60888671875, 0.55517578125, 0.14306640625, 0.85791015625]),
        (
            4095,
            [
                0.000244140625,
                0.941162109375,
                0.334228515625,
                0.569580078125,
                0.344970703125,
                0.437255859375,
                0.308349609375,
                0.338623046875,
            ],
        ),
    ];
    for (i, known) in rows {
        let mut u = sobol.point(0, 0, gray(i));
        let x: Vec<f64> = (0..Sobol::DIMENSIONS).map(|_| u.next_1d()).collect();
        for (column, known) in columns.iter().zip(known) {
            assert!(close(x[*column], known), "point {i}, coordinate {column}: {} is not {known}", x[*column]);
        }
    }
}

/// `scipy.stats.qmc.Halton(5, scramble=False)`, as fractions.
#[test]
fn halton_points_are_the_mirrored_digits() {
    let known = [(1, [1, 1, 1, 1, 1]), (2, [1, 2, 2, 2, 2]), (8, [1, 8, 16, 8, 8])];
    let powers = [(1, [2, 3, 5, 7, 11]), (2, [4, 3, 5, 7, 11]), (8, [16, 9, 25, 49, 11])];
    for ((i, numerators), (_, denominators)) in known.into_iter().zip(powers) {
        let mut u = Halton::new(0).unscrambled().point(0, 0, i);
        let mut h = Hammersley::new(32).unwrap().unscrambled().point(0, 0, i);
        assert!(close(h.next_1d(), i as f64 / 32.0));
        for (a, b) in numerators.into_iter().zip(denominators) {
            let x = u.next_1d();
            assert!(close(x, f64::from(a) / f64::from(b)), "point {i}: {x} is not {a}/{b}");
            assert_eq!(h.next_1d(), x);
        }
    }
    // 2026 = 3·675 + 1 = 2210001₃ … digits by hand: 2026 = 2·3⁶ + 2·3⁵ + 1·3⁴ + 0·3³ + 0·3² + 0·3 + 1
    let ternary = VanDerCorput::new(3).unwrap().unscrambled();
    let mirrored = [1.0, 0.0, 0.0, 0.0, 1.0, 2.0, 2.0];
    let x: f64 = mirrored.iter().enumerate().map(|(l, d)| d * 3f64.powi(-(l as i32) - 1)).sum();
    assert!(close(ternary.point(0, 0, 2026).next_1d(), x));
}

/// How many points fall into each box of a grid. Numbers like 1/3 may have been rounded down, hence the nudge.
fn occupied(points: &[Vec<f64>], boxes: &[u64]) -> BTreeMap<Vec<u64>, u64> {
    let mut counts = BTreeMap::new();
    for p in points {
        *counts.entry(p.iter().zip(boxes).map(|(x, b)| (x * *b as f64 + 1e-9) as u64).collect()).or_insert(0) += 1;
    }
    counts
}

/// All ways to write k as a sum of d numbers.
fn splits(k: u32, d: usize) -> Vec<Vec<u32>> {
    if d == 1 {
        return vec![vec![k]];
    }
    (0..=k).flat_map(|first| splits(k - first, d - 1).into_iter().map(move |rest| [vec![first], rest].concat())).collect()
}

/// Every elementary interval of volume 2^{t−m} holds 2^t points of every aligned block of 2^m: t = 0 for two coordinates, Σ(degree − 1) for
/// more; scrambling keeps it, digit by digit. 1-D: every one of the 1111 coordinates is a (0, 1)-sequence.
#[test]
fn sobol_blocks_are_nets() {
    let plain = Sobol::new(0).unscrambled();
    for sobol in [plain, Sobol::new(1), Sobol::new(2)] {
        for (d, t) in [(1, 0), (2, 0), (3, 1), (4, 3), (5, 5)] {
            for (m, block) in [(4u32, 0), (6, 3), (8, 0), (8, 1), (8, (1 << 20) + 5), (7, 1 << 40)].into_iter().filter(|c| c.0 > t) {
                let indices = block << m..(block + 1) << m;
                let points: Vec<Vec<f64>> = sobol.points(0, 3, indices).map(|mut u| (0..d).map(|_| u.next_1d()).collect()).collect();
                for k in splits(m - t, d) {
                    let boxes: Vec<u64> = k.iter().map(|k| 1 << k).collect();
                    let counts = occupied(&points, &boxes);
                    assert!(
                        counts.len() == 1 << (m - t) && counts.values().all(|c| *c == 1 << t),
                        "{sobol:?} {d}-D m {m} block {block} {k:?}"
                    );
                }
            }
        }
        let points: Vec<Vec<f64>> =
            sobol.points(0, 0, 512..768).map(|mut u| (0..Sobol::DIMENSIONS).map(|_| u.next_1d()).collect()).collect();
        for j in 0..Sobol::DIMENSIONS as usize {
            let strata: BTreeSet<u64> = points.iter().map(|p| (p[j] * 256.0) as u64).collect();
            assert_eq!(strata.len(), 256, "coordinate {j}");
        }
    }
}

/// b_1^k_1 … b_s^k_s neighbouring Halton points: one in every box of that grid. Hammersley: one in every stratum besides.
#[test]
fn halton_blocks_fill_their_boxes() {
    for halton in [Halton::new(0).unscrambled(), Halton::new(1), Halton::new(5)] {
        for boxes in [vec![4, 9], vec![8, 3, 5], vec![2, 27, 1, 7], vec![1, 1, 125], vec![16, 1, 1, 1, 11]] {
            let n: u64 = boxes.iter().product();
            for first in [0, 3 * n, (n << 30) / n * n] {
                let points: Vec<Vec<f64>> =
                    halton.points(0, 1, first..first + n).map(|mut u| boxes.iter().map(|_| u.next_1d()).collect()).collect();
                let counts = occupied(&points, &boxes);
                assert!(counts.len() as u64 == n && counts.values().all(|c| *c == 1), "{halton:?} {boxes:?} from {first}");
            }
        }
    }
    let set = points(Any::Hammersley(Hammersley::new(72).unwrap().with_seed(3)), 2, 72, 3);
    for boxes in [[72, 1, 1], [1, 8, 9], [9, 8, 1], [8, 1, 9]] {
        assert_eq!(occupied(&set, &boxes).len(), 72, "{boxes:?}");
    }
}

/// Randomised, the points of a Hammersley set come in a random order: the first tenth of a set is no arc, and the rank says nothing about the coordinate.
#[test]
fn hammersley_sets_come_in_a_random_order() {
    let n = 1000u64;
    for seed in 0..20 {
        let set = points(Any::Hammersley(Hammersley::new(n).unwrap().with_seed(seed)), 0, n, 1);
        let first: Vec<f64> = set.iter().take(100).map(|p| p[0]).collect();
        let thirds = first.iter().fold([0; 3], |mut t, x| {
            t[(3.0 * x) as usize] += 1;
            t
        });
        // hypergeometric: 33 ± 4.5 in each third
        assert!(thirds.iter().all(|t| (5..=65).contains(t)), "{thirds:?}");
        let correlation = set.iter().zip(0..).map(|(p, i)| (p[0] - 0.5) * (f64::from(i) / n as f64 - 0.5)).sum::<f64>() * 12.0 / n as f64;
        assert!(correlation.abs() < 0.25, "{correlation}");
        // the set is the same as ever: one point in each stratum
        assert_eq!(occupied(&set, &[n]).len() as u64, n);
    }
}

/// One point in every cell of every group of coordinates, at every vertex, in every set of n points.
#[test]
fn strata_hold_one_point_each() {
    for (strata, axes) in [(9u64, 1u32), (5, 2), (3, 3), (1, 2), (64, 1)] {
        let n = strata.pow(axes);
        let sequence = Stratified::new(strata, axes).unwrap().with_seed(8);
        for set in [0, 1, 1000] {
            for (vertex, purpose) in [(0, Purpose::Start), (0, Purpose::Move), (7, Purpose::Event), (12_345, Purpose::Survival)] {
                let mut cursors: Vec<_> = sequence.points(4, 2, set * n..(set + 1) * n).collect();
                for u in &mut cursors {
                    u.seek(vertex, purpose);
                }
                for group in 0..3 {
                    let points: Vec<Vec<f64>> = cursors.iter_mut().map(|u| (0..axes).map(|_| u.next_1d()).collect()).collect();
                    let cells = occupied(&points, &vec![strata; axes as usize]);
                    assert_eq!(cells.len() as u64, n, "{strata}^{axes}, set {set}, vertex {vertex}, group {group}");
                }
            }
        }
    }
}

const PURPOSES: [Purpose; 4] = [Purpose::Start, Purpose::Survival, Purpose::Move, Purpose::Event];

/// Wherever a cursor has been before, what it reads at a vertex for a purpose is the same, also beyond its coordinates and beyond the
/// table; `points` gives what `point` gives; no number is ever read twice.
#[test]
fn cursors_find_their_place_again() {
    for (name, sequence) in randomised(5) {
        let places: Vec<(u64, Purpose)> = [0, 1, 2, 200, 1 << 33].into_iter().flat_map(|v| PURPOSES.map(|p| (v, p))).collect();
        for (index, mut walk) in (3..).zip(sequence.points(7, 2, 3..6)) {
            let read = |u: &mut <Any as Sequence>::Sampler, (v, p): (u64, Purpose)| -> Vec<u64> {
                u.seek(v, p);
                (0..7).map(|_| u.next_1d().to_bits()).collect()
            };
            let forth: Vec<_> = places.iter().map(|p| read(&mut walk, *p)).collect();
            let mut other = sequence.point(7, 2, index);
            let mut back: Vec<_> = places.iter().rev().map(|p| read(&mut other, *p)).collect();
            back.reverse();
            assert_eq!(forth, back, "{name}");
            let mut plain = sequence.point(7, 2, index);
            let alone: Vec<u64> = (0..40).map(|_| plain.next_1d().to_bits()).collect();
            let distinct: BTreeSet<_> = forth.iter().flatten().collect();
            assert_eq!(distinct.len(), 7 * places.len(), "{name} repeats itself");
            assert_eq!(alone.iter().collect::<BTreeSet<_>>().len(), 40);
        }
    }
}

/// Blocks hold what cursors read, whatever their size, and beyond the table.
#[test]
fn blocks_hold_what_cursors_read() {
    for (name, sequence) in randomised(9) {
        for (from, n, d) in [(0u64, 1usize, 1usize), (60, 9, 3), (3, 200, 2), ((1 << 40) - 5, 70, 7), (0, 2, 1200), (7, 0, 3)] {
            let mut block = vec![0.0; n * d];
            sequence.fill(3, 1, from..from + n as u64, &mut block);
            let read: Vec<f64> = sequence.points(3, 1, from..from + n as u64).flat_map(|mut u| (0..d).map(move |_| u.next_1d())).collect();
            assert_eq!(block, read, "{name}, {n} points of {d} coordinates from {from}");
        }
    }
    for sobol in [Sobol::new(4), Sobol::new(4).unscrambled()] {
        let mut block = [0.0; 3 * 77];
        sobol.fill(0, 0, 100..177, &mut block);
        let read: Vec<f64> = sobol.points(0, 0, 100..177).flat_map(|mut u| [u.next_1d(), u.next_1d(), u.next_1d()]).collect();
        assert_eq!(block[..], read);
        let mut last = [0.0; 4];
        sobol.fill(0, 0, u64::MAX - 2..u64::MAX, &mut last);
        assert_eq!(last[2], sobol.point(0, 0, u64::MAX - 1).next_1d());
    }
}

/// Points, cells, replicates and seeds differ.
#[test]
fn names_name_different_points() {
    for (name, sequence) in randomised(8) {
        let read = |s: Any, cell, replicate, index| {
            let mut u = s.point(cell, replicate, index);
            u.seek(0, Purpose::Move);
            u.next_1d().to_bits()
        };
        let mut seen = BTreeSet::new();
        for seed in 0..4 {
            for (cell, replicate, index) in (0..4).flat_map(|c| (0..4).flat_map(move |r| (0..64).map(move |i| (c, r, i)))) {
                assert!(seen.insert(read(sequence.with_seed(seed), cell, replicate, index)), "{name}");
            }
        }
    }
    // a seed means a scramble
    let plain = Sobol::new(0).unscrambled();
    assert_eq!((Sequence::replicates(&plain), Sequence::replicates(&plain.replicates(4))), (Some(1), Some(4)));
    assert_ne!(plain.with_seed(3).point(0, 0, 1).next_1d(), plain.point(0, 0, 1).next_1d());
    assert_ne!(plain.replicates(4).point(0, 0, 1).next_1d(), plain.point(0, 0, 1).next_1d());
    assert_eq!(Sequence::replicates(&Pcg::new(1)), None);
}

#[test]
fn bad_settings_are_refused() {
    let refusal = Stratified::new(1 << 30, 2).unwrap_err().to_string();
    assert!(refusal.contains("1073741824"), "{refusal}");
    assert!(Stratified::new(0, 2).is_err() && Stratified::new(2, 0).is_err() && Stratified::new(u64::MAX, 3).is_err());
    assert!(VanDerCorput::new(0).is_err() && VanDerCorput::new(1).is_err() && Hammersley::new(0).is_err());
    assert!(fredholm::sampling::LatinHypercube::new(0).is_err());
    for (dimension, points) in [(1, u64::MAX), (usize::MAX, 2), (usize::MAX, u64::MAX), (1 << 16, 1 << 16)] {
        let refusal = fredholm::sampling::PointSet::draw(&Pcg::new(0), dimension, points).unwrap_err().to_string();
        assert!(refusal.contains("number of coordinates"), "{refusal}");
    }
}
