//! The registry of columns: the one description that row permutation, checkpoints and export use.

use bevy_ecs::entity::Entity;
use bevy_ecs::query::With;
use bevy_ecs::resource::Resource;
use bevy_ecs::world::World;
use froth_components::column::{Column, Plain};
use froth_components::identity::StableId;
use froth_components::kind::Kind;
use rayon::prelude::*;

/// Rows per parallel piece of work.
const CHUNK: usize = 16_384;

/// Every column of every kind, in the order of registration.
#[derive(Resource, Default)]
pub struct ColumnRegistry {
    entries: Vec<ColumnEntry>,
    kinds: Vec<KindEntry>,
}

/// What the registry knows of one kind.
#[derive(Clone, Copy)]
pub struct KindEntry {
    /// Name of the kind.
    pub name: &'static str,
    count: fn(&mut World) -> usize,
    spawn: fn(&mut World, usize),
    clear: fn(&mut World),
    cut: fn(&mut World, usize),
}

/// What becomes of a column's values where a mesh splits and joins vertices.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Nature {
    /// They blend: a value per place, such as velocity or thickness.
    Blended,
    /// They are shared out, and their sum stays: an amount, such as liquid volume.
    Conserved,
    /// They are handed on whole: a number that is a name.
    Copied,
}

impl KindEntry {
    /// Number of rows.
    #[must_use]
    pub fn count(&self, world: &mut World) -> usize {
        (self.count)(world)
    }

    /// Appends or removes rows at the end until there are `count`; new ones have every column at its default.
    pub fn resize(&self, world: &mut World, count: usize) {
        let now = self.count(world);
        if count > now {
            (self.spawn)(world, count - now);
        } else {
            (self.cut)(world, now - count);
        }
    }

    /// Replaces all rows by `count` new ones, every column at its default.
    pub fn respawn(&self, world: &mut World, count: usize) {
        (self.clear)(world);
        (self.spawn)(world, count);
    }
}

/// What the registry knows of one column.
#[derive(Clone, Copy)]
pub struct ColumnEntry {
    /// Name of the kind.
    pub kind: &'static str,
    /// Name of the column.
    pub name: &'static str,
    /// SI unit.
    pub unit: &'static str,
    /// What becomes of its values where vertices are split and joined.
    pub nature: Nature,
    /// Names of the scalars in a value; empty for a single one.
    pub lanes: &'static [&'static str],
    /// Bytes per row when saved.
    pub row_bytes: usize,
    rows: fn(&mut World) -> Vec<usize>,
    permute: fn(&mut World, &[u32]),
    save: fn(&mut World) -> Vec<u8>,
    load: fn(&mut World, &[u8]),
    numbers: fn(&mut World) -> Vec<f64>,
    fill: fn(&mut World, &[f64]),
    first_not_finite: fn(&mut World) -> Option<usize>,
    stable_id: fn(&mut World, usize) -> Option<u64>,
}

impl ColumnEntry {
    /// The column as little-endian bytes, row after row.
    #[must_use]
    pub fn save(&self, world: &mut World) -> Vec<u8> {
        (self.save)(world)
    }

    /// Overwrites the column with what [`ColumnEntry::save`] gave; the rows must exist.
    pub fn load(&self, world: &mut World, bytes: &[u8]) {
        (self.load)(world, bytes);
    }

    /// The column as numbers, row after row, lane after lane.
    #[must_use]
    pub fn numbers(&self, world: &mut World) -> Vec<f64> {
        (self.numbers)(world)
    }

    /// Overwrites the column with numbers as [`ColumnEntry::numbers`] gives them. Whole numbers are exact up to 2^53.
    pub fn fill(&self, world: &mut World, numbers: &[f64]) {
        (self.fill)(world, numbers);
    }

    /// The first row whose value has a NaN or an infinity.
    #[must_use]
    pub fn first_not_finite(&self, world: &mut World) -> Option<usize> {
        (self.first_not_finite)(world)
    }

    /// Stable id of the particle in a row of this column's kind; `None` where the kind has no such ids.
    #[must_use]
    pub fn stable_id(&self, world: &mut World, row: usize) -> Option<u64> {
        (self.stable_id)(world, row)
    }
}

/// A kind whose entities do not all live in one table.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "the {kind} particles are split over {tables} tables: column `{column}` was given to some of them only; \
     register it for the whole kind instead"
)]
pub struct SplitKind {
    /// Name of the kind.
    pub kind: &'static str,
    /// The column that showed the split.
    pub column: &'static str,
    /// Number of non-empty tables.
    pub tables: usize,
}

impl ColumnRegistry {
    /// Gives every future entity of kind `K` the column `C`, and notes it for sorting, checkpoints and export.
    /// A second registration of the same pair changes nothing.
    pub fn register<K: Kind, C: Column + Default>(world: &mut World) {
        let nature = if C::Value::BLENDS { Nature::Blended } else { Nature::Copied };
        Self::register_as::<K, C>(world, nature);
    }

