//! One number per face: the same everywhere, or a list.

use crate::rows::FaceRow;

/// A quantity per face, such as film tension `2σ` (N/m) or mass per area (kg/m^2).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Weights<'a> {
    /// The same on every face.
    Uniform(f64),
    /// One value per face row, vacant rows counted.
    PerFace(&'a [f64]),
}

impl Weights<'_> {
    /// The value on a face.
    #[must_use]
    #[inline]
    pub fn of(&self, face: FaceRow) -> f64 {
        match self {
            Self::Uniform(value) => *value,
            Self::PerFace(values) => values[face.index()],
        }
    }

    /// Length of the list, if it is one.
    #[must_use]
    pub fn listed(&self) -> Option<usize> {
        match self {
            Self::Uniform(_) => None,
            Self::PerFace(values) => Some(values.len()),
        }
    }
}
