//! Keeps rows in (region, Morton code) order, so that neighbours are near in memory.

use super::settings::Melp;
use crate::rows::morton::morton_code;
use crate::rows::read_column;
use crate::rows::registry::ColumnRegistry;
use bevy_ecs::world::World;
use froth_components::clock::Clock;
use froth_components::identity::{InRegion, StableId};
use froth_components::kind::{Kind, LagrangianParticle};
use froth_components::lamella::Lamellae;
use froth_components::motion::Position;
use rayon::prelude::*;

/// Sorts the material rows every few steps.
pub fn sort_material(world: &mut World) {
    let interval = world.resource::<Melp>().sort_interval;
    if world.resource::<Clock>().steps % interval == interval - 1 {
        sort_rows::<LagrangianParticle>(world);
    }
}

/// Sorts the rows of kind `K` by (region, Morton code of the place in cells of one spacing, stable id).
pub fn sort_rows<K: Kind>(world: &mut World) {
    let cell = world.resource::<Lamellae>().spacing;
    let positions = read_column::<K, Position>(world);
    let regions = read_column::<K, InRegion>(world);
    let ids = read_column::<K, StableId>(world);
    let Some(origin) = positions.iter().map(|p| p.0).reduce(glam::DVec3::min) else { return };
    let mut keys: Vec<(u32, u64, u64, u32)> = (0..positions.len())
        .into_par_iter()
        .map(|i| (regions[i].0.0, morton_code(positions[i].0, origin, cell), ids[i].0, i as u32))
        .collect();
    keys.par_sort_unstable();
    let order: Vec<u32> = keys.iter().map(|key| key.3).collect();
    ColumnRegistry::permute_rows::<K>(world, &order);
}
