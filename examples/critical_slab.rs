//! λ φ(x) = ½ ∫₀ᵃ E₁(|x − y|) φ(y) dy: when does a slab of thickness a sustain a chain reaction? If c = 1/λ neutrons come from every collision.
//!
//! Prints the thickness at which c = 1.5 (plutonium, the benchmark PUa-1-0-SL) is critical, against the published 2 × 0.605055 mean free paths, whose
//! sixth digit is wrong; the c of slabs from thin to thick; and the flux across the last of them.
//!
//! ```text
//! cargo run --release --example critical_slab -- [c] [tolerance]          default 1.5, 1e-10
//! ```

#![allow(clippy::print_stdout)]

use fredholm::Error;
use fredholm::deterministic::{Nystrom, eigenpairs};
use fredholm::transport::{Critical, Slab};

fn main() -> Result<(), Error> {
    let mut arguments = std::env::args().skip(1).map(|a| a.parse::<f64>().unwrap_or(f64::NAN));
    let c = arguments.next().unwrap_or(1.5);
    let tolerance = arguments.next().unwrap_or(1e-10);

    let slab = Critical::at_multiplication(c, tolerance)?;
    println!("c = {c}: critical at 2 × {:.12} ± {:.0e} mean free paths", 0.5 * slab.thickness, 0.5 * slab.error);
    if c == 1.5 {
        println!("         published   2 × 0.605055");
    }

    println!("\n   a        c of the critical slab      unknowns   next eigenvalue/first");
    let mut last = None;
    for a in [0.1, 1.0, 10.0] {
        let critical = Critical::at_thickness(a, tolerance)?;
        let pairs = eigenpairs(&Slab::new(a).scattering(1.0), &Nystrom::adaptive().tolerance(1e-6), 2)?;
        let ratio = pairs[1].value().re / pairs[0].value().re;
        println!("{a:6.1}  {:.12} ± {:.0e}   {:6}     {ratio:.4}", critical.multiplication, critical.error, critical.flux.unknowns());
        last = Some(critical);
    }

    if let Some(critical) = last {
        println!("\nflux across a = {}, its middle 1:", critical.thickness);
        let middle = critical.flux.eval(0.5 * critical.thickness).re;
        for i in 0..=10 {
            let x = critical.thickness * f64::from(i) / 10.0;
            let flux = critical.flux.eval(x).re / middle;
            println!("{x:6.1}  {flux:.10}  {}", "#".repeat((40.0 * flux) as usize));
        }
    }
    Ok(())
}
