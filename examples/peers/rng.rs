//! Generators and point sets, timed by the number, on one thread.

use crate::timed;
use fredholm::Error;
use fredholm::sampling::{Halton, Hammersley, LatinHypercube, Pcg, Sampler, Sequence, Sobol, Stratified};

const REPETITIONS: usize = 7;

/// Prints name, numbers, best and median nanoseconds a number, mean.
fn report(name: &str, numbers: u64, sum: impl Fn() -> f64) -> Result<(), Error> {
    let (seconds, sum) = timed(REPETITIONS, || Ok(std::hint::black_box(sum())))?;
    let nanoseconds = |s: f64| s / numbers as f64 * 1e9;
    println!(
        "rng,fredholm {name},{numbers},{:.3},{:.3},{:.6}",
        nanoseconds(seconds[0]),
        nanoseconds(seconds[REPETITIONS / 2]),
        sum / numbers as f64
    );
    Ok(())
}

/// The first coordinates of the first points, point by point.
fn sum<Q: Sequence>(sequence: &Q, points: u64, coordinates: u64) -> f64 {
    let mut sum = 0.0;
    for mut u in sequence.points(0, 0, 0..points) {
        for _ in 0..coordinates {
            sum += u.next_1d();
        }
    }
    sum
}

/// The same coordinates as a block in memory, as other programs give them; their mean is taken outside the clock.
fn block<Q: Sequence>(name: &str, sequence: &Q, points: u64, coordinates: u64) -> Result<(), Error> {
    let mut out = vec![0.0; (points * coordinates) as usize];
    sequence.fill(0, 0, 0..points, &mut out);
    let (sum, out) = (out.iter().sum(), std::cell::RefCell::new(out));
    report(&format!("{name} d={coordinates}, block"), points * coordinates, || {
        sequence.fill(0, 0, 0..points, &mut out.borrow_mut());
        sum
    })
}

pub(crate) fn rng(count: u64) -> Result<(), Error> {
    let mut stream = Pcg::new(7).point(0, 0, 0);
    let numbers = std::cell::RefCell::new(&mut stream);
    report("Pcg f64", count, || {
        let mut u = numbers.borrow_mut();
        (0..count).map(|_| u.next_1d()).sum()
    })?;
    report("Pcg point + 1 f64", count, || sum(&Pcg::new(7), count, 1))?;
    // the sizes of the other programs
    let n = 1 << 16;
    for d in [1u64, 4, 32] {
        block("Sobol scrambled", &Sobol::new(1), n, d)?;
        block("Sobol unscrambled", &Sobol::new(1).unscrambled(), n, d)?;
        report(&format!("Sobol d={d} scrambled, point by point"), n * d, || sum(&Sobol::new(1), n, d))?;
    }
    report("Sobol d=32 scrambled, point by point, 2^20 points", 32 << 20, || sum(&Sobol::new(1), 1 << 20, 32))?;
    let n = n / 8;
    report("Halton d=32 scrambled", n * 32, || sum(&Halton::new(1), n, 32))?;
    report("Halton d=32 unscrambled", n * 32, || sum(&Halton::new(1).unscrambled(), n, 32))?;
    let (hammersley, rooks, jittered) = (Hammersley::new(n)?, LatinHypercube::new(n)?, Stratified::new(90, 2)?);
    report("Hammersley d=32 scrambled", n * 32, || sum(&hammersley, n, 32))?;
    report("Latin hypercube d=32", n * 32, || sum(&rooks, n, 32))?;
    report("jittered pairs d=32", n * 32, || sum(&jittered, n, 32))
}
