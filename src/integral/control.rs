//! Control functions.
//!
//! ```text
//! ⟨I⟩ = score(f − αg) + αJ,   J = ∫ g dμ known exactly,        V(α) least at α = Cov(Y_f, Y_g)/Var Y_g: V·(1 − correlation²)
//! ```
//!
//! Y_f and Y_g are the scores of f and g from the same point; since primary estimators are linear in f, their difference is the score of f − αg.
//! α must not come from the scores that it is used for: a pilot finds it on points of its own. J must be exact: estimated from the same sample it
//! cancels and changes nothing (theory (2.2.6)). Reference: Hammersley, Handscomb, *Monte Carlo methods* (1964), §5.5; theory (4.8.7).

use super::draw::Probe;
use super::predict::Predict;
use super::{Integral, Primary};
use crate::domain::{Domain, Node};
use crate::error::Error;
use crate::sampling::{Pcg, PcgSampler, Sampler, Sequence};
use crate::source::Source;
use crate::value::Value;

/// The coefficient α of a control function.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Coefficient<V = f64> {
    /// Given, a number for each component.
    Fixed(V),
    /// The best one, from this many scores of a pilot.
    Pilot(u64),
}

/// Any primary estimator for f − αg, plus α∫g.
///
/// ```
/// use fredholm::integral::{Coefficient, Control, Integral, Plain, Secondary};
/// let integral = Integral::on_interval(0.0..=1.0, f64::exp);
/// // eˣ ≈ 1 + x, whose integral is 3/2
/// let control = Control::new(Plain, |x: &f64| 1.0 + x, 1.5, Coefficient::Pilot(256));
/// let (with, without) = (integral.solve(&Secondary::new(control))?, integral.solve(&Secondary::plain())?);
/// assert!(with.agrees_with(1f64.exp() - 1.0, 5.0) && with.variance() < without.variance().map(|v| v / 40.0));
/// # Ok::<(), fredholm::Error>(())
/// ```
#[derive(Clone, Copy)]
pub struct Control<P, F, V = f64> {
    primary: P,
    g: F,
    integral: V,
    coefficient: Coefficient<V>,
}

impl<P: std::fmt::Debug, F, V: std::fmt::Debug> std::fmt::Debug for Control<P, F, V> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Control { primary, integral, coefficient, .. } = self;
        f.debug_struct("Control")
            .field("primary", primary)
            .field("integral", integral)
            .field("coefficient", coefficient)
            .finish_non_exhaustive()
    }
}

impl<P, F, V> Control<P, F, V> {
    /// The control function `g`, whose integral over the domain is `integral`.
    pub fn new(primary: P, g: F, integral: V, coefficient: Coefficient<V>) -> Self {
        Control { primary, g, integral, coefficient }
    }
}

/// α f, component by component.
fn times<V: Value>(a: V, b: V) -> V {
    a.zip(b, |a, b| a * b)
}

impl<P, F, V: Value> Control<P, F, V> {
    /// α of a tuned estimator.
    fn alpha(&self) -> V {
        match self.coefficient {
            Coefficient::Fixed(alpha) => alpha,
            Coefficient::Pilot(_) => V::ZERO,
        }
    }
}

impl<D, V, P, F> Primary<D, V> for Control<P, F, V>
where
    D: Domain,
    V: Value,
    P: Primary<D, V>,
    F: Fn(&D::Point) -> V + Clone + Send + Sync,
{
    #[inline]
    fn score<S: Sampler>(&self, domain: &D, f: &impl Fn(&D::Point) -> V, u: &mut S) -> V {
        let alpha = self.alpha();
        // g lives on the domain, as f does
        let g = |x: &D::Point| if domain.contains(x) { (self.g)(x) } else { V::ZERO };
        self.primary.score(domain, &|x: &D::Point| f(x) - times(alpha, g(x)), u) + times(alpha, self.integral)
    }

    fn validate(&self) -> Result<(), Error> {
        if !self.integral.all_finite() {
            return Err(Error::invalid("integral of the control function", self.integral.magnitude(), "must be finite"));
        }
        match self.coefficient {
            Coefficient::Fixed(alpha) if !alpha.all_finite() => {
                return Err(Error::invalid("control coefficient", alpha.magnitude(), "must be finite"));
            }
            Coefficient::Pilot(n) if n < 2 => return Err(Error::invalid("pilot samples", n as f64, "must be at least 2")),
            _ => {}
        }
        self.primary.validate()
    }

    fn tuned<G>(&self, integral: &Integral<D, G>, points: &Pcg) -> Result<(Self, u64), Error>
    where
        G: Source<Point = D::Point, Value = V>,
    {
        let (primary, mut spent) = self.primary.tuned(integral, points)?;
        let mut out = Control { primary, ..self.clone() };
        if let Coefficient::Pilot(n) = self.coefficient {
            let (alpha, evaluations) = out.pilot(integral, points, n)?;
            out.coefficient = Coefficient::Fixed(alpha);
            spent += evaluations;
        }
        Ok((out, spent))
    }
}

