//! Places where g, K(·, y) or K(x, ·) jump, have a kink or are singular whatever the other variable: the ends of layers. Panels must end there.
//!
//! A difference of neighbours among some hundred places that stands out is bisected down to the spacing of floating-point numbers; what is left of it
//! is a jump, and of a continuous function nothing is left. Second differences that stand out are followed in the same way to kinks. Jumps closer together than 1/512 of the domain, or small beside the slope around them, are not
//! found here; then panels are halved towards them, or the solve is refused.

use super::ends::SINGULAR;
use super::near::components;
use super::side::growth;
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
/// Second differences fall to 1/16 of a smooth function, to 1/4 at a kink, more or less, when the spacing does to 1/4; so often before rounding.
const SQUARE: f64 = 0.09;
const LEVELS: usize = 8;
const ROUNDING: f64 = 1e-13;
/// Places around a kink that do not know of it.
const BESIDE: usize = 3;
/// Distances at which rows tell what they are at a place: so far from it, and halved so often.
const NEAR: f64 = 1.0 / 64.0;
const HALVINGS: i32 = 26;
/// Found from two places x, a jump is one of y alone.
const SAME: f64 = 1e-9;

/// Jumps along rows at [`OTHERS`], of every pair of states (from, to) and entry in turn.
pub(super) fn along_rows<K: Kernel + HasDomain>(kernel: &K) -> Vec<[Vec<f64>; 3]> {
    let (domain, c) = (kernel.domain(), components::<K>());
    let place = |state: usize, t: f64| domain.place(state, || t).point;
    let all = (0..domain.states().pow(2)).flat_map(|s| (0..c * c).map(move |e| (s / domain.states(), s % domain.states(), e)));
    let rows = |(from, to, e): (usize, usize, usize)| {
        OTHERS.map(|t| of(Some(t), |u| kernel.eval(&place(from, t), &place(to, u)).entry(e / c, e % c)))
    };
    all.map(rows).collect()
}

/// Coordinates of jumps in the interior, ascending; those along rows are known.
pub(super) fn jumps<G, K>(equation: &Equation<G, K>, rows: &[[Vec<f64>; 3]]) -> Vec<f64>
where
    G: Source,
    K: Kernel + HasDomain + Operator<Point = G::Point>,
    K::Weight: Weight<Value = G::Value>,
{
    let (kernel, domain, c) = (equation.kernel(), equation.kernel().domain(), components::<K>());
    let place = |state: usize, t: f64| domain.place(state, || t).point;
    let mut found: Vec<f64> = rows.iter().flat_map(shared).collect();
    for state in 0..domain.states() {
        for e in 0..c {
            found.extend(of(None, |t| equation.source().eval(&place(state, t)).component(e)));
        }
        for (other, e) in (0..domain.states()).flat_map(|s| (0..c * c).map(move |e| (s, e))) {
            let entry = |x: f64, y: f64| kernel.eval(&place(state, x), &place(other, y)).entry(e / c, e % c);
            found.extend(shared(&OTHERS.map(|y| of(Some(y), |x| entry(x, y)))));
        }
    }
    found.sort_by(f64::total_cmp);
    found.dedup_by(|a, b| (*a - *b).abs() < SAME);
    found
}

/// Coordinates u in the interior where K(x, ·) is singular, x wherever it is: panels that end there are not enough.
pub(super) fn singular_columns<K: Kernel + HasDomain>(kernel: &K, rows: &[[Vec<f64>; 3]]) -> Vec<f64> {
    let (domain, c) = (kernel.domain(), components::<K>());
    let mut found: Vec<f64> = Vec::new();
    for (i, lists) in rows.iter().enumerate() {
        let (from, to, e) = (i / (c * c) / domain.states(), i / (c * c) % domain.states(), i % (c * c));
        let x = domain.place(from, || OTHERS[1]).point;
        let value = |u: f64| kernel.eval(&x, &domain.place(to, || u).point).entry(e / c, e % c);
        let growth = |u: f64, side: f64| {
            let values: Vec<f64> = (0..HALVINGS).map(|k| value(u + side * NEAR * 0.5f64.powi(k))).collect();
            growth(&values, SMALLEST * values.iter().fold(0.0f64, |m, v| m.max(v.abs()))).map_or(0.0, |(growth, _)| growth)
        };
        for u in shared(lists) {
            let new = found.iter().all(|f| (f - u).abs() >= SAME);
            if new && u > NEAR && u < 1.0 - NEAR && growth(u, -1.0).max(growth(u, 1.0)) > SINGULAR {
                found.push(u);
            }
        }
    }
    found
}

/// Those of two lists out of three.
fn shared(lists: &[Vec<f64>; 3]) -> Vec<f64> {
    let is_in = |t: f64, list: &Vec<f64>| list.iter().any(|u| (t - u).abs() < SAME);
    let twice = |t: &f64| lists.iter().filter(|l| is_in(*t, l)).count() >= 2;
    lists.iter().flatten().copied().filter(twice).collect()
}

