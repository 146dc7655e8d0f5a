//! The optimal weights of combined sampling.
//!
//! ```text
//! A_ij = ∫ p_i p_j / Σ_k n_k p_k,   b_i = ∫ f p_i / Σ_k n_k p_k,   A α = b
//! ⟨I⟩  = Σ_i α_i + Σ_i Σ_j [ f(x_ij) − Σ_k α_k p_k(x_ij) ] / Σ_k n_k p_k(x_ij)                                    theory (4.4.8)
//! ```
//!
//! The balance heuristic for f − Σ α_k p_k, whose integral Σ α_k is known: a mixture control. Its variance is the least of all weights, negative ones
//! included; it is 0 for f = Σ α_k p_k. α comes from a pilot: from the same samples it would be biased. A is singular where two densities coincide;
//! the pseudo-inverse serves. Reference: Kondapaneni, Vévoda, Grittmann, Skřivan, Slusallek, Křivánek, *Optimal multiple importance sampling*, ACM
//! Trans. Graph. 38 (2019) 37; Owen, Zhou, *Safe and effective importance sampling*, JASA 95 (2000) 135.

use super::draw::Probe;
use super::{Combined, Integral};
use crate::domain::{Domain, Node, Point};
use crate::error::Error;
use crate::sampling::{Pcg, Sequence};
use crate::source::Source;
use crate::value::Value;
use nalgebra::{DMatrix, DVector};

/// A and b, summed up.
struct Sums {
    a: DMatrix<f64>,
    /// a column for every component
    b: DMatrix<f64>,
}

impl Sums {
    fn new(techniques: usize, components: usize) -> Self {
        Sums { a: DMatrix::zeros(techniques, techniques), b: DMatrix::zeros(techniques, components) }
    }

    /// Adds p_i p_j and f p_i at x, times `factor`.
    fn add<X: Point, V: Value>(&mut self, combined: &Combined<X>, x: &X, f: V, factor: f64) {
        let count = combined.techniques.len();
        let p = DVector::from_fn(count, |k, _| combined.pdf(k, x));
        for i in 0..count {
            for j in 0..count {
                self.a[(i, j)] += p[i] * p[j] * factor;
            }
            for c in 0..V::COMPONENTS {
                self.b[(i, c)] += p[i] * f.component(c) * factor;
            }
        }
    }

    /// α by the pseudo-inverse; `None` if the sums are not finite.
    fn solve(self) -> Option<Vec<Vec<f64>>> {
        if !self.a.iter().chain(self.b.iter()).all(|v| v.is_finite()) {
            return None;
        }
        let count = self.a.nrows();
        // Σ_j n_j A_ij = 1: the rows are of one size, so one threshold serves all
        let svd = self.a.svd(true, true);
        let threshold = 1e-10 * svd.singular_values.max();
        let alpha = svd.solve(&self.b, threshold).ok()?;
        Some((0..count).map(|i| alpha.row(i).iter().copied().collect()).collect())
    }
}

/// α from `n` scores of a pilot, and the evaluations it took.
pub(super) fn pilot<D, G>(
    combined: &Combined<D::Point>,
    integral: &Integral<D, G>,
    points: &Pcg,
    n: u64,
) -> Result<(Vec<Vec<f64>>, u64), Error>
where
    D: Domain,
    G: Source<Point = D::Point>,
{
    let probe = Probe::new(integral);
    let mut sums = Sums::new(combined.techniques.len(), <G::Value as Value>::COMPONENTS);
    for mut u in points.points(0, 0, 0..n) {
        combined.multisample(&mut u, |_, x| {
            let total: f64 = combined.effective(x).sum();
            // the balance estimator of ∫ h/Σ n p: h/(Σ n p)² at every sample
            sums.add(combined, x, probe.eval(x), 1.0 / (total * total * n as f64));
        });
    }
    probe.check()?;
    let alpha = sums.solve().ok_or_else(|| Error::NonFiniteScore { sample: 0, replicate: 0, score: "the pilot's sums".into() })?;
    Ok((alpha, probe.count()))
}

/// α by quadrature: what a pilot without error would find.
pub(super) fn by_quadrature<X: Point, V: Value>(combined: &Combined<X>, nodes: &[Node<X>], f: &dyn Fn(&X) -> V) -> Vec<Vec<f64>> {
    let mut sums = Sums::new(combined.techniques.len(), V::COMPONENTS);
    for n in nodes {
        let total: f64 = combined.effective(&n.point).sum();
        if total > 0.0 {
            sums.add(combined, &n.point, f(&n.point), n.weight / total);
        }
    }
    sums.solve().unwrap_or_else(|| vec![vec![f64::NAN; V::COMPONENTS]; combined.techniques.len()])
}
