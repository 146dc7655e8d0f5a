//! What you want to know about f: a value, a grid, a functional ⟨h, f⟩, a histogram.

use crate::domain::{Domain, Interval, Node, Point};
use crate::error::Error;
use crate::sampling::{Pcg, Sampler, Sequence};
use crate::value::Value;

/// Where a backward walk starts, and the weight h/p₀ it starts with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Start<X> {
    /// X₀.
    pub point: X,
    /// W₀ = h(X₀)/p₀(X₀).
    pub weight: f64,
}

/// A set of cells, each a linear functional of f: cell j is `E[weight · f(point)]` over `start(j, u)`.
pub trait Detector: Send + Sync {
    /// States x.
    type Point: Point;
    /// One result a cell in this shape: a single one, or a list.
    type Answer<T>;

    /// Number of cells.
    fn cells(&self) -> usize;

    /// Draws the start of a walk for cell `cell`.
    fn start<S: Sampler>(&self, cell: usize, u: &mut S) -> Start<Self::Point>;

    /// Largest ∫ |h| dμ over the cells, by which a bound for f at a point becomes one for ⟨h, f⟩; `None` if unknown.
    fn norm(&self) -> Option<f64> {
        None
    }

    /// Shapes the results of all cells, in order.
    fn answer<T>(&self, cells: Vec<T>) -> Self::Answer<T>;

    /// Refuses detectors without cells or with invalid numbers.
    ///
    /// # Errors
    /// [`Error::Invalid`] naming the parameter and its value.
    fn validate(&self) -> Result<(), Error> {
        if self.cells() == 0 { Err(Error::invalid("cells", 0.0, "a detector needs at least one cell")) } else { Ok(()) }
    }
}

/// A detector whose h can be evaluated at the states of a forward walk, which then scores in every cell it touches.
///
/// Law: with `add` summing over all births and steps of a walk, `E[Σ]` of cell j is ⟨h_j, f⟩ (theory (4.5.3)).
#[diagnostic::on_unimplemented(
    message = "`{Self}` cannot be hit by forward walks",
    note = "no random walk hits a point: use `Forward::next_event()` for f at points; a detector of your own implements `Score`"
)]
pub trait Score<Z: Point, V: Value>: Detector {
    /// Whether most states touch most cells: scores are then kept as a table, not as a list.
    const EVERY_CELL: bool = false;

    /// Calls `add(j, h_j(z) load)` for every cell j where h_j(z) ≠ 0. `u` is for detectors that look from a random place, such as a lens.
    fn score<S: Sampler>(&self, z: &Z, load: V, u: &mut S, add: impl FnMut(usize, V));
}

/// A detector whose points can be drawn as seen from a state of a forward walk: what its next event is connected with.
///
/// Law: `E[Σ weight · φ(cell, point)] = Σ_j ∫ h_j(x) φ(j, x) dμ(x)` over what `see` is given, for every φ with K(x, z) ≠ 0.
#[diagnostic::on_unimplemented(
    message = "points of `{Self}` cannot be drawn",
    note = "the next event of a forward walk is a point of the detector: implement `SampleDetector`, or use `Forward::new()`"
)]
pub trait SampleDetector<Z: Point>: Detector {
    /// Whether every call reaches every cell: scores are then kept as a table, not as a list.
    const EVERY_CELL: bool = false;

    /// Calls `see(j, η)` with points η of cells j, their `weight` h_j/r (theory (4.5.5)).
    fn sample_for<S: Sampler>(&self, z: &Z, u: &mut S, see: impl FnMut(usize, Start<Self::Point>));
}

/// A detector that states the density of its starts, so that forward walks may end at it.
///
/// Law: `start(j, u).weight` = h_j/p₀ at its point, and for every set B, `∫_B start_pdf(j, x) dμ(x) = P(start(j, u).point ∈ B)`.
#[diagnostic::on_unimplemented(
    message = "`{Self}` does not state the density of its starts",
    note = "bidirectional walks weigh the strategies of a path by their densities: implement `StartPdf`"
)]
pub trait StartPdf: Detector {
    /// p₀(x) of cell `cell`; infinite for points, which no forward walk can find.
    fn start_pdf(&self, cell: usize, x: &Self::Point) -> f64;

    /// h of cell `cell` at x, where p₀ is finite.
    fn importance(&self, cell: usize, x: &Self::Point) -> f64;
}

/// f(x) at one point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct At<X>(pub X);

impl<X: Point> Detector for At<X> {
    type Point = X;
    type Answer<T> = T;
    fn cells(&self) -> usize {
        1
    }
    #[inline]
    fn start<S: Sampler>(&self, _: usize, _: &mut S) -> Start<X> {
        Start { point: self.0, weight: 1.0 }
    }
    fn norm(&self) -> Option<f64> {
        Some(1.0)
    }
    fn answer<T>(&self, mut cells: Vec<T>) -> T {
        cells.swap_remove(0)
    }
}

