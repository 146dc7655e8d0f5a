//! Next event and the walk's own hits with optimal weights.
//!
//! ```text
//! Y = Y_w + Σ_n α W_n [ π/(q + π) (X_n, ζ_n)  −  1{survive} q/(q + π) (X_n, X_{n+1}) ]           theory (4.4.8), α = α_q − α_π
//! ```
//!
//! Derivation: both terms of the bracket, where W_n K ≠ 0, have the mean ∫_{K ≠ 0} qπ/(q + π), whatever part of the space either density covers, so Y is
//! unbiased for every α. (Where K = 0, π need not be what it says: scenes do not ask who hides behind a wall.) With the balance heuristic in Y_w the weights of
//! (Tg)(X_n) become w_q = q/(q + π) + α qπ/((q + π) K g), which may be negative: the least variance of all weights is reached by one of them, and is 0 where
//! K g = α_q q + α_π π. α is a constant of the run, from the regression of Y on the bracket's sum over whole walks in a pilot on points of its own: best for the
//! walk's score, and exactly Kondapaneni's for paths of one step from a point; 0, which is the heuristic, where the halves of the pilot do not confirm each
//! other. Costs the densities q and π at *every* vertex, where heuristics ask for them only if g ≠ 0. Reference: Kondapaneni, Vévoda, Grittmann, Skřivan,
//! Slusallek, Křivánek, *Optimal multiple importance sampling*, ACM Trans. Graph. 38 (2019) 37.

use super::next_event::{along, edge};
use super::{Arrival, Heuristic, Mis, Scoring, Technique, Visit};
use crate::contained::contained;
use crate::detector::Detector;
use crate::equation::{Equation, Query};
use crate::error::Error;
use crate::estimator::{coefficients, score_block};
use crate::kernel::{Density, Kernel, Operator, Transition, TransitionPdf};
use crate::sampling::{Sampler, Sequence, pilot_points};
use crate::source::SampleSource;
use crate::value::{Value, Weight};
use crate::walk::estimator::WalkEstimator;
use crate::walk::{Ending, Observer, Walk};

/// [`Mis`] with the control of a pilot; see [`Query::optimal`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OptimalMis<V = f64> {
    base: Mis,
    alpha: V,
}

impl<V: Value> OptimalMis<V> {
    /// α, by components.
    #[must_use]
    pub fn alpha(&self) -> V {
        self.alpha
    }

    /// What the control is added to.
    pub(crate) fn base(&self) -> Mis {
        self.base
    }

    /// α W share, by components.
    #[inline]
    fn control<W: Weight<Value = V>>(&self, weight: W, share: f64) -> V {
        weight.apply(V::from_components(|_| share)).zip(self.alpha, |w, a| w * a)
    }
}

impl<G, K> Scoring<G, K> for OptimalMis<G::Value>
where
    G: SampleSource,
    K: Kernel + TransitionPdf + Operator<Point = G::Point>,
    K::Weight: Weight<Value = G::Value>,
{
    const EVALUATIONS: u64 = 1;

    #[inline]
    fn arrival<O: Observer<K::Point, K::Weight>>(
        &self,
        equation: &Equation<G, K>,
        visit: &Visit<K::Point, K::Weight>,
        arrival: Arrival<K::Point, K::Weight>,
        score: &mut G::Value,
        observer: &mut O,
    ) {
        self.base.arrival(equation, visit, arrival, score, observer);
        let Arrival::Step { from, carried, .. } = arrival else { return };
        if visit.weight.norm() == 0.0 {
            return;
        }
        let pi = match arrival.density() {
            Density::Known(pdf) => pdf,
            Density::Deferred(survival) => survival * equation.kernel().pdf(&from, &visit.point),
            Density::Singular | Density::Unstated => return,
        };
        let q = equation.source().pdf_for(&from, &visit.point);
        let control = self.control(carried, -Heuristic::Balance.share(q, pi, Technique::First));
        observer.score(&control);
        *score += control;
    }

    #[inline]
    fn vertex<S: Sampler, O: Observer<K::Point, K::Weight>>(
        &self,
        equation: &Equation<G, K>,
        visit: &Visit<K::Point, K::Weight>,
        u: &mut S,
        score: &mut G::Value,
        observer: &mut O,
    ) {
        let Some(event) = equation.source().sample_for(&visit.point, u) else { return };
        let (q, pi) = (1.0 / event.weight, visit.survival * equation.kernel().pdf(&visit.point, &event.point));
        let share = self.base.0.share(q, pi, Technique::First);
        let k = edge(equation.kernel(), &visit.point, &event.point, observer);
        *score += along(equation, visit, (&event.point, k), share * event.weight, observer);
        if visit.weight.then(k).norm() == 0.0 {
            return;
        }
        let control = self.control(visit.weight, Heuristic::Balance.share(pi, q, Technique::Second));
        observer.score(&control);
        *score += control;
    }

    fn validate<E: Ending<K>>(&self, equation: &Equation<G, K>, ending: &E) -> Result<(), Error> {
        Scoring::<G, K>::validate(&self.base, equation, ending)
    }
}

