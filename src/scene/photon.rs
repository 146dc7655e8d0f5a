//! What a walk from the lights stands on.

use super::frame::Vec3;
use super::state::{Place, State};

/// A point that light comes to, with the direction it comes from; or a point of a light, where it starts.
///
/// [`State`] is the same of walks from the camera: there light *leaves* in the direction kept. Between both, see
/// [`Connect`](crate::walk::Connect).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Photon {
    pub(crate) place: Place,
    /// as in `State`
    pub(crate) u: f32,
    pub(crate) v: f32,
    pub(crate) position: [f64; 3],
    /// unit vector back along its flight; 0 where it starts at finite distance
    pub(crate) from: [f64; 3],
    /// whether it starts here
    pub(crate) emitted: bool,
}

impl Photon {
    pub(crate) const NOWHERE: Photon = Photon { place: Place::Void, u: 0.0, v: 0.0, position: [0.0; 3], from: [0.0; 3], emitted: true };

    /// Emitted where x is.
    #[inline]
    pub(crate) fn emitted(x: &State) -> Self {
        let State { place, u, v, position, outgoing } = *x;
        let from = match place {
            Place::Surface(_) => [0.0; 3],
            // far away, or nowhere: light leaves in one direction
            _ => outgoing.map(|c| -c),
        };
        Photon { place, u, v, position, from, emitted: true }
    }

    /// Arrived where x is, from a direction.
    #[inline]
    pub(crate) fn arrived(x: &State, from: &Vec3) -> Self {
        let State { place, u, v, position, .. } = *x;
        Photon { place, u, v, position, from: (*from).into(), emitted: false }
    }

    /// The place, seen from where light goes along `outgoing`.
    #[inline]
    pub(crate) fn seen(&self, outgoing: &Vec3) -> State {
        let Photon { place, u, v, position, .. } = *self;
        State { place, u, v, position, outgoing: (*outgoing).into() }
    }

    /// The place where light leaves back along its flight, which is how scattering laws draw directions.
    #[inline]
    pub(crate) fn turned(&self) -> State {
        self.seen(&self.from.into())
    }

    /// Where it is.
    #[must_use]
    pub fn place(&self) -> Place {
        self.place
    }

    /// Position in space; the origin if it starts infinitely far away.
    #[must_use]
    pub fn position(&self) -> [f64; 3] {
        self.position
    }

    /// Unit vector to where it comes from; 0 where it starts at finite distance.
    #[must_use]
    pub fn from(&self) -> [f64; 3] {
        self.from
    }
}
