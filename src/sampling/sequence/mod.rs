//! Sequences whose points are not independent: evener than random points, with errors from independent randomisations.

mod cursor;
mod halton;
mod hammersley;
mod layout;
mod permutation;
mod radical;
mod settings;
mod sobol;
mod stratified;
mod van_der_corput;

pub use cursor::{Coordinates, PointSampler};
pub use halton::{Halton, HaltonPoint};
pub use hammersley::{Hammersley, HammersleyPoint};
pub use layout::Layout;
pub use sobol::{Sobol, SobolPoint};
pub use stratified::{LatinHypercube, Stratified, StratifiedSampler};
pub use van_der_corput::{VanDerCorput, VanDerCorputPoint};
