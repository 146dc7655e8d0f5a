//! A proposal tabulated ∝ |K(x, ·)|, fine enough on the diagonal for peaks and singularities there.
//!
//! A row of the table belongs to a cell of x (and a state). In the coordinate s ∈ [0, 1] of the domain's map, with t the coordinate of x, it mixes
//!
//! ```text
//! p(x, y) = 0.01 · density of the domain
//!         + 0.99 · [ equal cells of s                                 the mean of |K|, but no more than its value at |s − t| = R
//!                  + dyadic shells R 2^{−k−1} ≤ ±(s − t) < R 2^{−k}     the mean of what exceeds that, near x ]
//! ```
//!
//! On a shell a kernel |x − y|^{−α}, α < 1, varies by no more than 2^α, so K/p stays
//! bounded where a table of equal cells has K/p unbounded and, for α ≥ ½, infinite variance (theory (4.3.1)). The same holds for peaks
//! narrower than a cell. Shells that would leave [0, 1] are folded back at its ends. R is one cell, measured in units of μ: where the map of a half line stretches,
//! shells keep their width in x, and so a kernel of |x − y| its table.

use super::{HasDomain, Kernel, Proposal, Proposed, RowMass};
use crate::domain::{Domain, Node};
use crate::error::Error;
use crate::sampling::{Sampler, Table};
use crate::value::Weight;

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
/// Most terms of the sum that guides.
const MOST_POWERS: usize = 300;
/// Shells on each side of x; the last one reaches x itself. 2^{−48} of a cell is below the spacing of floating-point numbers.
const SHELLS: usize = 48;

