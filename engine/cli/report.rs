//! What went wrong, on standard error: with the piece of the scene and a caret, in colours on a terminal.

use std::io::{self, IsTerminal};
use std::path::PathBuf;

use miette::{GraphicalReportHandler, GraphicalTheme};
use thiserror::Error;

use super::{FAILED, WRONG_USAGE};
use crate::bench::BenchError;
use crate::frames::PictureFramesError;
use crate::run::RunError;
use crate::scene::{MOST_FRAMES, SceneError};
use crate::simulation::{BuildError, StepError};

/// Why a command fails.
#[derive(Debug, Error)]
pub(super) enum Failure {
    #[error(transparent)]
    Build(#[from] BuildError),
    #[error(transparent)]
    Run(#[from] RunError),
    #[error(transparent)]
    Pictures(PictureFramesError),
    #[error("there is no error code `{0}`; there are: {1}")]
    NoSuchCode(String, String),
    #[error("there is no law `{0}`{hint}; `froth verify --list` lists them", hint = .1.map(|name| format!(", did you mean `{name}`?")).unwrap_or_default())]
    NoSuchLaw(String, Option<&'static str>),
    #[error(
        "`--until` would make about {frames:.1e} frames; more than {MOST_FRAMES} are refused: name an earlier time"
    )]
    TooManyFrames { frames: f64 },
    #[error("{0} threads cannot be started: {1}")]
    Threads(usize, rayon::ThreadPoolBuildError),
    #[error(transparent)]
    Step(#[from] StepError),
    #[error("{path} cannot be written: {error}", path = .0.display(), error = .1)]
    Csv(PathBuf, io::Error),
    #[error("signals cannot be caught: {0}")]
    Signals(io::Error),
}

impl From<SceneError> for Failure {
    fn from(error: SceneError) -> Self {
        Self::Build(error.into())
    }
}

impl From<BenchError> for Failure {
    fn from(error: BenchError) -> Self {
        match error {
            BenchError::Build(error) => Self::Build(error),
            BenchError::Step(error) => Self::Step(error),
        }
    }
}

impl From<PictureFramesError> for Failure {
    fn from(error: PictureFramesError) -> Self {
        match error {
            PictureFramesError::Scene(error) => (*error).into(),
            other => Self::Pictures(other),
        }
    }
}

impl Failure {
    fn build_error(&self) -> Option<&BuildError> {
        match self {
            Self::Build(error) | Self::Run(RunError::Build(error)) => Some(error),
            _ => None,
        }
    }

    pub(super) fn exit_code(&self) -> u8 {
        use BuildError as B;
        match self.build_error() {
            Some(B::Scene(_) | B::MethodNotAvailable { .. } | B::ResolutionFactor { .. }) => return WRONG_USAGE,
            Some(_) => return FAILED,
            None => {}
        }
        match self {
            Self::NoSuchCode(..)
            | Self::NoSuchLaw(..)
            | Self::TooManyFrames { .. }
            | Self::Pictures(_)
            | Self::Run(RunError::Occupied { .. } | RunError::NotARun { .. }) => WRONG_USAGE,
            _ => FAILED,
        }
    }
}

/// Shows a failure.
pub(super) fn show(failure: &Failure) {
    match failure.build_error() {
        Some(BuildError::Scene(error)) => eprint!("{}", drawn(error, io::stderr().is_terminal())),
        _ => eprintln!("error: {failure}"),
    }
}

/// Message, piece of the scene, and help. Without a terminal the place and the code come first, in one line that programs find.
fn drawn(error: &SceneError, on_terminal: bool) -> String {
    let theme = if on_terminal { GraphicalTheme::default() } else { GraphicalTheme::unicode_nocolor() };
    let mut handler = GraphicalReportHandler::new_themed(theme);
    if !on_terminal {
        handler = handler.with_width(PLAIN_WIDTH).with_links(false);
    }
    let mut drawn = String::new();
    if handler.render_report(&mut drawn, error).is_ok() && on_terminal {
        return drawn;
    }
    let place = error.place().map(|place| format!("{}:{}:{}: ", place.file, place.line, place.column));
    let message = format!("{}error[{}]: {error}", place.unwrap_or_default(), error.stable_code());
    // Code and message stand in the first line already.
    let is_more = |line: &str| ["╭", "├", "╰", "help:"].iter().any(|start| line.trim_start().starts_with(start));
    let more = drawn.lines().skip_while(|line| !is_more(line));
    [message.as_str()].into_iter().chain(more).fold(String::new(), |text, line| text + line + "\n")
}

/// Columns where there is no terminal.
const PLAIN_WIDTH: usize = 120;
