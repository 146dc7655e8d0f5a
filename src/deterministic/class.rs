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
use crate::domain::Domain;
use crate::error::Error;
use crate::kernel::{HasDomain, Kernel};
use crate::sampling::{Pcg, Sampler, Sequence};
use crate::value::Weight;
use nalgebra::DMatrix;
use std::fmt;

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
    /// K(x, ·) is singular at the lower and at the upper end of the domain.
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

impl fmt::Display for Diagonal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Diagonal::Smooth => write!(f, "smooth"),
            Diagonal::Peaked { width } => write!(f, "peaked on the diagonal, half width {width:.1e} of the domain"),
            Diagonal::Kink => write!(f, "a kink on the diagonal"),
            Diagonal::Jump => write!(f, "a jump on the diagonal"),
            Diagonal::Logarithmic => write!(f, "logarithmic on the diagonal"),
            Diagonal::Algebraic { exponent } if *exponent > 0.0 => write!(f, "|x − y|^−{exponent:.2} on the diagonal"),
            Diagonal::Algebraic { exponent } => write!(f, "|x − y|^{:.2} on the diagonal", -exponent),
            Diagonal::NotIntegrable { exponent } => write!(f, "|x − y|^−{exponent:.2} on the diagonal: not integrable"),
        }
    }
}

impl fmt::Display for KernelClass {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.diagonal)?;
        if self.toeplitz {
            write!(f, ", a function of x − y")?;
        }
        if self.symmetric && !self.toeplitz {
            write!(f, ", symmetric")?;
        }
        if self.periodic {
            write!(f, ", periodic")?;
        }
        if let Some(rank) = self.rank {
            write!(f, ", rank {rank}")?;
        }
        match self.singular_ends {
            [true, true] => write!(f, ", singular in y at both ends")?,
            [true, false] => write!(f, ", singular in y at the lower end")?,
            [false, true] => write!(f, ", singular in y at the upper end")?,
            [false, false] => {}
        }
        if let Some(h) = self.half_wave {
            write!(f, ", oscillating with half waves of {h:.1e} of the domain")?;
        }
        Ok(())
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
const MOST_RANK: usize = 24;
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
    Ok(KernelClass {
        diagonal,
        toeplitz: linear && values.same(|t, u, h| ((t, u), (t + h, u + h))),
        symmetric: values.same(|t, u, _| ((t, u), (u, t))),
        periodic: linear && smooth && values.periodic(),
        rank: if smooth { values.rank() } else { None },
        singular_ends: Ends::of_kernel(kernel).rows,
        half_wave: values.half_wave(),
    })
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
        let (Side::Limit { value: a, slope: s, half: h }, Side::Limit { value: b, slope: r, half: l }) = (&left, &right) else {
            let worse = |side: &Side| if let Side::Singular(d) = side { *d } else { Diagonal::Smooth };
            return Ok(if worse(&left) > worse(&right) { worse(&left) } else { worse(&right) });
        };
        let size = a.abs().max(b.abs());
        Ok(if (a - b).abs() > 1e-6 * size {
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
        let values = matrix.singular_values();
        let rank = values.iter().filter(|s| **s > 1e-12 * values[0]).count();
        (rank <= MOST_RANK).then_some(rank)
    }

    fn half_wave(&self) -> Option<f64> {
        const STEPS: usize = 2048;
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

/// K towards the diagonal from one side.
enum Side {
    /// A limit, the slope against the distance, and the distance at which half of the limit is left (1 if nowhere).
    Limit {
        value: f64,
        slope: f64,
        half: f64,
    },
    Singular(Diagonal),
}

impl Side {
    fn of(distances: &[f64], values: &[f64]) -> Self {
        let size = values.iter().fold(0.0f64, |m, v| m.max(v.abs()));
        let value = values.last().copied().unwrap_or(0.0);
        let Some((growth, first)) = growth(values, NOISE * size) else {
            return Side::Limit { value, slope: 0.0, half: half(distances, values) };
        };
        let step = values[first + 4] - values[first + 3];
        let exponent = growth.log2();
        // differences that fall like r² or faster: the slope is 0
        let slope = if growth < 0.35 { 0.0 } else { step / (distances[first + 4] - distances[first + 3]) };
        match growth {
            g if g >= 2f64.powf(0.985) => Side::Singular(Diagonal::NotIntegrable { exponent }),
            g if (g - 1.0).abs() < 0.02 => Side::Singular(Diagonal::Logarithmic),
            // r ln r comes close to ½ slowly
            g if g > 0.57 => Side::Singular(Diagonal::Algebraic { exponent }),
            _ => Side::Limit { value, slope, half: half(distances, values) },
        }
    }
}

/// By what the differences of values along halved distances grow in the deepest four in a row above `noise`, and the first of them.
pub(super) fn growth(values: &[f64], noise: f64) -> Option<(f64, usize)> {
    let steps: Vec<f64> = values.windows(2).map(|v| v[1] - v[0]).collect();
    let above = |w: &[f64]| w.iter().all(|d| d.abs() > noise);
    let first = (0..steps.len().saturating_sub(3)).rev().find(|&k| above(&steps[k..k + 4]))?;
    Some((((steps[first + 3] / steps[first]).abs().ln() / 3.0).exp(), first))
}

/// The largest distance below which all values keep more than half of the innermost one.
fn half(distances: &[f64], values: &[f64]) -> f64 {
    let top = values.last().map_or(0.0, |v| v.abs());
    if top == 0.0 {
        return 1.0;
    }
    distances.iter().zip(values).rev().find(|(_, v)| v.abs() < 0.5 * top).map_or(1.0, |(r, _)| *r)
}
