//! Does Σ |T|ⁿ converge? Known before a walk starts (condition (A) of theory §4.1), from a coarse discretisation of |T|.
//!
//! One-dimensional kernels may peak or be singular on the diagonal. The discretisation therefore keeps the *row masses*
//! ∫ |K(x_i, y)| dμ(y), computed by a rule graded towards y = x_i, and gives what the coarse nodes miss to the diagonal (singularity
//! subtraction; Kantorovich, Krylov, *Approximate methods of higher analysis*, 1958, ch. II §1.5).

use super::{HasDomain, Kernel};
use crate::deterministic::erased;
use crate::deterministic::quadrature::unit_rule;
use crate::domain::{Domain, Node, Point};
use crate::error::Error;
use crate::sampling::{Pcg, Sequence};
use crate::statistics::Moments;
use crate::value::{Value, Weight};
use nalgebra::{DMatrix, DVector};
use std::sync::Arc;

/// A spectral radius with its numerical uncertainty.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Radius {
    /// The estimate.
    pub value: f64,
    /// Half-width of the numerical uncertainty, from two discretisations.
    pub uncertainty: f64,
}

impl Radius {
    /// Whether the radius is at least 1 beyond its uncertainty.
    pub fn diverges(&self) -> bool {
        self.value - self.uncertainty >= 1.0
    }
}

/// What is known about Σ |T|ⁿ before a walk.
#[derive(Clone, Debug)]
pub enum Series<X> {
    /// The kernel cannot be evaluated on a domain.
    Unknown,
    /// A coarse discretisation is at hand.
    Known(Arc<Discretised<X>>),
}

/// |T| on coarse nodes.
#[derive(Clone, Debug)]
pub struct Discretised<X> {
    fine: Level<X>,
    /// half the nodes: the difference tells the error
    coarse: Level<X>,
    radius: Radius,
    mass: f64,
}

#[derive(Clone, Debug)]
struct Level<X> {
    nodes: Vec<Node<X>>,
    /// |K| in absolute components: block (i, j) is |K(x_i, y_j)| w_j
    matrix: DMatrix<f64>,
    /// rows of further places, the ends of the domain among them: a supremum over the nodes alone would miss them
    probes: DMatrix<f64>,
}

