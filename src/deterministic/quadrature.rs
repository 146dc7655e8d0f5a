//! Gauss–Legendre nodes on panels.

use crate::domain::Node;
use gauss_quad::GaussLegendre;
use std::num::NonZeroUsize;

/// The `order`-point Gauss–Legendre rule on [0, 1], nodes ascending; exact for polynomials of degree 2·`order` − 1.
///
/// Order 0 gives an empty rule.
///
/// ```
/// let rule = fredholm::deterministic::quadrature::unit_rule(2);
/// let integral: f64 = rule.iter().map(|n| n.weight * n.point.powi(3)).sum();
/// assert!((integral - 0.25).abs() < 1e-15);
/// ```
#[must_use]
pub fn unit_rule(order: usize) -> Vec<Node<f64>> {
    let Some(order) = NonZeroUsize::new(order) else { return Vec::new() };
    let mut nodes: Vec<_> = GaussLegendre::new(order).iter().map(|&(x, w)| Node { point: 0.5 * (1.0 + x), weight: 0.5 * w }).collect();
    nodes.sort_by(|a, b| a.point.total_cmp(&b.point));
    nodes
}

/// A sum without the rounding of its partial sums (Neumaier 1974).
pub(crate) fn compensated_sum(terms: impl IntoIterator<Item = f64>) -> f64 {
    let (mut sum, mut lost) = (0.0f64, 0.0);
    for term in terms {
        let next = sum + term;
        lost += if sum.abs() >= term.abs() { (sum - next) + term } else { (term - next) + sum };
        sum = next;
    }
    sum + lost
}

/// `panels` equal panels of [0, 1], each with the `order`-point Gauss–Legendre rule.
#[must_use]
pub fn composite_unit_rule(panels: usize, order: usize) -> Vec<Node<f64>> {
    let rule = unit_rule(order);
    let h = 1.0 / panels as f64;
    (0..panels).flat_map(|p| rule.iter().map(move |n| Node { point: (p as f64 + n.point) * h, weight: n.weight * h })).collect()
}

#[cfg(test)]
mod tests {
    use super::unit_rule;

    /// On [−1, 1]: the largest node, the smallest positive node and their weights, from 40-digit arithmetic.
    #[rustfmt::skip]
    const KNOWN: [(usize, f64, f64, f64, f64); 4] = [
        (16, 0.9894009349916499, 0.027152459411754096, 0.09501250983763744, 0.1894506104550685),
        (64, 0.9993050417357722, 0.001783280721696433, 0.024350292663424433, 0.048690957009139724),
        (256, 0.9999560500189922, 0.00011278901782227218, 0.006123912375189529, 0.012247671640289755),
        (1024, 0.9999972450545584, 7.07007641018259e-06, 0.0015332313560626385, 0.0030664603092439083),
    ];

    #[test]
    fn nodes_and_weights() {
        for (n, last, last_weight, first, first_weight) in KNOWN {
            let rule = unit_rule(n);
            let on_symmetric = |i: usize| (2.0 * rule[i].point - 1.0, 2.0 * rule[i].weight);
            for ((x, w), (node, weight)) in [(on_symmetric(n - 1), (last, last_weight)), (on_symmetric(n / 2), (first, first_weight))] {
                assert!((x - node).abs() < 4e-16 && (w / weight - 1.0).abs() < 1e-15, "n = {n}: {x} {w}");
            }
        }
    }

    #[test]
    fn moments_to_rounding() {
        for n in [16, 64, 256, 1024] {
            let rule = unit_rule(n);
            for degree in [0, 1, 2, 7, 31] {
                let moment: f64 = rule.iter().map(|p| p.weight * p.point.powi(degree)).sum();
                assert!((moment * f64::from(degree + 1) - 1.0).abs() < 1e-14, "n = {n}, degree {degree}: {moment}");
            }
        }
        // small orders are exact up to degree 2n − 1 and no further
        for n in 1..20 {
            let error =
                |degree: i32| unit_rule(n).iter().map(|p| p.weight * p.point.powi(degree)).sum::<f64>() - 1.0 / f64::from(degree + 1);
            assert!((0..2 * n as i32).all(|d| error(d).abs() < 2e-15));
            assert!(n > 10 || error(2 * n as i32).abs() > 1e-15);
        }
        assert!(unit_rule(0).is_empty());
    }
}
