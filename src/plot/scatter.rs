//! Point sets in the unit square, side by side.

use super::drawing::{Align, Drawing};
use super::panel::{self, Frame, TEXT};
use super::style::{GRID, INK, SOLID, look};
use super::{check, some};
use crate::error::Error;
use std::path::Path;

const SIDE: f64 = 220.0;
const BETWEEN: f64 = 24.0;
const LABEL: f64 = 24.0;
const MARGIN: f64 = 16.0;

/// Squares of points, each with its name; a light grid shows how many fall into each of its cells.
///
/// ```
/// # fn main() -> Result<(), fredholm::Error> {
/// use fredholm::{plot::Scatter, sampling::{PointSet, Sobol}};
/// let points = PointSet::draw(&Sobol::new(1), 2, 64)?;
/// let svg = Scatter::new("Point sets").grid(8).square("Sobol'", points.iter().map(|x| [x[0], x[1]])).to_svg()?;
/// assert!(svg.matches("<circle").count() >= 64);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
#[must_use]
pub struct Scatter {
    title: String,
    subtitle: String,
    columns: usize,
    grid: usize,
    squares: Vec<(String, Vec<[f64; 2]>)>,
}

impl Scatter {
    /// An empty picture.
    pub fn new(title: &str) -> Self {
        Scatter { title: title.into(), subtitle: String::new(), columns: 4, grid: 1, squares: Vec::new() }
    }

    /// A smaller line below the title.
    pub fn subtitle(self, subtitle: &str) -> Self {
        Scatter { subtitle: subtitle.into(), ..self }
    }

    /// Squares in a row; 4 by default.
    pub fn columns(self, columns: usize) -> Self {
        Scatter { columns, ..self }
    }

    /// Cells of the grid along a side; 1, no grid, by default.
    pub fn grid(self, cells: usize) -> Self {
        Scatter { grid: cells, ..self }
    }

    /// One more square.
    pub fn square(mut self, label: &str, points: impl IntoIterator<Item = [f64; 2]>) -> Self {
        self.squares.push((label.into(), points.into_iter().collect()));
        self
    }

    /// Writes the picture; the extension `.svg` or `.png` chooses the format, missing folders are made.
    ///
    /// # Errors
    /// [`Error::Unplottable`] for a point outside the unit square; [`Error::Invalid`] if there are no squares, or none in a row;
    /// [`Error::Io`] with the path.
    pub fn save(&self, path: impl AsRef<Path>) -> Result<(), Error> {
        self.draw()?.save(path.as_ref())
    }

    /// The picture as SVG text.
    ///
    /// # Errors
    /// As [`save`](Self::save).
    pub fn to_svg(&self) -> Result<String, Error> {
        self.draw()?.to_svg()
    }

    /// The picture as the bytes of a PNG file, two dots a pixel.
    ///
    /// # Errors
    /// As [`save`](Self::save).
    pub fn to_png(&self) -> Result<Vec<u8>, Error> {
        self.draw()?.to_png()
    }

    fn validate(&self) -> Result<(), Error> {
        some("squares", self.squares.len())?;
        some("squares in a row", self.columns)?;
        some("cells of the grid", self.grid)?;
        for (label, points) in &self.squares {
            check(label, "coordinate", "must lie in the unit square", points.iter().flatten().copied(), |x| (0.0..=1.0).contains(&x))?;
        }
        Ok(())
    }

    fn draw(&self) -> Result<Drawing, Error> {
        self.validate()?;
        let columns = self.columns.min(self.squares.len());
        let rows = self.squares.len().div_ceil(columns);
        let page = Frame { left: MARGIN, top: panel::top(&self.subtitle), width: SIDE, height: SIDE };
        let right = MARGIN + columns as f64 * (SIDE + BETWEEN) - BETWEEN + MARGIN;
        let bottom = page.top + rows as f64 * (LABEL + SIDE + BETWEEN);
        let mut drawing = Drawing::new(panel::page_width(right, page, &self.title, &self.subtitle), bottom);
        for (i, (label, points)) in self.squares.iter().enumerate() {
            let corner =
                (MARGIN + (i % columns) as f64 * (SIDE + BETWEEN), page.top + LABEL + (i / columns) as f64 * (LABEL + SIDE + BETWEEN));
            self.paint(corner, label, points, &mut drawing);
        }
        panel::title(&mut drawing, page, &self.title, &self.subtitle);
        Ok(drawing)
    }

    fn paint(&self, (left, top): (f64, f64), label: &str, points: &[[f64; 2]], drawing: &mut Drawing) {
        let place = |x: f64, y: f64| (left + SIDE * x, top + SIDE * (1.0 - y));
        for line in (1..self.grid).map(|i| i as f64 / self.grid as f64) {
            drawing.line(&[place(line, 0.0), place(line, 1.0)], GRID, 1.0, SOLID);
            drawing.line(&[place(0.0, line), place(1.0, line)], GRID, 1.0, SOLID);
        }
        let corners = [place(0.0, 0.0), place(1.0, 0.0), place(1.0, 1.0), place(0.0, 1.0), place(0.0, 0.0)];
        corners.windows(2).for_each(|side| drawing.line(side, INK, 1.2, SOLID));
        // crowds of points must not run together
        let radius = (0.3 * SIDE / (points.len() as f64).sqrt()).clamp(0.8, 2.6);
        let look = look(0);
        points.iter().for_each(|[x, y]| drawing.marker(look.marker, place(*x, *y), radius, look.colour));
        drawing.text(label, (left, top - 0.5 * TEXT), TEXT, Align::Left);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_outside_and_pictures_of_nothing_are_refused() {
        let refusal = Scatter::new("t").square("a", [[0.5, 0.5], [0.5, 1.5]]).to_svg().unwrap_err();
        assert!(matches!(refusal, Error::Unplottable { value, .. } if value == 1.5), "{refusal}");
        assert!(Scatter::new("t").to_svg().is_err());
        assert!(Scatter::new("t").square("a", [[0.5, 0.5]]).columns(0).to_svg().is_err());
        let two = Scatter::new("t").square("first", [[0.0, 1.0]]).square("second", []).to_svg().unwrap();
        assert!(two.contains("first") && two.contains("second"));
    }
}
