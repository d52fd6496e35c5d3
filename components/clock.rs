//! Time: the clock of the run and the length of the present step.

use bevy_ecs::resource::Resource;
use serde::{Deserialize, Serialize};

/// Simulated time and the present step.
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Clock {
    /// Time at the start of the present step, s.
    pub time: f64,
    /// Length of the present step, s. Chosen in the `Clock` stage.
    pub step_length: f64,
    /// Steps finished.
    pub steps: u64,
    /// The next moment that a step must not pass (the next frame, or the end), s.
    pub horizon: f64,
}

/// Seed of the run's random numbers, which are keyed by (seed, stable id, step, use).
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Seed(pub u64);
