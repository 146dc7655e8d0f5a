//! Tensor Gauss–Legendre quadrature: the deterministic answer, and the integrals of the variance formulas.

use super::{Integral, Integrator};
use crate::domain::{Domain, Node};
use crate::error::Error;
use crate::source::Source;
use crate::value::Value;

/// Panels of Gauss–Legendre nodes along every coordinate of the domain's map; exact for polynomials of degree 2·order − 1 in each panel.
///
/// ```
/// use fredholm::integral::{Gauss, Integral};
/// let i = Integral::on_interval(0.0..=std::f64::consts::PI, f64::sin).solve(&Gauss::legendre(4, 8))?;
/// assert!((i - 2.0).abs() < 1e-14);
/// # Ok::<(), fredholm::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[must_use]
pub struct Gauss {
    pub(super) panels: usize,
    pub(super) order: usize,
}

/// More nodes than this would not fit into a common memory.
const LIMIT: f64 = 2e8;

impl Gauss {
    /// `panels` equal panels of `order` nodes along every coordinate.
    pub fn legendre(panels: usize, order: usize) -> Self {
        Gauss { panels, order }
    }

    /// The nodes on the domain of `integral`, where f is finite.
    pub(super) fn nodes<D: Domain, G: Source<Point = D::Point>>(&self, integral: &Integral<D, G>) -> Result<Vec<Node<D::Point>>, Error> {
        integral.validate()?;
        self.validate(integral.domain())?;
        let nodes = integral.domain().rule(self.panels, self.order);
        for n in &nodes {
            let f = integral.integrand().eval(&n.point);
            if !f.all_finite() {
                return Err(Error::NonFiniteIntegrand { at: format!("{:?}", n.point), value: format!("{f:?}") });
            }
        }
        Ok(nodes)
    }

    pub(super) fn validate<D: Domain>(&self, domain: &D) -> Result<(), Error> {
        if self.panels == 0 {
            return Err(Error::invalid("panels", 0.0, "must be at least 1"));
        }
        if self.order == 0 {
            return Err(Error::invalid("order", 0.0, "must be at least 1"));
        }
        let count = (self.panels as f64 * self.order as f64).powi(domain.dimension() as i32) * domain.states() as f64;
        if count > LIMIT {
            return Err(Error::invalid("nodes of the tensor rule", count, "must be at most 2e8: use Monte Carlo"));
        }
        Ok(())
    }
}

impl<D: Domain, G: Source<Point = D::Point>> Integrator<D, G> for Gauss {
    type Solution = G::Value;

    fn solve(&self, integral: &Integral<D, G>) -> Result<G::Value, Error> {
        let mut sum = G::Value::ZERO;
        for n in self.nodes(integral)? {
            sum += integral.integrand().eval(&n.point).scale(n.weight);
        }
        Ok(sum)
    }
}
