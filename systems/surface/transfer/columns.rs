//! Values that are interpolated: velocity, concentration, anything a user's own column holds.

use glam::DVec3;

use super::sliding::weights_at;
use super::{Change, Transfer};
use crate::mesh::Remap;
use crate::rows::{PerVertex, VertexRow};
use crate::surface::Surface;

/// `lanes` numbers per vertex, vertex after vertex; split and joined vertices take the weighted mean of their parents.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Columns {
    lanes: usize,
    values: Vec<f64>,
}

impl Columns {
    /// Values of all vertices, `lanes` numbers each.
    ///
    /// # Panics
    /// When the values do not divide by the lanes.
    #[must_use]
    pub fn new(lanes: usize, values: Vec<f64>) -> Self {
        assert!(lanes == 0 || values.len().is_multiple_of(lanes), "invariant: {lanes} numbers per vertex");
        Self { lanes, values }
    }

    /// All numbers, vertex after vertex.
    #[must_use]
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// The numbers of a vertex.
    #[must_use]
    pub fn of(&self, vertex: VertexRow) -> &[f64] {
        &self.values[vertex.index() * self.lanes..(vertex.index() + 1) * self.lanes]
    }
}

impl Transfer for Columns {
    fn transfer(&mut self, surface: &Surface, change: &Change) {
        self.values.resize(surface.mesh.vertex_rows() * self.lanes, 0.0);
        // All parents are read before any vertex is written: a parent may be written by another blend.
        let mut blended = Vec::with_capacity(change.blends.len() * self.lanes);
        for blend in &change.blends {
            let lane = |lane: usize| blend.parents.iter().map(|(parent, weight)| weight * self.of(*parent)[lane]).sum();
            blended.extend((0..self.lanes).map(lane).map(|value: f64| value));
        }
        for (blend, values) in change.blends.iter().zip(blended.chunks(self.lanes.max(1))) {
            let start = blend.vertex.index() * self.lanes;
            self.values[start..start + self.lanes].copy_from_slice(values);
        }
    }

    fn slide(&mut self, surface: &Surface, slides: &PerVertex<DVec3>) {
        let old = self.clone();
        for vertex in surface.mesh.vertices() {
            let Some(weights) = weights_at(surface, vertex, slides[vertex]) else { continue };
            let start = vertex.index() * self.lanes;
            for lane in 0..self.lanes {
                self.values[start + lane] = weights.iter().map(|(v, weight)| weight * old.of(*v)[lane]).sum();
            }
        }
    }

    fn compact(&mut self, remap: &Remap) {
        let lanes = self.lanes;
        let kept = remap.vertices.iter().enumerate().filter(|(_, row)| row.is_some());
        self.values = kept.flat_map(|(old, _)| old * lanes..(old + 1) * lanes).map(|i| self.values[i]).collect();
    }
}
