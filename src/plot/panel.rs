//! A frame with axes, and the legend beside it.

use super::axis::{Axis, Tick};
use super::drawing::{Align, Drawing, text_width};
use super::style::{Colour, Dash, GREY, GRID, INK, Look, Marker, SOLID};

pub(super) const TITLE: f64 = 17.0;
pub(super) const TEXT: f64 = 13.0;
const FRAME: f64 = 1.2;
const MAJOR: f64 = 6.0;
const MINOR: f64 = 3.5;

/// Where a frame stands on the page, in pixels.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    pub(super) left: f64,
    pub(super) top: f64,
    pub(super) width: f64,
    pub(super) height: f64,
}

/// Axes in a frame.
#[derive(Clone, Debug)]
pub(super) struct Panel {
    pub(super) frame: Frame,
    pub(super) x: Axis,
    pub(super) y: Axis,
}

/// Whether a panel names the numbers of its x-axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Below {
    Labels,
    /// another panel with the same axis stands below
    Ticks,
}

impl Panel {
    /// The pixel of a point.
    pub(super) fn place(&self, x: f64, y: f64) -> (f64, f64) {
        (self.column(x), self.row(y))
    }

    fn column(&self, x: f64) -> f64 {
        self.frame.left + self.frame.width * self.x.position(x)
    }

    pub(super) fn row(&self, y: f64) -> f64 {
        self.frame.top + self.frame.height * (1.0 - self.y.position(y))
    }

    /// Room for the labels and the name of `axis` left of a frame of this height.
    pub(super) fn room_left(axis: &Axis, height: f64) -> f64 {
        let widest = y_ticks(axis, height).into_iter().filter_map(|t| t.label).map(|l| text_width(&l, TEXT)).fold(0.0, f64::max);
        let name = if axis.label.is_empty() { 0.0 } else { 1.8 * TEXT };
        widest + name + 18.0
    }

    /// Grid lines of the labelled ticks: painted before the data.
    pub(super) fn grid(&self, drawing: &mut Drawing) {
        self.x_grid(drawing);
        let Frame { left, width, height, .. } = self.frame;
        for tick in y_ticks(&self.y, height).iter().filter(|t| t.label.is_some()) {
            let y = self.row(tick.value);
            drawing.line(&[(left, y), (left + width, y)], GRID, 1.0, SOLID);
        }
    }

    /// Grid lines of x alone, for panels whose rows have names.
    pub(super) fn x_grid(&self, drawing: &mut Drawing) {
        let Frame { top, height, .. } = self.frame;
        for tick in self.x_ticks().iter().filter(|t| t.label.is_some()) {
            let x = self.column(tick.value);
            drawing.line(&[(x, top), (x, top + height)], GRID, 1.0, SOLID);
        }
    }

    /// Frame, ticks, numbers and names: painted after the data.
    pub(super) fn axes(&self, drawing: &mut Drawing, below: Below) {
        self.y_axis(drawing);
        self.x_axis(drawing, below);
        self.border(drawing);
    }

    pub(super) fn border(&self, drawing: &mut Drawing) {
        let Frame { left, top, width, height } = self.frame;
        let (right, bottom) = (left + width, top + height);
        // four lines: a closed path loses an edge where plotters fills thick paths as polygons
        let corners = [(left, top), (right, top), (right, bottom), (left, bottom), (left, top)];
        corners.windows(2).for_each(|side| drawing.line(side, INK, FRAME, SOLID));
    }

    fn y_axis(&self, drawing: &mut Drawing) {
        let Frame { left, top, width, height } = self.frame;
        for tick in y_ticks(&self.y, height) {
            let y = self.row(tick.value);
            let length = if tick.label.is_some() { MAJOR } else { MINOR };
            drawing.line(&[(left, y), (left + length, y)], INK, 1.0, SOLID);
            drawing.line(&[(left + width, y), (left + width - length, y)], INK, 1.0, SOLID);
            if let Some(label) = tick.label {
                drawing.text(label, (left - 7.0, y + 0.36 * TEXT), TEXT, Align::Right);
            }
        }
        let x = left - Panel::room_left(&self.y, height) + 1.2 * TEXT;
        drawing.upward_text(self.y.label.as_str(), (x, top + height / 2.0), TEXT);
    }

