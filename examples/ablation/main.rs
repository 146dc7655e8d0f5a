//! What is skipped, and what it would cost: each scene beside the same with one thing in it that changes nothing, or little.
//!
//! Equation: L = Lₑ + T L over a surface under a lamp. Either the shadow rays that are spared are cast all the same; or out of sight lie, one at a time, a
//! second light, triangles enough for a tree, a texture and a mask of ones.
//!
//! `cargo run --release --example ablation -- [--samples 256]`: a line of CSV each, medians of alternate runs, and what was counted.
#![allow(clippy::print_stdout)]

mod careless;
mod scenes;

use fredholm::scene::{Film, Scene};
use fredholm::{Error, Walk, walk::Mis};
use scenes::{LAMP, built, pairs};
use std::time::Instant;

/// Seconds of a run.
fn time((scene, film): &(Scene, Film), wasteful: bool, walk: &Walk<Mis>) -> Result<f64, Error> {
    let (equation, clock) = (careless::equation(&scene.light_transport(), scene, wasteful), Instant::now());
    equation.seen_by(film).solve(walk)?;
    Ok(clock.elapsed().as_secs_f64())
}

fn main() -> Result<(), Error> {
    sigpipe::reset();
    let mut arguments = std::env::args().skip_while(|a| a != "--samples");
    let walk = Walk::mis().samples_per_cell(arguments.nth(1).and_then(|a| a.parse().ok()).unwrap_or(256));
    println!("skipped,s without,s with,ratio,rays,shadow rays,blocked,never tried,faced away,dark");
    for (name, without, with) in pairs() {
        let target = if name.ends_with("away") { LAMP + 1.0 } else { 0.0 };
        let (a, b) = (built(without, target)?, built(with.unwrap_or(without), target)?);
        let (mut before, mut after) = ([0.0; 7], [0.0; 7]);
        for run in 0..7 {
            (before[run], after[run]) = (time(&a, false, &walk)?, time(&b, with.is_none(), &walk)?);
        }
        before.sort_by(f64::total_cmp);
        after.sort_by(f64::total_cmp);
        let (equation, c) = a.0.counted();
        careless::equation(&equation, &a.0, false).seen_by(&a.1).solve(&walk)?;
        let counted = [c.rays(), c.shadow_rays(), c.blocked(), c.mirrors(), c.unseen(), c.dark()].map(|n| n.to_string()).join(",");
        println!("{name},{:.4},{:.4},{:.3},{counted}", before[3], after[3], after[3] / before[3]);
    }
    Ok(())
}
