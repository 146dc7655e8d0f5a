//! The command line.

use std::path::PathBuf;

const USAGE: &str = "usage: slab [--c RATIO] [--a THICKNESS] [--source uniform|ramp|beam:COSINE] [--samples N] [--seed S] [--plots FOLDER]";

/// Where particles come from.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum SourceChoice {
    /// S = 1.
    Uniform,
    /// S = x/a, a closure.
    Ramp,
    /// S = e^{−x/μ₀}.
    Beam(f64),
}

/// What to solve, and how long.
pub(crate) struct Options {
    pub(crate) ratio: f64,
    pub(crate) thickness: f64,
    pub(crate) source: SourceChoice,
    pub(crate) samples: Option<u64>,
    pub(crate) seed: u64,
    pub(crate) plots: PathBuf,
}

impl Options {
    pub(crate) fn parse(mut arguments: impl Iterator<Item = String>) -> Result<Self, String> {
        let plots = PathBuf::from("target/plots");
        let mut options = Options { ratio: 0.9, thickness: 10.0, source: SourceChoice::Uniform, samples: None, seed: 0, plots };
        while let Some(name) = arguments.next() {
            if name == "--help" {
                return Err(USAGE.to_string());
            }
            let value = arguments.next().ok_or_else(|| format!("{name} needs a value\n{USAGE}"))?;
            match name.as_str() {
                "--c" => options.ratio = number(&name, &value)?,
                "--a" => options.thickness = number(&name, &value)?,
                "--source" => options.source = source(&value)?,
                "--samples" => options.samples = Some(number(&name, &value)?),
                "--seed" => options.seed = number(&name, &value)?,
                "--plots" => options.plots = PathBuf::from(value),
                _ => return Err(format!("unknown option {name}\n{USAGE}")),
            }
        }
        if options.samples.is_some_and(|n| n < 256) {
            return Err("--samples: at least 256, or there is nothing to plot".to_string());
        }
        if options.ratio == 0.0 {
            return Err("--c 0: nothing scatters, φ = S".to_string());
        }
        Ok(options)
    }

    /// Face, near the face, quarter, middle.
    pub(crate) fn points(&self) -> Vec<f64> {
        [0.0, 0.1, 0.25, 0.5].map(|t| t * self.thickness).to_vec()
    }
}

fn number<T: std::str::FromStr>(name: &str, value: &str) -> Result<T, String> {
    value.parse().map_err(|_| format!("{name} {value}: not a number of the right kind\n{USAGE}"))
}

fn source(value: &str) -> Result<SourceChoice, String> {
    match value.split_once(':') {
        None if value == "uniform" => Ok(SourceChoice::Uniform),
        None if value == "ramp" => Ok(SourceChoice::Ramp),
        Some(("beam", cosine)) => Ok(SourceChoice::Beam(number("--source beam", cosine)?)),
        _ => Err(format!("--source {value}: unknown\n{USAGE}")),
    }
}
