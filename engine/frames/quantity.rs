//! The quantity that a picture shows: a registered column of the finest kind of particle, or of the mesh vertices.

use bevy_ecs::world::World;
use froth_components::column::Column;
use froth_components::film::Thickness;
use froth_components::kind::{EulerianParticle, Kind, LagrangianParticle, MeshVertex};
use froth_components::motion::Position;
use froth_components::quantity::nearest;
use froth_surface::SurfaceMesh;
use froth_systems::rows::registry::{ColumnEntry, ColumnRegistry};

use crate::picture::Look;

/// A picture of a quantity that no particle carries.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("no particle has a quantity `{wanted}` to draw{}; there are: {}", hint(nearest.as_deref()), known.join(", "))]
pub struct QuantityError {
    /// What the scene asks for.
    pub wanted: String,
    /// The most similar name.
    pub nearest: Option<String>,
    /// What there is.
    pub known: Vec<&'static str>,
}

fn hint(nearest: Option<&str>) -> String {
    nearest.map(|name| format!(" (did you mean `{name}`?)")).unwrap_or_default()
}

impl QuantityError {
    fn of(wanted: String, candidates: &[ColumnEntry]) -> Self {
        let mut known: Vec<&'static str> = candidates.iter().map(|entry| entry.name).collect();
        known.sort_unstable();
        known.dedup();
        let nearest = nearest(&wanted, known.iter().copied()).map(str::to_owned);
        Self { wanted, nearest, known }
    }
}

/// Name of the column that a look shows.
fn wanted(look: &Look) -> String {
    match look {
        Look::Interference { .. } => Thickness::NAME.to_owned(),
        Look::Map { quantity, .. } => quantity.trim().replace(' ', "_"),
        // Colours by region show no quantity: one that every kind has will do.
        Look::Regions { .. } => Position::NAME.to_owned(),
    }
}

/// Columns of some kinds of particle, kind after kind.
fn candidates(world: &World, kinds: &[&'static str]) -> Vec<ColumnEntry> {
    let registry = world.resource::<ColumnRegistry>();
    kinds.iter().flat_map(|kind| registry.of_kind(kind)).collect()
}

/// A column to draw.
#[derive(Clone, Copy)]
pub(super) struct Quantity {
    /// Name of the kind of particle that is drawn.
    pub(super) kind: &'static str,
    column: ColumnEntry,
}

impl Quantity {
    /// The quantity that a look shows.
    pub(super) fn of(look: &Look, world: &mut World) -> Result<Self, QuantityError> {
        // Material particles first: they show the finest detail.
        let candidates = candidates(world, &[LagrangianParticle::NAME, MeshVertex::NAME, EulerianParticle::NAME]);
        let wanted = wanted(look);
        // A mesh may have lost all its vertices: then its films have burst, which makes a picture, too.
        let has_mesh = world.contains_resource::<SurfaceMesh>();
        let is_mesh = |entry: &ColumnEntry| has_mesh && entry.kind == MeshVertex::NAME;
        let populated =
            |entry: &&ColumnEntry| entry.name == wanted && (is_mesh(entry) || !entry.save(world).is_empty());
        match candidates.iter().find(populated) {
            Some(column) => Ok(Self { kind: column.kind, column: *column }),
            None => Err(QuantityError::of(wanted, &candidates)),
        }
    }

    /// Whether the particles that are to come will have the quantity that a look shows.
    pub(super) fn check(look: &Look, world: &World, has_liquid: bool) -> Result<(), QuantityError> {
        let kinds = [EulerianParticle::NAME, MeshVertex::NAME, LagrangianParticle::NAME];
        let candidates = candidates(world, if has_liquid { &kinds } else { &kinds[..2] });
        let wanted = wanted(look);
        match candidates.iter().any(|entry| entry.name == wanted) {
            true => Ok(()),
            false => Err(QuantityError::of(wanted, &candidates)),
        }
    }

    /// The values, one per particle; of a vector or matrix its length.
    pub(super) fn values(&self, world: &mut World) -> Vec<f64> {
        let numbers = self.column.numbers(world);
        match self.column.lanes.len() {
            0 => numbers,
            lanes => numbers.chunks_exact(lanes).map(|v| v.iter().map(|x| x * x).sum::<f64>().sqrt()).collect(),
        }
    }
}
