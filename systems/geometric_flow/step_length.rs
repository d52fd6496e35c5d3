//! The step length that the flow asks for: no vertex crosses more than `cfl` edge lengths.
//!
//! The speed is that of the step before, so a step is at most half as long again as the one before it. The first step goes by what
//! a film bent to the radius of one edge length would do: speed `mobility * 2 sigma / L`, or acceleration `2 sigma / (m L)`.

use bevy_ecs::query::With;
use bevy_ecs::system::{Query, Res, ResMut};
use froth_components::clock::Clock;
use froth_components::film::{Area, LiquidVolume};
use froth_components::kind::MeshVertex;
use froth_components::material::Liquid;
use froth_components::motion::Velocity;
use froth_surface::flow::Motion;

use super::measure::mass_of;
use super::settings::FlowRules;
use crate::clock::StepLimits;
use crate::rows::columns;
use crate::rows::reduce::{ordered_max, ordered_sum};
use crate::tracker::films::MeshRules;

/// Longest step in steps before.
const GROWTH: f64 = 1.5;

/// Proposes the step length by the fastest vertex, and the scene's own.
pub fn limit_step(
    vertices: Query<(&Velocity, &Area, &LiquidVolume), With<MeshVertex>>,
    rules: Res<FlowRules>,
    mesh: Res<MeshRules>,
    liquid: Res<Liquid>,
    clock: Res<Clock>,
    mut limits: ResMut<StepLimits>,
) {
    limits.propose("time_step", rules.step);
    if vertices.is_empty() {
        return; // The last film has burst.
    }
    let (velocities, areas, liquids) = columns(&vertices);
    let fastest = ordered_max(velocities.len(), 0.0, |v| velocities[v].0.length());
    let (edge, tension) = (mesh.policy.edge, 2.0 * liquid.surface_tension);
    limits.propose("cfl", rules.cfl * edge / fastest);
    if clock.steps > 0 {
        limits.propose("growth", GROWTH * clock.step_length);
        return;
    }
    let first = match rules.settings.motion {
        Motion::Overdamped { mobility } => rules.cfl * edge * edge / (mobility * tension),
        Motion::Inertial => {
            let sum = |f: &(dyn Fn(usize) -> f64 + Sync)| ordered_sum(areas.len(), 0.0, f);
            let mass = sum(&|v| mass_of(&rules, &liquid, areas[v], liquids[v])) / sum(&|v| areas[v].0);
            (2.0 * rules.cfl * edge * edge * mass / tension).sqrt()
        }
    };
    limits.propose("first step", first);
}
