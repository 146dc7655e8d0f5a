//! Places where g, K(·, y) or K(x, ·) jump whatever the other variable: the ends of layers. Panels must end there.
//!
//! A difference of neighbours among some hundred places that stands out is bisected down to the spacing of floating-point numbers; what is left of it
//! is a jump, and of a continuous function nothing is left. Jumps closer together than 1/512 of the domain, or small beside the slope around them, are not
//! found here; then panels are halved towards them, or the solve is refused.

use super::near::components;
use crate::domain::Domain;
use crate::equation::Equation;
use crate::kernel::{HasDomain, Kernel, Operator};
use crate::source::Source;
use crate::value::{Value, Weight};

const PLACES: usize = 512;
/// The other variable, at three places.
pub(super) const OTHERS: [f64; 3] = [0.091_3, 0.477_7, 0.883_1];
/// A difference this many times its neighbours' may hide a jump.
const OUTSTANDING: f64 = 4.0;
/// Jumps below this share of the largest value are rounding.
const SMALLEST: f64 = 1e-9;
/// Found from two places x, a jump is one of y alone.
const SAME: f64 = 1e-9;

/// Coordinates of jumps in the interior, ascending.
pub(super) fn jumps<G, K>(equation: &Equation<G, K>) -> Vec<f64>
where
    G: Source,
    K: Kernel + HasDomain + Operator<Point = G::Point>,
    K::Weight: Weight<Value = G::Value>,
{
    let (kernel, domain, c) = (equation.kernel(), equation.kernel().domain(), components::<K>());
    let place = |state: usize, t: f64| domain.place(state, || t).point;
    let mut found = Vec::new();
    for state in 0..domain.states() {
        for e in 0..c {
            found.extend(of(None, |t| equation.source().eval(&place(state, t)).component(e)));
        }
        for other in 0..domain.states() {
            for e in 0..c * c {
                let entry = |x: f64, y: f64| kernel.eval(&place(state, x), &place(other, y)).entry(e / c, e % c);
                let shared = |lists: [Vec<f64>; 3]| {
                    let is_in = |t: f64, list: &Vec<f64>| list.iter().any(|u| (t - u).abs() < SAME);
                    let twice = |t: &f64| lists.iter().filter(|l| is_in(*t, l)).count() >= 2;
                    lists.iter().flatten().copied().filter(twice).collect::<Vec<_>>()
                };
                found.extend(shared(OTHERS.map(|y| of(Some(y), |x| entry(x, y)))));
                found.extend(shared(OTHERS.map(|x| of(Some(x), |y| entry(x, y)))));
            }
        }
    }
    found.sort_by(f64::total_cmp);
    found.dedup_by(|a, b| (*a - *b).abs() < SAME);
    found
}

/// Jumps of one function of the coordinate; not within three places of `diagonal`.
pub(super) fn of(diagonal: Option<f64>, phi: impl Fn(f64) -> f64) -> Vec<f64> {
    let at = |i: usize| (i as f64 + 0.5) / PLACES as f64;
    let values: Vec<f64> = (0..PLACES).map(|i| phi(at(i))).collect();
    let size = values.iter().filter(|v| v.is_finite()).fold(0.0f64, |m, v| m.max(v.abs()));
    let steps: Vec<f64> = values.windows(2).map(|v| (v[1] - v[0]).abs()).collect();
    let mut found = Vec::new();
    for i in 1..steps.len() - 1 {
        let outstanding = steps[i] > OUTSTANDING * steps[i - 1].max(steps[i + 1]) && steps[i] > SMALLEST * size;
        if outstanding && diagonal.is_none_or(|t| (t - at(i)).abs() * PLACES as f64 > 3.0) {
            found.extend(bisected(&phi, (at(i), at(i + 1)), steps[i]));
        }
    }
    found
}

/// Where a difference of `step` between the ends remains one, however close they come.
fn bisected(phi: impl Fn(f64) -> f64, (mut a, mut b): (f64, f64), step: f64) -> Option<f64> {
    let (mut low, mut high) = (phi(a), phi(b));
    loop {
        let middle = 0.5 * (a + b);
        if middle <= a || middle >= b {
            break;
        }
        let value = phi(middle);
        if (value - low).abs() > (high - value).abs() {
            (b, high) = (middle, value);
        } else {
            (a, low) = (middle, value);
        }
    }
    ((high - low).abs() > 0.5 * step).then_some(b)
}

#[cfg(test)]
mod tests {
    use super::jumps;
    use crate::Equation;

    #[test]
    fn layers_are_found_and_nothing_else() {
        let c = |x: f64| if x > 1.0 { 0.9 } else { 0.4 };
        let of_x = Equation::on_interval(0.0..=3.0, |_| 1.0, move |x, y: f64| c(x) * f64::exp(-(x - y).abs()));
        let found = jumps(&of_x);
        assert!(found.len() == 1 && (found[0] - 1.0 / 3.0).abs() < 1e-15, "{found:?}");
        let of_y = Equation::on_interval(0.0..=3.0, |x: f64| x.sqrt(), move |x, y: f64| c(y) * (x - y).abs().ln());
        assert_eq!(jumps(&of_y).len(), 1);
        let of_g = Equation::on_interval(0.0..=1.0, |x: f64| f64::from(x < 0.3) + 5.0 * x, |x, y| x * y);
        assert!((jumps(&of_g)[0] - 0.3).abs() < 1e-15);
        // kinks, singularities and moving jumps are none
        let none = Equation::on_interval(
            0.0..=1.0,
            |x: f64| (x - 0.4).abs().sqrt(),
            |x, y: f64| f64::from((x - y).abs() < 0.2) / (x - y).abs().sqrt(),
        );
        assert_eq!(jumps(&none), Vec::<f64>::new());
    }
}
