//! Discrepancies against brute force, other programs, published optima, and what they are for.

use fredholm::sampling::{Halton, Hammersley, Pcg, PointSet, Sampler, Sequence, Sobol, VanDerCorput};

fn set(points: &[Vec<f64>]) -> PointSet {
    PointSet::new(points).unwrap()
}

/// All boxes whose sides are coordinates of any point, or 1; open and closed counts.
fn brute_force(points: &[Vec<f64>]) -> f64 {
    let (d, n) = (points[0].len(), points.len() as f64);
    let sides: Vec<Vec<f64>> = (0..d).map(|k| points.iter().map(|p| p[k]).chain([1.0]).collect()).collect();
    let mut best = 0.0f64;
    for code in 0..(points.len() + 1).pow(d as u32) {
        let y: Vec<f64> = (0..d).map(|k| sides[k][code / (points.len() + 1).pow(k as u32) % (points.len() + 1)]).collect();
        let volume: f64 = y.iter().product();
        let count =
            |inside: fn(&f64, &f64) -> bool| points.iter().filter(|p| p.iter().zip(&y).all(|(x, y)| inside(x, y))).count() as f64 / n;
        best = best.max(volume - count(|x, y| x < y)).max(count(|x, y| x <= y) - volume);
    }
    best
}

/// Random sets, with ties and zeros among them.
#[test]
fn star_is_that_of_brute_force() {
    let mut u = Pcg::new(3).point(0, 0, 0);
    for (d, n, repetitions) in [(1, 9, 40), (2, 1, 20), (2, 12, 40), (3, 7, 40), (4, 5, 30), (5, 3, 10)] {
        for repetition in 0..repetitions {
            let coarse = repetition % 2 == 0;
            let points: Vec<Vec<f64>> =
                (0..n).map(|_| (0..d).map(|_| if coarse { (u.next_1d() * 5.0).floor() / 5.0 } else { u.next_1d() }).collect()).collect();
            let (exact, known) = (set(&points).star().unwrap(), brute_force(&points));
            assert!((exact - known).abs() < 1e-14, "{d}-D {points:?}: {exact}, brute force {known}");
            let bounds = set(&points).star_bounds(200).unwrap();
            assert!(bounds.lower <= exact + 1e-14 && exact <= bounds.upper + 1e-14, "{bounds:?} {exact}");
        }
    }
}

/// `scipy.stats.qmc.discrepancy` 1.17.1; CD and WD are squares there.
#[test]
fn square_means_are_those_of_scipy() {
    let three = set(&[vec![0.5, 0.25], vec![0.125, 0.75], vec![0.875, 0.0625]]);
    let halton = PointSet::draw(&Halton::new(0).unscrambled(), 3, 17).unwrap();
    let sobol = PointSet::draw(&Sobol::new(0).unscrambled(), 2, 64).unwrap();
    let known = [
        (three, [0.06509399414062478, 0.07765028211805558, 0.13336028780280587]),
        (halton, [0.023451853882676676, 0.013906189511633471, 0.08361895613023887]),
        (sobol, [0.00024001962608743987, 0.00025360120667361485, 0.012869849626468793]),
    ];
    for (points, [centred, wrapped, l2]) in known {
        assert!((points.centred_l2().powi(2) - centred).abs() < 1e-13);
        assert!((points.wrap_around_l2().powi(2) - wrapped).abs() < 1e-13);
        assert!((points.l2_star() - l2).abs() < 1e-12);
        assert!(points.l2_star() <= points.star().unwrap());
    }
}

/// In one dimension: 1/(2n) for midpoints, at least that for all; in two: no pair of points is better than 0.3660 (White 1977), and some
/// come near.
#[test]
fn published_optima() {
    let midpoints: Vec<Vec<f64>> = (0..50).map(|i| vec![(f64::from(i) + 0.5) / 50.0]).collect();
    assert!((set(&midpoints).star().unwrap() - 0.01).abs() < 1e-15);
    let mut u = Pcg::new(1).point(0, 0, 0);
    let (mut best, mut at) = (1.0, [0.5, 0.5, 0.5, 0.5]);
    for step in 0..40_000 {
        let scale = 0.3 / (1.0 + f64::from(step) / 500.0);
        let trial = at.map(|x: f64| (x + scale * (u.next_1d() - 0.5)).clamp(0.0, 0.999));
        let star = PointSet::new(&[&trial[..2], &trial[2..]]).unwrap().star().unwrap();
        if star < best {
            (best, at) = (star, trial);
        }
    }
    let optimum = (3f64.sqrt() - 1.0) / 2.0;
    assert!(best >= optimum - 1e-12 && best < optimum + 1e-3, "{best} at {at:?}, not {optimum}");
}

