//! Functionals ⟨h, f⟩.

use super::{Detector, SampleDetector, Score, Start, StartPdf};
use crate::domain::{Domain, Node, Point};
use crate::error::Error;
use crate::sampling::{Pcg, Sampler, Sequence};
use crate::value::Value;

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