    /// As [`ColumnRegistry::register`], for an amount whose sum over all rows stays where rows are split and joined.
    pub fn register_conserved<K: Kind, C: Column + Default>(world: &mut World) {
        Self::register_as::<K, C>(world, Nature::Conserved);
    }

    fn register_as<K: Kind, C: Column + Default>(world: &mut World, nature: Nature) {
        let registered = |e: &ColumnEntry| e.kind == K::NAME && e.name == C::NAME;
        if world.get_resource_or_init::<Self>().entries.iter().any(registered) {
            return;
        }
        world.register_required_components::<K, C>();
        let mut registry = world.resource_mut::<Self>();
        if registry.kinds.iter().all(|kind| kind.name != K::NAME) {
            let (count, spawn, clear) = (count_rows::<K>, super::spawn_rows::<K>, despawn_rows::<K>);
            registry.kinds.push(KindEntry { name: K::NAME, count, spawn, clear, cut: cut_rows::<K> });
        }
        registry.entries.push(ColumnEntry {
            kind: K::NAME,
            name: C::NAME,
            unit: C::UNIT,
            nature,
            lanes: C::Value::LANES,
            row_bytes: C::Value::byte_len(),
            rows: table_rows::<K, C>,
            permute: permute_column::<K, C>,
            save: save_column::<K, C>,
            load: load_column::<K, C>,
            numbers: column_numbers::<K, C>,
            fill: fill_numbers::<K, C>,
            first_not_finite: first_not_finite::<K, C>,
            stable_id: stable_id::<K>,
        });
    }

    /// All columns.
    #[must_use]
    pub fn entries(&self) -> &[ColumnEntry] {
        &self.entries
    }

    /// All kinds that have columns.
    #[must_use]
    pub fn kinds(&self) -> &[KindEntry] {
        &self.kinds
    }

    /// Creates the table of every kind, in the order of registration. Queries over several kinds visit tables in the order
    /// of their creation: a run and its resumption must agree on it.
    pub fn create_tables(world: &mut World) {
        let kinds = world.get_resource_or_init::<Self>().kinds.clone();
        for kind in kinds {
            kind.respawn(world, 1);
            kind.respawn(world, 0);
        }
    }

    /// The columns of the kind called `kind`.
    pub fn of_kind<'a>(&'a self, kind: &'a str) -> impl Iterator<Item = ColumnEntry> + 'a {
        self.entries.iter().copied().filter(move |entry| entry.kind == kind)
    }

    /// Checks that every kind lives in one table.
    ///
    /// # Errors
    /// [`SplitKind`] names the kind and the column that only some of its entities carry.
    pub fn check_tables(world: &mut World) -> Result<(), SplitKind> {
        let entries = world.get_resource_or_init::<Self>().entries.clone();
        for entry in entries {
            let tables = (entry.rows)(world).iter().filter(|&&rows| rows > 0).count();
            if tables > 1 {
                return Err(SplitKind { kind: entry.kind, column: entry.name, tables });
            }
        }
        Ok(())
    }

    /// Permutes the rows of kind `K`: new row `i` holds what was in row `order[i]`.
    pub fn permute_rows<K: Kind>(world: &mut World, order: &[u32]) {
        let entries: Vec<ColumnEntry> = world.resource::<Self>().of_kind(K::NAME).collect();
        for entry in entries {
            (entry.permute)(world, order);
        }
    }
}

fn table_rows<K: Kind, C: Column>(world: &mut World) -> Vec<usize> {
    let mut state = world.query_filtered::<&C, With<K>>();
    state.contiguous_iter(world).expect("invariant: columns are stored in tables").map(<[C]>::len).collect()
}

fn permute_column<K: Kind, C: Column>(world: &mut World, order: &[u32]) {
    let mut state = world.query_filtered::<&mut C, With<K>>();
    for mut table in state.contiguous_iter_mut(world).expect("invariant: columns are stored in tables") {
        let column = table.bypass_change_detection();
        if column.is_empty() {
            continue;
        }
        let sorted: Vec<C> = order.par_iter().map(|&old| column[old as usize]).collect();
        column.copy_from_slice(&sorted);
    }
}

fn save_column<K: Kind, C: Column>(world: &mut World) -> Vec<u8> {
    let column = super::read_column::<K, C>(world);
    let mut bytes = Vec::with_capacity(column.len() * C::Value::byte_len());
    column.iter().for_each(|value| value.value().write_le(&mut bytes));
    bytes
}

