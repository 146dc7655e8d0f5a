//! The budget of false alarms, and the tests that draw on it (theory §5.3 T1, T2).
//!
//! The whole suite may cry wolf with probability 10⁻⁶. That level is split by Šidák over every statistical assertion *registered* here; a test
//! cannot choose its own level, only ask for its share by name, and must make exactly as many assertions as are registered for it.
//!
//! A test may not pass by being noisy: each test of a mean declares a margin δ and fails if a bias of δ could have escaped it, that is, if its
//! minimum detectable bias (z_α + z_β)·SE exceeds δ (power 1 − β = 0.99).

#![allow(dead_code, unreachable_pub, reason = "each test file uses its part")]

use statrs::distribution::{Binomial, ChiSquared, ContinuousCDF, DiscreteCDF, Normal, StudentsT};
use std::path::PathBuf;

/// Probability that the suite fails although every estimator is right.
pub const SUITE: f64 = 1e-6;

/// Statistical assertions, by test. The level of each is that of the sum.
const REGISTERED: &[(&str, u32)] = &[
    ("zoo::line", 550),
    ("zoo::subcritical", 56),
    ("zoo::matrix", 24),
    ("zoo::grouped", 18),
    ("zoo::cube", 16),
    ("zoo::functionals", 15),
    ("zoo::near-critical", 2),
    ("statistics::coverage", 12),
    ("statistics::stopping", 3),
    ("statistics::p-values", 6),
    ("errata::mutants", 15),
    ("errata::chains", 20),
    ("sampling::uniform", 28),
    ("sampling::pairs", 20),
    ("sampling::independent", 21),
    ("sampling::walks", 42),
    ("sampling::lines", 11),
    ("sampling::planes", 12),
    ("sampling::indices", 2),
    ("sampling::coverage", 14),
    ("sampling::slopes", 8),
    ("sampling::rooks", 1),
    ("integral::lectures", 6),
    ("integral::square", 2),
    ("integral::ties", 1),
    ("integral::blind", 4),
    ("integral::distributions", 2),
    ("integral::control", 3),
    ("integral::domains", 7),
    ("integral::study", 2),
    ("integral::variances", 36),
    ("integral::optimal", 2),
    ("integral::neyman", 2),
    ("integral::slopes", 3),
    ("integral::coverage", 5),
    ("integral::sequences", 48),
    ("integral::rooks", 4),
    ("integral::net slopes", 7),
    ("integral::disk", 4),
    ("integral::array slopes", 4),
    ("integral::replicates", 6),
    ("integral::array", 20),
    ("integral::array coverage", 2),
    ("integral::array plain", 1),
    ("bidirectional::combination", 4),
    ("bidirectional::debias", 8),
    ("bidirectional::metropolis", 16),
    ("bidirectional::metropolis coverage", 3),
    ("bidirectional::forward", 8),
    ("bidirectional::strategies", 30),
    ("bidirectional::variances", 14),
    ("bidirectional::predicted", 6),
    ("bidirectional::optimal", 12),
    ("bidirectional::lines", 88),
    ("bidirectional::squares", 9),
    ("bidirectional::systems", 18),
    ("bidirectional::mirrors", 18),
    ("bidirectional::shared", 32),
    ("bidirectional::zoo", 40),
    ("bidirectional::matrix", 4),
    ("forward::line", 256),
    ("forward::leakage", 4),
    ("forward::bins", 5),
    ("forward::matrices", 8),
    ("forward::complex", 2),
    ("forward::cut", 2),
    ("forward::variance", 2),
    ("forward::cube", 1),
    ("forward::systems", 2),
    ("forward::adjoint", 2),
    ("forward::bands", 4),
    ("forward::bumps", 3),
    ("forward::points", 20),
    ("forward::slab", 3),
    ("forward::smoothing", 6),
    ("forward::smoothing rate", 5),
    ("forward::expansion", 4),
    ("scene::materials", 16),
    ("scene::furnaces", 132),
    ("scene::furnaces white", 12),
    ("scene::enclosures", 20),
    ("scene::spheres", 8),
    ("scene::radiosity room", 2),
    ("scene::furnaces photons", 3),
    ("scene::furnaces chains", 4),
    ("scene::exact", 15),
    ("scene::cornell", 5),
    ("scene::hard", 10),
    ("scene::agreement", 28),
    ("scene::radiosity", 3),
    ("scene::directions furnace", 10),
    ("scene::directions strategies", 12),
    ("scene::directions images", 86),
    ("scene::directions metropolis", 4),
    ("scene::directions caustic", 1),
    ("scene::optimal", 1),
];

/// The share of one test.
pub struct Budget {
    name: &'static str,
    left: u32,
    level: f64,
}

