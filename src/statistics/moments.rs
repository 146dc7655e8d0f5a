//! Central moments to the fourth order, computed in blocks and merged in order.
//!
//! Pébay, *Formulas for robust, one-pass parallel computation of covariances and arbitrary-order statistical moments*, SAND2008-6212,
//! eqs. (1.5)–(1.6), (2.1) and the fourth-order update (theory (6.1.10)).

use crate::value::Value;

/// Count, mean, and the sums M₂, M₃, M₄ of powers of deviations from the mean, per component; the extremes; how many scores were not zero.
///
/// ```
/// use fredholm::statistics::Moments;
/// let m = Moments::from_scores(&[1.0, 2.0, 3.0, 4.0]);
/// assert_eq!((m.count, m.mean), (4, 2.5));
/// assert_eq!(m.variance(), Some(5.0 / 3.0));
/// let mut halves = Moments::from_scores(&[1.0, 2.0]);
/// halves.merge(&Moments::from_scores(&[3.0, 4.0]));
/// assert_eq!(halves, m);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(bound = "V: Value"))]
pub struct Moments<V> {
    /// Number of scores.
    pub count: u64,
    /// Number of scores with a component different from 0.
    pub nonzero: u64,
    /// Mean.
    #[cfg_attr(feature = "serde", serde(with = "crate::value::stored"))]
    pub mean: V,
    /// Σ (y − ȳ)².
    #[cfg_attr(feature = "serde", serde(with = "crate::value::stored"))]
    pub m2: V,
    /// Σ (y − ȳ)³.
    #[cfg_attr(feature = "serde", serde(with = "crate::value::stored"))]
    pub m3: V,
    /// Σ (y − ȳ)⁴.
    #[cfg_attr(feature = "serde", serde(with = "crate::value::stored"))]
    pub m4: V,
}

/// Σ f(y), in eight interleaved partial sums of fixed order.
#[inline]
fn lanes<V: Value, const N: usize>(scores: &[V], zero: [V; N], f: impl Fn(V) -> [V; N]) -> [V; N] {
    let mut sums = [zero; 8];
    let (blocks, rest) = scores.as_chunks::<8>();
    for block in blocks {
        for (sum, y) in sums.iter_mut().zip(block) {
            let terms = f(*y);
            (0..N).for_each(|k| sum[k] += terms[k]);
        }
    }
    for (sum, y) in sums.iter_mut().zip(rest) {
        let terms = f(*y);
        (0..N).for_each(|k| sum[k] += terms[k]);
    }
    std::array::from_fn(|k| {
        let s = sums.map(|s| s[k]);
        ((s[0] + s[1]) + (s[2] + s[3])) + ((s[4] + s[5]) + (s[6] + s[7]))
    })
}

impl<V: Value> Default for Moments<V> {
    fn default() -> Self {
        Moments { count: 0, nonzero: 0, mean: V::ZERO, m2: V::ZERO, m3: V::ZERO, m4: V::ZERO }
    }
}

impl<V: Value> Moments<V> {
    /// Two passes over a block: exact to rounding, and vectorisable.
    #[must_use]
    pub fn from_scores(scores: &[V]) -> Self {
        if scores.is_empty() {
            return Self::default();
        }
        let n = scores.len() as f64;
        // eight independent sums: short dependency chains, vector instructions, and less rounding than one
        let mean = lanes(scores, [V::ZERO], |y| [y])[0].scale(1.0 / n);
        let [d1, m2, m3, m4] = lanes(scores, [V::ZERO; 4], |y| {
            let d = y - mean;
            let d2 = d.zip(d, |a, b| a * b);
            [d, d2, d2.zip(d, |a, b| a * b), d2.zip(d2, |a, b| a * b)]
        });
        let nonzero = scores.iter().map(|y| u64::from(y.magnitude() != 0.0)).sum();
        // the mean's own rounding leaves Σd ≠ 0: moments about mean + Σd/n instead (order two: Chan, Golub, LeVeque (1983), eq. (1.7))
        let shift = d1.scale(1.0 / n);
        let s = |i: usize| shift.component(i);
        let m4 = V::from_components(|i| {
            m4.component(i) + s(i) * (s(i) * (6.0 * m2.component(i) - 3.0 * n * s(i) * s(i)) - 4.0 * m3.component(i))
        });
        let m3 = V::from_components(|i| m3.component(i) + s(i) * (2.0 * n * s(i) * s(i) - 3.0 * m2.component(i)));
        let m2 = m2 - d1.zip(shift, |a, b| a * b);
        Moments { count: scores.len() as u64, nonzero, mean: mean + shift, m2, m3, m4 }
    }

