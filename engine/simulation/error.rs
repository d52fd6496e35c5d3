//! Why a simulation cannot be built, and why a step cannot be finished.

use std::fmt::Write;

use froth_systems::observe::Fault;
use froth_systems::rows::registry::SplitKind;
use thiserror::Error;

use crate::checkpoint::CheckpointError;
use crate::method::DiscretiseError;
use crate::scene::SceneError;

/// Why a simulation cannot be built.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum BuildError {
    /// The scene is at fault.
    #[error(transparent)]
    Scene(#[from] SceneError),

    /// The method is known, but no code runs it.
    #[error("the method `{method}` cannot run in this version; these can: {}", available.join(", "))]
    MethodNotAvailable {
        /// Name on the command line.
        method: &'static str,
        /// Those that can run.
        available: Vec<&'static str>,
    },

    /// A factor that is no factor.
    #[error("the resolution factor is {factor}; it must be a positive number, e.g. 0.5 for twice the spacing")]
    ResolutionFactor {
        /// As it was given.
        factor: f64,
    },

    /// The method cannot turn the scene into particles.
    #[error("the films cannot be turned into particles: {0}")]
    Discretise(#[source] DiscretiseError),

    /// The checkpoint cannot be read, or is of another run.
    #[error(transparent)]
    Checkpoint(#[from] CheckpointError),
}

/// Why a step cannot be finished. The simulation stays readable; it does not step again.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum StepError {
    /// A system reported faults.
    #[error("step {step} from t = {time:.9} s (length {step_length:.3e} s) stopped in {}", list(faults))]
    Fault {
        /// What was reported, in order; at least one.
        faults: Vec<Fault>,
        /// Number of the step.
        step: u64,
        /// Time at its start, s.
        time: f64,
        /// Its length, s; that of the step before where the fault is in the choice of the length.
        step_length: f64,
    },

    /// A component was inserted by hand on some particles only.
    #[error(transparent)]
    Split(#[from] SplitKind),
}

/// Faults as a person reads them; a broken step may break in a thousand places.
fn list(faults: &[Fault]) -> String {
    const SHOWN: usize = 3;
    let mut list = faults.iter().take(SHOWN).map(Fault::to_string).collect::<Vec<_>>().join("; ");
    if faults.len() > SHOWN {
        let _ = write!(list, "; and {} more", faults.len() - SHOWN);
    }
    list
}
