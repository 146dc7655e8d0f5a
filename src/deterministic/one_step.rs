//! The variance of one step of a walk, for every rule of scoring.
//!
//! ```text
//! from x     A = w_q K g/q (ζ) + α π/(q + π) (ζ),  ζ ~ q           B = 1{survive} [ (K/π) c − α q/(q + π) ] (X'),  X' ~ π,      c = w_π g + h,  f = g + h
//! ν          = Var A + Var B,          E Y_h = Tf = E A + E B
//! collision  w_q = 0, w_π = 1          ν = ∫ K₂ f² − (Tf)²                                                                         theory (4.3.3)
//! next event w_q = 1, w_π = 0          ν = Var_q[Kg/q] + ∫ K₂ h² − (Th)²                                                           theory (4.3.5)
//! MIS        w_q + w_π = 1, α = 0 but with the weights of a pilot
//! ```
//!
//! A and B are independent given x; π has the survival probability in it, K₂ = K²/π. Terms of α count where K ≠ 0.

use crate::domain::Node;
use crate::equation::Equation;
use crate::kernel::{HasDomain, Kernel, Operator, TransitionPdf};
use crate::source::{SampleSource, Source};
use crate::walk::{Collision, Ending, Heuristic, Mis, NextEvent, OptimalMis, Scoring, Technique};

/// A scoring rule whose variance can be predicted.
///
/// Law: `hit` and the share of `event` add up to 1 wherever K g ≠ 0.
#[diagnostic::on_unimplemented(
    message = "the variance of the scoring rule `{Self}` has no formula here",
    note = "variances are predicted for `Collision`, `NextEvent`, `Mis` and `OptimalMis`; next event needs a source that can be sampled"
)]
pub trait Predictable<G: Source, K: Operator>: Scoring<G, K> {
    /// w_π: the share of g(y) that a walk scores where a step of sub-density π has led it from x to y.
    fn hit(&self, source: &G, x: &G::Point, y: &G::Point, pi: f64) -> f64;

    /// w_q and q of the next event at y, seen from x; `None` without next event.
    fn event(&self, source: &G, x: &G::Point, y: &G::Point, pi: f64) -> Option<(f64, f64)> {
        let _ = (source, x, y, pi);
        None
    }

    /// α of the control of optimal weights.
    fn control(&self) -> f64 {
        0.0
    }
}

impl<G: Source, K: Operator> Predictable<G, K> for Collision
where
    Collision: Scoring<G, K>,
{
    fn hit(&self, _: &G, _: &G::Point, _: &G::Point, _: f64) -> f64 {
        1.0
    }
}

impl<G: SampleSource, K: Operator> Predictable<G, K> for NextEvent
where
    NextEvent: Scoring<G, K>,
{
    fn hit(&self, _: &G, _: &G::Point, _: &G::Point, _: f64) -> f64 {
        0.0
    }
    fn event(&self, source: &G, x: &G::Point, y: &G::Point, _: f64) -> Option<(f64, f64)> {
        Some((1.0, source.pdf_for(x, y)))
    }
}

impl<G: SampleSource, K: Operator> Predictable<G, K> for Mis
where
    Mis: Scoring<G, K>,
{
    fn hit(&self, source: &G, x: &G::Point, y: &G::Point, pi: f64) -> f64 {
        self.0.share(pi, source.pdf_for(x, y), Technique::Second)
    }
    fn event(&self, source: &G, x: &G::Point, y: &G::Point, pi: f64) -> Option<(f64, f64)> {
        let q = source.pdf_for(x, y);
        Some((self.0.share(q, pi, Technique::First), q))
    }
}

impl<G: SampleSource<Value = f64>, K: Operator> Predictable<G, K> for OptimalMis
where
    Mis: Scoring<G, K>,
    OptimalMis: Scoring<G, K>,
{
    fn hit(&self, source: &G, x: &G::Point, y: &G::Point, pi: f64) -> f64 {
        Predictable::<G, K>::hit(&self.base(), source, x, y, pi)
    }
    fn event(&self, source: &G, x: &G::Point, y: &G::Point, pi: f64) -> Option<(f64, f64)> {
        Predictable::<G, K>::event(&self.base(), source, x, y, pi)
    }
    fn control(&self) -> f64 {
        self.alpha()
    }
}

