//! The coarse spectral radius of |T| that decides whether walks may start: ρ(|T|) of stored references and closed forms lies within the stated
//! uncertainty, and the refusals it implies are right.

use crate::erased::Equation;
use crate::reference::{number, record};
use fredholm::domain::{Cuboid, Grouped, HalfLine, Interval};
use fredholm::kernel::{Operator, Radius, Series};
use fredholm::special::e1;
use fredholm::{GroupMatrix, Spectrum};
use std::f64::consts::PI;
use std::sync::Arc;

fn radius(kernel: &impl Operator) -> Radius {
    match kernel.series().unwrap() {
        Series::Known(s) => s.radius(),
        Series::Unknown => panic!("the kernel can be evaluated on a domain"),
    }
}

/// ρ lies within the stated uncertainty, which is below `sharp`.
fn covers(name: &str, kernel: &impl Operator, known: f64, sharp: f64) {
    let r = radius(kernel);
    assert!((r.value - known).abs() <= r.uncertainty, "{name}: {} ± {:.1e} is not {known}", r.value, r.uncertainty);
    assert!(r.uncertainty <= sharp * known.max(1e-3), "{name}: {} ± {:.1e} says too little", r.value, r.uncertainty);
    if (known - 1.0).abs() > 2.0 * r.uncertainty {
        assert_eq!(r.diverges(), known >= 1.0, "{name}");
    }
}

fn stored(name: &str) -> f64 {
    number(&record(name)["spectral_radius"])
}

macro_rules! on_interval {
    ($name:expr, $a:expr, $b:expr, $sharp:expr, $k:expr) => {
        erased($name, $a..=$b, $sharp, Arc::new($k))
    };
}

/// One instantiation for all kernels.
fn erased(name: &str, interval: std::ops::RangeInclusive<f64>, sharp: f64, k: Arc<dyn Fn(f64, f64) -> f64 + Send + Sync>) {
    covers(name, Equation::on_interval(interval, |_| 1.0, move |x, y| k(x, y)).kernel(), stored(name), sharp);
}

#[test]
fn close_to_one_on_both_sides() {
    for (name, l) in [("res0.99", 0.99), ("res0.9999", 0.9999), ("res1.001", 1.001)] {
        on_interval!(&format!("green-bridge-{name}"), 0.0, 1.0, 2e-6, move |x: f64, y: f64| l * PI * PI * (x.min(y) - x * y));
    }
    on_interval!("green-min-res0.999", 0.0, 1.0, 1e-6, |x: f64, y: f64| 0.999 * PI * PI / 4.0 * x.min(y));
    for (name, l) in [("0.99", 1.144718), ("0.999", 1.155125), ("0.9999", 1.156165)] {
        on_interval!(&format!("gaussian-nearcritical-{name}"), 0.0, 1.0, 1e-6, move |x: f64, y: f64| l * (-(x - y) * (x - y)).exp());
    }
    on_interval!("slab-c1-a100-uniform", 0.0, 100.0, 1e-3, |x: f64, y: f64| e1((x - y).abs()) / 2.0);
    on_interval!("slab-c0.999-a10-uniform", 0.0, 10.0, 1e-4, |x: f64, y: f64| 0.999 / 2.0 * e1((x - y).abs()));
    on_interval!("love-plus-d0.01", -1.0, 1.0, 1e-3, |x: f64, y: f64| 0.01 / PI / (1e-4 + (x - y) * (x - y)));
    on_interval!("love-plus-d0.1", -1.0, 1.0, 1e-4, |x: f64, y: f64| 0.1 / PI / (0.01 + (x - y) * (x - y)));
}

