//! Settings of vortex sheets: films without mass that the air around them moves, under their tension.
//!
//! `rho d(phi)/dt = -p`: tension changes the potentials of the air on the two sides of a film; Biot-Savart turns their difference, the
//! circulation, into motion.

use bevy_ecs::resource::Resource;
use serde::Deserialize;

use super::Remesh;
use crate::quantity::{Angle, Rate, Ratio, Viscosity, range};

/// Settings of [`MethodChoice::VortexSheet`](super::MethodChoice::VortexSheet).
#[derive(Resource, Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct VortexSheetSettings {
    /// How the equations become numbers on the mesh. Default [`Discretisation::Variational`].
    pub discretisation: Discretisation,
    /// How steps are made of evaluations. Default [`Integrator::Leapfrog`].
    pub integrator: Integrator,
    /// Smoothed kernel of the Biot-Savart sum. Default [`Kernel::Third`].
    pub kernel: Kernel,
    /// Smoothing length of the kernel in edge lengths, above 0. Default 0.75; below 0.5 the mesh shows.
    /// For [`Discretisation::Pointwise`] 1.0 does best with [`Kernel::Third`]; Da 2015 has 0.5 with [`Kernel::First`].
    #[serde(deserialize_with = "range::positive")]
    pub smoothing: Ratio,
    /// How pairs are summed. Default: every pair while triangles are few, by expansions to 1e-3 where they are many.
    pub summation: PairSummation,
    /// Longest substep in units of `sqrt(rho h^3 / sigma)`, `h` the shortest edge but at least two thirds of the
    /// smoothing length; above 0. Default 0.4; the leapfrog is stable to about 1.
    #[serde(deserialize_with = "range::positive")]
    pub courant: Ratio,
    /// Part of an edge length that a vertex may move in one step, and part of itself by which an edge may change, above 0 to 0.5; the mesh is
    /// mended between steps, and a substep that turns out to do more than twice as much is taken again, shorter. Default 0.25.
    #[serde(deserialize_with = "range::half_at_most")]
    pub cfl: Ratio,
    /// Kinematic diffusivity of circulation over the films, m^2/s; a mode of degree `l` on a bubble of radius `R` fades at
    /// `D l (l + 1) / (2 R^2)`. Default 0.
    #[serde(deserialize_with = "range::not_negative")]
    pub diffusivity: Viscosity,
    /// Rate at which all circulation fades, per second. Default 0.
    #[serde(deserialize_with = "range::not_negative")]
    pub damping: Rate,
    /// How the mesh slides along the films.
    pub sliding: Sliding,
    /// How the mesh is kept fine and even, and how films meet and part. Its `smoothing` is not used: see [`sliding`](Self::sliding).
    pub remesh: Remesh,
}

impl Default for VortexSheetSettings {
    fn default() -> Self {
        Self {
            discretisation: Discretisation::Variational,
            integrator: Integrator::Leapfrog,
            kernel: Kernel::Third,
            smoothing: Ratio::from_si(0.75),
            summation: PairSummation::default(),
            courant: Ratio::from_si(0.4),
            cfl: Ratio::from_si(0.25),
            diffusivity: Viscosity::from_si(0.0),
            damping: Rate::from_si(0.0),
            sliding: Sliding::default(),
            remesh: Remesh::default(),
        }
    }
}

/// How the equations become numbers on the mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
pub enum Discretisation {
    /// As a discrete Hamiltonian system: waves stay neutral on any mesh, and rest is the mesh's state of least area.
    #[default]
    Variational,
    /// Curvature and velocity at the vertices (Da 2015), for comparison. On irregular meshes its shortest waves grow unless
    /// [`diffusivity`](VortexSheetSettings::diffusivity) holds them down: some 0.002 `sqrt(2 sigma R / rho)`.
    Pointwise,
}

/// How a step is made of evaluations of the flow.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
pub enum Integrator {
    /// One evaluation, second order in small waves: half a kick by tension, a move, half a kick.
    #[default]
    Leapfrog,
    /// One evaluation, first order: a kick, then a move (Da 2015).
    SymplecticEuler,
    /// Four evaluations, fourth order.
    RungeKutta4,
    /// About ten evaluations, second order; keeps energy over many periods.
    ImplicitMidpoint,
}

/// Smoothed kernel of the Biot-Savart sum: the order in which its error goes down with the smoothing length.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
pub enum Kernel {
    /// The plain one, `1 / sqrt(r^2 + a^2)` (Da 2015).
    First,
    /// Second order.
    Second,
    /// Third order.
    #[default]
    Third,
}

/// How the Biot-Savart sum over pairs of triangles is worked out. Bounds are on the relative error of normal velocities.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
pub enum PairSummation {
    /// Every pair: cost grows with the square of the number of triangles.
    Direct,
    /// Distant groups by expansions, to a bound.
    Fast(#[serde(deserialize_with = "range::positive")] Ratio),
    /// Whichever of the two is cheaper, to a bound. Default, with 1e-3.
    Auto(#[serde(deserialize_with = "range::positive")] Ratio),
}

impl Default for PairSummation {
    fn default() -> Self {
        Self::Auto(Ratio::from_si(1e-3))
    }
}

/// How the mesh slides along the films: only where triangles need it, because it damps waves as short as the mesh.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Sliding {
    /// Part of the way to the middle of its triangles that a vertex slides per substep, 0 to 1. Default 0.1.
    #[serde(deserialize_with = "range::fraction")]
    pub strength: Ratio,
    /// Smallest angle of a triangle below which its vertices slide with full strength. Default 25 degrees.
    pub full_below: Angle,
    /// Smallest angle above which they do not slide; in between strength falls linearly. Default 40 degrees.
    pub none_above: Angle,
}

impl Default for Sliding {
    fn default() -> Self {
        Self {
            strength: Ratio::from_si(0.1),
            full_below: Angle::from_si(25f64.to_radians()),
            none_above: Angle::from_si(40f64.to_radians()),
        }
    }
}
