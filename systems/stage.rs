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
/// 9. `Scatter`: carriers to material particles (E2L; mesh to particle)
/// 10. `Advance`: move carriers, move material, project
/// 11. `Topology`: redistribution, remeshing, sorting of rows
/// 12. `Observe`: diagnostics, checks for finite values, events
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
    /// Carriers to material particles.
    Scatter,
    /// Move carriers and material.
    Advance,
    /// Redistribution, remeshing, sorting.
    Topology,
    /// Diagnostics and checks.
    Observe,
}

impl Stage {
    /// Every stage, in order.
    pub const ALL: [Self; 12] = [
        Self::Clock,
        Self::Gather,
        Self::Geometry,
        Self::Forces,
        Self::Dynamics,
        Self::Coupling,
        Self::Velocity,
        Self::Constraints,
        Self::Scatter,
        Self::Advance,
        Self::Topology,
        Self::Observe,
    ];
}

/// An empty schedule with the stages chained, the single-threaded executor (parallelism lives inside systems), and
/// ambiguity as an error: two systems that touch the same data must be ordered.
#[must_use]
pub fn staged_schedule(label: impl ScheduleLabel) -> Schedule {
    let mut schedule = Schedule::new(label);
    schedule.set_executor(SingleThreadedExecutor::new());
    schedule.set_build_settings(ScheduleBuildSettings { ambiguity_detection: LogLevel::Error, ..Default::default() });
    use Stage as S;
    schedule.configure_sets(
        (
            (S::Clock, S::Gather, S::Geometry, S::Forces, S::Dynamics, S::Coupling).chain(),
            (S::Velocity, S::Constraints, S::Scatter, S::Advance, S::Topology, S::Observe).chain(),
        )
            .chain(),
    );
    schedule
}
