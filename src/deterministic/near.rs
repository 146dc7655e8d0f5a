//! Product integration towards the diagonal: ∫ K(x, y) ℓ_k(y) dμ(y) over one panel for a target x in or near it.
//!
//! The panel is cut at y = x, and each side into pieces r ∈ [ρ, 2ρ] or [ρ, 4ρ] of the distance r = |t_y − t_x|, on which a kernel with a kink, a jump, a
//! logarithm or an algebraic singularity at r = 0 (or a peak of any width) is analytic in a fixed ellipse: the same Gauss rule converges
//! geometrically on every piece (problems §4, algorithm 2). K is never evaluated at y = x nor outside the domain.
//!
//! Where the rest of a side proves smooth, one piece takes it all: kinks and jumps cost hardly more than smooth kernels.
//!
//! A point of floating-point numbers lies up to half an ulp off the node it stands for, and a singularity feels where it is: nodes are taken at the
//! distances they have, with weights for those (first order; [`Basis::shifted_weights`]). Below a distance s that keeps 16 bits of y − x, the integral is
//! extrapolated from the means m_k of K over [2ᵏs, 2ᵏ⁺¹s]. With δ = (m₂ − m₁)/(m₁ − m₀),
//!
//! ```text
//! ∫₀^s K = s (m₀ − 2 (m₁ − m₀)/(2δ − 1))        exact for A + B r^β (δ = 2^β) and for A + B ln r (δ = 1)
//! ∫₀^s K = s m₀ ρ/(1 − ρ),   ρ = m₀/(2 m₁)      exact for B r^β alone; used for strong singularities. ρ → 1: not integrable
//! ```

use super::basis::Basis;
use super::pieces::Pieces;
use crate::domain::Domain;
use crate::error::Error;
use crate::kernel::{HasDomain, Kernel, Singularity};
use crate::value::{Value, Weight};

/// Components of the values that a kernel acts on.
pub(crate) fn components<K: Kernel>() -> usize {
    <<K::Weight as Weight>::Value as Value>::COMPONENTS
}

/// The end of the domain, 0 or 1, from which coordinates near t keep their digits. Infinity is no end to count from.
pub(crate) fn nearer_end<D: Domain>(domain: &D, t: f64) -> f64 {
    if t > 0.5 && domain.volume().is_finite() { 1.0 } else { 0.0 }
}

/// A point x at which rows of the operator are wanted, and the place towards which panels are cut: x itself, or an end of the domain.
#[derive(Debug)]
pub(crate) struct Target<'a, K: HasDomain> {
    pub(super) kernel: &'a K,
    pub(super) x: &'a K::Point,
    /// x or an end
    pub(super) centre: K::Point,
    /// the end, if it is one
    pub(super) end: Option<f64>,
    /// the end of the domain, 0 or 1, that coordinates are counted from: the nearer one, so that they keep their digits
    origin: f64,
    /// coordinate of the centre
    pub(super) t: f64,
    /// smallest distance at which y − x keeps 16 bits
    pub(super) resolved: f64,
    /// distance from the centre below which K is known to be smooth but for the centre itself
    pub(super) scale: f64,
    /// a declared singularity, and |x − y| for a unit of distance
    pub(super) split: Option<(Singularity, f64)>,
}

impl<K: HasDomain> Clone for Target<'_, K> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<K: HasDomain> Copy for Target<'_, K> {}

/// Relative precision of distances: 16 bits. What the weights do not correct is its square.
const DISTANCE_BITS: f64 = 1.0 / 65_536.0;
/// No coordinate needs finer distances: far out on a half line, 2^{−80} is a millionth of x at x = 10⁹.
const FINEST: f64 = 1.0 / (1u128 << 80) as f64;

impl<'a, K: Kernel + HasDomain> Target<'a, K> {
    pub(crate) fn new(kernel: &'a K, x: &'a K::Point) -> Self {
        let domain = kernel.domain();
        let t = domain.coordinate(x, 0);
        let origin = nearer_end(domain, t);
        let t = if origin == 1.0 { domain.separation(&domain.place(domain.state(x), || 1.0).point, x) } else { t };
        let exact = |d: f64| domain.difference(x, d).is_some_and(|apart| kernel.eval_at_difference(x, x, apart).is_some());
        let resolved = resolved(domain, x, origin, t, exact);
        let split = domain.stretch().and_then(|stretch| Some((kernel.split(x, x, stretch)?.singularity, stretch)));
        Target { kernel, x, centre: *x, end: None, origin, t, resolved, scale: f64::INFINITY, split }
    }

    /// The row at x, with panels cut towards an end of the domain, 0 or 1: K(x, y) may be singular in y there.
    pub(crate) fn towards_end(kernel: &'a K, x: &'a K::Point, end: f64) -> Self {
        let centre = kernel.domain().place(0, || end).point;
        let resolved = resolved(kernel.domain(), &centre, end, 0.0, |_| false);
        Target { kernel, x, centre, end: Some(end), origin: end, t: 0.0, resolved, scale: f64::INFINITY, split: None }
    }

