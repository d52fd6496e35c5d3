//! What happens in froth: one folder per subject, one file per stage; every system is a thin shell over pure functions.
//!
//! * [`stage`]: the order of a step, fixed once.
//! * [`plan`]: which systems run in which stage, in which order, what each requires, and where the time goes.
//! * [`clock`]: the length of a step.
//! * [`observe`]: measured numbers, faults.
//! * [`rows`]: particles as rows of contiguous columns; the registry of columns; sorting.
//! * [`neighbours`]: cell lists, compressed rows of neighbours, kernels.
//! * [`tracker`]: films as a mesh: remeshing, changes of topology, wires, bursts.
//! * [`bubbles`]: the gas of closed regions.
//! * [`melp`], [`geometric_flow`], [`vortex_sheet`]: the stages of the methods; [`forces`]: what pushes films in every method.
//! * [`sampling`]: from authored shapes to rows, spherical harmonics, random numbers.
//! * [`operators`]: discrete surface calculus: pair weights, gradients, quadratic fits, conjugate gradients.

pub mod bubbles;
pub mod clock;
pub mod forces;
pub mod geometric_flow;
pub mod melp;
pub mod neighbours;
pub mod observe;
pub mod operators;
pub mod plan;
pub mod rows;
pub mod sampling;
pub mod stage;
pub mod tracker;
pub mod vortex_sheet;
