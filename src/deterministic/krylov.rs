//! Linear systems known by their products alone: GMRES, Saad, Schultz, *SIAM J. Sci. Stat. Comput.* 7 (1986) 856.
//!
//! ```text
//! x_m = x₀ + M y,  y ∈ span(r₀, AM r₀, …, (AM)^{m−1} r₀),  ‖b − A x_m‖₂ least            M ≈ A⁻¹: right preconditioner
//! ```
//!
//! For A = I − T with compact T the residuals fall faster than any geometric sequence, and the number of steps does not grow with the number of
//! unknowns. A [coarse inverse](super::coarse) lowers it further.

use nalgebra::DVector;

/// Share of A v in new directions up to which A counts as singular.
const SINGULAR: f64 = 1e-14;
/// Vectors kept before a restart from the true residual.
const BASIS: usize = 100;

/// An approximate solution and what is known about it.
#[derive(Clone, Debug)]
pub(crate) struct Iterated {
    pub(crate) x: DVector<f64>,
    /// products with A M
    pub(crate) iterations: usize,
    /// ‖b − A x‖₂/‖b‖₂, from x itself
    pub(crate) residual: f64,
}

/// Solves A x = b to ‖b − A x‖₂ ≤ `tolerance` ‖b‖₂, or as far as it gets: at most `most` products with A M, and no further restart once one gains less
/// than a factor of 2, because A is singular or rounding allows no more. The caller judges the residual.
pub(crate) fn gmres(
    apply: impl Fn(&DVector<f64>) -> DVector<f64>,
    precondition: impl Fn(&DVector<f64>) -> DVector<f64>,
    b: &DVector<f64>,
    tolerance: f64,
    most: usize,
) -> Iterated {
    let size = b.norm();
    let mut best = Iterated { x: DVector::zeros(b.len()), iterations: 0, residual: if size == 0.0 { 0.0 } else { 1.0 } };
    let mut r = b.clone();
    // `!(a <= b)`: a NaN is no convergence
    while !(best.residual <= tolerance) {
        let steps = BASIS.min(most - best.iterations);
        let cycle = Cycle::run(|v| apply(&precondition(v)), &r, tolerance * size, steps);
        let x = &best.x + precondition(&cycle.correction());
        r = b - apply(&x);
        let residual = r.norm() / size;
        let iterations = best.iterations + cycle.columns.len();
        let gained = residual <= 0.5 * best.residual;
        if residual < best.residual {
            best = Iterated { x, iterations, residual };
        }
        if !gained || iterations >= most {
            break;
        }
    }
    best
}

/// Arnoldi's basis of one cycle, and its least-squares problem rotated to a triangular one, R y = q.
struct Cycle {
    basis: Vec<DVector<f64>>,
    /// R, column by column
    columns: Vec<Vec<f64>>,
    /// one longer than R: the last entry is the residual that remains
    q: Vec<f64>,
}

impl Cycle {
    /// At most `steps` products, fewer once the residual is below `target` or the basis spans all that A can reach.
    fn run(apply: impl Fn(&DVector<f64>) -> DVector<f64>, r: &DVector<f64>, target: f64, steps: usize) -> Self {
        let norm = r.norm();
        let mut cycle = Cycle { basis: vec![r / norm], columns: Vec::new(), q: vec![norm] };
        let mut rotations: Vec<(f64, f64)> = Vec::new();
        for k in 0..steps {
            let mut v = apply(&cycle.basis[k]);
            let size = v.norm();
            let (mut column, rest) = cycle.orthogonalise(&mut v);
            for (i, (c, s)) in rotations.iter().enumerate() {
                (column[i], column[i + 1]) = (c * column[i] + s * column[i + 1], c * column[i + 1] - s * column[i]);
            }
            let length = column[k].hypot(rest);
            // nothing but rounding in this direction: A is singular on the basis (a NaN is no progress either)
            if !(length > SINGULAR * size) || length.is_infinite() {
                break;
            }
            let (c, s) = (column[k] / length, rest / length);
            column[k] = length;
            let last = cycle.q[k];
            cycle.q[k] = c * last;
            cycle.q.push(-s * last);
            cycle.columns.push(column);
            rotations.push((c, s));
            if cycle.q[k + 1].abs() <= target || rest == 0.0 {
                break;
            }
            cycle.basis.push(v / rest);
        }
        cycle
    }

    /// Coefficients of v in the basis and the norm of what is left of v. Twice is enough: Giraud et al., *Numer. Math.* 101 (2005) 87.
    fn orthogonalise(&self, v: &mut DVector<f64>) -> (Vec<f64>, f64) {
        let mut h = vec![0.0; self.basis.len()];
        let before = v.norm();
        for _ in 0..2 {
            for (h, e) in h.iter_mut().zip(&self.basis) {
                let part = e.dot(v);
                v.axpy(-part, e, 1.0);
                *h += part;
            }
        }
        let rest = v.norm();
        // only rounding is left
        (h, if rest <= SINGULAR * before { 0.0 } else { rest })
    }

