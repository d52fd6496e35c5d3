//! Discrete surface calculus on scattered points.
//!
//! * [`tangent`]: vectors between tangent planes.
//! * [`stencil`]: areas and symmetric pair weights; Laplacian, divergence, gradients.
//! * [`quadratic`]: local quadratic fits: normals, curvature, lifting and projection.
//! * [`conjugate_gradient`]: solving symmetric positive definite systems.

pub mod conjugate_gradient;
pub mod quadratic;
pub mod stencil;
pub mod tangent;
