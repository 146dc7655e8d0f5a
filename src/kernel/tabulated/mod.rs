//! A proposal tabulated ∝ |K(x, ·)|, fine enough on the diagonal for peaks and singularities there.
//!
//! A row of the table belongs to a cell of x (and a state). In the coordinate s ∈ [0, 1] of the domain's map, with t the coordinate of x, it mixes
//!
//! ```text
//! p(x, y) = 0.01 · density of the domain
//!         + 0.99 · [ equal cells of s             the mean of |K|, but no more than its value at |s − t| = R
//!                  + shells r_k ≤ ±(s − t) < r_{k+1} < R   the mean of what exceeds that ]
//! ```
//!
//! and no entry less than a tenth of the density of its neighbours: K may end between the places where it was asked for.
//!
//! Shells are quarters of octaves of the distance, down to the spacing of floating-point numbers. On one of them a kernel |x − y|^{−α} hardly varies, so K/p stays
//! bounded where equal cells alone have K/p unbounded and, for α ≥ ½, infinite variance (theory (4.3.1)); the same holds for peaks narrower than a cell.
//! Shells that would leave [0, 1] are folded back at its ends. R is a few cells, measured in units of μ: where the map of a half line stretches, shells keep
//! their width in x, and so a kernel of |x − y| its table.

mod guide;
mod probe;
mod shell;

use super::{HasDomain, Kernel, Proposal, Proposed, RowMass};
use crate::contained::contained;
use crate::domain::{Domain, Node};
use crate::error::Error;
use crate::sampling::{Sampler, Table};
use probe::Probe;
use shell::{SHELLS, Shell, scale};

/// A proposal tabulated ∝ |K(x, ·)| with no work from the user, on one-dimensional domains (times groups).
///
/// Rows are tables of the mean |K| over cells of y and over shells around x, one for each cell of x and group; a share of the domain's own density
/// keeps condition (S) where a table saw only zeros. Its error costs variance, never bias: the weight is K/p with the exact p.
#[derive(Clone, Debug)]
pub struct Tabulated<D> {
    domain: D,
    rows: Vec<Row>,
    cells: usize,
    groups: usize,
    guidance: Guidance,
}

/// What the entries of the table are proportional to.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Guidance {
    /// |K(x, y)|
    Kernel,
    /// |K(x, y)| u(y), see [`Tabulated::guided`]
    Importance,
}

#[derive(Clone, Debug)]
struct Row {
    /// over groups × cells, then groups × sides × shells; `None` if the kernel vanishes on the whole row
    table: Option<Table>,
    mass: f64,
    /// R, in units of μ
    reach: f64,
}

/// Share of the domain's own density mixed into every row: weights stay below 100 times the uniform ones. With p ∝ |K| but for this share,
/// ρ(K²/p) = ρ(|K|)²/(1 − share): a larger one would make the variance infinite for kernels close to critical.
const DEFENSIVE: f64 = 0.01;
/// Row mass reported where all samples of |K| vanish.
const UNSEEN: f64 = 0.1;
impl<D: Domain> Tabulated<D> {
    /// Tabulates |K| on `cells` × `cells` cells of the map's coordinate, for every pair of states; 6 `cells`² + 768 `cells` evaluations a pair.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a domain of more than one dimension, `cells` = 0 or an invalid domain; [`Error::NonFiniteKernel`] with the place;
    /// [`Error::BelowRounding`] if more than 10⁻⁴ of ∫ |K(x, ·)| lies closer to y = x than floating-point numbers can tell, as from |x − y|^−¾ on.
    pub fn new<K>(kernel: &K, cells: usize) -> Result<Self, Error>
    where
        K: Kernel + HasDomain<Domain = D, Point = D::Point>,
    {
        let domain = kernel.domain();
        domain.validate()?;
        if cells == 0 {
            return Err(Error::invalid("cells", 0.0, "must be at least 1"));
        }
        Error::held("cells × cells", (cells as u64).saturating_mul(cells as u64).saturating_mul(domain.states() as u64))?;
        if domain.dimension() != 1 {
            return Err(Error::invalid("dimension", domain.dimension() as f64, "tabulated proposals need a one-dimensional domain"));
        }
        let groups = domain.states();
        let row = |i: usize| Probe { kernel, cells, state: i / cells, cell: i % cells }.row();
        Ok(Tabulated {
            domain: domain.clone(),
            rows: contained(|| crate::parallel::map(groups * cells, row).into_iter().collect())?,
            cells,
            groups,
            guidance: Guidance::Kernel,
        })
    }

    /// A table of another kernel, as fine as this one and guided if it is.
    pub(crate) fn again<K>(&self, kernel: &K) -> Result<Self, Error>
    where
        K: Kernel + HasDomain<Domain = D, Point = D::Point>,
    {
        let table = Tabulated::new(kernel, self.cells)?;
        Ok(if self.guidance == Guidance::Importance { table.guided() } else { table })
    }

    #[inline]
    fn row(&self, x: &D::Point) -> &Row {
        let cell = ((self.domain.coordinate(x, 0) * self.cells as f64) as usize).min(self.cells - 1);
        // a state beyond the last has no row of its own: any row is unbiased
        &self.rows[self.domain.state(x).min(self.groups - 1) * self.cells + cell]
    }

