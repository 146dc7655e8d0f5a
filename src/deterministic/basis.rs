//! Lagrange bases on [0, 1], in barycentric form, and the decay of Legendre coefficients.
//!
//! ```text
//! ℓ_k(u) = (s_k/(u − u_k)) / Σ_j s_j/(u − u_j)                    Berrut, Trefethen, SIAM Review 46 (2004) 501, (4.2)
//! s_k = (−1)^k √((1 − x_k²) ω_k) for Gauss–Legendre nodes          Wang, Xiang, Math. Comp. 81 (2012) 861
//! ```

use super::quadrature::unit_rule;
use crate::domain::Node;

/// Nodes u_k in [0, 1], their quadrature weights and their barycentric weights.
#[derive(Clone, Debug)]
pub(crate) struct Basis {
    rule: Vec<Node<f64>>,
    scale: Vec<f64>,
    /// ℓ_j′(u_k) at k · len + j
    slopes: Vec<f64>,
    /// ℓ_k = Σ_n c_kn P_n(2u − 1), at k · len + n
    legendre: Vec<f64>,
}

impl Basis {
    /// Polynomials of degree `order` − 1 through the Gauss–Legendre nodes.
    pub(crate) fn gauss(order: usize) -> Self {
        let rule = unit_rule(order);
        // discrete orthogonality: products of two P_n are integrated exactly
        let coefficient = |u: &Node<f64>, (n, p): (usize, f64)| (2 * n + 1) as f64 * u.weight * p;
        let of_node = |u: &Node<f64>| legendre(order, 2.0 * u.point - 1.0).into_iter().enumerate().map(|p| coefficient(u, p)).collect();
        let coefficients = rule.iter().map(of_node).collect::<Vec<Vec<f64>>>().concat();
        let sign = |k: usize| if k.is_multiple_of(2) { 1.0 } else { -1.0 };
        let scale = rule.iter().enumerate().map(|(k, n)| sign(k) * (n.point * (1.0 - n.point) * n.weight).sqrt()).collect();
        Basis::new(rule, scale, coefficients)
    }

    /// The two halves of hat functions on an element: linear functions through its ends.
    pub(crate) fn hats() -> Self {
        let rule = [0.0, 1.0].map(|point| Node { point, weight: 0.5 }).to_vec();
        Basis::new(rule, vec![1.0, -1.0], vec![0.5, -0.5, 0.5, 0.5])
    }

    /// Slopes at the nodes: Berrut, Trefethen (2004), (9.4), with rows that sum to 0.
    fn new(rule: Vec<Node<f64>>, scale: Vec<f64>, legendre: Vec<f64>) -> Self {
        let n = rule.len();
        let mut slopes = vec![0.0; n * n];
        for k in 0..n {
            for j in (0..n).filter(|&j| j != k) {
                slopes[k * n + j] = scale[j] / scale[k] / (rule[k].point - rule[j].point);
                slopes[k * n + k] -= slopes[k * n + j];
            }
        }
        Basis { rule, scale, slopes, legendre }
    }

    /// Weights for the nodes u_k + `shifts`_k instead of u_k, to first order in the shifts: φ(u_k) ≈ φ(u_k + δ_k) − δ_k φ′(u_k), with φ′ that of
    /// the interpolant.
    pub(crate) fn shifted_weights(&self, shifts: &[f64], out: &mut [f64]) {
        out.iter_mut().zip(&self.rule).for_each(|(w, n)| *w = n.weight);
        for ((shift, n), slopes) in shifts.iter().zip(&self.rule).zip(self.slopes.chunks_exact(self.rule.len())) {
            if *shift != 0.0 {
                out.iter_mut().zip(slopes).for_each(|(w, slope)| *w -= n.weight * shift * slope);
            }
        }
    }

    pub(crate) fn len(&self) -> usize {
        self.rule.len()
    }

    pub(crate) fn rule(&self) -> &[Node<f64>] {
        &self.rule
    }

