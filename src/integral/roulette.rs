//! Russian roulette for a single integral.
//!
//! ```text
//! ⟨I⟩ = ξ < P ? score(ξ/P, …)/P : 0,        V' = (V + I²)/P − I² ≥ V                                                  theory (4.2.4)
//! ```
//!
//! The uniform that decided is used again, rescaled: one coordinate less, which quasi-Monte Carlo likes. The variance always rises; it pays where the
//! integrand costs more than everything else, V'·(P·cost) < V·cost. Reference: Arvo, Kirk, *Particle transport and image synthesis*, SIGGRAPH 1990.

use super::predict::Predict;
use super::{Integral, Primary};
use crate::domain::{Domain, Node};
use crate::error::Error;
use crate::sampling::{Pcg, Purpose, Sampler};
use crate::source::Source;
use crate::value::Value;

/// Another primary estimator with probability P, divided by P.
///
/// ```
/// use fredholm::integral::{Integral, Plain, Roulette, Secondary};
/// let i = Integral::on_interval(0.0..=1.0, |x| x * x).solve(&Secondary::new(Roulette::new(Plain, 0.25)))?;
/// assert!(i.agrees_with(1.0 / 3.0, 5.0) && i.evaluations < i.samples() / 3);
/// # Ok::<(), fredholm::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Roulette<P> {
    primary: P,
    survival: f64,
}

impl<P> Roulette<P> {
    /// `primary` with probability `survival` ∈ (0, 1].
    #[must_use]
    pub fn new(primary: P, survival: f64) -> Self {
        Roulette { primary, survival }
    }
}

/// A sampler whose first coordinate is given.
struct Headed<'a, S> {
    head: Option<f64>,
    rest: &'a mut S,
}

impl<S: Sampler> Sampler for Headed<'_, S> {
    #[inline]
    fn next_1d(&mut self) -> f64 {
        self.head.take().unwrap_or_else(|| self.rest.next_1d())
    }
    fn seek(&mut self, vertex: u64, purpose: Purpose) {
        self.rest.seek(vertex, purpose);
    }
}

impl<D: Domain, V: Value, P: Primary<D, V>> Primary<D, V> for Roulette<P> {
    #[inline]
    fn score<S: Sampler>(&self, domain: &D, f: &impl Fn(&D::Point) -> V, u: &mut S) -> V {
        let xi = u.next_1d();
        if xi >= self.survival {
            return V::ZERO;
        }
        // ξ < P, and so is the rounded quotient below 1: numbers below P are by P 2⁻⁵³ or more
        let head = Some(xi / self.survival);
        self.primary.score(domain, f, &mut Headed { head, rest: u }).scale(1.0 / self.survival)
    }

    fn validate(&self) -> Result<(), Error> {
        if !(self.survival > 0.0 && self.survival <= 1.0) {
            return Err(Error::invalid("roulette survival probability", self.survival, "must lie in (0, 1]"));
        }
        self.primary.validate()
    }

    fn tuned<G>(&self, integral: &Integral<D, G>, points: &Pcg) -> Result<(Self, u64), Error>
    where
        G: Source<Point = D::Point, Value = V>,
    {
        let (primary, spent) = self.primary.tuned(integral, points)?;
        Ok((Roulette { primary, ..*self }, spent))
    }
}

impl<D: Domain, V: Value, P: Predict<D, V>> Predict<D, V> for Roulette<P> {
    fn moments(&self, domain: &D, nodes: &[Node<D::Point>], f: &dyn Fn(&D::Point) -> V) -> Result<(V, V), Error> {
        let (mean, variance) = self.primary.moments(domain, nodes, f)?;
        Ok((mean, variance.zip(mean, |v, i| v / self.survival + i * i * (1.0 / self.survival - 1.0))))
    }
}
