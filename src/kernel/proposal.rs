//! Where a walk goes when the kernel can only be evaluated: proposals p(x, y), exchangeable without touching the kernel.
//!
//! The step draws y ~ p(x, ·) and carries the weight K(x, y)/p(x, y). Condition (S) of theory §4.1: p(x, y) > 0 wherever
//! K(x, y) (Σ|T|ⁿ|g|)(y) ≠ 0; [`check::transition`](crate::check) looks for violations.

use super::series::series_of;
use super::{Absorbing, HasDomain, Kernel, Operator, RowMass, Series, Step, Transition, TransitionPdf};
use crate::domain::{Domain, Node, Point};
use crate::error::Error;
use crate::sampling::{Sampler, Table};
use crate::value::Weight;
use std::sync::OnceLock;

/// A density p(x, ·) from which the next point is drawn.
///
/// Laws: `sample(x).weight == 1/pdf(x, sample(x).point)`, and ∫ pdf(x, y) dμ(y) = 1: survival belongs to the method, absorption to the kernel.
pub trait Proposal<X: Point>: Send + Sync {
    /// y ~ p(x, ·), with `weight` = 1/p(x, y).
    fn sample<S: Sampler>(&self, x: &X, u: &mut S) -> Node<X>;

    /// p(x, y).
    fn pdf(&self, x: &X, y: &X) -> f64;
}

/// The domain's own density, whatever x: uniform where the volume is finite, the map's density on a half line.
#[derive(Clone, Copy, Debug)]
pub struct Uniform<D> {
    domain: D,
}

impl<D: Domain> Uniform<D> {
    /// Uniform on `domain`.
    #[must_use]
    pub fn on(domain: D) -> Self {
        Uniform { domain }
    }
}

impl<D: Domain> Proposal<D::Point> for Uniform<D> {
    #[inline]
    fn sample<S: Sampler>(&self, _: &D::Point, u: &mut S) -> Node<D::Point> {
        self.domain.sample(u)
    }
    #[inline]
    fn pdf(&self, _: &D::Point, y: &D::Point) -> f64 {
        self.domain.density(y)
    }
}

/// A kernel with the proposal that walks it.
///
/// Never absorbs by itself (theory §4.2: a survival probability hidden in a kernel made the absorption estimator 22 times worse).
#[derive(Debug)]
pub struct Proposed<K: Operator, P> {
    kernel: K,
    proposal: P,
    series: OnceLock<Result<Series<K::Point>, Error>>,
}

impl<K: Operator + Clone, P: Clone> Clone for Proposed<K, P> {
    fn clone(&self) -> Self {
        Proposed { kernel: self.kernel.clone(), proposal: self.proposal.clone(), series: self.series.clone() }
    }
}

impl<K: Operator, P> Proposed<K, P> {
    /// `kernel`, walked by `proposal`.
    pub fn new(kernel: K, proposal: P) -> Self {
        Proposed { kernel, proposal, series: OnceLock::new() }
    }

    /// The kernel.
    pub fn kernel(&self) -> &K {
        &self.kernel
    }

    /// The proposal.
    pub fn proposal(&self) -> &P {
        &self.proposal
    }

    /// The same kernel with another proposal.
    #[must_use]
    pub fn with_proposal<Q>(self, proposal: Q) -> Proposed<K, Q> {
        Proposed { kernel: self.kernel, proposal, series: self.series }
    }
}

impl<K: Kernel + HasDomain, P: Send + Sync> Operator for Proposed<K, P> {
    type Point = K::Point;
    type Weight = K::Weight;
    fn validate(&self) -> Result<(), Error> {
        self.kernel.validate()?;
        self.kernel.domain().validate()
    }
    fn series(&self) -> Result<Series<K::Point>, Error> {
        self.series.get_or_init(|| series_of(&self.kernel)).clone()
    }
}

impl<K: Kernel + HasDomain, P: Send + Sync> Kernel for Proposed<K, P> {
    #[inline]
    fn eval(&self, x: &K::Point, y: &K::Point) -> K::Weight {
        self.kernel.eval(x, y)
    }
}

impl<K: Kernel + HasDomain, P: Send + Sync> HasDomain for Proposed<K, P> {
    type Domain = K::Domain;
    fn domain(&self) -> &K::Domain {
        self.kernel.domain()
    }
}

impl<K: Kernel + HasDomain, P: Proposal<K::Point>> Transition for Proposed<K, P> {
    #[inline]
    fn step<S: Sampler>(&self, x: &K::Point, u: &mut S) -> Option<Step<K::Point, K::Weight>> {
        let y = self.proposal.sample(x, u);
        Some(Step::with_pdf(y.point, self.kernel.eval(x, &y.point).scaled(y.weight), 1.0 / y.weight))
    }
}

impl<K: Kernel + HasDomain, P: Proposal<K::Point>> TransitionPdf for Proposed<K, P> {
    #[inline]
    fn pdf(&self, x: &K::Point, y: &K::Point) -> f64 {
        self.proposal.pdf(x, y)
    }
}

impl<K: Kernel + HasDomain, P: Proposal<K::Point>> Absorbing for Proposed<K, P> {
    fn absorption(&self, _: &K::Point) -> f64 {
        0.0
    }
    fn never_absorbs(&self) -> bool {
        true
    }
}

