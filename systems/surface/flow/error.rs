//! Why a step of the flow was not taken.

use crate::rows::Region;

/// Why a step of the flow was not taken. The state is as it was before.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FlowError {
    /// A list does not have one entry per row.
    #[error("{what} has {found} entries, the mesh has {expected} rows")]
    WrongLength {
        /// Which list.
        what: &'static str,
        /// Rows of the mesh.
        expected: usize,
        /// Entries found.
        found: usize,
    },
    /// A closed region without a target volume.
    #[error("{region} is closed and has no target volume: adopt regions after the mesh has changed, or mark it open")]
    NoTarget {
        /// The region.
        region: Region,
    },
    /// A region whose volume no free vertex can change, or a set of regions that depend on each other.
    #[error("the volume of {region} cannot be set: its pivot is {pivot:.1e} of its diagonal; is it held on all sides?")]
    SingularPressure {
        /// The region whose row has no pivot.
        region: Region,
        /// Pivot over diagonal, dimensionless.
        pivot: f64,
    },
    /// The volume projection did not get there.
    #[error("{region} misses its volume by {error:.2e} of it after {iterations} iterations: take a shorter step")]
    VolumeNotReached {
        /// The region that is farthest off.
        region: Region,
        /// Relative error of its volume.
        error: f64,
        /// Iterations done.
        iterations: u32,
    },
    /// The linear solve of the implicit scheme did not converge.
    #[error("no convergence after {iterations} iterations: residual {residual:.2e}, {tolerance:.2e} wanted")]
    NotConverged {
        /// Iterations done.
        iterations: u32,
        /// Residual over right-hand side, dimensionless.
        residual: f64,
        /// What was wanted.
        tolerance: f64,
    },
    /// The step needs too many explicit substeps.
    #[error(
        "a step of {dt:.2e} s needs {substeps:.0} explicit substeps, at most {most} are allowed: use the implicit scheme"
    )]
    TooManySubsteps {
        /// Length of the step, s.
        dt: f64,
        /// Substeps needed.
        substeps: f64,
        /// Substeps allowed.
        most: u32,
    },
}
