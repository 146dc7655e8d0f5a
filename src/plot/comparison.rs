//! One positive number a method.

use super::axis::{Axis, three_digits};
use super::drawing::{Align, Drawing, text_width};
use super::panel::{self, Below, Frame, Panel, TEXT};
use super::style::{GREY, WHITE, look};
use super::{check, some};
use crate::error::Error;
use std::path::Path;

const WIDTH: f64 = 470.0;
const ROW: f64 = 30.0;

/// Methods compared by one positive number each, such as efficiency: horizontal bars on a log scale, in the order given.
///
/// On a log scale only the distance between the ends of two bars means something: their ratio.
///
/// ```
/// # fn main() -> Result<(), fredholm::Error> {
/// use fredholm::{Equation, Walk, plot::Comparison};
/// let eq = Equation::on_interval(0.0..=1.0, |_| 1.0, |x, y| 0.5 * x * y);
/// let (a, b) = (eq.at(0.5).solve(&Walk::collision())?, eq.at(0.5).solve(&Walk::next_event())?);
/// let plot = Comparison::new("f(½) = 1.15", "efficiency 1/(V·W)")
///     .efficiency("collision", &a)
///     .efficiency("next event", &b)
///     .missing("subcritical", "refused: no row mass");
/// assert!(plot.to_svg()?.contains("refused: no row mass"));
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
#[must_use]
pub struct Comparison {
    title: String,
    subtitle: String,
    quantity: String,
    rows: Vec<(String, Row)>,
}

#[derive(Clone, Debug)]
enum Row {
    Value(f64),
    Missing(String),
}

impl Comparison {
    /// No methods yet; `quantity` is the name of the number.
    pub fn new(title: &str, quantity: &str) -> Self {
        Comparison { title: title.into(), subtitle: String::new(), quantity: quantity.into(), rows: Vec::new() }
    }

    /// A smaller line below the title.
    pub fn subtitle(self, subtitle: &str) -> Self {
        Comparison { subtitle: subtitle.into(), ..self }
    }

    /// One method and its number.
    pub fn bar(mut self, label: &str, value: f64) -> Self {
        self.rows.push((label.into(), Row::Value(value)));
        self
    }

    /// One method and the efficiency 1/(V·W) of its estimate, W = kernel evaluations a walk (theory (4.3.7)).
    ///
    /// An efficiency that is unknown (one walk) or infinite (no variance) becomes a row that says so.
    pub fn efficiency<V: crate::Value>(self, label: &str, estimate: &crate::Estimate<V>) -> Self {
        match estimate.efficiency() {
            Some(e) if e.is_finite() => self.bar(label, e),
            Some(_) => self.missing(label, "infinite: no variance"),
            None => self.missing(label, "unknown: one walk"),
        }
    }

    /// A method without a number, and why.
    pub fn missing(mut self, label: &str, reason: &str) -> Self {
        self.rows.push((label.into(), Row::Missing(reason.into())));
        self
    }

    /// Writes the picture; the extension `.svg` or `.png` chooses the format, missing folders are made.
    ///
    /// # Errors
    /// [`Error::Unplottable`] for a number that is not positive and finite; [`Error::Invalid`] if there is none; [`Error::Io`] with the path.
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

    fn values(&self) -> Result<Vec<f64>, Error> {
        let mut values = Vec::new();
        for (label, row) in &self.rows {
            if let Row::Value(v) = row {
                check(label, "value", "must be positive and finite on a log scale", [*v], |v| v > 0.0)?;
                values.push(*v);
            }
        }
        some("bars with a number", values.len())?;
        Ok(values)
    }

    fn draw(&self) -> Result<Drawing, Error> {
        let values = self.values()?;
        let names = self.rows.iter().map(|(label, _)| text_width(label, TEXT)).fold(0.0, f64::max);
        let frame =
            Frame { left: names + 26.0, top: panel::top(&self.subtitle), width: WIDTH, height: ROW * self.rows.len() as f64 + 10.0 };
        let panel = Panel { frame, x: Axis::log(&self.quantity, values, 0.35), y: Axis::linear("", [0.0, 1.0], 0.0) };
        // the numbers stand in a column of their own, right of the frame
        let text = |row: &Row| match row {
            Row::Value(v) => three_digits(*v),
            Row::Missing(_) => "–".into(),
        };
        let numbers = self.rows.iter().map(|(_, row)| text_width(&text(row), TEXT)).fold(0.0, f64::max);
        let right = frame.left + WIDTH + 12.0 + numbers;
        let mut drawing =
            Drawing::new(panel::page_width(right + 16.0, frame, &self.title, &self.subtitle), frame.top + frame.height + 52.0);
        panel.x_grid(&mut drawing);
        for (i, (label, row)) in self.rows.iter().enumerate() {
            let y = frame.top + 5.0 + ROW * (i as f64 + 0.5);
            bar(&panel, row, y, &mut drawing);
            drawing.text(label.as_str(), (frame.left - 10.0, y + 0.36 * TEXT), TEXT, Align::Right);
            drawing.text(text(row), (right, y + 0.36 * TEXT), TEXT, Align::Right);
        }
        panel.x_axis(&mut drawing, Below::Labels);
        panel.border(&mut drawing);
        panel::title(&mut drawing, frame, &self.title, &self.subtitle);
        Ok(drawing)
    }
}

fn bar(panel: &Panel, row: &Row, y: f64, drawing: &mut Drawing) {
    let (left, half) = (panel.frame.left, 0.32 * ROW);
    let corners = |right: f64, half: f64| vec![(left, y - half), (right, y - half), (right, y + half), (left, y + half)];
    match row {
        Row::Value(v) => drawing.area(corners(left + panel.frame.width * panel.x.position(*v), half), look(0).colour),
        Row::Missing(reason) => {
            // paper below the words: grid lines must not run through them
            drawing.area(corners(left + 14.0 + text_width(reason, TEXT), half), WHITE);
            drawing.coloured_text(reason.as_str(), (left + 8.0, y + 0.36 * TEXT), TEXT, Align::Left, GREY);
        }
    }
}
