//! The shared false-alarm level, the tests themselves, and the collection of issues.

use super::Settings;
use super::report::{Issue, Law, Report};
use crate::domain::Domain;
use crate::error::Error;
use crate::sampling::{Pcg, Sampler, Sequence};
use crate::statistics::Moments;
use statrs::distribution::{Binomial, ChiSquared, ContinuousCDF, DiscreteCDF, Normal, StudentsT};

/// One call of a check: draws, tests and findings.
pub(super) struct Tester {
    settings: Settings,
    level: f64,
    report: Report,
    /// further places of each issue
    more: Vec<usize>,
}

/// What a test of a mean says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Outcome {
    Agrees,
    /// With this z-score.
    Differs(f64),
    /// The scores have too heavy a tail for a test at this level.
    Undecided,
}

impl Tester {
    /// A call that will make at most `planned` statistical tests.
    pub(super) fn new<D: Domain>(settings: Settings, domain: &D, planned: usize) -> Result<Self, Error> {
        settings.validate()?;
        domain.validate()?;
        let report = Report { issues: Vec::new(), notes: Vec::new(), tests: 0, false_alarm: settings.false_alarm, resolution: 0.0 };
        Ok(Tester { settings, level: settings.false_alarm / planned.max(1) as f64, report, more: Vec::new() })
    }

    pub(super) fn samples(&self) -> u64 {
        self.settings.samples
    }

    pub(super) fn seed(&self) -> u64 {
        self.settings.seed
    }

    pub(super) fn tolerance(&self) -> f64 {
        self.settings.tolerance
    }

    /// The generator of draw `index` at place `place`.
    pub(super) fn random(&self, place: usize, index: u64) -> impl Sampler + use<> {
        Pcg::new(self.settings.seed).point(place as u64, 0, index)
    }

    /// Places x: a shifted Kronecker sequence in the coordinates of the map, all states in turn.
    pub(super) fn places<D: Domain>(&self, domain: &D) -> Vec<D::Point> {
        let d = domain.dimension();
        // the root of φ^{d+1} = φ + 1 (Roberts' R_d sequence)
        let golden = (0..64).fold(1.5f64, |g, _| (1.0 + g).powf(1.0 / (d as f64 + 1.0)));
        let mut u = Pcg::new(self.settings.seed).point(u64::MAX, 0, 0);
        let shift: Vec<f64> = (0..d).map(|_| u.next_1d()).collect();
        let place = |i: usize| {
            let mut axis = 0;
            domain
                .place(i % domain.states(), || {
                    let t = (shift[axis] + (i as f64 + 0.5) * golden.powi(-(axis as i32) - 1)).fract();
                    axis += 1;
                    t.clamp(1e-6, 1.0 - 1e-6)
                })
                .point
        };
        (0..self.settings.places.max(domain.states())).map(place).collect()
    }

    /// A broken law. The first place is told in full, further ones are counted.
    pub(super) fn blame(&mut self, law: Law, place: String, observed: f64, expected: f64, message: String) {
        if let Some(i) = self.report.issues.iter().position(|i| i.law == law) {
            self.more[i] += 1;
            return;
        }
        self.report.issues.push(Issue { law, place, observed, expected, message });
        self.more.push(0);
    }

    pub(super) fn note(&mut self, note: String) {
        if !self.report.notes.contains(&note) {
            self.report.notes.push(note);
        }
    }

