//! The command line.

use std::path::PathBuf;

pub(crate) const USAGE: &str = "usage: study [--small] [--out DIR] [--peers FILE]… [--problem NAME|FILE.json]… [--no-scenes]
  --small     few sizes and repetitions: seconds instead of minutes
  --peers     lines `peer;problem;N;threads;best s;median s;error;note` of other programs, or tables of images, laid over the plots
  --problem   only these: names of built-in problems and scenes, or equations as text on a line; where a file tells no value of f, a tight adaptive
              solve does";

/// What to study, and how long.
#[derive(Debug)]
pub(crate) struct Options {
    pub out: PathBuf,
    pub peers: Vec<PathBuf>,
    pub problems: Vec<String>,
    pub scenes: Scenes,
    pub effort: Effort,
}

/// Whether images are part of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Scenes {
    With,
    Without,
}

/// Sizes of the sweeps.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Effort {
    /// Repetitions with seeds of their own behind every root mean square.
    pub seeds: u64,
    /// Most walks of one repetition.
    pub walks: u64,
    /// A sweep ends after the first size whose repetitions took so long together.
    pub seconds: f64,
    /// Most unknowns of rules that are not adaptive.
    pub unknowns: usize,
    /// Walks a pixel.
    pub pixel: u64,
}

const FULL: Effort = Effort { seeds: 16, walks: 1 << 18, seconds: 0.5, unknowns: 512, pixel: 64 };
const SMALL: Effort = Effort { seeds: 4, walks: 1 << 10, seconds: 0.02, unknowns: 32, pixel: 4 };

impl Options {
    pub(crate) fn parse(arguments: impl Iterator<Item = String>) -> Result<Self, String> {
        let mut options =
            Options { out: "target/study".into(), peers: Vec::new(), problems: Vec::new(), scenes: Scenes::With, effort: FULL };
        let mut arguments = arguments.peekable();
        while let Some(argument) = arguments.next() {
            let mut value = || arguments.next().ok_or_else(|| format!("{argument} needs a value\n{USAGE}"));
            match argument.as_str() {
                "--small" => options.effort = SMALL,
                "--out" => options.out = value()?.into(),
                "--peers" => options.peers.push(value()?.into()),
                "--problem" => options.problems.push(value()?),
                "--no-scenes" => options.scenes = Scenes::Without,
                _ => return Err(format!("unknown option {argument}\n{USAGE}")),
            }
        }
        Ok(options)
    }
}
