//! The tabulated proposal is a density, samples it, and keeps K/p bounded on singular and peaked diagonals.

use crate::erased::{Equation, kernel_fn};
use fredholm::domain::{Domain, Grouped, HalfLine, Interval};
use fredholm::kernel::{HasDomain, Kernel, KernelFn, Proposal, Tabulated};
use fredholm::sampling::{Pcg, Sequence};

/// ∫ φ(y) dμ(y) by panels graded towards x and the ends in the coordinate, for every state.
fn integral<D: Domain>(domain: &D, t: f64, phi: impl Fn(&D::Point) -> f64) -> f64 {
    let rule = fredholm::deterministic::quadrature::unit_rule(4);
    let mut breaks: Vec<f64> = (0..=4096).map(|i| f64::from(i) / 4096.0).collect();
    breaks.extend((8..52).flat_map(|k| (0..32).map(move |m| (1.0 + f64::from(m) / 32.0) * 0.5f64.powi(k))).flat_map(|r| [t - r, t + r]));
    breaks.push(t);
    breaks.retain(|b| (0.0..=1.0).contains(b));
    breaks.sort_by(f64::total_cmp);
    let mut sum = 0.0;
    for state in 0..domain.states() {
        for e in breaks.windows(2).filter(|e| e[1] > e[0]) {
            for n in &rule {
                let y = domain.place(state, || e[0] + n.point * (e[1] - e[0]));
                sum += n.weight * (e[1] - e[0]) * y.weight * phi(&y.point);
            }
        }
    }
    sum
}

/// p(x, ·) integrates to 1, its samples carry 1/p, and their shares of ten parts of the domain are those of p.
fn is_a_density<D, F>(kernel: &KernelFn<D, F, f64>, cells: usize)
where
    D: Domain,
    F: Fn(&D::Point, &D::Point) -> f64 + Send + Sync,
{
    let domain = kernel.domain().clone();
    let plain = Tabulated::new(kernel, cells).unwrap();
    for table in [plain.clone(), plain.guided()] {
        for (i, t) in [0.003, 0.21, 0.5, 0.74, 0.998].into_iter().enumerate() {
            let x = domain.place(i % domain.states(), || t).point;
            let total = integral(&domain, t, |y| table.pdf(&x, y));
            assert!((total - 1.0).abs() < 2e-3, "{kernel:?} at {x:?}: ∫ p = {total}");
            let mut counts = [0.0; 10];
            let n = 20_000;
            for i in 0..n {
                let y = table.sample(&x, &mut Pcg::default().point(0, 0, i));
                assert_eq!(y.weight, 1.0 / table.pdf(&x, &y.point));
                assert!(domain.contains(&y.point) && y.point != x);
                counts[((domain.coordinate(&y.point, 0) * 10.0) as usize).min(9)] += 1.0 / n as f64;
            }
            for (part, share) in counts.into_iter().enumerate() {
                let here = |y: &D::Point| ((domain.coordinate(y, 0) * 10.0) as usize).min(9) == part;
                let p = integral(&domain, t, |y| if here(y) { table.pdf(&x, y) } else { 0.0 });
                let sigma = (p * (1.0 - p) / n as f64).sqrt();
                assert!((share - p).abs() < 5.5 * sigma + 2e-3, "{kernel:?} at {x:?}, part {part}: {share} ≠ {p}");
            }
        }
    }
}

#[test]
fn tables_are_densities() {
    let unit = Interval::from(0.0..=1.0);
    is_a_density(&kernel_fn(unit, |x: &f64, y: &f64| 0.2 / (x - y).abs().sqrt()), 32);
    is_a_density(&kernel_fn(unit, |x: &f64, y: &f64| 1e-4 / (1e-8 + (x - y) * (x - y))), 32);
    is_a_density(&kernel_fn(unit, |x: &f64, y: &f64| if x > y { 1.0 } else { 0.0 }), 16);
    is_a_density(&kernel_fn(unit, |x: &f64, y: &f64| x * y), 4);
    is_a_density(&kernel_fn(unit, |x: &f64, y: &f64| (x - y).abs()), 1);
    is_a_density(&kernel_fn(Interval::from(-3.0..=7.0), |x: &f64, y: &f64| (20.0 * (x - y)).cos()), 64);
    is_a_density(&kernel_fn(HalfLine::new(0.0), |x: &f64, y: &f64| (-(x - y).abs()).exp()), 32);
    let system = Grouped::new(Interval::from(0.0..=2.0), 3);
    is_a_density(&kernel_fn(system, |x: &(f64, usize), y: &(f64, usize)| ((x.1 + 2 * y.1) as f64) / (0.01 + (x.0 - y.0).abs())), 16);
}