/// A function of two points as a kernel on the domain of another.
pub(super) struct Composed<'a, K: Operator> {
    kernel: &'a K,
    value: &'a (dyn Fn(&K::Point, &K::Point) -> f64 + Sync),
}

impl<'a, K: Operator> Composed<'a, K> {
    pub(super) fn new(kernel: &'a K, value: &'a (dyn Fn(&K::Point, &K::Point) -> f64 + Sync)) -> Self {
        Composed { kernel, value }
    }
}

impl<K: Operator> Operator for Composed<'_, K> {
    type Point = K::Point;
    type Weight = f64;
}

impl<K: Operator> Kernel for Composed<'_, K> {
    fn eval(&self, x: &K::Point, y: &K::Point) -> f64 {
        (self.value)(x, y)
    }
}

impl<K: HasDomain> HasDomain for Composed<'_, K> {
    type Domain = K::Domain;
    fn domain(&self) -> &K::Domain {
        self.kernel.domain()
    }
}

/// Rows of quadrature from one x: of K, of K₂ and of K²/q.
pub(super) struct Rows<'a> {
    pub(super) first: &'a [f64],
    pub(super) second: &'a [f64],
    pub(super) event: &'a [f64],
}

/// One step of a walk.
pub(super) struct OneStep<'a, G, K, C, E> {
    pub(super) equation: &'a Equation<G, K>,
    pub(super) scoring: &'a C,
    pub(super) ending: &'a E,
}

impl<G, K, C, E> OneStep<'_, G, K, C, E>
where
    G: Source<Value = f64>,
    K: Kernel + HasDomain + TransitionPdf + Operator<Point = G::Point, Weight = f64>,
    C: Predictable<G, K>,
    E: Ending<K>,
{
    /// π, survival included.
    pub(super) fn density(&self, x: &K::Point, y: &K::Point) -> f64 {
        let kernel = self.equation.kernel();
        self.ending.survival_at(kernel, x).unwrap_or(f64::NAN) * kernel.pdf(x, y)
    }

    /// K²/π: where K vanishes nothing need be drawn; K ≠ 0 without density breaks condition (S) and gives an infinity, refused with its place.
    pub(super) fn second(&self, x: &K::Point, y: &K::Point) -> f64 {
        let k = self.equation.kernel().eval(x, y);
        if k == 0.0 { 0.0 } else { k * k / self.density(x, y) }
    }

    /// K²/q where next event scores.
    pub(super) fn event(&self, x: &K::Point, y: &K::Point) -> f64 {
        let (source, k) = (self.equation.source(), self.equation.kernel().eval(x, y));
        match self.scoring.event(source, x, y, self.density(x, y)) {
            Some((share, q)) if k * share != 0.0 && (q > 0.0 || source.eval(y) != 0.0) => k * k / q,
            _ => 0.0,
        }
    }

    /// ν(x), from f and g at the nodes.
    pub(super) fn variance(&self, x: &K::Point, rows: &Rows<'_>, nodes: &[Node<K::Point>], (f, g): (&[f64], &[f64])) -> f64 {
        let (source, alpha) = (self.equation.source(), self.scoring.control());
        let ([mut a, mut b], [mut aa, mut bb]) = ([0.0; 2], [0.0; 2]);
        for (j, n) in nodes.iter().enumerate() {
            let pi = self.density(x, &n.point);
            let c = self.scoring.hit(source, x, &n.point, pi) * g[j] + f[j] - g[j];
            b += rows.first[j] * c;
            bb += rows.second[j] * c * c;
            let Some((share, q)) = self.scoring.event(source, x, &n.point, pi) else { continue };
            let hit = share * g[j];
            a += rows.first[j] * hit;
            aa += rows.event[j] * hit * hit;
            if alpha != 0.0 && self.equation.kernel().eval(x, &n.point) != 0.0 {
                let (to_q, to_pi) = (Heuristic::Balance.share(q, pi, Technique::First), Heuristic::Balance.share(pi, q, Technique::Second));
                let overlap = alpha * n.weight * pi * to_q;
                a += overlap;
                b -= overlap;
                aa += alpha * to_pi * (2.0 * rows.first[j] * hit + overlap);
                bb -= alpha * to_q * (2.0 * rows.first[j] * c - overlap);
            }
        }
        aa - a * a + bb - b * b
    }
}
