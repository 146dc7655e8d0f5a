//! Deterministic methods on a stated equation.

use crate::options::Options;
use crate::report::Outcome;
use fredholm::formula::Statement;

pub(crate) fn all(_statement: &Statement, _options: &Options) -> Vec<Outcome> {
    Vec::new()
}
