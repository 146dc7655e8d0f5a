//! The star discrepancy, exactly.
//!
//! The supremum is one over finitely many boxes (Niederreiter 1972; the critical boxes of Doerr, Gnewuch, Wahlström, *Calculation of
//! discrepancy measures and applications*, 2014): closed ones whose upper corner has coordinates of points, and open ones whose upper
//! corner has coordinates of points or 1,
//!
//! ```text
//! D* = max( max_closed #{x ≤ y}/n − vol y,  max_open vol y − #{x < y}/n )
//! d = 1:  D* = 1/(2n) + max_i |x_(i) − (2i − 1)/(2n)|
//! ```
//!
//! They are enumerated coordinate by coordinate, the last two by one sweep with a sorted list: O(n^d) steps, O(n d) memory.

use super::PointSet;
use crate::error::Error;

/// Boxes at most.
const LIMIT: f64 = (1u64 << 32) as f64;

/// What a box must hold more, or less of than its volume.
#[derive(Clone, Copy, PartialEq)]
enum Boxes {
    Closed,
    Open,
}

impl PointSet {
    /// The star discrepancy, exact up to rounding.
    ///
    /// ```
    /// # use fredholm::sampling::PointSet;
    /// // the best single point of the square (White 1977): the golden section
    /// let a = (5f64.sqrt() - 1.0) / 2.0;
    /// assert!((PointSet::new(&[[a, a]])?.star()? - a).abs() < 1e-15);
    /// # Ok::<(), fredholm::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Invalid`] beyond n^d = 2³² boxes in two and more dimensions (65 536 points in two, 1625 in three, 256 in four): use
    /// [`star_bounds`](Self::star_bounds).
    pub fn star(&self) -> Result<f64, Error> {
        let n = self.count() as f64;
        let mut points: Vec<&[f64]> = self.iter().collect();
        if self.dimension() == 1 {
            points.sort_by(|a, b| a[0].total_cmp(&b[0]));
            return Ok(points
                .iter()
                .zip(0..)
                .map(|(x, i)| ((f64::from(i) + 1.0) / n - x[0]).max(x[0] - f64::from(i) / n))
                .fold(0.0, f64::max));
        }
        if n.powi(self.dimension() as i32) > LIMIT {
            return Err(Error::invalid("number of points", n, "n^d must not exceed 2³² for an exact star discrepancy; take `star_bounds`"));
        }
        let largest = |boxes| Search { boxes, n }.from(0, &mut points.clone(), 1.0);
        Ok(largest(Boxes::Closed).max(largest(Boxes::Open)))
    }
}

struct Search {
    boxes: Boxes,
    /// number of points
    n: f64,
}

impl Search {
    /// The largest local discrepancy over all sides from coordinate `k` on; `points` are those inside the sides chosen before, whose
    /// product is `volume`.
    fn from(&self, k: usize, points: &mut [&[f64]], volume: f64) -> f64 {
        points.sort_by(|a, b| a[k].total_cmp(&b[k]));
        if points.first().is_none_or(|p| k + 2 == p.len()) {
            return self.sweep(k, points, volume);
        }
        let mut best = 0.0f64;
        self.sides(k, points, |inside, side| {
            best = best.max(self.from(k + 1, &mut points[..inside].to_vec(), volume * side));
        });
        best
    }

    /// The last two coordinates: points enter by the first of them, into a list sorted by the other.
    fn sweep(&self, k: usize, points: &[&[f64]], volume: f64) -> f64 {
        let (mut list, mut best) = (Vec::with_capacity(points.len()), 0.0f64);
        self.sides(k, points, |inside, side| {
            for p in &points[list.len()..inside] {
                let place = list.partition_point(|z| *z < p[k + 1]);
                list.insert(place, p[k + 1]);
            }
            best = best.max(self.scan(&list, volume * side));
        });
        best
    }

    /// All lengths of side `k`, ascending, and how many of the sorted points are inside: those below for open boxes, and those at the end
    /// for closed ones.
    fn sides(&self, k: usize, points: &[&[f64]], mut visit: impl FnMut(usize, f64)) {
        let mut first = 0;
        for run in points.chunk_by(|a, b| a[k] == b[k]) {
            visit(if self.boxes == Boxes::Closed { first + run.len() } else { first }, run[0][k]);
            first += run.len();
        }
        if self.boxes == Boxes::Open {
            visit(points.len(), 1.0);
        }
    }

    /// All lengths of the last side.
    fn scan(&self, list: &[f64], volume: f64) -> f64 {
        let sides = list.iter().zip(0..);
        match self.boxes {
            Boxes::Closed => sides.map(|(z, i)| (f64::from(i) + 1.0) / self.n - volume * z).fold(0.0, f64::max),
            Boxes::Open => {
                let whole = volume - list.len() as f64 / self.n;
                sides.map(|(z, i)| volume * z - f64::from(i) / self.n).fold(whole, f64::max)
            }
        }
    }
}
