//! What drives films in one step: tension, mass, external acceleration, and where held vertices go.

use glam::DVec3;

use crate::calculus::area::vertex_integrals;
use crate::calculus::{Incidence, Weights};

/// Mass of the films.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Mass<'a> {
    /// Per film area, kg/m^2: `ρη`, with the mass of the air that moves along if wanted.
    PerArea(Weights<'a>),
    /// Per vertex row, kg: for callers who carry mass along with the vertices.
    PerVertex(&'a [f64]),
}

impl Mass<'_> {
    /// Mass of every vertex, kg.
    pub(crate) fn lump(&self, incidence: &Incidence, positions: &[DVec3], masses: &mut [f64]) {
        match self {
            Self::PerArea(weights) => vertex_integrals(incidence, positions, *weights, masses),
            Self::PerVertex(given) => masses.copy_from_slice(given),
        }
    }
}

/// External acceleration, m/s^2: gravity, wind divided by mass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Acceleration<'a> {
    /// The same everywhere.
    Uniform(DVec3),
    /// One per vertex row.
    PerVertex(&'a [DVec3]),
}

impl Acceleration<'_> {
    #[inline]
    pub(crate) fn of(&self, vertex: usize) -> DVec3 {
        match self {
            Self::Uniform(value) => *value,
            Self::PerVertex(values) => values[vertex],
        }
    }
}

/// What drives films in one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Forcing<'a> {
    /// Tension of the film, both of its faces together: `2σ`, N/m.
    pub tension: Weights<'a>,
    /// Mass.
    pub mass: Mass<'a>,
    /// External acceleration.
    pub acceleration: Acceleration<'a>,
    /// Per vertex row, where held vertices are at the end of the step, m; read at held vertices only. `None`: they stay.
    pub targets: Option<&'a [DVec3]>,
}

impl Forcing<'_> {
    /// Films of one tension (N/m) and mass per area (kg/m^2), without external acceleration, held vertices at rest.
    #[must_use]
    pub const fn uniform(tension: f64, mass_per_area: f64) -> Self {
        Self {
            tension: Weights::Uniform(tension),
            mass: Mass::PerArea(Weights::Uniform(mass_per_area)),
            acceleration: Acceleration::Uniform(DVec3::ZERO),
            targets: None,
        }
    }
}
