//! The panel of deviations from a curve.

use super::{Bar, Lines, Points, Profile, finite};
use crate::error::Error;
use crate::plot::drawing::Drawing;
use crate::plot::panel::{Below, Panel};
use crate::plot::style::{DASHED, GREY, INK, SOLID};

/// 95 % of a normal distribution lies within ± this many standard deviations.
const NORMAL_95: f64 = 1.96;

impl Profile<'_> {
    /// (x, deviation in standard errors) of every series; `None` without a curve to deviate from.
    pub(super) fn deviations(&self) -> Result<Option<Lines>, Error> {
        if self.curves.is_empty() || self.points.is_empty() {
            return Ok(None);
        }
        let one = |points: &Points, b: &Bar| {
            let (label, f) = &self.curves[points.curve];
            let expected = finite(label, b.x, f(b.x))?.1;
            // an estimate without variance deviates by rounding at most, or infinitely: the latter cannot be drawn
            let same = (b.value - expected).abs() <= 16.0 * f64::EPSILON * expected.abs();
            let z = if same { 0.0 } else { (b.value - expected) / b.std_error };
            if z.is_finite() {
                return Ok((b.x, z));
            }
            let (series, requirement) = (points.label.clone(), "an estimate of standard error 0 lies off the curve");
            Err(Error::Unplottable { series, quantity: "deviation in standard errors", at: format!("x = {}", b.x), value: z, requirement })
        };
        self.points.iter().map(|p| p.bars.iter().map(|b| one(p, b)).collect()).collect::<Result<_, _>>().map(Some)
    }

    pub(super) fn lower(&self, panel: &Panel, deviations: &[Vec<(f64, f64)>], drawing: &mut Drawing) {
        panel.grid(drawing);
        let (from, to) = panel.x.ends();
        for (z, colour, dash) in [(0.0, INK, SOLID), (NORMAL_95, GREY, DASHED), (-NORMAL_95, GREY, DASHED)] {
            drawing.line(&[panel.place(from, z), panel.place(to, z)], colour, 1.2, dash);
        }
        for (i, series) in deviations.iter().enumerate() {
            let look = self.look(self.curves.len() + i);
            for (x, z) in series {
                let (x, y) = panel.place(*x, *z);
                drawing.marker(look.marker, (x + self.shift(i), y), 3.6, look.colour);
            }
        }
        panel.axes(drawing, Below::Labels);
    }
}
