//! The variance and the cost of a walk, predicted before it starts: both are Fredholm equations (theory §4.3).
//!
//! ```text
//! K₂ = K²/(P π)       π the density of a step, P(x) the survival probability                     theory (4.1.7)
//! σ² = ν + K₂ σ²,     ν the variance of one step                         theory (4.3.3), (4.3.5)
//! c  = 1 + P π c      vertices a walk                                                            theory (4.3.4)
//! ```
//!
//! The variance is finite iff ρ(K₂) < 1 and the rows of K₂ are integrable. The radius comes first: beyond it the linear solve still returns
//! finite, even plausible numbers (trap (4.3.8)).

use super::grid::Grid;
use super::linear::Factor;
use super::nystrom::Nystrom;
use super::one_step::{Composed, OneStep, Predictable, Rows};
use crate::contained::contained;
use crate::domain::Domain;
use crate::equation::Equation;
use crate::error::Error;
use crate::kernel::{HasDomain, Kernel, Operator, TransitionPdf};
use crate::source::Source;
use crate::walk::{Ending, Walk};
use nalgebra::DVector;

/// Whether a walk has a variance.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum PredictedVariance {
    /// ρ(K₂) < 1.
    Finite,
    /// ρ(K₂) ≥ 1: second moments of the weights grow without bound.
    InfiniteBySeries,
    /// ∫ K²/(Pπ) dμ, or that of K²/q, diverges at the diagonal: one step suffices. The ratio of its integrals over [r, 2r] when r is halved.
    InfiniteAtDiagonal {
        /// 1 for 1/|x − y|.
        ratio: f64,
    },
}

/// Predicted variance and cost of a [`Walk`] with a survival that depends on the place alone.
#[derive(Debug)]
pub struct Prediction<'a, G: Source, K: Operator, C, E> {
    equation: &'a Equation<G, K>,
    scoring: C,
    ending: E,
    grid: Grid<K::Point>,
    radius: f64,
    verdict: PredictedVariance,
    solution: Vec<f64>,
    source: Vec<f64>,
    variance: Option<Vec<f64>>,
    vertices: Vec<f64>,
}

/// Relative amount by which ρ(K₂) must stay below 1: the error of the rule.
const MARGIN: f64 = 1e-6;

impl<G, K> Equation<G, K>
where
    G: Source<Value = f64>,
    K: Kernel + HasDomain + TransitionPdf + Operator<Point = G::Point, Weight = f64>,
{
    /// Predicts variance and cost of a walk on this equation, by a rule of some hundred unknowns: collision, next event, MIS with any heuristic, and with the
    /// weights of a pilot ([`Query::optimal`](crate::Query::optimal)).
    ///
    /// ```
    /// use fredholm::{Equation, Walk, walk::Roulette};
    /// let eq = Equation::on_interval(0.0..=1.0, |_| 1.0, |x, y| 0.5 * x * y);
    /// let walk = Walk::collision().roulette(Roulette::constant(0.5)).samples_per_cell(1 << 16);
    /// let prediction = eq.predict(&walk)?;
    /// assert!((prediction.radius() - 0.1).abs() < 1e-9);             // K₂ = x²y²/2
    /// let measured = eq.at(0.5).solve(&walk)?.variance().unwrap();
    /// assert!((measured / prediction.variance(0.5)?.unwrap() - 1.0).abs() < 0.05);
    /// // which heuristic is the best, before any walk
    /// let mis = Walk::mis().roulette(Roulette::constant(0.5));
    /// assert!(eq.predict(&mis)?.variance(0.5)? < eq.predict(&walk)?.variance(0.5)?);
    /// # Ok::<(), fredholm::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Invalid`] for an ending whose survival depends on more than the place (roulette by throughput, fixed depth); those of a Nyström solve.
    pub fn predict<C, E, Q>(&self, walk: &Walk<C, E, Q>) -> Result<Prediction<'_, G, K, C, E>, Error>
    where
        C: Predictable<G, K>,
        E: Ending<K>,
    {
        match self.kernel().domain().dimension() {
            1 => self.predict_by(walk, &Nystrom::graded(8, 8).levels(6)),
            2 => self.predict_by(walk, &Nystrom::gauss_legendre(16)),
            3 => self.predict_by(walk, &Nystrom::gauss_legendre(7)),
            _ => self.predict_by(walk, &Nystrom::gauss_legendre(4)),
        }
    }

    /// As [`predict`](Equation::predict), by a rule of your choice.
    ///
    /// # Errors
    /// Those of [`predict`](Equation::predict).
    pub fn predict_by<C, E, Q>(&self, walk: &Walk<C, E, Q>, rule: &Nystrom) -> Result<Prediction<'_, G, K, C, E>, Error>
    where
        C: Predictable<G, K>,
        E: Ending<K>,
    {
        contained(|| {
            self.validate()?;
            let (scoring, ending) = (*walk.scores_by(), *walk.ends_by());
            ending.validate()?;
            scoring.validate(self, &ending)?;
            let grid = rule.grid(self.kernel().domain())?;
            for n in &grid.nodes {
                if ending.survival_at(self.kernel(), &n.point).is_none() {
                    return Err(Error::invalid(
                        "ending",
                        f64::NAN,
                        "the variance is predicted for survival that depends on the place alone: constant roulette, Subcritical, OwnAbsorption",
                    ));
                }
            }
            predict(self, (scoring, ending), grid)
        })
    }
}