impl Budget {
    /// The share registered under `name`.
    pub fn of(name: &'static str) -> Self {
        let left = REGISTERED.iter().find(|r| r.0 == name).unwrap_or_else(|| panic!("{name} is not registered")).1;
        let total: u32 = REGISTERED.iter().map(|r| r.1).sum();
        // 1 − (1 − α)^{1/n} without cancellation
        let level = -((-SUITE).ln_1p() / f64::from(total)).exp_m1();
        Budget { name, left, level }
    }

    /// Level of one assertion.
    pub fn level(&self) -> f64 {
        self.level
    }

    fn spend(&mut self) -> f64 {
        assert!(self.left > 0, "{}: more statistical assertions than registered", self.name);
        self.left -= 1;
        self.level
    }

    /// (z_α + z_β): a bias of so many standard errors is seen with probability 0.99.
    pub fn detectable(&self) -> f64 {
        Normal::standard().inverse_cdf(1.0 - self.level / 2.0) + Normal::standard().inverse_cdf(0.99)
    }

    /// Student's test of `mean ± error` against `truth`, with its duty to be able to see a bias of `margin`.
    pub fn mean(&mut self, what: &str, (mean, error, freedom): (f64, f64, f64), truth: f64, margin: f64) -> Result<(), String> {
        let level = self.spend();
        let seen = self.detectable() * error;
        if !(seen <= margin) {
            return Err(format!(
                "{what}: noisy: a bias of {margin:.2e} could hide, {seen:.2e} would be seen (mean {mean}, error {error:.2e})"
            ));
        }
        let rounding = 1e-12 * truth.abs().max(mean.abs());
        let difference = ((mean - truth).abs() - rounding).max(0.0);
        let p = if difference == 0.0 { 1.0 } else { student(difference / error, freedom) };
        if p < level {
            return Err(format!("{what}: biased: {mean} ± {error:.2e} against {truth} (z = {:.2}, p = {p:.1e})", (mean - truth) / error));
        }
        Ok(())
    }

    /// One-sided: is the truth at most `bound`? What is measured below it is no deviation.
    pub fn at_most(&mut self, what: &str, (value, error, freedom): (f64, f64, f64), bound: f64, margin: f64) -> Result<(), String> {
        self.mean(what, (value.max(bound), error, freedom), bound, margin)
    }

    /// Whether `hits` of `trials` are compatible with a probability in [`low`, `high`] (exact binomial).
    pub fn frequency(&mut self, what: &str, hits: u64, trials: u64, low: f64, high: f64) -> Result<(), String> {
        let level = self.spend();
        let below = Binomial::new(low, trials).unwrap().cdf(hits);
        let above = if hits == 0 { 1.0 } else { Binomial::new(high, trials).unwrap().sf(hits - 1) };
        if below.min(above) < level / 2.0 {
            return Err(format!("{what}: {hits} of {trials} = {:.5} is not in [{low}, {high}]", hits as f64 / trials as f64));
        }
        Ok(())
    }

    /// Kolmogorov–Smirnov: are the numbers uniform on [0, 1]?
    pub fn uniform(&mut self, what: &str, p: &[f64]) -> Result<(), String> {
        let level = self.spend();
        let (d, q) = kolmogorov(p);
        if q < level { Err(format!("{what}: not uniform: D = {d:.4} of {} values, p = {q:.1e}", p.len())) } else { Ok(()) }
    }

    /// Pearson's test, cells pooled to an expectation of at least 10.
    pub fn counts(&mut self, what: &str, observed: &[u64], expected: &[f64]) -> Result<(), String> {
        let level = self.spend();
        let (mut pools, mut o, mut e) = (Vec::new(), 0.0, 0.0);
        for (a, b) in observed.iter().zip(expected) {
            o += *a as f64;
            e += b;
            if e >= 10.0 {
                pools.push((o, e));
                (o, e) = (0.0, 0.0);
            }
        }
        if let Some(last) = pools.last_mut() {
            last.0 += o;
            last.1 += e;
        }
        let chi: f64 = pools.iter().map(|(o, e)| (o - e) * (o - e) / e).sum();
        let p = ChiSquared::new((pools.len() - 1) as f64).unwrap().sf(chi);
        if p < level { Err(format!("{what}: χ² = {chi:.1} in {} cells, p = {p:.1e}", pools.len())) } else { Ok(()) }
    }
}

impl Drop for Budget {
    fn drop(&mut self) {
        if !std::thread::panicking() {
            assert_eq!(self.left, 0, "{}: {} registered assertions were not made", self.name, self.left);
        }
    }
}

/// Fails with all messages at once.
pub fn all_pass(results: impl IntoIterator<Item = Result<(), String>>) {
    let failures: Vec<String> = results.into_iter().filter_map(Result::err).collect();
    assert!(failures.is_empty(), "{} failed:\n{}", failures.len(), failures.join("\n"));
}

