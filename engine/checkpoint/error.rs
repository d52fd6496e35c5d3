//! Why a checkpoint cannot be written or read.

use std::io;
use std::path::PathBuf;

use thiserror::Error;

/// Why a checkpoint cannot be written or read.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum CheckpointError {
    /// The file cannot be written.
    #[error("the checkpoint `{}` cannot be written: {cause}", path.display())]
    Unwritable {
        /// The file.
        path: PathBuf,
        /// Why.
        #[source]
        cause: io::Error,
    },

    /// A resource cannot be written as text.
    #[error("the state `{name}` cannot be saved: {message}")]
    Unsayable {
        /// Name of the resource.
        name: &'static str,
        /// Why.
        message: String,
    },

    /// The file cannot be read.
    #[error("the checkpoint `{}` cannot be read: {cause}", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// Why.
        #[source]
        cause: io::Error,
    },

    /// Some other file.
    #[error("`{}` is not a checkpoint of froth", path.display())]
    NotACheckpoint {
        /// The file.
        path: PathBuf,
    },

    /// A layout that this version does not know.
    #[error("`{}` has checkpoint format {found}; this version reads format {known}", path.display())]
    Format {
        /// The file.
        path: PathBuf,
        /// Version in the file.
        found: u32,
        /// Version of this engine.
        known: u32,
    },

    /// The end is missing.
    #[error("`{}` is truncated after {bytes} bytes", path.display())]
    Truncated {
        /// The file.
        path: PathBuf,
        /// Its length.
        bytes: u64,
    },

    /// The checksum does not fit.
    #[error("`{}` is damaged: its checksum is {found:016x}, written was {expected:016x}", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// Checksum in the file.
        expected: u64,
        /// Checksum of the file.
        found: u64,
    },

    /// Written by another version, whose steps may differ.
    #[error("`{}` was written by froth {found}, this is {this}: resume it with that version, or begin anew", path.display())]
    OtherEngine {
        /// The file.
        path: PathBuf,
        /// Version that wrote it.
        found: String,
        /// This version.
        this: &'static str,
    },

    /// Of another scene, or of the same with other overrides.
    #[error("`{}` is of another scene or other overrides (its hash is {found}, wanted is {wanted})", path.display())]
    OtherScene {
        /// The file.
        path: PathBuf,
        /// Hash in the file.
        found: String,
        /// Hash of the present scene and overrides.
        wanted: String,
    },

    /// Of a simulation with other columns or state: components that were plugged in are missing, or new.
    #[error("`{}` does not fit this simulation: {}", path.display(), difference(missing, unknown))]
    OtherContent {
        /// The file.
        path: PathBuf,
        /// What the simulation has and the file lacks.
        missing: Vec<String>,
        /// What the file has and the simulation lacks.
        unknown: Vec<String>,
    },

    /// A resource cannot be read from its text.
    #[error("the state `{name}` in `{}` cannot be read: {message}", path.display())]
    State {
        /// The file.
        path: PathBuf,
        /// Name of the resource.
        name: String,
        /// Why.
        message: String,
    },
}

impl CheckpointError {
    /// Whether the file itself is broken, so that an older checkpoint may do.
    #[must_use]
    pub fn is_damage(&self) -> bool {
        matches!(
            self,
            Self::Unreadable { .. } | Self::NotACheckpoint { .. } | Self::Truncated { .. } | Self::Damaged { .. }
        )
    }
}

fn difference(missing: &[String], unknown: &[String]) -> String {
    let list = |what: &str, names: &[String]| match names {
        [] => None,
        names => Some(format!("{what} {}", names.join(", "))),
    };
    [list("it lacks", missing), list("nobody registered", unknown)].into_iter().flatten().collect::<Vec<_>>().join("; ")
}
