//! Algebraic and distributional laws over random inputs (proptest).

use fredholm::deterministic::quadrature::unit_rule;
use fredholm::domain::{Cuboid, Domain, Grouped, HalfLine, Interval};
use fredholm::kernel::{Proposal, Tabulated, Uniform, kernel_fn};
use fredholm::sampling::{Pcg, Sampler, Sequence, Table};
use fredholm::source::{SampleSource, source_fn};
use fredholm::statistics::Moments;
use fredholm::walk::{Heuristic, Technique};
use fredholm::{GroupMatrix, Spectrum, Value, Weight};
use proptest::prelude::*;

/// A generator that always says the same: the ends of (0, 1) on demand.
struct Fixed(f64);

impl Sampler for Fixed {
    fn next_1d(&mut self) -> f64 {
        self.0
    }
}

const LEAST: f64 = f64::EPSILON / 2.0;
const MOST: f64 = 1.0 - f64::EPSILON / 2.0;

fn number() -> impl Strategy<Value = f64> {
    prop_oneof![-10.0..10.0f64, Just(0.0), Just(1.0)]
}

fn spectrum() -> impl Strategy<Value = Spectrum<3>> {
    prop::array::uniform3(number()).prop_map(Spectrum)
}

fn matrix() -> impl Strategy<Value = GroupMatrix<3>> {
    prop::array::uniform3(prop::array::uniform3(number())).prop_map(GroupMatrix)
}

fn near(a: Spectrum<3>, b: Spectrum<3>, scale: f64) -> bool {
    (a - b).magnitude() <= 1e-12 * (1.0 + scale)
}

fn pairs() -> impl Strategy<Value = f64> {
    // extreme ratios, ties and zeros
    prop_oneof![
        (-300.0..300.0f64).prop_map(|e| 10f64.powf(e)),
        0.0..10.0f64,
        Just(0.0),
        Just(1.0),
        Just(1e300),
        Just(1e-300),
        Just(f64::MIN_POSITIVE),
        Just(5e-324),
        Just(f64::MAX)
    ]
}

