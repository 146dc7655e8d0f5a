//! Error against cost.

use super::axis::Axis;
use super::drawing::Drawing;
use super::panel::{self, Below, Entry, Frame, Panel};
use super::style::{DASHED, GREY, Look, Marker, look};
use super::{check, some};
use crate::error::Error;
use std::path::Path;

const WIDTH: f64 = 520.0;
const HEIGHT: f64 = 400.0;

/// Error against cost on log-log axes, with the slope −1/2 of independent samples for reference, or [slopes](Convergence::slopes) of your own.
///
/// An error of exactly 0 has no logarithm: such points are drawn as ▽ on the lower edge, and the legend says so.
///
/// ```
/// # fn main() -> Result<(), fredholm::Error> {
/// use fredholm::plot::Convergence;
/// let svg = Convergence::against_time("f(½), seed 7").series("mis", [(1e-3, 2e-2), (1e-2, 5e-3), (1e-1, 2e-3)]).to_svg()?;
/// assert!(svg.contains("slope −1/2") && svg.contains("10⁻³"));
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
#[must_use]
pub struct Convergence {
    title: String,
    subtitle: String,
    cost: String,
    error: String,
    series: Vec<(String, Vec<(f64, f64)>)>,
    slopes: Vec<f64>,
}

impl Convergence {
    /// The cost is a number of walks.
    pub fn against_samples(title: &str) -> Self {
        Convergence::against(title, "walks N")
    }

    /// The cost is wall time in seconds.
    pub fn against_time(title: &str) -> Self {
        Convergence::against(title, "wall time / s")
    }

    /// Any cost, by its name.
    pub fn against(title: &str, cost: &str) -> Self {
        let (title, subtitle, cost, error) = (title.into(), String::new(), cost.into(), "error".into());
        Convergence { title, subtitle, cost, error, series: Vec::new(), slopes: vec![-0.5] }
    }

    /// Reference lines of other slopes than −1/2, all from one point; or none.
    pub fn slopes(self, slopes: &[f64]) -> Self {
        Convergence { slopes: slopes.to_vec(), ..self }
    }

    /// A smaller line below the title.
    pub fn subtitle(self, subtitle: &str) -> Self {
        Convergence { subtitle: subtitle.into(), ..self }
    }

    /// What the errors are, for the y-axis.
    pub fn error_label(self, label: &str) -> Self {
        Convergence { error: label.into(), ..self }
    }

    /// Pairs (cost, error) of one method.
    pub fn series(mut self, label: &str, points: impl IntoIterator<Item = (f64, f64)>) -> Self {
        self.series.push((label.into(), points.into_iter().collect()));
        self
    }

    /// Writes the picture; the extension `.svg` or `.png` chooses the format, missing folders are made.
    ///
    /// # Errors
    /// [`Error::Unplottable`] for a cost that is not positive or an error that is negative, NaN or infinite; [`Error::Invalid`] if there is no
    /// positive error at all; [`Error::Io`] with the path.
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

    fn points(&self) -> impl Iterator<Item = (f64, f64)> {
        self.series.iter().flat_map(|(_, points)| points.iter().copied())
    }

    fn validate(&self) -> Result<(), Error> {
        some("series", self.series.len())?;
        for (label, points) in &self.series {
            some("points of a series", points.len())?;
            check(label, "cost", "must be positive and finite", points.iter().map(|p| p.0), |c| c > 0.0)?;
            check(label, "error", "must be finite and not negative", points.iter().map(|p| p.1), |e| e >= 0.0)?;
        }
        check("reference lines", "slope", "must be finite", self.slopes.iter().copied(), |_| true)?;
        if self.points().all(|(_, e)| e == 0.0) {
            return Err(Error::invalid("largest error", 0.0, "a log scale needs at least one positive error"));
        }
        Ok(())
    }

