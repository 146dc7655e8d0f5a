//! Discrepancy: how far a point set is from even.
//!
//! ```text
//! D*(P) = sup_y | #{x ∈ P: x < y}/n − y₁ … y_d |                 star discrepancy
//! | Σ f(x)/n − ∫f | ≤ V(f) D*(P)                                 Koksma–Hlawka, V in the sense of Hardy and Krause
//! ```
//!
//! | measure | cost | |
//! |---|---|---|
//! | [`PointSet::star`] | n log n in one dimension, O(n^d) beyond | exact; refused beyond n^d = 2³² |
//! | [`PointSet::star_bounds`] | n d for each bracket | rigorous bounds from below and above |
//! | [`PointSet::l2_star`], [`centred_l2`](PointSet::centred_l2), [`wrap_around_l2`](PointSet::wrap_around_l2) | n² d | exact |

mod bounds;
mod square;
mod star;

pub use bounds::Bounds;

use crate::error::Error;
use crate::sampling::Sequence;

/// Points of the half-open unit cube [0, 1)^d.
///
/// ```
/// use fredholm::sampling::{PointSet, Sobol, Pcg};
/// let even = PointSet::draw(&Sobol::new(0).unscrambled(), 2, 256)?;
/// let random = PointSet::draw(&Pcg::new(0), 2, 256)?;
/// assert!(even.star()? < 0.02 && random.star()? > 0.05);
/// assert!(even.centred_l2() < 0.1 * random.centred_l2());
/// # Ok::<(), fredholm::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct PointSet {
    dimension: usize,
    /// point by point
    coordinates: Vec<f64>,
}

impl PointSet {
    /// Points given by their coordinates.
    ///
    /// # Errors
    /// [`Error::Invalid`] for no points, points of no coordinates or of different dimension, and coordinates outside [0, 1).
    pub fn new<P: AsRef<[f64]>>(points: &[P]) -> Result<Self, Error> {
        let dimension = points.first().map_or(0, |p| p.as_ref().len());
        if let Some(p) = points.iter().find(|p| p.as_ref().len() != dimension) {
            return Err(Error::invalid("dimension of a point", p.as_ref().len() as f64, "must be the same for all points"));
        }
        Self::checked(dimension, points.iter().flat_map(|p| p.as_ref()).copied().collect())
    }

    /// The first `dimension` coordinates of the first points of a sequence (cell 0, replicate 0).
    ///
    /// # Errors
    /// As [`new`](Self::new), and beyond 10⁹ coordinates.
    pub fn draw<Q: Sequence>(sequence: &Q, dimension: usize, points: u64) -> Result<Self, Error> {
        let count = points as f64 * dimension as f64;
        if count > 1e9 {
            return Err(Error::invalid("number of coordinates", count, "must not exceed 1e9: all are held in memory"));
        }
        let mut coordinates = vec![0.0; points as usize * dimension];
        sequence.fill(0, 0, 0..points, &mut coordinates);
        Self::checked(dimension, coordinates)
    }

    fn checked(dimension: usize, coordinates: Vec<f64>) -> Result<Self, Error> {
        if coordinates.is_empty() {
            return Err(Error::invalid("number of coordinates", 0.0, "a point set needs a point, and a point needs a coordinate"));
        }
        match coordinates.iter().find(|x| !(0.0..1.0).contains(*x)) {
            Some(x) => Err(Error::invalid("coordinate", *x, "must lie in [0, 1)")),
            None => Ok(PointSet { dimension, coordinates }),
        }
    }

    /// Coordinates of a point.
    #[must_use]
    pub fn dimension(&self) -> usize {
        self.dimension
    }

    /// Number of points.
    #[must_use]
    pub fn count(&self) -> usize {
        self.coordinates.len() / self.dimension
    }

    /// The points.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &[f64]> {
        self.coordinates.chunks_exact(self.dimension)
    }
}