/// Collects g at the nodes.
pub(super) fn source_values<G: Source<Value = f64>>(source: &G, grid: &Grid<G::Point>) -> Result<DVector<f64>, Error> {
    let mut g = DVector::zeros(grid.nodes.len());
    for (g, n) in g.iter_mut().zip(&grid.nodes) {
        *g = source.eval(&n.point);
        if !g.is_finite() {
            return Err(Error::non_finite_source(&n.point, g));
        }
    }
    Ok(g)
}

fn predict<G, K, C, E>(
    equation: &Equation<G, K>,
    (scoring, ending): (C, E),
    grid: Grid<K::Point>,
) -> Result<Prediction<'_, G, K, C, E>, Error>
where
    G: Source<Value = f64>,
    K: Kernel + HasDomain + TransitionPdf + Operator<Point = G::Point, Weight = f64>,
    C: Predictable<G, K>,
    E: Ending<K>,
{
    let (kernel, n) = (equation.kernel(), grid.nodes.len());
    let g = source_values(equation.source(), &grid)?;
    let first = grid.matrix(kernel)?.0;
    let f = Factor::identity_minus(first.clone(), n)?.solve(&g);
    let step = OneStep { equation, scoring: &scoring, ending: &ending };
    let density = grid.matrix(&Composed::new(kernel, &|x, y| step.density(x, y)))?.0;
    let vertices = Factor::identity_minus(density, n)?.solve(&DVector::from_element(n, 1.0));
    let (solution, source) = (f.as_slice().to_vec(), g.as_slice().to_vec());
    let mut out = Prediction {
        equation,
        scoring,
        ending,
        radius: f64::INFINITY,
        verdict: PredictedVariance::InfiniteBySeries,
        solution,
        source,
        variance: None,
        vertices: vertices.as_slice().to_vec(),
        grid,
    };
    let step = out.step();
    let second = out.grid.matrix(&Composed::new(kernel, &|x, y| step.second(x, y)));
    let event = out.grid.matrix(&Composed::new(kernel, &|x, y| step.event(x, y)));
    let (second, event) = match (second, event) {
        (Ok((second, _)), Ok((event, _))) => (second, event),
        (Err(Error::NotIntegrable { ratio, .. }), _) | (_, Err(Error::NotIntegrable { ratio, .. })) => {
            out.verdict = PredictedVariance::InfiniteAtDiagonal { ratio };
            return Ok(out);
        }
        (Err(e), _) | (_, Err(e)) => return Err(e),
    };
    let radius = power_iteration(&second, n);
    let part = |i: usize| i * n..(i + 1) * n;
    let rows = |i: usize| Rows { first: &first[part(i)], second: &second[part(i)], event: &event[part(i)] };
    let nu = DVector::from_fn(n, |i, _| step.variance(&out.grid.nodes[i].point, &rows(i), &out.grid.nodes, (&out.solution, &out.source)));
    out.radius = radius;
    if radius.is_nan() || radius >= 1.0 - MARGIN {
        return Ok(out);
    }
    let variance = Factor::identity_minus(second, n)?.solve(&nu);
    // σ² < 0 beyond rounding proves that there is no variance (trap (4.3.8))
    let scale = f.amax().powi(2) + variance.amax();
    if variance.min() >= -MARGIN * scale {
        out.verdict = PredictedVariance::Finite;
        out.variance = Some(variance.as_slice().to_vec());
    }
    Ok(out)
}

