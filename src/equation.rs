//! f = g + T f, and what can be asked of it.

use crate::contained::contained;
use crate::detector::{At, Detector, Points};
use crate::domain::{Domain, Interval};
use crate::error::Error;
use crate::kernel::{HasDomain, Kernel, KernelFn, Operator, Proposed, Tabulated, Uniform, kernel_fn};
use crate::source::{Source, SourceFn, TabulatedSource, source_fn};
use crate::value::{Value, Weight};

/// A Fredholm equation of the second kind, f(x) = g(x) + ∫ K(x, y) f(y) dμ(y): a source and a kernel.
///
/// ```
/// use fredholm::{Equation, Walk};
/// let eq = Equation::on_interval(0.0..=1.0, |_| 1.0, |x, y| 0.5 * x * y);      // f(x) = 1 + ∫₀¹ ½xy f(y) dy = 1 + 3x/10
/// let f = eq.at(0.5).solve(&Walk::collision().samples_per_cell(1 << 16).seed(7))?;
/// assert!(f.agrees_with(1.15, 4.0));
/// # Ok::<(), fredholm::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Equation<G, K> {
    source: G,
    kernel: K,
}

/// What closures on an interval become: [`Equation::on_interval`].
pub type IntervalEquation<V, W, G, K> = ClosureEquation<Interval, V, W, G, K>;
/// What closures on a domain become: [`Equation::on`].
pub type ClosureEquation<D, V, W, G, K> = Equation<SourceFn<D, G, V>, Proposed<KernelFn<D, K, W>, Uniform<D>>>;

impl Equation<(), ()> {
    /// g and K as closures of numbers on an interval, walked by the uniform proposal. Argument types are inferred.
    ///
    /// An empty or reversed interval is refused by every solve, with its ends.
    pub fn on_interval<V, W, G, K>(
        interval: impl Into<Interval>,
        g: G,
        k: K,
    ) -> IntervalEquation<V, W, impl Fn(&f64) -> V + Send + Sync + Clone, impl Fn(&f64, &f64) -> W + Send + Sync + Clone>
    where
        V: Value,
        W: Weight<Value = V>,
        G: Fn(f64) -> V + Send + Sync + Clone,
        K: Fn(f64, f64) -> W + Send + Sync + Clone,
    {
        Equation::on_domain(interval.into(), move |x: &f64| g(*x), move |x: &f64, y: &f64| k(*x, *y))
    }

    /// g and K as closures of points of any [`Domain`], walked by the domain's own density.
    ///
    /// ```
    /// use fredholm::{domain::Cuboid, Equation, Walk};
    /// let eq = Equation::on_domain(Cuboid::<2>::unit(), |_| 1.0, |x, y| x[0] * y[0] + 0.0 * x[1] * y[1]);
    /// let f = eq.at([1.0, 0.5]).solve(&Walk::collision())?;      // f = 1 + 3x₀/4
    /// assert!(f.agrees_with(1.75, 5.0));
    /// # Ok::<(), fredholm::Error>(())
    /// ```
    pub fn on_domain<D, V, W, G, K>(domain: D, g: G, k: K) -> ClosureEquation<D, V, W, G, K>
    where
        D: Domain,
        V: Value,
        W: Weight<Value = V>,
        G: Fn(&D::Point) -> V + Send + Sync,
        K: Fn(&D::Point, &D::Point) -> W + Send + Sync,
    {
        let proposal = Uniform::on(domain.clone());
        Equation { source: source_fn(domain.clone(), g), kernel: Proposed::new(kernel_fn(domain, k), proposal) }
    }
}