impl<P: Clone, F, V: Value> Control<P, F, V> {
    /// Cov/Var of `n` pairs of scores.
    fn pilot<D, G>(&self, integral: &Integral<D, G>, points: &Pcg, n: u64) -> Result<(V, u64), Error>
    where
        D: Domain,
        G: Source<Point = D::Point, Value = V>,
        P: Primary<D, V>,
        F: Fn(&D::Point) -> V,
    {
        let (domain, probe) = (integral.domain(), Probe::new(integral));
        let score = |mut u: PcgSampler| {
            let f = self.primary.score(domain, &|x| probe.eval(x), &mut u.clone());
            (f, self.primary.score(domain, &|x| if domain.contains(x) { (self.g)(x) } else { V::ZERO }, &mut u))
        };
        // a cell of its own: the primary's pilot may have read the first
        let pairs: Vec<(V, V)> = points.points(1, 0, 0..n).map(score).collect();
        probe.check()?;
        let mean = |pick: fn(&(V, V)) -> V| {
            let mut sum = V::ZERO;
            pairs.iter().for_each(|p| sum += pick(p));
            sum.scale(1.0 / n as f64)
        };
        let (f, g) = (mean(|p| p.0), mean(|p| p.1));
        let (mut covariance, mut variance) = (V::ZERO, V::ZERO);
        for pair in &pairs {
            covariance += times(pair.0 - f, pair.1 - g);
            variance += times(pair.1 - g, pair.1 - g);
        }
        let alpha = best(covariance, variance);
        if !alpha.all_finite() {
            let score = format!("{:?} in the pilot", pairs[0].1);
            return Err(Error::NonFiniteScore { sample: 0, replicate: 0, score });
        }
        Ok((alpha, probe.count()))
    }
}

/// Cov/Var; a control that does not vary is of no use, and needs no coefficient.
fn best<V: Value>(covariance: V, variance: V) -> V {
    covariance.zip(variance, |c, v| if v == 0.0 { 0.0 } else { c / v })
}

impl<D, V, P, F> Predict<D, V> for Control<P, F, V>
where
    D: Domain,
    V: Value,
    P: Predict<D, V>,
    F: Fn(&D::Point) -> V + Clone + Send + Sync,
{
    /// With a pilot, the variance of the best α: what a pilot without error would find.
    fn moments(&self, domain: &D, nodes: &[Node<D::Point>], f: &dyn Fn(&D::Point) -> V) -> Result<(V, V), Error> {
        let variance = |h: &dyn Fn(&D::Point) -> V| Ok::<V, Error>(self.primary.moments(domain, nodes, h)?.1);
        let alpha = match self.coefficient {
            Coefficient::Fixed(alpha) => alpha,
            Coefficient::Pilot(_) => {
                // Cov(Y_f, Y_g) by polarisation
                let (sum, difference) = (variance(&|x| f(x) + (self.g)(x))?, variance(&|x| f(x) - (self.g)(x))?);
                best((sum - difference).scale(0.25), variance(&|x| (self.g)(x))?)
            }
        };
        let (mean, variance) = self.primary.moments(domain, nodes, &|x| f(x) - times(alpha, (self.g)(x)))?;
        Ok((mean + times(alpha, self.integral), variance))
    }
}
