//! E[weight · φ(point)] = (Tφ)(x), and what the row mass says.

use super::Settings;
use super::integral::whole;
use super::report::{Law, Report};
use super::tester::{Outcome, Tester};
use crate::contained::contained;
use crate::domain::{Domain, Point};
use crate::error::Error;
use crate::kernel::{Density, HasDomain, Kernel, RowMass, Transition};
use crate::statistics::Moments;
use crate::value::{Value, Weight};

/// Names of the test functions, in the order of [`functions`].
const FUNCTIONS: [&str; 4] = ["1", "cos πt", "sin 3πt + t", "1/(1 + 400 (t − t_x)²)"];
/// Indicators of the first states join them.
const STATES: usize = 8;

fn count<D: Domain>(domain: &D) -> usize {
    FUNCTIONS.len() + if domain.states() > 1 { domain.states().min(STATES) } else { 0 }
}

fn name(i: usize) -> String {
    FUNCTIONS.get(i).map_or_else(|| format!("1 on state {}", i - FUNCTIONS.len()), |f| (*f).to_string())
}

/// φ_i(y): t is the mean of the map's coordinates, so that no axis is forgotten.
fn functions<D: Domain>(domain: &D, x: &D::Point, y: &D::Point, out: &mut [f64]) {
    let d = domain.dimension();
    let mean = |p: &D::Point| (0..d).map(|a| domain.coordinate(p, a) * (1.0 + 0.1 * a as f64)).sum::<f64>() / d as f64;
    let (t, at) = (mean(y), mean(x));
    let pi = std::f64::consts::PI;
    out[0] = 1.0;
    out[1] = (pi * t).cos();
    out[2] = (3.0 * pi * t).sin() + t;
    out[3] = 1.0 / (1.0 + 400.0 * (t - at) * (t - at));
    for (s, o) in out[FUNCTIONS.len()..].iter_mut().enumerate() {
        *o = f64::from(domain.state(y) == s);
    }
}

/// What the draws at one place showed.
struct Drawn<X> {
    /// one for each (entry, function)
    moments: Vec<Moments<f64>>,
    /// steps with a stated density, those whose weight · pdf ≠ K(x, y), and those among them for which it is K(y, x)
    wrong: u64,
    swapped: u64,
    /// the first wrong one: y, weight · pdf, K
    first: Option<(X, f64, f64)>,
    not_finite: Option<(X, String)>,
    outside: Option<X>,
}

/// Law of [`Transition`]: E[weight · φ(point)] = ∫ K(x, y) φ(y) dμ(y), for constant, smooth and peaked φ and every state.
///
/// Steps along Dirac parts ([`Step::singular`](crate::kernel::Step::singular)) are left out: K(x, y) is the part with a density.
///
/// ```
/// use fredholm::{check::{self, Law, Settings}, domain::Interval, kernel::*, sampling::Sampler};
/// struct Halved(KernelFn<Interval, fn(&f64, &f64) -> f64, f64>);       // forgets a factor 2 in the weight
/// impl Operator for Halved { type Point = f64; type Weight = f64; }
/// impl HasDomain for Halved { type Domain = Interval; fn domain(&self) -> &Interval { self.0.domain() } }
/// impl Kernel for Halved { fn eval(&self, x: &f64, y: &f64) -> f64 { self.0.eval(x, y) } }
/// impl Transition for Halved {
///     fn step<S: Sampler>(&self, x: &f64, u: &mut S) -> Option<Step<f64, f64>> {
///         let y = u.next_1d();
///         Some(Step::new(y, 0.5 * self.eval(x, &y)))
///     }
/// }
/// let report = check::transition(&Halved(kernel_fn(Interval::from(0.0..=1.0), |x, y| x + y)), Settings::default())?;
/// assert!(report.breaks(Law::Expectation));
/// # Ok::<(), fredholm::Error>(())
/// ```
///
/// # Errors
/// [`Error::Invalid`] for settings or domains outside their range.
pub fn transition<K: Transition + Kernel + HasDomain>(kernel: &K, settings: Settings) -> Result<Report, Error> {
    contained(|| {
        let domain = kernel.domain();
        let c = <<K::Weight as Weight>::Value as Value>::COMPONENTS;
        let m = count(domain);
        let places = settings.places.max(domain.states());
        // twice: every integral is also compared with that of K(y, x)
        let mut tester = Tester::new(settings, domain, 2 * places * c * c * m)?;
        for (i, x) in tester.places(domain).into_iter().enumerate() {
            let mut phi = vec![0.0; m];
            let exact = whole(domain, &x, 2 * c * c * m, (tester.seed() ^ 0x5eed, 4 * tester.samples()), |y, out| {
                functions(domain, &x, y, &mut phi);
                let (direct, adjoint) = out.split_at_mut(c * c * m);
                for (k, out) in [(kernel.eval(&x, y), direct), (kernel.eval(y, &x), adjoint)] {
                    out.iter_mut().enumerate().for_each(|(j, o)| *o = k.entry(j / m / c, j / m % c) * phi[j % m]);
                }
            });
            if let Some(y) = exact.fault {
                let k = kernel.eval(&x, &y);
                tester.blame(Law::Finite, format!("x = {x:?}, y = {y:?}"), f64::NAN, 0.0, format!("K(x, y) = {k:?}"));
                continue;
            }
            let drawn = draw(&tester, kernel, &x, i);
            if !steps_are_sound(&mut tester, &x, &drawn) {
                continue;
            }
            let compare = |tester: &mut Tester, offset: usize, j: usize| {
                // an error counts against the whole row, ∫ |K(x, y)| dμ(y): φ = 1 comes first
                let scale = exact.scale[j - j % m].max(exact.values[j].abs());
                tester.mean(&drawn.moments[j], exact.values[offset + j], exact.errors[offset + j], exact.std_errors[offset + j], scale)
            };
            let direct: Vec<_> = (0..c * c * m).map(|j| compare(&mut tester, 0, j)).collect();
            let Some(j) = direct.iter().position(|o| matches!(o, Outcome::Differs(_))) else {
                if let Some(j) = direct.iter().position(|o| *o == Outcome::Undecided) {
                    tester.note(format!(
                        "the weights vary too much for a test of E[weight · φ] with φ = {}: infinite variance?",
                        name(j % m)
                    ));
                }
                continue;
            };
            let adjoint = (0..c * c * m).all(|j| compare(&mut tester, c * c * m, j) == Outcome::Agrees);
            expectation(&mut tester, &x, &drawn.moments[j], exact.values[j], &direct[j], (name(j % m), c, j / m, adjoint));
        }
        Ok(tester.finish())
    })
}

