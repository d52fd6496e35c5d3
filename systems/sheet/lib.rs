//! Vortex sheets on a multi-region mesh: soap films moved by the air around them (Da et al. 2015), as a discrete Hamiltonian system.
//!
//! The state is the films' shape and one velocity potential per vertex and region; circulations are differences of those.
//! Area is potential energy, the air's motion kinetic energy, and both are discretised before anything is derived from them: waves
//! neither grow on irregular meshes nor need artificial damping, volumes are kept to round-off, and rest is exactly the mesh's
//! state of least area.
//!
//! | question | module |
//! |---|---|
//! | where do potentials lie, what becomes of them when the mesh changes | [`layout`], [`potentials`] |
//! | shape of the films, and what a vertex's volume gradients span | [`geometry`], [`symmetric`] |
//! | which discretisation, and what each has to say | [`discretisation`], [`variational`] (the default), [`pointwise`] |
//! | from potentials to motion | [`flow`] (with [`froth_biot_savart`]), [`sliding`] |
//! | what else moves the air: a wind, gas that comes into bubbles | [`ambient`] |
//! | from forces to potentials | [`tension`], [`convection`], [`damping`] |
//! | what holds | [`wires`], [`impulse`] |
//! | films in contact | [`inelastic`] |
//! | how linear systems are solved | [`conjugate_gradient`] |
//! | all of it in order | [`sheet`], [`integration`], [`step_length`] |
//!
//! # Source
//! Da, Batty, Wojtan, Grinspun 2015, *Double bubbles sans toil and trouble: discrete circulation-preserving vortex sheets for soap films
//! and foams*. The default discretisation is a variational one: fluxes through vertex shares instead of velocities at points. The
//! paper's own is there for comparison.

pub mod ambient;
pub mod conjugate_gradient;
pub mod convection;
pub mod damping;
pub mod discretisation;
pub mod error;
pub mod flow;
pub mod geometry;
pub mod impulse;
pub mod inelastic;
pub mod integration;
pub mod layout;
pub mod pointwise;
pub mod potentials;
pub(crate) mod region_pressures;
pub mod sheet;
pub mod sliding;
pub mod step_length;
pub mod symmetric;
pub mod tension;
pub mod variational;
pub mod wires;

pub use discretisation::Discretisation;
pub use error::SheetError;
pub use froth_biot_savart::{KernelOrder, SheetKernel, Summation};
pub use integration::{Integration, Integrator, Next, Rates, SheetState};
pub use layout::Layout;
pub use potentials::Potentials;
pub use sheet::{Forcing, Sheet};
pub use sliding::Sliding;
