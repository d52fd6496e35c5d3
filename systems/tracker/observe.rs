//! What the tracker measures in every step: size and quality of the mesh, operations, changes of topology.

use bevy_ecs::system::{Res, ResMut};
use froth_surface::SurfaceMesh;
use froth_surface::operations::Counts;

use super::events::StepEvents;
use super::feeding::{Feeds, LiquidFed};
use super::remeshing::{LiquidLost, StepCounts};
use crate::observe::Observables;

/// Records vertices, faces, operations and events of the step.
pub fn observe_mesh(
    mesh: Res<SurfaceMesh>,
    counts: Res<StepCounts>,
    events: Res<StepEvents>,
    lost: Res<LiquidLost>,
    fed: Res<LiquidFed>,
    feeds: Res<Feeds>,
    mut observables: ResMut<Observables>,
) {
    observables.record("vertices", "1", mesh.vertex_rows() as f64);
    observables.record("faces", "1", mesh.face_count() as f64);
    let Counts { splits, face_splits, collapses, separations, snaps, flips, bursts, moves, blocked, .. } = counts.0;
    for (name, count) in [
        ("splits", splits + face_splits),
        ("collapses", collapses),
        ("separations", separations),
        ("snaps", snaps),
        ("flips", flips),
        ("bursts", bursts),
        ("moves", moves),
        ("blocked", blocked),
    ] {
        observables.record(name, "1", count as f64);
    }
    observables.record("liquid_lost", "m^3", lost.0);
    if !feeds.is_empty() {
        observables.record("liquid_fed", "m^3", fed.0);
    }
    observables.record("events", "1", events.0.len() as f64);
}
