//! Densities tabulated from values of g.

use crate::domain::{Domain, Node};
use crate::error::Error;
use crate::kernel::Proposal;
use crate::sampling::{Sampler, Table};
use crate::value::Value;

/// A density tabulated ∝ |g| with a share of the domain's own density, whatever x.
#[derive(Clone, Debug)]
pub struct TabulatedSource<D> {
    domain: D,
    table: Option<Table>,
}

/// Share of the domain's own density: a cell whose samples of g all vanish may still hold g ≠ 0.
const DEFENSIVE: f64 = 0.1;

impl<D: Domain> TabulatedSource<D> {
    pub(crate) fn new<V: Value>(domain: &D, g: impl Fn(&D::Point) -> V, cells: usize) -> Result<Self, Error> {
        domain.validate()?;
        if cells == 0 {
            return Err(Error::invalid("cells", 0.0, "must be at least 1"));
        }
        Error::held("cells", (domain.states() as u64).saturating_mul(cells as u64))?;
        if domain.dimension() != 1 {
            return Err(Error::invalid("dimension", domain.dimension() as f64, "tabulated sources need a one-dimensional domain"));
        }
        let h = 1.0 / cells as f64;
        let mut weights = Vec::with_capacity(domain.states() * cells);
        for i in 0..domain.states() * cells {
            let mut mean = 0.0;
            for offset in [0.125, 0.375, 0.625, 0.875] {
                let y = domain.place(i / cells, || ((i % cells) as f64 + offset) * h);
                let value = g(&y.point);
                if !value.all_finite() {
                    return Err(Error::non_finite_source(&y.point, &value));
                }
                mean += 0.25 * value.magnitude() * y.weight;
            }
            weights.push(mean);
        }
        Ok(TabulatedSource { domain: domain.clone(), table: Table::new(&weights) })
    }

    /// A point and 1/density.
    #[inline]
    pub(crate) fn draw<S: Sampler>(&self, u: &mut S) -> Node<D::Point> {
        let v = u.next_1d();
        let Some(table) = &self.table else { return self.domain.sample(u) };
        let y = if v < DEFENSIVE {
            self.domain.sample(u).point
        } else {
            let states = self.domain.states();
            let t = table.sample((v - DEFENSIVE) / (1.0 - DEFENSIVE)).0 * states as f64;
            let state = (t as usize).min(states - 1);
            self.domain.place(state, || (t - state as f64).clamp(f64::EPSILON / 2.0, 1.0 - f64::EPSILON / 2.0)).point
        };
        Node { point: y, weight: 1.0 / self.density(&y) }
    }

    /// Density at y.
    #[inline]
    pub(crate) fn density(&self, y: &D::Point) -> f64 {
        let own = self.domain.density(y);
        let Some(table) = &self.table else { return own };
        let t = (self.domain.state(y) as f64 + self.domain.coordinate(y, 0)) / self.domain.states() as f64;
        own * (DEFENSIVE + (1.0 - DEFENSIVE) * table.pdf(t))
    }
}

impl<D: Domain> Proposal<D::Point> for TabulatedSource<D> {
    #[inline]
    fn sample<S: Sampler>(&self, _: &D::Point, u: &mut S) -> Node<D::Point> {
        self.draw(u)
    }

    #[inline]
    fn pdf(&self, _: &D::Point, y: &D::Point) -> f64 {
        self.density(y)
    }
}
