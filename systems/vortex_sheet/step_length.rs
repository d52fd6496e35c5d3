//! Steps and substeps of a sheet: capillary waves as short as the mesh limit substeps, speed limits steps.
//!
//! The speed is that of the step before, so a step is at most half as long again as the one before it; the first holds a few substeps.

use bevy_ecs::query::With;
use bevy_ecs::system::{Query, Res, ResMut};
use froth_components::clock::Clock;
use froth_components::kind::MeshVertex;
use froth_components::material::Liquid;
use froth_components::motion::{Position, Velocity};
use froth_sheet::step_length::{capillary_time, limiting_edge};
use froth_surface::SurfaceMesh;

use super::settings::SheetRules;
use crate::clock::StepLimits;
use crate::rows::columns;
use crate::rows::reduce::ordered_max;
use crate::tracker::films::MeshRules;

/// Longest step in steps before.
const GROWTH: f64 = 1.5;
/// Substeps of the first step.
const FIRST: f64 = 4.0;
/// Substeps that a step may hold: enough for any mesh that the tracker keeps.
const MOST_SUBSTEPS: u32 = 1000;

/// Proposes the lengths of step and substeps.
pub fn limit_step(
    vertices: Query<(&Position, &Velocity), With<MeshVertex>>,
    films: Res<SurfaceMesh>,
    rules: Res<SheetRules>,
    mesh: Res<MeshRules>,
    liquid: Res<Liquid>,
    clock: Res<Clock>,
    mut limits: ResMut<StepLimits>,
) {
    if vertices.is_empty() {
        return; // The last film has burst.
    }
    let (positions, velocities) = columns(&vertices);
    let sides = films.faces().filter(|(_, face)| !face.is_ghost()).flat_map(|(_, face)| {
        let [a, b, c] = face.vertices().map(|v| positions[v.index()].0);
        [a.distance_squared(b), b.distance_squared(c), c.distance_squared(a)]
    });
    let shortest = sides.fold(f64::INFINITY, f64::min).sqrt();
    let shortest = limiting_edge(shortest, rules.kernel.smoothing_length);
    let capillary = rules.courant * capillary_time(shortest, rules.density, liquid.surface_tension);
    limits.propose_for_substeps("capillary waves", capillary, MOST_SUBSTEPS);
    let fastest = ordered_max(velocities.len(), 0.0, |v| velocities[v].0.length());
    limits.propose("cfl", rules.cfl * mesh.policy.edge / fastest);
    if clock.steps > 0 {
        limits.propose("growth", GROWTH * clock.step_length);
    } else {
        limits.propose("first step", FIRST * capillary);
    }
}
