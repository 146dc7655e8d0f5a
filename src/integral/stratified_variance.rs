//! The variance of stratified sampling, by quadrature in every stratum.

use super::secondary::validate;
use super::{Gauss, Integral, Plain, Predictable, Stratified};
use crate::deterministic::quadrature::composite_unit_rule;
use crate::domain::Domain;
use crate::error::Error;
use crate::sampling::Pcg;
use crate::source::Source;
use crate::value::Value;

/// Σ v_i² σ_i²/n_i for the plain estimator with independent points; Neyman's n_i with the true σ_i.
impl<D, G> Predictable<D, G> for Stratified<Plain, Pcg>
where
    D: Domain,
    G: Source<Point = D::Point>,
{
    fn predict(&self, integral: &Integral<D, G>, rule: &Gauss) -> Result<G::Value, Error> {
        integral.validate()?;
        self.strata.validate()?;
        self.allocation.validate()?;
        validate(self.samples, Some(self.replicates))?;
        rule.validate(integral.domain())?;
        let variances = (0..self.strata.count()).map(|i| self.variance_in(integral, rule, i)).collect::<Result<Vec<_>, Error>>()?;
        let spread: Vec<f64> = variances.iter().map(|v| v.magnitude().sqrt()).collect();
        let counts = self.allocation.counts(&self.strata, self.samples.div_ceil(u64::from(self.replicates)), &spread);
        let mut sum = G::Value::ZERO;
        for (i, (v, n)) in variances.iter().zip(&counts).enumerate() {
            sum += v.scale(self.strata.volume(i).powi(2) / *n as f64);
        }
        Ok(sum.scale(1.0 / f64::from(self.replicates)))
    }
}

impl Stratified<Plain, Pcg> {
    /// σ_i².
    fn variance_in<D, G>(&self, integral: &Integral<D, G>, rule: &Gauss, i: usize) -> Result<G::Value, Error>
    where
        D: Domain,
        G: Source<Point = D::Point>,
    {
        let domain = integral.domain();
        if domain.states() != 1 || domain.dimension() < self.strata.dimension() {
            let requirement = "variances are predicted for one state and no more axes of strata than dimensions";
            return Err(Error::invalid("axes of strata", self.strata.dimension() as f64, requirement));
        }
        let sides: Vec<_> = self.strata.sides(i).chain(std::iter::repeat((0.0, 1.0))).take(domain.dimension()).collect();
        let unit = composite_unit_rule(rule.panels, rule.order);
        let score = |index: usize| {
            let (mut rest, mut weight, mut axis) = (index, 1.0, 0);
            let node = domain.place(0, || {
                let n = unit[rest % unit.len()];
                rest /= unit.len();
                weight *= n.weight;
                axis += 1;
                sides[axis - 1].0 + n.point * (sides[axis - 1].1 - sides[axis - 1].0)
            });
            (integral.integrand().eval(&node.point).scale(node.weight), weight)
        };
        let count = unit.len().pow(domain.dimension() as u32);
        let (mut mean, mut variance) = (G::Value::ZERO, G::Value::ZERO);
        (0..count).map(score).for_each(|(y, w)| mean += y.scale(w));
        (0..count).map(score).for_each(|(y, w)| variance += (y - mean).map(|d| d * d).scale(w));
        if !variance.all_finite() {
            return Err(Error::NonFiniteIntegrand { at: format!("stratum {i}"), value: format!("{mean:?}") });
        }
        Ok(variance)
    }
}
