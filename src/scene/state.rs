//! What a walk of light stands on.

use super::frame::Vec3;

/// A surface point with the direction in which light leaves it, or one of the places outside.
///
/// As seen from x, a point y that sends light to x has the direction from y to x: the state is one of phase space, and the measure μ of the
/// equation is the area of its position (solid angle on the environment, counting on points and directions that emit).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State {
    pub(crate) place: Place,
    /// barycentric, or on a sphere, coordinates; see `geometry::Hit`
    pub(crate) u: f32,
    pub(crate) v: f32,
    pub(crate) position: [f64; 3],
    pub(crate) outgoing: [f64; 3],
}

/// Where a state is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// On this primitive of the geometry.
    Surface(u32),
    /// Infinitely far away, in the direction opposite to that in which light comes.
    Environment,
    /// On this light of no extent, which no ray hits.
    Light(u32),
    /// Nowhere: what gets here is gone.
    Void,
}

impl State {
    pub(crate) const VOID: State = State { place: Place::Void, u: 0.0, v: 0.0, position: [0.0; 3], outgoing: [0.0; 3] };

    /// The environment, seen in a direction.
    #[inline]
    pub(crate) fn environment(direction: &Vec3) -> Self {
        State { place: Place::Environment, outgoing: (-direction).into(), ..State::VOID }
    }

    /// Where it is.
    #[must_use]
    pub fn place(&self) -> Place {
        self.place
    }

    /// Position in space; the origin for the environment.
    #[must_use]
    pub fn position(&self) -> [f64; 3] {
        self.position
    }

    /// Unit vector along which the light asked for leaves.
    #[must_use]
    pub fn outgoing(&self) -> [f64; 3] {
        self.outgoing
    }
}
