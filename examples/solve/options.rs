//! The command line.

use std::path::PathBuf;

pub(crate) const USAGE: &str =
    "usage: solve FILE|FOLDER… [--walks METHOD…] [--deterministic METHOD…] [--tolerance ε] [--samples N] [--seed S]
             [--all-points] [--csv OUT] [--plot OUT.svg]
  walks:         collision roulette fixed-depth subcritical absorption next-event mis mis-power mis-maximum mis-average all none
  deterministic: nystrom composite graded adaptive galerkin collocation all none";

/// A random-walk method.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum WalkMethod {
    Collision,
    Roulette,
    FixedDepth,
    Subcritical,
    Absorption,
    NextEvent,
    Mis,
    MisPower,
    MisMaximum,
    MisAverage,
}

/// All of them, with their names.
pub(crate) const WALKS: [(&str, WalkMethod); 10] = [
    ("collision", WalkMethod::Collision),
    ("roulette", WalkMethod::Roulette),
    ("fixed-depth", WalkMethod::FixedDepth),
    ("subcritical", WalkMethod::Subcritical),
    ("absorption", WalkMethod::Absorption),
    ("next-event", WalkMethod::NextEvent),
    ("mis", WalkMethod::Mis),
    ("mis-power", WalkMethod::MisPower),
    ("mis-maximum", WalkMethod::MisMaximum),
    ("mis-average", WalkMethod::MisAverage),
];

/// A deterministic method.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum DeterministicMethod {
    Nystrom,
    Composite,
    Graded,
    Adaptive,
    Galerkin,
    Collocation,
}

/// All of them, with their names.
pub(crate) const DETERMINISTIC: [(&str, DeterministicMethod); 6] = [
    ("nystrom", DeterministicMethod::Nystrom),
    ("composite", DeterministicMethod::Composite),
    ("graded", DeterministicMethod::Graded),
    ("adaptive", DeterministicMethod::Adaptive),
    ("galerkin", DeterministicMethod::Galerkin),
    ("collocation", DeterministicMethod::Collocation),
];

/// What to do.
#[derive(Debug)]
pub(crate) struct Options {
    pub paths: Vec<PathBuf>,
    pub walks: Vec<(&'static str, WalkMethod)>,
    pub deterministic: Vec<(&'static str, DeterministicMethod)>,
    pub tolerance: f64,
    /// None: as many as suits the length of the walks
    pub samples: Option<u64>,
    pub seed: u64,
    pub all_points: bool,
    pub csv: Option<PathBuf>,
    pub plot: Option<PathBuf>,
}

impl Options {
    pub(crate) fn parse(arguments: impl Iterator<Item = String>) -> Result<Self, String> {
        let mut options = Options {
            paths: Vec::new(),
            walks: Vec::new(),
            deterministic: Vec::new(),
            tolerance: 1e-8,
            samples: None,
            seed: 0,
            all_points: false,
            csv: None,
            plot: None,
        };
        let (mut walks, mut deterministic) = (None, None);
        let mut arguments = arguments.peekable();
        while let Some(argument) = arguments.next() {
            let Some(option) = argument.strip_prefix("--") else {
                options.paths.push(argument.into());
                continue;
            };
            let mut values = Vec::new();
            let single = !matches!(option, "walks" | "deterministic" | "all-points");
            while let Some(value) = arguments.next_if(|a| !a.starts_with("--") && option != "all-points" && (!single || values.is_empty()))
            {
                values.extend(value.split(',').map(String::from));
            }
            let value = || values.first().cloned().ok_or_else(|| format!("--{option} needs a value"));
            match option {
                "walks" => walks = Some(choose(&values, &WALKS, option, &mut options.paths)?),
                "deterministic" => deterministic = Some(choose(&values, &DETERMINISTIC, option, &mut options.paths)?),
                "tolerance" => options.tolerance = positive(&value()?, option)?,
                "samples" => options.samples = Some(positive(&value()?, option)?.ceil() as u64),
                "seed" => options.seed = value()?.parse().map_err(|_| format!("--seed {} is no whole number", values[0]))?,
                "all-points" => options.all_points = true,
                "csv" => options.csv = Some(value()?.into()),
                "plot" => options.plot = Some(value()?.into()),
                _ => return Err(format!("unknown option --{option}")),
            }
        }
        if options.paths.is_empty() {
            return Err("no file or folder given".into());
        }
        let both = walks.is_none() && deterministic.is_none();
        options.walks = walks.unwrap_or_else(|| if both { pick(&WALKS, &["collision", "next-event", "mis"]) } else { Vec::new() });
        options.deterministic =
            deterministic.unwrap_or_else(|| if both { pick(&DETERMINISTIC, &["composite", "adaptive"]) } else { Vec::new() });
        Ok(options)
    }
}

fn pick<M: Copy>(list: &[(&'static str, M)], names: &[&str]) -> Vec<(&'static str, M)> {
    list.iter().copied().filter(|(n, _)| names.contains(n)).collect()
}

/// The methods named; what exists as a path is a file, so that methods may stand before files.
fn choose<M: Copy>(
    names: &[String],
    list: &[(&'static str, M)],
    option: &str,
    paths: &mut Vec<PathBuf>,
) -> Result<Vec<(&'static str, M)>, String> {
    let mut chosen = Vec::new();
    for name in names {
        match list.iter().find(|(n, _)| n == name) {
            Some(method) => chosen.push(*method),
            None if name == "all" => chosen.extend(list),
            None if name == "none" => {}
            None if std::path::Path::new(name).exists() => paths.push(name.into()),
            None => return Err(format!("--{option} {name}: unknown method")),
        }
    }
    if names.is_empty() {
        return Err(format!("--{option} needs at least one method"));
    }
    Ok(chosen)
}

fn positive(text: &str, option: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(v) if v > 0.0 && v.is_finite() => Ok(v),
        _ => Err(format!("--{option} {text} is no positive number")),
    }
}
