//! Discrete surface calculus on scattered points.
//!
//! * [`tangent`]: vectors between tangent planes.
//! * [`stencil`]: areas and symmetric pair weights; Laplacian, divergence, gradients.
//! * [`quadratic`]: local quadratic fits: normals, curvature, lifting and projection.
//! * [`pair_system`]: symmetric positive (semi)definite systems; [`conjugate_gradient`] solves them, [`multigrid`]
//!   makes that fast.

pub mod conjugate_gradient;
pub mod multigrid;
pub mod pair_system;
pub mod quadratic;
pub mod stencil;
pub mod tangent;
