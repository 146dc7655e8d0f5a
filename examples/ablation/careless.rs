//! The equation of light with the shadow rays that it spares: nothing comes of them but their cost.

use fredholm::Equation;
use fredholm::domain::Node;
use fredholm::kernel::{Kernel, Operator, Step, Transition, TransitionPdf};
use fredholm::sampling::Sampler;
use fredholm::scene::{Emission, LightTransport, Place, Rgb, Scene, State, geometry::Ray};
use fredholm::source::{SampleSource, Source};
use std::hint::black_box;

/// Source or kernel; a ray to the lamp for every connection that is never tried if `wasteful`, and as it is if not.
pub(crate) struct Careless<T> {
    inner: T,
    scene: Scene,
    wasteful: bool,
}

pub(crate) fn equation(
    light: &Equation<Emission, LightTransport>,
    scene: &Scene,
    wasteful: bool,
) -> Equation<Careless<Emission>, Careless<LightTransport>> {
    let scene = || scene.clone();
    let source = Careless { inner: light.source().clone(), scene: scene(), wasteful };
    Equation::new(source, Careless { inner: light.kernel().clone(), scene: scene(), wasteful })
}

impl<T> Careless<T> {
    #[inline]
    fn waste(&self, x: &State) {
        if self.wasteful && matches!(x.place(), Place::Surface(_)) {
            let [a, b, c] = x.position();
            let ray = Ray::new([a, b, c], [-a, super::scenes::LAMP - b, -c]).until(0.999);
            black_box(self.scene.geometry().occluded(&ray));
        }
    }
}

impl Source for Careless<Emission> {
    type Point = State;
    type Value = Rgb;
    #[inline]
    fn eval(&self, x: &State) -> Rgb {
        self.inner.eval(x)
    }
}

impl SampleSource for Careless<Emission> {
    #[inline]
    fn sample_for<S: Sampler>(&self, x: &State, u: &mut S) -> Option<Node<State>> {
        let event = self.inner.sample_for(x, u);
        if event.is_none() {
            self.waste(x);
        }
        event
    }
    #[inline]
    fn pdf_for(&self, x: &State, y: &State) -> f64 {
        self.inner.pdf_for(x, y)
    }
}

impl Operator for Careless<LightTransport> {
    type Point = State;
    type Weight = Rgb;
}

impl Kernel for Careless<LightTransport> {
    #[inline]
    fn eval(&self, x: &State, y: &State) -> Rgb {
        self.inner.eval(x, y)
    }
}

impl Transition for Careless<LightTransport> {
    #[inline]
    fn step<S: Sampler>(&self, x: &State, u: &mut S) -> Option<Step<State, Rgb>> {
        self.inner.step(x, u)
    }
}

impl TransitionPdf for Careless<LightTransport> {
    #[inline]
    fn pdf(&self, x: &State, y: &State) -> f64 {
        self.inner.pdf(x, y)
    }
    #[inline]
    fn eval_and_pdf(&self, x: &State, y: &State) -> (Rgb, f64) {
        let found = self.inner.eval_and_pdf(x, y);
        // blocked connections had their ray: the scenes have none
        if found.0 == Rgb::default() {
            self.waste(x);
        }
        found
    }
}
