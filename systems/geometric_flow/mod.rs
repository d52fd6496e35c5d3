//! Geometric flow (Ishida et al. 2017, and the normal step of Tao et al. 2024): films as a mesh under their own tension,
//! with the volume of every bubble kept exactly.
//!
//! | stage | system | file |
//! |---|---|---|
//! | `Clock` | no vertex crosses more than `cfl` edge lengths | `step_length` |
//! | `Geometry` | areas, normals, curvature, thickness | `measure` |
//! | `Dynamics` | where tension, pressure and external forces take the films, for as long as faces keep their shapes | `motion` |
//! | `Deform` | films go there, as far as none touches another | `motion` |
//! | `Observe` | areas, energies, how the step went | `observe` |
//!
//! The mathematics is [`froth_surface::flow`] and [`froth_surface::calculus`].

pub mod measure;
pub mod motion;
pub mod observe;
pub mod settings;
pub mod step_length;