impl<D: Domain> Tabulated<D> {
    /// Tabulates |K| on `cells` × `cells` cells of the map's coordinate, for every pair of states; 6 `cells`² + 384 `cells` evaluations a pair.
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
        let rows = crate::parallel::map(groups * cells, |i| Probe { kernel, cells, state: i / cells, cell: i % cells }.row());
        Ok(Tabulated { domain: domain.clone(), rows: rows.into_iter().collect::<Result<_, _>>()?, cells, groups })
    }

    /// The same table, guided towards where the walk will score: entries ∝ |K(x, y)| u(y), with u = Σ |T|ⁿ 1 from the table itself.
    ///
    /// With p ∝ |K| the operator K²/p has the kernel M(x)|K(x, y)|, M = ∫|K|, and its radius may exceed 1, an infinite variance, although that of |T| is
    /// far below, where M varies: systems, Green's functions. With p ∝ |K| u the radius is that of |T|, squared (theory §4.9).
    ///
    /// ```
    /// use fredholm::{Equation, Walk, kernel::Tabulated};
    /// let eq = Equation::on_interval(0.0..=1.0, |_| 1.0, |x, y| 0.5 * x * y);
    /// let table = Tabulated::new(eq.kernel().kernel(), 32)?.guided();
    /// assert!(eq.with_proposal(table).at(0.5).solve(&Walk::collision())?.agrees_with(1.15, 5.0));
    /// # Ok::<(), fredholm::Error>(())
    /// ```
    #[must_use]
    pub fn guided(mut self) -> Self {
        let u = self.importance();
        for (i, row) in self.rows.iter_mut().enumerate() {
            let Some(table) = &row.table else { continue };
            let cell = i % self.cells;
            let weights: Vec<f64> = table.weights().enumerate().map(|(e, w)| w * u[column(e, cell, self.cells, self.groups)]).collect();
            row.table = Table::new(&weights);
        }
        self
    }

    /// Σ |T|ⁿ 1 on the cells, by powers of the table; scaled to a maximum of 1.
    fn importance(&self) -> Vec<f64> {
        let (mut u, mut scale) = (vec![1.0; self.rows.len()], 1.0);
        for _ in 0..MOST_POWERS {
            let image = crate::parallel::map(self.rows.len(), |i| {
                let row = self.rows[i].table.iter().flat_map(|t| t.weights().enumerate());
                scale + row.map(|(e, w)| w * u[column(e, i % self.cells, self.cells, self.groups)]).sum::<f64>()
            });
            // a divergent sum grows until it is its fastest-growing part, which is what is wanted then
            let largest = image.iter().fold(0.0, |m: f64, v| m.max(*v));
            let change = image.iter().zip(&u).map(|(new, old)| (new / largest - old).abs()).fold(0.0, f64::max);
            scale /= largest;
            u = image.into_iter().map(|v| v / largest).collect();
            if change < 1e-6 {
                break;
            }
        }
        u
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
            let shell = Shell { state, right: image >= t, level: Shell::level_of(distance) };
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

/// The cell that entry `e` of a row leads to, as an index of rows; shells lead to the cell of x.
fn column(e: usize, cell: usize, cells: usize, groups: usize) -> usize {
    if e < groups * cells { e } else { Shell::of_index(e - groups * cells).state * cells + cell }
}

/// Shells are measured in μ: `stretch` = dμ/ds, `reach` = R in units of μ.
#[inline]
fn scale(stretch: f64, reach: f64) -> f64 {
    (stretch / reach).max(1.0)
}

/// A shell of distances around x, in units of R: [2^{−level−1}, 2^{−level}), the last one from 0.
#[derive(Clone, Copy)]
struct Shell {
    state: usize,
    right: bool,
    level: usize,
}

impl Shell {
    #[inline]
    fn index(self) -> usize {
        (2 * self.state + usize::from(self.right)) * SHELLS + self.level
    }

    #[inline]
    fn of_index(i: usize) -> Self {
        Shell { state: i / (2 * SHELLS), right: (i / SHELLS) % 2 == 1, level: i % SHELLS }
    }

    #[inline]
    fn bounds(self) -> (f64, f64) {
        let outer = power_of_half(self.level);
        (if self.level + 1 == SHELLS { 0.0 } else { 0.5 * outer }, outer)
    }

    /// The level of a distance in [0, 1): its binary exponent.
    #[inline]
    fn level_of(distance: f64) -> usize {
        let exponent = (distance.to_bits() >> 52) as usize;
        (1022usize.saturating_sub(exponent)).min(SHELLS - 1)
    }
}

/// 2^{−n}, exactly.
#[inline]
fn power_of_half(n: usize) -> f64 {
    f64::from_bits((1023 - n as u64) << 52)
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

/// Offsets in a cell of x and of y, and in a shell.
const X_OFFSETS: [f64; 2] = [0.25, 0.75];
const Y_OFFSETS: [f64; 3] = [1.0 / 6.0, 0.5, 5.0 / 6.0];
const SHELL_OFFSETS: [f64; 2] = [0.25, 0.75];

/// Measures one row.
struct Probe<'a, K> {
    kernel: &'a K,
    cells: usize,
    state: usize,
    cell: usize,
}

impl<K: Kernel + HasDomain> Probe<'_, K> {
    fn row(&self) -> Result<Row, Error> {
        let domain = self.kernel.domain();
        let h = 1.0 / self.cells as f64;
        let mut weights = vec![0.0; domain.states() * (self.cells + 2 * SHELLS)];
        let reach = h * domain.place(self.state, || (self.cell as f64 + X_OFFSETS[0]) * h).weight;
        for dx in X_OFFSETS {
            let t = (self.cell as f64 + dx) * h;
            let x = domain.place(self.state, || t);
            let at = Seen { x: x.point, t, reach: 1.0 / scale(x.weight, reach) };
            self.add(&at, 1.0 / X_OFFSETS.len() as f64, &mut weights)?;
        }
        let mass = weights.iter().sum();
        Ok(Row { table: Table::new(&weights), mass, reach })
    }

    /// Adds `share` of the row of one x: |K| up to its value at distance R to the cells, what exceeds that nearer than R to the shells.
    fn add(&self, at: &Seen<K::Point>, share: f64, weights: &mut [f64]) -> Result<(), Error> {
        let h = 1.0 / self.cells as f64;
        let states = self.kernel.domain().states();
        let caps = (0..states).map(|state| self.caps(at, state)).collect::<Result<Vec<_>, _>>()?;
        let (cells, shells) = weights.split_at_mut(states * self.cells);
        for (i, w) in cells.iter_mut().enumerate() {
            for dy in Y_OFFSETS {
                let s = ((i % self.cells) as f64 + dy) * h;
                let (k, stretch) = self.magnitude(at, i / self.cells, s)?;
                let near = (s - at.t).abs() < at.reach;
                let k = if near { k.min(caps[i / self.cells][usize::from(s > at.t)]) } else { k };
                *w += share / Y_OFFSETS.len() as f64 * h * k * stretch;
            }
        }
        for (i, w) in shells.iter_mut().enumerate() {
            let shell = Shell::of_index(i);
            let (inner, outer) = shell.bounds();
            for part in SHELL_OFFSETS {
                let distance = (inner + part * (outer - inner)) * at.reach;
                let s = if shell.right { at.t + distance } else { at.t - distance };
                // s = t: below the spacing of floating-point numbers at t
                if s > 0.0 && s < 1.0 && s != at.t {
                    let (k, stretch) = self.magnitude(at, shell.state, s)?;
                    let excess = (k - caps[shell.state][usize::from(shell.right)]).max(0.0);
                    *w += share / SHELL_OFFSETS.len() as f64 * (outer - inner) * at.reach * excess * stretch;
                }
            }
        }
        Ok(())
    }

    /// |K| at distance R to the left and to the right, or at the ends of the domain.
    fn caps(&self, at: &Seen<K::Point>, state: usize) -> Result<[f64; 2], Error> {
        let left = self.magnitude(at, state, (at.t - at.reach).max(f64::EPSILON))?.0;
        let right = self.magnitude(at, state, (at.t + at.reach).min(1.0 - f64::EPSILON))?.0;
        Ok([left, right])
    }

    /// |K(x, y)| and dμ/ds at the point y of coordinate s.
    fn magnitude(&self, at: &Seen<K::Point>, state: usize, s: f64) -> Result<(f64, f64), Error> {
        let domain = self.kernel.domain();
        let y = domain.place(state, || s);
        let k = self.kernel.eval(&at.x, &y.point);
        if k.entries_finite() {
            return Ok((k.norm(), y.weight));
        }
        if domain.coordinate(&y.point, 0) == domain.coordinate(&at.x, 0) {
            return Ok((0.0, y.weight)); // a singularity at y = x, reached by rounding
        }
        Err(Error::non_finite_kernel(&at.x, &y.point, &k))
    }
}

/// One x at which a row is measured.
struct Seen<X> {
    x: X,
    /// its coordinate
    t: f64,
    /// R in the coordinate
    reach: f64,
}