    /// ℓ_k(u) for all k.
    pub(crate) fn values(&self, u: f64, out: &mut [f64]) {
        let mut closest = f64::INFINITY;
        for (o, n) in out.iter_mut().zip(&self.rule) {
            *o = u - n.point;
            closest = closest.min(o.abs());
        }
        if closest < f64::MIN_POSITIVE {
            // at a node the basis is an indicator; 1/d of a subnormal number overflows
            out.iter_mut().for_each(|o| *o = if o.abs() < f64::MIN_POSITIVE { 1.0 } else { 0.0 });
            return;
        }
        let mut sum = 0.0;
        out.iter_mut().zip(&self.scale).for_each(|(o, s)| *o = s / *o);
        out.iter().for_each(|o| sum += o);
        let share = 1.0 / sum;
        out.iter_mut().for_each(|o| *o *= share);
    }

    /// Integrals against ℓ_k, added to `out`, from those against P_n(2u − 1); both hold `width` numbers a function.
    pub(crate) fn add_from_legendre(&self, integrals: &[f64], width: usize, out: &mut [f64]) {
        for (coefficients, out) in self.legendre.chunks_exact(self.len()).zip(out.chunks_exact_mut(width)) {
            for (c, row) in coefficients.iter().zip(integrals.chunks_exact(width)) {
                out.iter_mut().zip(row).for_each(|(o, m)| *o += c * m);
            }
        }
    }

    /// Size of the last Legendre coefficients of the interpolant through `values`: what the basis fails to resolve.
    ///
    /// The two last ones together, so that an even or odd function cannot hide.
    pub(crate) fn tail(&self, values: &[f64]) -> f64 {
        let p = self.len();
        let coefficient = |degree: usize| -> f64 { values.iter().enumerate().map(|(k, v)| v * self.legendre[k * p + degree]).sum() };
        (p.saturating_sub(2)..p).map(|d| coefficient(d).abs()).fold(0.0, f64::max)
    }
}

/// P_0(x), …, P_{count − 1}(x) by their three-term recurrence.
fn legendre(count: usize, x: f64) -> Vec<f64> {
    let (mut before, mut now) = (0.0, 1.0);
    let next = |k: usize| {
        let (k, p) = (k as f64, now);
        (before, now) = (now, ((2.0 * k + 1.0) * x * now - k * before) / (k + 1.0));
        p
    };
    (0..count).map(next).collect()
}

#[cfg(test)]
mod tests {
    use super::Basis;

    #[test]
    fn interpolates_polynomials() {
        let basis = Basis::gauss(9);
        let mut l = [0.0; 9];
        for u in [0.0, 0.1, 0.5, 0.77, 1.0] {
            basis.values(u, &mut l);
            let value: f64 = basis.rule().iter().zip(l).map(|(n, l)| l * n.point.powi(8)).sum();
            assert!((value - f64::powi(u, 8)).abs() < 1e-14, "{u}: {value}");
        }
    }

    #[test]
    fn shifted_nodes_integrate_as_well() {
        let basis = Basis::gauss(12);
        let shifts: Vec<f64> = (0..12).map(|k| 1e-9 * f64::from((7 * k) % 5 - 2)).collect();
        let mut weights = [0.0; 12];
        basis.shifted_weights(&shifts, &mut weights);
        let integral: f64 = basis.rule().iter().zip(&shifts).zip(weights).map(|((n, d), w)| w * (2.0 * (n.point + d)).exp()).sum();
        assert!((integral - 0.5 * (f64::exp(2.0) - 1.0)).abs() < 4e-15, "{integral}");
    }

    #[test]
    fn hats_are_linear() {
        let mut l = [0.0; 2];
        Basis::hats().values(0.25, &mut l);
        assert_eq!(l, [0.75, 0.25]);
        Basis::hats().values(1.0, &mut l);
        assert_eq!(l, [0.0, 1.0]);
        Basis::hats().values(5e-324, &mut l);
        assert_eq!(l, [1.0, 0.0]);
    }

    #[test]
    fn tail_sees_what_is_unresolved() {
        let basis = Basis::gauss(16);
        let tail = |f: fn(f64) -> f64| basis.tail(&basis.rule().iter().map(|n| f(n.point)).collect::<Vec<_>>());
        assert!(tail(f64::exp) < 1e-13);
        assert!(tail(|u| (u - 0.3).abs()) > 1e-3);
        assert!(tail(f64::sqrt) > 1e-4);
    }
}
