//! One value per vertex and pair of regions: the circulation of Da 2015, antisymmetric in the pair.
//!
//! After an operation every touched vertex has a value for exactly the pairs whose films meet there:
//! the blend of the parents that have the pair; where a film closed a gap, the sum of the two it came from (potential jumps add
//! across the closing sheet); else the mean over neighbours that have the pair. A new pair is never filled with zero, which would be a
//! spike of vorticity. When a region joins another, films that become one are shifted by half the difference of their means.
//! Source: Da 2015, section 5.2, with the sum rule in place of the neighbour mean.

use glam::DVec3;
use smallvec::SmallVec;

use super::sliding::weights_at;
use super::{Change, Transfer};
use crate::bodies::Division;
use crate::mesh::Remap;
use crate::rows::{PerVertex, Region, VertexRow};
use crate::surface::Surface;

/// A pair of regions, smaller label first, with its value.
type Entry = ([Region; 2], f64);
type Table = SmallVec<[Entry; 3]>;

/// Values per vertex and pair of regions.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Circulations {
    tables: Vec<Table>,
}

impl Circulations {
    /// The values of a function on every film of every vertex; `value(v, i, j)` with `i < j`.
    #[must_use]
    pub fn new(surface: &Surface, value: impl Fn(VertexRow, Region, Region) -> f64) -> Self {
        let rows = (0..surface.mesh.vertex_rows() as u32).map(VertexRow);
        let table = |v| pairs_at(surface, v).into_iter().map(|pair| (pair, value(v, pair[0], pair[1]))).collect();
        Self { tables: rows.map(table).collect() }
    }

    /// The value of a pair at a vertex, if films between the two meet there; antisymmetric in the pair.
    #[must_use]
    pub fn get(&self, vertex: VertexRow, i: Region, j: Region) -> Option<f64> {
        let (pair, sign) = ordered(i, j);
        self.tables[vertex.index()].iter().find(|(other, _)| *other == pair).map(|(_, value)| sign * value)
    }

    /// The pairs of a vertex, smaller label first.
    pub fn pairs(&self, vertex: VertexRow) -> impl Iterator<Item = [Region; 2]> + '_ {
        self.tables[vertex.index()].iter().map(|(pair, _)| *pair)
    }

    fn blended(&self, parents: &[(VertexRow, f64)], pair: [Region; 2]) -> Option<f64> {
        let having = parents.iter().filter_map(|(v, weight)| Some((self.get(*v, pair[0], pair[1])?, *weight)));
        let (sum, weight) = having.fold((0.0, 0.0), |(sum, whole), (value, w)| (sum + w * value, whole + w));
        (weight > 1e-12).then(|| sum / weight)
    }

    fn fused(&self, parents: &[(VertexRow, f64)], pair: [Region; 2], change: &Change) -> Option<f64> {
        change.fused.iter().find_map(|(back, between, front)| {
            let (fused, sign) = ordered(*back, *front);
            let sum = self.summed(parents, *back, *between)? + self.summed(parents, *between, *front)?;
            (fused == pair).then_some(sign * sum)
        })
    }

    fn summed(&self, parents: &[(VertexRow, f64)], i: Region, j: Region) -> Option<f64> {
        let (pair, sign) = ordered(i, j);
        self.blended(parents, pair).map(|value| sign * value)
    }

    fn of_neighbours(&self, surface: &Surface, vertex: VertexRow, pair: [Region; 2]) -> f64 {
        let neighbours = surface.mesh.neighbours(vertex);
        let known = neighbours.iter().filter(|v| v.index() < self.tables.len());
        let values: SmallVec<[f64; 8]> = known.filter_map(|v| self.get(*v, pair[0], pair[1])).collect();
        if values.is_empty() { 0.0 } else { values.iter().sum::<f64>() / values.len() as f64 }
    }

    fn new_table(&self, surface: &Surface, vertex: VertexRow, change: &Change) -> Table {
        let itself = SmallVec::from_slice(&[(vertex, 1.0)]);
        let blend = change.blends.iter().find(|blend| blend.vertex == vertex);
        let parents = blend.map_or(&itself, |blend| &blend.parents);
        let value = |pair: [Region; 2]| {
            self.blended(parents, pair)
                .or_else(|| self.fused(parents, pair, change))
                .unwrap_or_else(|| self.of_neighbours(surface, vertex, pair))
        };
        pairs_at(surface, vertex).into_iter().map(|pair| (pair, value(pair))).collect()
    }

    /// Joins region `gone` to `into`, as a burst does: the tables first, then the pairs that are left.
    fn join(&mut self, gone: Region, into: Region) {
        for other in self.partners(gone).into_iter().filter(|other| *other != into) {
            let shift = self.difference(gone, into, other);
            for table in &mut self.tables {
                join_pair(table, gone, into, other, 0.5 * shift);
            }
        }
    }

    fn partners(&self, region: Region) -> Vec<Region> {
        let pairs = self.tables.iter().flatten().filter(|(pair, _)| pair.contains(&region));
        let mut partners: Vec<Region> =
            pairs.map(|(pair, _)| if pair[0] == region { pair[1] } else { pair[0] }).collect();
        partners.sort_unstable();
        partners.dedup();
        partners
    }

    /// Mean of `value(gone, other) - value(into, other)` over vertices that have both.
    fn difference(&self, gone: Region, into: Region, other: Region) -> f64 {
        let rows = (0..self.tables.len() as u32).map(VertexRow);
        let both = rows.filter_map(|v| Some(self.get(v, gone, other)? - self.get(v, into, other)?));
        let (sum, count) = both.fold((0.0, 0), |(sum, count), value| (sum + value, count + 1));
        if count == 0 { 0.0 } else { sum / f64::from(count) }
    }
}

