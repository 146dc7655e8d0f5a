//! A solution along a line: estimates with error bars over curves.

mod band;
mod deviations;

use super::axis::Axis;
use super::drawing::Drawing;
use super::panel::{self, Below, Entry, Frame, Panel};
use super::style::{INK, Look, SOLID, look};
use super::{check, some};
use crate::domain::{Domain, Interval};
use crate::error::Error;
use crate::statistics::{self, Estimate};
use band::Strip;
use std::path::Path;
use std::rc::Rc;

const WIDTH: f64 = 560.0;
const HEIGHT: f64 = 330.0;
/// Height of the panel of deviations, and its distance from the other.
const DEVIATIONS: f64 = 120.0;
const BETWEEN: f64 = 16.0;
/// Points of a curve.
const SAMPLES: usize = 400;

/// f along an interval: curves from functions, estimates with error bars.
///
/// Error bars are the 95 % Student intervals. If there is a curve, a second panel shows (estimate − curve)/standard error, where 95 % of the
/// marks should fall between the dashed lines at ±1.96: errors too small to see in the first panel are seen there. Estimates are compared with
/// the curve that was given last before them, or else with the first.
///
/// ```
/// # fn main() -> Result<(), fredholm::Error> {
/// use fredholm::{Equation, Walk, plot::Profile};
/// let eq = Equation::on_interval(0.0..=1.0, |_| 1.0, |x, y| 0.5 * x * y);
/// let xs = [0.25, 0.5, 0.75, 1.0];
/// let estimates = eq.on(&xs).solve(&Walk::next_event())?;
/// let plot = Profile::new("f = 1 + 3x/10", 0.0..=1.0).curve("exact", |x| 1.0 + 0.3 * x).estimates("next event", &xs, &estimates);
/// assert!(plot.to_svg()?.contains("next event"));
/// # Ok(())
/// # }
/// ```
#[derive(Clone)]
#[must_use]
pub struct Profile<'a> {
    title: String,
    subtitle: String,
    x: String,
    y: String,
    interval: Interval,
    curves: Vec<(String, Curve<'a>)>,
    points: Vec<Points>,
    bands: Vec<Strip>,
}

/// Points (x, y) of each of several series.
type Lines = Vec<Vec<(f64, f64)>>;

type Curve<'a> = Rc<dyn Fn(f64) -> f64 + 'a>;

/// A series of estimates.
#[derive(Clone, Debug)]
struct Points {
    label: String,
    bars: Vec<Bar>,
    /// number of the curve that deviations are measured from, if there is one
    curve: usize,
}

/// An estimate at x; NaN where an error is unknown, which is refused.
#[derive(Clone, Copy, Debug)]
struct Bar {
    x: f64,
    value: f64,
    half_width: f64,
    std_error: f64,
}

impl std::fmt::Debug for Profile<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let curves: Vec<_> = self.curves.iter().map(|c| &c.0).collect();
        f.debug_struct("Profile").field("title", &self.title).field("curves", &curves).field("points", &self.points).finish_non_exhaustive()
    }
}

impl<'a> Profile<'a> {
    /// An empty plot over `interval`.
    pub fn new(title: &str, interval: impl Into<Interval>) -> Self {
        Profile {
            title: title.into(),
            subtitle: String::new(),
            x: "x".into(),
            y: "f(x)".into(),
            interval: interval.into(),
            curves: Vec::new(),
            points: Vec::new(),
            bands: Vec::new(),
        }
    }

    /// A smaller line below the title.
    pub fn subtitle(self, subtitle: &str) -> Self {
        Profile { subtitle: subtitle.into(), ..self }
    }

    /// The name of x.
    pub fn x_label(self, label: &str) -> Self {
        Profile { x: label.into(), ..self }
    }

    /// The name of f.
    pub fn y_label(self, label: &str) -> Self {
        Profile { y: label.into(), ..self }
    }

    /// A function, drawn through 401 points. Estimates that follow are compared with it.
    pub fn curve(mut self, label: &str, f: impl Fn(f64) -> f64 + 'a) -> Self {
        self.curves.push((label.into(), Rc::new(f)));
        self
    }

