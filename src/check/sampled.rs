//! Do points follow the density that is stated for them?

use super::integral::{Integrals, adaptive, whole};
use super::report::Law;
use super::tester::{Outcome, Tester};
use crate::domain::Domain;
use crate::sampling::Sampler;
use crate::statistics::Moments;

/// One draw.
pub(super) enum Draw<X> {
    Nothing,
    /// Along a Dirac part: has no density.
    Singular,
    /// `stated` is NaN if the draw does not say its density.
    Point {
        point: X,
        stated: f64,
    },
}

/// What the density must integrate to.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Total {
    /// Proposals and sources.
    One,
    /// Steps: P(a point of the part with a density).
    Survival,
}

/// How the object calls its things.
pub(super) struct Words {
    pub(super) total: Total,
    /// "the step", "sample", "sample_for"
    pub(super) draw: &'static str,
    /// "pdf(x, y)", "pdf_for(x, y)"
    pub(super) pdf: &'static str,
}

/// Cells of the coordinate in one dimension, and of each axis in more.
const CELLS: usize = 64;
const MARGINAL: usize = 8;

/// Statistical tests at one place.
pub(super) fn tests_a_place<D: Domain>(domain: &D) -> usize {
    if domain.dimension() == 1 { 2 } else { 1 + MARGINAL * domain.dimension() }
}

struct Seen {
    points: u64,
    nothing: u64,
    cells: Vec<u64>,
    sound: bool,
}

/// Draws at x against the density there.
pub(super) fn compare<D: Domain>(
    tester: &mut Tester,
    domain: &D,
    (place, x): (usize, &D::Point),
    words: &Words,
    draw: impl FnMut(&mut dyn Sampler) -> Draw<D::Point>,
    pdf: impl Fn(&D::Point) -> f64,
) {
    let seen = look(tester, domain, (place, x), words, draw, &pdf);
    if !seen.sound || (words.total == Total::One && seen.nothing == tester.samples()) {
        return;
    }
    let exact = expected(tester, domain, x, &pdf);
    let at = format!("x = {x:?}");
    if let Some(y) = exact.fault {
        let value = pdf(&y);
        tester.blame(Law::Finite, format!("x = {x:?}, y = {y:?}"), value, 0.0, format!("{} = {value}", words.pdf));
        return;
    }
    // |F| − F is twice the negative part
    if exact.scale[0] - exact.values[0] > 1e-9 * exact.scale[0] + exact.errors[0] {
        let message =
            format!("{} is negative: its negative part integrates to {:.3e}", words.pdf, 0.5 * (exact.scale[0] - exact.values[0]));
        tester.blame(Law::NonNegative, at, exact.values[0], exact.scale[0], message);
        return;
    }
    if mass(tester, &at, words, &seen, &exact) {
        shape(tester, domain, &at, words, &seen, &exact);
    }
}

fn cell<D: Domain>(domain: &D, y: &D::Point, axis: usize, cells: usize) -> usize {
    ((domain.coordinate(y, axis) * cells as f64) as usize).min(cells - 1)
}

fn look<D: Domain>(
    tester: &mut Tester,
    domain: &D,
    (place, x): (usize, &D::Point),
    words: &Words,
    mut draw: impl FnMut(&mut dyn Sampler) -> Draw<D::Point>,
    pdf: &impl Fn(&D::Point) -> f64,
) -> Seen {
    let line = domain.dimension() == 1;
    let size = if line { CELLS * domain.states() } else { MARGINAL * domain.dimension() };
    let mut seen = Seen { points: 0, nothing: 0, cells: vec![0; size], sound: true };
    for index in 0..tester.samples() {
        let (point, stated) = match draw(&mut tester.random(place, index)) {
            Draw::Nothing => {
                seen.nothing += 1;
                continue;
            }
            Draw::Singular => continue,
            Draw::Point { point, stated } => (point, stated),
        };
        seen.points += 1;
        let at = || format!("x = {x:?}, y = {point:?}");
        if !domain.contains(&point) {
            seen.sound = false;
            tester.blame(Law::Domain, at(), f64::NAN, f64::NAN, format!("{} leaves the domain", words.draw));
            continue;
        }
        let value = pdf(&point);
        stated_density(tester, &at, words, stated, value);
        if line {
            seen.cells[domain.state(&point) * CELLS + cell(domain, &point, 0, CELLS)] += 1;
        } else {
            (0..domain.dimension()).for_each(|a| seen.cells[a * MARGINAL + cell(domain, &point, a, MARGINAL)] += 1);
        }
    }
    seen
}

fn stated_density(tester: &mut Tester, at: &impl Fn() -> String, words: &Words, stated: f64, pdf: f64) {
    let (law, what) = match words.total {
        Total::One => (Law::SampleWeight, "1/weight"),
        Total::Survival => (Law::StatedDensity, "the density stated by the step"),
    };
    if !pdf.is_finite() {
        tester.blame(Law::Finite, at(), pdf, 0.0, format!("{} = {pdf}", words.pdf));
    } else if pdf <= 0.0 {
        let message = format!("{} produced this point although {} = {pdf}", words.draw, words.pdf);
        tester.blame(Law::Support, at(), pdf, 1.0, message);
    } else if stated.is_nan() {
        tester.blame(law, at(), stated, pdf, format!("{what} is not stated, but {} = {pdf:.6}", words.pdf));
    } else if (stated - pdf).abs() > 1e-9 * pdf.abs().max(stated.abs()) {
        let message = format!("{what} is {stated:.9}, but {} = {pdf:.9} (ratio {:.6})", words.pdf, stated / pdf);
        tester.blame(law, at(), stated, pdf, message);
    }
}

