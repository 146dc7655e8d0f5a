//! Strips between two curves.

use crate::plot::drawing::Drawing;
use crate::plot::panel::Panel;
use crate::plot::style::{Colour, SOLID};

/// A simultaneous band around its values.
#[derive(Clone, Debug)]
pub(super) struct Strip {
    pub(super) label: String,
    /// x, lower end, value, upper end, ascending in x; NaN where there is no band, which is refused
    pub(super) places: Vec<[f64; 4]>,
}

impl Strip {
    /// All heights.
    pub(super) fn ends(&self) -> impl Iterator<Item = f64> + '_ {
        self.places.iter().flat_map(|p| [p[1], p[3]])
    }

    /// A pale area with edges, and the values as a line.
    pub(super) fn draw(&self, panel: &Panel, colour: Colour, drawing: &mut Drawing) {
        let side = |k: usize| self.places.iter().map(move |p| panel.place(p[0], p[k]));
        drawing.area(side(1).chain(side(3).rev()).collect(), pale(colour));
        for (k, width) in [(1, 0.8), (3, 0.8), (2, 1.6)] {
            drawing.line(&side(k).collect::<Vec<_>>(), colour, width, SOLID);
        }
    }
}

/// Four fifths white.
fn pale((r, g, b): Colour) -> Colour {
    let mix = |c: u8| (204 + u16::from(c) / 5) as u8;
    (mix(r), mix(g), mix(b))
}