fn expectation<X: Point>(
    tester: &mut Tester,
    x: &X,
    scores: &Moments<f64>,
    exact: f64,
    outcome: &Outcome,
    (function, c, entry, adjoint): (String, usize, usize, bool),
) {
    let of = if c == 1 { String::new() } else { format!(" of entry ({}, {})", entry / c, entry % c) };
    let z = if let Outcome::Differs(z) = outcome { *z } else { 0.0 };
    let message = format!(
        "E[weight · φ(point)]{of} with φ = {function} is {:.6} ± {:.1e}, but ∫ K(x, y) φ(y) dμ(y) = {exact:.6} (z = {z:.1}, ratio {:.4})",
        scores.mean,
        scores.std_error().unwrap_or(f64::NAN),
        scores.mean / exact
    );
    if adjoint {
        let message = format!("{message}; it does equal ∫ K(y, x) φ(y) dμ(y): the arguments of K are swapped");
        tester.blame(Law::ArgumentOrder, format!("x = {x:?}"), scores.mean, exact, message);
    } else {
        tester.blame(Law::Expectation, format!("x = {x:?}"), scores.mean, exact, message);
    }
}

fn draw<K: Transition + Kernel + HasDomain>(tester: &Tester, kernel: &K, x: &K::Point, place: usize) -> Drawn<K::Point> {
    let domain = kernel.domain();
    let c = <<K::Weight as Weight>::Value as Value>::COMPONENTS;
    let m = count(domain);
    let mut drawn =
        Drawn { moments: vec![Moments::default(); c * c * m], wrong: 0, swapped: 0, first: None, not_finite: None, outside: None };
    let mut block: Vec<Vec<f64>> = vec![Vec::with_capacity(1024); c * c * m];
    let mut phi = vec![0.0; m];
    for index in 0..tester.samples() {
        let step = kernel.step(x, &mut tester.random(place, index)).filter(|s| s.density() != Density::Singular);
        if let Some(step) = &step {
            inspect(kernel, x, step, &mut drawn);
            functions(domain, x, &step.point(), &mut phi);
        }
        for (j, b) in block.iter_mut().enumerate() {
            b.push(step.as_ref().map_or(0.0, |s| s.weight().entry(j / m / c, j / m % c) * phi[j % m]));
        }
        if block[0].len() == 1024 || index + 1 == tester.samples() {
            for (moments, b) in drawn.moments.iter_mut().zip(&mut block) {
                moments.merge(&Moments::from_scores(b));
                b.clear();
            }
        }
    }
    drawn
}

