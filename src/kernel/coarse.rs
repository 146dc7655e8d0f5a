//! |T| on a few nodes, with the mass of every row.
//!
//! One-dimensional kernels may peak or be singular on the diagonal. The discretisation therefore keeps the *row masses*
//! ∫ |K(x_i, y)| dμ(y), computed by a rule graded towards y = x_i, and gives what the coarse nodes miss to the diagonal (singularity
//! subtraction; Kantorovich, Krylov, *Approximate methods of higher analysis*, 1958, ch. II §1.5).

use super::{HasDomain, Kernel};
use crate::deterministic::quadrature::unit_rule;
use crate::domain::{Domain, Node, Point};
use crate::error::Error;
use crate::value::{Value, Weight};
use nalgebra::{DMatrix, DVector};

/// |T| on some nodes.
#[derive(Clone, Debug)]
pub(super) struct Level<X> {
    nodes: Vec<Node<X>>,
    /// |K| in absolute components: block (i, j) is |K(x_i, y_j)| w_j
    pub(super) matrix: DMatrix<f64>,
    /// rows of further places, the ends of the domain among them: a supremum over the nodes alone would miss them
    probes: DMatrix<f64>,
}

impl<X: Point> Level<X> {
    /// sup Σ_{n > depth} |T|ⁿ |g|.
    pub(super) fn remainder<V: Value>(&self, depth: u64, g: &impl Fn(&X) -> V) -> Option<f64> {
        let source = DVector::from_iterator(
            self.matrix.nrows(),
            self.nodes.iter().flat_map(|n| {
                let v = g(&n.point);
                (0..V::COMPONENTS).map(move |i| v.component(i).abs())
            }),
        );
        let identity = DMatrix::identity(self.matrix.nrows(), self.matrix.nrows());
        let mut rest = (identity - &self.matrix).lu().solve(&source)?;
        for _ in 0..depth.min(100_000) {
            rest = &self.matrix * rest;
        }
        Some((&self.matrix * &rest).amax().max((&self.probes * &rest).amax()))
    }
}

/// Rows of |T| at places that are no nodes: next to the ends of every state and between, with the row mass as in the matrix.
fn probe<K: Kernel + HasDomain>(kernel: &K, nodes: &[Node<K::Point>]) -> DMatrix<f64> {
    const PLACES: usize = 17;
    const END: f64 = 1e-9;
    let domain = kernel.domain();
    let c = <<K::Weight as Weight>::Value as Value>::COMPONENTS;
    let mut rows = DMatrix::zeros(c * PLACES * domain.states(), c * nodes.len());
    for i in 0..PLACES * domain.states() {
        let (step, mut axis) = (i % PLACES, 0);
        let x = domain.place(i / PLACES, || {
            axis += 1;
            // corners first where there are several coordinates
            let t = if domain.dimension() == 1 { step as f64 / (PLACES - 1) as f64 } else { (step >> ((axis - 1) % 4) & 1) as f64 };
            // far out on a half line the graded rule could not follow the kernel
            t.clamp(END, if domain.volume().is_finite() { 1.0 - END } else { 1.0 - 1e-4 })
        });
        let x = x.point;
        let entry = |k: K::Weight, a, b| Some(k.entry(a, b).abs()).filter(|k| k.is_finite()).unwrap_or(0.0);
        for (j, y) in nodes.iter().enumerate() {
            let k = kernel.eval(&x, &y.point);
            (0..c * c).for_each(|e| rows[(c * i + e / c, c * j + e % c)] = entry(k, e / c, e % c) * y.weight);
        }
        if domain.dimension() > 1 {
            continue;
        }
        let per_state = nodes.len() / domain.states();
        for state in 0..domain.states() {
            let block = state * per_state..(state + 1) * per_state;
            let distance = |j: &usize| (domain.coordinate(&nodes[*j].point, 0) - domain.coordinate(&x, 0)).abs();
            let Some(near) = block.clone().min_by(|a, b| distance(a).total_cmp(&distance(b))) else { continue };
            // where the graded rule meets a kernel that is not finite, the nodes' own values stand
            for (e, exact) in graded_mass(kernel, &x, state, MASS_ORDERS[0]).unwrap_or_default().iter().enumerate() {
                let seen: f64 = block.clone().map(|j| rows[(c * i + e / c, c * j + e % c)]).sum();
                rows[(c * i + e / c, c * near + e % c)] += (exact - seen).max(0.0);
            }
        }
    }
    rows
}

