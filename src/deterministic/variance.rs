//! The variance and the cost of a walk, predicted before it starts: both are Fredholm equations (theory §4.3).
//!
//! ```text
//! K₂ = K²/(P π)       π the density of a step, P(x) the survival probability                     theory (4.1.7)
//! σ² = ν + K₂ σ²,     ν(x) = ∫ K₂(x, y) f(y)² dμ(y) − ((Tf)(x))²           collision estimator, theory (4.3.3)
//! c  = 1 + P π c      vertices a walk                                                            theory (4.3.4)
//! ```
//!
//! The variance is finite iff ρ(K₂) < 1 and the rows of K₂ are integrable. The radius comes first: beyond it the linear solve still returns
//! finite, even plausible numbers (trap (4.3.8)).

use super::grid::Grid;
use super::linear::Factor;
use super::nystrom::Nystrom;
use crate::domain::Domain;
use crate::equation::Equation;
use crate::error::Error;
use crate::kernel::{HasDomain, Kernel, Operator, TransitionPdf};
use crate::source::Source;
use crate::walk::{Collision, Ending, Walk};
use nalgebra::DVector;

/// Whether the collision estimator has a variance.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum PredictedVariance {
    /// ρ(K₂) < 1.
    Finite,
    /// ρ(K₂) ≥ 1: second moments of the weights grow without bound.
    InfiniteBySeries,
    /// ∫ K²/(Pπ) dμ diverges at the diagonal: one step suffices. The ratio of its integrals over [r, 2r] when r is halved.
    InfiniteAtDiagonal {
        /// 1 for 1/|x − y|.
        ratio: f64,
    },
}

/// Predicted variance and cost of [`Walk::collision`] with a survival that depends on the place alone.
#[derive(Debug)]
pub struct Prediction<'a, G: Source, K: Operator, E> {
    equation: &'a Equation<G, K>,
    ending: E,
    grid: Grid<K::Point>,
    radius: f64,
    verdict: PredictedVariance,
    solution: Vec<f64>,
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
    /// Predicts variance and cost of a collision walk on this equation, by a rule of some hundred unknowns.
    ///
    /// ```
    /// use fredholm::{Equation, Walk, walk::Roulette};
    /// let eq = Equation::on_interval(0.0..=1.0, |_| 1.0, |x, y| 0.5 * x * y);
    /// let walk = Walk::collision().roulette(Roulette::constant(0.5)).samples_per_cell(1 << 16);
    /// let prediction = eq.predict(&walk)?;
    /// assert!((prediction.radius() - 0.1).abs() < 1e-9);             // K₂ = x²y²/2
    /// let measured = eq.at(0.5).solve(&walk)?.variance().unwrap();
    /// assert!((measured / prediction.variance(0.5)?.unwrap() - 1.0).abs() < 0.05);
    /// # Ok::<(), fredholm::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Invalid`] for an ending whose survival depends on more than the place (roulette by throughput, fixed depth); those of a Nyström solve.
    pub fn predict<E: Ending<K>, Q>(&self, walk: &Walk<Collision, E, Q>) -> Result<Prediction<'_, G, K, E>, Error> {
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
    pub fn predict_by<E: Ending<K>, Q>(&self, walk: &Walk<Collision, E, Q>, rule: &Nystrom) -> Result<Prediction<'_, G, K, E>, Error> {
        self.validate()?;
        let ending = *walk.ends_by();
        ending.validate()?;
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
        predict(self, ending, grid)
    }
}

/// Collects g at the nodes.
fn source_values<G: Source<Value = f64>>(source: &G, grid: &Grid<G::Point>) -> Result<DVector<f64>, Error> {
    let mut g = DVector::zeros(grid.nodes.len());
    for (g, n) in g.iter_mut().zip(&grid.nodes) {
        *g = source.eval(&n.point);
        if !g.is_finite() {
            return Err(Error::non_finite_source(&n.point, g));
        }
    }
    Ok(g)
}

