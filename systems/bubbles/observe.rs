//! What is measured of the bubbles in every step.

use bevy_ecs::query::With;
use bevy_ecs::system::{Query, Res, ResMut};
use froth_components::gas::{GasPressure, GasVolume, ReferencePressure, ReferenceVolume};
use froth_components::identity::InRegion;
use froth_components::kind::{MeshVertex, Region};
use froth_components::motion::Position;
use froth_surface::SurfaceMesh;

use crate::observe::Observables;
use crate::rows::columns;

/// Largest number of a bubble whose volume, pressure and area get columns of their own; all are rows of the kind `Region`.
const LISTED: usize = 40;

/// Records the bubbles: how many, how well they keep their volumes, and of the first forty volume, pressure and the area of the films
/// around them.
pub fn observe_bubbles(
    bubbles: Query<(&InRegion, &GasVolume, &ReferenceVolume, &GasPressure, &ReferencePressure), With<Region>>,
    vertices: Query<&Position, With<MeshVertex>>,
    mesh: Res<SurfaceMesh>,
    mut observables: ResMut<Observables>,
) {
    let areas = if vertices.is_empty() { [0.0; LISTED + 1] } else { areas_around(&mesh, columns(&vertices)) };
    observables.record("bubbles", "1", bubbles.iter().len() as f64);
    let error = bubbles.iter().map(|(_, volume, target, ..)| (volume.0 / target.0 - 1.0).abs()).fold(0.0, f64::max);
    observables.record("volume_error", "1", error);
    for (region, volume, _, pressure, outside) in bubbles.iter().filter(|(region, ..)| region.0.0 as usize <= LISTED) {
        let name = |what: &str| format!("{what}_{}", region.0.0);
        observables.record(&name("volume"), "m^3", volume.0);
        observables.record(&name("excess_pressure"), "Pa", pressure.0 - outside.0);
        observables.record(&name("area"), "m^2", areas[region.0.0 as usize]);
    }
}

/// Area of the films around each region by its label, m^2; a film between two regions counts for both.
fn areas_around(mesh: &SurfaceMesh, places: &[Position]) -> [f64; LISTED + 1] {
    let mut areas = [0.0; LISTED + 1];
    for (_, face) in mesh.faces().filter(|(_, face)| !face.is_ghost()) {
        let [a, b, c] = face.vertices().map(|v| places[v.index()].0);
        let area = 0.5 * (b - a).cross(c - a).length();
        for region in face.labels() {
            if let Some(sum) = areas.get_mut(region.0 as usize) {
                *sum += area;
            }
        }
    }
    areas
}
