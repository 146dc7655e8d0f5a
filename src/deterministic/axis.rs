//! Nodes and interpolation along one coordinate of a tensor rule.
//!
//! ```text
//! trapezoid, n odd:    ℓ_k(u) = (−1)^k/sin π(u − u_k) / Σ_j (−1)^j/sin π(u − u_j)
//!            n even:   the same with tan for sin                                     Henrici, Numer. Math. 33 (1979) 225
//! ```

use super::basis::Basis;
use super::double_exponential::DoubleExponential;

/// Gauss nodes with polynomials, equidistant ones with trigonometric polynomials, or double-exponential ones with sinc functions.
#[derive(Clone, Debug)]
pub(super) enum Axis {
    Gauss(Box<Basis>),
    Trapezoid(usize),
    DoubleExponential(DoubleExponential),
}

impl Axis {
    pub(super) fn len(&self) -> usize {
        match self {
            Axis::Gauss(basis) => basis.len(),
            Axis::Trapezoid(n) => *n,
            Axis::DoubleExponential(rule) => rule.len(),
        }
    }

    /// ℓ_k(u) for all k.
    pub(super) fn values(&self, u: f64, out: &mut [f64]) {
        let n = match self {
            Axis::Gauss(basis) => return basis.values(u, out),
            Axis::DoubleExponential(rule) => return rule.values(u, out),
            Axis::Trapezoid(n) => *n,
        };
        let step = std::f64::consts::PI / n as f64;
        let ((mut s, mut c), (s1, c1)) = ((std::f64::consts::PI * u - 0.5 * step).sin_cos(), step.sin_cos());
        let mut sum = 0.0;
        for k in 0..n {
            let d = if n.is_multiple_of(2) { s / c } else { s };
            // one node on
            (s, c) = (s * c1 - c * s1, c * c1 + s * s1);
            if d.abs() < f64::MIN_POSITIVE {
                out.fill(0.0);
                out[k] = 1.0;
                return;
            }
            out[k] = if k.is_multiple_of(2) { 1.0 } else { -1.0 } / d;
            sum += out[k];
        }
        out.iter_mut().for_each(|o| *o /= sum);
    }
}

#[cfg(test)]
mod tests {
    use super::Axis;
    use std::f64::consts::TAU;

    #[test]
    fn trigonometric_polynomials_are_interpolated() {
        for n in [1, 2, 7, 8, 15, 16] {
            let degree = (n - 1) / 2;
            let f = |u: f64| (0..=degree).map(|m| (TAU * m as f64 * u + 0.3).cos()).sum::<f64>();
            let mut l = vec![0.0; n];
            for u in [0.0, 0.11, 0.5, 0.97, 1.0, 0.5 / n as f64] {
                Axis::Trapezoid(n).values(u, &mut l);
                let value: f64 = l.iter().enumerate().map(|(k, l)| l * f((k as f64 + 0.5) / n as f64)).sum();
                assert!((value - f(u)).abs() < 1e-13, "{n} {u}: {value} {}", f(u));
            }
        }
    }
}
