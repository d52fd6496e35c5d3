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
