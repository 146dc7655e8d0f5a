//! The whole of f from one set of forward walks, by every tally, with bands that hold for all points at once.
//!
//! Equation: φ(x) = e^{−2x} + ½·0.9 ∫₀⁴ E₁(|x − y|) φ(y) dy, first collisions of a beam of cosine ½ that falls on a slab.
//! Answer: adaptive Nyström; each tally's band around its curve, and how far off it is.
//!
//! `cargo run --release --example profile -- [--walks 100000]`
#![allow(clippy::print_stdout)]

use fredholm::deterministic::Nystrom;
use fredholm::statistics::Profile;
use fredholm::transport::Slab;
use fredholm::walk::{Expansion, Histogram, KernelTally, OwnAbsorption, Smoothed};
use fredholm::{Equation, Error, Forward, Walk, plot};

const POINTS: usize = 100;

fn main() -> Result<(), Error> {
    let walks = std::env::args().skip_while(|a| a != "--walks").nth(1).map_or(100_000, |n| n.parse().expect("a whole number"));
    let slab = Slab::new(4.0).scattering(0.9);
    let eq = Equation::new(slab.beam(0.5), &slab);
    let exact = eq.solve(&Nystrom::adaptive().tolerance(1e-9))?;
    let xs: Vec<f64> = (0..POINTS).map(|i| 4.0 * (i as f64 + 0.5) / POINTS as f64).collect();

    // analog flights end by themselves
    let forward = Forward::new().ending(OwnAbsorption).walks(walks).seed(7);
    let legendre = Expansion::legendre(0.0..=4.0, 8, &xs);
    let (missed, all) = legendre.missed(|x| exact.integral_term(x).unwrap_or(f64::NAN));
    let profiles: [(&str, Profile<f64>); 4] = [
        ("kernel tally", eq.solve(&forward.profile(KernelTally::at(&xs)))?),
        ("histogram", eq.solve(&forward.profile(Histogram::new(0.0..=4.0, 40)))?),
        ("smoothed", eq.solve(&forward.profile(Smoothed::at(0.0..=4.0, &xs)))?),
        ("expansion", eq.solve(&forward.profile(legendre))?),
    ];
    println!("{:14}{:>12}{:>14}{:>8}  what it estimates, and its verdict", "", "|error| ≤", "band ± ≤", "inside");
    for (name, f) in &profiles {
        let truth: Vec<f64> = f.points().iter().map(|x| exact.eval(*x)).collect();
        let error = f.values().iter().zip(&truth).map(|(v, t)| (v - t).abs()).fold(0.0, f64::max);
        let band = f.band(0.95).expect("batches");
        let width = band.lower.iter().zip(&band.upper).map(|(l, u)| 0.5 * (u - l)).fold(0.0, f64::max);
        println!("{name:14}{error:12.5}{width:14.5}{:>8}  {}, {}", band.contains(&truth), f.bias(), f.verdict());
        let path = format!("target/plots/profile-{}.png", name.replace(' ', "-"));
        let picture = plot::Profile::new(&format!("A slab in a beam: {name}"), 0.0..=4.0)
            .subtitle(&format!("{walks} walks, strip of 95 % for the whole curve; {}", f.bias()))
            .y_label("φ(x)")
            .curve("Nyström", |x| exact.eval(x));
        picture.band(name, f, 0.95).save(&path)?;
    }
    println!("eight polynomials miss {:.1e} of T φ in the mean square", missed / all);

    // one set of forward walks for all points, or backward walks for each: evaluations of the kernel at equal error
    let tally = &profiles[0].1;
    let backward = eq.on(&xs).solve(&Walk::collision().ending(OwnAbsorption).samples_per_cell(walks / POINTS as u64 + 1))?;
    let each: u64 = backward.iter().map(|e| e.evaluations).sum();
    let variance = |errors: &mut dyn Iterator<Item = f64>| errors.map(|e| e * e).sum::<f64>() / POINTS as f64;
    let ours = variance(&mut tally.std_errors().into_iter().flatten().copied()) * tally.cells()[0].evaluations as f64;
    let theirs = variance(&mut backward.iter().filter_map(|e| e.std_error)) * each as f64;
    let clocks = [tally.cells()[0].elapsed, backward[0].elapsed].map(|t| t.as_secs_f64());
    let seconds = theirs / each as f64 * clocks[1] / (ours / tally.cells()[0].evaluations as f64 * clocks[0]);
    println!(
        "{POINTS} points: the kernel tally is {:.1} × as efficient as backward walks by evaluations, {seconds:.1} × by time",
        theirs / ours
    );
    Ok(())
}
