//! f at points.

use super::{Detector, SampleDetector, Start, StartPdf};
use crate::domain::Point;
use crate::sampling::Sampler;

/// f(x) at one point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct At<X>(pub X);

impl<X: Point> Detector for At<X> {
    type Point = X;
    type Answer<T> = T;
    fn cells(&self) -> usize {
        1
    }
    #[inline]
    fn start<S: Sampler>(&self, _: usize, _: &mut S) -> Start<X> {
        Start { point: self.0, weight: 1.0 }
    }
    fn norm(&self) -> Option<f64> {
        Some(1.0)
    }
    fn answer<T>(&self, mut cells: Vec<T>) -> T {
        cells.swap_remove(0)
    }
}

impl<X: Point> StartPdf for At<X> {
    const EXTENDED: bool = false;
    fn start_pdf(&self, _: usize, _: &X) -> f64 {
        f64::INFINITY
    }
    fn importance(&self, _: usize, _: &X) -> f64 {
        0.0
    }
}

impl<Z: Point, X: Point> SampleDetector<Z> for At<X> {
    const EVERY_CELL: bool = true;
    #[inline]
    fn sample_for<S: Sampler>(&self, _: &Z, _: &mut S, mut see: impl FnMut(usize, Start<X>)) {
        see(0, Start { point: self.0, weight: 1.0 });
    }
}

/// f at several points, with independent walks for each.
#[derive(Clone, Debug, PartialEq)]
pub struct Points<X>(pub Vec<X>);

impl<X: Point> Detector for Points<X> {
    type Point = X;
    type Answer<T> = Vec<T>;
    fn cells(&self) -> usize {
        self.0.len()
    }
    #[inline]
    fn start<S: Sampler>(&self, cell: usize, _: &mut S) -> Start<X> {
        Start { point: self.0[cell], weight: 1.0 }
    }
    fn norm(&self) -> Option<f64> {
        Some(1.0)
    }
    fn answer<T>(&self, cells: Vec<T>) -> Vec<T> {
        cells
    }
}

impl<X: Point> StartPdf for Points<X> {
    const EXTENDED: bool = false;
    fn start_pdf(&self, _: usize, _: &X) -> f64 {
        f64::INFINITY
    }
    fn importance(&self, _: usize, _: &X) -> f64 {
        0.0
    }
}

/// All points, from everywhere: the kernel tally (theory (4.6.2)).
impl<Z: Point, X: Point> SampleDetector<Z> for Points<X> {
    const EVERY_CELL: bool = true;
    #[inline]
    fn sample_for<S: Sampler>(&self, _: &Z, _: &mut S, mut see: impl FnMut(usize, Start<X>)) {
        self.0.iter().enumerate().for_each(|(cell, x)| see(cell, Start { point: *x, weight: 1.0 }));
    }
}