/// Renames `(gone, other)` to `(into, other)` with the two films' means brought together; their mean where both meet.
fn join_pair(table: &mut Table, gone: Region, into: Region, other: Region, half: f64) {
    let (old, old_sign) = ordered(gone, other);
    let (new, new_sign) = ordered(into, other);
    let taken = table.iter().position(|(pair, _)| *pair == old).map(|i| table.remove(i).1 * old_sign - half);
    let kept = table.iter().position(|(pair, _)| *pair == new);
    if let Some(i) = kept {
        let value = table[i].1 * new_sign + half;
        table[i].1 = new_sign * taken.map_or(value, |taken| 0.5 * (taken + value));
    } else if let Some(taken) = taken {
        table.push((new, new_sign * taken));
        table.sort_unstable_by_key(|(pair, _)| *pair);
    }
}

fn ordered(i: Region, j: Region) -> ([Region; 2], f64) {
    if i < j { ([i, j], 1.0) } else { ([j, i], -1.0) }
}

/// Pairs of regions whose films meet at a vertex, ascending.
fn pairs_at(surface: &Surface, vertex: VertexRow) -> SmallVec<[[Region; 2]; 3]> {
    let faces = surface.mesh.faces_of(vertex).iter();
    let mut pairs: SmallVec<[[Region; 2]; 3]> = faces
        .map(|face| {
            let [back, front] = surface.mesh.face(*face).labels();
            ordered(back, front).0
        })
        .collect();
    pairs.sort_unstable();
    pairs.dedup();
    pairs
}

impl Transfer for Circulations {
    fn transfer(&mut self, surface: &Surface, change: &Change) {
        if let Some((gone, into)) = change.joined {
            self.join(gone, into);
        }
        self.tables.resize(surface.mesh.vertex_rows(), Table::new());
        let touched = change.areas.iter().map(|area| area.vertex);
        let tables: SmallVec<[(VertexRow, Table); 12]> =
            touched.map(|v| (v, self.new_table(surface, v, change))).collect();
        tables.into_iter().for_each(|(v, table)| self.tables[v.index()] = table);
    }

    fn divide(&mut self, surface: &Surface, divisions: &[Division]) {
        let origin = |region| divisions.iter().find(|division| division.to == region).map_or(region, |d| d.from);
        let renamed = |v: VertexRow| {
            let value = |[i, j]: [Region; 2]| self.get(v, origin(i), origin(j)).unwrap_or(0.0);
            pairs_at(surface, v).into_iter().map(|pair| (pair, value(pair))).collect()
        };
        self.tables = (0..self.tables.len() as u32).map(VertexRow).map(renamed).collect();
    }

    fn slide(&mut self, surface: &Surface, slides: &PerVertex<DVec3>) {
        let moved = |v: VertexRow| {
            let weights = weights_at(surface, v, slides[v])?;
            let value = |(pair, own): &Entry| (*pair, self.blended(&weights, *pair).unwrap_or(*own));
            Some((v, self.tables[v.index()].iter().map(value).collect::<Table>()))
        };
        let tables: Vec<(VertexRow, Table)> = surface.mesh.vertices().filter_map(moved).collect();
        tables.into_iter().for_each(|(v, table)| self.tables[v.index()] = table);
    }

    fn compact(&mut self, remap: &Remap) {
        remap.close_up(&mut self.tables);
    }
}
