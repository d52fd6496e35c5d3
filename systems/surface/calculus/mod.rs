//! Discrete calculus on a [`Surface`](crate::Surface): areas, volumes, their exact gradients, stiffness, curvature, angles.
//!
//! Everything is assembled face by face over the whole non-manifold mesh, so that junctions need no rule of their own.
//! Ghost faces count for volumes and for nothing else.
//!
//! * [`incidence`]: connectivity in flat arrays, built once per change of the mesh; [`weights`]: one number per face.
//! * [`area`]: areas and the gradient of film energy; [`volume`]: volumes and their gradients.
//! * [`stiffness`]: the cotangent matrix; [`curvature`]: mean curvature.
//! * [`borders`]: Plateau borders and where they meet; [`angles`]: the angles there, measured to second order;
//!   [`quadric`]: the fit behind them; [`solid_angle`](mod@solid_angle): of a triangle, from a point.

pub mod angles;
pub mod area;
pub mod borders;
pub mod curvature;
pub mod incidence;
pub mod quadric;
pub mod solid_angle;
pub mod stiffness;
pub mod volume;
pub mod weights;

#[cfg(test)]
pub(crate) mod test_shapes;

pub use incidence::Incidence;
pub use weights::Weights;
