//! The quantity that a picture shows: a registered column of the finest kind of particle that has it.

use bevy_ecs::world::World;
use froth_components::column::Column;
use froth_components::film::Thickness;
use froth_components::kind::{EulerianParticle, Kind, LagrangianParticle};
use froth_components::quantity::nearest;
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
        let wanted = match look {
            Look::Interference { .. } => Thickness::NAME.to_owned(),
            Look::Map { quantity, .. } => quantity.trim().replace(' ', "_"),
        };
        let registry = world.resource::<ColumnRegistry>();
        // Material particles first: they show the finest detail.
        let drawn = [LagrangianParticle::NAME, EulerianParticle::NAME];
        let candidates: Vec<ColumnEntry> = drawn.iter().flat_map(|kind| registry.of_kind(kind)).collect();
        let populated = |entry: &&ColumnEntry| entry.name == wanted && !entry.save(world).is_empty();
        if let Some(column) = candidates.iter().find(populated) {
            return Ok(Self { kind: column.kind, column: *column });
        }
        let mut known: Vec<&'static str> = candidates.iter().map(|entry| entry.name).collect();
        known.sort_unstable();
        known.dedup();
        let nearest = nearest(&wanted, known.iter().copied()).map(str::to_owned);
        Err(QuantityError { wanted, nearest, known })
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
