//! A slab that scatters isotropically, by every estimator and by Nyström:
//!
//! ```text
//! φ(x) = S(x) + (c/2) ∫₀ᵃ E₁(|x − y|) φ(y) dy        c = 0.9, a = 10, S = 1:  φ(5) = 9.135261726293376
//! ```
//!
//! `cargo run --release --example slab [-- --c 0.9 --a 10 --source uniform|ramp|beam:0.5 --samples N --seed S --plots FOLDER]`
//!
//! E₁ is infinite at y = x. Walks sample that singularity exactly by flying as particles do; Nyström integrates it on graded panels.

#![allow(clippy::print_stdout, clippy::print_stderr)]

mod methods;
mod options;
mod pictures;
mod report;
mod source;
mod truth;

use fredholm::kernel::Operator;
use fredholm::source::Source;
use fredholm::transport::{CollisionTally, Histories, Slab, TrackTally};
use fredholm::{Error, Estimate};
use options::Options;
use source::AnySource;
use std::process::ExitCode;
use truth::Truth;

/// One method's answer.
struct Row {
    name: String,
    answer: Result<Vec<Estimate>, Error>,
}

fn run(options: &Options, slab: &Slab) -> Result<(), Error> {
    let source = AnySource::new(options.source, slab);
    slab.validate()?;
    source.validate()?;
    let xs = options.points();
    report::heading(options);
    let truth = Truth::new(options, slab, source, &xs)?;
    report::nystrom(&truth, &xs);

    let methods = methods::all(slab, source, options.seed)?;
    let samples = options.samples.unwrap_or_else(|| methods::affordable(slab, &truth));
    if let Err(refusal @ Error::Divergent { .. }) = (methods[0].solve)(&xs, 1) {
        println!("walks refused: {refusal}");
        return Ok(());
    }
    report::table_head(&xs, samples);
    let mut rows = Vec::new();
    for method in &methods {
        let row = Row { name: method.name.clone(), answer: (method.solve)(&xs, samples) };
        report::row(&row, &truth.values);
        rows.push(row);
    }
    report::legend(&rows);

    let histories = Histories::new((CollisionTally, TrackTally)).bins(20).histories(8 * samples).seed(options.seed);
    report::forward(&truth, histories.run(slab, &source));

    pictures::draw(options, &truth, &rows, &methods, samples)
}

fn main() -> ExitCode {
    sigpipe::reset();
    let result = Options::parse(std::env::args().skip(1)).and_then(|options| {
        let slab = Slab::new(options.thickness).scattering(options.ratio);
        run(&options, &slab).map_err(|e| e.to_string())
    });
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("slab: {message}");
            ExitCode::FAILURE
        }
    }
}
