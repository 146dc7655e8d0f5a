//! Indices with given weights.

use super::{Distribution, bin, cumulative};
use crate::error::Error;

/// Index i with probability ∝ `weights[i]`, by bisection of the cumulative sums: monotone in u, and what is left of u can be used again.
///
/// ```
/// use fredholm::sampling::distribution::{Discrete, Distribution};
/// let d = Discrete::new(&[1.0, 0.0, 3.0])?;
/// assert_eq!((d.sample(0.2), d.sample(0.9), d.pdf(&2), d.pdf(&7)), (0, 2, 0.75, 0.0));
/// assert_eq!(d.split(0.625), (2, 0.5));
/// assert_eq!(d.join(2, 0.5), Some(0.625));
/// # Ok::<(), fredholm::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Discrete {
    sums: Vec<f64>,
    total: f64,
}

impl Discrete {
    /// Probabilities ∝ `weights`.
    ///
    /// # Errors
    /// [`Error::Invalid`] for weights that are negative or not finite, or whose sum is 0 or not finite.
    pub fn new(weights: &[f64]) -> Result<Self, Error> {
        let (sums, total) = cumulative("weight", weights.iter().copied())?;
        Ok(Discrete { sums, total })
    }

    /// Sum of the weights.
    #[must_use]
    pub fn total(&self) -> f64 {
        self.total
    }

    /// The index, and the place of u between the sums before and after it: again uniform in [0, 1), independent of the index.
    #[must_use]
    pub fn split(&self, u: f64) -> (usize, f64) {
        let i = bin(&self.sums, u);
        (i, ((u - self.sums[i]) / self.probability(i)).clamp(0.0, 1.0 - f64::EPSILON / 2.0))
    }

    /// The inverse of [`split`](Self::split); `None` for an index that is never drawn.
    #[must_use]
    pub fn join(&self, i: usize, rest: f64) -> Option<f64> {
        (self.pdf(&i) > 0.0).then(|| self.sums[i] + rest * self.probability(i))
    }

    fn probability(&self, i: usize) -> f64 {
        self.sums[i + 1] - self.sums[i]
    }
}

impl Distribution for Discrete {
    type Unit = f64;
    type Point = usize;

    fn sample(&self, u: f64) -> usize {
        bin(&self.sums, u)
    }

    fn pdf(&self, i: &usize) -> f64 {
        if *i + 1 < self.sums.len() { self.probability(*i) } else { 0.0 }
    }
}

/// Index i with probability ∝ `weights[i]`, in constant time (Walker, 1977; tables after Vose, *A linear algorithm for generating random
/// numbers with a given distribution*, 1991). Not monotone in u: low discrepancy is lost, and there is no inverse.
///
/// ```
/// use fredholm::sampling::distribution::{Alias, Distribution};
/// let d = Alias::new(&[1.0, 0.0, 3.0])?;
/// let drawn = (0..300).filter(|i| d.sample((*i as f64 + 0.5) / 300.0) == 2).count();
/// assert_eq!((drawn, d.pdf(&2)), (225, 0.75));
/// # Ok::<(), fredholm::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Alias {
    /// of each column: the share that is its own, and the index that has the rest
    columns: Vec<(f64, usize)>,
    pdf: Vec<f64>,
}

impl Alias {
    /// Probabilities ∝ `weights`.
    ///
    /// # Errors
    /// [`Error::Invalid`] for weights that are negative or not finite, or whose sum is 0 or not finite.
    pub fn new(weights: &[f64]) -> Result<Self, Error> {
        let (_, total) = cumulative("weight", weights.iter().copied())?;
        let n = weights.len();
        let pdf: Vec<f64> = weights.iter().map(|w| w / total).collect();
        let mut share: Vec<f64> = pdf.iter().map(|p| p * n as f64).collect();
        let (mut small, mut large): (Vec<usize>, Vec<usize>) = (0..n).partition(|i| share[*i] < 1.0);
        let heaviest = (0..n).max_by(|a, b| pdf[*a].total_cmp(&pdf[*b])).unwrap_or(0);
        // a column that finds no partner is full up to rounding; one of weight 0 must not be, so it goes to the heaviest
        let mut columns: Vec<(f64, usize)> = (0..n).map(|i| if pdf[i] > 0.0 { (1.0, i) } else { (0.0, heaviest) }).collect();
        while let (Some(low), Some(high)) = (small.pop(), large.last().copied()) {
            columns[low] = (share[low], high);
            share[high] -= 1.0 - share[low];
            if share[high] < 1.0 {
                large.pop();
                small.push(high);
            }
        }
        Ok(Alias { columns, pdf })
    }
}

impl Distribution for Alias {
    type Unit = f64;
    type Point = usize;

    fn sample(&self, u: f64) -> usize {
        let n = self.columns.len();
        let place = u * n as f64;
        let column = (place as usize).min(n - 1);
        let (own, other) = self.columns[column];
        if place - (column as f64) < own { column } else { other }
    }

    fn pdf(&self, i: &usize) -> f64 {
        self.pdf.get(*i).copied().unwrap_or(0.0)
    }
}
