//! A coarse inverse of I − T: what makes GMRES need few steps, however many unknowns.
//!
//! ```text
//! M = I + P [(I − T_c)⁻¹ − I] R,    T_c = R T P,   R P = I                  Atkinson 1997, §6.2; Brakhage, Numer. Math. 2 (1960) 183
//! ```
//!
//! P spans polynomials of low degree on blocks of consecutive nodes, orthonormal in the weights of the rule; R = Pᵀ W. T smooths: T (I − P R) is small,
//! and (I − T) M differs from I by about as much.

use super::grid::Grid;
use super::linear::Factor;
use crate::error::Error;
use crate::parallel;
use nalgebra::{DMatrix, DVector};

/// Functions of a block.
const DEGREES: usize = 3;
/// Shortest block, in nodes.
const SHORTEST: usize = 12;
/// Most unknowns of T_c, about.
const MOST: usize = 900;

/// Nodes with their weights, each with several components.
#[derive(Clone, Debug)]
pub(crate) struct Layout {
    weights: Vec<f64>,
    components: usize,
}

impl Layout {
    pub(super) fn of<X: crate::domain::Point>(grid: &Grid<X>, components: usize) -> Self {
        Layout { weights: grid.nodes.iter().map(|n| n.weight).collect(), components }
    }

    pub(super) fn unknowns(&self) -> usize {
        self.weights.len() * self.components
    }
}

/// Polynomials on a block of consecutive nodes: values at its nodes, and those times the weights.
#[derive(Clone, Debug)]
struct Block {
    first: usize,
    values: DMatrix<f64>,
    weighted: DMatrix<f64>,
}

impl Block {
    /// Gram–Schmidt in ⟨u, v⟩ = Σ w u v; functions that vanish on the nodes are left out.
    fn new(first: usize, weights: &[f64], degrees: usize) -> Self {
        let n = weights.len();
        let product = |a: &DVector<f64>, b: &DVector<f64>| (0..n).map(|i| weights[i] * a[i] * b[i]).sum::<f64>();
        let mut columns: Vec<DVector<f64>> = Vec::new();
        for degree in 0..degrees.min(n) {
            let mut v = DVector::from_fn(n, |i, _| ((2 * i + 1) as f64 / n as f64 - 1.0).powi(degree as i32));
            for _ in 0..2 {
                for q in &columns {
                    let part = product(q, &v);
                    v.axpy(-part, q, 1.0);
                }
            }
            let size = product(&v, &v).sqrt();
            if size > 0.0 && size.is_finite() {
                columns.push(v / size);
            }
        }
        if columns.is_empty() {
            columns.push(DVector::zeros(n));
        }
        let values = DMatrix::from_columns(&columns);
        let weighted = DMatrix::from_fn(n, values.ncols(), |i, k| weights[i] * values[(i, k)]);
        Block { first, values, weighted }
    }
}

/// P, R and (I − T_c)⁻¹.
#[derive(Clone, Debug)]
pub(super) struct Coarse {
    blocks: Vec<Block>,
    components: usize,
    inverse: Factor,
}

impl Coarse {
    /// From the rows of T.
    pub(super) fn of_rows(rows: &[f64], layout: &Layout) -> Result<Self, Error> {
        let (n, c) = (layout.unknowns(), layout.components);
        let length = SHORTEST.max((DEGREES * n).div_ceil(MOST));
        let blocks = blocks(&layout.weights, length, DEGREES);
        // T P row by row, then R (T P)
        let size: usize = blocks.iter().map(|b| b.values.ncols()).sum::<usize>() * c;
        let products = parallel::map(n, |i| restrict_values(&blocks, c, &rows[i * n..(i + 1) * n]));
        let mut small = DMatrix::zeros(size, size);
        let mut at = 0;
        for b in &blocks {
            for k in 0..b.values.ncols() {
                for a in 0..c {
                    for i in 0..b.values.nrows() {
                        let w = b.weighted[(i, k)];
                        let row = &products[(b.first + i) * c + a];
                        small.row_mut(at).iter_mut().zip(row).for_each(|(s, t)| *s += w * t);
                    }
                    at += 1;
                }
            }
        }
        let inverse = Factor::new(DMatrix::identity(size, size) - small)?;
        Ok(Coarse { blocks, components: c, inverse })
    }

    /// From Σ_{i ∈ I} Σ_{j ∈ J} T_ij over blocks of equal weights: constants on each.
    pub(super) fn of_block_sums(
        n: usize,
        weight: f64,
        length: usize,
        sum: impl Fn((usize, usize), (usize, usize)) -> f64,
    ) -> Result<Self, Error> {
        let blocks = blocks(&vec![weight; n], length, 1);
        let ends = |b: &Block| (b.first, b.first + b.values.nrows());
        let entry = |i: usize, j: usize| {
            let (a, b) = (&blocks[i], &blocks[j]);
            a.weighted[(0, 0)] * b.values[(0, 0)] * sum(ends(a), ends(b))
        };
        let size = blocks.len();
        let small = DMatrix::from_fn(size, size, |i, j| (if i == j { 1.0 } else { 0.0 }) - entry(i, j));
        Ok(Coarse { inverse: Factor::new(small)?, blocks, components: 1 })
    }

