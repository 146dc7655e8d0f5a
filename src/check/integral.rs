//! Integrals over the domain that the laws are compared with: adaptive in one dimension, random in more.

use crate::deterministic::quadrature::unit_rule;
use crate::domain::{Domain, Node};
use crate::sampling::{Pcg, Sequence};
use crate::statistics::Moments;
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// Several integrals at once, each with a bound or standard error of what it does not know.
pub(super) struct Integrals<X> {
    pub(super) values: Vec<f64>,
    /// numerical error of the quadrature
    pub(super) errors: Vec<f64>,
    /// standard error, if the integral is random
    pub(super) std_errors: Vec<f64>,
    /// ∫ |F|
    pub(super) scale: Vec<f64>,
    /// first point where an integrand was not finite
    pub(super) fault: Option<X>,
}

struct Panel {
    lower: f64,
    upper: f64,
    values: Vec<f64>,
    errors: Vec<f64>,
    scale: Vec<f64>,
    priority: f64,
}

impl PartialEq for Panel {
    fn eq(&self, other: &Self) -> bool {
        self.priority == other.priority
    }
}
impl Eq for Panel {}
impl PartialOrd for Panel {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}
impl Ord for Panel {
    fn cmp(&self, other: &Self) -> Ordering {
        self.priority.total_cmp(&other.priority)
    }
}

/// Most panels of one integral: 19 evaluations each.
const PANELS: usize = 3000;
/// Narrower panels are below the spacing of floating-point numbers.
const NARROW: f64 = 1e-14;
const TOLERANCE: f64 = 1e-10;

/// One state of a one-dimensional domain between coordinates `range`, with a panel boundary at `split`.
///
/// Panels of largest |G₁₂ − G₇| are halved first; twice the sum of these differences is the reported error.
pub(super) fn adaptive<D: Domain>(
    domain: &D,
    state: usize,
    range: (f64, f64),
    split: f64,
    count: usize,
    mut f: impl FnMut(&D::Point, &mut [f64]),
) -> Integrals<D::Point> {
    let (fine, coarse) = (unit_rule(12), unit_rule(7));
    let mut fault = None;
    let mut panel = |lower: f64, upper: f64| {
        let mut sums = [vec![0.0; count], vec![0.0; count]];
        let mut scale = vec![0.0; count];
        let mut out = vec![0.0; count];
        for (level, (sum, rule)) in sums.iter_mut().zip([&fine, &coarse]).enumerate() {
            for n in rule {
                let t = lower + (upper - lower) * n.point;
                if t <= 0.0 || t >= 1.0 || t == split {
                    continue;
                }
                let y = domain.place(state, || t);
                f(&y.point, &mut out);
                if !out.iter().all(|v| v.is_finite()) {
                    // next to the diagonal y may round to x itself, where a kernel is allowed to be infinite
                    if domain.coordinate(&y.point, 0) != split {
                        fault.get_or_insert(y.point);
                    }
                    continue;
                }
                let w = n.weight * (upper - lower) * y.weight;
                sum.iter_mut().zip(&out).for_each(|(s, v)| *s += w * v);
                if level == 0 {
                    scale.iter_mut().zip(&out).for_each(|(s, v)| *s += w * v.abs());
                }
            }
        }
        let [values, rough] = sums;
        // doubled: on panels next to a singularity both rules err to the same side, and their difference is less than the error
        let errors: Vec<f64> = values.iter().zip(&rough).map(|(a, b)| 2.0 * (a - b).abs()).collect();
        let priority = if upper - lower > NARROW { errors.iter().fold(0.0, |m: f64, e| m.max(*e)) } else { 0.0 };
        Panel { lower, upper, values, errors, scale, priority }
    };
    let mut heap: BinaryHeap<Panel> = start(range, split).windows(2).map(|w| panel(w[0], w[1])).collect();
    let total = |heap: &BinaryHeap<Panel>, part: fn(&Panel) -> &Vec<f64>| {
        heap.iter().fold(vec![0.0; count], |mut sum, p| {
            sum.iter_mut().zip(part(p)).for_each(|(s, v)| *s += v);
            sum
        })
    };
    // priorities are compared with the largest scale: all integrands are of one kind
    let size = total(&heap, |p| &p.scale).iter().fold(0.0, |m: f64, s| m.max(*s));
    let mut left: f64 = heap.iter().map(|p| p.priority).sum();
    while left > TOLERANCE * size && heap.len() < PANELS {
        let Some(worst) = heap.pop() else { break };
        if worst.priority == 0.0 {
            heap.push(worst);
            break;
        }
        let middle = 0.5 * (worst.lower + worst.upper);
        let halves = [panel(worst.lower, middle), panel(middle, worst.upper)];
        left += halves[0].priority + halves[1].priority - worst.priority;
        heap.extend(halves);
    }
    // summed in order of position: the same bits whatever the history of the heap
    let mut panels = heap.into_sorted_vec();
    panels.sort_by(|a, b| a.lower.total_cmp(&b.lower));
    let heap = BinaryHeap::from(panels);
    Integrals {
        values: total(&heap, |p| &p.values),
        errors: total(&heap, |p| &p.errors),
        std_errors: vec![0.0; count],
        scale: total(&heap, |p| &p.scale),
        fault,
    }
}

