//! Where forces take the films before volumes are corrected.
//!
//! # Equation
//! With the metric `W` (masses, or areas over mobility), the factor `κ` (`Δt²`, or `Δt`), the coasting `c` (`u Δt`, or 0)
//! and the forces `F` at the start of the step:
//!
//! * explicit: `W d = W c + κ F`;
//! * implicit: `(W + κ K) d = W c + κ F`, which is tension at the end of the step with the stiffness `K` of its start.
//!
//! Written for the displacement `d`, a film at rest has a right-hand side of zero: rest is the same for both, and exact.

use glam::DVec3;

use super::conjugate_gradient::{ShiftedStiffness, SolveInfo, StopRule, Workspace, solve};
use super::error::FlowError;
use crate::calculus::stiffness::Stiffness;

/// What a prediction starts from, per vertex.
#[derive(Clone, Copy, Debug)]
pub struct Start<'a> {
    /// `W`, kg or kg s.
    pub metric: &'a [f64],
    /// `1/W`, zero for held vertices.
    pub inverse: &'a [f64],
    /// `κ`, s^2 or s.
    pub factor: f64,
    /// `F`, N.
    pub forces: &'a [DVec3],
    /// Velocity that coasts on, m/s; `None` in overdamped motion.
    pub velocities: Option<&'a [DVec3]>,
    /// Length of the step, s.
    pub dt: f64,
}

impl Start<'_> {
    fn coasting(&self, v: usize) -> DVec3 {
        self.velocities.map_or(DVec3::ZERO, |velocities| velocities[v] * self.dt)
    }
}

/// Displacement of free vertices by an explicit step, m. Those of held vertices stay as they come.
pub fn explicit(start: &Start<'_>, displacements: &mut [DVec3]) {
    for (v, d) in displacements.iter_mut().enumerate().filter(|(v, _)| start.inverse[*v] > 0.0) {
        *d = start.coasting(v) + start.forces[v] * (start.factor * start.inverse[v]);
    }
}

/// Displacement of free vertices by an implicit step, m, found from what `displacements` hold. `right` is scratch.
///
/// # Errors
/// [`FlowError::NotConverged`] from the linear solve.
pub fn implicit(
    start: &Start<'_>,
    stiffness: &Stiffness,
    stop: StopRule,
    displacements: &mut [DVec3],
    right: &mut [DVec3],
    work: &mut Workspace,
) -> Result<SolveInfo, FlowError> {
    for (v, b) in right.iter_mut().enumerate() {
        *b = start.coasting(v) * start.metric[v] + start.forces[v] * start.factor;
    }
    let matrix = ShiftedStiffness { diagonal: start.metric, factor: start.factor, stiffness, free: start.inverse };
    solve(&matrix, right, displacements, stop, work)
}
