//! Rules that are exact for polynomials times a declared singularity: ∫₀¹ S(R v) φ(v) dv = Σ_i W_i φ(v_i) at Gauss–Legendre nodes v_i.
//!
//! ```text
//! W_i = w_i Σ_n (2n + 1) m_n P_n(2v_i − 1),        m_n = ∫₀¹ S(R v) P_n(2v − 1) dv
//! ∫₀¹ v^s P_n(2v − 1) dv = s (s − 1) … (s − n + 1) / ((s + 1) (s + 2) … (s + n + 1))
//! ∫₀¹ ln v P_n(2v − 1) dv = (−1)^{n−1}/(n (n + 1)),  −1 for n = 0                    its derivative at s = 0
//! ```
//!
//! Atkinson, *The numerical solution of integral equations of the second kind* (1997), §4.2 (product integration).

use super::basis::Basis;
use crate::kernel::Singularity;

/// Weights of S(v) on [0, 1] at the nodes of a rule.
#[derive(Debug)]
pub(super) struct SplitRule {
    singularity: Singularity,
    singular: Vec<f64>,
}

impl SplitRule {
    pub(super) fn new(singularity: Singularity, rule: &Basis) -> Self {
        let mut moments = Vec::with_capacity(rule.len());
        let mut product = f64::NAN;
        for n in 0..rule.len() {
            let k = n as f64;
            moments.push(match singularity {
                Singularity::Logarithm if n == 0 => -1.0,
                Singularity::Logarithm => (if n % 2 == 1 { 1.0 } else { -1.0 }) / (k * (k + 1.0)),
                Singularity::Power { exponent } => {
                    let s = -exponent;
                    product = if n == 0 { 1.0 / (s + 1.0) } else { product * (s - k + 1.0) / (s + k + 1.0) };
                    product
                }
            });
        }
        let mut singular = vec![0.0; rule.len()];
        rule.add_from_legendre(&moments, 1, &mut singular);
        SplitRule { singularity, singular }
    }

    /// The weight of S(R v) at node `k` of `rule`, for a side of length R.
    pub(super) fn weight(&self, rule: &Basis, k: usize, length: f64) -> f64 {
        match self.singularity {
            Singularity::Logarithm => self.singular[k] + rule.rule()[k].weight * length.ln(),
            Singularity::Power { exponent } => self.singular[k] * length.powf(-exponent),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_for_polynomials_times_the_singularity() {
        let integral = |s: Singularity, length: f64, power: i32| -> f64 {
            {
                let rule = Basis::gauss(40);
                let split = SplitRule::new(s, &rule);
                rule.rule().iter().enumerate().map(|(k, n)| split.weight(&rule, k, length) * n.point.powi(power)).sum()
            }
        };
        for k in [0, 1, 7, 30] {
            let p = f64::from(k) + 1.0;
            let log = 1e-3f64.ln() / p - 1.0 / (p * p);
            assert!((integral(Singularity::Logarithm, 1e-3, k) - log).abs() < 2e-15 * log.abs().max(1.0), "{k}");
            for exponent in [0.5, 0.9, -0.5] {
                let power = 2f64.powf(-exponent) / (p - exponent);
                assert!((integral(Singularity::Power { exponent }, 2.0, k) / power - 1.0).abs() < 2e-12, "{k} {exponent}");
            }
        }
    }
}
