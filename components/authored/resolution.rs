//! How finely films are sampled.

use serde::Deserialize;

use crate::quantity::{Count, Length, range};

/// How finely films are sampled. One carrier (Eulerian particle, mesh vertex) stands for `spacing²` of film.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
pub enum Resolution {
    /// Distance between neighbouring carriers, metres.
    Spacing(#[serde(deserialize_with = "range::positive")] Length),
    /// Number of carriers on all films together.
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
}