/// Bounds enclose the exact value, and tighten.
#[test]
fn bounds_enclose_and_tighten() {
    for (d, n) in [(2, 200), (3, 100), (4, 40)] {
        for points in [PointSet::draw(&Pcg::new(5), d, n).unwrap(), PointSet::draw(&Sobol::new(2), d, n).unwrap()] {
            let exact = points.star().unwrap();
            let mut gap = 1.0;
            for brackets in [1, 100, 20_000] {
                let b = points.star_bounds(brackets).unwrap();
                assert!(b.lower <= exact + 1e-14 && exact <= b.upper + 1e-14, "{d}-D, {brackets}: {b:?}, {exact}");
                assert!(b.upper - b.lower < gap);
                gap = b.upper - b.lower;
            }
            assert!(gap < 0.25 * exact + 0.02, "{d}-D: gap {gap} of {exact}");
        }
    }
    let many = PointSet::draw(&Sobol::new(2), 6, 1 << 12).unwrap();
    let refusal = many.star().unwrap_err().to_string();
    assert!(refusal.contains("4096") && refusal.contains("star_bounds"), "{refusal}");
    let b = many.star_bounds(300).unwrap();
    assert!(0.0 < b.lower && b.lower < b.upper && b.upper < 1.0);
}

/// |Σ f/n − ∫f| ≤ V D*: ∏ x_j has variation 2^d − 1 (each of its faces at x = 1 contributes 1), eˣ has e − 1; and ∏ x_j in the plane uses up a good part.
#[test]
fn koksma_and_hlawka_bound_the_error() {
    let mut largest = 0.0f64;
    for d in 1..=3 {
        for n in [5, 32, 100, 243] {
            let sets = [
                PointSet::draw(&Halton::new(0).unscrambled(), d, n),
                PointSet::draw(&Hammersley::new(n).unwrap(), d, n),
                PointSet::draw(&Sobol::new(1), d, n),
                PointSet::draw(&Pcg::new(2), d, n),
            ];
            for points in sets.map(Result::unwrap) {
                let mean = points.iter().map(|x| x.iter().product::<f64>()).sum::<f64>() / n as f64;
                let (error, bound) = ((mean - 0.5f64.powi(d as i32)).abs(), (2f64.powi(d as i32) - 1.0) * points.star().unwrap());
                assert!(error <= bound, "{d}-D, n = {n}: {error} > {bound}");
                largest = largest.max(error / bound);
            }
        }
    }
    assert!(largest > 0.2, "a bound that is never approached tests nothing: {largest}");
    let points = PointSet::draw(&VanDerCorput::new(2).unwrap().unscrambled(), 1, 100).unwrap();
    let mean = points.iter().map(|x| x[0].exp()).sum::<f64>() / 100.0;
    assert!((mean - (1f64.exp() - 1.0)).abs() <= (1f64.exp() - 1.0) * points.star().unwrap());
}

/// Low-discrepancy points deserve their name: n D* / (ln n)^d stays bounded, and random points are far behind.
#[test]
fn low_discrepancy_is_low() {
    for n in [64u64, 256, 1024] {
        let star = |s: Result<PointSet, _>| s.unwrap().star().unwrap();
        let random = star(PointSet::draw(&Pcg::new(4), 2, n));
        let halton = star(PointSet::draw(&Halton::new(0).unscrambled(), 2, n));
        let sobol = star(PointSet::draw(&Sobol::new(0).unscrambled(), 2, n));
        let scrambled = star(PointSet::draw(&Sobol::new(9), 2, n));
        let hammersley = star(PointSet::draw(&Hammersley::new(n).unwrap().unscrambled(), 2, n));
        for (name, d) in [("Halton", halton), ("Sobol'", sobol), ("scrambled Sobol'", scrambled), ("Hammersley", hammersley)] {
            let constant = n as f64 * d / (n as f64).ln().powi(2);
            assert!(constant < 0.5 && d < 0.5 * random, "{name}, n = {n}: {d}, random {random}, constant {constant}");
        }
    }
}

#[test]
fn bad_sets_are_refused() {
    assert!(PointSet::new::<[f64; 2]>(&[]).is_err() && PointSet::new(&[[0.0; 0]]).is_err());
    assert!(PointSet::new(&[vec![0.5, 0.5], vec![0.5]]).is_err());
    assert!(PointSet::new(&[[0.5, 1.0]]).is_err() && PointSet::new(&[[0.5, -0.1]]).is_err() && PointSet::new(&[[f64::NAN, 0.5]]).is_err());
    assert!(PointSet::draw(&Pcg::new(0), 2, 0).is_err() && PointSet::draw(&Pcg::new(0), 0, 2).is_err());
    assert!(PointSet::new(&[[0.5]]).unwrap().star_bounds(0).is_err());
}
