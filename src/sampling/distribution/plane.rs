//! A piecewise-constant density on a rectangle: the marginal of the rows, then the conditional in the row.

use super::{Distribution, Inverse, PiecewiseConstant, matching};
use crate::domain::Interval;
use crate::error::Error;

/// Density ∝ `rows[j][i]` on the cells of a rectangle, row j along y, column i along x. The first number chooses x, the second y.
///
/// ```
/// use fredholm::sampling::distribution::{Distribution, Inverse, PiecewiseConstant2d};
/// let d = PiecewiseConstant2d::on([(0.0..=2.0).into(), (0.0..=1.0).into()], &[[1.0, 0.0], [1.0, 2.0]])?;
/// let x = d.sample([0.5, 0.75]);
/// assert!((x[0] - 1.25).abs() < 1e-15 && (d.pdf(&x) - 1.0).abs() < 1e-15);
/// assert_eq!((d.pdf(&[1.5, 0.25]), d.invert(&[1.5, 0.25])), (0.0, None));
/// # Ok::<(), fredholm::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct PiecewiseConstant2d {
    marginal: PiecewiseConstant,
    conditional: Vec<PiecewiseConstant>,
}

impl PiecewiseConstant2d {
    /// Equal cells of the rectangle x × y.
    ///
    /// # Errors
    /// [`Error::Invalid`] for values that are negative or not finite or all zero, rows of different lengths, and intervals without length.
    pub fn on<R: AsRef<[f64]>>([x, y]: [Interval; 2], rows: &[R]) -> Result<Self, Error> {
        let columns = rows.first().map_or(0, |r| r.as_ref().len());
        let (mut conditional, mut integrals) = (Vec::new(), Vec::new());
        for row in rows.iter().map(AsRef::as_ref) {
            matching("number of values in a row", row.len(), columns, "must be the same in all rows")?;
            if row.iter().all(|v| *v == 0.0) && columns > 0 {
                // never chosen: any density will do
                conditional.push(PiecewiseConstant::on(x, &vec![1.0; columns])?);
                integrals.push(0.0);
            } else {
                let row = PiecewiseConstant::on(x, row)?;
                integrals.push(row.integral());
                conditional.push(row);
            }
        }
        Ok(PiecewiseConstant2d { marginal: PiecewiseConstant::on(y, &integrals)?, conditional })
    }

    /// Integral of the values over the rectangle.
    #[must_use]
    pub fn integral(&self) -> f64 {
        self.marginal.integral()
    }

    fn row(&self, y: f64) -> Option<&PiecewiseConstant> {
        self.marginal.cell(y).map(|j| &self.conditional[j])
    }
}

impl Distribution for PiecewiseConstant2d {
    type Unit = [f64; 2];
    type Point = [f64; 2];

    fn sample(&self, [u, v]: [f64; 2]) -> [f64; 2] {
        let y = self.marginal.sample(v);
        // a sample of the marginal lies in one of its cells
        let row = self.row(y).unwrap_or(&self.conditional[0]);
        [row.sample(u), y]
    }

    fn pdf(&self, [x, y]: &[f64; 2]) -> f64 {
        self.row(*y).map_or(0.0, |row| self.marginal.pdf(y) * row.pdf(x))
    }
}

impl Inverse for PiecewiseConstant2d {
    fn invert(&self, [x, y]: &[f64; 2]) -> Option<[f64; 2]> {
        Some([self.row(*y)?.invert(x)?, self.marginal.invert(y)?])
    }
}
