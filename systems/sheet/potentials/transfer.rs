//! What becomes of potentials when the mesh changes.
//!
//! * Split, joined and moved vertices blend their parents region by region, once the parents agree on a gauge: each is
//!   shifted so that the regions they have in common have mean zero. A film that closes a gap thus gets the sum of the two
//!   circulations that met.
//! * A region that a vertex newly touches (T1 process, contact) takes its potential from the nearest vertices that know it,
//!   measured against the regions that both know. It is never filled with zero, which would be a spike of vorticity.
//! * When a film bursts, region `gone` joins `into`: the potential of `gone` is shifted by one constant (which moves
//!   nothing) so that both have the same mean where they meet, and what is left of the difference there is shared.
//!   The circulation that the burst film carried is lost with it; Da 2015, §5.3, averages likewise.
//!
//! Limits: first order where the gauge of far parents differs; new regions see one ring of neighbours.

use froth_surface::bodies::Division;
use froth_surface::transfer::{Change, Transfer};
use froth_surface::{PerVertex, Region, Remap, Surface, VertexRow};
use glam::DVec3;
use smallvec::SmallVec;

use super::{Potentials, SidePotential, Table};
use crate::layout::film_regions;

/// Parents with their weights.
type Parents = SmallVec<[(VertexRow, f64); 3]>;
/// Potential and head.
type Pair = [f64; 2];

impl Potentials {
    /// The table of a vertex after a change.
    fn renewed(&self, surface: &Surface, vertex: VertexRow, change: &Change) -> Table {
        let regions = film_regions(surface, vertex);
        let blend = change.blends.iter().find(|blend| blend.vertex == vertex);
        let parents = blend.map_or_else(|| Parents::from_slice(&[(vertex, 1.0)]), |blend| blend.parents.clone());
        let mut table = self.blended(&parents, &regions);
        for region in regions {
            if !table.iter().any(|entry| entry.region == region) {
                let [potential, head] = self.extrapolated(surface, vertex, region, &table);
                table.push(SidePotential { region, potential, head });
                table.sort_unstable_by_key(|entry| entry.region);
            }
        }
        table
    }

    /// Weighted mean of the parents, region by region, in a gauge that they share.
    fn blended(&self, parents: &[(VertexRow, f64)], regions: &[Region]) -> Table {
        let known: SmallVec<[(&Table, f64); 3]> = parents
            .iter()
            .filter(|(_, weight)| *weight != 0.0)
            .filter_map(|(v, weight)| Some((self.tables.get(v.index()).filter(|table| !table.is_empty())?, *weight)))
            .collect();
        let Some((first, _)) = known.first() else { return Table::new() };
        let in_all = |entry: &&SidePotential| known.iter().all(|(table, _)| find(table, entry.region).is_some());
        let common: SmallVec<[Region; 4]> = first.iter().filter(in_all).map(|entry| entry.region).collect();
        let gauges: SmallVec<[Pair; 3]> = known.iter().map(|(table, _)| mean(table, &common)).collect();
        let value = |region: Region| {
            let is_common = common.contains(&region);
            let (mut sum, mut whole) = ([0.0; 2], 0.0);
            for ((table, weight), gauge) in known.iter().zip(&gauges) {
                let Some(entry) = find(table, region) else { continue };
                // Of parents that are left over, those that count negative would leave next to nothing to divide by.
                let weight = if is_common { *weight } else { weight.max(0.0) };
                sum[0] += weight * (entry.potential - gauge[0]);
                sum[1] += weight * (entry.head - gauge[1]);
                whole += weight;
            }
            (whole > 0.0).then(|| SidePotential { region, potential: sum[0] / whole, head: sum[1] / whole })
        };
        regions.iter().copied().filter_map(value).collect()
    }