/// weight · pdf = K(x, y), entry by entry.
fn inspect<K: Kernel + HasDomain>(kernel: &K, x: &K::Point, step: &crate::kernel::Step<K::Point, K::Weight>, drawn: &mut Drawn<K::Point>) {
    let y = step.point();
    if !step.weight().entries_finite() {
        drawn.not_finite.get_or_insert_with(|| (y, format!("{:?}", step.weight())));
    }
    if !kernel.domain().contains(&y) {
        drawn.outside.get_or_insert(y);
    }
    let Density::Known(pdf) = step.density() else { return };
    let (found, k) = (step.weight().scaled(pdf), kernel.eval(x, &y));
    if k.entries_finite() && found.entries_finite() && differs(&found, &k) {
        drawn.wrong += 1;
        drawn.swapped += u64::from(!differs(&found, &kernel.eval(&y, x)));
        drawn.first.get_or_insert((y, largest(&found), largest(&k)));
    }
}

fn differs<W: Weight>(a: &W, b: &W) -> bool {
    let c = <W::Value as Value>::COMPONENTS;
    let scale = a.norm().max(b.norm());
    (0..c * c).any(|e| (a.entry(e / c, e % c) - b.entry(e / c, e % c)).abs() > 1e-9 * scale)
}

/// The entry of largest absolute value, with its sign.
fn largest<W: Weight>(w: &W) -> f64 {
    let c = <W::Value as Value>::COMPONENTS;
    (0..c * c).map(|e| w.entry(e / c, e % c)).fold(0.0, |m: f64, e| if e.abs() > m.abs() { e } else { m })
}

/// Reports what can be seen in single steps; false if the moments mean nothing.
fn steps_are_sound<X: Point>(tester: &mut Tester, x: &X, drawn: &Drawn<X>) -> bool {
    if let Some(y) = drawn.outside {
        let message = "a step leaves the domain: walks then read K and g where they are not defined".to_string();
        tester.blame(Law::Domain, format!("x = {x:?}, y = {y:?}"), f64::NAN, f64::NAN, message);
    }
    if let Some((y, found, k)) = drawn.first {
        let place = format!("x = {x:?}, y = {y:?}");
        if drawn.swapped * 100 > 99 * drawn.wrong {
            let message = format!("weight · pdf = {found:.9} is K(y, x), but K(x, y) = {k:.9}: the arguments of K are swapped");
            tester.blame(Law::ArgumentOrder, place, found, k, message);
        } else {
            let message = format!(
                "weight · pdf = {found:.9}, but K(x, y) = {k:.9} (ratio {:.6}; {} steps of {})",
                found / k,
                drawn.wrong,
                tester.samples()
            );
            tester.blame(Law::StepWeight, place, found, k, message);
        }
    }
    if let Some((y, weight)) = &drawn.not_finite {
        tester.blame(Law::Finite, format!("x = {x:?}, y = {y:?}"), f64::NAN, 0.0, format!("the step has weight {weight}"));
        return false;
    }
    true
}

/// Law of [`RowMass`]: `mass(x)` = ∫ |K(x, y)| dμ(y) within [`Settings::tolerance`], and positive wherever the row is not 0: a survival
/// probability of 0 there is a bias.
///
/// # Errors
/// [`Error::Invalid`] for settings or domains outside their range.
pub fn row_mass<K: RowMass + Kernel + HasDomain>(kernel: &K, settings: Settings) -> Result<Report, Error> {
    contained(|| {
        let domain = kernel.domain();
        let mut tester = Tester::new(settings, domain, settings.places.max(domain.states()))?;
        for x in tester.places(domain) {
            let place = format!("x = {x:?}");
            let exact = whole(domain, &x, 1, (tester.seed() ^ 0x5eed, tester.samples()), |y, out| out[0] = kernel.eval(&x, y).norm());
            if let Some(y) = exact.fault {
                let k = kernel.eval(&x, &y);
                tester.blame(Law::Finite, format!("x = {x:?}, y = {y:?}"), f64::NAN, 0.0, format!("K(x, y) = {k:?}"));
                continue;
            }
            let (mass, exact, unsure) = (kernel.mass(&x), exact.values[0], exact.errors[0] + 6.0 * exact.std_errors[0]);
            if !(mass >= 0.0 && mass.is_finite()) {
                tester.blame(Law::RowMass, place, mass, exact, format!("mass(x) = {mass} is no mass; ∫ |K(x, y)| dμ(y) = {exact:.6}"));
            } else if mass == 0.0 && exact - unsure > 0.0 {
                let message = format!("mass(x) = 0, but ∫ |K(x, y)| dμ(y) = {exact:.3e}: subcritical walks all end here, which is a bias");
                tester.blame(Law::Support, place, 0.0, exact, message);
            } else if (mass - exact).abs() > tester.tolerance() * exact + unsure {
                let message = format!("mass(x) = {mass:.6}, but ∫ |K(x, y)| dμ(y) = {exact:.6} (ratio {:.4})", mass / exact);
                tester.blame(Law::RowMass, place, mass, exact, message);
            }
        }
        Ok(tester.finish())
    })
}
