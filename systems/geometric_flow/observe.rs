//! What a run of geometric flow measures in every step.

use bevy_ecs::query::With;
use bevy_ecs::system::{Query, Res, ResMut};
use froth_components::film::{Area, LiquidVolume};
use froth_components::kind::MeshVertex;
use froth_components::material::Liquid;
use froth_components::motion::{Position, Velocity};
use froth_surface::{SurfaceMesh, VertexRow};

use super::measure::mass_of;
use super::motion::FlowStep;
use super::settings::FlowRules;
use crate::observe::Observables;
use crate::rows::columns;
use crate::rows::reduce::{ordered_max, ordered_sum};
use crate::tracker::tension::{BubbleTensions, film_energy};

/// Records area, energies, speeds, and how the step went.
pub fn observe_films(
    vertices: Query<(&Area, &Position, &Velocity, &LiquidVolume), With<MeshVertex>>,
    step: Res<FlowStep>,
    rules: Res<FlowRules>,
    liquid: Res<Liquid>,
    mesh: Res<SurfaceMesh>,
    tensions: Res<BubbleTensions>,
    mut observables: ResMut<Observables>,
) {
    if vertices.is_empty() {
        // The last film has burst.
        observables.record("area", "m^2", 0.0);
        return;
    }
    let (areas, positions, velocities, volumes) = columns(&vertices);
    let count = areas.len();
    let sum = |f: &(dyn Fn(usize) -> f64 + Sync)| ordered_sum(count, 0.0, f);
    let area = sum(&|v| areas[v].0);
    observables.record("area", "m^2", area);
    let place = |v: VertexRow| positions[v.index()].0;
    observables.record("surface_energy", "J", film_energy(&mesh, &tensions, liquid.surface_tension, place));
    observables.record("liquid", "m^3", sum(&|v| volumes[v].0));
    observables.record("max_speed", "m/s", ordered_max(count, 0.0, |v| velocities[v].0.length()));
    if rules.is_inertial() {
        let mass = |v: usize| mass_of(&rules, &liquid, areas[v], volumes[v]);
        let energy = sum(&|v| 0.5 * mass(v) * velocities[v].0.length_squared());
        observables.record("kinetic_energy", "J", energy);
    }
    observables.record("limited_vertices", "1", step.limited as f64);
    observables.record("least_fraction", "1", step.least_fraction);
    observables.record("proposals", "1", f64::from(step.proposals));
    observables.record("substeps", "1", f64::from(step.substeps));
    observables.record("solve_iterations", "1", f64::from(step.solve_iterations));
}
