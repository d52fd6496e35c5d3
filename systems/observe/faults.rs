//! Faults: what a system reports when the run cannot go on.
//!
//! A fault is data, not a panic: the step stops at the next system, the state stays readable, and whoever drives the run
//! says what happened and where the last good checkpoint is.

use std::fmt;

use bevy_ecs::resource::Resource;
use bevy_ecs::world::World;

use crate::stage::Stage;

/// Why a step could not be finished.
#[derive(Clone, Debug, PartialEq)]
pub struct Fault {
    /// Stage of the system that reports it.
    pub stage: Stage,
    /// The component, resource or solver that is at fault, such as `velocity` or `Marangoni solve`.
    pub what: String,
    /// What is wrong with it, with numbers.
    pub detail: String,
    /// The particle it shows on, if it shows on one.
    pub particle: Option<FaultyParticle>,
}

/// A particle that a fault shows on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FaultyParticle {
    /// Name of its kind.
    pub kind: &'static str,
    /// Its row at the time of the fault.
    pub row: usize,
    /// Its stable id, if the kind has such.
    pub id: Option<u64>,
}

impl Fault {
    /// A fault of the whole run; `what` is at fault, `detail` says what is wrong with it.
    #[must_use]
    pub fn new(stage: Stage, what: impl Into<String>, detail: impl Into<String>) -> Self {
        Self { stage, what: what.into(), detail: detail.into(), particle: None }
    }

    /// The same fault, showing on one particle.
    #[must_use]
    pub fn on_particle(mut self, kind: &'static str, row: usize, id: Option<u64>) -> Self {
        self.particle = Some(FaultyParticle { kind, row, id });
        self
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:?}: `{}` ", self.stage, self.what)?;
        if let Some(particle) = self.particle {
            match particle.id {
                Some(id) => write!(f, "of {} particle {id} ", particle.kind)?,
                None => write!(f, "of {} row {} ", particle.kind, particle.row)?,
            }
        }
        f.write_str(&self.detail)
    }
}

/// The faults of the present step, in the order in which they were reported.
#[derive(Resource, Debug, Default)]
pub struct Faults(Vec<Fault>);

impl Faults {
    /// Stops the step after the system that reports.
    pub fn report(&mut self, fault: Fault) {
        self.0.push(fault);
    }

    /// The faults so far.
    #[must_use]
    pub fn all(&self) -> &[Fault] {
        &self.0
    }

    /// Forgets all faults.
    pub fn clear(&mut self) {
        self.0.clear();
    }

    /// Whether no fault has been reported in a world.
    #[must_use]
    pub fn none(world: &World) -> bool {
        world.get_resource::<Self>().is_none_or(|faults| faults.0.is_empty())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fault_says_stage_component_and_particle() {
        let fault = Fault::new(Stage::Velocity, "velocity", "is not finite (NaN)");
        assert_eq!(fault.to_string(), "Velocity: `velocity` is not finite (NaN)");
        let fault = fault.on_particle("eulerian", 3, Some(17));
        assert_eq!(fault.to_string(), "Velocity: `velocity` of eulerian particle 17 is not finite (NaN)");
    }
}
