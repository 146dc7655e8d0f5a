//! What a kernel on a line looks like, from point values alone (problems §5b).
//!
//! Along r = 2^{−k} towards the diagonal, on both sides, the differences Δ_k = K(r_{k+1}) − K(r_k) tell the type by the limit of Δ_{k+1}/Δ_k:
//!
//! ```text
//! 2^α: |x − y|^{−α}      1: log|x − y|      ½ or less: a limit and a slope exist
//! ```
//!
//! Limits that differ between the sides make a jump, slopes a kink. Eight places x are probed: what happens only elsewhere is not seen, and the solver does
//! not rely on it: it refines where values say so, whatever the class.

use super::ends::Ends;
use super::near::components;
use super::side::{Side, cross_rank};
use crate::contained::contained;
use crate::domain::Domain;
use crate::error::Error;
use crate::kernel::{HasDomain, Kernel};
use crate::sampling::{Pcg, Sampler, Sequence};
use crate::value::Weight;
use nalgebra::DMatrix;

/// How K(x, y) behaves at y = x, in order of difficulty.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
#[non_exhaustive]
pub enum Diagonal {
    /// Analytic across the diagonal, as far as values tell.
    Smooth,
    /// Smooth, with a peak on the diagonal that falls to half its height at distance `width`, in units of the map's coordinate (1 = the whole interval).
    Peaked {
        /// Half width at half maximum.
        width: f64,
    },
    /// Continuous, with a slope that differs between the sides: Green's functions, e^{−|x−y|}.
    Kink,
    /// Different limits on the two sides: Volterra kernels.
    Jump,
    /// log|x − y|, E₁(|x − y|).
    Logarithmic,
    /// |x − y|^{−α}; negative for |x − y|^β, β < 1.
    Algebraic {
        /// α < 1.
        exponent: f64,
    },
    /// |x − y|^{−α} with α ≥ 1: no integral exists.
    NotIntegrable {
        /// α.
        exponent: f64,
    },
}

/// What [`classify`] found.
///
/// `Display` says it in words.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct KernelClass {
    /// The worst behaviour on the diagonal, over places, states and components.
    pub diagonal: Diagonal,
    /// K is a function of x − y (finite intervals only).
    pub toeplitz: bool,
    /// K(x, y) = K(y, x).
    pub symmetric: bool,
    /// K and its slopes agree at both ends of a finite interval.
    pub periodic: bool,
    /// Numerical rank to 12 digits, if it is at most 24.
    pub rank: Option<usize>,
    /// K(x, ·) is singular at the lower and at the upper end of the domain, for x inside or at the other end.
    pub singular_ends: [bool; 2],
    /// Mean distance between zeros of a row in units of the coordinate, if there are more than eight.
    pub half_wave: Option<f64>,
}

impl Diagonal {
    /// The same type, exponents within a twentieth; a peak is smooth.
    pub(super) fn is_like(self, other: Diagonal) -> bool {
        use Diagonal::{Algebraic, Peaked, Smooth};
        match (self, other) {
            (Smooth | Peaked { .. }, Smooth | Peaked { .. }) => true,
            (Algebraic { exponent: a }, Algebraic { exponent: b }) => (a - b).abs() < 0.05,
            (a, b) => std::mem::discriminant(&a) == std::mem::discriminant(&b),
        }
    }
}

/// Places x and distances 2^{−k} of the room on each side.
pub(super) const PLACES: [f64; 8] = [0.0731, 0.1877, 0.3119, 0.4271, 0.5393, 0.6637, 0.7919, 0.9283];
const FINEST: i32 = 40;
/// Differences below this share of the values are rounding.
pub(super) const NOISE: f64 = 1e-9;
/// A peak narrower than this counts as one.
const NARROW: f64 = 0.06;
/// Most rank that is worth a word, and the size of the sample it is found on.
pub(super) const MOST_RANK: usize = 24;
const SAMPLE: usize = 40;

