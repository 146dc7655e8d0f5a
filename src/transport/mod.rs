//! One-dimensional neutral-particle transport: plane-parallel slabs with isotropic scattering.
//!
//! ```text
//! φ(x) = S(x) + (c/2) ∫₀ᵃ E₁(|x − y|) φ(y) dy
//! ```
//!
//! Lengths are in mean free paths. With S the density of isotropic births, φ is the *emission density* S + cΦ; with S = e^{−x/μ₀}, the first
//! collisions of a beam, φ is the *collision density*. In both readings (φ − S)/c = ½ ∫ E₁ φ is the scalar flux Φ of particles that were emitted
//! isotropically, and ½ ∫ E₂(x) φ(x) dx leaves through the face x = 0.
//!
//! | item | what it is |
//! |---|---|
//! | [`Slab`] | the kernel; walked by analog free flights: E₁'s logarithmic singularity is sampled exactly |
//! | [`ImplicitCapture`] | the same kernel, walked without capture, weight c a step |
//! | [`UniformSource`], [`BeamSource`] | sources with exact sampling; [`Slab::source`] takes a closure |
//! | [`Critical`] | the c or the thickness at which a slab is critical, with its flux |
//! | [`Histories`] | forward analog histories with [`CollisionTally`], [`TrackTally`] (flux of every bin, as a curve with its band) and [`SurfaceTally`] (currents at every edge) |
//!
//! The module uses the core and adds nothing to it: a slab is a kernel.
//!
//! ```
//! use fredholm::{transport::Slab, Equation, Walk};
//! let slab = Slab::new(10.0).scattering(0.9);
//! let eq = Equation::new(slab.uniform(1.0), &slab);
//! let middle = eq.at(5.0).solve(&Walk::mis())?;
//! assert!(middle.agrees_with(9.135_261_726_293_38, 5.0));
//! # Ok::<(), fredholm::Error>(())
//! ```

mod critical;
mod histories;
mod implicit;
mod slab;
mod source;
mod surface;
mod tally;

pub use critical::Critical;
pub use histories::{Fate, Histories, Outcome};
pub use implicit::ImplicitCapture;
pub use slab::Slab;
pub use source::{BeamSource, UniformSource};
pub use surface::{Currents, SurfaceTally};
pub use tally::{CollisionTally, Flight, Flux, Grid, Tally, TrackTally};