impl<G: Source, K: Operator<Point = G::Point>> Equation<G, K>
where
    K::Weight: Weight<Value = G::Value>,
{
    /// Your own source and kernel.
    pub fn new(source: G, kernel: K) -> Self {
        Equation { source, kernel }
    }

    /// f at one point.
    pub fn at(&self, x: G::Point) -> Query<'_, G, K, At<G::Point>> {
        Query { equation: self, detector: Held::Own(At(x)) }
    }

    /// f at several points.
    pub fn on(&self, points: &[G::Point]) -> Query<'_, G, K, Points<G::Point>> {
        Query { equation: self, detector: Held::Own(Points(points.to_vec())) }
    }

    /// Any detector.
    pub fn seen_by<'a, D: Detector<Point = G::Point>>(&'a self, detector: &'a D) -> Query<'a, G, K, D> {
        Query { equation: self, detector: Held::Borrowed(detector) }
    }

    /// f everywhere, by a method that finds a function.
    ///
    /// # Errors
    /// Those of the method; [`Error::Panicked`].
    pub fn solve<M: Method<G, K, Everywhere> + ?Sized>(&self, method: &M) -> Result<M::Solution, Error> {
        contained(|| method.solve(self, &Everywhere))
    }

    /// The source g.
    pub fn source(&self) -> &G {
        &self.source
    }

    /// The kernel K.
    pub fn kernel(&self) -> &K {
        &self.kernel
    }

    /// The same kernel with another source.
    pub fn with_source<H>(self, source: H) -> Equation<H, K>
    where
        H: Source<Point = G::Point, Value = G::Value>,
    {
        Equation { source, kernel: self.kernel }
    }

    /// Refuses invalid domains and parameters.
    ///
    /// # Errors
    /// Those of the source's and the kernel's own checks.
    pub fn validate(&self) -> Result<(), Error> {
        self.source.validate()?;
        self.kernel.validate()
    }
}

impl<G: Source, K: Kernel + HasDomain + Operator<Point = G::Point>, P> Equation<G, Proposed<K, P>> {
    /// The same equation, walked by another proposal.
    pub fn with_proposal<Q>(self, proposal: Q) -> Equation<G, Proposed<K, Q>> {
        Equation { source: self.source, kernel: self.kernel.with_proposal(proposal) }
    }

    /// The same equation, walked by a table ∝ |K(x, ·)| on `cells` × `cells` cells (one-dimensional domains).
    ///
    /// # Errors
    /// Those of [`Tabulated::new`].
    pub fn tabulated(self, cells: usize) -> Result<Equation<G, Proposed<K, Tabulated<K::Domain>>>, Error> {
        let proposal = Tabulated::new(self.kernel.kernel(), cells)?;
        Ok(self.with_proposal(proposal))
    }
}

impl<D, F, V, Q, K> Equation<SourceFn<D, F, V, Q>, K>
where
    D: Domain,
    V: Value,
    F: Fn(&D::Point) -> V + Send + Sync,
{
    /// The same equation with next-event points drawn from a table ∝ |g|.
    ///
    /// # Errors
    /// Those of [`SourceFn::tabulated`].
    pub fn tabulated_source(self, cells: usize) -> Result<Equation<SourceFn<D, F, V, TabulatedSource<D>>, K>, Error> {
        Ok(Equation { source: self.source.tabulated(cells)?, kernel: self.kernel })
    }
}

/// The detector of methods that find f as a function.
#[derive(Clone, Copy, Debug, Default)]
pub struct Everywhere;

/// A way to find what `detector` asks of an equation. Object-safe: dispatch happens once a solve and nowhere deeper.
#[diagnostic::on_unimplemented(
    message = "`{Self}` cannot solve this equation for this detector",
    note = "the method needs a capability that the kernel or the source lacks; the table in the crate's documentation lists which"
)]
pub trait Method<G, K, D> {
    /// What it finds.
    type Solution;

    /// Solves.
    ///
    /// # Errors
    /// See [`Error`]: nothing is clamped, dropped or regularised silently.
    fn solve(&self, equation: &Equation<G, K>, detector: &D) -> Result<Self::Solution, Error>;
}

#[derive(Debug)]
enum Held<'a, D> {
    Own(D),
    Borrowed(&'a D),
}

/// An equation and what is asked of it.
#[derive(Debug)]
#[must_use]
pub struct Query<'a, G, K, D> {
    equation: &'a Equation<G, K>,
    detector: Held<'a, D>,
}

impl<'a, G, K, D> Query<'a, G, K, D> {
    /// Solves with one method.
    ///
    /// # Errors
    /// Those of the method; [`Error::Panicked`].
    pub fn solve<M: Method<G, K, D> + ?Sized>(&self, method: &M) -> Result<M::Solution, Error> {
        contained(|| method.solve(self.equation, self.detector()))
    }

    /// The equation.
    pub fn equation(&self) -> &'a Equation<G, K> {
        self.equation
    }

    /// The detector.
    pub fn detector(&self) -> &D {
        match &self.detector {
            Held::Own(d) => d,
            Held::Borrowed(d) => d,
        }
    }
}
