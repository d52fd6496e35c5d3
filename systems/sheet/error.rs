//! What can go wrong in a step of a sheet.

use froth_biot_savart::PairSumError;
use froth_surface::flow::FlowError;
use thiserror::Error;

/// Why a step could not be taken.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum SheetError {
    /// The pair sum refused its input.
    #[error(transparent)]
    Pairs(#[from] PairSumError),
    /// Volumes could not be met.
    #[error(transparent)]
    Volumes(#[from] FlowError),
    /// The circulation on the wires was not found.
    #[error(
        "the circulation on the wires was not found in {iterations} iterations (residual {residual:.1e}): do two wires cross, or hold the same film twice?"
    )]
    WireNotSolved {
        /// Iterations done.
        iterations: u32,
        /// Residual over right-hand side, dimensionless.
        residual: f64,
    },
    /// The diffusion of the potentials was not solved.
    #[error(
        "the diffusion of the potentials was not solved in {iterations} iterations (residual {residual:.1e}): the mesh has broken down, or `diffusivity` is out of all proportion"
    )]
    DampingNotSolved {
        /// Iterations done.
        iterations: u32,
        /// Residual over potentials, dimensionless.
        residual: f64,
    },
    /// The implicit midpoint rule found no midpoint.
    #[error(
        "no midpoint was found in {passes} evaluations of a step of {dt:.3e} s (last change {change:.1e} of the motion): take shorter substeps (`courant`)"
    )]
    MidpointNotFound {
        /// Length of the step, s.
        dt: f64,
        /// Evaluations done.
        passes: u32,
        /// Last change over the motion, dimensionless.
        change: f64,
    },
}