    /// The x-axis alone, for panels whose rows have names.
    pub(super) fn x_axis(&self, drawing: &mut Drawing, below: Below) {
        let Frame { left, top, width, height } = self.frame;
        let bottom = top + height;
        for tick in self.x_ticks() {
            let x = self.column(tick.value);
            let length = if tick.label.is_some() { MAJOR } else { MINOR };
            drawing.line(&[(x, bottom), (x, bottom - length)], INK, 1.0, SOLID);
            drawing.line(&[(x, top), (x, top + length)], INK, 1.0, SOLID);
            if let (Some(label), Below::Labels) = (tick.label, below) {
                drawing.text(label, (x, bottom + 1.45 * TEXT), TEXT, Align::Centre);
            }
        }
        if below == Below::Labels {
            drawing.text(self.x.label.as_str(), (left + width / 2.0, bottom + 3.1 * TEXT), TEXT, Align::Centre);
        }
    }

    fn x_ticks(&self) -> Vec<Tick> {
        self.x.ticks((self.frame.width / 75.0) as usize)
    }
}

fn y_ticks(axis: &Axis, height: f64) -> Vec<Tick> {
    axis.ticks(((height / 42.0) as usize).max(4))
}

/// One line of a legend.
#[derive(Clone, Debug)]
pub(super) struct Entry {
    pub(super) label: String,
    pub(super) colour: Colour,
    pub(super) line: Option<Dash>,
    pub(super) marker: Option<Marker>,
}

impl Entry {
    pub(super) fn series(label: &str, look: Look) -> Self {
        Entry { label: label.to_owned(), colour: look.colour, line: Some(look.dash), marker: Some(look.marker) }
    }
}

const SAMPLE: f64 = 34.0;
const GAP: f64 = 14.0;

/// Width of a legend that stands right of a frame: it can never lie on the data.
pub(super) fn legend_width(entries: &[Entry]) -> f64 {
    if entries.is_empty() {
        return 0.0;
    }
    GAP + SAMPLE + 8.0 + entries.iter().map(|e| text_width(&e.label, TEXT)).fold(0.0, f64::max)
}

/// Paints the legend right of `frame`.
pub(super) fn legend(drawing: &mut Drawing, frame: Frame, entries: &[Entry]) {
    let left = frame.left + frame.width + GAP;
    for (i, entry) in entries.iter().enumerate() {
        let y = frame.top + 10.0 + 1.65 * TEXT * i as f64;
        if let Some(dash) = entry.line {
            drawing.line(&[(left, y), (left + SAMPLE, y)], entry.colour, 1.8, dash);
        }
        if let Some(marker) = entry.marker {
            drawing.marker(marker, (left + SAMPLE / 2.0, y), 4.2, entry.colour);
        }
        drawing.text(entry.label.as_str(), (left + SAMPLE + 8.0, y + 0.36 * TEXT), TEXT, Align::Left);
    }
}

/// Distance of the first frame from the upper edge: room for the title.
pub(super) fn top(subtitle: &str) -> f64 {
    if subtitle.is_empty() { 42.0 } else { 58.0 }
}

/// Paints the title above `frame`, and a line of smaller text below it.
pub(super) fn title(drawing: &mut Drawing, frame: Frame, title: &str, subtitle: &str) {
    let baseline = frame.top - if subtitle.is_empty() { 14.0 } else { 30.0 };
    drawing.text(title, (frame.left, baseline), TITLE, Align::Left);
    drawing.coloured_text(subtitle, (frame.left, frame.top - 11.0), TEXT, Align::Left, GREY);
}

/// Width of a page that holds a title over `frame` and whatever ends at `right`.
pub(super) fn page_width(right: f64, frame: Frame, title: &str, subtitle: &str) -> f64 {
    let text = text_width(title, TITLE).max(text_width(subtitle, TEXT));
    right.max(frame.left + text + 16.0).ceil()
}