impl<X: Point> StartPdf for At<X> {
    fn start_pdf(&self, _: usize, _: &X) -> f64 {
        f64::INFINITY
    }
    fn importance(&self, _: usize, _: &X) -> f64 {
        0.0
    }
}

impl<Z: Point, X: Point> SampleDetector<Z> for At<X> {
    const EVERY_CELL: bool = true;
    #[inline]
    fn sample_for<S: Sampler>(&self, _: &Z, _: &mut S, mut see: impl FnMut(usize, Start<X>)) {
        see(0, Start { point: self.0, weight: 1.0 });
    }
}

/// f at several points, with independent walks for each.
#[derive(Clone, Debug, PartialEq)]
pub struct Points<X>(pub Vec<X>);

impl<X: Point> Detector for Points<X> {
    type Point = X;
    type Answer<T> = Vec<T>;
    fn cells(&self) -> usize {
        self.0.len()
    }
    #[inline]
    fn start<S: Sampler>(&self, cell: usize, _: &mut S) -> Start<X> {
        Start { point: self.0[cell], weight: 1.0 }
    }
    fn norm(&self) -> Option<f64> {
        Some(1.0)
    }
    fn answer<T>(&self, cells: Vec<T>) -> Vec<T> {
        cells
    }
}

impl<X: Point> StartPdf for Points<X> {
    fn start_pdf(&self, _: usize, _: &X) -> f64 {
        f64::INFINITY
    }
    fn importance(&self, _: usize, _: &X) -> f64 {
        0.0
    }
}

/// All points, from everywhere: the kernel tally (theory (4.6.2)).
impl<Z: Point, X: Point> SampleDetector<Z> for Points<X> {
    const EVERY_CELL: bool = true;
    #[inline]
    fn sample_for<S: Sampler>(&self, _: &Z, _: &mut S, mut see: impl FnMut(usize, Start<X>)) {
        self.0.iter().enumerate().for_each(|(cell, x)| see(cell, Start { point: *x, weight: 1.0 }));
    }
}

/// The mean of f over each of `count` equal cells of an interval.
///
/// ```
/// use fredholm::{detector::Bins, Equation, Walk};
/// let eq = Equation::on_interval(0.0..=1.0, |x| x, |_, _| 0.0);
/// let means = eq.seen_by(&Bins::new(0.0..=1.0, 2)).solve(&Walk::collision())?;
/// assert!(means[0].agrees_with(0.25, 5.0) && means[1].agrees_with(0.75, 5.0));
/// # Ok::<(), fredholm::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bins {
    interval: Interval,
    count: usize,
}

impl Bins {
    /// `count` equal cells of `interval`.
    #[must_use]
    pub fn new(interval: impl Into<Interval>, count: usize) -> Self {
        Bins { interval: interval.into(), count }
    }

    /// Width of a cell.
    pub fn width(&self) -> f64 {
        self.interval.length() / self.count as f64
    }

    /// The point at share `t` of cell `cell`.
    #[inline]
    pub(crate) fn place(&self, cell: usize, t: f64) -> f64 {
        self.interval.at((cell as f64 + t) / self.count as f64)
    }

    /// The cell of x, if it is inside.
    #[inline]
    pub fn cell(&self, x: f64) -> Option<usize> {
        let inside = self.interval.contains(&x);
        // the last cell keeps its upper end
        inside.then(|| ((self.interval.coordinate(&x, 0) * self.count as f64) as usize).min(self.count - 1))
    }

    /// Middle of cell `cell`.
    pub fn centre(&self, cell: usize) -> f64 {
        self.place(cell, 0.5)
    }
}

impl Detector for Bins {
    type Point = f64;
    type Answer<T> = Vec<T>;
    fn cells(&self) -> usize {
        self.count
    }
    #[inline]
    fn start<S: Sampler>(&self, cell: usize, u: &mut S) -> Start<f64> {
        Start { point: self.place(cell, u.next_1d()), weight: 1.0 }
    }
    fn norm(&self) -> Option<f64> {
        Some(1.0)
    }
    fn answer<T>(&self, cells: Vec<T>) -> Vec<T> {
        cells
    }
    fn validate(&self) -> Result<(), Error> {
        self.interval.validate()?;
        if self.count == 0 { Err(Error::invalid("bins", 0.0, "must be at least 1")) } else { Ok(()) }
    }
}

/// h_j = 1/(width of a cell) on cell j.
impl<V: Value> Score<f64, V> for Bins {
    #[inline]
    fn score<S: Sampler>(&self, z: &f64, load: V, _: &mut S, mut add: impl FnMut(usize, V)) {
        if let Some(cell) = self.cell(*z) {
            add(cell, load.scale(self.count as f64 / self.interval.length()));
        }
    }
}

