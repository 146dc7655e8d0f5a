//! Ends of the domain: where K(x, y) is singular in y, and where f is going to be.
//!
//! Along distances d = 2^{−k} from an end the differences of values tell a singularity as they do on the diagonal ([`class`](super::class)): they fall to ½ or less
//! where a slope exists. Panels at an end where K(x, ·) has none are integrated by pieces cut towards it, as those at y = x are: log y, y^{−½},
//! (1 − y²)^{β(x)} then cost nothing of the order. Where x is on the same panel, the pieces meet half way between x and the end.

use super::basis::Basis;
use super::class::{NOISE, PLACES};
use super::near::{Target, components};
use super::side::growth;
use crate::domain::{Domain, Point};
use crate::equation::Equation;
use crate::error::Error;
use crate::kernel::{HasDomain, Kernel, Operator};
use crate::source::Source;
use crate::value::{Value, Weight};

/// Differences that fall less than to this are those of a singularity: r ln r comes to ½ slowly.
pub(super) const SINGULAR: f64 = 0.505;
/// Those of a logarithm stay as they are, those of d^{−β} grow.
const UNBOUNDED: f64 = 0.98;
/// ∫ d^{−½} below this distance is nothing.
const FINE: f64 = 1e-29;
/// Closest place to an end, in units of the distance of which half is kept when points are rounded: 4096 times one that keeps 16 bits.
const HELD_OFF: f64 = 4096.0 * 65_536.0;
/// Distances are halved so often, from a sixteenth of the domain.
const FARTHEST: f64 = 1.0 / 16.0;
const HALVINGS: i32 = 34;

/// What is singular at coordinates 0 and 1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Ends {
    /// K(x, ·), for x inside or at the other end
    pub(crate) rows: [bool; 2],
    /// K(x, ·) grows beyond all bounds
    pub(crate) unbounded: [bool; 2],
    /// g, or K(·, y)
    pub(crate) solution: [bool; 2],
}

impl Ends {
    /// With those of g; those of the kernel are known.
    pub(super) fn of<G, K>(equation: &Equation<G, K>, of_kernel: Ends) -> Self
    where
        G: Source,
        K: Kernel + HasDomain + Operator<Point = G::Point>,
        K::Weight: Weight<Value = G::Value>,
    {
        let domain = equation.kernel().domain();
        let mut ends = of_kernel;
        for (i, end) in [0.0, 1.0].into_iter().enumerate().filter(|(_, end)| is_end(domain, *end)) {
            let along = Approach::to(domain, end);
            for (state, e) in (0..domain.states()).flat_map(|s| (0..G::Value::COMPONENTS).map(move |e| (s, e))) {
                ends.solution[i] |= along.growth(domain, state, |y| equation.source().eval(y).component(e)) > SINGULAR;
            }
        }
        ends
    }

    /// Those of the kernel alone.
    pub(super) fn of_kernel<K: Kernel + HasDomain>(kernel: &K) -> Self {
        let (domain, c) = (kernel.domain(), components::<K>());
        let mut ends = Ends::default();
        for (i, end) in [0.0, 1.0].into_iter().enumerate().filter(|(_, end)| is_end(domain, *end)) {
            let along = Approach::to(domain, end);
            for (t, states) in PLACES.iter().flat_map(|t| (0..domain.states().pow(2)).map(move |s| (t, s))) {
                let (from, to) = (states / domain.states(), states % domain.states());
                let x = domain.place(from, || *t).point;
                let row = |y: &K::Point, e: usize| kernel.eval(&x, y).entry(e / c, e % c);
                let column = |y: &K::Point, e: usize| kernel.eval(y, &x).entry(e / c, e % c);
                for e in 0..c * c {
                    let growth = along.growth(domain, to, |y| row(y, e));
                    ends.rows[i] |= growth > SINGULAR;
                    ends.unbounded[i] |= growth > UNBOUNDED;
                    ends.solution[i] |= along.growth(domain, to, |y| column(y, e)) > SINGULAR;
                }
            }
            ends.rows[i] |= domain.volume().is_finite() && along.is_singular_from_the_other(kernel);
        }
        ends
    }

    /// Rows integrated towards every end there is.
    pub(super) fn all<D: Domain>(domain: &D) -> Self {
        Ends { rows: [0.0, 1.0].map(|end| is_end(domain, end)), ..Ends::default() }
    }

    /// Whether any of it is.
    fn any(self) -> bool {
        self != Ends::default()
    }

    /// Whether [double-exponential nodes](super::double_exponential) are for this: singular ends, and distances from them to as many digits as it takes.
    pub(super) fn are_for_double_exponential<D: Domain>(self, domain: &D) -> bool {
        let fine = |i: usize| !self.unbounded[i] || reach(domain, i as f64) < FINE;
        self.any() && fine(0) && fine(1) && !domain.is_periodic(0)
    }

