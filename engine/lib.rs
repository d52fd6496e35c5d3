//! Assembles and runs: scene files, methods (schedules), run loop, checkpoints, pictures, verification.

pub mod picture;
