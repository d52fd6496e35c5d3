//! The columns of mesh vertices while the mesh changes: each by its [`Nature`].

use bevy_ecs::world::World;
use froth_components::column::Column;
use froth_components::identity::StableId;
use froth_components::kind::{Kind, MeshVertex};
use froth_components::motion::{Pinned, Position};
use froth_surface::transfer::{Amounts, Change, Columns, Transfer};
use froth_surface::{PerVertex, Remap, Surface};
use glam::DVec3;

use crate::rows::registry::{ColumnEntry, ColumnRegistry, Nature};

/// All columns of mesh vertices but their positions, taken out of the world.
pub struct VertexColumns {
    blended: (Vec<ColumnEntry>, Columns),
    conserved: Vec<(ColumnEntry, Amounts)>,
    origins: Origins,
    copied: Vec<(ColumnEntry, Vec<f64>)>,
    rows: usize,
}

impl VertexColumns {
    /// Reads every column.
    #[must_use]
    pub fn take(world: &mut World, rows: usize) -> Self {
        let entries: Vec<ColumnEntry> = world.resource::<ColumnRegistry>().of_kind(MeshVertex::NAME).collect();
        let of = |nature: Nature| entries.iter().copied().filter(move |entry| entry.nature == nature);
        let blended: Vec<ColumnEntry> = of(Nature::Blended).filter(|entry| entry.name != Position::NAME).collect();
        let columns = interleaved(world, &blended, rows);
        let conserved = of(Nature::Conserved).map(|entry| (entry, Amounts::new(entry.numbers(world)))).collect();
        let copied = of(Nature::Copied).map(|entry| (entry, entry.numbers(world))).collect();
        let origins = Origins::new(rows);
        Self { blended: (blended, columns), conserved, origins, copied, rows }
    }

    /// Writes every column to as many rows as there are now. New vertices get stable ids from `next_id` on; those that the
    /// surface does not hold are free, whatever they descend from.
    pub fn put_back(self, world: &mut World, surface: &Surface, next_id: &mut u64) {
        let rows = self.origins.of.len();
        let kinds = world.resource::<ColumnRegistry>().kinds();
        let kind = kinds.iter().find(|kind| kind.name == MeshVertex::NAME).copied();
        if let Some(kind) = kind.filter(|_| rows != self.rows) {
            kind.resize(world, rows);
        }
        let (entries, columns) = self.blended;
        write_interleaved(world, &entries, &columns, rows);
        for (entry, amounts) in self.conserved {
            entry.fill(world, amounts.values());
        }
        for (entry, values) in self.copied {
            let (is_id, is_pin) = (entry.name == StableId::NAME, entry.name == Pinned::NAME);
            let value = |(origin, held): (&Origin, &bool)| {
                if origin.is_new && is_id {
                    *next_id += 1;
                    return (*next_id - 1) as f64;
                }
                if is_pin && !held { 0.0 } else { values[origin.row] }
            };
            let values: Vec<f64> = self.origins.of.iter().zip(surface.pinned.iter()).map(value).collect();
            entry.fill(world, &values);
        }
    }

    /// Conserved amounts that were lost with films that vanished as a whole, by name of the column.
    pub fn lost(&self) -> impl Iterator<Item = (&'static str, f64)> + '_ {
        self.conserved.iter().map(|(entry, amounts)| (entry.name, amounts.lost())).filter(|(_, lost)| *lost != 0.0)
    }
}

impl Transfer for VertexColumns {
    fn transfer(&mut self, surface: &Surface, change: &Change) {
        self.blended.1.transfer(surface, change);
        self.conserved.iter_mut().for_each(|(_, amounts)| amounts.transfer(surface, change));
        self.origins.transfer(surface, change);
    }

    fn slide(&mut self, surface: &Surface, slides: &PerVertex<DVec3>) {
        self.blended.1.slide(surface, slides);
        self.conserved.iter_mut().for_each(|(_, amounts)| amounts.slide(surface, slides));
    }

    fn compact(&mut self, remap: &Remap) {
        self.blended.1.compact(remap);
        self.conserved.iter_mut().for_each(|(_, amounts)| amounts.compact(remap));
        self.origins.compact(remap);
    }
}

/// The row before the pass that a vertex takes names from.
#[derive(Clone, Copy, Debug)]
struct Origin {
    row: usize,
    is_new: bool,
}

/// Where vertices come from.
struct Origins {
    of: Vec<Origin>,
}

impl Origins {
    fn new(rows: usize) -> Self {
        Self { of: (0..rows).map(|row| Origin { row, is_new: false }).collect() }
    }
}

impl Transfer for Origins {
    fn transfer(&mut self, surface: &Surface, change: &Change) {
        let known = self.of.len();
        for blend in change.blends.iter().filter(|blend| blend.vertex.index() >= known) {
            let nearest = blend.parents.iter().max_by(|a, b| a.1.total_cmp(&b.1));
            let row = nearest.map_or(0, |(parent, _)| self.of[parent.index()].row);
            self.of.push(Origin { row, is_new: true });
        }
        debug_assert_eq!(self.of.len(), surface.mesh.vertex_rows(), "every new vertex has a blend");
    }

    fn compact(&mut self, remap: &Remap) {
        remap.close_up(&mut self.of);
    }
}

fn lanes(entry: &ColumnEntry) -> usize {
    entry.lanes.len().max(1)
}

/// Several columns as one, vertex after vertex.
fn interleaved(world: &mut World, entries: &[ColumnEntry], rows: usize) -> Columns {
    let columns: Vec<(usize, Vec<f64>)> = entries.iter().map(|entry| (lanes(entry), entry.numbers(world))).collect();
    let width = columns.iter().map(|(lanes, _)| lanes).sum();
    let mut values = Vec::with_capacity(width * rows);
    for row in 0..rows {
        columns.iter().for_each(|(lanes, numbers)| values.extend(&numbers[row * lanes..(row + 1) * lanes]));
    }
    Columns::new(width, values)
}

fn write_interleaved(world: &mut World, entries: &[ColumnEntry], columns: &Columns, rows: usize) {
    let width: usize = entries.iter().map(lanes).sum();
    let mut from = 0;
    for entry in entries {
        let lanes = lanes(entry);
        let of_row = |row: usize| &columns.values()[row * width + from..row * width + from + lanes];
        let numbers: Vec<f64> = (0..rows).flat_map(of_row).copied().collect();
        entry.fill(world, &numbers);
        from += lanes;
    }
}