    /// Student's test of a mean against `expected` ± `slack`, itself perhaps random with standard error `expected_error`.
    ///
    /// Skewed scores: Hall's cubic transformation, *On the removal of skewness by transformation*, JRSS B 54 (1992) 221, and the milder of the
    /// two verdicts. `scale` is what an error of 100 % would be.
    pub(super) fn mean(&mut self, scores: &Moments<f64>, expected: f64, slack: f64, expected_error: f64, scale: f64) -> Outcome {
        self.report.tests += 1;
        let own = scores.std_error().unwrap_or(f64::INFINITY);
        let error = own.hypot(expected_error);
        let difference = scores.mean - expected;
        let beyond = (difference.abs() - slack - 1e-11 * scale).max(0.0);
        if beyond == 0.0 {
            self.resolved(error, scale);
            return Outcome::Agrees;
        }
        if error == 0.0 {
            return Outcome::Differs(f64::INFINITY);
        }
        let t = difference.signum() * beyond / error;
        let a = scores.skewness() * own / error / (scores.count as f64).sqrt();
        let cubic = t + a * t * t / 3.0 + a * a * t * t * t / 27.0 + a / 6.0;
        let mild = t.abs().min(cubic.abs());
        if two_sided(mild, (scores.count - 1) as f64) < self.level {
            return Outcome::Differs(t);
        }
        // the variance itself is uncertain (theory (5.2.1)): a pass would mean little
        if scores.variance_of_variance() > 0.1 {
            return Outcome::Undecided;
        }
        self.resolved(error, scale);
        Outcome::Agrees
    }

    /// Whether `hits` of `trials` contradict a probability in [`low`, `high`].
    pub(super) fn frequency(&mut self, hits: u64, trials: u64, low: f64, high: f64) -> bool {
        self.report.tests += 1;
        let p = |probability: f64, upper: bool| match Binomial::new(probability.clamp(0.0, 1.0), trials) {
            Ok(b) if upper => {
                if hits == 0 {
                    1.0
                } else {
                    b.sf(hits - 1)
                }
            }
            Ok(b) => b.cdf(hits),
            Err(_) => 0.0,
        };
        let middle = (0.5 * (low + high)).clamp(0.0, 1.0);
        self.resolved((middle * (1.0 - middle) / trials as f64).sqrt(), 1.0);
        p(low, false).min(1.0) < self.level / 2.0 || p(high, true).min(1.0) < self.level / 2.0
    }

    /// Pearson's test of `observed` against `expected`, cells pooled to 10 expected points; the χ² and its degrees of freedom if it fails.
    pub(super) fn distribution(&mut self, observed: &[u64], expected: &[f64]) -> Option<(f64, usize)> {
        self.report.tests += 1;
        let (mut chi, mut cells) = (0.0, 0usize);
        let (mut o, mut e) = (0.0, 0.0);
        // smallest first: what is left over joins cells of its own size
        let mut order: Vec<usize> = (0..expected.len()).collect();
        order.sort_by(|a, b| expected[*a].total_cmp(&expected[*b]));
        let total: f64 = expected.iter().sum();
        let mut behind = total;
        for i in order {
            o += observed[i] as f64;
            e += expected[i];
            behind -= expected[i];
            if e >= 10.0 && behind >= 10.0 || behind <= 1e-9 * total {
                if e > 0.0 {
                    chi += (o - e) * (o - e) / e;
                    cells += 1;
                }
                (o, e) = (0.0, 0.0);
            }
        }
        if cells < 2 {
            return None;
        }
        let p = ChiSquared::new((cells - 1) as f64).map_or(0.0, |c| c.sf(chi));
        (p < self.level).then_some((chi, cells - 1))
    }

    /// An error of `error` standard deviations relative to `scale` would have been seen with probability 0.99.
    fn resolved(&mut self, error: f64, scale: f64) {
        if scale > 0.0 && error > 0.0 {
            let z = Normal::standard().inverse_cdf(1.0 - self.level / 2.0) + 2.33;
            self.report.resolution = self.report.resolution.max(z * error / scale);
        }
    }

    pub(super) fn finish(mut self) -> Report {
        for (issue, more) in self.report.issues.iter_mut().zip(&self.more) {
            if *more > 0 {
                issue.message.push_str(&format!(" (and {more} more like it)"));
            }
        }
        self.report
    }
}

/// P(|t| ≥ `t`) of Student's distribution.
fn two_sided(t: f64, freedom: f64) -> f64 {
    StudentsT::new(0.0, 1.0, freedom).map_or(0.0, |d| 2.0 * d.cdf(-t.abs()))
}