fn predict<G, K, E>(equation: &Equation<G, K>, ending: E, grid: Grid<K::Point>) -> Result<Prediction<'_, G, K, E>, Error>
where
    G: Source<Value = f64>,
    K: Kernel + HasDomain + TransitionPdf + Operator<Point = G::Point, Weight = f64>,
    E: Ending<K>,
{
    let (kernel, n) = (equation.kernel(), grid.nodes.len());
    let g = source_values(equation.source(), &grid)?;
    let f = Factor::identity_minus(grid.matrix(kernel)?.0, n)?.solve(&g);
    let density = Paired { kernel, ending, pairing: Pairing::Density };
    let vertices = Factor::identity_minus(grid.matrix(&density)?.0, n)?.solve(&DVector::from_element(n, 1.0));
    let second = Paired { kernel, ending, pairing: Pairing::Second };
    let mut out = Prediction {
        equation,
        ending,
        radius: f64::INFINITY,
        verdict: PredictedVariance::InfiniteBySeries,
        solution: f.as_slice().to_vec(),
        variance: None,
        vertices: vertices.as_slice().to_vec(),
        grid,
    };
    let matrix = match out.grid.matrix(&second) {
        Ok((matrix, _)) => matrix,
        Err(Error::NotIntegrable { ratio, .. }) => {
            out.verdict = PredictedVariance::InfiniteAtDiagonal { ratio };
            return Ok(out);
        }
        Err(e) => return Err(e),
    };
    out.radius = power_iteration(&matrix, n);
    if out.radius.is_nan() || out.radius >= 1.0 - MARGIN {
        return Ok(out);
    }
    let row = |i: usize| &matrix[i * n..(i + 1) * n];
    let nu = DVector::from_fn(n, |i, _| row(i).iter().zip(&f).map(|(k, f)| k * f * f).sum::<f64>() - (f[i] - g[i]).powi(2));
    let variance = Factor::identity_minus(matrix, n)?.solve(&nu);
    // σ² < 0 beyond rounding proves that there is no variance (trap (4.3.8))
    let scale = f.amax().powi(2) + variance.amax();
    if variance.min() >= -MARGIN * scale {
        out.verdict = PredictedVariance::Finite;
        out.variance = Some(variance.as_slice().to_vec());
    }
    Ok(out)
}

impl<G, K, E> Prediction<'_, G, K, E>
where
    G: Source<Value = f64>,
    K: Kernel + HasDomain + TransitionPdf + Operator<Point = G::Point, Weight = f64>,
    E: Ending<K>,
{
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
        let Some(variance) = &self.variance else { return Ok(None) };
        let kernel = self.equation.kernel();
        let second = self.row(&Paired { kernel, ending: self.ending, pairing: Pairing::Second }, &x)?;
        let first = self.row(kernel, &x)?;
        let tf: f64 = first.iter().zip(&self.solution).map(|(k, f)| k * f).sum();
        let carried: f64 = second.iter().zip(self.solution.iter().zip(variance)).map(|(k, (f, v))| k * (f * f + v)).sum();
        Ok(Some(carried - tf * tf))
    }

    /// Expected steps of one walk from x.
    ///
    /// # Errors
    /// [`Error::NonFiniteKernel`] with the place.
    pub fn steps(&self, x: K::Point) -> Result<f64, Error> {
        let density = self.row(&Paired { kernel: self.equation.kernel(), ending: self.ending, pairing: Pairing::Density }, &x)?;
        Ok(density.iter().zip(&self.vertices).map(|(k, c)| k * c).sum())
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

#[derive(Clone, Copy)]
enum Pairing {
    /// K²/(Pπ)
    Second,
    /// Pπ
    Density,
}

/// A kernel made of K, π and P.
struct Paired<'a, K, E> {
    kernel: &'a K,
    ending: E,
    pairing: Pairing,
}

impl<K, E> Operator for Paired<'_, K, E>
where
    K: TransitionPdf + Operator<Weight = f64>,
    E: Ending<K>,
{
    type Point = K::Point;
    type Weight = f64;
}

impl<K, E> Kernel for Paired<'_, K, E>
where
    K: Kernel + TransitionPdf + Operator<Weight = f64>,
    E: Ending<K>,
{
    fn eval(&self, x: &K::Point, y: &K::Point) -> f64 {
        let density = self.ending.survival_at(self.kernel, x).unwrap_or(f64::NAN) * self.kernel.pdf(x, y);
        match self.pairing {
            Pairing::Density => density,
            Pairing::Second => {
                let k = self.kernel.eval(x, y);
                // where K vanishes nothing need be drawn; K ≠ 0 without density breaks condition (S) and gives an infinity, refused with its place
                if k == 0.0 { 0.0 } else { k * k / density }
            }
        }
    }
}

impl<K, E> HasDomain for Paired<'_, K, E>
where
    K: HasDomain + TransitionPdf + Operator<Weight = f64>,
    E: Ending<K>,
{
    type Domain = K::Domain;
    fn domain(&self) -> &K::Domain {
        self.kernel.domain()
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