impl<G, K, D> Query<'_, G, K, D>
where
    G: SampleSource,
    K: Kernel + Transition + TransitionPdf + Operator<Point = G::Point>,
    K::Weight: Weight<Value = G::Value>,
    D: Detector<Point = G::Point>,
{
    /// The walk with the optimal weights that a pilot of `pilot` walks finds, all cells together: a method like others, for this equation and detector. What the
    /// pilot costs is not part of its estimates.
    ///
    /// ```
    /// use fredholm::{Equation, Walk};
    /// // next event by a table of g, steps to anywhere: where both have one density there is nothing to choose
    /// let eq = Equation::on_interval(0.0..=1.0, |x| (3.0 * x).exp(), |x, y| 0.5 * x * (-y).exp()).tabulated_source(16)?;
    /// let (query, walk) = (eq.at(0.5), Walk::mis().depth(1));
    /// let best = query.optimal(&walk, 1024)?;
    /// let (balance, best) = (query.solve(&walk)?, query.solve(&best)?);
    /// assert!(best.variance() < balance.variance());
    /// assert!((best.value - balance.value).abs() < 5.0 * balance.std_error.unwrap());
    /// # Ok::<(), fredholm::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Invalid`] for a pilot of fewer than two walks; whatever can be refused before the first walk, and the pilot's own faults.
    pub fn optimal<E, Q>(&self, walk: &Walk<Mis, E, Q>, pilot: u64) -> Result<Walk<OptimalMis<G::Value>, E, Q>, Error>
    where
        E: Ending<K>,
        Q: Sequence,
    {
        if pilot < 2 {
            return Err(Error::invalid("pilot", pilot as f64, "must be at least 2 walks"));
        }
        Error::held("pilot", pilot)?;
        let alpha = contained(|| self.control(walk, pilot))?;
        Ok(walk.scored_by(OptimalMis { base: walk.scoring, alpha }))
    }

    /// α of a pilot.
    fn control<E, Q>(&self, walk: &Walk<Mis, E, Q>, pilot: u64) -> Result<G::Value, Error>
    where
        E: Ending<K>,
        Q: Sequence,
    {
        let scored = |share: f64| {
            let walk = walk.scored_by(OptimalMis { base: walk.scoring, alpha: G::Value::from_components(|_| share) });
            let (bound, points) = (WalkEstimator::bind(self, &walk)?, pilot_points(&walk.sequence));
            let cells = self.detector().cells() as u64;
            let cell = |j: u64| Ok(score_block(&bound, &points, j as usize, (j, 0), 0..pilot.div_ceil(cells))?.scores);
            Ok::<_, Error>((0..cells).map(cell).collect::<Result<Vec<_>, Error>>()?.concat())
        };
        let (plain, both) = (scored(0.0)?, scored(1.0)?);
        let mut alpha = vec![0.0; G::Value::COMPONENTS];
        for (c, alpha) in alpha.iter_mut().enumerate() {
            let control: Vec<f64> = both.iter().zip(&plain).map(|(b, p)| b.component(c) - p.component(c)).collect();
            let scores: Vec<f64> = plain.iter().map(|p| p.component(c)).collect();
            let unexplained = || Error::NonFiniteScore { sample: 0, replicate: 0, score: "the pilot's sums".into() };
            *alpha = coefficients(&[control], &scores).ok_or_else(unexplained)?[0];
        }
        Ok(G::Value::from_components(|c| alpha[c]))
    }
}