/// The slope of ln(root mean square) against ln n and its standard error, from the errors of independent repetitions at every n: Var ln rms = (κ − 1)/4R,
/// κ the kurtosis of the errors.
pub fn slope(sizes: &[(f64, Vec<f64>)]) -> (f64, f64, f64) {
    let mean = sizes.iter().map(|s| s.0.ln()).sum::<f64>() / sizes.len() as f64;
    let spread: f64 = sizes.iter().map(|s| (s.0.ln() - mean).powi(2)).sum();
    let (mut slope, mut variance) = (0.0, 0.0);
    for (n, errors) in sizes {
        let moment = |k: i32| errors.iter().map(|e| e.powi(k)).sum::<f64>() / errors.len() as f64;
        let leverage = (n.ln() - mean) / spread;
        slope += leverage * 0.5 * moment(2).ln();
        // a kurtosis of few repetitions is too small rather than too large: at least the normal one
        let kurtosis = (moment(4) / moment(2).powi(2)).max(3.0);
        variance += leverage * leverage * (kurtosis - 1.0) / (4.0 * errors.len() as f64);
    }
    (slope, variance.sqrt(), 1e6)
}

/// P(|t| ≥ `t`).
pub fn student(t: f64, freedom: f64) -> f64 {
    2.0 * StudentsT::new(0.0, 1.0, freedom).unwrap().cdf(-t.abs())
}

/// Kolmogorov's D against the uniform distribution, and its p-value (Stephens' finite-n argument in the asymptotic series).
pub fn kolmogorov(values: &[f64]) -> (f64, f64) {
    let mut v = values.to_vec();
    v.sort_by(f64::total_cmp);
    let n = v.len() as f64;
    let d = v.iter().enumerate().map(|(i, x)| (x - i as f64 / n).max((i + 1) as f64 / n - x)).fold(0.0, f64::max);
    let l = (n.sqrt() + 0.12 + 0.11 / n.sqrt()) * d;
    let series = |k: i32| 2.0 * if k % 2 == 1 { 1.0 } else { -1.0 } * (-2.0 * f64::from(k * k) * l * l).exp();
    (d, if l < 0.2 { 1.0 } else { (1..100).map(series).sum::<f64>().clamp(0.0, 1.0) })
}

/// A stored reference problem: numbers with as many digits as doubles hold.
pub struct Reference(serde_json::Value);

impl Reference {
    /// `tests/data/reference/NAME.json`.
    pub fn load(name: &str) -> Self {
        let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/data/reference").join(format!("{name}.json"));
        let text = std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
        Reference(serde_json::from_str(&text).unwrap_or_else(|e| panic!("{name}: {e}")))
    }

    /// A parameter that is a number.
    pub fn parameter(&self, name: &str) -> f64 {
        number(&self.0["parameters"][name])
    }

    /// Spectral radius of T.
    pub fn radius(&self) -> f64 {
        number(&self.0["spectral_radius"])
    }

    /// Points with one coordinate and scalar values.
    pub fn scalar(&self) -> Vec<(f64, f64)> {
        self.points().iter().zip(self.values()).map(|(x, v)| (number(x), number(v))).collect()
    }

    /// Points with one coordinate and vector values.
    pub fn vector(&self) -> Vec<(f64, Vec<f64>)> {
        let list = |v: &serde_json::Value| v.as_array().unwrap().iter().map(number).collect();
        self.points().iter().zip(self.values()).map(|(x, v)| (number(x), list(v))).collect()
    }

    /// Scalar values, whatever their points.
    pub fn numbers(&self) -> Vec<f64> {
        self.values().iter().map(number).collect()
    }

    /// Points with several coordinates and scalar values.
    pub fn spatial(&self) -> Vec<(Vec<f64>, f64)> {
        let list = |v: &serde_json::Value| v.as_array().unwrap().iter().map(number).collect();
        self.points().iter().zip(self.values()).map(|(x, v)| (list(x), number(v))).collect()
    }

    /// The functional whose `h` is written so.
    pub fn functional(&self, h: &str) -> f64 {
        let list = self.0["functionals"].as_array().unwrap();
        number(&list.iter().find(|f| f["h"] == h).unwrap_or_else(|| panic!("no functional {h}"))["value"])
    }

    /// Whether there is one.
    pub fn has_functional(&self, h: &str) -> bool {
        self.0["functionals"].as_array().is_some_and(|list| list.iter().any(|f| f["h"] == h))
    }

    fn points(&self) -> &Vec<serde_json::Value> {
        self.0["points"].as_array().unwrap()
    }

    fn values(&self) -> &Vec<serde_json::Value> {
        self.0["values"].as_array().unwrap()
    }
}

fn number(v: &serde_json::Value) -> f64 {
    let text = v.as_str().map_or_else(|| v.to_string(), str::to_string);
    text.parse().unwrap_or_else(|_| panic!("{text} is not a number"))
}
