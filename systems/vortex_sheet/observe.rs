//! What a run of a vortex sheet measures in every step.

use bevy_ecs::query::With;
use bevy_ecs::system::{Query, Res, ResMut};
use froth_components::film::{Area, LiquidVolume};
use froth_components::kind::MeshVertex;
use froth_components::material::Liquid;
use froth_components::motion::Velocity;
use froth_surface::{SurfaceMesh, VertexRow};
use glam::DVec3;

use super::settings::SheetRules;
use super::work::SheetWork;
use crate::observe::Observables;
use crate::rows::columns;
use crate::rows::reduce::{ordered_max, ordered_sum};
use crate::tracker::tension::{BubbleTensions, film_energy};

/// Records area, energies, impulse, speeds, and how the step went.
///
/// The kinetic energy, and the energy of films and air together, are those of the step's last evaluation, which comes before its last move:
/// the sum over pairs is not worked out once more for a number. The impulse is that of the clusters that no wire holds. In a wind both are
/// those against it, and neither has what gas that comes in does to the air around.
pub fn observe_films(
    vertices: Query<(&Area, &Velocity, &LiquidVolume), With<MeshVertex>>,
    work: Res<SheetWork>,
    rules: Res<SheetRules>,
    liquid: Res<Liquid>,
    tensions: Res<BubbleTensions>,
    mesh: Res<SurfaceMesh>,
    mut observables: ResMut<Observables>,
) {
    if vertices.is_empty() {
        // The last film has burst.
        observables.record("area", "m^2", 0.0);
        return;
    }
    let (areas, velocities, volumes) = columns(&vertices);
    let count = areas.len();
    let area = ordered_sum(count, 0.0, |v| areas[v].0);
    let place = |v: VertexRow| work.state.positions[v.index()];
    let film_energy = film_energy(&mesh, &tensions, liquid.surface_tension, place);
    let measured = work.sheet.measured;
    observables.record("area", "m^2", area);
    observables.record("surface_energy", "J", film_energy);
    observables.record("kinetic_energy", "J", measured.kinetic_energy);
    observables.record("energy", "J", measured.energy);
    let impulse: DVec3 = rules.density * work.sheet.impulses(&work.state.potentials).into_iter().sum::<DVec3>();
    observables.record("impulse_x", "kg m/s", impulse.x);
    observables.record("impulse_y", "kg m/s", impulse.y);
    observables.record("impulse_z", "kg m/s", impulse.z);
    observables.record("liquid", "m^3", ordered_sum(count, 0.0, |v| volumes[v].0));
    observables.record("max_speed", "m/s", ordered_max(count, 0.0, |v| velocities[v].0.length()));
    let circulations = work
        .sheet
        .layout
        .panels()
        .iter()
        .flat_map(|panel| froth_sheet::geometry::circulations(panel, &work.state.potentials));
    observables.record("max_circulation", "m^2/s", circulations.fold(0.0, |most, gamma| most.max(gamma.abs())));
    let report = work.report;
    observables.record("limited_vertices", "1", report.limited as f64);
    observables.record("least_fraction", "1", report.least_fraction);
    observables.record("substeps", "1", f64::from(report.substeps));
    observables.record("evaluations", "1", f64::from(report.evaluations));
    observables.record("wire_iterations", "1", f64::from(report.wire_iterations));
    observables.record("volume_correction", "m", report.volume_correction);
    observables.record("contact_loss", "J", report.contact_loss);
    observables.record("impulse_correction", "m/s", report.impulse_correction);
}
