//! The rate of convergence, fitted.

use crate::error::Error;

/// Least-squares line through (ln cost, ln error): error ≈ constant · cost^slope.
///
/// The standard errors are those of ordinary least squares, s²(XᵀX)⁻¹ with n − 2 degrees of freedom (Draper, Smith, *Applied regression
/// analysis*, 3rd ed. 1998, §1.4): they hold for independent errors of equal relative spread, such as root
/// mean squares over equally many repetitions, with seeds of their own at every cost.
///
/// ```
/// use fredholm::statistics::Rate;
/// let rate = Rate::fit([(1e2, 0.2), (1e4, 0.02), (1e6, 0.002)])?;
/// assert!((rate.slope + 0.5).abs() < 1e-12 && (rate.constant - 2.0).abs() < 1e-12 && rate.std_error < 1e-12);
/// # Ok::<(), fredholm::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rate {
    /// Exponent; −1/2 for independent samples.
    pub slope: f64,
    /// Standard error of the slope.
    pub std_error: f64,
    /// Error at cost 1.
    pub constant: f64,
}

impl Rate {
    /// Fits pairs (cost, error).
    ///
    /// # Errors
    /// [`Error::Invalid`] for fewer than three points, for costs all equal, and for numbers that are not positive and finite: an error of 0 has no
    /// logarithm.
    pub fn fit(points: impl IntoIterator<Item = (f64, f64)>) -> Result<Self, Error> {
        let points: Vec<_> = points.into_iter().collect();
        for (parameter, value) in points.iter().flat_map(|(c, e)| [("cost", *c), ("error", *e)]) {
            if !(value > 0.0 && value.is_finite()) {
                return Err(Error::invalid(parameter, value, "a rate needs positive, finite costs and errors"));
            }
        }
        let n = points.len() as f64;
        if points.len() < 3 {
            return Err(Error::invalid("number of points", n, "a slope with an error needs at least 3"));
        }
        let logs: Vec<_> = points.iter().map(|(c, e)| (c.ln(), e.ln())).collect();
        let mean = |f: fn(&(f64, f64)) -> f64| logs.iter().map(f).sum::<f64>() / n;
        let (x, y) = (mean(|p| p.0), mean(|p| p.1));
        let sum = |f: &dyn Fn(f64, f64) -> f64| logs.iter().map(|p| f(p.0 - x, p.1 - y)).sum::<f64>();
        let spread = sum(&|dx, _| dx * dx);
        if spread == 0.0 {
            return Err(Error::invalid("largest cost", points[0].0, "a slope needs different costs"));
        }
        let slope = sum(&|dx, dy| dx * dy) / spread;
        let residuals = sum(&|dx, dy| (dy - slope * dx).powi(2));
        Ok(Rate { slope, std_error: (residuals / (n - 2.0) / spread).sqrt(), constant: (y - slope * x).exp() })
    }
}

#[cfg(test)]
mod tests {
    use super::Rate;

    #[test]
    fn slope_and_error_of_a_line_worked_by_hand() {
        // ln e = (0, 1, 3) at ln c = (0, 1, 2): slope 3/2, residuals (1/6, −1/3, 1/6), s² = 1/6, standard error √(1/12)
        let e = std::f64::consts::E;
        let rate = Rate::fit([(1.0, 1.0), (e, e), (e * e, e * e * e)]).unwrap();
        assert!((rate.slope - 1.5).abs() < 1e-14);
        assert!((rate.std_error - (1.0f64 / 12.0).sqrt()).abs() < 1e-14);
        assert!((rate.constant - (-1.0f64 / 6.0).exp()).abs() < 1e-14);
    }

    #[test]
    fn what_has_no_slope_is_refused() {
        for points in
            [[(1.0, 1.0), (2.0, 0.0), (3.0, 1.0)], [(1.0, 1.0), (1.0, 2.0), (1.0, 3.0)], [(1.0, 1.0), (2.0, 2.0), (f64::NAN, 1.0)]]
        {
            assert!(Rate::fit(points).is_err(), "{points:?}");
        }
        assert!(Rate::fit([(1.0, 1.0), (2.0, 1.0)]).is_err());
    }
}