    fn draw(&self) -> Result<Drawing, Error> {
        self.validate()?;
        let constant = self.reference();
        let x = Axis::log(&self.cost, self.points().map(|p| p.0), 0.12);
        let least = self.points().map(|p| p.0).fold(f64::INFINITY, f64::min);
        let errors = self.points().map(|p| p.1).filter(|e| *e > 0.0);
        let top = (!self.slopes.is_empty()).then_some(constant / least.sqrt());
        let y = Axis::log(&self.error, errors.chain(top), 0.15);
        let legend = self.legend();
        let left = Panel::room_left(&y, HEIGHT) + 8.0;
        let frame = Frame { left, top: panel::top(&self.subtitle), width: WIDTH, height: HEIGHT };
        let beside = left + WIDTH + panel::legend_width(&legend) + 16.0;
        let mut drawing = Drawing::new(panel::page_width(beside, frame, &self.title, &self.subtitle), frame.top + HEIGHT + 52.0);
        let panel = Panel { frame, x, y };
        panel.grid(&mut drawing);
        for slope in &self.slopes {
            // through the point (least, constant/√least)
            let from = if self.slopes.len() == 1 { 0.0 } else { least };
            reference(&panel, constant * least.powf(-0.5 - slope), (*slope, from), &mut drawing);
        }
        for (i, (_, points)) in self.series.iter().enumerate() {
            curve(&panel, points, look(i), &mut drawing);
        }
        panel.axes(&mut drawing, Below::Labels);
        panel::legend(&mut drawing, frame, &legend);
        panel::title(&mut drawing, frame, &self.title, &self.subtitle);
        Ok(drawing)
    }

    /// The constant of the reference line: above the cheapest point of every series, so that series which fall slower are seen to cross it.
    fn reference(&self) -> f64 {
        let cheapest = |points: &[(f64, f64)]| points.iter().copied().filter(|p| p.1 > 0.0).min_by(|a, b| a.0.total_cmp(&b.0));
        1.6 * self.series.iter().filter_map(|(_, points)| cheapest(points)).map(|(c, e)| e * c.sqrt()).fold(0.0, f64::max)
    }

    fn legend(&self) -> Vec<Entry> {
        let mut entries: Vec<_> = self.series.iter().enumerate().map(|(i, (label, _))| Entry::series(label, look(i))).collect();
        if !self.slopes.is_empty() {
            // one entry: the lines tell themselves apart
            let names = self.slopes.iter().map(|s| slope_name(*s)).collect::<Vec<_>>().join(", ");
            let label = if self.slopes.len() == 1 { format!("slope {names}") } else { format!("slopes {names}") };
            entries.push(Entry { label, colour: GREY, line: Some(DASHED), marker: None });
        }
        if self.points().any(|(_, e)| e == 0.0) {
            entries.push(Entry { label: "error exactly 0".into(), colour: GREY, line: None, marker: Some(Marker::Fallen) });
        }
        entries
    }
}

/// «−3/2»: halves as fractions.
fn slope_name(slope: f64) -> String {
    let sign = if slope < 0.0 { "−" } else { "" };
    let (size, halves) = (slope.abs(), 2.0 * slope.abs());
    if halves.fract() == 0.0 && size.fract() != 0.0 { format!("{sign}{halves}/2") } else { format!("{sign}{size}") }
}

/// error = constant · cost^slope from a cost on, cut where it leaves the frame.
fn reference(panel: &Panel, constant: f64, (slope, least): (f64, f64), drawing: &mut Drawing) {
    let ((x0, x1), (y0, y1)) = (panel.x.ends(), panel.y.ends());
    let error = |cost: f64| constant * cost.powf(slope);
    // where the line meets the upper and the lower edge
    let [a, b] = [y0, y1].map(|y| (y / constant).powf(1.0 / slope));
    let (from, to) = if slope == 0.0 { (x0, x1) } else { (x0.max(a.min(b)), x1.min(a.max(b))) };
    let from = from.max(least);
    if from < to {
        drawing.line(&[from, to].map(|c| panel.place(c, error(c))), GREY, 1.4, DASHED);
    }
}

fn curve(panel: &Panel, points: &[(f64, f64)], look: Look, drawing: &mut Drawing) {
    // a zero breaks the line: there is nothing between it and its neighbours
    for run in points.split(|p| p.1 == 0.0).filter(|run| !run.is_empty()) {
        let places: Vec<_> = run.iter().map(|p| panel.place(p.0, p.1)).collect();
        drawing.line(&places, look.colour, 1.8, look.dash);
        places.iter().for_each(|p| drawing.marker(look.marker, *p, 4.2, look.colour));
    }
    let edge = panel.frame.top + panel.frame.height - 8.0;
    for (cost, _) in points.iter().filter(|p| p.1 == 0.0) {
        let column = panel.place(*cost, panel.y.ends().0).0;
        drawing.marker(Marker::Fallen, (column, edge), 4.6, look.colour);
    }
}
