//! A piecewise-constant density on [0, 1): sampling by inversion, its pdf beside it.

/// Tabulated density ∝ `weights` on equal cells of [0, 1).
///
/// Inversion with a guide table (Chen, Asau, *On generating random variates from an empirical distribution*, 1974): expected O(1) and
/// monotone in u, as quasi-Monte Carlo needs it. Cells of weight 0 are never chosen.
///
/// ```
/// use fredholm::sampling::Table;
/// let t = Table::new(&[1.0, 0.0, 3.0]).unwrap();
/// let (x, pdf) = t.sample(0.5);
/// assert!(x > 2.0 / 3.0 && pdf == t.pdf(x));
/// assert_eq!(t.pdf(0.5), 0.0);
/// ```
#[derive(Clone, Debug)]
pub struct Table {
    /// cumulative sums normalised to 1, length cells + 1
    cdf: Vec<f64>,
    /// densities with respect to the unit interval
    pdf: Vec<f64>,
    guide: Vec<u32>,
    total: f64,
}

impl Table {
    /// The table, or `None` if a weight is negative or not finite or all are zero.
    #[must_use]
    pub fn new(weights: &[f64]) -> Option<Self> {
        let total: f64 = weights.iter().sum();
        if !total.is_finite() || total <= 0.0 || weights.iter().any(|w| !(*w >= 0.0)) {
            return None;
        }
        let n = weights.len();
        let mut cdf = Vec::with_capacity(n + 1);
        let mut sum = 0.0;
        cdf.push(0.0);
        for w in weights {
            sum += w / total;
            // rounding may carry the sum past 1: the rest then has probability 0, not a negative one
            cdf.push(sum.min(1.0));
        }
        // rounding may leave the last sum off 1: from the last cell that a uniform can reach on, the value is exactly 1
        let last = (0..n).rposition(|i| cdf[i + 1] > cdf[i])?;
        cdf[last + 1..].fill(1.0);
        let mut guide = Vec::with_capacity(n);
        let mut k = 0;
        for i in 0..n {
            while cdf[k + 1] <= i as f64 / n as f64 {
                k += 1;
            }
            guide.push(k as u32);
        }
        // from the sums, not from the weights: the density of what is sampled, rounding included
        let pdf = cdf.windows(2).map(|c| (c[1] - c[0]) * n as f64).collect();
        Some(Table { cdf, pdf, guide, total })
    }

    /// The point of [0, 1) at which the distribution function is `u` ∈ (0, 1), and its density.
    #[inline]
    #[must_use]
    pub fn sample(&self, u: f64) -> (f64, f64) {
        let n = self.pdf.len();
        let mut k = self.guide[((u * n as f64) as usize).min(n - 1)] as usize;
        while self.cdf[k + 1] <= u {
            k += 1;
        }
        let t = (u - self.cdf[k]) / (self.cdf[k + 1] - self.cdf[k]);
        let x = (k as f64 + t.clamp(0.0, 1.0 - 2.0 * n as f64 * f64::EPSILON)) / n as f64;
        // k/n can round to a number whose cell is k − 1, perhaps one of weight 0
        (if ((x * n as f64) as usize) < k { x.next_up() } else { x }, self.pdf[k])
    }

    /// Density at `x` with respect to the unit interval; 0 outside.
    #[inline]
    #[must_use]
    pub fn pdf(&self, x: f64) -> f64 {
        if !(0.0..=1.0).contains(&x) {
            return 0.0;
        }
        let n = self.pdf.len();
        self.pdf[((x * n as f64) as usize).min(n - 1)]
    }

    /// Probability of cell `i`.
    ///
    /// ```
    /// # let t = fredholm::sampling::Table::new(&[1.0, 0.0, 3.0]).unwrap();
    /// assert_eq!(t.probability(2), 0.75);
    /// ```
    #[inline]
    #[must_use]
    pub fn probability(&self, i: usize) -> f64 {
        self.cdf[i + 1] - self.cdf[i]
    }

    /// The weights given, up to rounding.
    pub(crate) fn weights(&self) -> impl Iterator<Item = f64> {
        let total = self.total;
        self.pdf.iter().map(move |p| p * total / self.pdf.len() as f64)
    }

    /// Sum of the weights given.
    #[must_use]
    pub fn total(&self) -> f64 {
        self.total
    }
}
