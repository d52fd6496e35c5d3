//! Vortex sheets (Da et al. 2015): films that the air around them moves, as a mesh with a potential per vertex and region.
//!
//! | stage | system | file |
//! |---|---|---|
//! | `Clock` | capillary waves and speed limit steps and substeps | `step_length` |
//! | `Geometry` | area vectors, volume gradients; columns of shape | `geometry` |
//! | `Dynamics` | tension and external forces change the potentials | `dynamics` |
//! | `Dynamics` | circulation on wires, so that films go with them | `dynamics` |
//! | `Velocity` | sheet strengths, Biot-Savart, fluxes, velocities, convection | `velocity` |
//! | `Deform` | integrator; volumes; films go there, as far as none touches another; damping; impulse | `motion` |
//! | `Advance` | pressure of every bubble, impulse of every cluster | `motion` |
//! | `Topology` | volumes and impulses after remeshing | `motion` |
//! | `Observe` | energies, circulations, how the step went | `observe` |
//!
//! `Geometry` to `Deform` are one evaluation; integrators that need several ask for another pass
//! ([`AnotherPass`](crate::plan::AnotherPass)). The mathematics is [`froth_sheet`].

pub mod dynamics;
pub mod geometry;
pub mod motion;
pub mod observe;
pub mod settings;
pub mod step_length;
pub mod velocity;
pub mod work;