/// First boundaries: eighths of the range, and grading towards the place where kernels peak.
fn start((lower, upper): (f64, f64), split: f64) -> Vec<f64> {
    let mut cuts: Vec<f64> = (0..=8).map(|i| lower + (upper - lower) * f64::from(i) / 8.0).collect();
    let near = (0..14).flat_map(|i| [split - 0.1 * 0.3f64.powi(i), split + 0.1 * 0.3f64.powi(i)]).chain([split]);
    cuts.extend(near.filter(|t| *t > lower && *t < upper));
    cuts.sort_by(f64::total_cmp);
    cuts.dedup();
    cuts
}

/// The whole domain: adaptive for one continuous coordinate, random points for more.
pub(super) fn whole<D: Domain>(
    domain: &D,
    split: &D::Point,
    count: usize,
    (seed, samples): (u64, u64),
    mut f: impl FnMut(&D::Point, &mut [f64]),
) -> Integrals<D::Point> {
    if domain.dimension() > 1 {
        return random(domain, count, (seed, samples), f);
    }
    let at = domain.coordinate(split, 0);
    let mut sum = adaptive(domain, 0, (0.0, 1.0), at, count, &mut f);
    for state in 1..domain.states() {
        let part = adaptive(domain, state, (0.0, 1.0), at, count, &mut f);
        let add = |a: &mut Vec<f64>, b: &[f64]| a.iter_mut().zip(b).for_each(|(a, b)| *a += b);
        add(&mut sum.values, &part.values);
        add(&mut sum.errors, &part.errors);
        add(&mut sum.scale, &part.scale);
        sum.fault = sum.fault.or(part.fault);
    }
    sum
}

fn random<D: Domain>(
    domain: &D,
    count: usize,
    (seed, samples): (u64, u64),
    mut f: impl FnMut(&D::Point, &mut [f64]),
) -> Integrals<D::Point> {
    let mut fault = None;
    let mut moments = vec![Moments::<f64>::default(); count];
    let mut scale = vec![0.0; count];
    let mut block: Vec<Vec<f64>> = vec![Vec::with_capacity(1024); count];
    let mut out = vec![0.0; count];
    for i in 0..samples {
        let Node { point, weight } = domain.sample(&mut Pcg::new(seed).point(u64::MAX, 7, i));
        f(&point, &mut out);
        if !out.iter().all(|v| v.is_finite()) {
            fault.get_or_insert(point);
            out.fill(0.0);
        }
        for ((b, v), s) in block.iter_mut().zip(&out).zip(&mut scale) {
            b.push(weight * v);
            *s += weight * v.abs() / samples as f64;
        }
        if block[0].len() == 1024 || i + 1 == samples {
            for (m, b) in moments.iter_mut().zip(&mut block) {
                m.merge(&Moments::from_scores(b));
                b.clear();
            }
        }
    }
    Integrals {
        values: moments.iter().map(|m| m.mean).collect(),
        errors: vec![0.0; count],
        std_errors: moments.iter().map(|m| m.std_error().unwrap_or(f64::INFINITY)).collect(),
        scale,
        fault,
    }
}

#[cfg(test)]
mod tests {
    use super::adaptive;
    use crate::domain::Interval;

    #[test]
    fn singularities_jumps_and_peaks_are_integrated_within_the_stated_error() {
        let unit = Interval::from(0.0..=1.0);
        let at = 0.3f64;
        let exact = [
            at * (at.ln() - 1.0) + 0.7 * (0.7f64.ln() - 1.0),
            2.0 * (at.sqrt() + 0.7f64.sqrt()),
            0.3,
            ((0.7f64 / 1e-4).atan() + (0.3f64 / 1e-4).atan()) / std::f64::consts::PI,
        ];
        let r = adaptive(&unit, 0, (0.0, 1.0), at, 4, |y, out| {
            let t = (y - at).abs();
            out.copy_from_slice(&[t.ln(), t.powf(-0.5), f64::from(*y > 0.7), 1e-4 / (std::f64::consts::PI * (1e-8 + t * t))]);
        });
        for ((value, stated), exact) in r.values.iter().zip(&r.errors).zip(exact) {
            let error = (value - exact).abs();
            assert!(error <= stated + 1e-12, "{exact}: {error} > {stated}");
            assert!(*stated < 1e-6, "{exact}: {stated}");
        }
        assert!(r.fault.is_none());
    }
}