    /// One estimate at each of `xs`, with its 95 % interval. Several series are shifted sideways by a few pixels, lest they hide each other.
    pub fn estimates(mut self, label: &str, xs: &[f64], estimates: &[Estimate]) -> Self {
        let bar = |i: usize| {
            // a list too short leaves NaN, which is refused with the place
            let (x, e) = (xs.get(i).copied().unwrap_or(f64::NAN), estimates.get(i));
            Bar {
                x,
                value: e.map_or(f64::NAN, |e| e.value),
                half_width: e.and_then(|e| e.half_width(0.95)).unwrap_or(f64::NAN),
                std_error: e.and_then(|e| e.std_error).unwrap_or(f64::NAN),
            }
        };
        let bars = (0..xs.len().max(estimates.len())).map(bar).collect();
        self.points.push(Points { label: label.into(), bars, curve: self.curves.len().saturating_sub(1) });
        self
    }

    /// The simultaneous band of a [profile](crate::statistics::Profile) of ascending points, as a strip: with probability `confidence` the whole
    /// curve is inside.
    pub fn band(mut self, label: &str, profile: &statistics::Profile<f64>, confidence: f64) -> Self {
        let band = profile.band(confidence);
        let ends = |i: usize| band.as_ref().map_or([f64::NAN; 2], |b| [b.lower[i], b.upper[i]]);
        let place = |(i, (x, v)): (usize, (&f64, &f64))| [*x, ends(i)[0], *v, ends(i)[1]];
        let places = profile.points().iter().zip(profile.values()).enumerate().map(place).collect();
        self.bands.push(Strip { label: label.into(), places });
        self
    }

