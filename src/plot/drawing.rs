//! A drawing is a list of marks, painted by plotters as SVG or as PNG.

use super::style::{Colour, Dash, INK, Marker, WHITE};
use crate::error::Error;
use crate::output::replace;
use plotters::backend::{BitMapBackend, DrawingBackend, SVGBackend};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{Color, FontDesc, FontFamily, FontStyle, FontTransform, RGBColor, ShapeStyle, TextStyle, register_font};
use std::path::Path;
use std::sync::Once;

/// What SVG viewers shall look for; PNG text is drawn with the first, which is embedded.
const FONTS: &str = "DejaVu Sans, Verdana, sans-serif";
/// plotters has integer coordinates: SVG is drawn in tenths of a pixel.
const SVG_UNITS: f64 = 10.0;
/// PNG has two dots a pixel, each the mean of 3 × 3 painted ones.
const PNG_DOTS: usize = 2;
const OVERSAMPLING: usize = 3;

/// Where a text stands relative to its point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Align {
    Left,
    Centre,
    Right,
}

/// Which way a text runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Turn {
    Level,
    Upwards,
}

#[derive(Clone, Debug)]
enum Mark {
    Line { points: Vec<(f64, f64)>, colour: Colour, width: f64 },
    Area { points: Vec<(f64, f64)>, colour: Colour },
    Disc { centre: (f64, f64), radius: f64, colour: Colour },
    Text { text: String, baseline: (f64, f64), size: f64, colour: Colour, align: Align, turn: Turn },
}

/// Marks on a white page, in pixels from the upper left corner.
#[derive(Clone, Debug)]
pub(super) struct Drawing {
    width: f64,
    height: f64,
    marks: Vec<Mark>,
}

impl Drawing {
    pub(super) fn new(width: f64, height: f64) -> Self {
        let page = vec![(0.0, 0.0), (width, 0.0), (width, height), (0.0, height)];
        Drawing { width, height, marks: vec![Mark::Area { points: page, colour: WHITE }] }
    }

    pub(super) fn line(&mut self, points: &[(f64, f64)], colour: Colour, width: f64, dash: Dash) {
        if dash.is_empty() {
            self.marks.push(Mark::Line { points: points.to_vec(), colour, width });
        } else {
            self.marks.extend(dashes(points, dash).into_iter().map(|points| Mark::Line { points, colour, width }));
        }
    }

    pub(super) fn area(&mut self, points: Vec<(f64, f64)>, colour: Colour) {
        self.marks.push(Mark::Area { points, colour });
    }

    /// A filled marker with a thin white edge, so that neighbours stay apart.
    pub(super) fn marker(&mut self, marker: Marker, at: (f64, f64), radius: f64, colour: Colour) {
        for (r, colour) in [(radius + 1.0, WHITE), (radius, colour)] {
            match marker {
                Marker::Disc => self.marks.push(Mark::Disc { centre: at, radius: r, colour }),
                _ => self.area(marker.corners(at, r), colour),
            }
        }
    }

    /// Text whose baseline begins, is centred or ends at `baseline`.
    pub(super) fn text(&mut self, text: impl Into<String>, baseline: (f64, f64), size: f64, align: Align) {
        self.marks.push(Mark::Text { text: text.into(), baseline, size, colour: INK, align, turn: Turn::Level });
    }

    pub(super) fn coloured_text(&mut self, text: impl Into<String>, baseline: (f64, f64), size: f64, align: Align, colour: Colour) {
        self.marks.push(Mark::Text { text: text.into(), baseline, size, colour, align, turn: Turn::Level });
    }

    /// Text that runs upwards, centred at `baseline`.
    pub(super) fn upward_text(&mut self, text: impl Into<String>, baseline: (f64, f64), size: f64) {
        self.marks.push(Mark::Text { text: text.into(), baseline, size, colour: INK, align: Align::Centre, turn: Turn::Upwards });
    }

    pub(super) fn to_svg(&self) -> Result<String, Error> {
        let (w, h) = ((self.width * SVG_UNITS).round() as u32, (self.height * SVG_UNITS).round() as u32);
        let mut svg = String::new();
        let mut backend = SVGBackend::with_string(&mut svg, (w, h));
        // SVG: font size and the drop from the top of a text to its baseline, both as written by plotters-svg
        self.paint(&mut backend, SVG_UNITS, 1.24, 0.76).map_err(|m| failed("svg", m))?;
        backend.present().map_err(|e| failed("svg", e.to_string()))?;
        drop(backend);
        let drawn = format!("width=\"{w}\" height=\"{h}\"");
        Ok(svg.replacen(&drawn, &format!("width=\"{}\" height=\"{}\"", self.width, self.height), 1))
    }

    pub(super) fn to_png(&self) -> Result<Vec<u8>, Error> {
        let scale = (PNG_DOTS * OVERSAMPLING) as f64;
        let (w, h) = (self.width.round() as usize * PNG_DOTS, self.height.round() as usize * PNG_DOTS);
        let mut painted = vec![255; 3 * w * h * OVERSAMPLING * OVERSAMPLING];
        let mut backend = BitMapBackend::with_buffer(&mut painted, ((w * OVERSAMPLING) as u32, (h * OVERSAMPLING) as u32));
        // PNG: DejaVu's ascent and descent are 1.164 em, and plotters puts the baseline half the size below the top
        self.paint(&mut backend, scale, 1.164, 0.582).map_err(|m| failed("png", m))?;
        drop(backend);
        encode(&reduce(&painted, w, h), w as u32, h as u32).map_err(|e| failed("png", e.to_string()))
    }

