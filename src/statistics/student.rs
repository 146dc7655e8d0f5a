//! Quantiles of Student's t.

use statrs::distribution::{ContinuousCDF, Normal, StudentsT};
use std::f64::consts::PI;

/// From here on the expansion has all the digits that anybody prints.
const MANY: f64 = 1e3;

/// t with P(T ≤ t) = `probability` for `freedom` degrees of freedom, `probability` ∈ [0, 1].
///
/// Cauchy's −cot πp for one; beyond 1000 by Fisher's expansion about the normal quantile z, with w = z² (Abramowitz, Stegun (1964), 26.7.5):
///
/// ```text
/// t = z [1 + (w + 1)/(4ν) + (5w² + 16w + 3)/(96ν²) + (3w³ + 19w² + 17w − 15)/(384ν³) + (79w⁴ + 776w³ + 1482w² − 1920w − 945)/(92 160ν⁴)] + O(ν⁻⁵)
/// ```
///
/// Relative error below 10⁻¹⁰ for |z| < 6.5. Inverting the incomplete beta function instead loses digits as ν²: 10⁻³ of t at ν = 10⁶, all of them at 10⁷;
/// statrs 0.19 then sometimes never ends (ν = 2²⁴ − 1), nor does it find the far tails of ν = 1 (its issue 435).
///
/// `None` if there is no degree of freedom, or `probability` is no probability.
///
/// ```
/// use fredholm::statistics::student_quantile;
/// assert!((student_quantile(1, 0.75).unwrap() - 1.0).abs() < 1e-12);
/// assert!((student_quantile(1 << 24, 0.975).unwrap() - 1.959_964).abs() < 1e-6);
/// assert_eq!(student_quantile(0, 0.975), None);
/// ```
#[must_use]
pub fn student_quantile(freedom: u64, probability: f64) -> Option<f64> {
    if !(0.0..=1.0).contains(&probability) {
        return None;
    }
    if freedom == 1 {
        let tail = probability.min(1.0 - probability);
        return Some((PI * tail).tan().recip().copysign(probability - 0.5));
    }
    let nu = freedom as f64;
    if nu < MANY {
        return StudentsT::new(0.0, 1.0, nu).ok().map(|t| t.inverse_cdf(probability));
    }
    Some(expanded(nu, Normal::standard().inverse_cdf(probability)))
}

fn expanded(nu: f64, z: f64) -> f64 {
    let w = z * z;
    let terms = [
        (w + 1.0) / 4.0,
        ((5.0 * w + 16.0) * w + 3.0) / 96.0,
        (((3.0 * w + 19.0) * w + 17.0) * w - 15.0) / 384.0,
        ((((79.0 * w + 776.0) * w + 1482.0) * w - 1920.0) * w - 945.0) / 92_160.0,
    ];
    z + z * terms.iter().rev().fold(0.0, |sum, term| (sum + term) / nu)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inverse_of_the_distribution() {
        for nu in [1, 2, 7, 100, 999, 1000, 1001, 4000] {
            let student = StudentsT::new(0.0, 1.0, nu as f64).unwrap();
            for probability in [1e-10, 1e-6, 1e-3, 0.025, 0.1, 0.25] {
                let error = student.cdf(student_quantile(nu, probability).unwrap()) / probability - 1.0;
                assert!(error.abs() < 1e-9, "ν = {nu}, p = {probability}: {error}");
            }
        }
    }

    #[test]
    fn many_degrees_of_freedom_are_normal() {
        for probability in [1e-9, 0.025, 0.6, 0.975] {
            let z = Normal::standard().inverse_cdf(probability);
            // 14 438 908 and 2²⁴ − 1 are two of those for which inversion does not end
            for nu in [1_000_000, 14_438_908, (1 << 24) - 1, u64::MAX] {
                let excess = student_quantile(nu, probability).unwrap() / z - 1.0;
                let expected = (z * z + 1.0) / (4.0 * nu as f64);
                assert!((excess - expected).abs() < 1e-10, "ν = {nu}, p = {probability}: {excess}, not {expected}");
            }
        }
    }

    #[test]
    fn ends_and_refusals() {
        for freedom in [1, 999, 1000, 1 << 24] {
            assert_eq!(student_quantile(freedom, 1.0), Some(f64::INFINITY));
            assert_eq!(student_quantile(freedom, 0.0), Some(f64::NEG_INFINITY));
            assert!(student_quantile(freedom, 0.5).unwrap().abs() < 1e-7);
            assert_eq!([-0.1, 1.1, f64::NAN].map(|p| student_quantile(freedom, p)), [None; 3]);
        }
        assert_eq!(student_quantile(0, 0.5), None);
    }
}