fn load_column<K: Kind, C: Column>(world: &mut World, bytes: &[u8]) {
    let values: Vec<C> =
        bytes.chunks_exact(C::Value::byte_len()).map(|raw| C::from_value(C::Value::read_le(raw))).collect();
    super::fill_column::<K, C>(world, &values);
}

fn column_numbers<K: Kind, C: Column>(world: &mut World) -> Vec<f64> {
    let mut numbers = Vec::new();
    super::read_column::<K, C>(world).iter().for_each(|value| value.value().push_lanes(&mut numbers));
    numbers
}

fn fill_numbers<K: Kind, C: Column>(world: &mut World, numbers: &[f64]) {
    let lanes = C::Value::LANES.len().max(1);
    let values: Vec<C> = numbers.chunks_exact(lanes).map(|lanes| C::from_value(C::Value::from_lanes(lanes))).collect();
    super::fill_column::<K, C>(world, &values);
}

fn first_not_finite<K: Kind, C: Column>(world: &mut World) -> Option<usize> {
    let mut state = world.query_filtered::<&C, With<K>>();
    let tables = state.contiguous_iter(world).expect("invariant: columns are stored in tables");
    let mut start = 0;
    for table in tables {
        let in_chunk = |chunk: &[C]| chunk.iter().position(|value| !value.value().is_finite());
        let chunks = table.par_chunks(CHUNK).enumerate();
        let found = chunks.filter_map(|(k, chunk)| Some(k * CHUNK + in_chunk(chunk)?)).find_first(|_| true);
        if let Some(row) = found {
            return Some(start + row);
        }
        start += table.len();
    }
    None
}

fn stable_id<K: Kind>(world: &mut World, row: usize) -> Option<u64> {
    let mut state = world.query_filtered::<&StableId, With<K>>();
    state.contiguous_iter(world).expect("invariant: columns are stored in tables").flatten().nth(row).map(|id| id.0)
}

fn count_rows<K: Kind>(world: &mut World) -> usize {
    world.query_filtered::<(), With<K>>().iter(world).count()
}

/// Removes the last rows: no other row changes its place.
fn cut_rows<K: Kind>(world: &mut World, count: usize) {
    let mut state = world.query_filtered::<Entity, With<K>>();
    let rows: Vec<Entity> = state.iter(world).collect();
    for row in rows[rows.len() - count..].iter().rev() {
        world.despawn(*row);
    }
}

fn despawn_rows<K: Kind>(world: &mut World) {
    let mut state = world.query_filtered::<Entity, With<K>>();
    let rows: Vec<Entity> = state.iter(world).collect();
    for row in rows {
        world.despawn(row);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rows::{fill_column, read_column, spawn_rows};
    use froth_components::kind::EulerianParticle;
    use froth_components::motion::{Position, Velocity};
    use glam::DVec3;

    fn three_rows() -> World {
        let mut world = World::new();
        ColumnRegistry::register::<EulerianParticle, StableId>(&mut world);
        ColumnRegistry::register::<EulerianParticle, Position>(&mut world);
        spawn_rows::<EulerianParticle>(&mut world, 3);
        fill_column::<EulerianParticle, _>(&mut world, &[StableId(7), StableId(8), StableId(9)]);
        fill_column::<EulerianParticle, _>(&mut world, &[0.0, 1.0, 2.0].map(|v| Position(DVec3::splat(v))));
        world
    }

    #[test]
    fn permuting_rows_moves_every_column_alike() {
        let mut world = three_rows();
        ColumnRegistry::permute_rows::<EulerianParticle>(&mut world, &[2, 0, 1]);
        assert_eq!(read_column::<EulerianParticle, StableId>(&mut world), [StableId(9), StableId(7), StableId(8)]);
        assert_eq!(read_column::<EulerianParticle, Position>(&mut world)[0], Position(DVec3::splat(2.0)));
    }

    #[test]
    fn a_saved_column_is_loaded_bit_for_bit() {
        let mut world = three_rows();
        let entries = world.resource::<ColumnRegistry>().entries().to_vec();
        let saved: Vec<Vec<u8>> = entries.iter().map(|e| e.save(&mut world)).collect();
        let mut other = three_rows();
        fill_column::<EulerianParticle, _>(&mut other, &[Position(DVec3::NAN); 3]);
        entries.iter().zip(&saved).for_each(|(e, bytes)| e.load(&mut other, bytes));
        assert_eq!(saved[1], entries[1].save(&mut other));
    }

    #[test]
    fn a_component_on_some_particles_only_is_reported() {
        let mut world = three_rows();
        assert_eq!(ColumnRegistry::check_tables(&mut world), Ok(()));
        world.spawn((EulerianParticle, Velocity(DVec3::ZERO)));
        let split = ColumnRegistry::check_tables(&mut world).expect_err("a split table");
        assert_eq!((split.kind, split.tables), ("eulerian", 2));
    }
}