    /// x, but not closer to an end where K(x, ·) is unbounded than values of K can tell what is singular at x from what is at the end.
    pub(super) fn held_off<D: Domain>(self, domain: &D, x: &D::Point) -> D::Point {
        for (end, _) in [0.0, 1.0].into_iter().zip(self.unbounded).filter(|(_, unbounded)| *unbounded) {
            let (reach, at) = (reach(domain, end), domain.place(domain.state(x), || end).point);
            let closest = HELD_OFF * reach;
            if reach > FINE && domain.separation(&at, x).abs() < closest {
                return domain.displaced(&at, domain.state(x), (1.0 - 2.0 * end) * closest).point;
            }
        }
        *x
    }

    /// The end, 0 or 1, towards which rows are integrated on panel `p` of `count`.
    pub(super) fn at(self, p: usize, count: usize) -> Option<f64> {
        match self.rows {
            [true, _] if p == 0 => Some(0.0),
            [_, true] if p + 1 == count => Some(1.0),
            _ => None,
        }
    }
}

/// Whether functions may be singular at coordinate `end`: not at infinity, nor where they continue periodically.
pub(super) fn is_end<D: Domain>(domain: &D, end: f64) -> bool {
    domain.dimension() == 1 && !domain.is_periodic(0) && domain.place(0, || end).weight.is_finite()
}

/// Whether g is the same at both ends.
pub(super) fn is_periodic<G, K>(equation: &Equation<G, K>) -> bool
where
    G: Source,
    K: HasDomain + Operator<Point = G::Point>,
    K::Weight: Weight<Value = G::Value>,
{
    const SAME: f64 = 1e-11;
    let domain = equation.kernel().domain();
    (0..domain.states()).all(|state| {
        let [a, b] = [0.0, 1.0].map(|t| equation.source().eval(&domain.place(state, || t).point));
        (a + b.scale(-1.0)).magnitude() <= SAME * a.magnitude().max(b.magnitude())
    })
}

/// What K has beyond the outermost panels of an infinite domain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Tail {
    /// K ~ |y|^−power
    pub(super) power: f64,
    /// ∫ |K| there
    pub(super) mass: f64,
}

impl Tail {
    /// The error of n nodes over what m < n nodes change, at least 1: both leave n^{−2q} of |y|^{−1−q}, q < 1, towards infinity, and half as much again
    /// where few nodes are not there yet.
    pub(super) fn alike(self, m: usize, n: usize) -> f64 {
        const EARLY: f64 = 1.5;
        1.0f64.max(EARLY / ((n as f64 / m as f64).powf(2.0 * (self.power - 1.0)) - 1.0))
    }
}

/// The heaviest tail of K(x, ·), where it is no smooth function of the coordinate: powers below 2.
pub(super) fn tail<K: Kernel + HasDomain>(kernel: &K) -> Option<Tail> {
    const OUTERMOST: f64 = 1.0 / (1u64 << 42) as f64;
    let (domain, c) = (kernel.domain(), components::<K>());
    let mut worst: Option<Tail> = None;
    for end in [0.0, 1.0].into_iter().filter(|end| domain.dimension() == 1 && !domain.place(0, || *end).weight.is_finite()) {
        for (t, states) in PLACES.iter().flat_map(|t| (0..domain.states().pow(2)).map(move |s| (t, s))) {
            let x = domain.place(states / domain.states(), || *t).point;
            let octave = |d: f64| {
                let y = domain.place(states % domain.states(), || (end - d).abs());
                let k = kernel.eval(&x, &y.point);
                (0..c * c).map(|e| k.entry(e / c, e % c).abs()).fold(0.0, f64::max) * y.weight * d
            };
            let (outer, inner) = (octave(OUTERMOST), octave(16.0 * OUTERMOST));
            let growth = (inner / outer).log2() / 4.0;
            if outer > 0.0 && growth < 0.95 {
                let mass = if growth > 0.02 { outer / growth } else { f64::INFINITY };
                if worst.is_none_or(|w| w.mass < mass) {
                    worst = Some(Tail { power: 1.0 + growth, mass });
                }
            }
        }
    }
    worst
}

/// Smallest distance from an end at which half of it is kept when the point is rounded; 2^{−100} if all are.
pub(super) fn reach<D: Domain>(domain: &D, end: f64) -> f64 {
    const SMALLEST: f64 = 1.0 / (1u128 << 100) as f64;
    if !is_end(domain, end) {
        return f64::EPSILON;
    }
    let (at, sign) = (domain.place(0, || end).point, 1.0 - 2.0 * end);
    let kept = |d: f64| (sign * domain.separation(&at, &domain.displaced(&at, 0, sign * d).point) / d - 1.0).abs() < 0.5;
    let mut d = 0.125;
    while d > SMALLEST && kept(0.685 * 0.5 * d) && kept(0.597 * 0.5 * d) {
        d *= 0.5;
    }
    d
}