/// Probes a kernel on a one-dimensional domain (times groups) by some thousands of values.
///
/// ```
/// use fredholm::{deterministic::{classify, Diagonal}, domain::Interval, kernel::kernel_fn};
/// let class = classify(&kernel_fn(Interval::from(0.0..=2.0), |x: &f64, y: &f64| -(x - y).abs().ln()))?;
/// assert_eq!(class.diagonal, Diagonal::Logarithmic);
/// assert_eq!(class.to_string(), "logarithmic on the diagonal, a function of x − y");
/// # Ok::<(), fredholm::Error>(())
/// ```
///
/// # Errors
/// [`Error::Invalid`] for more than one dimension; [`Error::NonFiniteKernel`] with the place where K is not finite on the way to the diagonal.
pub fn classify<K: Kernel + HasDomain>(kernel: &K) -> Result<KernelClass, Error> {
    contained(|| Ok(classified(kernel)?.0))
}

/// The same with what is singular at the ends.
pub(super) fn classified<K: Kernel + HasDomain>(kernel: &K) -> Result<(KernelClass, Ends), Error> {
    let domain = kernel.domain();
    domain.validate()?;
    if domain.dimension() != 1 {
        return Err(Error::invalid("dimension", domain.dimension() as f64, "kernels are classified on one-dimensional domains"));
    }
    let values = Values { kernel };
    let mut diagonal = Diagonal::Smooth;
    for t in PLACES {
        for pair in 0..domain.states() * domain.states() {
            for entry in 0..components::<K>().pow(2) {
                let here = values.diagonal(t, (pair / domain.states(), pair % domain.states()), entry)?;
                if here > diagonal {
                    diagonal = here;
                }
            }
        }
    }
    let linear = domain.volume().is_finite();
    let smooth = matches!(diagonal, Diagonal::Smooth | Diagonal::Peaked { .. });
    let ends = Ends::of_kernel(kernel);
    let class = KernelClass {
        diagonal,
        toeplitz: linear && values.same(|t, u, h| ((t, u), (t + h, u + h))),
        symmetric: values.same(|t, u, _| ((t, u), (u, t))),
        periodic: linear && smooth && values.periodic(),
        rank: if smooth { values.rank() } else { None },
        singular_ends: ends.rows,
        half_wave: values.half_wave(),
    };
    Ok((class, ends))
}

struct Values<'a, K> {
    kernel: &'a K,
}

