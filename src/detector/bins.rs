//! Means of f over cells.

use super::{Detector, SampleDetector, Score, Start, StartPdf};
use crate::domain::{Domain, Interval, Point};
use crate::error::Error;
use crate::sampling::Sampler;
use crate::value::Value;

/// The mean of f over each of `count` equal cells of an interval.
///
/// ```
/// use fredholm::{detector::Bins, Equation, Walk};
/// let eq = Equation::on_interval(0.0..=1.0, |x| x, |_, _| 0.0);
/// let means = eq.seen_by(&Bins::new(0.0..=1.0, 2)).solve(&Walk::collision())?;
/// assert!(means[0].agrees_with(0.25, 5.0) && means[1].agrees_with(0.75, 5.0));
/// # Ok::<(), fredholm::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bins {
    interval: Interval,
    count: usize,
}

impl Bins {
    /// `count` equal cells of `interval`.
    #[must_use]
    pub fn new(interval: impl Into<Interval>, count: usize) -> Self {
        Bins { interval: interval.into(), count }
    }

    /// Width of a cell.
    pub fn width(&self) -> f64 {
        self.interval.length() / self.count as f64
    }

    /// The point at share `t` of cell `cell`.
    #[inline]
    pub(crate) fn place(&self, cell: usize, t: f64) -> f64 {
        self.interval.at((cell as f64 + t) / self.count as f64)
    }

    /// The cell of x, if it is inside.
    #[inline]
    pub fn cell(&self, x: f64) -> Option<usize> {
        let last = self.count.checked_sub(1)?;
        // the last cell keeps its upper end
        self.interval.contains(&x).then(|| ((self.interval.coordinate(&x, 0) * self.count as f64) as usize).min(last))
    }

    /// Middle of cell `cell`.
    pub fn centre(&self, cell: usize) -> f64 {
        self.place(cell, 0.5)
    }
}

impl Detector for Bins {
    type Point = f64;
    type Answer<T> = Vec<T>;
    fn cells(&self) -> usize {
        self.count
    }
    #[inline]
    fn start<S: Sampler>(&self, cell: usize, u: &mut S) -> Start<f64> {
        let x = self.place(cell, u.next_1d());
        // rounding may put a point of a cell into its neighbour, where its density is 0
        Start { point: if self.cell(x) == Some(cell) { x } else { self.centre(cell) }, weight: 1.0 }
    }
    fn norm(&self) -> Option<f64> {
        Some(1.0)
    }
    fn answer<T>(&self, cells: Vec<T>) -> Vec<T> {
        cells
    }
    fn validate(&self) -> Result<(), Error> {
        self.interval.validate()?;
        if self.count == 0 { Err(Error::invalid("bins", 0.0, "must be at least 1")) } else { Ok(()) }
    }
}

/// h_j = 1/(width of a cell) on cell j.
impl<V: Value> Score<f64, V> for Bins {
    #[inline]
    fn score<S: Sampler>(&self, z: &f64, load: V, _: &mut S, mut add: impl FnMut(usize, V)) {
        if let Some(cell) = self.cell(*z) {
            add(cell, load.scale(self.count as f64 / self.interval.length()));
        }
    }
}

/// h = p₀ = 1/(width of a cell) on the cell.
impl StartPdf for Bins {
    #[inline]
    fn start_pdf(&self, cell: usize, x: &f64) -> f64 {
        if self.cell(*x) == Some(cell) { self.count as f64 / self.interval.length() } else { 0.0 }
    }
    #[inline]
    fn importance(&self, cell: usize, x: &f64) -> f64 {
        self.start_pdf(cell, x)
    }
    #[inline]
    fn near(&self, x: &f64, each: impl FnMut(usize)) {
        self.cell(*x).into_iter().for_each(each);
    }
}

/// A point of the whole interval, and with it one cell.
impl<Z: Point> SampleDetector<Z> for Bins {
    #[inline]
    fn sample_for<S: Sampler>(&self, _: &Z, u: &mut S, mut see: impl FnMut(usize, Start<f64>)) {
        let t = u.next_1d();
        let cell = ((t * self.count as f64) as usize).min(self.count - 1);
        see(cell, Start { point: self.interval.at(t), weight: self.count as f64 });
    }
}
