//! What lives on between steps.

use std::collections::BTreeMap;

use glam::DVec3;
use serde::{Deserialize, Serialize};

use crate::calculus::Incidence;
use crate::calculus::volume::volumes;
use crate::rows::{PerVertex, Region};
use crate::surface::Surface;

/// State of the flow besides the surface itself.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FlowState {
    /// Velocity of each vertex, m/s. Whoever changes rows of the mesh carries them along.
    pub velocities: PerVertex<DVec3>,
    /// Pressure of each closed region above the outside, Pa.
    pub pressures: BTreeMap<Region, f64>,
    /// Volume that each closed region shall have, m^3.
    pub target_volumes: BTreeMap<Region, f64>,
}

impl FlowState {
    /// Everything at rest: targets are the volumes of the surface, pressures 0.
    #[must_use]
    pub fn at_rest(surface: &Surface) -> Self {
        let mut state = Self { velocities: PerVertex(vec![DVec3::ZERO; surface.positions.len()]), ..Self::default() };
        state.adopt_regions(surface);
        state
    }

    /// Follows a change of regions: those that vanished are forgotten, new ones keep the volume they have now.
    pub fn adopt_regions(&mut self, surface: &Surface) {
        let closed: Vec<Region> =
            surface.mesh.regions().into_iter().filter(|region| !surface.is_open(*region)).collect();
        self.pressures.retain(|region, _| closed.binary_search(region).is_ok());
        self.target_volumes.retain(|region, _| closed.binary_search(region).is_ok());
        closed.iter().for_each(|region| _ = self.pressures.entry(*region).or_insert(0.0));
        if closed.iter().all(|region| self.target_volumes.contains_key(region)) {
            return;
        }
        let mut found = Vec::new();
        volumes(&Incidence::new(surface), &surface.positions, &mut found);
        for (region, volume) in closed.iter().zip(found) {
            self.target_volumes.entry(*region).or_insert(volume);
        }
    }
}
