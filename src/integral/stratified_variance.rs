//! The variance of stratified sampling, by quadrature in every stratum.

use super::secondary::validate;
use super::{Gauss, Integral, Plain, Predictable, Stratified};
use crate::deterministic::quadrature::composite_unit_rule;
use crate::domain::{Domain, Node};
use crate::error::Error;
use crate::sampling::{Pcg, Sampler};
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
            let mut u = OnNode { unit: &unit, rest: index, sides: sides.iter(), weight: 1.0 };
            let node = domain.sample(&mut u);
            (integral.integrand().eval(&node.point).scale(node.weight), u.weight)
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

/// A sampler that reads one node of a tensor rule on a part of the cube: what random points are made of, not the domain's rule, which may have another map.
struct OnNode<'a> {
    unit: &'a [Node<f64>],
    /// the node's number, the axes read so far divided out
    rest: usize,
    sides: std::slice::Iter<'a, (f64, f64)>,
    weight: f64,
}

impl Sampler for OnNode<'_> {
    fn next_1d(&mut self) -> f64 {
        let (lower, upper) = self.sides.next().copied().unwrap_or((0.0, 1.0));
        let node = self.unit[self.rest % self.unit.len()];
        self.rest /= self.unit.len();
        self.weight *= node.weight;
        lower + node.point * (upper - lower)
    }
}
