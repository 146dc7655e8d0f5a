//! Condition (S): is every place that matters within reach?

use super::Settings;
use super::report::{Law, Report};
use super::tester::Tester;
use crate::contained::contained;
use crate::domain::Domain;
use crate::equation::Equation;
use crate::error::Error;
use crate::kernel::{HasDomain, Kernel, Operator, TransitionPdf};
use crate::sampling::{Pcg, Sampler, Sequence};
use crate::source::{SampleSource, Source};
use crate::value::{Value, Weight};

/// Points of the search.
const POINTS: usize = 240;

/// One random point in each of equal cells of the coordinate (in one dimension), all states in turn.
fn points<D: Domain>(domain: &D, seed: u64) -> Vec<D::Point> {
    let states = domain.states();
    let rows = POINTS.div_ceil(states).max(24);
    let point = |i: usize| {
        let mut u = Pcg::new(seed).point(u64::MAX, 1, i as u64);
        let line = domain.dimension() == 1;
        domain.place(i % states, || if line { ((i / states) as f64 + u.next_1d()) / rows as f64 } else { u.next_1d() }).point
    };
    (0..rows * states).map(point).collect()
}

/// K(x, y) ≠ 0 for all pairs; kernels that are not finite count as not 0.
fn coupled<K: Kernel>(kernel: &K, points: &[K::Point]) -> Vec<Vec<bool>> {
    let nonzero = |x: &K::Point, y: &K::Point| {
        let k = kernel.eval(x, y);
        !k.entries_finite() || k.norm() > 0.0
    };
    points.iter().map(|x| points.iter().map(|y| nonzero(x, y)).collect()).collect()
}

/// Where (Σ|T|ⁿ|g|)(y) ≠ 0: the source itself, and whatever a chain of couplings leads to it.
fn lit<G: Source>(source: &G, points: &[G::Point], coupled: &[Vec<bool>]) -> Vec<bool> {
    let mut lit: Vec<bool> = points.iter().map(|y| source.eval(y).map(f64::abs) != G::Value::ZERO).collect();
    loop {
        let next: Vec<bool> = lit.iter().zip(coupled).map(|(l, row)| *l || row.iter().zip(&lit).any(|(k, l)| *k && *l)).collect();
        if next == lit {
            return lit;
        }
        lit = next;
    }
}

/// Condition (S) of theory §4.1: pdf(x, y) > 0 wherever K(x, y) (Σ|T|ⁿ|g|)(y) ≠ 0. Otherwise every walk is biased, silently.
///
/// Searches all pairs of about 240 points; a hole narrower than their spacing is not seen.
///
/// ```
/// use fredholm::{check::{self, Law, Settings}, domain::Interval, kernel::Uniform, Equation};
/// let eq = Equation::on_interval(0.0..=1.0, |_| 1.0, |x, y| 0.5 * x * y).with_proposal(Uniform::on(Interval::from(0.0..=0.9)));
/// let report = check::support(&eq, Settings::default())?;
/// assert!(report.breaks(Law::Support));
/// # Ok::<(), fredholm::Error>(())
/// ```
///
/// # Errors
/// [`Error::Invalid`] for settings or domains outside their range.
pub fn support<G, K>(equation: &Equation<G, K>, settings: Settings) -> Result<Report, Error>
where
    G: Source,
    K: Kernel + TransitionPdf + HasDomain + Operator<Point = G::Point>,
    K::Weight: Weight<Value = G::Value>,
{
    contained(|| {
        let (kernel, source) = (equation.kernel(), equation.source());
        let tester = Tester::new(settings, kernel.domain(), 1)?;
        let points = points(kernel.domain(), tester.seed());
        let coupled = coupled(kernel, &points);
        let lit = lit(source, &points, &coupled);
        holes(
            tester,
            &points,
            &coupled,
            &lit,
            |x, y| kernel.pdf(x, y),
            |x, y| {
                format!(
                    "pdf(x, y) = 0, but K(x, y) = {:?} and what is seen from y is not 0: no walk can go there, which is a bias",
                    kernel.eval(x, y)
                )
            },
        )
    })
}

/// pdf_for(x, y) > 0 wherever K(x, y) g(y) ≠ 0: otherwise next event is biased, silently.
///
/// # Errors
/// [`Error::Invalid`] for settings or domains outside their range.
pub fn connections<G, K>(equation: &Equation<G, K>, settings: Settings) -> Result<Report, Error>
where
    G: SampleSource,
    K: Kernel + HasDomain + Operator<Point = G::Point>,
    K::Weight: Weight<Value = G::Value>,
{
    contained(|| {
        let (kernel, source) = (equation.kernel(), equation.source());
        let tester = Tester::new(settings, kernel.domain(), 1)?;
        let points = points(kernel.domain(), tester.seed());
        let coupled = coupled(kernel, &points);
        let bright: Vec<bool> = points.iter().map(|y| source.eval(y).map(f64::abs) != G::Value::ZERO).collect();
        holes(
            tester,
            &points,
            &coupled,
            &bright,
            |x, y| source.pdf_for(x, y),
            |x, y| {
                format!(
                    "pdf_for(x, y) = 0, but K(x, y) = {:?} and g(y) = {:?}: next event never sees it, which is a bias",
                    kernel.eval(x, y),
                    source.eval(y)
                )
            },
        )
    })
}

fn holes<X: crate::domain::Point>(
    mut tester: Tester,
    points: &[X],
    coupled: &[Vec<bool>],
    needed: &[bool],
    pdf: impl Fn(&X, &X) -> f64,
    words: impl Fn(&X, &X) -> String,
) -> Result<Report, Error> {
    for (x, row) in points.iter().zip(coupled) {
        for ((y, k), needed) in points.iter().zip(row).zip(needed) {
            if !(*k && *needed) {
                continue;
            }
            let density = pdf(x, y);
            // `!(>)`: NaN is a hole too
            if !(density > 0.0) {
                tester.blame(Law::Support, format!("x = {x:?}, y = {y:?}"), density, f64::MIN_POSITIVE, words(x, y));
            }
        }
    }
    Ok(tester.finish())
}
