//! The step length that the flow asks for: no vertex crosses more than `cfl` edge lengths.
//!
//! The speed is that of the step before, so a step is at most half as long again as the one before it was asked to be; that may have
//! ended early ([`motion`](super::motion)). The first step goes by what
//! a film bent to the radius of one edge length would do: speed `mobility * 2 sigma / L`, or acceleration `2 sigma / (m L)`.

use bevy_ecs::query::With;
use bevy_ecs::resource::Resource;
use bevy_ecs::system::{Query, Res, ResMut};
use froth_components::clock::Clock;
use froth_components::film::{Area, LiquidVolume};
use froth_components::kind::MeshVertex;
use froth_components::material::Liquid;
use froth_components::motion::Velocity;
use froth_surface::flow::Motion;
use serde::{Deserialize, Serialize};

use super::measure::mass_of;
use super::settings::FlowRules;
use crate::clock::StepLimits;
use crate::rows::columns;
use crate::rows::reduce::{ordered_max, ordered_sum};
use crate::tracker::films::MeshRules;
use crate::tracker::tension::BubbleTensions;

/// Longest step in steps before.
const GROWTH: f64 = 1.5;

/// Length that the last step was asked to have, s; it may have ended before. State of a run: without it, steps that end early one after
/// the other would grow shorter and shorter.
#[derive(Resource, Clone, Copy, Debug, Default, Serialize, Deserialize)]
#[serde(transparent)]
pub struct AskedLength(pub f64);

/// Proposes the step length by the fastest vertex, and the scene's own.
pub fn limit_step(
    vertices: Query<(&Velocity, &Area, &LiquidVolume), With<MeshVertex>>,
    rules: Res<FlowRules>,
    mesh: Res<MeshRules>,
    liquid: Res<Liquid>,
    tensions: Res<BubbleTensions>,
    clock: Res<Clock>,
    asked: Res<AskedLength>,
    mut limits: ResMut<StepLimits>,
) {
    limits.propose("time_step", rules.step);
    if vertices.is_empty() {
        return; // The last film has burst.
    }
    let (velocities, areas, liquids) = columns(&vertices);
    let fastest = ordered_max(velocities.len(), 0.0, |v| velocities[v].0.length());
    let (edge, tension) = (mesh.policy.edge, 2.0 * tensions.largest(liquid.surface_tension));
    limits.propose("cfl", rules.cfl * edge / fastest);
    if clock.steps > 0 {
        limits.propose("growth", GROWTH * asked.0);
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
