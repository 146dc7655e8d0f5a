//! How much work walks did in a scene, and how much they were spared.

use super::{Emission, LightTransport, Scene};
use crate::equation::Equation;
use std::fmt;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

/// Counts of an equation made by [`Scene::counted`]; other equations count nothing.
///
/// ```
/// use fredholm::{Walk, scene::{Camera, Counters, Material, Scene, shapes}};
/// let mut scene = Scene::builder();
/// let mirror = scene.material(Material::mirror([0.5; 3]).emitting([1.0; 3]));
/// scene.mesh(shapes::room([-1.0; 3], [1.0; 3])?, mirror)?;
/// let scene = scene.build()?;
/// let (equation, counters) = scene.counted();
/// equation.seen_by(&scene.film(Camera::look_at([0.0; 3], [1.0, 0.2, 0.3]), 1, 1)).solve(&Walk::mis())?;
/// assert!(counters.rays() > 0 && counters.shadow_rays() == 0 && counters.mirrors() > 0);
/// # Ok::<(), fredholm::Error>(())
/// ```
#[derive(Debug, Default)]
pub struct Counters {
    pub(super) rays: AtomicU64,
    pub(super) shadow_rays: AtomicU64,
    pub(super) blocked: AtomicU64,
    pub(super) mirrors: AtomicU64,
    pub(super) unseen: AtomicU64,
    pub(super) dark: AtomicU64,
}

impl Counters {
    /// Rays traced to the next surface, camera rays left out.
    pub fn rays(&self) -> u64 {
        self.rays.load(Relaxed)
    }

    /// Connections that cost a shadow ray.
    pub fn shadow_rays(&self) -> u64 {
        self.shadow_rays.load(Relaxed)
    }

    /// Those of them that something blocked.
    pub fn blocked(&self) -> u64 {
        self.blocked.load(Relaxed)
    }

    /// Connections never tried: the point is on a mirror, clear glass, a black back, or outside.
    pub fn mirrors(&self) -> u64 {
        self.mirrors.load(Relaxed)
    }

    /// Connections never tried: the light drawn faces away, or all lights are below the horizon.
    pub fn unseen(&self) -> u64 {
        self.unseen.load(Relaxed)
    }

    /// Shadow rays avoided: cosine or scattering law are 0.
    pub fn dark(&self) -> u64 {
        self.dark.load(Relaxed)
    }
}

/// Adds 1, if anyone counts.
#[inline]
pub(super) fn count(counters: &Option<Arc<Counters>>, which: impl Fn(&Counters) -> &AtomicU64) {
    if let Some(counters) = counters {
        which(counters).fetch_add(1, Relaxed);
    }
}

impl Scene {
    /// The equation of light, and what will be counted when it is solved. The same numbers come out; counting costs time.
    #[must_use]
    pub fn counted(&self) -> (Equation<Emission, LightTransport>, Arc<Counters>) {
        let counters = Arc::new(Counters::default());
        (self.transport(Some(counters.clone())), counters)
    }
}

impl fmt::Display for Counters {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let tried = self.shadow_rays() + self.mirrors() + self.unseen() + self.dark();
        let share = |n: u64| 100.0 * n as f64 / tried.max(1) as f64;
        write!(f, "{} rays, {} shadow rays ({:.0} % blocked); ", self.rays(), self.shadow_rays(), share(self.blocked()))?;
        write!(f, "of {tried} connections {:.0} % were never tried at mirrors, glass and black backs, ", share(self.mirrors()))?;
        write!(f, "{:.0} % because no light faces the point, {:.0} % because cosine or law are 0", share(self.unseen()), share(self.dark()))
    }
}