fn heuristics() -> impl Strategy<Value = Heuristic> {
    prop_oneof![
        Just(Heuristic::Balance),
        Just(Heuristic::Maximum),
        Just(Heuristic::Average),
        (0.1..20.0f64).prop_map(Heuristic::Power),
        Just(Heuristic::Power(2.0))
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..ProptestConfig::default() })]

    /// w.then(k).apply(v) = w.apply(k.apply(v)), 1 is neutral on both sides, the product is associative: the order of theory (4.1.5).
    #[test]
    fn weights_compose_from_the_left((w, k, l) in (matrix(), matrix(), matrix()), v in spectrum()) {
        let scale = 1e4 * 30.0;
        prop_assert!(near(w.then(k).apply(v), w.apply(k.apply(v)), scale));
        prop_assert_eq!(GroupMatrix::<3>::ONE.then(w), w);
        prop_assert_eq!(w.then(GroupMatrix::ONE), w);
        prop_assert!(near(w.then(k).then(l).apply(v), w.then(k.then(l)).apply(v), 100.0 * scale));
        prop_assert!(near(w.scaled(0.3).apply(v), w.apply(v).scale(0.3), scale));
        prop_assert!(near(w.then(k.scaled(2.0)).apply(v), w.scaled(2.0).then(k).apply(v), scale));
        prop_assert_eq!(w.norm(), (0..9).map(|e| w.entry(e / 3, e % 3).abs()).fold(0.0, f64::max));
        let by_entries = Spectrum(std::array::from_fn(|i| (0..3).map(|j| w.entry(i, j) * v[j]).sum()));
        prop_assert!(near(by_entries, w.apply(v), scale));
    }

    /// Diagonal weights are matrices with nothing else.
    #[test]
    fn spectra_are_diagonal_matrices(w in spectrum(), k in spectrum(), v in spectrum()) {
        let full = |s: Spectrum<3>| GroupMatrix(std::array::from_fn(|i| std::array::from_fn(|j| Weight::entry(&s, i, j))));
        prop_assert!(near(w.then(k).apply(v), full(w).then(full(k)).apply(v), 1e4));
        prop_assert_eq!(w.norm(), full(w).norm());
        prop_assert_eq!(Spectrum::<3>::ONE.apply(v), v);
        prop_assert_eq!(w.entries_finite(), full(w).entries_finite());
    }

    /// Values are a vector space; NaN never hides.
    #[test]
    fn values_add_up(a in spectrum(), b in spectrum(), s in number(), i in 0usize..3) {
        prop_assert_eq!(a + Spectrum::ZERO, a);
        prop_assert!(near((a + b) - b, a, 20.0));
        prop_assert!(near((a + b).scale(s), a.scale(s) + b.scale(s), 200.0));
        let mut c = a;
        c += b;
        prop_assert_eq!(c, a + b);
        let mut bad = a;
        bad[i] = f64::NAN;
        prop_assert!(!bad.all_finite() && !Weight::entries_finite(&bad));
    }

    /// Shares add up to 1 for any densities, ties, zeros and ratios beyond 1e±300 among them; no technique gets a share of what it cannot sample.
    #[test]
    fn heuristics_share_everything_once(h in heuristics(), a in pairs(), b in pairs()) {
        let (first, second) = (h.share(a, b, Technique::First), h.share(b, a, Technique::Second));
        prop_assert!((0.0..=1.0).contains(&first) && (0.0..=1.0).contains(&second), "{first} {second}");
        if a > 0.0 || b > 0.0 {
            prop_assert!((first + second - 1.0).abs() < 1e-14, "{h:?} {a:e} {b:e}: {first} + {second}");
        }
        prop_assert_eq!(h.share(0.0, b, Technique::First), 0.0);
        prop_assert_eq!(h.share(0.0, b, Technique::Second), 0.0);
    }

    /// Sampling a table: inside its cell, of the stated density, monotone in u, no cell of weight 0, and ∫ pdf = 1.
    #[test]
    fn tables_sample_what_they_state(
        weights in prop::collection::vec(prop_oneof![0.0..1.0f64, Just(0.0), (-200.0..200.0f64).prop_map(|e| 10f64.powf(e))], 1..60),
        us in prop::collection::vec(0.0..1.0f64, 1..40),
    ) {
        let Some(table) = Table::new(&weights) else {
            prop_assert!(weights.iter().all(|w| *w == 0.0));
            return Ok(());
        };
        let n = weights.len();
        let mass: f64 = (0..n).map(|i| table.pdf((i as f64 + 0.5) / n as f64) / n as f64).sum();
        prop_assert!((mass - 1.0).abs() < 1e-12);
        prop_assert!((table.total() / weights.iter().sum::<f64>() - 1.0).abs() < 1e-12);
        let mut us: Vec<f64> = us.into_iter().map(|u| u.clamp(LEAST, MOST)).collect();
        us.extend([LEAST, MOST, f64::MIN_POSITIVE]);
        us.sort_by(f64::total_cmp);
        let mut before = 0.0;
        for u in us {
            let (x, pdf) = table.sample(u);
            prop_assert!((0.0..1.0).contains(&x), "{u}: {x}");
            prop_assert!(pdf > 0.0 && weights[((x * n as f64) as usize).min(n - 1)] > 0.0, "{u}: {x} has weight 0");
            prop_assert!((table.pdf(x) - pdf).abs() <= 1e-12 * pdf, "{u}: {x}");
            prop_assert!(x >= before);
            before = x;
        }
    }

    /// The distribution function of a table: a share of the uniforms below Σ w_i falls into the first cells.
    #[test]
    fn tables_invert_their_distribution(weights in prop::collection::vec(0.0..1.0f64, 2..30), i in 0usize..30) {
        let Some(table) = Table::new(&weights) else { return Ok(()) };
        let i = i % weights.len();
        let share: f64 = weights[..i].iter().sum::<f64>() / weights.iter().sum::<f64>();
        if share > 1e-6 && share < 1.0 - 1e-6 && weights[i] > 1e-3 && weights[i - 1] > 1e-3 {
            let edge = i as f64 / weights.len() as f64;
            prop_assert!(table.sample(share - 1e-9).0 < edge && table.sample(share + 1e-9).0 >= edge - 1e-12);
        }
    }

    /// Domains: the map lands inside, `coordinate` inverts it, `density` is 1/Jacobian, and random points never leave.
    #[test]
    fn domains_keep_their_maps(a in -100.0..100.0f64, length in 1e-3..1e3f64, t in 1e-9..MOST, group in 0usize..4, seed in any::<u64>()) {
        let interval = Interval::from(a..=a + length);
        let half = HalfLine::new(a).scale(length);
        let cube = Cuboid::<3>::from([a..=a + length, 0.0..=1.0, -length..=length]);
        let groups = Grouped::new(interval, 4);
        one_domain(&interval, 0, t, seed, 1e-9 * (1.0 + a.abs() / length))?;
        one_domain(&half, 0, t.min(0.999), seed, 1e-9 * (1.0 + a.abs() / length))?;
        one_domain(&cube, 0, t, seed, 1e-9 * (1.0 + a.abs() / length))?;
        one_domain(&groups, group, t, seed, 1e-9 * (1.0 + a.abs() / length))?;
    }

    /// Quadrature of the domain: exact for polynomials, total weight μ(Ω).
    #[test]
    fn rules_integrate(a in -5.0..5.0f64, length in 0.1..5.0f64, panels in 1usize..6, order in 1usize..9, degree in 0i32..16) {
        let interval = Interval::from(a..=a + length);
        let rule = interval.rule(panels, order);
        prop_assert!((rule.iter().map(|n| n.weight).sum::<f64>() / length - 1.0).abs() < 1e-13);
        if degree < 2 * order as i32 {
            let b = a + length;
            let exact = (b.powi(degree + 1) - a.powi(degree + 1)) / f64::from(degree + 1);
            let scale: f64 = rule.iter().map(|n| n.weight * n.point.abs().powi(degree)).sum();
            let sum: f64 = rule.iter().map(|n| n.weight * n.point.powi(degree)).sum();
            prop_assert!((sum - exact).abs() <= 1e-12 * (scale + exact.abs()), "{sum} {exact}");
        }
    }

    /// Merging moments is associative to rounding.
    #[test]
    fn merging_is_associative(scores in prop::collection::vec(-1e3..1e3f64, 3..200), i in 1usize..100, j in 1usize..100) {
        let (i, j) = (1 + i % (scores.len() - 2), 1 + j % (scores.len() - 2));
        let (i, j) = (i.min(j), i.max(j) + usize::from(i == j));
        let part = |r: std::ops::Range<usize>| Moments::from_scores(&scores[r]);
        let (mut left, mut right) = (part(0..i), part(i..j));
        left.merge(&part(i..j));
        left.merge(&part(j..scores.len()));
        right.merge(&part(j..scores.len()));
        let mut other = part(0..i);
        other.merge(&right);
        prop_assert_eq!(left.count, other.count);
        let scale = left.m2.max(1e-9);
        prop_assert!((left.mean - other.mean).abs() < 1e-12 * 1e3);
        prop_assert!((left.m2 - other.m2).abs() <= 1e-11 * scale);
        prop_assert!((left.m3 - other.m3).abs() <= 1e-10 * scale * 2e3);
        prop_assert!((left.m4 - other.m4).abs() <= 1e-10 * scale * 4e6);
    }

    /// Tabulated proposals of random kernels: normalised, positive everywhere, weight = 1/pdf, whatever the table saw; also at u → 0 and 1.
    #[test]
    fn tabulated_proposals_are_normalised(
        (c0, c1, cut) in (0.0..3.0f64, -3.0..3.0f64, 0.0..1.0f64),
        cells in 1usize..40,
        x in 0.0..=1.0f64,
        us in prop::collection::vec(0.0..1.0f64, 8),
    ) {
        let unit = Interval::from(0.0..=1.0);
        let kernel = kernel_fn(unit, move |x: &f64, y: &f64| if *y < cut { 0.0 } else { c0 + c1 * x * y });
        let table = Tabulated::new(&kernel, cells).unwrap();
        // the density is constant between the edges of cells, of quarters of octaves within 8 cells of x, and of their images behind the ends
        let h = 1.0 / cells as f64;
        let mut edges: Vec<f64> = (0..=cells).map(|i| i as f64 * h).collect();
        for level in 0..60 {
            for quarter in [1.0, 0.875, 0.75, 0.625] {
                let r = (8.0 * h).min(1.0) * quarter * 0.5f64.powi(level);
                edges.extend([x - r, x + r, r - x, 2.0 - x - r].into_iter().filter(|e| (0.0..=1.0).contains(e)));
            }
        }
        edges.push(x);
        edges.sort_by(f64::total_cmp);
        let middles = edges.windows(2).map(|e| (e[1] - e[0], 0.5 * (e[0] + e[1]))).filter(|m| m.0 > 0.0);
        let mut mass = 0.0;
        for (width, y) in middles {
            // the defensive share
            prop_assert!(table.pdf(&x, &y) >= 0.01 - 1e-12);
            mass += width * table.pdf(&x, &y);
        }
        prop_assert!((mass - 1.0).abs() < 1e-9, "{mass}");
        prop_assert!(table.mass(&x) > 0.0);
        for u in us.into_iter().map(|u| u.clamp(LEAST, MOST)).chain([LEAST, MOST]) {
            let n = table.sample(&x, &mut Fixed(u));
            prop_assert!(unit.contains(&n.point));
            prop_assert!((n.weight * table.pdf(&x, &n.point) - 1.0).abs() < 1e-12);
        }
    }

    /// The same for sources, on groups, with g = 0 almost everywhere.
    #[test]
    fn tabulated_sources_are_normalised(at in 0.0..1.0f64, group in 0usize..3, cells in 1usize..30, us in prop::collection::vec(0.0..1.0f64, 8)) {
        let domain = Grouped::new(Interval::from(0.0..=2.0), 3);
        let g = source_fn(domain, move |x: &(f64, usize)| if x.1 == group && (x.0 - 2.0 * at).abs() < 0.1 { 5.0 } else { 0.0 });
        let g = g.tabulated(cells).unwrap();
        let x = (0.3, 0);
        let rule = Interval::from(0.0..=2.0).rule(cells, 1);
        let mass: f64 = (0..3).flat_map(|s| rule.iter().map(move |n| (n, s))).map(|(n, s)| n.weight * g.pdf_for(&x, &(n.point, s))).sum();
        prop_assert!((mass - 1.0).abs() < 1e-12, "{mass}");
        for u in us.into_iter().map(|u| u.clamp(LEAST, MOST)).chain([LEAST, MOST]) {
            let n = g.sample_for(&x, &mut Fixed(u)).unwrap();
            prop_assert!(domain.contains(&n.point));
            prop_assert!((n.weight * g.pdf_for(&x, &n.point) - 1.0).abs() < 1e-12);
        }
    }

    /// Points of a sequence are pure functions of their address, strictly inside (0, 1), and differ with every part of it.
    #[test]
    fn points_are_pure(seed in any::<u64>(), cell in any::<u64>(), replicate in any::<u32>(), index in any::<u64>()) {
        let draw = |s: u64, c: u64, r: u32, i: u64| {
            let mut u = Pcg::new(s).point(c, r, i);
            std::array::from_fn::<f64, 4, _>(|_| u.next_1d())
        };
        let here = draw(seed, cell, replicate, index);
        prop_assert_eq!(here, draw(seed, cell, replicate, index));
        prop_assert!(here.iter().all(|u| *u > 0.0 && *u < 1.0));
        prop_assert_ne!(here, draw(seed ^ 1, cell, replicate, index));
        prop_assert_ne!(here, draw(seed, cell ^ 1, replicate, index));
        prop_assert_ne!(here, draw(seed, cell, replicate ^ 1, index));
        prop_assert_ne!(here, draw(seed, cell, replicate, index ^ 1));
    }
}

