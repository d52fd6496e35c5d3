//! What went wrong, on standard error: with the piece of the scene and a caret on a terminal, in one line otherwise.

use std::io::{self, IsTerminal};
use std::path::PathBuf;

use miette::{Diagnostic, GraphicalReportHandler};
use thiserror::Error;

use super::{FAILED, WRONG_USAGE};
use crate::bench::BenchError;
use crate::frames::PictureFramesError;
use crate::run::RunError;
use crate::scene::SceneError;
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
    #[error("there is no error code `{0}`; codes look like F0020")]
    NoSuchCode(String),
    #[error("there is no law `{0}`{hint}; `froth verify --list` lists them", hint = .1.map(|name| format!(", did you mean `{name}`?")).unwrap_or_default())]
    NoSuchLaw(String, Option<&'static str>),
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
            Self::NoSuchCode(_)
            | Self::NoSuchLaw(..)
            | Self::Pictures(_)
            | Self::Run(RunError::Occupied { .. } | RunError::NotARun { .. }) => WRONG_USAGE,
            _ => FAILED,
        }
    }
}

/// Shows a failure.
pub(super) fn show(failure: &Failure) {
    match failure.build_error() {
        Some(BuildError::Scene(error)) if io::stderr().is_terminal() => eprint!("{}", drawn(error)),
        Some(BuildError::Scene(error)) => eprintln!("{}", in_lines(error)),
        _ => eprintln!("error: {failure}"),
    }
}

/// With the piece of the scene.
fn drawn(error: &SceneError) -> String {
    let mut text = String::new();
    match GraphicalReportHandler::new().render_report(&mut text, error) {
        Ok(()) => text,
        Err(_) => in_lines(error),
    }
}

/// `file:line:column: error[F0020]: message`, and the help.
fn in_lines(error: &SceneError) -> String {
    let place = error.place().map(|place| format!("{}:{}:{}: ", place.file, place.line, place.column));
    let help = error.help().map(|help| format!("\n  help: {help}"));
    let (place, help) = (place.unwrap_or_default(), help.unwrap_or_default());
    format!("{place}error[{}]: {error}{help}", error.stable_code())
}
