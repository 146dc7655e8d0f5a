//! Colours, markers and dashes that are told apart by everybody, also in grey.

/// Red, green, blue.
pub(super) type Colour = (u8, u8, u8);

pub(super) const WHITE: Colour = (255, 255, 255);
pub(super) const INK: Colour = (34, 34, 34);
pub(super) const GREY: Colour = (110, 110, 110);
pub(super) const GRID: Colour = (226, 226, 226);

/// Okabe, Ito (2008), the dark ones first; yellow is left out, it vanishes on white.
const PALETTE: [Colour; 7] = [(0, 114, 178), (213, 94, 0), (0, 158, 115), (204, 121, 167), (230, 159, 0), (86, 180, 233), (0, 0, 0)];

/// The shape of a data point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Marker {
    Disc,
    Square,
    Triangle,
    Diamond,
    Cross,
    Fallen,
}

/// How a line is broken, in pixels of dash and gap.
pub(super) type Dash = &'static [f64];
pub(super) const SOLID: Dash = &[];
pub(super) const DASHED: Dash = &[7.0, 4.0];

/// How a series looks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Look {
    pub(super) colour: Colour,
    pub(super) marker: Marker,
    pub(super) dash: Dash,
}

/// Look number `index`. Colours repeat after 7, markers after 5, dashes after 4: 140 series differ.
pub(super) fn look(index: usize) -> Look {
    const MARKERS: [Marker; 5] = [Marker::Disc, Marker::Square, Marker::Triangle, Marker::Diamond, Marker::Cross];
    const DASHES: [Dash; 4] = [SOLID, &[9.0, 3.0], &[3.0, 3.0], &[9.0, 3.0, 2.0, 3.0]];
    Look { colour: PALETTE[index % 7], marker: MARKERS[index % 5], dash: DASHES[index % 4] }
}

impl Marker {
    /// Corners around `(x, y)`, `r` pixels away; the disc has none, the cross is a polygon of twelve.
    pub(super) fn corners(self, (x, y): (f64, f64), r: f64) -> Vec<(f64, f64)> {
        let unit: &[(f64, f64)] = match self {
            Marker::Disc => &[],
            Marker::Square => &[(-0.88, -0.88), (0.88, -0.88), (0.88, 0.88), (-0.88, 0.88)],
            Marker::Triangle => &[(0.0, -1.2), (1.1, 0.8), (-1.1, 0.8)],
            Marker::Fallen => &[(0.0, 1.2), (1.1, -0.8), (-1.1, -0.8)],
            Marker::Diamond => &[(0.0, -1.3), (1.3, 0.0), (0.0, 1.3), (-1.3, 0.0)],
            Marker::Cross => &[
                (0.0, -0.4),
                (0.7, -1.1),
                (1.1, -0.7),
                (0.4, 0.0),
                (1.1, 0.7),
                (0.7, 1.1),
                (0.0, 0.4),
                (-0.7, 1.1),
                (-1.1, 0.7),
                (-0.4, 0.0),
                (-1.1, -0.7),
                (-0.7, -1.1),
            ],
        };
        unit.iter().map(|(u, v)| (x + r * u, y + r * v)).collect()
    }
}
