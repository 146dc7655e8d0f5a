//! Equations, kernels and sources whose closures hide behind one type for each domain: what solves them is compiled once, not once for every closure.
//!
//! Called like those of `fredholm`: `use erased::Equation` is all that a file of tests has to say. Closures live as long as the program does.

#![allow(dead_code, unreachable_pub, reason = "each test file uses its part")]

use fredholm::domain::{Domain, Interval};
use fredholm::kernel::{KernelFn, Operator};
use fredholm::source::{Source, SourceFn};
use fredholm::{ClosureEquation, Value, Weight};

type Function<'a, X, V> = &'a (dyn Fn(&X) -> V + Send + Sync);
type Pair<'a, X, W> = &'a (dyn Fn(&X, &X) -> W + Send + Sync);

/// Any kernel on a domain.
pub type AnyKernel<'a, D, W = f64> = KernelFn<D, Pair<'a, <D as Domain>::Point, W>, W>;
/// Any source on a domain.
pub type AnySource<'a, D, V = f64> = SourceFn<D, Function<'a, <D as Domain>::Point, V>, V>;
/// Any equation on a domain.
pub type AnyEquation<'a, D, V = f64, W = f64> =
    ClosureEquation<D, V, W, Function<'a, <D as Domain>::Point, V>, Pair<'a, <D as Domain>::Point, W>>;

/// Constructors as those of [`fredholm::Equation`].
#[derive(Debug)]
pub struct Equation;

impl Equation {
    /// As [`fredholm::Equation::on_domain`].
    pub fn on_domain<'a, D: Domain, V: Value, W: Weight<Value = V>>(
        domain: D,
        g: impl Fn(&D::Point) -> V + Send + Sync + 'a,
        k: impl Fn(&D::Point, &D::Point) -> W + Send + Sync + 'a,
    ) -> AnyEquation<'a, D, V, W> {
        let (g, k): (Function<'a, D::Point, V>, Pair<'a, D::Point, W>) = (Box::leak(Box::new(g)), Box::leak(Box::new(k)));
        fredholm::Equation::on_domain(domain, g, k)
    }

    /// As [`fredholm::Equation::on_interval`].
    pub fn on_interval<'a, V: Value, W: Weight<Value = V>>(
        interval: impl Into<Interval>,
        g: impl Fn(f64) -> V + Send + Sync + 'a,
        k: impl Fn(f64, f64) -> W + Send + Sync + 'a,
    ) -> AnyEquation<'a, Interval, V, W> {
        Equation::on_domain(interval.into(), move |x: &f64| g(*x), move |x: &f64, y: &f64| k(*x, *y))
    }

    /// [`fredholm::Equation::new`].
    #[allow(clippy::new_ret_no_self, reason = "stands for the constructor of that name")]
    pub fn new<G: Source, K: Operator<Point = G::Point, Weight: Weight<Value = G::Value>>>(g: G, k: K) -> fredholm::Equation<G, K> {
        fredholm::Equation::new(g, k)
    }
}

/// As [`fredholm::kernel::kernel_fn`].
pub fn kernel_fn<'a, D: Domain, W: Weight>(domain: D, k: impl Fn(&D::Point, &D::Point) -> W + Send + Sync + 'a) -> AnyKernel<'a, D, W> {
    let k: Pair<'a, D::Point, W> = Box::leak(Box::new(k));
    fredholm::kernel::kernel_fn(domain, k)
}

/// As [`fredholm::source::source_fn`].
pub fn source_fn<'a, D: Domain, V: Value>(domain: D, g: impl Fn(&D::Point) -> V + Send + Sync + 'a) -> AnySource<'a, D, V> {
    let g: Function<'a, D::Point, V> = Box::leak(Box::new(g));
    fredholm::source::source_fn(domain, g)
}
