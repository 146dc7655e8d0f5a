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

/// `panels` equal panels of [0, 1], each with the `order`-point Gauss–Legendre rule.
#[must_use]
pub fn composite_unit_rule(panels: usize, order: usize) -> Vec<Node<f64>> {
    let rule = unit_rule(order);
    let h = 1.0 / panels as f64;
    (0..panels).flat_map(|p| rule.iter().map(move |n| Node { point: (p as f64 + n.point) * h, weight: n.weight * h })).collect()
}
