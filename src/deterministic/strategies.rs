//! The variance of every strategy of a bidirectional estimator, predicted before the first pair.
//!
//! ```text
//! E C²_{s,t} = ⟨h²/p₀, K₂^{t−1} K² K₂*^{s−1} g²/q₀⟩,      s, t ≥ 1,      K₂ = K²/π,  K₂*(z, x) = K(x, z)²/π*(z, x)             theory (4.1.6), (4.7.4)
//! E C²_{0,t} = ⟨h²/p₀, K₂^{t−1} g²⟩,     E C²_{s,0} = ⟨h², K₂*^{s−1} g²/q₀⟩
//! ```

use super::Nystrom;
use super::grid::Grid;
use super::one_step::Composed;
use super::variance::source_values;
use crate::contained::contained;
use crate::detector::StartPdf;
use crate::domain::{Node, Point};
use crate::equation::Query;
use crate::error::Error;
use crate::kernel::{HasAdjoint, HasDomain, Kernel, Operator, TransitionPdf};
use crate::sampling::{Pcg, Sequence};
use crate::source::{EmitPdf, Source};
use crate::walk::{Bidirectional, Ending, MOST_EDGES};

/// What one strategy alone will find.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct PredictedStrategy {
    /// Vertices from the source.
    pub s: u64,
    /// Vertices from the detector.
    pub t: u64,
    /// ⟨h, T^{s+t−1} g⟩.
    pub mean: f64,
    /// Variance of C_{s,t}; infinite where a row of K², K₂ or K₂* is not integrable, or the strategy misses paths; 0 where the error of the rule leaves less.
    pub variance: f64,
}

impl<G, K, D> Query<'_, G, K, D>
where
    G: EmitPdf<Value = f64, State = <G as Source>::Point>,
    K: Kernel + HasDomain + TransitionPdf + HasAdjoint<Adjoint: TransitionPdf + Operator<Point = G::Point>>,
    K: Operator<Point = G::Point, Weight = f64>,
    D: StartPdf<Point = G::Point>,
{
    /// Predicts mean and variance of the strategies of paths of up to `order` edges, each alone, for the detector's cell `cell`, by `rule`: what
    /// [`strategies`](Query::strategies) measures.
    ///
    /// ```
    /// use fredholm::{Bidirectional, Equation, deterministic::Nystrom, walk::Roulette};
    /// let eq = Equation::on_interval(0.0..=1.0, |_| 1.0, |x, y| 0.5 * x * y);
    /// let walks = Bidirectional::new().roulette(Roulette::constant(0.5)).samples_per_cell(1 << 16);
    /// let (query, rule) = (eq.at(0.5), Nystrom::composite(4, 8));
    /// for (p, m) in query.predict_strategies(&walks, 0, 2, &rule)?.iter().zip(query.strategies(&walks, 0, 2)?) {
    ///     assert_eq!((p.s, p.t), (m.s, m.t));
    ///     // no forward walk hits a point
    ///     assert!(p.t == 0 || (m.alone.variance().unwrap() - p.variance).abs() <= 0.05 * p.variance);
    /// }
    /// # Ok::<(), fredholm::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Invalid`] for a cell that the detector does not have, orders above 64, and endings whose survival depends on more than the place; those of the rule.
    pub fn predict_strategies<E, F, Q>(
        &self,
        walks: &Bidirectional<E, F, Q>,
        cell: usize,
        order: u64,
        rule: &Nystrom,
    ) -> Result<Vec<PredictedStrategy>, Error>
    where
        E: Ending<K>,
        F: Ending<K::Adjoint>,
        Q: Sequence,
    {
        contained(|| {
            let (kernel, source, detector) = (self.equation().kernel(), self.equation().source(), self.detector());
            self.equation().validate()?;
            detector.validate()?;
            if cell >= detector.cells() {
                return Err(Error::invalid("cell", cell as f64, "must be below the detector's number of cells"));
            }
            if order > MOST_EDGES {
                return Err(Error::invalid("order", order as f64, "must be at most 64"));
            }
            let (adjoint, grid, (back, forth)) = (kernel.adjoint()?, rule.grid(kernel.domain())?, walks.ends_by());
            let known = |x| back.survival_at(kernel, x).and(forth.survival_at(&adjoint, x)).is_some();
            if !grid.nodes.iter().all(|n| known(&n.point)) {
                let why =
                    "the variance is predicted for survival that depends on the place alone: constant roulette, Subcritical, OwnAbsorption";
                return Err(Error::invalid("ending", f64::NAN, why));
            }
            let density = |x: &G::Point, y: &G::Point| back.survival_at(kernel, x).unwrap_or(f64::NAN) * kernel.pdf(x, y);
            let reverse = |z: &G::Point, x: &G::Point| forth.survival_at(&adjoint, z).unwrap_or(f64::NAN) * adjoint.pdf(z, x);
            let over = |k: f64, p: f64| if k == 0.0 { 0.0 } else { k * k / p };
            let rows = Rows {
                grid: &grid,
                kernel,
                backward: &|x, y| over(kernel.eval(x, y), density(x, y)),
                forward: &|z, x| over(kernel.eval(x, z), reverse(z, x)),
                joined: &|x, z| kernel.eval(x, z).powi(2),
            };
            let start = detector.start(cell, &mut Pcg::default().point(cell as u64, 0, 0)).point;
            let start = detector.start_pdf(cell, &start).is_infinite().then_some(start);
            let values = |f: &dyn Fn(&G::Point) -> f64| grid.nodes.iter().map(|n| f(&n.point)).collect::<Vec<_>>();
            let ends = Ends {
                g: source_values(source, &grid)?.as_slice().to_vec(),
                h: values(&|x| detector.importance(cell, x)),
                seen: values(&|x| over(detector.importance(cell, x), detector.start_pdf(cell, x))),
                born: values(&|x| over(source.eval(x), source.emit_pdf(x))),
            };
            rows.strategies(&ends, start.map(|x| (x, source.eval(&x))), order)
        })
    }
}