impl<K: Kernel + HasDomain> Values<'_, K> {
    /// K at two coordinates of states (i, j), entry `e`; NaN where it is not finite, which no comparison passes.
    fn at(&self, t: f64, u: f64, (i, j): (usize, usize), e: usize) -> f64 {
        let (domain, c) = (self.kernel.domain(), components::<K>());
        let (x, y) = (domain.place(i, || t).point, domain.place(j, || u).point);
        let k = self.kernel.eval(&x, &y);
        if k.entries_finite() { k.entry(e / c, e % c) } else { f64::NAN }
    }

    /// The worse of the two sides of one place, or what their limits make together.
    fn diagonal(&self, t: f64, states: (usize, usize), e: usize) -> Result<Diagonal, Error> {
        let (left, right) = (self.side(t, -1.0, states, e)?, self.side(t, 1.0, states, e)?);
        let (Side::Limit { value: a, slope: s, half: h, largest: m }, Side::Limit { value: b, slope: r, half: l, largest: n }) =
            (&left, &right)
        else {
            let worse = |side: &Side| if let Side::Singular(d) = side { *d } else { Diagonal::Smooth };
            return Ok(if worse(&left) > worse(&right) { worse(&left) } else { worse(&right) });
        };
        let size = a.abs().max(b.abs());
        // where K is 0 on the diagonal, the innermost values are what is left of its slope
        Ok(if (a - b).abs() > 1e-6 * size && (a - b).abs() > NOISE * m.max(*n) {
            Diagonal::Jump
        } else if (s + r).abs() > 1e-3 * (s.abs() + r.abs()) && (s + r).abs() > 1e-6 * size {
            Diagonal::Kink
        } else if h.max(*l) < NARROW {
            Diagonal::Peaked { width: h.max(*l) }
        } else {
            Diagonal::Smooth
        })
    }

    fn side(&self, t: f64, sign: f64, (i, j): (usize, usize), e: usize) -> Result<Side, Error> {
        let (domain, c) = (self.kernel.domain(), components::<K>());
        let room = 0.9 * if sign > 0.0 { 1.0 - t } else { t };
        let x = domain.place(i, || t).point;
        let (mut distances, mut values) = (Vec::new(), Vec::new());
        for k in 0..=FINEST {
            let y = domain.displaced(&x, j, sign * room * 0.5f64.powi(k)).point;
            let r = sign * domain.separation(&x, &y);
            if !(r > 0.0) {
                break;
            }
            let v = self.kernel.eval(&x, &y);
            if !v.entries_finite() {
                return Err(Error::non_finite_kernel(&x, &y, &v));
            }
            distances.push(r);
            values.push(v.entry(e / c, e % c));
        }
        Ok(Side::of(&distances, &values))
    }

    /// Whether K agrees at pairs of places made from random (t, u, h) that stay inside.
    fn same(&self, pairs: impl Fn(f64, f64, f64) -> ((f64, f64), (f64, f64))) -> bool {
        let mut random = Pcg::default().point(u64::MAX - 2, 0, 0);
        let (states, c) = (self.kernel.domain().states(), components::<K>());
        for _ in 0..48 {
            let (t, u, h) = (0.5 * random.next_1d(), 0.5 * random.next_1d(), 0.5 * random.next_1d());
            let (a, b) = pairs(t, u, h);
            for s in 0..states * states * c * c {
                let (state, e) = ((s / (c * c) / states, s / (c * c) % states), s % (c * c));
                let (p, q) = (self.at(a.0, a.1, state, e), self.at(b.0, b.1, state, e));
                // a steep kernel feels the rounding of its places
                if !((p - q).abs() <= 1e-9 * p.abs().max(q.abs())) {
                    return false;
                }
            }
        }
        true
    }

    fn periodic(&self) -> bool {
        const STEP: f64 = 1.0 / 4096.0;
        let (states, c) = (self.kernel.domain().states(), components::<K>());
        for u in PLACES {
            for s in 0..states * states * c * c {
                let (state, e) = ((s / (c * c) / states, s / (c * c) % states), s % (c * c));
                let along = |t: f64| [self.at(t, u, state, e), self.at(u, t, state, e)];
                let (a, a1, b1, b) = (along(0.0), along(STEP), along(1.0 - STEP), along(1.0));
                for k in 0..2 {
                    let size = a[k].abs().max(b[k].abs());
                    let slopes = (a1[k] - a[k], b[k] - b1[k]);
                    // second differences of a smooth periodic function are of the order of the step
                    let straight = (slopes.0 - slopes.1).abs() <= 0.1 * (slopes.0.abs() + slopes.1.abs()) + 1e-4 * size;
                    if !((a[k] - b[k]).abs() <= 1e-11 * size && straight) {
                        return false;
                    }
                }
            }
        }
        true
    }

    fn rank(&self) -> Option<usize> {
        let (states, c) = (self.kernel.domain().states(), components::<K>());
        if states * c > 1 {
            return None;
        }
        let mut matrix = DMatrix::zeros(SAMPLE, SAMPLE);
        for (i, j) in (0..SAMPLE).flat_map(|i| (0..SAMPLE).map(move |j| (i, j))) {
            // Chebyshev places: equispaced ones would hide what happens at the ends
            let place = |i: usize| 0.5 - 0.5 * (std::f64::consts::PI * (i as f64 + 0.5) / SAMPLE as f64).cos();
            matrix[(i, j)] = self.at(place(i), place(j), (0, 0), 0);
        }
        if matrix.iter().any(|k| k.is_nan()) {
            return None;
        }
        cross_rank(matrix)
    }

    fn half_wave(&self) -> Option<f64> {
        const STEPS: usize = 512;
        let mut most = 0;
        for t in [PLACES[1], PLACES[5]] {
            let (mut last, mut zeros) = (0.0f64, 0);
            for i in 0..STEPS {
                let u = (i as f64 + 0.5) / STEPS as f64;
                let k = self.at(t, u, (0, 0), 0);
                zeros += usize::from(k * last < 0.0);
                last = k;
            }
            most = most.max(zeros);
        }
        (most > 8).then(|| 1.0 / most as f64)
    }
}