impl<G, K, C, E> Prediction<'_, G, K, C, E>
where
    G: Source<Value = f64>,
    K: Kernel + HasDomain + TransitionPdf + Operator<Point = G::Point, Weight = f64>,
    C: Predictable<G, K>,
    E: Ending<K>,
{
    fn step(&self) -> OneStep<'_, G, K, C, E> {
        OneStep { equation: self.equation, scoring: &self.scoring, ending: &self.ending }
    }

    /// ρ(K₂); infinite if its rows are not integrable.
    #[must_use]
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// Whether there is a variance.
    #[must_use]
    pub fn verdict(&self) -> PredictedVariance {
        self.verdict
    }

    /// σ²(x) of one walk from x; `None` if infinite.
    ///
    /// # Errors
    /// [`Error::NonFiniteKernel`] with the place.
    pub fn variance(&self, x: K::Point) -> Result<Option<f64>, Error> {
        contained(|| {
            let Some(variance) = &self.variance else { return Ok(None) };
            let (kernel, step) = (self.equation.kernel(), self.step());
            let first = self.row(kernel, &x)?;
            let second = self.row(&Composed::new(kernel, &|x, y| step.second(x, y)), &x)?;
            let event = self.row(&Composed::new(kernel, &|x, y| step.event(x, y)), &x)?;
            let rows = Rows { first: &first, second: &second, event: &event };
            let own = step.variance(&x, &rows, &self.grid.nodes, (&self.solution, &self.source));
            Ok(Some(own + second.iter().zip(variance).map(|(k, v)| k * v).sum::<f64>()))
        })
    }

    /// Expected steps of one walk from x.
    ///
    /// # Errors
    /// [`Error::NonFiniteKernel`] with the place.
    pub fn steps(&self, x: K::Point) -> Result<f64, Error> {
        contained(|| {
            let step = self.step();
            let density = self.row(&Composed::new(self.equation.kernel(), &|x, y| step.density(x, y)), &x)?;
            Ok(density.iter().zip(&self.vertices).map(|(k, c)| k * c).sum())
        })
    }

    /// Efficiency 1/(σ² c) from x with c in steps (theory (4.3.7)), as [`Estimate::efficiency`](crate::Estimate::efficiency) measures it; 0 if the
    /// variance is infinite.
    ///
    /// # Errors
    /// [`Error::NonFiniteKernel`] with the place.
    pub fn efficiency(&self, x: K::Point) -> Result<f64, Error> {
        Ok(self.variance(x)?.map_or(0.0, |v| 1.0 / (v * self.steps(x).unwrap_or(f64::NAN))))
    }

    fn row<P: Kernel<Point = K::Point> + HasDomain>(&self, kernel: &P, x: &K::Point) -> Result<Vec<f64>, Error> {
        if !kernel.domain().contains(x) {
            return Err(Error::Outside { x: format!("{x:?}") });
        }
        let mut row = vec![0.0; self.grid.nodes.len()];
        self.grid.row(kernel, x, &mut row)?;
        Ok(row)
    }
}

/// Largest eigenvalue of the discretised positive operator.
fn power_iteration(rows: &[f64], n: usize) -> f64 {
    let mut v = vec![1.0; n];
    let mut last = 0.0;
    for _ in 0..2000 {
        let w: Vec<f64> = rows.chunks_exact(n).map(|r| r.iter().zip(&v).map(|(k, v)| k * v).sum()).collect();
        let norm = w.iter().fold(0.0f64, |m, w| m.max(w.abs()));
        if norm == 0.0 || (norm - last).abs() <= 1e-12 * norm {
            return norm;
        }
        v = w.iter().map(|w| w / norm).collect();
        last = norm;
    }
    last
}