    /// What the neighbours say about a region that a vertex newly touches, in the gauge of the vertex's own table.
    fn extrapolated(&self, surface: &Surface, vertex: VertexRow, region: Region, own: &Table) -> Pair {
        let (mut sum, mut count) = ([0.0; 2], 0.0);
        for neighbour in surface.mesh.neighbours(vertex) {
            let Some(table) = self.tables.get(neighbour.index()) else { continue };
            let Some(entry) = find(table, region) else { continue };
            let common: SmallVec<[Region; 4]> =
                own.iter().map(|entry| entry.region).filter(|region| find(table, *region).is_some()).collect();
            let (theirs, ours) = (mean(table, &common), mean(own, &common));
            sum[0] += entry.potential - theirs[0] + ours[0];
            sum[1] += entry.head - theirs[1] + ours[1];
            count += 1.0;
        }
        if count > 0.0 { sum.map(|value| value / count) } else { mean(own, &[]) }
    }

    fn join(&mut self, gone: Region, into: Region) {
        let [shift, head_shift] = self.mean_difference(gone, into);
        for table in &mut self.tables {
            let Some(place) = table.iter().position(|entry| entry.region == gone) else { continue };
            let old = table.remove(place);
            let moved = SidePotential { region: into, potential: old.potential + shift, head: old.head + head_shift };
            match table.iter_mut().find(|entry| entry.region == into) {
                Some(entry) => {
                    entry.potential = 0.5 * (entry.potential + moved.potential);
                    entry.head = 0.5 * (entry.head + moved.head);
                }
                None => {
                    table.push(moved);
                    table.sort_unstable_by_key(|entry| entry.region);
                }
            }
        }
    }

    /// Mean of `into` less `gone` where both meet.
    fn mean_difference(&self, gone: Region, into: Region) -> Pair {
        let (mut sum, mut count) = ([0.0; 2], 0.0);
        for table in &self.tables {
            if let (Some(old), Some(new)) = (find(table, gone), find(table, into)) {
                sum[0] += new.potential - old.potential;
                sum[1] += new.head - old.head;
                count += 1.0;
            }
        }
        if count > 0.0 { sum.map(|value| value / count) } else { sum }
    }
}

fn find(table: &[SidePotential], region: Region) -> Option<&SidePotential> {
    table.iter().find(|entry| entry.region == region)
}

/// Mean over the listed regions; over all where none is listed.
fn mean(table: &[SidePotential], regions: &[Region]) -> Pair {
    let listed = table.iter().filter(|entry| regions.is_empty() || regions.contains(&entry.region));
    let (sum, count) = listed
        .fold(([0.0; 2], 0.0), |(sum, count), entry| ([sum[0] + entry.potential, sum[1] + entry.head], count + 1.0));
    if count > 0.0 { sum.map(|value| value / count) } else { sum }
}

impl Transfer for Potentials {
    fn transfer(&mut self, surface: &Surface, change: &Change) {
        if let Some((gone, into)) = change.joined {
            self.join(gone, into);
        }
        self.tables.resize(surface.mesh.vertex_rows(), Table::new());
        let touched = change.areas.iter().map(|area| area.vertex);
        let tables: SmallVec<[(VertexRow, Table); 12]> =
            touched.map(|v| (v, self.renewed(surface, v, change))).collect();
        tables.into_iter().for_each(|(v, table)| self.tables[v.index()] = table);
        self.met.resize(self.tables.len(), false);
        if change.meets {
            change.areas.iter().for_each(|area| self.met[area.vertex.index()] = true);
        }
    }

    fn divide(&mut self, surface: &Surface, divisions: &[Division]) {
        let origin = |region| divisions.iter().find(|division| division.to == region).map_or(region, |d| d.from);
        let renamed = |v: VertexRow| {
            let entry = |region| Some(SidePotential { region, ..*find(&self.tables[v.index()], origin(region))? });
            film_regions(surface, v).into_iter().filter_map(entry).collect()
        };
        self.tables = (0..self.tables.len() as u32).map(VertexRow).map(renamed).collect();
    }

    /// Slides are part of a sheet's own motion, which convects potentials exactly: none comes from outside.
    fn slide(&mut self, _: &Surface, _: &PerVertex<DVec3>) {}

    fn compact(&mut self, remap: &Remap) {
        remap.close_up(&mut self.tables);
        remap.close_up(&mut self.met);
    }
}