impl<X: Point> Level<X> {
    /// sup Σ_{n > depth} |T|ⁿ |g|.
    fn remainder<V: Value>(&self, depth: u64, g: &impl Fn(&X) -> V) -> Option<f64> {
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

impl<X: Point> Discretised<X> {
    /// Spectral radius of the operator with kernel |K|.
    pub fn radius(&self) -> Radius {
        self.radius
    }

    /// Largest row mass seen, an estimate of ‖T‖∞.
    pub fn norm(&self) -> f64 {
        self.mass
    }

    /// sup over nodes, ends and further places of Σ_{n > depth} |T|ⁿ |g|, the bias of walks cut at `depth` (theory (4.2.3)), widened by twice
    /// the difference between two discretisations; `None` if the series diverges.
    pub fn truncation_bound<V: Value>(&self, depth: u64, g: impl Fn(&X) -> V) -> Option<f64> {
        if self.radius.value >= 1.0 {
            return None;
        }
        let (fine, coarse) = (self.fine.remainder(depth, &g)?, self.coarse.remainder(depth, &g)?);
        Some(fine.max(coarse) + 2.0 * (fine - coarse).abs()).filter(|b| b.is_finite())
    }
}

/// Most unknowns of the coarse discretisation.
const UNKNOWNS: usize = 96;
/// Independent sets of random nodes from five dimensions on.
const REPLICATES: u32 = 6;
/// The differences between rules that all miss a narrow peak fall short of their error, by a factor of 2 on a peak of width 10⁻⁴.
const SAFETY: f64 = 3.0;
/// Half-width of the uncertainty in standard errors of their mean.
const SIGMAS: f64 = 3.0;

/// Σ |T|ⁿ of any kernel that can be evaluated on a domain: what [`Operator::series`](super::Operator::series) of such a kernel returns.
pub(crate) fn series_of<K: Kernel + HasDomain>(kernel: &K) -> Result<Series<K::Point>, Error> {
    by_values(&erased(kernel))
}

fn by_values<K: Kernel + HasDomain>(kernel: &K) -> Result<Series<K::Point>, Error> {
    kernel.domain().validate()?;
    let components = <<K::Weight as Weight>::Value as Value>::COMPONENTS;
    let budget = (UNKNOWNS / components.max(1) / kernel.domain().states()).max(12);
    let dimension = kernel.domain().dimension();
    let (fine, coarse, radius) = if dimension > 4 { by_random_nodes(kernel, budget)? } else { by_rules(kernel, budget, dimension)? };
    let mass = fine.matrix.row_iter().map(|r| r.sum()).fold(0.0, f64::max);
    Ok(Series::Known(Arc::new(Discretised { fine, coarse, radius, mass })))
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

/// Two discretisations and the radius.
type Levels<X> = (Level<X>, Level<X>, Radius);

/// Tensor Gauss rules of three sizes without a common factor: where K jumps, the error depends on where the nodes fall, and two sizes can agree by luck.
fn by_rules<K: Kernel + HasDomain>(kernel: &K, budget: usize, dimension: usize) -> Result<Levels<K::Point>, Error> {
    let orders = match dimension {
        1 => [budget, (5 * budget).div_ceil(8) + 1, 3 * budget / 8],
        2 => [19, 16, 11].map(|n| ((n * n * budget) as f64 / UNKNOWNS as f64).sqrt().max(4.0) as usize),
        3 => [7, 5, 4],
        _ => [4, 3, 2],
    };
    let level = |i: usize| discretise(kernel, kernel.domain().rule(1, orders[i]), MASS_ORDERS[i]);
    let (fine, coarse, third) = (level(0)?, level(1)?, level(2)?);
    let value = spectral_radius(&fine.matrix);
    let change = |other: &Level<K::Point>| (spectral_radius(&other.matrix) - value).abs();
    let uncertainty = (ROW_MASS * value).max(SAFETY * change(&coarse).max(change(&third)));
    Ok((fine, coarse, Radius { value, uncertainty }))
}

/// Random nodes: the error of the radius is statistical, O(n^{−1/2}). The diagonal is left out, a product of *two* independent nodes; it would bias
/// the radius upwards by ∫ K(x, x)/n.
fn by_random_nodes<K: Kernel + HasDomain>(kernel: &K, budget: usize) -> Result<Levels<K::Point>, Error> {
    let count = (budget + budget / 3).max(32);
    let replicate = |replicate: u32| {
        let node = |i: usize| {
            let n = kernel.domain().sample(&mut Pcg::default().point(u64::MAX, replicate, i as u64));
            Node { point: n.point, weight: n.weight / (count - 1) as f64 }
        };
        discretise(kernel, (0..count).map(node).collect(), MASS_ORDERS[0])
    };
    let mut levels = (0..REPLICATES).map(replicate).collect::<Result<Vec<_>, _>>()?;
    let radii: Vec<f64> = levels.iter().map(|level| spectral_radius(&level.matrix)).collect();
    let moments = Moments::from_scores(&radii);
    let uncertainty = SIGMAS * moments.std_error().unwrap_or(f64::INFINITY) + 1e-12 * moments.mean;
    let (fine, coarse) = (levels.swap_remove(0), levels.swap_remove(0));
    Ok((fine, coarse, Radius { value: moments.mean, uncertainty }))
}

fn discretise<K: Kernel + HasDomain>(kernel: &K, nodes: Vec<Node<K::Point>>, mass_order: usize) -> Result<Level<K::Point>, Error> {
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
const MASS_ORDERS: [usize; 3] = [8, 7, 6];
/// Relative error of a graded row mass.
const ROW_MASS: f64 = 1e-7;

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

/// Spectral radius of a non-negative matrix: power iteration with Collatz–Wielandt bounds, else Gelfand's formula by repeated squaring.
fn spectral_radius(a: &DMatrix<f64>) -> f64 {
    let mut v = DVector::from_element(a.nrows(), 1.0);
    for _ in 0..200 {
        let w = a * &v;
        let ratios = w.iter().zip(v.iter()).map(|(w, v)| w / v);
        let (lo, hi) = ratios.fold((f64::INFINITY, 0.0f64), |(lo, hi), r| (lo.min(r), hi.max(r)));
        let norm = w.amax();
        if norm == 0.0 || (lo > 0.0 && hi - lo <= 1e-9 * hi) {
            return if norm == 0.0 { 0.0 } else { 0.5 * (lo + hi) };
        }
        v = w / norm;
        if v.iter().any(|x| *x <= 1e-100) {
            break; // reducible: the bounds do not close
        }
    }
    gelfand(a.clone())
}

/// ρ = lim ‖A^m‖^{1/m} by repeated squaring, m up to 2³²: right whatever the Jordan form.
///
/// Once A^m, normalised, has rank one, squaring multiplies it by its trace for ever, and the rest of the limit is a geometric series.
pub(crate) fn gelfand(mut a: DMatrix<f64>) -> f64 {
    let (mut log, mut power) = (0.0, 1.0f64);
    let mut last = f64::NAN;
    for _ in 0..32 {
        let norm = a.amax();
        if norm == 0.0 {
            return 0.0;
        }
        if (norm - last).abs() <= 1e-13 * norm {
            return (log + 2.0 * norm.ln() / power).exp();
        }
        log += norm.ln() / power;
        a /= norm;
        a = &a * &a;
        power *= 2.0;
        last = norm;
    }
    log.exp()
}
