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

mod air_modes;
mod breathing;
mod catenoid;
mod clusters;
mod coalescence;
mod curvature;
mod double_bubble;
mod drainage;
mod drum_in_air;
mod elastic_shape_modes;
mod equilibrium_disc;
pub mod finding;
mod foam;
mod frames;
mod marangoni_wave;
mod mesh_run;
mod minima;
mod operators;
pub mod oscillation;
mod particle_clusters;
mod particle_films;
mod pulled_double_bubble;
mod redistribution;
mod resting_bubble;
mod sampled;
mod scene_run;
mod shape_modes;
mod sheet_clusters;
mod sheet_cube;
mod sheet_energy;
mod sheet_impulse;
mod sheet_run;
mod sheet_scenes;
mod sphere_volume;
mod transfers;
mod unequal_tensions;
mod young_laplace;

use froth_components::quantity::nearest;
use froth_sheet::SheetError;
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
        name: "transfers",
        summary: "transfers between the particle sets keep liquid, surfactant, linear and angular momentum",
        source: "Deng 2022, Algorithms 1 and 4; Jiang 2015",
        measure: transfers::measure,
    },
    Law {
        name: "redistribution",
        summary: "redistribution leaves the surface and the thickness unchanged",
        source: "Deng 2022, Algorithm 5",
        measure: redistribution::measure,
    },
    Law {
        name: "young_laplace",
        summary: "the pressure in a bubble exceeds that outside by 4 sigma/R",
        source: "Young 1805, Laplace 1806, two interfaces",
        measure: young_laplace::measure,
    },
    Law {
        name: "breathing",
        summary: "a bubble breathes at omega^2 = (3 gamma p/R - 4 sigma/R^2)/(rho eta)",
        source: "Minnaert 1933 with the inertia of the film",
        measure: breathing::measure,
    },
    Law {
        name: "shape_modes",
        summary: "a bubble of film mass alone rings at omega^2 = 2 sigma (n - 1)(n + 2)/(rho eta R^2)",
        source: "Rayleigh 1879 for a film, inertia rho eta per area",
        measure: shape_modes::measure,
    },
    Law {
        name: "elastic_shape_modes",
        summary: "with liquid, real surfactant and the air's inertia it rings at the slow root of a two by two system",
        source: "derived in its file; stiff limit: inertia rho eta (1 + 4/(n (n + 1))) + m_air",
        measure: elastic_shape_modes::measure,
    },
    Law {
        name: "marangoni_wave",
        summary: "surfactant and liquid swing at c/(2 L) between walls, c^2 = 2 E/(rho eta)",
        source: "Deng 2022, Eqs 13 and 14, linearised",
        measure: marangoni_wave::measure,
    },
    Law {
        name: "drainage",
        summary: "a film at rest under gravity is eta0 exp(-rho g eta0 z/(2 E)) thick, eta0 set by the liquid",
        source: "Deng 2022, 6.1, fig. 13; rectangle, disc and hexagon",
        measure: drainage::measure,
    },
    Law {
        name: "equilibrium_disc",
        summary: "an uneven disc evens out at real elasticity and CFL 0.99",
        source: "Deng 2022, 6.2, fig. 14",
        measure: equilibrium_disc::measure,
    },
    Law {
        name: "resting_bubble",
        summary: "a bubble at rest at 1 atm, with the mass of a real film, stays at rest",
        source: "the volume is constant, speeds decay, no limit is reached",
        measure: resting_bubble::measure,
    },
    Law {
        name: "particle_clusters",
        summary: "clusters of particles come to rest with Plateau's angles and Laplace's pressures",
        source: "Deng 2022, tables 2 and 3",
        measure: particle_clusters::measure,
    },
    Law {
        name: "sphere_volume",
        summary: "a bubble on a mesh that is remeshed in every step keeps its volume",
        source: "dV/dt = 0 over 1000 steps",
        measure: sphere_volume::measure,
    },
    Law {
        name: "double_bubble",
        summary: "two unequal bubbles rest at 120 degrees, with pressures 4 sigma/R and the least area",
        source: "Plateau 1873, Laplace 1806; closed form",
        measure: double_bubble::measure,
    },
    Law {
        name: "unequal_tensions",
        summary: "films of different soaps meet at the angles of the triangle of their tensions",
        source: "Neumann 1894; closed form",
        measure: unequal_tensions::measure,
    },
    Law {
        name: "catenoid",
        summary: "a film between two rings of radius R holds up to a gap of 1.3254868 R, and pinches off beyond",
        source: "Lindelof 1863; closed form",
        measure: catenoid::measure,
    },
    Law {
        name: "coalescence",
        summary: "two equal bubbles that touch become a double bubble of area 27 pi R^2/4",
        source: "Ishida 2017; Deng 2022, fig. 13",
        measure: coalescence::measure,
    },
    Law {
        name: "pulled_double_bubble",
        summary: "a double bubble that two rings pull apart becomes two bubbles of the same volumes",
        source: "Da 2015, fig. 7",
        measure: pulled_double_bubble::measure,
    },
    Law {
        name: "foam_lattice",
        summary: "cubes in a block, four films at an edge, become a foam with three",
        source: "Plateau 1873; Da 2014",
        measure: foam::measure_lattice,
    },
    Law {
        name: "bursting_foam",
        summary: "bubbles of a foam keep their volumes while others burst",
        source: "Ishida 2017",
        measure: foam::measure_bursts,
    },
    Law {
        name: "frames",
        summary: "films in frames of wire come to the least area next to where they start",
        source: "Surface Evolver, assets/evolver",
        measure: frames::measure,
    },
    Law {
        name: "clusters",
        summary: "unequal triple and quadruple bubbles have the least area and the pressures that go with it",
        source: "Surface Evolver, assets/evolver",
        measure: clusters::measure,
    },
    Law {
        name: "air_modes",
        summary: "a bubble in air rings at omega^2 = n (n - 1)(n + 1)(n + 2) 2 sigma/((2 n + 1) rho R^3)",
        source: "Lamb 1932, §275, air on both sides",
        measure: air_modes::measure,
    },
    Law {
        name: "drum_in_air",
        summary: "a film on a ring swings in air at omega^2 = 5.8598 (2 sigma)/(rho a^3)",
        source: "derived in its file",
        measure: drum_in_air::measure,
    },
    Law {
        name: "sheet_energy",
        summary: "a bubble in air keeps the sum of its kinetic energy and that of its film",
        source: "K + 2 sigma A is constant",
        measure: sheet_energy::measure,
    },
    Law {
        name: "sheet_cube",
        summary: "a cube of film rings on in air, and settles to a sphere where it is damped",
        source: "Da 2015, figs. 4 and 8",
        measure: sheet_cube::measure,
    },
    Law {
        name: "sheet_clusters",
        summary: "clusters in air come to rest with Plateau's angles and Laplace's pressures",
        source: "Plateau 1873, Laplace 1806; closed forms",
        measure: sheet_clusters::measure,
    },
    Law {
        name: "sheet_impulse",
        summary: "a free cluster in air has the impulse that its weight gives it, and none without",
        source: "Saffman 1992, §3.2",
        measure: sheet_impulse::measure,
    },
    Law {
        name: "sheet_scenes",
        summary: "the scenes of vortex sheets run to their end, and what shall happen happens",
        source: "Da 2015, table 1",
        measure: sheet_scenes::measure,
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
    /// The flow around a sheet could not be worked out.
    #[error(transparent)]
    Sheet(#[from] SheetError),
}