    pub(super) fn unknowns(&self) -> usize {
        self.inverse.unknowns()
    }

    /// M r.
    pub(super) fn apply(&self, r: &DVector<f64>) -> DVector<f64> {
        let down = self.down(r, |b| &b.weighted);
        let up = self.inverse.solve(&down) - &down;
        self.up(r, &up, |b| &b.values)
    }

    /// Mᵀ r.
    pub(super) fn apply_transposed(&self, r: &DVector<f64>) -> DVector<f64> {
        let down = self.down(r, |b| &b.values);
        let up = self.inverse.solve_transposed(&down) - &down;
        self.up(r, &up, |b| &b.weighted)
    }

    fn down(&self, r: &DVector<f64>, functions: impl Fn(&Block) -> &DMatrix<f64>) -> DVector<f64> {
        let c = self.components;
        let mut out = Vec::with_capacity(self.unknowns());
        for b in &self.blocks {
            for column in functions(b).column_iter() {
                for a in 0..c {
                    out.push(column.iter().enumerate().map(|(i, p)| p * r[(b.first + i) * c + a]).sum());
                }
            }
        }
        DVector::from_vec(out)
    }

    fn up(&self, r: &DVector<f64>, coefficients: &DVector<f64>, functions: impl Fn(&Block) -> &DMatrix<f64>) -> DVector<f64> {
        let (c, mut out, mut at) = (self.components, r.clone(), 0);
        for b in &self.blocks {
            for column in functions(b).column_iter() {
                for a in 0..c {
                    let s = coefficients[at];
                    column.iter().enumerate().for_each(|(i, p)| out[(b.first + i) * c + a] += s * p);
                    at += 1;
                }
            }
        }
        out
    }
}

fn blocks(weights: &[f64], length: usize, degrees: usize) -> Vec<Block> {
    weights.chunks(length).enumerate().map(|(i, w)| Block::new(i * length, w, degrees)).collect()
}

/// A row of T times P.
fn restrict_values(blocks: &[Block], c: usize, row: &[f64]) -> Vec<f64> {
    let mut out = Vec::new();
    for b in blocks {
        for column in b.values.column_iter() {
            for a in 0..c {
                out.push(column.iter().enumerate().map(|(i, p)| p * row[(b.first + i) * c + a]).sum());
            }
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::{Coarse, Layout};
    use crate::deterministic::krylov::gmres;
    use crate::deterministic::quadrature::composite_unit_rule;
    use nalgebra::DVector;

    #[test]
    fn products_with_the_transpose_are_those() {
        let rule = composite_unit_rule(10, 8);
        let rows: Vec<f64> = rule.iter().flat_map(|x| rule.iter().map(move |y| y.weight * (x.point + 2.0 * y.point).sin() * 0.4)).collect();
        let layout = Layout { weights: rule.iter().map(|n| n.weight).collect(), components: 1 };
        let m = Coarse::of_rows(&rows, &layout).unwrap();
        let (u, v) = (DVector::from_fn(80, |i, _| (i as f64).cos()), DVector::from_fn(80, |i, _| 1.0 / (1.0 + i as f64)));
        assert!((u.dot(&m.apply(&v)) - v.dot(&m.apply_transposed(&u))).abs() < 1e-13);
    }

    #[test]
    fn few_steps_are_left() {
        let rule = composite_unit_rule(60, 8);
        let love = |t: f64| 0.02 / std::f64::consts::PI / (0.0004 + t * t);
        let rows: Vec<f64> = rule.iter().flat_map(|x| rule.iter().map(move |y| y.weight * love(x.point - y.point))).collect();
        let n = rule.len();
        let layout = Layout { weights: rule.iter().map(|n| n.weight).collect(), components: 1 };
        let m = Coarse::of_rows(&rows, &layout).unwrap();
        let apply = |v: &DVector<f64>| v - DVector::from_fn(n, |i, _| (0..n).map(|j| rows[i * n + j] * v[j]).sum::<f64>());
        let b = DVector::from_element(n, 1.0);
        let plain = gmres(apply, Clone::clone, &b, 1e-12, 200);
        let helped = gmres(apply, |r| m.apply(r), &b, 1e-12, 200);
        assert!(helped.residual <= 1e-12 && 2 * helped.iterations < plain.iterations, "{} {}", helped.iterations, plain.iterations);
        assert!((plain.x - helped.x).amax() < 1e-9);
    }
}