/// Largest K/p over many samples, in units of the row mass.
fn largest_weight<F: Fn(&f64, &f64) -> f64 + Send + Sync>(kernel: F) -> f64 {
    let kernel = kernel_fn(Interval::from(0.0..=1.0), kernel);
    let table = Tabulated::new(&kernel, 64).unwrap();
    let at = |x: f64| {
        let one = |i| {
            let y = table.sample(&x, &mut Pcg::default().point(1, 0, i));
            kernel.eval(&x, &y.point) * y.weight / table.mass(&x)
        };
        (0..50_000).map(one).fold(0.0, f64::max)
    };
    [0.01, 0.377, 0.5, 0.803].into_iter().map(at).fold(0.0, f64::max)
}

#[test]
fn weights_stay_bounded_on_the_diagonal() {
    assert!(largest_weight(|x, y| (x - y).abs().powf(-0.5)) < 3.0);
    // a few samples fall into the innermost shell, where floating-point numbers leave eight distances
    assert!(largest_weight(|x, y| (x - y).abs().powf(-0.7)) < 12.0);
    assert!(largest_weight(|x, y| -(x - y).abs().ln()) < 3.0);
    assert!(largest_weight(|x, y| 1e-5 / (1e-10 + (x - y) * (x - y))) < 3.0);
    assert!(largest_weight(|x, y| (-0.5 * ((x - y) / 1e-3).powi(2)).exp()) < 3.0);
}

/// Where K ends between the places that the table asked for, walks still come: else a part of it is met by one walk in a million, with a weight of 10⁴.
#[test]
fn weights_stay_bounded_where_the_kernel_ends() {
    let largest = |kernel: fn(&f64, &f64) -> f64| {
        let kernel = kernel_fn(Interval::from(0.0..=1.0), kernel);
        let table = Tabulated::new(&kernel, 64).unwrap();
        let over = |x: f64| (1..20_000).map(move |i| (x, f64::from(i) / 20_000.0)).filter(|(x, y)| x != y);
        let weight = |(x, y): (f64, f64)| kernel.eval(&x, &y) / (table.pdf(&x, &y) * table.mass(&x));
        (0..200).flat_map(|i| over((f64::from(i) + 0.37) / 200.0)).map(weight).fold(0.0, f64::max)
    };
    // where only a hundredth of the density of the domain leads it would be 5·10⁴ and 10⁴
    let band = largest(|x, y| f64::from(u8::from((x - y).abs() < 1e-3)));
    let window = largest(|_, y| f64::from(u8::from((0.501..0.511).contains(y))));
    let across = largest(|_, y| f64::from(u8::from((0.499..0.509).contains(y))));
    assert!(band < 40.0 && window < 40.0 && across < 40.0, "{band} {window} {across}");
}

/// 1.6·10⁻³ of the mass of |x − y|^−0.8 lies closer to y = x than the spacing of numbers there: walks would be wrong by that, unseen.
#[test]
fn singularities_below_rounding_are_refused() {
    let kernel = kernel_fn(Interval::from(0.0..=1.0), |x: &f64, y: &f64| (x - y).abs().powf(-0.8));
    assert!(matches!(Tabulated::new(&kernel, 64), Err(fredholm::Error::BelowRounding { share, .. }) if share > 1e-4));
}

#[test]
fn guided_tables_keep_the_variance_finite_where_row_masses_vary() {
    // K = λ min(x, y): ρ(|K|) = 4λ/π² = 0.97, but M(x) rises to λ/2 = 1.2
    let eq = || Equation::on_interval(0.0..=1.0, |_| 1.0, |x: f64, y: f64| 2.4 * x.min(y));
    let k = 2.4f64.sqrt();
    let truth = (k * 0.5).cos() + k.tan() * (k * 0.5).sin();
    let walk = fredholm::Walk::collision().samples_per_cell(1 << 14);
    let plain = eq().tabulated(64).unwrap().at(0.5).solve(&walk).unwrap();
    let guided = eq();
    let table = Tabulated::new(guided.kernel().kernel(), 64).unwrap().guided();
    let guided = guided.with_proposal(table).at(0.5).solve(&walk).unwrap();
    assert!(guided.agrees_with(truth, 5.5), "{guided} ≠ {truth}");
    assert!(guided.std_error < plain.std_error, "{guided} is no better than {plain}");
}
