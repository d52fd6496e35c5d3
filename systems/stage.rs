//! The order of a step, fixed once for every method.

use bevy_ecs::schedule::{IntoScheduleConfigs, LogLevel, Schedule, ScheduleBuildSettings, SingleThreadedExecutor};
use bevy_ecs::schedule::{ScheduleLabel, SystemSet};

/// The stages of a step. Their order is the algorithm:
///
/// 1. `Clock`: choose the step length from CFL and the method's own limits
/// 2. `Gather`: material particles to carriers (L2E; particle to mesh)
/// 3. `Geometry`: frames, areas, curvature, thickness, volumes, pressures
/// 4. `Forces`: external forces write accelerations; the plug-in point
/// 5. `Dynamics`: normal motion, Marangoni flow, circulation
/// 6. `Coupling`: between regions: tracking, contact, sharing of surface tension, material transfer
/// 7. `Velocity`: velocity from what was evolved (Biot-Savart, Poisson)
/// 8. `Constraints`: wires, obstacles, rims
/// 9. `Deform`: the film follows its own fast motion
/// 10. `Scatter`: carriers to material particles (E2L; mesh to particle)
/// 11. `Advance`: spread carriers, move material, project
/// 12. `Topology`: remeshing, splitting and merging, sorting of rows
/// 13. `Observe`: diagnostics, checks for finite values, events
///
/// `Geometry` to `Deform` are a substep: they run [`Clock::substeps`](froth_components::clock::Clock) times in a step.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Stage {
    /// Choose the step length.
    Clock,
    /// Material particles to carriers.
    Gather,
    /// Frames, areas, curvature, thickness, volumes, pressures.
    Geometry,
    /// External forces.
    Forces,
    /// Normal motion, Marangoni flow, circulation.
    Dynamics,
    /// Between regions.
    Coupling,
    /// Velocity from what was evolved.
    Velocity,
    /// Wires, obstacles, rims.
    Constraints,
    /// The film follows its own fast motion.
    Deform,
    /// Carriers to material particles.
    Scatter,
    /// Spread carriers, move material.
    Advance,
    /// Remeshing, splitting and merging, sorting.
    Topology,
    /// Diagnostics and checks.
    Observe,
}

impl Stage {
    /// Every stage, in order.
    pub const ALL: [Self; 13] = [
        Self::Clock,
        Self::Gather,
        Self::Geometry,
        Self::Forces,
        Self::Dynamics,
        Self::Coupling,
        Self::Velocity,
        Self::Constraints,
        Self::Deform,
        Self::Scatter,
        Self::Advance,
        Self::Topology,
        Self::Observe,
    ];

    /// The part of a step that the stage belongs to.
    #[must_use]
    pub fn part(self) -> Part {
        match self {
            Self::Clock | Self::Gather => Part::Begin,
            Self::Scatter | Self::Advance | Self::Topology | Self::Observe => Part::End,
            _ => Part::Substep,
        }
    }
}

/// A part of a step: what runs before, in and after its substeps. Label of a schedule.
#[derive(ScheduleLabel, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Part {
    /// Once, before the substeps.
    Begin,
    /// Once per substep.
    Substep,
    /// Once, after the substeps.
    End,
}

impl Part {
    /// Every part, in order.
    pub const ALL: [Self; 3] = [Self::Begin, Self::Substep, Self::End];

    /// Its stages, in order.
    pub fn stages(self) -> impl Iterator<Item = Stage> {
        Stage::ALL.into_iter().filter(move |stage| stage.part() == self)
    }
}

/// An empty schedule of a part with its stages chained, the single-threaded executor (parallelism lives inside systems),
/// and ambiguity as an error: two systems that touch the same data must be ordered.
#[must_use]
pub fn staged_schedule(part: Part) -> Schedule {
    let mut schedule = Schedule::new(part);
    schedule.set_executor(SingleThreadedExecutor::new());
    schedule.set_build_settings(ScheduleBuildSettings { ambiguity_detection: LogLevel::Error, ..Default::default() });
    let stages: Vec<Stage> = part.stages().collect();
    for pair in stages.windows(2) {
        schedule.configure_sets((pair[0], pair[1]).chain());
    }
    schedule
}
