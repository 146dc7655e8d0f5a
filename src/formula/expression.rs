//! One formula, parsed once and evaluated without parsing or allocation.

use super::functions::Python;
use super::translate::{Parameters, Scope, translate, variable};
use crate::error::Error;
use exmex::{Express, FlatEx};

/// A formula of `N` variables: Python's arithmetic with the functions of this module, all parameters already numbers.
///
/// ```
/// use fredholm::formula::Expression;
/// let f = Expression::new("lam*exp(-x**2)", ["x"], &[("lam", 2.0)])?;
/// assert_eq!(f.eval(&[0.0]), 2.0);
/// assert_eq!(f.eval(&[1.0]), 2.0 * (-1.0f64).exp());         // −x² is −(x²)
/// assert!(Expression::new("lam*exp(-z)", ["x"], &[("lam", 2.0)]).is_err());
/// # Ok::<(), fredholm::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Expression<const N: usize> {
    tree: FlatEx<f64, Python>,
    /// for each variable that occurs, in exmex's order, which of the N it is
    used: Vec<usize>,
}

impl<const N: usize> Expression<N> {
    /// Parses `text` in the `variables`, with `parameters` replaced by their values.
    ///
    /// # Errors
    /// [`Error::Formula`] that quotes the formula and names what is wrong: an unknown name or function, a missing parenthesis, ….
    pub fn new(text: &str, variables: [&str; N], parameters: &[(&str, f64)]) -> Result<Self, Error> {
        let parameters = parameters.iter().map(|(name, value)| ((*name).to_string(), Ok(*value))).collect();
        Self::parse(text, &variables.map(String::from), &parameters)
    }

    pub(super) fn parse(text: &str, variables: &[String], parameters: &Parameters) -> Result<Self, Error> {
        let wrong = |reason: String| Error::Formula(format!("formula `{text}`: {reason}"));
        let translated = translate(text, Scope { variables, parameters }).map_err(wrong)?;
        let tree = FlatEx::<f64, Python>::parse(&translated).map_err(|e| wrong(e.to_string()))?;
        let used = tree.var_names().iter().filter_map(|name| (0..N).find(|&i| variable(i) == *name)).collect();
        Ok(Expression { tree, used })
    }

    /// The value at `arguments`, in the order of the variables.
    #[inline]
    pub fn eval(&self, arguments: &[f64; N]) -> f64 {
        let mut values = [0.0; N];
        for (value, &i) in values.iter_mut().zip(&self.used) {
            *value = arguments[i];
        }
        // fails only with fewer values than variables, which cannot be; NaN would be reported with the place
        self.tree.eval_relaxed(&values).unwrap_or(f64::NAN)
    }

    /// Whether variable `i` occurs.
    pub fn uses(&self, i: usize) -> bool {
        self.used.contains(&i)
    }
}

/// The number a formula without variables stands for.
pub(super) fn constant(text: &str, parameters: &Parameters) -> Result<f64, Error> {
    let value = Expression::<0>::parse(text, &[], parameters)?.eval(&[]);
    if value.is_finite() { Ok(value) } else { Err(Error::Formula(format!("formula `{text}` is {value}, not a finite number"))) }
}
