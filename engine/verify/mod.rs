//! Laws that the program is held against: expected, measured, error, tolerance, observed order of convergence.
//!
//! | to find out | see |
//! |---|---|
//! | which laws there are | [`LAWS`], the one table |
//! | what a law finds | [`finding`] |
//! | how frequencies are measured | [`oscillation`] |
//! | the laws themselves | one file per law beside this one; where a law runs a scene, that scene is in the gallery |
//!
//! `froth verify` prints the findings; `tests/laws.rs` asserts the quick ones.

mod curvature;
pub mod finding;
mod operators;
pub mod oscillation;
mod sampled;
mod scene_run;
mod shape_modes;

use froth_components::quantity::nearest;
use froth_systems::operators::conjugate_gradient::NotConverged;
use thiserror::Error;

use self::finding::Finding;
use crate::simulation::{BuildError, StepError};

/// How much work a law may do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effort {
    /// Small sizes, all laws within minutes.
    Quick,
    /// The sizes that the published bars are for.
    Full,
}

impl Effort {
    /// One of two values.
    #[must_use]
    pub fn choose<T>(self, quick: T, full: T) -> T {
        match self {
            Self::Quick => quick,
            Self::Full => full,
        }
    }
}

/// A law.
#[derive(Clone, Copy, Debug)]
pub struct Law {
    /// Name on the command line.
    pub name: &'static str,
    /// What it says, in one line.
    pub summary: &'static str,
    /// Where it comes from.
    pub source: &'static str,
    /// Measures it.
    pub measure: fn(Effort) -> Result<Vec<Finding>, LawError>,
}

/// Every law, in the order of listings.
pub const LAWS: &[Law] = &[
    Law {
        name: "operators",
        summary: "surface operators are exact for constants and linear fields, also at walls",
        source: "Deng 2022, Eqs 6, 9, 10, 21; the eigenvalues of the sphere's Laplacian are l (l + 1)/R^2",
        measure: operators::measure,
    },
    Law {
        name: "curvature",
        summary: "area and curvature of a sphere and of an ellipsoid",
        source: "kappa = div n; closed forms",
        measure: curvature::measure,
    },
    Law {
        name: "shape_modes",
        summary: "a bubble of film mass alone rings at omega^2 = 2 sigma (n - 1)(n + 2)/(rho eta R^2)",
        source: "Rayleigh 1879 for a film, inertia rho eta per area",
        measure: shape_modes::measure,
    },
];

/// The law of a name.
#[must_use]
pub fn law(name: &str) -> Option<&'static Law> {
    LAWS.iter().find(|law| law.name == name)
}

/// The name of the law most like `name`, if any is near enough to be what was meant.
#[must_use]
pub fn nearest_law(name: &str) -> Option<&'static str> {
    nearest(name, LAWS.iter().map(|law| law.name))
}

/// Why a law cannot be measured.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum LawError {
    /// Its scene cannot be built.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// Its scene stopped.
    #[error(transparent)]
    Step(#[from] StepError),
    /// A film could not be sampled evenly.
    #[error("the film cannot be sampled evenly: {0}")]
    Sampling(#[from] NotConverged),
}
