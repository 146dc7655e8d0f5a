//! Densities and frequencies of steps, proposals and sources.

use super::Settings;
use super::report::{Law, Report};
use super::sampled::{Draw, Total, Words, compare, tests_a_place};
use super::tester::Tester;
use crate::contained::contained;
use crate::domain::Domain;
use crate::error::Error;
use crate::kernel::{Absorbing, Density, HasDomain, Proposal, TransitionPdf};
use crate::source::SampleSource;

/// Laws of [`TransitionPdf`]: the density that a step states is `pdf(x, y)`; ∫ pdf = P(step ≠ None) (the part without Dirac steps); the points
/// follow it (χ²).
///
/// # Errors
/// [`Error::Invalid`] for settings or domains outside their range.
pub fn density<K: TransitionPdf + HasDomain>(kernel: &K, settings: Settings) -> Result<Report, Error> {
    contained(|| {
        let domain = kernel.domain();
        let mut tester = tester(settings, domain)?;
        let words = Words { total: Total::Survival, draw: "the step", pdf: "pdf(x, y)" };
        for (i, x) in tester.places(domain).into_iter().enumerate() {
            let draw = |mut u: &mut dyn crate::sampling::Sampler| match kernel.step(&x, &mut u) {
                None => Draw::Nothing,
                Some(step) => match step.density() {
                    Density::Singular => Draw::Singular,
                    Density::Known(stated) => Draw::Point { point: step.point(), stated },
                    // stated by `pdf` itself: the χ² test below is what checks it
                    Density::Deferred(factor) => Draw::Point { point: step.point(), stated: factor * kernel.pdf(&x, &step.point()) },
                    Density::Unstated => Draw::Point { point: step.point(), stated: f64::NAN },
                },
            };
            compare(&mut tester, domain, (i, &x), &words, draw, |y| kernel.pdf(&x, y));
        }
        Ok(tester.finish())
    })
}

/// Laws of [`Proposal`]: weight = 1/pdf, ∫ pdf(x, y) dμ(y) = 1, the points follow it (χ²).
///
/// ```
/// use fredholm::{check::{self, Settings}, domain::Interval, kernel::Uniform};
/// let unit = Interval::from(0.0..=1.0);
/// assert!(check::proposal(&Uniform::on(unit), &unit, Settings::default())?.is_ok());
/// // normalised, but on another interval than the kernel's
/// let report = check::proposal(&Uniform::on(Interval::from(0.0..=2.0)), &unit, Settings::default())?;
/// assert!(report.breaks(check::Law::Domain));
/// # Ok::<(), fredholm::Error>(())
/// ```
///
/// # Errors
/// [`Error::Invalid`] for settings or domains outside their range.
pub fn proposal<D: Domain, P: Proposal<D::Point>>(proposal: &P, domain: &D, settings: Settings) -> Result<Report, Error> {
    contained(|| {
        let mut tester = tester(settings, domain)?;
        let words = Words { total: Total::One, draw: "sample", pdf: "pdf(x, y)" };
        for (i, x) in tester.places(domain).into_iter().enumerate() {
            let draw = |mut u: &mut dyn crate::sampling::Sampler| {
                let n = proposal.sample(&x, &mut u);
                Draw::Point { point: n.point, stated: 1.0 / n.weight }
            };
            compare(&mut tester, domain, (i, &x), &words, draw, |y| proposal.pdf(&x, y));
        }
        Ok(tester.finish())
    })
}

/// Laws of [`SampleSource`]: weight = 1/pdf_for, ∫ pdf_for(x, y) dμ(y) = 1, the points follow it (χ²). Places x from which nothing is ever
/// seen (`sample_for` = None) are skipped; [`connections`](super::connections) looks whether that is right.
///
/// # Errors
/// [`Error::Invalid`] for settings or domains outside their range.
pub fn source<D: Domain, G: SampleSource<Point = D::Point>>(source: &G, domain: &D, settings: Settings) -> Result<Report, Error> {
    contained(|| {
        let mut tester = tester(settings, domain)?;
        let words = Words { total: Total::One, draw: "sample_for", pdf: "pdf_for(x, y)" };
        for (i, x) in tester.places(domain).into_iter().enumerate() {
            let draw = |mut u: &mut dyn crate::sampling::Sampler| match source.sample_for(&x, &mut u) {
                None => Draw::Nothing,
                Some(n) => Draw::Point { point: n.point, stated: 1.0 / n.weight },
            };
            compare(&mut tester, domain, (i, &x), &words, draw, |y| source.pdf_for(&x, y));
        }
        Ok(tester.finish())
    })
}

fn tester<D: Domain>(settings: Settings, domain: &D) -> Result<Tester, Error> {
    Tester::new(settings, domain, settings.places.max(domain.states()) * tests_a_place(domain))
}

/// Law of [`Absorbing`]: `absorption(x)` = P(step = None), a probability; `never_absorbs` only if it is 0.
///
/// # Errors
/// [`Error::Invalid`] for settings or domains outside their range.
pub fn absorption<K: Absorbing + HasDomain>(kernel: &K, settings: Settings) -> Result<Report, Error> {
    contained(|| {
        let domain = kernel.domain();
        let mut tester = Tester::new(settings, domain, settings.places.max(domain.states()))?;
        for (i, x) in tester.places(domain).into_iter().enumerate() {
            let stated = kernel.absorption(&x);
            let none = (0..tester.samples()).filter(|index| kernel.step(&x, &mut tester.random(i, *index)).is_none()).count() as u64;
            let frequency = none as f64 / tester.samples() as f64;
            let at = format!("x = {x:?}");
            if !(0.0..=1.0).contains(&stated) {
                tester.blame(Law::Absorption, at, stated, frequency, format!("absorption(x) = {stated} is no probability"));
            } else if kernel.never_absorbs() && (none > 0 || stated > 0.0) {
                let message = format!("never_absorbs() is true, but absorption(x) = {stated} and {frequency:.4} of the steps are None");
                tester.blame(Law::Absorption, at, stated, frequency, message);
            } else if tester.frequency(none, tester.samples(), stated - 1e-12, stated + 1e-12) {
                let message = format!("absorption(x) = {stated:.6}, but {frequency:.4} of {} steps are None", tester.samples());
                tester.blame(Law::Absorption, at, stated, frequency, message);
            }
        }
        Ok(tester.finish())
    })
}
