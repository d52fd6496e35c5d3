//! Assembles and runs: scene files, methods (schedules), run loop, checkpoints, pictures, verification.
//!
//! A program begins at [`Simulation`]; a run with its folder at [`run`].

pub mod bench;
pub mod checkpoint;
pub mod cli;
pub mod errors;
pub mod frames;
pub mod gallery;
pub mod method;
pub mod picture;
pub mod run;
pub mod scene;
pub mod simulation;
pub mod verify;
pub mod whole_file;

pub use simulation::Simulation;
