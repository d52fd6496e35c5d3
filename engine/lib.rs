//! Assembles and runs: scene files, methods (schedules), run loop, checkpoints, pictures, verification.

pub mod errors;
pub mod scene;
