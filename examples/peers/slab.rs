//! Analog histories in a slab, with flux tallies.

use crate::timed;
use fredholm::Error;
use fredholm::transport::{CollisionTally, Flux, Histories, Outcome, Slab, Tally, TrackTally};

fn slab_line<T: Tally>(
    name: &str,
    tally: T,
    sizes: (u64, usize, usize),
    flux: impl Fn(&T::Flux) -> [Option<&Flux>; 2],
) -> Result<(), Error> {
    let (histories, repetitions, threads) = sizes;
    let slab = Slab::new(10.0).scattering(0.9);
    let source = slab.uniform(1.0);
    let method = Histories::new(tally).bins(100).batches(50).histories(histories);
    let (seconds, run): (_, Outcome<T::Flux>) = timed(repetitions, || method.run(&slab, &source))?;
    let (best, median) = (seconds[0], seconds[repetitions / 2]);
    let n = run.histories as f64;
    let merit = |flux: Option<&Flux>| {
        let rv = flux.and_then(Flux::relative_variance).unwrap_or(f64::NAN);
        format!("rv {rv:.3e} FOM {:.4e}", 1.0 / (rv * median))
    };
    let [collision, track] = flux(&run.flux).map(merit);
    println!(
        "slab,fredholm,{name},{threads},{},{best:.6e},{median:.6e},{:.4e},{:.4e},{:.2},{},col {collision},trk {track}",
        run.histories,
        n / best,
        n / median,
        best / run.collisions as f64 * 1e9,
        run.collisions
    );
    Ok(())
}

pub(crate) fn slab(histories: u64, repetitions: usize, threads: usize) -> Result<(), Error> {
    let sizes = (histories, repetitions, threads);
    slab_line("collision", CollisionTally, sizes, |f| [Some(f), None])?;
    slab_line("track", TrackTally, sizes, |f| [None, Some(f)])?;
    slab_line("both", (CollisionTally, TrackTally), sizes, |(c, t)| [Some(c), Some(t)])
}
