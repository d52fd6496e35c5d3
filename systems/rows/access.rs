//! Reading and writing whole columns.

use bevy_ecs::query::{ArchetypeFilter, ContiguousQueryData, QueryNotDenseError, With};
use bevy_ecs::system::Query;
use bevy_ecs::world::World;
use froth_components::column::Column;
use froth_components::kind::Kind;

/// The columns of a read-only query over one kind, as slices.
///
/// Panics when the kind is split over several tables: [`ColumnRegistry`](super::registry::ColumnRegistry) checks
/// that at the start of a run, so a split here is a bug.
pub fn columns<'q, D, F>(query: &'q Query<D, F>) -> <D::ReadOnly as ContiguousQueryData>::Contiguous<'q, 'q>
where
    D: ContiguousQueryData,
    D::ReadOnly: ContiguousQueryData,
    F: ArchetypeFilter,
{
    only(query.contiguous_iter())
}

/// The columns of a query over one kind; written ones as `ContiguousMut`, to be opened with
/// `bypass_change_detection`.
pub fn columns_mut<'q, D, F>(query: &'q mut Query<D, F>) -> D::Contiguous<'q, 'q>
where
    D: ContiguousQueryData,
    F: ArchetypeFilter,
{
    only(query.contiguous_iter_mut())
}

fn only<I: Iterator>(tables: Result<I, QueryNotDenseError>) -> I::Item {
    let mut tables = tables.expect("invariant: columns are stored in tables");
    let first = tables.next().expect("invariant: a system over a kind runs only where the kind exists");
    assert!(tables.next().is_none(), "invariant: all particles of a kind live in one table");
    first
}

/// A copy of column `C` of kind `K`, empty if there are no such particles.
#[must_use]
pub fn read_column<K: Kind, C: Column>(world: &mut World) -> Vec<C> {
    let mut state = world.query_filtered::<&C, With<K>>();
    let tables = state.contiguous_iter(world).expect("invariant: columns are stored in tables");
    tables.flat_map(|table| table.iter().copied()).collect()
}

/// Overwrites column `C` of kind `K`.
pub fn fill_column<K: Kind, C: Column>(world: &mut World, values: &[C]) {
    let mut state = world.query_filtered::<&mut C, With<K>>();
    let mut start = 0;
    for mut table in state.contiguous_iter_mut(world).expect("invariant: columns are stored in tables") {
        let slice = table.bypass_change_detection();
        slice.copy_from_slice(&values[start..start + slice.len()]);
        start += slice.len();
    }
    assert_eq!(start, values.len(), "invariant: one value per row of `{}`", K::NAME);
}

/// Appends `count` rows of kind `K`, every registered column at its default.
pub fn spawn_rows<K: Kind>(world: &mut World, count: usize) {
    world.spawn_batch((0..count).map(|_| K::default())).for_each(drop);
}