    /// The row at x, with panels cut towards its crossing with a line along which K is singular, at coordinate `t`.
    pub(crate) fn towards(kernel: &'a K, x: &'a K::Point, t: f64) -> Self {
        let domain = kernel.domain();
        let (centre, origin) = (domain.place(domain.state(x), || t).point, nearer_end(domain, t));
        let t = domain.separation(&domain.place(domain.state(x), || origin).point, &centre);
        let resolved = resolved(domain, &centre, origin, t, |_| false);
        Target { kernel, x, centre, end: Some(t + origin), origin, t, resolved, scale: f64::INFINITY, split: None }
    }

    /// The coordinate of the centre.
    pub(super) fn place(&self) -> f64 {
        self.origin + self.t
    }

    /// The same where something else is singular at a distance.
    pub(super) fn beside(self, scale: f64) -> Self {
        Target { scale, ..self }
    }

    /// A panel in coordinates from the origin: exact where they are close.
    fn relative(&self, (a, b): (f64, f64)) -> (f64, f64) {
        (a - self.origin, b - self.origin)
    }

    /// Whether the domain reaches to distance r on a side of x.
    pub(super) fn reaches(&self, sign: f64, r: f64) -> bool {
        (-self.origin..=1.0 - self.origin).contains(&(self.t + sign * r))
    }

    /// Whether the panel [a, b] needs product integration: its distance to x is less than its length.
    pub(crate) fn is_near(&self, panel: (f64, f64)) -> bool {
        let (a, b) = self.relative(panel);
        (a - self.t).max(self.t - b) < b - a
    }

    /// Adds ∫ K(x, y) ℓ_k(y) dμ(y) over the panel to `out[(k c + row) c + column]`; `rule` integrates a piece. Returns kernel evaluations.
    pub(crate) fn moments(&self, state: usize, panel: (f64, f64), basis: &Basis, rule: &Basis, out: &mut [f64]) -> Result<u64, Error> {
        self.moments_over(state, panel, panel, basis, rule, out)
    }

    /// The same over a part of the panel.
    pub(crate) fn moments_over(
        &self,
        state: usize,
        panel: (f64, f64),
        part: (f64, f64),
        basis: &Basis,
        rule: &Basis,
        out: &mut [f64],
    ) -> Result<u64, Error> {
        let (near, (a, b)) = (self.is_near(panel), self.relative(part));
        let mut pieces = Pieces::of(self, state, self.relative(panel), basis, rule);
        if !near {
            let side = if a > self.t { 1.0 } else { -1.0 };
            pieces.add(side, (a - self.t).max(self.t - b), (b - self.t).max(self.t - a))?;
        } else {
            if a < self.t {
                pieces.side(-1.0, (self.t - b).max(0.0), self.t - a)?;
            }
            if b > self.t {
                pieces.side(1.0, (a - self.t).max(0.0), b - self.t)?;
            }
        }
        Ok(pieces.finish(out))
    }

    /// K(x, y) dμ/dt at the point y nearest to distance r on the side `sign`, entry by entry, and the distance that y has; zero where y cannot be told
    /// from x.
    pub(super) fn density(&self, state: usize, sign: f64, r: f64, out: &mut [f64]) -> Result<Option<f64>, Error> {
        let domain = self.kernel.domain();
        let y = domain.displaced(&self.centre, state, sign * r);
        let apart = if self.end.is_some() { None } else { domain.difference(self.x, sign * r) };
        let exact = apart.and_then(|apart| self.kernel.eval_at_difference(self.x, &y.point, apart));
        let distance = if exact.is_some() { r } else { sign * domain.separation(&self.centre, &y.point) };
        if !(distance > 0.0) {
            out.fill(0.0);
            return Ok(None);
        }
        let k = exact.unwrap_or_else(|| self.kernel.eval(self.x, &y.point));
        if !k.entries_finite() {
            return Err(Error::non_finite_kernel(self.x, &y.point, &k));
        }
        let c = components::<K>();
        out.iter_mut().enumerate().for_each(|(e, o)| *o = k.entry(e / c, e % c) * y.weight);
        Ok(Some(distance))
    }
}

/// Twice the smallest distance from a point of coordinate `t` that keeps its bits, or is known exactly.
fn resolved<D: Domain>(domain: &D, x: &D::Point, origin: f64, t: f64, exact: impl Fn(f64) -> bool) -> f64 {
    let inside = |t: f64| (-origin..=1.0 - origin).contains(&t);
    let kept = |d: f64| {
        let apart = |y: &D::Point| domain.separation(x, y);
        !inside(t + d) || (apart(&domain.displaced(x, domain.state(x), d).point) - d).abs() <= DISTANCE_BITS * d.abs()
    };
    let mut resolved = 0.125;
    // factors without a short binary expansion: an accidentally exact sum must not pass
    while resolved > FINEST && [0.685, -0.685, 0.597, -0.597].iter().all(|f| kept(f * resolved) || exact(f * resolved)) {
        resolved *= 0.5;
    }
    2.0 * resolved
}
