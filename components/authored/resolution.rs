//! How finely films are sampled.

use serde::Deserialize;

use crate::quantity::{Count, Length, range};

/// Area of film per vertex of a mesh of equilateral triangles, in edges squared: `√3/2`.
pub const VERTEX_AREA: f64 = 0.866_025_403_784_438_6;

/// How finely films are sampled. One Eulerian particle stands for `spacing²` of film, one mesh vertex for `√3/2 edge²`, as in a
/// mesh of equilateral triangles.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
pub enum Resolution {
    /// Distance between neighbouring carriers, metres: of particles, or of the vertices at the ends of an edge.
    Spacing(#[serde(deserialize_with = "range::positive")] Length),
    /// Number of carriers on all films together. `Vertices(4000)` is the same, and reads better with a mesh.
    #[serde(alias = "Vertices")]
    Particles(Count),
}

impl Resolution {
    /// Distance between carriers on films of a total area, metres. `area` in square metres.
    #[must_use]
    pub fn spacing(&self, area: f64) -> f64 {
        match self {
            Self::Spacing(spacing) => spacing.si(),
            Self::Particles(count) => (area / count.get() as f64).sqrt(),
        }
    }

    /// Length of the edges of a mesh on films of a total area, metres. `area` in square metres.
    #[must_use]
    pub fn edge(&self, area: f64) -> f64 {
        match self {
            Self::Spacing(spacing) => spacing.si(),
            Self::Particles(_) => self.spacing(area) / VERTEX_AREA.sqrt(),
        }
    }

    /// The resolution `factor` times as fine: the spacing divided by it, the number of carriers multiplied by its square.
    #[must_use]
    pub fn refined(&self, factor: f64) -> Self {
        match self {
            Self::Spacing(spacing) => Self::Spacing(Length::from_si(spacing.si() / factor)),
            Self::Particles(count) => {
                let refined = count.get() as f64 * factor * factor;
                Self::Particles(Count::new((refined.round() as u64).max(1)))
            }
        }
    }
}