/// Distances towards an end.
struct Approach {
    end: f64,
    distances: Vec<f64>,
}

impl Approach {
    fn to<D: Domain>(domain: &D, end: f64) -> Self {
        // what rounding does to distances must stay below what is asked of their differences
        let resolved = 256.0 * reach(domain, end);
        let distances = (0..HALVINGS).map(|k| FARTHEST * 0.5f64.powi(k)).filter(|d| *d > resolved).collect();
        Approach { end, distances }
    }

    /// Whether rows at the other end are singular at this one, as those of a circle that was cut are.
    fn is_singular_from_the_other<K: Kernel + HasDomain>(&self, kernel: &K) -> bool {
        let (domain, c) = (kernel.domain(), components::<K>());
        (0..domain.states().pow(2)).any(|states| {
            let x = domain.place(states / domain.states(), || 1.0 - self.end).point;
            let row = |e: usize| move |y: &K::Point| kernel.eval(&x, y).entry(e / c, e % c);
            (0..c * c).any(|e| self.growth(domain, states % domain.states(), row(e)) > SINGULAR)
        })
    }

    /// By what differences of φ grow when the distance is halved; 0 where there are none to speak of.
    fn growth<D: Domain>(&self, domain: &D, state: usize, phi: impl Fn(&D::Point) -> f64) -> f64 {
        let (at, sign) = (domain.place(state, || self.end).point, 1.0 - 2.0 * self.end);
        let value = |d: &f64| phi(&domain.displaced(&at, state, sign * d).point);
        let values: Vec<f64> = self.distances.iter().map(value).take_while(|v| v.is_finite()).collect();
        let size = values.iter().fold(0.0f64, |m, v| m.max(v.abs()));
        growth(&values, NOISE * size).map_or(0.0, |(growth, _)| growth)
    }
}

/// ∫ K(x, y) ℓ_k(y) dμ(y) over a panel at an end where K(x, ·) is singular, as [`Target::moments`] adds it to `out`; `at_x` is the target at x.
pub(super) fn moments<K: Kernel + HasDomain>(
    at_x: &Target<'_, K>,
    end: f64,
    state: usize,
    panel: (f64, f64),
    (basis, rule): (&Basis, &Basis),
    out: &mut [f64],
) -> Result<u64, Error>
where
    K::Point: Point,
{
    let domain = at_x.kernel.domain();
    let at_end = Target::towards_end(at_x.kernel, at_x.x, end);
    let distance = domain.separation(&at_end.centre, at_x.x).abs();
    if !at_x.is_near(panel) {
        return at_end.moments(state, panel, basis, rule, out);
    }
    // x is the end: what is singular at either is so at x
    if distance <= 2.0 * at_end.resolved {
        return at_x.moments(state, panel, basis, rule, out);
    }
    let (a, b) = panel;
    let (outer, inner) = if end == 0.0 {
        let middle = (0.5 * distance).min(b);
        ((a, middle), (middle, b))
    } else {
        let middle = (1.0 - 0.5 * distance).max(a);
        ((middle, b), (a, middle))
    };
    let evaluations = at_end.beside(distance).moments_over(state, panel, outer, basis, rule, out)?;
    let rest = inner.1 > inner.0;
    Ok(evaluations + if rest { at_x.beside(0.5 * distance).moments_over(state, panel, inner, basis, rule, out)? } else { 0 })
}

/// The same over a panel near to several places where K(x, ·) is singular: each has what is closer to it than to any other.
pub(super) fn moments_among<K: Kernel + HasDomain>(
    mut targets: Vec<Target<'_, K>>,
    state: usize,
    panel: (f64, f64),
    (basis, rule): (&Basis, &Basis),
    out: &mut [f64],
) -> Result<u64, Error> {
    targets.sort_by(|a, b| a.place().total_cmp(&b.place()));
    let middle = |i: usize| 0.5 * (targets[i].place() + targets[i + 1].place());
    let mut evaluations = 0;
    for (i, target) in targets.iter().enumerate() {
        let low = if i == 0 { panel.0 } else { middle(i - 1).clamp(panel.0, panel.1) };
        let high = if i + 1 == targets.len() { panel.1 } else { middle(i).clamp(panel.0, panel.1) };
        if high > low {
            let room = (target.place() - low).abs().min((high - target.place()).abs());
            let apart = if targets.len() == 1 { f64::INFINITY } else { room };
            evaluations += target.beside(apart).moments_over(state, panel, (low, high), basis, rule, out)?;
        }
    }
    Ok(evaluations)
}
