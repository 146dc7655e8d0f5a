//! Interpolants through values at the nodes of a rule.

use super::axis::Axis;
use super::basis::Basis;
use super::grid::Grid;
use crate::domain::{Domain, Point};

/// Value of an interpolant at one place: Σ weights_k value(first + k).
#[derive(Clone, Debug)]
pub(crate) struct Stencil {
    pub(crate) first: usize,
    weights: Vec<f64>,
}

impl Stencil {
    pub(crate) fn apply(&self, value: impl Fn(usize) -> f64) -> f64 {
        self.weights.iter().enumerate().map(|(k, w)| w * value(self.first + k)).sum()
    }
}

impl<X: Point> Grid<X> {
    /// What the polynomials through values at the nodes are at x, panel by panel or over the whole cube; `None` for composite rules.
    pub(crate) fn stencil<D: Domain<Point = X>>(&self, domain: &D, x: &X) -> Option<Stencil> {
        let mut weights = vec![0.0; self.stencil_width()];
        let first = self.stencil_into(domain, x, &mut weights)?;
        Some(Stencil { first, weights })
    }

    /// Nodes of a stencil; 0 for composite rules.
    pub(super) fn stencil_width(&self) -> usize {
        match (&self.panels, &self.tensor) {
            (Some(panels), _) => panels.basis.len(),
            (_, Some(axes)) => axes.iter().map(Axis::len).product(),
            _ => 0,
        }
    }

    /// The same stencil in place, and its first node.
    pub(super) fn stencil_into<D: Domain<Point = X>>(&self, domain: &D, x: &X, weights: &mut [f64]) -> Option<usize> {
        let per_state = self.nodes.len() / domain.states();
        let first = domain.state(x) * per_state;
        if let Some(panels) = &self.panels {
            let t = domain.coordinate(x, 0);
            let p = panels.at(t);
            let (a, b) = panels.panel(p);
            panels.basis.values((t - a) / (b - a), weights);
            return Some(first + p * weights.len());
        }
        // rounding is all that sinc functions leave of what is close to an end
        const EDGE: f64 = 1e-6;
        if self.is_double_exponential() && !(EDGE..=1.0 - EDGE).contains(&domain.coordinate(x, 0)) {
            return None;
        }
        let axes = self.tensor.as_ref()?;
        axes[0].values(domain.coordinate(x, 0), &mut weights[..axes[0].len()]);
        let (mut filled, mut factors) = (axes[0].len(), Vec::new());
        for (a, axis) in axes.iter().enumerate().skip(1) {
            factors.resize(axis.len(), 0.0);
            axis.values(domain.coordinate(x, a), &mut factors);
            // the first coordinate runs fastest, as in `Domain::rule`
            for (k, factor) in factors.iter().enumerate().rev() {
                (0..filled).for_each(|i| weights[k * filled + i] = factor * weights[i]);
            }
            filled *= axis.len();
        }
        Some(first)
    }

    /// The polynomials of panels or of a line; blocks of as many nodes are theirs.
    pub(super) fn polynomials(&self) -> Option<&Basis> {
        match (&self.panels, self.tensor.as_deref()) {
            (Some(panels), _) => Some(&panels.basis),
            (_, Some([Axis::Gauss(basis)])) => Some(basis),
            _ => None,
        }
    }
}
