//! Conserved amounts: liquid, surfactant. Their sum over all vertices stays to round-off through every operation.
//!
//! Equation: with amounts `m`, lumped film areas `A` before and `A'` after, and densities `d = m / A` (a new or moved vertex takes
//! the blend of its parents' densities), the vertices that an operation touches share their amount as
//! `m' = d A' * (sum of m) / (sum of d A')`: densities stay as they are up to one factor per operation.
//! Limits: where no vertex of an operation keeps a film, the amount is lost to the films and counted in [`Amounts::lost`].

use glam::DVec3;
use smallvec::SmallVec;

use super::sliding::exchange_areas;
use super::{AreaChange, Change, Transfer};
use crate::mesh::Remap;
use crate::rows::{PerVertex, VertexRow};
use crate::surface::Surface;

/// One conserved amount per vertex.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Amounts {
    amounts: Vec<f64>,
    lost: f64,
}

impl Amounts {
    /// Amounts of all vertices.
    #[must_use]
    pub fn new(amounts: Vec<f64>) -> Self {
        Self { amounts, lost: 0.0 }
    }

    /// The amount of every vertex.
    #[must_use]
    pub fn values(&self) -> &[f64] {
        &self.amounts
    }

    /// What films took along that vanished as a whole.
    #[must_use]
    pub fn lost(&self) -> f64 {
        self.lost
    }

    /// Amount per area of each touched vertex once the operation is done.
    fn densities(&self, change: &Change) -> SmallVec<[f64; 12]> {
        let before = |row| change.areas.iter().find(|area| area.vertex == row).map_or(0.0, |area| area.before);
        let density = |row: VertexRow| {
            let area = before(row);
            if area > 0.0 { self.amounts[row.index()] / area } else { 0.0 }
        };
        let of = |area: &AreaChange| match change.blends.iter().find(|blend| blend.vertex == area.vertex) {
            Some(blend) => blend.parents.iter().map(|(parent, weight)| weight * density(*parent)).sum(),
            None => density(area.vertex),
        };
        change.areas.iter().map(of).collect()
    }
}

impl Transfer for Amounts {
    fn transfer(&mut self, surface: &Surface, change: &Change) {
        self.amounts.resize(surface.mesh.vertex_rows(), 0.0);
        let total: f64 = change.areas.iter().map(|area| self.amounts[area.vertex.index()]).sum();
        if total == 0.0 {
            return;
        }
        let densities = self.densities(change);
        let share = |area: &AreaChange, density: f64| density * area.after;
        let mut whole: f64 = change.areas.iter().zip(&densities).map(|(area, d)| share(area, *d)).sum();
        // Without a density anywhere the area alone decides.
        let by_area = !(whole > 0.0);
        if by_area {
            whole = change.areas.iter().map(|area| area.after).sum();
        }
        if !(whole > 0.0) {
            self.lost += total;
            change.areas.iter().for_each(|area| self.amounts[area.vertex.index()] = 0.0);
            return;
        }
        for (area, density) in change.areas.iter().zip(&densities) {
            let part = if by_area { area.after } else { share(area, *density) };
            self.amounts[area.vertex.index()] = total * (part / whole);
        }
    }

    fn slide(&mut self, surface: &Surface, slides: &PerVertex<DVec3>) {
        let mut areas = vec![0.0; surface.mesh.vertex_rows()];
        for (row, face) in surface.mesh.faces().filter(|(_, face)| !face.is_ghost()) {
            face.vertices().iter().for_each(|v| areas[v.index()] += surface.area(row) / 3.0);
        }
        let density = |v: VertexRow| {
            let area = areas[v.index()];
            if area > 0.0 { self.amounts[v.index()] / area } else { 0.0 }
        };
        let mut changes = vec![0.0; self.amounts.len()];
        exchange_areas(surface, slides, |a, b, area| {
            let amount = 0.5 * (density(a) + density(b)) * area;
            changes[a.index()] += amount;
            changes[b.index()] -= amount;
        });
        self.amounts.iter_mut().zip(changes).for_each(|(amount, change)| *amount += change);
    }

    fn compact(&mut self, remap: &Remap) {
        remap.close_up(&mut self.amounts);
    }
}
