//! Fredholm's alternative: what is known of an equation that has no unique solution.
//!
//! ```text
//! 1 ∈ spec T:   φ = T φ,  ψ = T†ψ,     f = g + T f  has solutions  ⇔  ⟨ψ, g⟩ = 0 for every such ψ,   and then f + Σ c_k φ_k as well
//! ```
//!
//! φ and ψ are the singular vectors of W^{½}(I − T_n)W^{−½} for singular values near 0, orthonormal in L² (Kress, *Linear integral equations*, ch. 4; Golub,
//! Van Loan, §5.5).

use super::class::{Diagonal, classify};
use super::grid::Grid;
use super::nystrom::graded_breaks;
use crate::domain::Domain;
use crate::equation::Equation;
use crate::error::Error;
use crate::kernel::{HasDomain, Kernel, Operator};
use crate::source::Source;
use crate::value::{Value, Weight};
use nalgebra::{DMatrix, DVector};
use std::fmt;

/// Null functions of I − T and the condition under which f = g + T f has solutions; part of [`Error::Singular`].
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Alternative {
    /// Smallest singular value of I − T on the nodes: how close 1 is to being an eigenvalue, in L².
    pub smallest: f64,
    /// The nodes, as printed by their `Debug`.
    pub places: Vec<String>,
    /// Functions φ_k with φ_k = T φ_k, ∫ φ_k² = 1, at the places: all components of the first place, of the second, …
    pub null: Vec<Vec<f64>>,
    /// ⟨ψ_k, g⟩/(‖ψ_k‖ ‖g‖): solutions exist only if all are 0.
    pub solvability: Vec<f64>,
}

/// Singular values that count as 0 beside the smallest.
const CLOSE: f64 = 8.0;
const ZERO: f64 = 1e-10;
/// No singular value is 0 if the smallest is more than this, and I − T is ill-conditioned by its norm if that is large.
const NULL: f64 = 1e-4;
const LARGE: f64 = 1e6;
/// Singular values below this share of the largest are rounding.
const LOST: f64 = 1e-14;
/// Unknowns of the decomposition.
const UNKNOWNS: usize = 240;

impl Alternative {
    /// Whether ⟨ψ, g⟩ = 0 as far as the smallest singular value tells: solutions exist, but more than one.
    #[must_use]
    pub fn is_solvable(&self) -> bool {
        self.solvability.iter().all(|s| s.abs() <= (CLOSE * self.smallest).max(ZERO))
    }
}

impl fmt::Display for Alternative {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let functions = if self.null.len() == 1 { "function" } else { "functions" };
        let largest = self.solvability.iter().fold(0.0f64, |m, s| m.max(s.abs()));
        write!(f, "1 is an eigenvalue of T, with {} null {functions} (|φ − Tφ| ≤ {:.1e} |φ|); ", self.null.len(), self.smallest)?;
        write!(f, "f exists only if ⟨ψ, g⟩ = 0 for ψ = T†ψ, and here |⟨ψ, g⟩| = {largest:.1e} |ψ| |g|: ")?;
        write!(f, "{}", if self.is_solvable() { "solutions exist, and are not unique" } else { "there is no solution" })
    }
}

/// The same error with what can be said about null functions; errors of any other kind as they are.
pub(super) fn explained<G, K>(equation: &Equation<G, K>, error: Error) -> Error
where
    G: Source,
    K: Kernel + HasDomain + Operator<Point = G::Point>,
    K::Weight: Weight<Value = G::Value>,
{
    match error {
        // on infinite domains T need not be compact: 1 may lie in a continuous spectrum, without null functions
        Error::Singular { rcond, unknowns, alternative: None } if !equation.kernel().domain().volume().is_finite() => {
            Error::ContinuousSpectrum { rcond, unknowns }
        }
        Error::Singular { rcond, unknowns, alternative: None } => match alternative(equation).ok().flatten() {
            Some((found, norm)) if norm > LARGE && (found.smallest > NULL || found.smallest <= LOST * norm) => Error::FirstKind { norm },
            // no null function: the system was singular, of values too different in size
            found => {
                let alternative = found.map(|(found, _)| found).filter(|found| found.smallest <= NULL).map(Box::new);
                Error::Singular { rcond, unknowns, alternative }
            }
        },
        other => other,
    }
}

fn grid<K: Kernel + HasDomain>(kernel: &K, components: usize) -> Result<Grid<K::Point>, Error> {
    let domain = kernel.domain();
    let nodes = (UNKNOWNS / (components * domain.states())).max(8);
    if domain.dimension() > 1 {
        return Grid::plain(domain, 1, (nodes as f64).powf(1.0 / domain.dimension() as f64).max(2.0) as usize);
    }
    if matches!(classify(kernel)?.diagonal, Diagonal::Smooth) {
        return Grid::plain(domain, 1, nodes / 2);
    }
    const ORDER: usize = 10;
    let levels = (nodes / ORDER).saturating_sub(4) / 2;
    Grid::panelled(domain, graded_breaks(&[0.0, 1.0], 2, levels.min(12)), ORDER)
}

/// With the largest singular value of I − T; `None` if the decomposition does not end.
fn alternative<G, K>(equation: &Equation<G, K>) -> Result<Option<(Alternative, f64)>, Error>
where
    G: Source,
    K: Kernel + HasDomain + Operator<Point = G::Point>,
    K::Weight: Weight<Value = G::Value>,
{
    let (kernel, c) = (equation.kernel(), G::Value::COMPONENTS);
    let grid = grid(kernel, c)?;
    let n = grid.nodes.len() * c;
    let (rows, _) = grid.matrix(kernel)?;
    let root = |i: usize| grid.nodes[i / c].weight.sqrt();
    let a = DMatrix::from_fn(n, n, |i, j| (if i == j { 1.0 } else { 0.0 }) - rows[i * n + j] * root(i) / root(j));
    let g = DVector::from_fn(n, |i, _| equation.source().eval(&grid.nodes[i / c].point).component(i % c) * root(i));
    let Some(svd) = a.try_svd(true, true, f64::EPSILON, 0) else { return Ok(None) };
    let (Some(u), Some(vt)) = (&svd.u, &svd.v_t) else { return Ok(None) };
    let smallest = svd.singular_values.min();
    let zero = (CLOSE * smallest).max(ZERO);
    let nulls: Vec<usize> = (0..n).filter(|k| svd.singular_values[*k] <= zero).collect();
    let size = g.norm();
    let found = Alternative {
        smallest,
        places: grid.nodes.iter().map(|n| format!("{:?}", n.point)).collect(),
        null: nulls.iter().map(|&k| (0..n).map(|i| vt[(k, i)] / root(i)).collect()).collect(),
        solvability: nulls.iter().map(|&k| if size == 0.0 { 0.0 } else { u.column(k).dot(&g) / size }).collect(),
    };
    Ok(Some((found, svd.singular_values.max())))
}