/// ∫ pdf over everything (index 0) and over each cell.
fn expected<D: Domain>(tester: &Tester, domain: &D, x: &D::Point, pdf: &impl Fn(&D::Point) -> f64) -> Integrals<D::Point> {
    if domain.dimension() == 1 {
        let split = domain.coordinate(x, 0);
        let mut all = Integrals { values: vec![0.0], errors: vec![0.0], std_errors: vec![0.0], scale: vec![0.0], fault: None };
        for i in 0..CELLS * domain.states() {
            let range = ((i % CELLS) as f64 / CELLS as f64, (i % CELLS + 1) as f64 / CELLS as f64);
            let part = adaptive(domain, i / CELLS, range, split, 1, |y, out| out[0] = pdf(y));
            all.values[0] += part.values[0];
            all.errors[0] += part.errors[0];
            all.scale[0] += part.scale[0];
            all.values.push(part.values[0]);
            all.errors.push(part.errors[0]);
            all.fault = all.fault.or(part.fault);
        }
        return all;
    }
    let d = domain.dimension();
    whole(domain, x, 1 + MARGINAL * d, (tester.seed() ^ 0xd0, 4 * tester.samples()), |y, out| {
        out.fill(0.0);
        out[0] = pdf(y);
        (0..d).for_each(|a| out[1 + a * MARGINAL + cell(domain, y, a, MARGINAL)] = out[0]);
    })
}

/// Whether ∫ pdf is what it must be.
fn mass<X>(tester: &mut Tester, at: &str, words: &Words, seen: &Seen, exact: &Integrals<X>) -> bool {
    let (value, error) = (exact.values[0], exact.errors[0] + 1e-5 + 8.0 * exact.std_errors[0]);
    let frequency = seen.points as f64 / tester.samples() as f64;
    let mut blame = |law, expected: f64, message: String| {
        tester.blame(law, at.to_string(), value, expected, message);
        false
    };
    if words.total == Total::One && (value - 1.0).abs() > error {
        return blame(Law::Mass, 1.0, format!("∫ {} dμ(y) = {value:.6}, not 1", words.pdf));
    }
    if value - error > 1.0 {
        return blame(Law::Mass, 1.0, format!("∫ {} dμ(y) = {value:.6} > 1: no density", words.pdf));
    }
    if !tester.frequency(seen.points, tester.samples(), value - error, value + error) {
        return true;
    }
    if words.total == Total::Survival && (value - 1.0).abs() <= error {
        let message = format!(
            "∫ {} dμ(y) = {value:.6}, but only {frequency:.4} of the steps survive: the density must include the survival probability",
            words.pdf
        );
        tester.blame(Law::Survival, at.to_string(), value, frequency, message);
    } else {
        let message = format!("∫ {} dμ(y) = {value:.6}, but {} yields a point with frequency {frequency:.4}", words.pdf, words.draw);
        tester.blame(Law::Mass, at.to_string(), value, frequency, message);
    }
    false
}

fn shape<D: Domain>(tester: &mut Tester, domain: &D, at: &str, words: &Words, seen: &Seen, exact: &Integrals<D::Point>) {
    let n = tester.samples() as f64;
    if domain.dimension() == 1 {
        if exact.errors[0] > 1e-4 * exact.values[0] {
            tester.note(format!("∫ {} over cells is known to {:.0e} only: no χ² test", words.pdf, exact.errors[0]));
            return;
        }
        let expected: Vec<f64> = exact.values[1..].iter().map(|p| p.max(0.0) * seen.points as f64 / exact.values[0]).collect();
        if let Some((chi, freedom)) = tester.distribution(&seen.cells, &expected) {
            let (i, worst) = worst(&seen.cells, &expected);
            let message = format!(
                "the points do not follow {}: χ² = {chi:.1} with {freedom} degrees of freedom; cell {} of {CELLS} of state {} got {} points \
                 instead of {worst:.1}",
                words.pdf,
                i % CELLS,
                i / CELLS,
                seen.cells[i]
            );
            tester.blame(Law::Distribution, at.to_string(), seen.cells[i] as f64, worst, message);
        }
        return;
    }
    for (i, &hits) in seen.cells.iter().enumerate() {
        let p = hits as f64 / n;
        // a coin's moments: n p (1 − p), …
        let q = 1.0 - p;
        let scores = Moments {
            count: tester.samples(),
            nonzero: hits,
            mean: p,
            m2: n * p * q,
            m3: n * p * q * (q - p),
            m4: n * p * q * (1.0 - 3.0 * p * q),
        };
        let outcome = tester.mean(&scores, exact.values[1 + i], exact.errors[1 + i], exact.std_errors[1 + i], 1.0);
        if let Outcome::Differs(z) = outcome {
            let message = format!(
                "the points do not follow {}: cell {} of {MARGINAL} of axis {} has frequency {p:.5} instead of {:.5} (z = {z:.1})",
                words.pdf,
                i % MARGINAL,
                i / MARGINAL,
                exact.values[1 + i]
            );
            tester.blame(Law::Distribution, at.to_string(), p, exact.values[1 + i], message);
        }
    }
}

/// The cell of the largest contribution to χ², and its expectation.
fn worst(observed: &[u64], expected: &[f64]) -> (usize, f64) {
    let part = |i: usize| (observed[i] as f64 - expected[i]).powi(2) / expected[i].max(1.0);
    let i = (0..expected.len()).max_by(|a, b| part(*a).total_cmp(&part(*b))).unwrap_or(0);
    (i, expected[i])
}
