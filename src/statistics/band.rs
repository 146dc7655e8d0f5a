//! Simultaneous bands by the largest |t| over all points.
//!
//! ```text
//! D_b = batch mean b − mean (vectors over points),  s_i² = Σ_b D_bi²/(B(B − 1)):       T = max_i |mean_i − truth_i|/s_i
//! given the batches,  T* = max_i |Σ_b ξ_b D_bi| / (√(B(B − 1)) s_i) / √(χ²_{B−1}/(B − 1)),    ξ_b ~ N(0, 1),  has the law of T
//! ```
//!
//! Derivation: for normal batch means Σ ξ_b D_b/√(B − 1) has their estimated covariance, and t_i is a normal variable over an independent χ; one point alone
//! gives Student's t with B − 1 degrees of freedom. Reference: Montiel Olea, Plagborg-Møller, J. Appl. Econometrics 34 (2019) 1; Chernozhukov,
//! Chetverikov, Kato, *Gaussian approximations and multiplier bootstrap*, Ann. Statist. 41 (2013) 2786.

use crate::parallel;
use crate::sampling::{Pcg, Sampler, Sequence};
use crate::value::Value;

/// Lower and upper ends of a region that contains a whole curve with a stated probability.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Band<V = f64> {
    /// Probability that the curve is inside at all points at once.
    pub confidence: f64,
    /// Half-width in standard errors; 1.96 or so for a single point, more for many.
    pub critical: f64,
    /// Lower ends.
    pub lower: Vec<V>,
    /// Upper ends.
    pub upper: Vec<V>,
}

impl<V: Value> Band<V> {
    /// Whether the band contains a whole curve, given at its points.
    pub fn contains(&self, curve: &[V]) -> bool {
        let inside = |i: usize, k: usize| {
            let v = curve[i].component(k);
            let slack = 16.0 * f64::EPSILON * v.abs();
            self.lower[i].component(k) <= v + slack && v <= self.upper[i].component(k) + slack
        };
        (0..curve.len()).all(|i| (0..V::COMPONENTS).all(|k| inside(i, k)))
    }
}

/// Draws of T*: the level of a 95 % band is right to 0.3 %.
const DRAWS: usize = 4096;
/// Draws in a task.
const TASK: usize = 64;

/// The quantile of T*; `None` below two batches.
pub(super) fn critical<V: Value>(deviations: &[Vec<V>], errors: &[V], confidence: f64) -> Option<f64> {
    let batches = deviations.len();
    if batches < 2 {
        return None;
    }
    let (b, components) = (batches as f64, V::COMPONENTS);
    // D_bi/(√(B(B − 1)) s_i); points without spread have no t
    let scaled = |d: &Vec<V>| -> Vec<f64> {
        let one = |i: usize| d[i / components].component(i % components) / errors[i / components].component(i % components);
        (0..components * errors.len()).map(|i| Some(one(i) / (b * (b - 1.0)).sqrt()).filter(|t| t.is_finite()).unwrap_or(0.0)).collect()
    };
    let rows: Vec<Vec<f64>> = deviations.iter().map(scaled).collect();
    let tasks = parallel::map(DRAWS / TASK, |task| {
        let mut sums = vec![0.0; components * errors.len()];
        let draw = |k: usize| largest(&rows, (task * TASK + k) as u64, &mut sums);
        (0..TASK).map(draw).collect::<Vec<_>>()
    });
    let mut draws = tasks.concat();
    draws.sort_unstable_by(f64::total_cmp);
    let rank = (confidence * DRAWS as f64).ceil() as usize;
    Some(draws[rank.clamp(1, DRAWS) - 1])
}

/// One draw of T*.
fn largest(rows: &[Vec<f64>], draw: u64, sums: &mut [f64]) -> f64 {
    // the band of the same batches is the same band: nothing but the number of the draw is random
    let mut u = Pcg::default().point(u64::MAX, u32::MAX, draw);
    sums.fill(0.0);
    for pair in rows.chunks(2) {
        for (xi, row) in normals(&mut u).into_iter().zip(pair) {
            sums.iter_mut().zip(row).for_each(|(s, d)| *s += xi * d);
        }
    }
    let freedom = rows.len() - 1;
    let chi: f64 = (0..freedom.div_ceil(2)).map(|i| normals(&mut u).iter().take(freedom - 2 * i).map(|n| n * n).sum::<f64>()).sum();
    sums.iter().fold(0.0, |m: f64, s| m.max(s.abs())) / (chi / freedom as f64).sqrt()
}

/// Two independent normal numbers (Box, Muller, Ann. Math. Statist. 29 (1958) 610).
#[inline]
fn normals<S: Sampler>(u: &mut S) -> [f64; 2] {
    let [a, b] = u.next_2d();
    let (sin, cos) = (std::f64::consts::TAU * b).sin_cos();
    let radius = (-2.0 * a.ln()).sqrt();
    [radius * cos, radius * sin]
}

#[cfg(test)]
mod tests {
    use super::critical;
    use statrs::distribution::{ContinuousCDF, StudentsT};

    /// One point: Student's quantile. Two points that always agree: the same.
    #[test]
    fn one_point_is_students() {
        let deviations: Vec<Vec<f64>> = (0..8).map(|i| vec![f64::from(i) - 3.5; 2]).collect();
        let error = (deviations.iter().map(|d| d[0] * d[0]).sum::<f64>() / 56.0).sqrt();
        let c = critical(&deviations, &[error; 2], 0.9).unwrap();
        let t = StudentsT::new(0.0, 1.0, 7.0).unwrap().inverse_cdf(0.95);
        assert!((c / t - 1.0).abs() < 0.05, "{c} against {t}");
    }
}
