//! Residuals of solutions, by rules that share no nodes with the solve.

use super::solution::{Check, NystromSolution, apply_row};
use crate::contained::contained;
use crate::error::Error;
use crate::kernel::{HasDomain, Kernel, Operator};
use crate::parallel;
use crate::source::Source;
use crate::value::{Value, Weight};
use std::sync::OnceLock;

impl<G, K> NystromSolution<G, K>
where
    G: Source,
    K: Kernel + HasDomain + Operator<Point = G::Point>,
    K::Weight: Weight<Value = G::Value>,
{
    /// g(x) + (Tf_n)(x) − f_n(x), with T by a rule that shares neither nodes nor order with the solve (made at the first call: about n more rows).
    ///
    /// # Errors
    /// Those of [`try_eval`](NystromSolution::try_eval).
    pub fn residual(&self, x: K::Point) -> Result<G::Value, Error> {
        contained(|| {
            let check = self.check.get_or_init(|| self.independent(0.0)).as_ref().map_err(Clone::clone)?;
            Ok(apply_row(&self.system.kernel, &check.grid, &check.values, &x)? - self.integral_term(x)?)
        })
    }

    /// f_j improved by one step of iterative refinement, with residuals from sums that do not round (Higham 2002, ch. 12): one more assembly.
    pub(super) fn refined(mut self) -> Result<Self, Error> {
        let nodes = &self.system.grid.nodes;
        let at_nodes = parallel::map(nodes.len(), |j| Ok::<_, Error>(self.value_at(&nodes[j].point)? - self.values[j]));
        let residuals = at_nodes.into_iter().collect::<Result<Vec<_>, _>>()?;
        self.values.iter_mut().zip(self.system.inverse_of(&residuals)).for_each(|(f, e)| *f += e);
        self.check = OnceLock::new();
        Ok(self)
    }

    /// The residual at node `j`, where f − g is T f of the solve up to the rounding of the linear system.
    pub(super) fn residual_at_node(&self, j: usize) -> Result<G::Value, Error> {
        let check = self.check.get_or_init(|| self.independent(0.0)).as_ref().map_err(Clone::clone)?;
        let x = self.system.grid.nodes[j].point;
        Ok(apply_row(&self.system.kernel, &check.grid, &check.values, &x)? - (self.values[j] - self.source.eval(&x)))
    }

    /// Prepares residuals for which f between nodes may err by `allowed`: polynomials instead of rows where they are good enough.
    pub(super) fn prepare_residuals(&self, allowed: f64) {
        self.check.get_or_init(|| self.independent(allowed));
    }

    /// f at places between nodes: by the polynomials through the nodes of panels that resolve f up to `allowed`, else by rows.
    pub(super) fn between_nodes(&self, places: &[K::Point], allowed: f64) -> Result<Vec<G::Value>, Error> {
        let (grid, domain) = (&self.system.grid, self.system.kernel.domain());
        let resolved: Vec<bool> = grid.panels().map_or_else(Vec::new, |panels| {
            let tail = |values: &[G::Value], a: usize| panels.basis.tail(&values.iter().map(|v| v.component(a)).collect::<Vec<_>>());
            let fine = |values: &[G::Value]| (0..G::Value::COMPONENTS).all(|a| tail(values, a) <= allowed);
            self.values.chunks_exact(panels.basis.len()).map(fine).collect()
        });
        let at = |x: &K::Point| match grid.panels().and_then(|p| Some((p.basis.len(), grid.stencil(domain, x)?))) {
            Some((order, stencil)) if resolved[stencil.first / order] => {
                Ok(G::Value::from_components(|a| stencil.apply(|j| self.values[j].component(a))))
            }
            _ => self.value_at(x),
        };
        parallel::map(places.len(), |i| at(&places[i])).into_iter().collect()
    }

    fn independent(&self, allowed: f64) -> Result<Check<K::Point, G::Value>, Error> {
        let domain = self.system.kernel.domain();
        let grid = self.system.grid.independent(domain)?;
        let places: Vec<K::Point> = grid.nodes.iter().map(|n| n.point).collect();
        let values = self.between_nodes(&places, allowed)?;
        Ok(Check { grid, values })
    }
}