/// |T| on nodes, with the exact mass of every row in one dimension.
pub(super) fn discretise<K: Kernel + HasDomain>(
    kernel: &K,
    nodes: Vec<Node<K::Point>>,
    mass_order: usize,
) -> Result<Level<K::Point>, Error> {
    let domain = kernel.domain();
    let random = domain.dimension() > 4;
    let c = <<K::Weight as Weight>::Value as Value>::COMPONENTS;
    let mut matrix = DMatrix::zeros(c * nodes.len(), c * nodes.len());
    for (i, x) in nodes.iter().enumerate() {
        for (j, y) in nodes.iter().enumerate() {
            if random && i == j {
                continue;
            }
            let k = kernel.eval(&x.point, &y.point);
            if !k.entries_finite() {
                if same_place(domain, &x.point, &y.point) {
                    continue; // a diagonal singularity: filled from the row mass below
                }
                return Err(Error::non_finite_kernel(&x.point, &y.point, &k));
            }
            for a in 0..c {
                for b in 0..c {
                    matrix[(c * i + a, c * j + b)] = k.entry(a, b).abs() * y.weight;
                }
            }
        }
        if domain.dimension() == 1 {
            keep_row_mass(kernel, &nodes, i, mass_order, &mut matrix)?;
        }
    }
    let probes = probe(kernel, &nodes);
    Ok(Level { nodes, matrix, probes })
}

fn same_place<D: Domain>(domain: &D, x: &D::Point, y: &D::Point) -> bool {
    (0..domain.dimension()).all(|a| domain.coordinate(x, a) == domain.coordinate(y, a))
}

/// Pieces of a row towards the diagonal, each a quarter of the one before: down to 10⁻¹¹ of the domain.
const LEVELS: usize = 18;
/// Gauss nodes a piece for the three discretisations: a kink off the diagonal, where K changes sign, must not bias all of them alike.
pub(super) const MASS_ORDERS: [usize; 3] = [8, 7, 6];
/// Relative error of a graded row mass.
pub(super) const ROW_MASS: f64 = 1e-7;

/// Sets the entries at y = x_i so that each (state, component) block of row i has its exact mass.
fn keep_row_mass<K: Kernel + HasDomain>(
    kernel: &K,
    nodes: &[Node<K::Point>],
    i: usize,
    order: usize,
    matrix: &mut DMatrix<f64>,
) -> Result<(), Error> {
    let domain = kernel.domain();
    let c = <<K::Weight as Weight>::Value as Value>::COMPONENTS;
    let per_state = nodes.len() / domain.states();
    for state in 0..domain.states() {
        // the node of this state at the same place as x_i
        let j = state * per_state + i % per_state;
        for (e, exact) in graded_mass(kernel, &nodes[i].point, state, order)?.iter().enumerate() {
            let (row, column) = (c * i + e / c, c * j + e % c);
            let others: f64 = (state * per_state..(state + 1) * per_state).filter(|&l| l != j).map(|l| matrix[(row, c * l + e % c)]).sum();
            // a coarse rule can overshoot a narrow peak; a negative entry would leave the cone of |T|
            matrix[(row, column)] = (exact - others).max(0.0);
        }
    }
    Ok(())
}

/// ∫ |K(x, y)| dμ(y) over one state, entry by entry, by a rule graded towards y = x.
fn graded_mass<K: Kernel + HasDomain>(kernel: &K, x: &K::Point, state: usize, order: usize) -> Result<Vec<f64>, Error> {
    let domain = kernel.domain();
    let c = <<K::Weight as Weight>::Value as Value>::COMPONENTS;
    let t = domain.coordinate(x, 0);
    let rule = unit_rule(order);
    let mut exact = vec![0.0; c * c];
    for (end, span) in [(-1.0, t), (1.0, 1.0 - t)] {
        let mut outer = span;
        for level in 0..LEVELS {
            let inner = if level == LEVELS - 1 { 0.0 } else { outer * 0.25 };
            for n in rule.iter() {
                let r = inner + (outer - inner) * n.point;
                let y = domain.place(state, || (t + end * r).clamp(f64::MIN_POSITIVE, 1.0 - f64::EPSILON));
                let k = kernel.eval(x, &y.point);
                if !k.entries_finite() {
                    if same_place(domain, x, &y.point) {
                        continue; // r below the spacing of floating-point numbers at x
                    }
                    return Err(Error::non_finite_kernel(x, &y.point, &k));
                }
                let w = n.weight * (outer - inner) * y.weight;
                exact.iter_mut().enumerate().for_each(|(e, s)| *s += w * k.entry(e / c, e % c).abs());
            }
            outer = inner;
        }
    }
    Ok(exact)
}

/// Whether K(x, ·) is zero at 2¹² places of every state and on the way towards y = x, in one dimension.
pub(crate) fn vanishes<K: Kernel + HasDomain>(kernel: &K, x: &K::Point) -> bool {
    const PLACES: usize = 1 << 12;
    let domain = kernel.domain();
    let zero = |y: &K::Point| kernel.eval(x, y).norm() == 0.0;
    let place = |state, i| domain.place(state, || (i as f64 + 0.5) / PLACES as f64).point;
    let near = |state| graded_mass(kernel, x, state, MASS_ORDERS[0]).is_ok_and(|mass| mass.iter().all(|m| *m == 0.0));
    domain.dimension() == 1 && (0..domain.states()).all(|state| near(state) && (0..PLACES).all(|i| zero(&place(state, i))))
}
