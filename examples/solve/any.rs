//! Several domains as one type: what is compiled for every domain, all walks and all solves, is compiled once for all that have the same points.

use fredholm::Error;
use fredholm::domain::{Cuboid, Disk, Domain, HalfLine, Interval, Line, Node};
use fredholm::sampling::Sampler;

macro_rules! one_of {
    ($(#[$doc:meta])* $any:ident<$point:ty> { $($kind:ident($domain:ty)),* }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug)]
        pub(crate) enum $any {
            $($kind($domain)),*
        }

        $(impl From<$domain> for $any {
            fn from(domain: $domain) -> Self {
                $any::$kind(domain)
            }
        })*

        impl Domain for $any {
            type Point = $point;
            fn validate(&self) -> Result<(), Error> {
                match self { $($any::$kind(d) => d.validate()),* }
            }
            fn volume(&self) -> f64 {
                match self { $($any::$kind(d) => d.volume()),* }
            }
            fn contains(&self, x: &$point) -> bool {
                match self { $($any::$kind(d) => d.contains(x)),* }
            }
            fn dimension(&self) -> usize {
                match self { $($any::$kind(d) => d.dimension()),* }
            }
            fn place(&self, state: usize, next: impl FnMut() -> f64) -> Node<$point> {
                match self { $($any::$kind(d) => d.place(state, next)),* }
            }
            fn coordinate(&self, x: &$point, axis: usize) -> f64 {
                match self { $($any::$kind(d) => d.coordinate(x, axis)),* }
            }
            fn displaced(&self, x: &$point, state: usize, distance: f64) -> Node<$point> {
                match self { $($any::$kind(d) => d.displaced(x, state, distance)),* }
            }
            fn separation(&self, x: &$point, y: &$point) -> f64 {
                match self { $($any::$kind(d) => d.separation(x, y)),* }
            }
            fn difference(&self, x: &$point, distance: f64) -> Option<f64> {
                match self { $($any::$kind(d) => d.difference(x, distance)),* }
            }
            fn stretch(&self) -> Option<f64> {
                match self { $($any::$kind(d) => d.stretch()),* }
            }
            fn locate(&self, x: f64) -> Option<f64> {
                match self { $($any::$kind(d) => d.locate(x)),* }
            }
            fn is_periodic(&self, axis: usize) -> bool {
                match self { $($any::$kind(d) => d.is_periodic(axis)),* }
            }
            fn around(&self, x: &$point, order: usize) -> Option<Vec<Node<$point>>> {
                match self { $($any::$kind(d) => d.around(x, order)),* }
            }
            fn density(&self, x: &$point) -> f64 {
                match self { $($any::$kind(d) => d.density(x)),* }
            }
            fn sample<S: Sampler>(&self, u: &mut S) -> Node<$point> {
                match self { $($any::$kind(d) => d.sample(u)),* }
            }
            fn rule(&self, panels: usize, order: usize) -> Vec<Node<$point>> {
                match self { $($any::$kind(d) => d.rule(panels, order)),* }
            }
        }
    };
}

one_of! {
    /// A part of the real line.
    AnyLine<f64> { Interval(Interval), HalfLine(HalfLine), Line(Line) }
}

one_of! {
    /// A part of the plane.
    AnyPlane<[f64; 2]> { Box(Cuboid<2>), Disk(Disk) }
}