    /// Joins the moments of a later block to those of the earlier ones.
    pub fn merge(&mut self, later: &Self) {
        if later.count == 0 {
            return;
        }
        if self.count == 0 {
            *self = *later;
            return;
        }
        let (na, nb) = (self.count as f64, later.count as f64);
        let n = na + nb;
        let combine = |i: usize| {
            let (a2, b2) = (self.m2.component(i), later.m2.component(i));
            let (a3, b3) = (self.m3.component(i), later.m3.component(i));
            let d = later.mean.component(i) - self.mean.component(i);
            let dn = d / n;
            let mean = self.mean.component(i) + nb * dn;
            let m2 = a2 + b2 + d * dn * na * nb;
            let m3 = a3 + b3 + d * dn * dn * na * nb * (na - nb) + 3.0 * dn * (na * b2 - nb * a2);
            let m4 = self.m4.component(i)
                + later.m4.component(i)
                + d * dn * dn * dn * na * nb * (na * na - na * nb + nb * nb)
                + 6.0 * dn * dn * (na * na * b2 + nb * nb * a2)
                + 4.0 * dn * (na * b3 - nb * a3);
            [mean, m2, m3, m4]
        };
        let part = |k: usize| V::from_components(|i| combine(i)[k]);
        *self = Moments {
            count: self.count + later.count,
            nonzero: self.nonzero + later.nonzero,
            mean: part(0),
            m2: part(1),
            m3: part(2),
            m4: part(3),
        };
    }

    /// The moments of the scores multiplied by `factor`.
    pub(crate) fn scaled(&self, factor: f64) -> Self {
        let [f2, f3, f4] = [2, 3, 4].map(|k| factor.powi(k));
        let nonzero = if factor == 0.0 { 0 } else { self.nonzero };
        let (m2, m3, m4) = (self.m2.scale(f2), self.m3.scale(f3), self.m4.scale(f4));
        Moments { count: self.count, nonzero, mean: self.mean.scale(factor), m2, m3, m4 }
    }

    /// The moments of component `i` alone. How many of its scores are not zero was not counted: `nonzero` is that of the whole, or 0 if all were.
    #[must_use]
    pub fn component(&self, i: usize) -> Moments<f64> {
        let (mean, m2) = (self.mean.component(i), self.m2.component(i));
        let nonzero = if mean == 0.0 && m2 == 0.0 { 0 } else { self.nonzero };
        Moments { count: self.count, nonzero, mean, m2, m3: self.m3.component(i), m4: self.m4.component(i) }
    }

    /// Unbiased sample variance M₂/(N−1); `None` below two scores.
    pub fn variance(&self) -> Option<V> {
        (self.count > 1).then(|| self.m2.map(|s| s.max(0.0) / (self.count - 1) as f64))
    }

    /// Standard error of the mean.
    pub fn std_error(&self) -> Option<V> {
        self.variance().map(|v| v.map(|v| (v / self.count as f64).sqrt()))
    }

    /// Skewness m₃/m₂^{3/2}; 0 for constant scores.
    pub fn skewness(&self) -> V {
        let n = self.count as f64;
        V::from_components(|i| {
            let m2 = self.m2.component(i) / n;
            if m2 > 0.0 { self.m3.component(i) / n / m2.powf(1.5) } else { 0.0 }
        })
    }

    /// Kurtosis m₄/m₂² (3 for a normal distribution); 0 for constant scores.
    pub fn kurtosis(&self) -> V {
        let n = self.count as f64;
        V::from_components(|i| {
            let m2 = self.m2.component(i) / n;
            if m2 > 0.0 { self.m4.component(i) / n / (m2 * m2) } else { 0.0 }
        })
    }

    /// Relative variance of the variance, Σd⁴/(Σd²)² − 1/N (theory (5.2.1)); 0 for constant scores.
    pub fn variance_of_variance(&self) -> V {
        let n = self.count as f64;
        V::from_components(|i| {
            let m2 = self.m2.component(i);
            if m2 > 0.0 { self.m4.component(i) / (m2 * m2) - 1.0 / n } else { 0.0 }
        })
    }
}