/// g, h, h²/p₀, g²/q₀ at the nodes.
struct Ends {
    g: Vec<f64>,
    h: Vec<f64>,
    seen: Vec<f64>,
    born: Vec<f64>,
}

type Of<'a, X> = &'a (dyn Fn(&X, &X) -> f64 + Sync);

/// K, K₂, K₂* and K².
struct Rows<'a, K: Kernel + HasDomain> {
    grid: &'a Grid<K::Point>,
    kernel: &'a K,
    backward: Of<'a, K::Point>,
    forward: Of<'a, K::Point>,
    joined: Of<'a, K::Point>,
}

/// Values at the nodes, or moments of a row that is not integrable.
type Column = Option<Vec<f64>>;

impl<K: Kernel<Weight = f64> + HasDomain> Rows<'_, K> {
    /// ∫ φ(x_i, ·), row by row; `None` if they are not integrable.
    fn matrix(&self, of: Of<'_, K::Point>) -> Result<Column, Error> {
        match self.grid.matrix(&Composed::new(self.kernel, of)) {
            Ok((matrix, _)) => Ok(Some(matrix)),
            Err(Error::NotIntegrable { .. }) => Ok(None),
            Err(e) => Err(e),
        }
    }

    /// One row; `None` if it is not integrable.
    fn row(&self, of: Of<'_, K::Point>, x: &K::Point) -> Result<Column, Error> {
        let mut row = vec![0.0; self.grid.nodes.len()];
        match self.grid.row(&Composed::new(self.kernel, of), x, &mut row) {
            Ok(_) => Ok(Some(row)),
            Err(Error::NotIntegrable { .. }) => Ok(None),
            Err(e) => Err(e),
        }
    }

    /// ⟨h, Tᵐ g⟩ for m = 0, …, `order`.
    fn means(&self, ends: &Ends, start: Start<K::Point>, order: u64) -> Result<Vec<f64>, Error> {
        let (first, h) = (self.grid.matrix(self.kernel)?.0, weighted(&self.grid.nodes, &ends.h));
        let mut row = vec![0.0; h.len()];
        if let Some((x, _)) = start {
            self.grid.row(self.kernel, &x, &mut row)?;
        }
        let mut term = ends.g.clone();
        let mut means = vec![start.map_or_else(|| dot(&h, &term), |(_, g)| g)];
        for _ in 0..order {
            let next = times(&first, &term);
            means.push(if start.is_some() { dot(&row, &term) } else { dot(&h, &next) });
            term = next;
        }
        Ok(means)
    }

    /// Second moments of the loads of so many vertices of both walks, times the nodes' weights; not of a first vertex that is a point.
    fn moments(&self, ends: &Ends, start: Start<K::Point>, count: u64) -> Result<[Vec<Column>; 2], Error> {
        let (nodes, backward, forward) = (&self.grid.nodes, self.matrix(self.backward)?, self.matrix(self.forward)?);
        let mut seen = vec![start.is_none().then(|| weighted(nodes, &ends.seen))];
        let mut born = vec![Some(weighted(nodes, &ends.born))];
        for n in 1..count as usize {
            seen.push(match start {
                Some((x, _)) if n == 1 => self.row(self.backward, &x)?,
                _ => carried(seen[n - 1].as_ref(), backward.as_ref()),
            });
            born.push(carried(born[n - 1].as_ref(), forward.as_ref()));
        }
        Ok([seen, born])
    }

    /// All (s, t) by order, then by s; `start` is the point of a detector that is one, and g there.
    fn strategies(&self, ends: &Ends, start: Start<K::Point>, order: u64) -> Result<Vec<PredictedStrategy>, Error> {
        let (nodes, means) = (&self.grid.nodes, self.means(ends, start, order)?);
        let [seen, born] = self.moments(ends, start, order + 1)?;
        let joined = self.matrix(self.joined)?;
        let at_start = start.map(|(x, _)| self.row(self.joined, &x)).transpose()?.flatten();
        let squares = |v: &[f64]| v.iter().map(|v| v * v).collect::<Vec<_>>();
        let (gg, hh) = (squares(&ends.g), squares(&ends.h));
        let second = |s: usize, t: usize| match (s, t, start) {
            (_, 0, Some(_)) => None,
            (_, 0, None) => Some(dot(born[s - 1].as_ref()?, &hh)),
            (0, 1, Some((_, g))) => Some(g * g),
            (0, _, _) => Some(dot(seen[t - 1].as_ref()?, &gg)),
            (_, 1, Some(_)) => Some(across(at_start.as_ref()?, born[s - 1].as_ref()?, nodes)),
            _ => {
                let (a, b, k) = (seen[t - 1].as_ref()?, born[s - 1].as_ref()?, joined.as_ref()?);
                Some(k.chunks_exact(nodes.len()).zip(a).map(|(row, a)| a * across(row, b, nodes)).sum())
            }
        };
        let strategy = |(m, s): (u64, u64)| {
            let (t, mean) = (m + 1 - s, means[m as usize]);
            let variance = second(s as usize, t as usize).map_or(f64::INFINITY, |second: f64| second - mean * mean);
            // not `max`, which would make 0 of NaN
            PredictedStrategy { s, t, mean, variance: if variance < 0.0 { 0.0 } else { variance } }
        };
        Ok((0..=order).flat_map(|m| (0..=m + 1).map(move |s| (m, s))).map(strategy).collect())
    }
}

/// The point of a detector that is one, and g there.
type Start<X> = Option<(X, f64)>;

fn weighted<X: Point>(nodes: &[Node<X>], values: &[f64]) -> Vec<f64> {
    nodes.iter().zip(values).map(|(n, v)| n.weight * v).collect()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn times(matrix: &[f64], v: &[f64]) -> Vec<f64> {
    matrix.chunks_exact(v.len()).map(|row| dot(row, v)).collect()
}

/// A row of quadrature on moments that have the nodes' weights in them already.
fn across<X: Point>(row: &[f64], moments: &[f64], nodes: &[Node<X>]) -> f64 {
    row.iter().zip(moments).zip(nodes).map(|((k, b), n)| k * b / n.weight).sum()
}

/// Moments one step on.
fn carried(moments: Option<&Vec<f64>>, matrix: Option<&Vec<f64>>) -> Column {
    let (moments, matrix) = (moments?, matrix?);
    let n = moments.len();
    let mut next = vec![0.0; n];
    for (row, a) in matrix.chunks_exact(n).zip(moments) {
        next.iter_mut().zip(row).for_each(|(next, k)| *next += a * k);
    }
    Some(next)
}
