//! Settings of MELP (Deng et al. 2022).

use bevy_ecs::resource::Resource;
use serde::Deserialize;

use super::AirInertia;
use crate::quantity::{Ratio, range};

/// Settings of [`MethodChoice::Melp`](super::MethodChoice::Melp).
#[derive(Resource, Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct MelpSettings {
    /// Fraction of the particle spacing that the fastest particle may cross in one step (plain number above 0). Default 0.99.
    #[serde(deserialize_with = "range::positive")]
    pub cfl: Ratio,
    /// Material (Lagrangian) particles per carrier (Eulerian particle), 0 to 1000. Default 16. With 0 the liquid does not flow:
    /// the film moves along its normal alone, with the thickness and under the tension it has at rest.
    #[serde(deserialize_with = "range::particles_per_carrier")]
    pub liquid_per_carrier: u32,
    /// Most steps of the film's own motion (tension, gas, Marangoni flow) in one step of the liquid, 1 to 1000. The liquid moves
    /// once per step, by its mean flow. Default 8; 1 moves both together.
    #[serde(deserialize_with = "range::substeps")]
    pub substeps: u32,
    /// Inertia of the air that the film must push aside. Default [`AirInertia::Local`].
    pub air: AirInertia,
    /// Gas inside bubbles. Default [`Gas::Isothermal`].
    pub gas: Gas,
    /// How velocity goes from carriers to material particles. Default [`Transfer::Affine`].
    pub transfer: Transfer,
    /// Part of a material particle's velocity that is its old one plus the carriers' change (FLIP), 0 to 1.
    /// 0 is the transfer alone: calm and more damped; 0.95 is livelier. Default 0.
    #[serde(deserialize_with = "range::fraction")]
    pub flip: Ratio,
    /// Smoothing of velocities between neighbouring carriers in each step (XSPH), 0 to 1. Default 0.
    #[serde(deserialize_with = "range::fraction")]
    pub xsph: Ratio,
}

impl Default for MelpSettings {
    fn default() -> Self {
        Self {
            cfl: Ratio::from_si(0.99),
            liquid_per_carrier: 16,
            substeps: 8,
            air: AirInertia::Local,
            gas: Gas::Isothermal,
            transfer: Transfer::Affine,
            flip: Ratio::from_si(0.0),
            xsph: Ratio::from_si(0.0),
        }
    }
}

/// How gas inside a bubble answers a change of volume.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
pub enum Gas {
    /// `p V` constant: heat passes through the film at once.
    #[default]
    Isothermal,
    /// `p V^ratio` constant, with the ratio of specific heats (1.4 for air): no heat passes.
    Adiabatic(#[serde(deserialize_with = "range::positive")] Ratio),
}

/// How velocity goes from carriers to material particles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
pub enum Transfer {
    /// With its gradient (APIC), carried between tangent planes by the minimal rotation.
    #[default]
    Affine,
    /// Without (PIC): strongly damped, for comparison.
    Plain,
}