/// h = p₀ = 1/(width of a cell) on the cell.
impl StartPdf for Bins {
    #[inline]
    fn start_pdf(&self, cell: usize, x: &f64) -> f64 {
        if self.cell(*x) == Some(cell) { self.count as f64 / self.interval.length() } else { 0.0 }
    }
    #[inline]
    fn importance(&self, cell: usize, x: &f64) -> f64 {
        self.start_pdf(cell, x)
    }
}

/// A point of the whole interval, and with it one cell.
impl<Z: Point> SampleDetector<Z> for Bins {
    #[inline]
    fn sample_for<S: Sampler>(&self, _: &Z, u: &mut S, mut see: impl FnMut(usize, Start<f64>)) {
        let t = u.next_1d();
        let cell = ((t * self.count as f64) as usize).min(self.count - 1);
        see(cell, Start { point: self.interval.at(t), weight: self.count as f64 });
    }
}

/// The functional ⟨h, f⟩ = ∫ h(x) f(x) dμ(x), with starts drawn by the domain's map.
///
/// ```
/// use fredholm::{detector::Functional, domain::Interval, Equation, Walk};
/// let eq = Equation::on_interval(0.0..=1.0, |_| 1.0, |_, _| 0.0);
/// let mean = eq.seen_by(&Functional::new(Interval::from(0.0..=1.0), |x| 2.0 * x)).solve(&Walk::collision())?;
/// assert!(mean.agrees_with(1.0, 5.0));
/// # Ok::<(), fredholm::Error>(())
/// ```
#[derive(Clone, Copy)]
pub struct Functional<D, H> {
    domain: D,
    weight: H,
}

impl<D: std::fmt::Debug, H> std::fmt::Debug for Functional<D, H> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Functional").field("domain", &self.domain).finish_non_exhaustive()
    }
}

impl<D: Domain, H: Fn(&D::Point) -> f64 + Send + Sync> Functional<D, H> {
    /// ∫ h f dμ over `domain`.
    pub fn new(domain: D, h: H) -> Self {
        Functional { domain, weight: h }
    }
}

impl<D: Domain, H: Fn(&D::Point) -> f64 + Send + Sync> Detector for Functional<D, H> {
    type Point = D::Point;
    type Answer<T> = T;
    fn cells(&self) -> usize {
        1
    }
    #[inline]
    fn start<S: Sampler>(&self, _: usize, u: &mut S) -> Start<D::Point> {
        let n = self.domain.sample(u);
        Start { point: n.point, weight: (self.weight)(&n.point) * n.weight }
    }
    /// The larger of two quadratures and their difference; in more than three dimensions from random points. `None` if they differ by more than a tenth.
    fn norm(&self) -> Option<f64> {
        let random = |replicate: u32| {
            let point = |i| self.domain.sample(&mut Pcg::default().point(u64::MAX, replicate, i));
            (0..4096).map(point).map(|n| Node { weight: n.weight / 4096.0, ..n }).collect()
        };
        let nodes = match self.domain.dimension() {
            1 => [self.domain.rule(32, 8), self.domain.rule(211, 3)],
            2 | 3 => [self.domain.rule(2, 8), self.domain.rule(7, 3)],
            _ => [random(0), random(1)],
        };
        let [a, b] = nodes.map(|nodes| nodes.iter().map(|n| n.weight * (self.weight)(&n.point).abs()).sum::<f64>());
        let change = (a - b).abs();
        (change <= 0.1 * a.max(b)).then_some(a.max(b) + change)
    }
    fn answer<T>(&self, mut cells: Vec<T>) -> T {
        cells.swap_remove(0)
    }
    fn validate(&self) -> Result<(), Error> {
        self.domain.validate()
    }
}

impl<D: Domain, H: Fn(&D::Point) -> f64 + Send + Sync, V: Value> Score<D::Point, V> for Functional<D, H> {
    #[inline]
    fn score<S: Sampler>(&self, z: &D::Point, load: V, _: &mut S, mut add: impl FnMut(usize, V)) {
        if self.domain.contains(z) {
            add(0, load.scale((self.weight)(z)));
        }
    }
}

impl<Z: Point, D: Domain, H: Fn(&D::Point) -> f64 + Send + Sync> SampleDetector<Z> for Functional<D, H> {
    const EVERY_CELL: bool = true;
    #[inline]
    fn sample_for<S: Sampler>(&self, _: &Z, u: &mut S, mut see: impl FnMut(usize, Start<D::Point>)) {
        see(0, self.start(0, u));
    }
}

impl<D: Domain, H: Fn(&D::Point) -> f64 + Send + Sync> StartPdf for Functional<D, H> {
    #[inline]
    fn start_pdf(&self, _: usize, x: &D::Point) -> f64 {
        self.domain.density(x)
    }
    #[inline]
    fn importance(&self, _: usize, x: &D::Point) -> f64 {
        if self.domain.contains(x) { (self.weight)(x) } else { 0.0 }
    }
}
