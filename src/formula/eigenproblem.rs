//! λ f(x) = ∫ K(x, y) f(y) dy as text.

use super::fields::{Fields, malformed, number, refuse};
use super::line::scalar;
use super::region::{Region, region};
use super::stated::{KernelText, Stated};
use crate::domain::Interval;
use crate::error::Error;
use crate::kernel::{KernelFn, kernel_fn};
use serde_json::Value;
use std::path::Path;

/// The largest eigenvalue of a kernel on an interval, wanted with its function.
///
/// ```
/// use fredholm::{deterministic::{Nystrom, eigenpairs}, formula::Eigenproblem};
/// let text = r#"{"domain": "[0, a]", "parameters": {"a": 1}, "kernel": "E1(t)/2", "source": "0 (eigenproblem)",
///                "spectral_radius": "0.6190499483622112076402"}"#;
/// let problem = Eigenproblem::parse(text)?;
/// let pair = &eigenpairs(&problem.kernel(), &Nystrom::adaptive().tolerance(1e-10), 1)?[0];
/// assert!((pair.value().re - problem.largest.unwrap()).abs() < 1e-10);
/// # Ok::<(), fredholm::Error>(())
/// ```
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Eigenproblem {
    /// Field `class`.
    pub class: Option<String>,
    /// Field `digits`: how many significant digits of the known values can be trusted.
    pub digits: Option<u32>,
    /// Field `spectral_radius`: the largest eigenvalue, if the file knows it.
    pub largest: Option<f64>,
    /// Places of the interval and values of the eigenfunction there, up to a factor.
    pub stated: Stated<Interval>,
}

impl Eigenproblem {
    /// Reads a file.
    ///
    /// # Errors
    /// [`Error::Io`], and those of [`parse`](Eigenproblem::parse).
    pub fn read(path: impl AsRef<Path>) -> Result<Self, Error> {
        let path = path.as_ref();
        let text = std::fs::read_to_string(path);
        Self::parse(&text.map_err(|e| Error::Io { path: path.display().to_string(), message: e.to_string() })?)
    }

    /// Reads the text of a file.
    ///
    /// # Errors
    /// [`Error::Malformed`] if it is no equation file; [`Error::Formula`] if its source does not say that this is an eigenproblem, or if its kernel is not
    /// one of numbers on an interval.
    pub fn parse(text: &str) -> Result<Self, Error> {
        let fields = Fields::parse(text)?;
        if !fields.required("source")?.as_str().is_some_and(|s| s.contains("eigenproblem")) {
            return refuse("the source does not say `eigenproblem`");
        }
        let p = fields.parameters()?;
        let Some(domain) = fields.text("domain")? else { return malformed("field `domain` is missing") };
        let Region::Interval(a, b) = region(&domain, &p)? else { return refuse("eigenproblems are read on intervals") };
        let largest = fields.optional("spectral_radius").map(|v| number(v, "spectral_radius", &p)).transpose()?;
        let class = fields.text("class")?;
        let digits = fields.optional("digits").and_then(Value::as_u64).and_then(|d| u32::try_from(d).ok());
        let (stated, _) = scalar(&fields.with("source", Value::from(0)), &p, Interval::from(a..=b))?;
        Ok(Eigenproblem { class, digits, largest, stated })
    }

    /// K.
    #[must_use]
    pub fn kernel(&self) -> KernelFn<Interval, KernelText<'_, Interval>, f64> {
        kernel_fn(*self.stated.domain(), self.stated.kernel_text())
    }
}