impl<K: Kernel + HasDomain, D: Domain<Point = K::Point>> RowMass for Proposed<K, Tabulated<D>> {
    #[inline]
    fn mass(&self, x: &K::Point) -> f64 {
        self.proposal.mass(x)
    }
}

/// A proposal tabulated ∝ |K(x, ·)| with no work from the user, on one-dimensional domains (times groups).
///
/// Rows are tables of the mean |K| over cells of y, one for each cell of x and group; a share of the domain's own density keeps condition (S)
/// where a table saw only zeros. Its error costs variance, never bias: the weight is K/p with the exact p.
#[derive(Clone, Debug)]
pub struct Tabulated<D> {
    domain: D,
    rows: Vec<Row>,
    cells: usize,
    groups: usize,
}

#[derive(Clone, Debug)]
struct Row {
    /// over groups × cells, or `None` if the kernel vanishes on the whole row
    table: Option<Table>,
    mass: f64,
}

/// Share of the domain's own density mixed into every row: weights stay below 1/0.1 of the uniform ones.
const DEFENSIVE: f64 = 0.1;

impl<D: Domain> Tabulated<D> {
    /// Tabulates |K| on `cells` × `cells` cells of the map's coordinate, for every pair of states; 6 `cells`² evaluations a pair.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a domain of more than one dimension, `cells` = 0 or an invalid domain; [`Error::NonFiniteKernel`] with the place.
    pub fn new<K>(kernel: &K, cells: usize) -> Result<Self, Error>
    where
        K: Kernel + HasDomain<Domain = D, Point = D::Point>,
    {
        let domain = kernel.domain();
        domain.validate()?;
        if cells == 0 {
            return Err(Error::invalid("cells", 0.0, "must be at least 1"));
        }
        if domain.dimension() != 1 {
            return Err(Error::invalid("dimension", domain.dimension() as f64, "tabulated proposals need a one-dimensional domain"));
        }
        let groups = domain.states();
        let rows = crate::parallel::map(groups * cells, |i| tabulate_row(kernel, domain, cells, i / cells, i % cells));
        Ok(Tabulated { domain: domain.clone(), rows: rows.into_iter().collect::<Result<_, _>>()?, cells, groups })
    }

    #[inline]
    fn row(&self, x: &D::Point) -> &Row {
        let cell = ((self.domain.coordinate(x, 0) * self.cells as f64) as usize).min(self.cells - 1);
        &self.rows[self.domain.state(x) * self.cells + cell]
    }

    /// The tabulated ∫ |K(x, y)| dμ(y).
    #[inline]
    pub fn mass(&self, x: &D::Point) -> f64 {
        self.row(x).mass
    }
}

/// Offsets in a cell of x and of y: never equal, so that a diagonal singularity is not hit.
const X_OFFSETS: [f64; 2] = [0.25, 0.75];
const Y_OFFSETS: [f64; 3] = [1.0 / 6.0, 0.5, 5.0 / 6.0];

fn tabulate_row<K>(kernel: &K, domain: &K::Domain, cells: usize, state: usize, cell: usize) -> Result<Row, Error>
where
    K: Kernel + HasDomain,
{
    let h = 1.0 / cells as f64;
    let mut weights = vec![0.0; domain.states() * cells];
    for dx in X_OFFSETS {
        let x = domain.place(state, || (cell as f64 + dx) * h).point;
        for (i, w) in weights.iter_mut().enumerate() {
            for dy in Y_OFFSETS {
                let y = domain.place(i / cells, || ((i % cells) as f64 + dy) * h);
                let k = kernel.eval(&x, &y.point);
                if !k.entries_finite() {
                    return Err(Error::non_finite_kernel(&x, &y.point, &k));
                }
                *w += k.norm() * y.weight * h / (X_OFFSETS.len() * Y_OFFSETS.len()) as f64;
            }
        }
    }
    let mass = weights.iter().sum();
    Ok(Row { table: Table::new(&weights), mass })
}

impl<D: Domain> Proposal<D::Point> for Tabulated<D> {
    #[inline]
    fn sample<S: Sampler>(&self, x: &D::Point, u: &mut S) -> Node<D::Point> {
        let row = self.row(x);
        let v = u.next_1d();
        let Some(table) = &row.table else { return self.domain.sample(u) };
        // one uniform chooses the branch and, rescaled, the point (theory (4.2.4)): two coordinates a step, one of them for the table alone
        let y = if v < DEFENSIVE {
            self.domain.sample(u).point
        } else {
            let (t, _) = table.sample((v - DEFENSIVE) / (1.0 - DEFENSIVE));
            let t = t * self.groups as f64;
            let state = (t as usize).min(self.groups - 1);
            self.domain.place(state, || (t - state as f64).clamp(f64::EPSILON / 2.0, 1.0 - f64::EPSILON / 2.0)).point
        };
        Node { point: y, weight: 1.0 / self.pdf(x, &y) }
    }

    #[inline]
    fn pdf(&self, x: &D::Point, y: &D::Point) -> f64 {
        let own = self.domain.density(y);
        let Some(table) = &self.row(x).table else { return own };
        let t = (self.domain.state(y) as f64 + self.domain.coordinate(y, 0)) / self.groups as f64;
        // `own` = (density of the map)/groups, and the table is a density of the pair (state, t) on the unit interval
        own * (DEFENSIVE + (1.0 - DEFENSIVE) * table.pdf(t))
    }
}