    /// Σ y_i v_i.
    fn correction(&self) -> DVector<f64> {
        let mut y = self.q[..self.columns.len()].to_vec();
        for j in (0..y.len()).rev() {
            y[j] /= self.columns[j][j];
            for i in 0..j {
                y[i] -= self.columns[j][i] * y[j];
            }
        }
        let mut sum = DVector::zeros(self.basis[0].len());
        y.iter().zip(&self.basis).for_each(|(y, v)| sum.axpy(*y, v, 1.0));
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::gmres;
    use crate::deterministic::linear::Factor;
    use crate::deterministic::quadrature::unit_rule;
    use crate::domain::Node;
    use nalgebra::{DMatrix, DVector};

    /// Love's kernel on [0, 1], from the nodes of one rule to those of another.
    fn love(width: f64, to: &[Node<f64>], from: &[Node<f64>]) -> DMatrix<f64> {
        let k = |t: f64| width / std::f64::consts::PI / (width * width + t * t);
        DMatrix::from_fn(to.len(), from.len(), |i, j| from[j].weight * k(to[i].point - from[j].point))
    }

    fn ones(n: usize) -> DVector<f64> {
        DVector::from_element(n, 1.0)
    }

    #[test]
    fn solutions_are_those_of_elimination() {
        for n in [1, 2, 40, 150] {
            let rule = unit_rule(n);
            let a = DMatrix::identity(n, n) - love(0.1, &rule, &rule);
            let b = DVector::from_fn(n, |i, _| (3.0 * rule[i].point).sin());
            let found = gmres(|v| &a * v, Clone::clone, &b, 1e-13, 100);
            assert!(found.residual <= 1e-13 && found.iterations <= n.min(30), "{n}: {found:?}");
            assert!((&found.x - Factor::new(a).unwrap().solve(&b)).amax() < 1e-12, "{n}");
        }
    }

    #[test]
    fn steps_do_not_grow_with_the_unknowns() {
        let steps = |n: usize| {
            let rule = unit_rule(n);
            let t = love(0.05, &rule, &rule);
            gmres(|v| v - &t * v, Clone::clone, &ones(n), 1e-12, 100).iterations
        };
        let few = steps(100);
        assert!(steps(400).abs_diff(few) <= 1, "{few}");
    }

    #[test]
    fn a_coarse_inverse_saves_steps() {
        let (fine, coarse) = (unit_rule(300), unit_rule(100));
        let t = love(0.02, &fine, &fine);
        let (down, up) = (love(0.02, &coarse, &fine), love(0.02, &fine, &coarse));
        let inverse = Factor::new(DMatrix::identity(100, 100) - love(0.02, &coarse, &coarse)).unwrap();
        let two_grid = |r: &DVector<f64>| r + &t * r + &up * inverse.solve(&(&down * r));
        let apply = |v: &DVector<f64>| v - &t * v;
        let plain = gmres(apply, Clone::clone, &ones(300), 1e-12, 200);
        let helped = gmres(apply, two_grid, &ones(300), 1e-12, 200);
        assert!(3 * helped.iterations <= plain.iterations, "{} against {}", helped.iterations, plain.iterations);
        assert!((plain.x - helped.x).amax() < 1e-9);
    }

    #[test]
    fn restarts_keep_what_is_gained() {
        let diagonal = DVector::from_fn(2000, |i, _| 1.0 + i as f64);
        let found = gmres(|v| v.component_mul(&diagonal), Clone::clone, &ones(2000), 1e-10, 2000);
        assert!(found.iterations > super::BASIS, "{}", found.iterations);
        assert!((found.x.component_mul(&diagonal) - ones(2000)).norm() <= 1e-10 * 2000f64.sqrt());
    }

    #[test]
    fn what_cannot_be_solved_shows_in_the_residual() {
        // I − 11ᵀ/n leaves no constant vector within reach
        let mean = |v: &DVector<f64>| v.add_scalar(-v.mean());
        let b = DVector::from_fn(50, |i, _| 1.0 + (i as f64).sin());
        let found = gmres(mean, Clone::clone, &b, 1e-10, 100);
        let least = b.mean() * 50f64.sqrt() / b.norm();
        assert!((found.residual - least).abs() < 1e-12, "1 is in the spectrum: {found:?}");
        let rule = unit_rule(60);
        let t = love(0.05, &rule, &rule);
        for (tolerance, most) in [(0.0, 100), (1e-12, 3), (1e-12, 0)] {
            assert!(gmres(|v| v - &t * v, Clone::clone, &ones(60), tolerance, most).residual > tolerance);
        }
        assert_eq!(gmres(|v| v * f64::NAN, Clone::clone, &b, 1e-10, 100).residual, 1.0);
    }

    #[test]
    fn nothing_to_solve() {
        let found = gmres(Clone::clone, Clone::clone, &DVector::zeros(5), 1e-10, 10);
        assert_eq!((found.x.amax(), found.iterations, found.residual), (0.0, 0, 0.0));
    }
}