    /// Writes the picture; the extension `.svg` or `.png` chooses the format, missing folders are made.
    ///
    /// # Errors
    /// [`Error::Unplottable`] for a value that is not finite, an estimate without an error or outside the interval, lists of different lengths;
    /// [`Error::Invalid`] for an empty plot or interval; [`Error::Io`] with the path.
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
        self.interval.validate()?;
        some("curves and estimates", self.curves.len() + self.points.len() + self.bands.len())?;
        for Strip { label, places } in &self.bands {
            let (here, within) = (self.interval, "every point of a band must lie inside the interval of the plot");
            check(label, "x", within, places.iter().map(|p| p[0]), |x| here.contains(&x))?;
            check(
                label,
                "end of the band",
                "must be known and finite: more batches, or points that walks reach",
                places.iter().flat_map(|p| [p[1], p[3]]),
                |_| true,
            )?;
        }
        for Points { label, bars, .. } in &self.points {
            some("estimates", bars.len())?;
            let (here, within) = (self.interval, "every estimate needs an x inside the interval of the plot");
            check(label, "x", within, bars.iter().map(|b| b.x), |x| here.contains(&x))?;
            check(label, "value", "every x needs an estimate, and it must be finite", bars.iter().map(|b| b.value), |_| true)?;
            let known = "must be known and finite: take more samples or replicates";
            check(label, "half-width of the 95 % interval", known, bars.iter().map(|b| b.half_width), |_| true)?;
        }
        Ok(())
    }

    fn sampled(&self) -> Result<Lines, Error> {
        let at = |i: usize| self.interval.at(i as f64 / SAMPLES as f64);
        self.curves.iter().map(|(label, f)| (0..=SAMPLES).map(|i| finite(label, at(i), f(at(i)))).collect()).collect()
    }

    fn draw(&self) -> Result<Drawing, Error> {
        self.validate()?;
        let (curves, deviations) = (self.sampled()?, self.deviations()?);
        let x = Axis::linear(&self.x, [self.interval.lower(), self.interval.upper()], 0.025);
        let ends = self.points.iter().flat_map(|p| &p.bars).flat_map(|b| [b.value - b.half_width, b.value + b.half_width]);
        let ends = ends.chain(self.bands.iter().flat_map(Strip::ends));
        let y = Axis::linear(&self.y, curves.iter().flatten().map(|p| p.1).chain(ends), 0.06);
        let largest = deviations.iter().flatten().flatten().map(|d| d.1.abs()).fold(3.0, f64::max);
        let z = Axis::linear("deviation / σ", [-largest, largest], 0.08);
        let legend = self.legend();
        let left = Panel::room_left(&y, HEIGHT).max(Panel::room_left(&z, DEVIATIONS)) + 8.0;
        let frame = Frame { left, top: panel::top(&self.subtitle), width: WIDTH, height: HEIGHT };
        let lower = Frame { top: frame.top + HEIGHT + BETWEEN, height: DEVIATIONS, ..frame };
        let bottom = if deviations.is_some() { lower.top + DEVIATIONS } else { frame.top + HEIGHT };
        let beside = left + WIDTH + panel::legend_width(&legend) + 16.0;
        let mut drawing = Drawing::new(panel::page_width(beside, frame, &self.title, &self.subtitle), bottom + 52.0);
        let below = if deviations.is_some() { Below::Ticks } else { Below::Labels };
        self.upper(&Panel { frame, x: x.clone(), y }, &curves, below, &mut drawing);
        if let Some(deviations) = &deviations {
            self.lower(&Panel { frame: lower, x, y: z }, deviations, &mut drawing);
        }
        panel::legend(&mut drawing, frame, &legend);
        panel::title(&mut drawing, frame, &self.title, &self.subtitle);
        Ok(drawing)
    }

    fn legend(&self) -> Vec<Entry> {
        let entry = |i: usize, label: &str, curve: bool| {
            let Look { colour, marker, .. } = self.look(i);
            Entry { label: label.into(), colour, line: curve.then_some(look(i).dash), marker: (!curve).then_some(marker) }
        };
        let curves = self.curves.iter().enumerate().map(|(i, (label, _))| entry(i, label, true));
        let points = self.points.iter().enumerate().map(|(i, p)| entry(self.curves.len() + i, &p.label, false));
        let strip = |(i, b): (usize, &Strip)| Entry { line: Some(SOLID), ..entry(self.strip(i), &b.label, true) };
        curves.chain(points).chain(self.bands.iter().enumerate().map(strip)).collect()
    }

    /// Number of band `i` among all series.
    fn strip(&self, i: usize) -> usize {
        self.curves.len() + self.points.len() + i
    }

    /// The first curve is dark grey: it is what everything else is compared with.
    fn look(&self, index: usize) -> Look {
        match (index, self.curves.len()) {
            (0, 1..) => Look { colour: INK, ..look(0) },
            (i, 0) => look(i),
            (i, _) => look(i - 1),
        }
    }

    /// Series number `i` is shifted sideways by some pixels, so that error bars at the same x do not hide each other.
    fn shift(&self, i: usize) -> f64 {
        5.0 * (i as f64 - 0.5 * (self.points.len() - 1) as f64)
    }

    fn upper(&self, panel: &Panel, curves: &[Vec<(f64, f64)>], shared: Below, drawing: &mut Drawing) {
        panel.grid(drawing);
        self.bands.iter().enumerate().for_each(|(i, b)| b.draw(panel, self.look(self.strip(i)).colour, drawing));
        for (i, curve) in curves.iter().enumerate() {
            let places: Vec<_> = curve.iter().map(|p| panel.place(p.0, p.1)).collect();
            drawing.line(&places, self.look(i).colour, 1.8, look(i).dash);
        }
        for (i, points) in self.points.iter().enumerate() {
            let (look, shift) = (self.look(curves.len() + i), self.shift(i));
            for bar in &points.bars {
                let (x, y) = panel.place(bar.x, bar.value);
                let ends = [bar.value - bar.half_width, bar.value + bar.half_width].map(|v| panel.row(v));
                drawing.line(&ends.map(|e| (x + shift, e)), look.colour, 1.4, SOLID);
                ends.iter().for_each(|e| drawing.line(&[(x + shift - 3.5, *e), (x + shift + 3.5, *e)], look.colour, 1.4, SOLID));
                drawing.marker(look.marker, (x + shift, y), 3.6, look.colour);
            }
        }
        panel.axes(drawing, shared);
    }
}

/// A point of a curve, if there is one.
fn finite(series: &str, x: f64, value: f64) -> Result<(f64, f64), Error> {
    if value.is_finite() {
        return Ok((x, value));
    }
    let (series, at) = (series.to_owned(), format!("x = {x}"));
    Err(Error::Unplottable { series, quantity: "value", at, value, requirement: "a curve must be finite on the interval of the plot" })
}