/// Jumps, kinks and singularities of one function of the coordinate; not within three places of `diagonal`.
fn of(diagonal: Option<f64>, phi: impl Fn(f64) -> f64) -> Vec<f64> {
    let at = |i: usize| (i as f64 + 0.5) / PLACES as f64;
    let values: Vec<f64> = (0..PLACES).map(|i| phi(at(i))).collect();
    let size = values.iter().filter(|v| v.is_finite()).fold(0.0f64, |m, v| m.max(v.abs()));
    let steps: Vec<f64> = values.windows(2).map(|v| (v[1] - v[0]).abs()).collect();
    let apart = |i: usize, t: f64, places: f64| (t - at(i)).abs() * PLACES as f64 > places;
    let mut found = Vec::new();
    for i in 1..steps.len() - 1 {
        let outstanding = steps[i] > OUTSTANDING * steps[i - 1].max(steps[i + 1]) && steps[i] > SMALLEST * size;
        if outstanding && diagonal.is_none_or(|t| apart(i, t, 3.0)) {
            found.extend(bisected(&phi, (at(i), at(i + 1)), steps[i]));
        }
    }
    let bends: Vec<f64> = values.windows(3).map(|v| (v[0] - 2.0 * v[1] + v[2]).abs()).collect();
    for i in BESIDE..bends.len() - BESIDE {
        let around = bends[i - BESIDE].max(bends[i + BESIDE]);
        let highest = bends[i] >= bends[i - 1] && bends[i] > bends[i + 1];
        let outstanding = highest && bends[i] > OUTSTANDING * around && bends[i] > SMALLEST * size;
        if outstanding && diagonal.iter().chain(&found).all(|t| apart(i + 1, *t, 3.0)) {
            found.extend(rough(&phi, (at(i), at(i + 2)), size));
        }
    }
    found
}

/// Where second differences of φ do not fall like the square of the spacing, however small: a kink, d^β with β < 1.5 or a logarithm.
fn rough(phi: impl Fn(f64) -> f64, (mut a, mut b): (f64, f64), size: f64) -> Option<f64> {
    const PARTS: usize = 8;
    let (mut last, mut levels) = (0.0, 0);
    loop {
        let h = (b - a) / PARTS as f64;
        let at = |k: usize| a + h * k as f64;
        let values: [f64; PARTS + 1] = std::array::from_fn(|k| phi(at(k)));
        let bend = |k: usize| (values[k - 1] - 2.0 * values[k] + values[k + 1]).abs();
        if let Some(k) = values.iter().position(|v| !v.is_finite()) {
            return (levels >= LEVELS).then(|| at(k));
        }
        let k = (1..PARTS).max_by(|i, j| bend(*i).total_cmp(&bend(*j)))?;
        if bend(k) <= ROUNDING * size || h <= 4.0 * f64::EPSILON * b {
            return (levels >= LEVELS).then_some(0.5 * (a + b));
        }
        if bend(k) < SQUARE * last {
            return None;
        }
        (a, b, last, levels) = (at(k - 1), at(k + 1), bend(k), levels + 1);
    }
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
    use super::{along_rows, jumps};
    use crate::Equation;

    #[test]
    fn layers_are_found_and_nothing_else() {
        let c = |x: f64| if x > 1.0 { 0.9 } else { 0.4 };
        let of_x = Equation::on_interval(0.0..=3.0, |_| 1.0, move |x, y: f64| c(x) * f64::exp(-(x - y).abs()));
        let found = jumps(&of_x, &along_rows(of_x.kernel()));
        assert!(found.len() == 1 && (found[0] - 1.0 / 3.0).abs() < 1e-15, "{found:?}");
        let of_y = Equation::on_interval(0.0..=3.0, |x: f64| x.sqrt(), move |x, y: f64| c(y) * (x - y).abs().ln());
        assert_eq!(jumps(&of_y, &along_rows(of_y.kernel())).len(), 1);
        let of_g = Equation::on_interval(0.0..=1.0, |x: f64| f64::from(x < 0.3) + 5.0 * x, |x, y| x * y);
        assert!((jumps(&of_g, &[])[0] - 0.3).abs() < 1e-15);
        // moving jumps are none
        let root = Equation::on_interval(
            0.0..=1.0,
            |x: f64| (x - 0.4).abs().sqrt(),
            |x, y: f64| f64::from((x - y).abs() < 0.2) / (x - y).abs().sqrt(),
        );
        let found = jumps(&root, &along_rows(root.kernel()));
        assert!(found.len() == 1 && (found[0] - 0.4).abs() < 1e-14, "{found:?}");
    }

    #[test]
    fn kinks_are_told_from_what_is_smooth() {
        type Phi = fn(f64) -> f64;
        let of = |phi: Phi| super::of(None, phi);
        for rough in [(|t| (t - 0.37).abs() + t.cos()) as Phi, |t| (t - 0.37).abs().ln(), |t| t.min(0.37), |t| (t - 0.37).abs().powf(-0.3)]
        {
            let found = of(rough);
            assert!(found.len() == 1 && (found[0] - 0.37).abs() < 1e-10, "{found:?}");
        }
        for smooth in
            [(|t| (40.0 * t).sin()) as Phi, |t| 1.0 / (1e-6 + (t - 0.3).powi(2)), |t| (-((t - 0.5) / 1e-3).powi(2)).exp(), |_| 1.0]
        {
            assert_eq!(of(smooth), Vec::<f64>::new());
        }
    }
}
