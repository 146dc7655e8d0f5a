//! Discrepancies in the square mean: closed formulas of n² d operations.
//!
//! ```text
//! (L2*)² = 3^{−d} − 2^{1−d}/n Σ_i ∏(1 − x²) + 1/n² Σ_ij ∏(1 − max(x, x'))                                     Warnock 1972
//! CD²    = (13/12)^d − 2/n Σ_i ∏(1 + ½|x−½| − ½|x−½|²) + 1/n² Σ_ij ∏(1 + ½|x−½| + ½|x'−½| − ½|x−x'|)           Hickernell 1998
//! WD²    = −(4/3)^d + 1/n² Σ_ij ∏(3/2 − |x−x'|(1 − |x−x'|))                                                     Hickernell 1998
//! ```
//!
//! The terms are of order 1: squares below 10⁻¹⁵ drown in their rounding. The programs of others often give the squares.

use super::PointSet;
use crate::parallel;

impl PointSet {
    /// The L2 star discrepancy: the local discrepancy in the square mean over all boxes at the origin.
    ///
    /// ```
    /// # use fredholm::sampling::PointSet;
    /// // ∫₀¹ (A(y) − y)² dy = 1/12 for the one point ½
    /// assert!((PointSet::new(&[[0.5]])?.l2_star() - (1f64 / 12.0).sqrt()).abs() < 1e-15);
    /// # Ok::<(), fredholm::Error>(())
    /// ```
    #[must_use]
    pub fn l2_star(&self) -> f64 {
        let d = self.dimension() as i32;
        self.square(3f64.powi(-d), 2f64.powi(1 - d), |x| 1.0 - x * x, |x, y| 1.0 - x.max(y))
    }

    /// The centred L2 discrepancy, which is the same for the set mirrored at any plane x_j = ½.
    #[must_use]
    pub fn centred_l2(&self) -> f64 {
        let single = |x: f64| 1.0 + 0.5 * (x - 0.5).abs() - 0.5 * (x - 0.5).powi(2);
        let pair = |x: f64, y: f64| 1.0 + 0.5 * ((x - 0.5).abs() + (y - 0.5).abs() - (x - y).abs());
        self.square((13f64 / 12.0).powi(self.dimension() as i32), 2.0, single, pair)
    }

    /// The wrap-around L2 discrepancy, which is the same for the set shifted on the torus.
    #[must_use]
    pub fn wrap_around_l2(&self) -> f64 {
        let pair = |x: f64, y: f64| 1.5 - (x - y).abs() * (1.0 - (x - y).abs());
        self.square(-(4f64 / 3.0).powi(self.dimension() as i32), 0.0, |_| 1.0, pair)
    }

    /// √(constant − factor/n Σ_i ∏ single + 1/n² Σ_ij ∏ pair).
    fn square(
        &self,
        constant: f64,
        factor: f64,
        single: impl Fn(f64) -> f64 + Send + Sync,
        pair: impl Fn(f64, f64) -> f64 + Send + Sync,
    ) -> f64 {
        let n = self.count();
        // pairs once: i < j counts twice
        let row = |i: usize| {
            let x = &self.coordinates[i * self.dimension..(i + 1) * self.dimension];
            let product = |y: &[f64]| x.iter().zip(y).map(|(x, y)| pair(*x, *y)).product::<f64>();
            let pairs = 2.0 * self.iter().skip(i + 1).map(product).sum::<f64>() + product(x);
            (x.iter().map(|x| single(*x)).product::<f64>(), pairs)
        };
        let (singles, pairs) = parallel::map(n, row).into_iter().fold((0.0, 0.0), |(s, p), (a, b)| (s + a, p + b));
        let n = n as f64;
        // the square of a number: negative by rounding at most
        (constant - factor * singles / n + pairs / (n * n)).max(0.0).sqrt()
    }
}
