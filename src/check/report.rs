//! What a check found, in words.

use std::fmt;

/// The laws of kernels, proposals and sources.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Law {
    /// Values are finite (kernels may be infinite at x = y only).
    Finite,
    /// Steps and samples stay in the domain.
    Domain,
    /// E[weight · φ(point)] = (Tφ)(x).
    Expectation,
    /// weight · pdf(x, y) = K(x, y) for steps that state a density.
    StepWeight,
    /// K(x, y), not K(y, x).
    ArgumentOrder,
    /// The density stated with a point = the density function at that point.
    StatedDensity,
    /// Densities are not negative.
    NonNegative,
    /// The density integrates to the probability of a point: 1 for proposals and sources, the survival probability for steps.
    Mass,
    /// The density of a step includes the kernel's own survival: π = P·p, not p (theory (4.1.5)).
    Survival,
    /// Points are distributed as the density says.
    Distribution,
    /// absorption(x) = P(step = None).
    Absorption,
    /// mass(x) = ∫ |K(x, y)| dμ(y).
    RowMass,
    /// weight · density = 1 for samples of proposals and sources.
    SampleWeight,
    /// Density positive wherever it is needed: condition (S) of theory §4.1.
    Support,
}

impl fmt::Display for Law {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Law::Finite => "finite values",
            Law::Domain => "points stay in the domain",
            Law::Expectation => "E[weight · φ(point)] = (Tφ)(x)",
            Law::StepWeight => "weight · pdf = K",
            Law::ArgumentOrder => "K(x, y), not K(y, x)",
            Law::StatedDensity => "stated density = pdf",
            Law::NonNegative => "density ≥ 0",
            Law::Mass => "mass of the density",
            Law::Survival => "density includes survival",
            Law::Distribution => "points follow the density",
            Law::Absorption => "absorption = P(None)",
            Law::RowMass => "mass = ∫|K|",
            Law::SampleWeight => "weight · density = 1",
            Law::Support => "support",
        })
    }
}

/// One broken law, at the place where it is broken worst or first.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Issue {
    /// Which law.
    pub law: Law,
    /// Where, as printed by `Debug`: `x = 0.5`, or `x = 0.5, y = 0.7`.
    pub place: String,
    /// What was found there.
    pub observed: f64,
    /// What the law demands.
    pub expected: f64,
    /// The whole story in a sentence.
    pub message: String,
}

impl fmt::Display for Issue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "[{}] at {}: {}", self.law, self.place, self.message)
    }
}

/// The result of a check.
#[derive(Clone, Debug, PartialEq)]
#[must_use]
pub struct Report {
    pub(super) issues: Vec<Issue>,
    pub(super) notes: Vec<String>,
    pub(super) tests: usize,
    pub(super) false_alarm: f64,
    pub(super) resolution: f64,
}

impl Report {
    /// Whether no law was seen broken.
    #[must_use]
    pub fn is_ok(&self) -> bool {
        self.issues.is_empty()
    }

    /// The broken laws, each once, at the place where it was first seen broken.
    #[must_use]
    pub fn issues(&self) -> &[Issue] {
        &self.issues
    }

    /// Whether this law is among the broken ones.
    #[must_use]
    pub fn breaks(&self, law: Law) -> bool {
        self.issues.iter().any(|i| i.law == law)
    }

    /// What could not be decided, and why. A report without issues but with notes is no proof.
    #[must_use]
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// Number of statistical tests that shared the false-alarm level.
    #[must_use]
    pub fn tests(&self) -> usize {
        self.tests
    }

    /// Error of (Tφ)(x) relative to ∫ |K(x, y)| dμ(y), or of a probability, that would have been seen with probability 0.99; 0 if nothing was random.
    #[must_use]
    pub fn resolution(&self) -> f64 {
        self.resolution
    }

    /// Joins two reports; false-alarm levels add up.
    pub(super) fn append(&mut self, other: Report) {
        self.issues.extend(other.issues);
        self.notes.extend(other.notes);
        self.tests += other.tests;
        self.false_alarm += other.false_alarm;
        self.resolution = self.resolution.max(other.resolution);
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.issues.len() {
            0 => write!(f, "no law broken")?,
            1 => write!(f, "1 law broken")?,
            n => write!(f, "{n} laws broken")?,
        }
        write!(f, " ({} statistical tests, false alarm below {:.0e}", self.tests, self.false_alarm)?;
        if self.resolution > 0.0 {
            write!(f, ", errors above {:.1} % would be seen", 100.0 * self.resolution)?;
        }
        write!(f, ")")?;
        for issue in &self.issues {
            write!(f, "\n  {issue}")?;
        }
        for note in &self.notes {
            write!(f, "\n  undecided: {note}")?;
        }
        Ok(())
    }
}
