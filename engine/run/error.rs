//! Why a run cannot begin, go on or be resumed.

use std::error::Error;
use std::io;
use std::path::PathBuf;

use thiserror::Error;

use crate::checkpoint::CheckpointError;
use crate::simulation::{BuildError, StepError};

/// Why a frame cannot be drawn or written: the typed error of whoever draws it.
pub type FrameError = Box<dyn Error + Send + Sync>;

/// Why a run cannot begin, go on or be resumed. What was written before stays.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum RunError {
    /// The run folder cannot be made.
    #[error("the run folder `{}` cannot be made: {cause}", path.display())]
    Folder {
        /// The folder.
        path: PathBuf,
        /// Why.
        #[source]
        cause: io::Error,
    },

    /// The folder has files that a run would overwrite.
    #[error("`{}` is not empty: a run never overwrites; name another folder, or resume this one", path.display())]
    Occupied {
        /// The folder.
        path: PathBuf,
    },

    /// Another process runs in the folder.
    #[error("another process is running in `{}`", path.display())]
    InUse {
        /// The folder.
        path: PathBuf,
    },

    /// There is no run in the folder.
    #[error("`{}` is not a run folder: `{}` cannot be read ({cause})", path.display(), file)]
    NotARun {
        /// The folder.
        path: PathBuf,
        /// The file that should be there.
        file: &'static str,
        /// Why.
        #[source]
        cause: io::Error,
    },

    /// The simulation cannot be built from the folder.
    #[error(transparent)]
    Build(#[from] BuildError),

    /// A file of the run folder cannot be written.
    #[error("`{}` cannot be written: {cause}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// Why.
        #[source]
        cause: io::Error,
    },

    /// A frame is lost.
    #[error("frame {frame} (t = {time:.6} s) is lost: {cause}; frames before it are whole")]
    Frame {
        /// Number of the frame.
        frame: u64,
        /// Its time, s.
        time: f64,
        /// Why.
        #[source]
        cause: FrameError,
    },

    /// What is made of all frames, at the end.
    #[error("the run is done, but what is made of all frames is lost: {cause}")]
    Finish {
        /// Why.
        #[source]
        cause: FrameError,
    },

    /// A step could not be finished.
    #[error("{cause}; {}", last(checkpoint.as_ref()))]
    Step {
        /// What went wrong.
        #[source]
        cause: StepError,
        /// The last good checkpoint.
        checkpoint: Option<PathBuf>,
    },

    /// The checkpoint that ends the run cannot be written.
    #[error(transparent)]
    Checkpoint(#[from] CheckpointError),
}

fn last(checkpoint: Option<&PathBuf>) -> String {
    match checkpoint {
        Some(path) => format!("the last good checkpoint is `{}`", path.display()),
        None => "there is no checkpoint yet".to_owned(),
    }
}
