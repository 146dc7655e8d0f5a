//! What low discrepancy looks like: the first two coordinates of every sequence, and two coordinates far out, where sequences are worst.
//!
//! Equation: none; n points of the unit square, in a grid of √n × √n cells. Answer: random points leave cells empty and crowd in others;
//! jittered points have one in each cell, Latin hypercubes one in each row and column, Sobol' points both and more; Halton's coordinates 30
//! and 31 are useless until they are scrambled.
//!
//! `cargo run --release --example point_sets -- [--points 256]`
#![allow(clippy::print_stdout)]

use fredholm::Error;
use fredholm::plot::Scatter;
use fredholm::sampling::{Halton, Hammersley, LatinHypercube, Pcg, PointSet, Sequence, Sobol, Stratified, VanDerCorput};

fn option(name: &str, default: u64) -> u64 {
    let value = std::env::args().skip_while(|a| a != name).nth(1);
    value.map_or(default, |v| v.parse().unwrap_or_else(|_| panic!("{name} needs a whole number, not {v}")))
}

/// Coordinates `first` and `first` + 1 of n points.
fn pairs(sequence: &impl Sequence, first: usize, n: u64) -> Result<Vec<[f64; 2]>, Error> {
    Ok(PointSet::draw(sequence, first + 2, n)?.iter().map(|x| [x[first], x[first + 1]]).collect())
}

fn main() -> Result<(), Error> {
    let side = (option("--points", 256) as f64).sqrt().round().max(1.0) as u64;
    let n = side * side;
    let sets = [
        ("PCG", pairs(&Pcg::new(1), 0, n)?),
        ("jittered", pairs(&Stratified::new(side, 2)?, 0, n)?),
        ("Latin hypercube", pairs(&LatinHypercube::new(n)?, 0, n)?),
        ("van der Corput, then random", pairs(&VanDerCorput::new(2)?, 0, n)?),
        ("Hammersley", pairs(&Hammersley::new(n)?.unscrambled(), 0, n)?),
        ("Halton", pairs(&Halton::new(1).unscrambled(), 0, n)?),
        ("Sobol'", pairs(&Sobol::new(1).unscrambled(), 0, n)?),
        ("Sobol', scrambled", pairs(&Sobol::new(1), 0, n)?),
        ("Halton, coordinates 30, 31", pairs(&Halton::new(1).unscrambled(), 30, n)?),
        ("the same, scrambled", pairs(&Halton::new(1), 30, n)?),
        ("Sobol', coordinates 30, 31", pairs(&Sobol::new(1).unscrambled(), 30, n)?),
        ("the same, scrambled", pairs(&Sobol::new(1), 30, n)?),
    ];
    let subtitle = format!("{n} points, a grid of {side} × {side}");
    let mut picture = Scatter::new("Point sets").subtitle(&subtitle).grid(side as usize);
    println!("{:30} cells without a point, of {n}   D* of the square", "");
    for (name, points) in sets {
        let mut occupied = vec![false; n as usize];
        for [x, y] in &points {
            occupied[(x * side as f64) as usize * side as usize + (y * side as f64) as usize] = true;
        }
        let empty = occupied.iter().filter(|o| !**o).count();
        println!("{name:30} {empty:8}                      {:.4}", PointSet::new(&points)?.star()?);
        picture = picture.square(name, points);
    }
    picture.save("target/plots/point_sets.svg")?;
    picture.save("target/plots/point_sets.png")?;
    println!("wrote target/plots/point_sets.svg, point_sets.png");
    Ok(())
}
