//! Settings of geometric flow: films as a mesh that moves under its own tension while each bubble keeps its volume.
//!
//! The force per area of a film of tension `2 σ` (two interfaces) and mean curvature `H` (sum of the principal ones) is
//! `f = -2 σ H n + Δp n + ρ η g`, with the pressures `Δp` that keep the volumes. [`FilmMotion`] says what follows from it.

use bevy_ecs::resource::Resource;
use serde::Deserialize;

use super::{AirInertia, Remesh};
use crate::quantity::{MassPerArea, Mobility, Rate, Ratio, Time, range};

/// Settings of [`MethodChoice::GeometricFlow`](super::MethodChoice::GeometricFlow).
#[derive(Resource, Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct GeometricFlowSettings {
    /// Whether films creep or swing. Default [`FilmMotion::Overdamped`].
    pub motion: FilmMotion,
    /// How the step treats tension. Default [`TensionScheme::Implicit`].
    pub tension: TensionScheme,
    /// Part of an edge length that a vertex may move in one step, above 0 to 0.5: farther, it could pass through its
    /// neighbours. Default 0.25.
    #[serde(deserialize_with = "range::half_at_most")]
    pub cfl: Ratio,
    /// Length of every step, seconds; a step that [`cfl`](Self::cfl) or the scene's `maximum_step` forbids is shorter.
    /// Default: as long as those two allow.
    #[serde(deserialize_with = "range::positive_if_given")]
    pub time_step: Option<Time>,
    /// Whether bubbles keep their volumes. Default [`VolumeRule::Constrained`].
    pub volume: VolumeRule,
    /// How the mesh is kept fine and even, and how films meet and part.
    pub remesh: Remesh,
}

impl Default for GeometricFlowSettings {
    fn default() -> Self {
        Self {
            motion: FilmMotion::default(),
            tension: TensionScheme::Implicit,
            cfl: Ratio::from_si(0.25),
            time_step: None,
            volume: VolumeRule::Constrained,
            remesh: Remesh::default(),
        }
    }
}

/// How a film answers the force per area `f` on it.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
pub enum FilmMotion {
    /// It creeps, `u = mobility * f`: the way to equilibrium. It has no inertia and starts at rest.
    Overdamped(Overdamped),
    /// It swings, `m (du/dt + damping u) = f`, with the mass per area `m` of liquid and air.
    Inertial(Inertial),
}

impl Default for FilmMotion {
    fn default() -> Self {
        Self::Overdamped(Overdamped::default())
    }
}

/// Settings of [`FilmMotion::Overdamped`].
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Overdamped {
    /// Speed per force per area, metres per second and pascal. Default 0.1: at σ = 30 mN/m a bubble of radius `R` evens out
    /// within `R² / (8 σ mobility)`, 0.1 s at 5 cm.
    ///
    /// It sets the clock alone: `mobility * time` is what an overdamped film knows.
    #[serde(deserialize_with = "range::positive")]
    pub mobility: Mobility,
}

impl Default for Overdamped {
    fn default() -> Self {
        Self { mobility: Mobility::from_si(0.1) }
    }
}

/// Settings of [`FilmMotion::Inertial`].
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Inertial {
    /// Mass of the film per area. Default [`Mass::FromThickness`].
    pub mass: Mass,
    /// Inertia of the air that the film must push aside, on top. Default [`AirInertia::None`].
    pub air: AirInertia,
    /// Rate at which velocities fade, per second. Default 0.
    #[serde(deserialize_with = "range::not_negative")]
    pub damping: Rate,
}

impl Default for Inertial {
    fn default() -> Self {
        Self { mass: Mass::FromThickness, air: AirInertia::None, damping: Rate::from_si(0.0) }
    }
}

/// Mass of a film per area.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
pub enum Mass {
    /// `ρ η`: density of the liquid times thickness of the film.
    #[default]
    FromThickness,
    /// The same everywhere, kilograms per square metre.
    PerArea(#[serde(deserialize_with = "range::positive")] MassPerArea),
}

/// How a step treats the tension of the films.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
pub enum TensionScheme {
    /// At the end of the step, by one sparse solve: stable for any step.
    #[default]
    Implicit,
    /// At its beginning: cheaper, and stable only for steps that shrink with the edges.
    Explicit,
}

/// Whether bubbles keep their volumes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
pub enum VolumeRule {
    /// Every bubble keeps its volume: displacements are projected on those that do.
    #[default]
    Constrained,
    /// Bubbles shrink as their tension likes.
    Free,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_default_mobility_evens_a_bubble_of_five_centimetres_within_a_tenth_of_a_second() {
        // A mode of degree l of a sphere relaxes at 2 σ (l - 1)(l + 2) mobility / R²; the slowest has degree 2.
        let (tension, radius) = (0.03, 0.05_f64);
        let rate = 2.0 * tension * 4.0 * Overdamped::default().mobility.si() / radius.powi(2);
        assert!((0.05..0.2).contains(&(1.0 / rate)), "{rate}");
    }
}
