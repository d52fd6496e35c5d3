//! The state of a sheet: one velocity potential per vertex and region around it.
//!
//! Equation: `Gamma(i, j) = phi_j - phi_i` is the circulation around a loop that leaves region `i` through the rim, or through
//! another film, and comes back through the film from `j`. Potentials instead of circulations per pair make the table
//! antisymmetric, and add up to zero round a Plateau border, by construction.
//! Only differences at a vertex mean something: a constant per vertex is gauge, and a constant per region moves nothing.
//!
//! Beside each potential lies its [`head`](SidePotential::head), the rate at which convection changes it: the one-evaluation
//! integrator uses that of the evaluation before.

use froth_surface::{Region, VertexRow};
use serde::{Deserialize, Serialize};
use smallvec::SmallVec;

use crate::layout::Layout;

mod transfer;

/// What a region knows at a vertex.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SidePotential {
    /// The region.
    pub region: Region,
    /// Velocity potential `phi`, m^2/s.
    pub potential: f64,
    /// Rate of change of the potential by convection, m^2/s^2.
    pub head: f64,
}

type Table = SmallVec<[SidePotential; 3]>;

/// Potentials of all vertices. State of a run; follows the mesh as [`Transfer`](froth_surface::transfer::Transfer).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "bevy_ecs", derive(bevy_ecs::resource::Resource))]
pub struct Potentials {
    tables: Vec<Table>,
    /// Vertices of films that met or parted since the potentials were scattered.
    #[serde(skip)]
    met: Vec<bool>,
}

impl Potentials {
    /// A sheet at rest.
    #[must_use]
    pub fn at_rest(layout: &Layout) -> Self {
        let zeros = vec![0.0; layout.side_count()];
        Self::scattered(layout, &zeros, &zeros)
    }

    /// Potentials and heads per side as a table.
    #[must_use]
    pub fn scattered(layout: &Layout, potentials: &[f64], heads: &[f64]) -> Self {
        let at = |side: usize| SidePotential {
            region: layout.regions()[side],
            potential: potentials[side],
            head: heads[side],
        };
        let tables: Vec<Table> = (0..layout.vertex_rows()).map(|v| layout.sides_of(v).map(at).collect()).collect();
        Self { met: vec![false; tables.len()], tables }
    }

    /// Potentials and heads per side of the layout of the same mesh; regions that the table does not know get zero.
    pub fn gather(&self, layout: &Layout, potentials: &mut Vec<f64>, heads: &mut Vec<f64>) {
        potentials.clear();
        heads.clear();
        for (v, table) in self.tables.iter().enumerate() {
            for side in layout.sides_of(v) {
                let known = table.iter().find(|known| known.region == layout.regions()[side]);
                potentials.push(known.map_or(0.0, |known| known.potential));
                heads.push(known.map_or(0.0, |known| known.head));
            }
        }
    }

    /// What the regions around a vertex know, ascending by region.
    #[must_use]
    pub fn of(&self, vertex: VertexRow) -> &[SidePotential] {
        &self.tables[vertex.index()]
    }

    /// Circulation of a pair of regions at a vertex, m^2/s; antisymmetric in the pair; `None` where one of them is not there.
    #[must_use]
    pub fn circulation(&self, vertex: VertexRow, i: Region, j: Region) -> Option<f64> {
        Some(self.potential(vertex, j)? - self.potential(vertex, i)?)
    }

    /// Whether films have met or parted at the vertex, or beside it, since the potentials were scattered: circulations there are means of
    /// such as did not fit together.
    #[must_use]
    pub fn has_met(&self, vertex: VertexRow) -> bool {
        self.met.get(vertex.index()).copied().unwrap_or(false)
    }

    /// Rows of vertices.
    #[must_use]
    pub fn vertex_rows(&self) -> usize {
        self.tables.len()
    }

    fn potential(&self, vertex: VertexRow, region: Region) -> Option<f64> {
        Some(self.entry(vertex, region)?.potential)
    }

    fn entry(&self, vertex: VertexRow, region: Region) -> Option<&SidePotential> {
        self.tables.get(vertex.index())?.iter().find(|entry| entry.region == region)
    }
}

/// Subtracts the mean at every vertex: the gauge in which numbers stay small.
pub fn centre(layout: &Layout, potentials: &mut [f64]) {
    for v in 0..layout.vertex_rows() {
        let sides = layout.sides_of(v);
        let count = sides.len().max(1) as f64;
        let mean = potentials[sides.clone()].iter().sum::<f64>() / count;
        potentials[sides].iter_mut().for_each(|potential| *potential -= mean);
    }
}
