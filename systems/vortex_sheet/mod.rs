//! Vortex sheets (Da et al. 2015): films that the air around them moves, as a mesh with a potential per vertex and region.
//!
//! | stage | system | file |
//! |---|---|---|
//! | `Clock` | capillary waves, speed and strain limit steps and substeps | `step_length` |
//! | `Geometry` | area vectors, volume gradients; columns of shape | `geometry` |
//! | `Forces` | wind, and gas that comes in: everything else is seen from a frame that goes with them | `dynamics` |
//! | `Dynamics` | tension and external forces change the potentials | `dynamics` |
//! | `Dynamics` | circulation on wires, so that films go with them | `dynamics` |
//! | `Velocity` | sheet strengths, Biot-Savart, fluxes, velocities, convection | `velocity` |
//! | `Velocity` | a substep that turns out too long is taken again | `step_length` |
//! | `Deform` | integrator; gas; films go where it says, as far as none touches another | `motion` |
//! | `Deform` | at the end of a substep: second kick, impulse, damping | `arrival` |
//! | `Deform`, `Topology` | films in contact lose energy | `contacts` |
//! | `Topology` | volumes and impulses after remeshing | `remeshed` |
//! | `Observe` | energies, circulations, how the step went | `observe` |
//!
//! `Geometry` to `Deform` are one evaluation; integrators that need several ask for another pass
//! ([`AnotherPass`](crate::plan::AnotherPass)). The mathematics is [`froth_sheet`].

pub mod arrival;
pub mod contacts;
pub mod dynamics;
pub mod geometry;
pub mod motion;
pub mod observe;
pub mod remeshed;
pub mod settings;
pub mod step_length;
pub mod velocity;
pub mod work;