    pub(super) fn save(&self, path: &Path) -> Result<(), Error> {
        let bytes = match path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase).as_deref() {
            Some("svg") => self.to_svg()?.into_bytes(),
            Some("png") => self.to_png()?,
            _ => return Err(failed(&path.display().to_string(), "unknown kind of picture: the name must end in .svg or .png".into())),
        };
        replace(path, &bytes)
    }

    /// `units` a pixel; a font of size s em is asked for as s·`em`, and its baseline lies s·`drop` below its top.
    fn paint<B: DrawingBackend>(&self, backend: &mut B, units: f64, em: f64, drop: f64) -> Result<(), String> {
        let place = |(x, y): (f64, f64)| ((x * units).round() as i32, (y * units).round() as i32);
        for mark in &self.marks {
            let done = match mark {
                Mark::Line { points, colour, width } => {
                    let style = ShapeStyle { color: rgb(*colour).into(), filled: false, stroke_width: (width * units).round() as u32 };
                    backend.draw_path(points.iter().map(|p| place(*p)), &style)
                }
                Mark::Area { points, colour } => backend.fill_polygon(points.iter().map(|p| place(*p)), &rgb(*colour)),
                Mark::Disc { centre, radius, colour } => {
                    backend.draw_circle(place(*centre), (radius * units).round() as u32, &rgb(*colour), true)
                }
                Mark::Text { text, baseline: (x, y), size, colour, align, turn } => {
                    let top = match turn {
                        Turn::Level => (*x, y - drop * size),
                        Turn::Upwards => (x - drop * size, *y),
                    };
                    backend.draw_text(text, &lettering(size * em * units, *colour, *align, *turn), place(top))
                }
            };
            done.map_err(|e| e.to_string())?;
        }
        Ok(())
    }
}

fn rgb((r, g, b): Colour) -> RGBColor {
    RGBColor(r, g, b)
}

fn font(size: f64) -> FontDesc<'static> {
    static REGISTERED: Once = Once::new();
    REGISTERED.call_once(|| {
        // an embedded font that cannot be read leaves the name unknown, and painting text then fails with that message
        let _ = register_font(FONTS, FontStyle::Normal, dejavu::sans::regular());
    });
    FontDesc::new(FontFamily::Name(FONTS), size, FontStyle::Normal)
}

fn lettering(size: f64, colour: Colour, align: Align, turn: Turn) -> TextStyle<'static> {
    let h_pos = match align {
        Align::Left => HPos::Left,
        Align::Centre => HPos::Center,
        Align::Right => HPos::Right,
    };
    let transform = match turn {
        Turn::Level => FontTransform::None,
        Turn::Upwards => FontTransform::Rotate270,
    };
    let mut style = TextStyle::from(font(size).transform(transform)).pos(Pos::new(h_pos, VPos::Top));
    style.color = rgb(colour).to_backend_color();
    style
}

/// Width in pixels of a text of `size` pixels an em, in the embedded font.
pub(super) fn text_width(text: &str, size: f64) -> f64 {
    // measured large, because layouts are whole numbers; an unreadable font fails where it is painted, not here
    font(100.0 * 1.164).layout_box(text).map_or(0.6 * size * text.chars().count() as f64, |(a, b)| f64::from(b.0 - a.0) * size / 100.0)
}

/// Cuts a polyline into the pieces that a dash pattern leaves.
fn dashes(points: &[(f64, f64)], dash: Dash) -> Vec<Vec<(f64, f64)>> {
    let (mut pieces, mut piece) = (Vec::new(), Vec::from_iter(points.first().copied()));
    let (mut part, mut left) = (0, dash[0]);
    for pair in points.windows(2) {
        let (mut from, to) = (pair[0], pair[1]);
        loop {
            let length = (to.0 - from.0).hypot(to.1 - from.1);
            if length < left {
                left -= length;
                piece.push(to);
                break;
            }
            let t = left / length;
            from = (from.0 + t * (to.0 - from.0), from.1 + t * (to.1 - from.1));
            piece.push(from);
            if part % 2 == 0 {
                pieces.push(std::mem::take(&mut piece));
            }
            piece = vec![from];
            part = (part + 1) % dash.len();
            left = dash[part];
        }
    }
    if part % 2 == 0 && piece.len() > 1 {
        pieces.push(piece);
    }
    pieces
}

/// The mean of every block of painted dots.
fn reduce(painted: &[u8], width: usize, height: usize) -> Vec<u8> {
    const N: usize = OVERSAMPLING;
    let mut dots = Vec::with_capacity(3 * width * height);
    for y in 0..height {
        for x in 0..width {
            for c in 0..3 {
                let at = |i: usize| painted[3 * ((y * N + i / N) * width * N + x * N + i % N) + c];
                let sum: usize = (0..N * N).map(|i| usize::from(at(i))).sum();
                dots.push(((sum + N * N / 2) / (N * N)) as u8);
            }
        }
    }
    dots
}

fn encode(dots: &[u8], width: u32, height: u32) -> Result<Vec<u8>, png::EncodingError> {
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(dots)?;
    writer.finish()?;
    Ok(file)
}

fn failed(path: &str, message: String) -> Error {
    Error::Io { path: path.to_owned(), message }
}