fn one_domain<D: Domain>(domain: &D, state: usize, t: f64, seed: u64, tolerance: f64) -> Result<(), TestCaseError> {
    prop_assert!(domain.validate().is_ok());
    let n = domain.place(state, || t);
    prop_assert!(domain.contains(&n.point), "{:?}", n.point);
    prop_assert_eq!(domain.state(&n.point), state);
    for axis in 0..domain.dimension() {
        prop_assert!((domain.coordinate(&n.point, axis) - t).abs() <= tolerance, "{:?} {t}", n.point);
    }
    let density = domain.density(&n.point) * n.weight * domain.states() as f64;
    prop_assert!((density - 1.0).abs() < 1e-6 + tolerance, "{density}");
    let mut u = Pcg::new(seed).point(0, 0, 0);
    for _ in 0..16 {
        let n = domain.sample(&mut u);
        prop_assert!(domain.contains(&n.point));
        prop_assert!((domain.density(&n.point) * n.weight - 1.0).abs() < 1e-6 + tolerance);
        prop_assert!((Uniform::on(domain.clone()).pdf(&n.point, &n.point) - domain.density(&n.point)).abs() < 1e-12);
    }
    for end in [LEAST, MOST] {
        let n = domain.sample(&mut Fixed(end));
        prop_assert!(domain.contains(&n.point), "{:?}", n.point);
    }
    Ok(())
}

#[test]
fn tables_refuse_what_is_no_density() {
    for bad in [&[][..], &[0.0], &[0.0, 0.0], &[-1.0, 2.0], &[f64::NAN, 1.0], &[f64::INFINITY, 1.0], &[f64::MAX, f64::MAX]] {
        assert!(Table::new(bad).is_none(), "{bad:?}");
    }
    let t = Table::new(&[0.0, 2.0, 0.0]).unwrap();
    assert_eq!((t.pdf(-0.1), t.pdf(1.1), t.pdf(0.5), t.pdf(f64::NAN)), (0.0, 0.0, 3.0, 0.0));
}

#[test]
fn gauss_rules_are_ascending_and_positive() {
    assert!(unit_rule(0).is_empty());
    for order in [1, 2, 7, 64, 200] {
        let r = unit_rule(order);
        assert_eq!(r.len(), order);
        assert!(r.windows(2).all(|w| w[0].point < w[1].point) && r.iter().all(|n| n.weight > 0.0 && n.point > 0.0 && n.point < 1.0));
        assert!((r.iter().map(|n| n.weight).sum::<f64>() - 1.0).abs() < 1e-13);
    }
}
