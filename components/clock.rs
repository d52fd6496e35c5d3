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
    /// Equal substeps that the present step is divided into for the film's own motion; 0 counts as 1. Chosen in the
    /// `Clock` stage.
    pub substeps: u32,
    /// Steps finished.
    pub steps: u64,
    /// The next moment that a step must not pass (the next frame, or the end), s.
    pub horizon: f64,
}

impl Clock {
    /// Length of one substep, s: what systems of the stages `Geometry` to `Deform` advance by.
    #[must_use]
    pub fn substep_length(&self) -> f64 {
        self.step_length / f64::from(self.substeps.max(1))
    }

    /// Ends the present step after `substeps` of its substeps, at least one: what follows them comes sooner.
    pub fn end_after(&mut self, substeps: u32) {
        let (length, count) = (self.substep_length(), substeps.max(1));
        if count < self.substeps {
            (self.step_length, self.substeps) = (length * f64::from(count), count);
        }
    }
}

/// Seed of the run's random numbers, which are keyed by (seed, stable id, step, use).
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Seed(pub u64);
