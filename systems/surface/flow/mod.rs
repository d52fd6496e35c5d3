//! The geometric flow: films move by tension, mass or friction, and the gas in every closed region keeps its volume.
//!
//! One step, as a table of contents ([`Flow::propose`]):
//!
//! 1. [`forces`]: tension, external forces, and the pressures of the step before; [`rigid`]: momentum is given back
//!    where tangential forces are removed;
//! 2. [`prediction`]: where they take the films, explicitly or by a linear solve ([`conjugate_gradient`]);
//! 3. [`projection`]: the pressures that bring every volume to its target ([`pressure_system`]);
//! 4. the tracker moves the mesh as far as is safe, and [`Flow::finish`] takes velocities from what was achieved.
//!
//! [`settings`] and [`forcing`] are the knobs; [`state`] is what lives on between steps; [`stable_step`] bounds explicit
//! steps, [`shape_keeping`] all steps by what the mesh can take before it has to be mended.
//!
//! # Equation
//! Inertial motion: `m ẍ = -∂E/∂x + m g + Σ_i p_i ∂V_i/∂x` with `E = Σ_f T_f A_f`. Overdamped motion: velocity = mobility x
//! force per area, with the same forces. In both, pressures are what keeps `V_i` at its target; they are measured from the
//! outside, which has 0.
//!
//! # Source
//! Ishida 2017 (hyperbolic mean curvature flow), with three changes:
//!
//! * exact volume gradients instead of unit normals, so that junctions need no rule of their own;
//! * the projection is weighted by mass: a free bubble keeps its momentum;
//! * volumes are met to round-off in each step, not to first order.

pub mod conjugate_gradient;
pub mod error;
pub mod forces;
pub mod forcing;
pub mod prediction;
pub mod pressure_system;
pub mod projection;
pub mod rigid;
pub mod settings;
pub mod shape_keeping;
pub mod stable_step;
pub mod state;
pub mod step;

#[cfg(test)]
mod equilibrium_tests;
#[cfg(test)]
mod motion_tests;

pub use error::FlowError;
pub use forcing::{Acceleration, Forcing, Mass};
pub use settings::{Motion, Scheme, Settings, Tangential};
pub use state::FlowState;
pub use step::{Flow, Proposal, StepInfo};