#[test]
fn of_every_kind_of_kernel() {
    on_interval!("expxy-g1-lam1.5", 0.0, 1.0, 1e-6, |x: f64, y: f64| 1.5 * (x * y).exp());
    on_interval!("green-max-lam-2", 0.0, 1.0, 1e-6, |x: f64, y: f64| -2.0 * x.max(y));
    on_interval!("expkernel-lam3-b1", 0.0, 1.0, 1e-6, |x: f64, y: f64| 3.0 * (-(x - y).abs()).exp());
    on_interval!("abel-1over2-g1-lam-0.5", 0.0, 1.0, 1e-4, |x: f64, y: f64| -0.5 / (x - y).abs().sqrt());
    on_interval!("abel-1over3-g1-lam0.3", 0.0, 1.0, 1e-5, |x: f64, y: f64| 0.3 * (x - y).abs().powf(-1.0 / 3.0));
    on_interval!("log-g1-lam-0.5", 0.0, 1.0, 1e-5, |x: f64, y: f64| -0.5 * (x - y).abs().ln());
    on_interval!("cauchy-peaked-d1e-4-manufactured", 0.0, 1.0, 1e-4, |x: f64, y: f64| 0.9 * 1e-4 / PI / (1e-8 + (x - y) * (x - y)));
    on_interval!("twolayer-c0.5-c0.95", 0.0, 3.0, 1e-2, |x: f64, y: f64| if x > 1.0 { 0.475 } else { 0.25 } * e1((x - y).abs()));
    on_interval!("slab-c0.9-a1-uniform", 0.0, 1.0, 1e-5, |x: f64, y: f64| 0.45 * e1((x - y).abs()));
    // signs count for T, not for |T|: |cos(x − y)| on [0, π] has row mass 2 everywhere
    let turning = Equation::on_interval(0.0..=PI, |_| 1.0, |x: f64, y: f64| 0.3 * (x - y).cos());
    covers("|cos|", turning.kernel(), 0.6, 1e-2);
    let line = |l: f64| Equation::on_domain(HalfLine::new(0.0), |_| 1.0, move |x: &f64, y: &f64| l * (-(x - y).abs()).exp());
    for l in [0.3, 0.45, -0.8] {
        // continuous spectrum: the radius is the norm 2|λ|, which no finite section reaches
        let r = radius(line(l).kernel());
        assert!((r.value - 2.0 * l.abs()).abs() < 1e-5 && r.diverges() == (l < -0.5), "{r:?}");
    }
}

#[test]
fn volterra_kernels_never_diverge() {
    for l in [1.0, -6.0, 60.0, 1000.0] {
        let r = radius(Equation::on_interval(0.0..=1.0, |_| 1.0, move |x, y| if x > y { l } else { 0.0 }).kernel());
        assert!(!r.diverges() && r.uncertainty >= r.value, "{l}: {r:?}");
    }
    let ramp = radius(Equation::on_interval(0.0..=1.0, |_| 1.0, |x: f64, y: f64| 4.0 * (x - y).max(0.0)).kernel());
    assert!(ramp.value < 1e-2 && !ramp.diverges());
}

#[test]
fn of_systems() {
    let (s, total) = ([[0.4, 0.0, 0.0, 0.0], [0.3, 0.6, 0.0, 0.1], [0.2, 0.5, 1.2, 0.3], [0.0, 0.2, 0.6, 3.2]], [1.0, 1.5, 2.0, 4.0]);
    let slab = Interval::from(0.0..=2.0);
    let groups = Equation::on_domain(Grouped::new(slab, 4), |_| 1.0, move |x, y| s[x.1][y.1] / 2.0 * e1(total[y.1] * (x.0 - y.0).abs()));
    let matrix = Equation::on_domain(
        slab,
        |_| Spectrum([1.0; 4]),
        move |x: &f64, y: &f64| GroupMatrix(std::array::from_fn(|i| std::array::from_fn(|j| s[i][j] / 2.0 * e1(total[j] * (x - y).abs())))),
    );
    covers("fourgroup-slab", groups.kernel(), stored("fourgroup-slab"), 2e-3);
    covers("fourgroup-slab as matrices", matrix.kernel(), stored("fourgroup-slab"), 2e-3);
}

/// K = λ Π k(x_i, y_i); the radii of products are products.
fn product<const D: usize>(name: &str, l: f64, k: fn(f64, f64) -> f64, sharp: f64) {
    let eq = Equation::on_domain(
        Cuboid::<D>::unit(),
        |_| 1.0,
        move |x: &[f64; D], y: &[f64; D]| l * x.iter().zip(y).map(|(x, y)| k(*x, *y)).sum::<f64>().exp(),
    );
    covers(name, eq.kernel(), stored(name), sharp);
}

#[test]
fn in_many_dimensions() {
    let (gauss, separable): (fn(f64, f64) -> f64, fn(f64, f64) -> f64) = (|x, y| -(x - y) * (x - y), |x, y| x * y);
    product::<2>("square-separable-exp-manufactured", 0.3, separable, 1e-6);
    product::<3>("cube3-gaussian", 1.2, gauss, 1e-3);
    product::<5>("highd-5-gaussian-g1", 1.5, gauss, 0.1);
    product::<5>("highd-5-separable-manufactured", 0.1, separable, 0.2);
    product::<10>("highd-10-gaussian-g1", 3.0, gauss, 0.1);
    product::<10>("highd-10-separable-manufactured", 0.03, separable, 0.5);
    product::<20>("highd-20-gaussian-g1", 12.0, gauss, 0.1);
    product::<20>("highd-20-separable-manufactured", 0.0015, separable, 0.5);
}