    /// The tabulated ∫ |K(x, y)| dμ(y).
    ///
    /// Where all samples of |K| vanish it is 0.1: they may have missed a peak, and a survival probability of 0 would then be a bias.
    #[inline]
    pub fn mass(&self, x: &D::Point) -> f64 {
        let row = self.row(x);
        if row.table.is_some() { row.mass } else { UNSEEN }
    }

    /// The coordinate t of x; of the nearest end for an x outside, where shells around x would leave the domain.
    #[inline]
    fn centre(&self, x: &D::Point) -> f64 {
        self.domain.coordinate(x, 0).clamp(0.0, 1.0)
    }

    /// 1/R(x) in the coordinate s: R at most the whole interval, so that a shell folds at most once at each end.
    #[inline]
    fn scale(&self, t: f64, row: &Row) -> f64 {
        scale(self.domain.place(0, || t.clamp(f64::MIN_POSITIVE, 1.0 - f64::EPSILON / 2.0)).weight, row.reach)
    }

    /// The point at coordinate s of a state; `place` needs coordinates strictly inside (0, 1).
    #[inline]
    fn place(&self, state: usize, s: f64) -> D::Point {
        self.domain.place(state, || s.clamp(f64::MIN_POSITIVE, 1.0 - f64::EPSILON / 2.0)).point
    }

    /// The point of shell `shell` at share `part` of its width.
    #[inline]
    fn near(&self, x: &D::Point, row: &Row, shell: Shell, part: f64) -> D::Point {
        let t = self.centre(x);
        let (inner, outer) = shell.bounds();
        let mut distance = (inner + part * (outer - inner)) / self.scale(t, row);
        loop {
            let s = (if shell.right { t + distance } else { t - distance }).abs();
            let y = self.place(shell.state, if s > 1.0 { 2.0 - s } else { s });
            // what rounds back to x, where the kernel may be infinite, goes to the nearest point that does not
            if self.domain.coordinate(&y, 0) != t {
                return y;
            }
            distance = 2.0 * distance.max(f64::EPSILON * f64::EPSILON);
        }
    }

    /// Density of the shells with respect to the coordinate s, for a table whose entries have probabilities `table.pdf`/entries.
    #[inline]
    fn near_pdf(&self, x: &D::Point, row: &Row, state: usize, s: f64, probability: impl Fn(usize) -> f64) -> f64 {
        let t = self.centre(x);
        let scale = self.scale(t, row);
        let one = |image: f64| {
            let distance = (image - t).abs() * scale;
            if distance >= 1.0 {
                return 0.0;
            }
            let shell = Shell::at(state, image >= t, distance);
            let (inner, outer) = shell.bounds();
            probability(self.groups * self.cells + shell.index()) * scale / (outer - inner)
        };
        let mut sum = one(s);
        // images behind the ends, where a shell reaches over them
        if t * scale < 1.0 {
            sum += one(-s);
        }
        if (1.0 - t) * scale < 1.0 {
            sum += one(2.0 - s);
        }
        sum
    }
}

impl<D: Domain> Proposal<D::Point> for Tabulated<D> {
    #[inline]
    fn sample<S: Sampler>(&self, x: &D::Point, u: &mut S) -> Node<D::Point> {
        let row = self.row(x);
        let v = u.next_1d();
        let Some(table) = &row.table else { return self.domain.sample(u) };
        // one uniform chooses the branch, the entry and, rescaled, the point in it (theory (4.2.4))
        let y = if v < DEFENSIVE {
            self.domain.sample(u).point
        } else {
            let far = self.groups * self.cells;
            let entries = far + self.groups * 2 * SHELLS;
            let at = table.sample((v - DEFENSIVE) / (1.0 - DEFENSIVE)).0 * entries as f64;
            let entry = (at as usize).min(entries - 1);
            let part = at - entry as f64;
            if entry < far {
                self.place(entry / self.cells, ((entry % self.cells) as f64 + part) / self.cells as f64)
            } else {
                self.near(x, row, Shell::of_index(entry - far), part)
            }
        };
        Node { point: y, weight: 1.0 / self.pdf(x, &y) }
    }

    #[inline]
    fn pdf(&self, x: &D::Point, y: &D::Point) -> f64 {
        let own = self.domain.density(y);
        let row = self.row(x);
        let Some(table) = &row.table else { return own };
        let (s, state) = (self.domain.coordinate(y, 0), self.domain.state(y));
        let cell = ((s * self.cells as f64) as usize).min(self.cells - 1);
        let probability = |entry: usize| table.probability(entry);
        let far = probability(state * self.cells + cell) * self.cells as f64;
        let near = self.near_pdf(x, row, state, s, probability);
        // `own` = (density of the map)/groups; the table is a density of the pair (state, s)
        own * (DEFENSIVE + (1.0 - DEFENSIVE) * self.groups as f64 * (far + near))
    }
}

impl<K: Kernel + HasDomain, D: Domain<Point = K::Point>> RowMass for Proposed<K, Tabulated<D>> {
    #[inline]
    fn mass(&self, x: &K::Point) -> f64 {
        self.proposal().mass(x)
    }
}
