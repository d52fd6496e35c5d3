//! Which method runs a scene, and its settings.

use bevy_ecs::resource::Resource;
use serde::Deserialize;

use crate::quantity::{MassPerArea, Ratio, range};

/// The method of a scene, with its settings. Written `Melp(cfl: 0.99)`; a bare name takes all defaults.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[non_exhaustive]
pub enum MethodChoice {
    /// Moving Eulerian-Lagrangian particles (Deng et al. 2022).
    Melp(MelpSettings),
}

impl MethodChoice {
    /// Which method, without its settings.
    #[must_use]
    pub fn name(&self) -> MethodName {
        match self {
            Self::Melp(_) => MethodName::Melp,
        }
    }

    /// A method with all defaults; `None` if it is not available.
    #[must_use]
    pub fn with_defaults(name: MethodName) -> Option<Self> {
        match name {
            MethodName::Melp => Some(Self::Melp(MelpSettings::default())),
            _ => None,
        }
    }
}

/// A published method. All are known by name; not all are available.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum MethodName {
    /// Moving Eulerian-Lagrangian particles (Deng et al. 2022).
    Melp,
    /// Vortex sheets on a multi-region mesh (Da et al. 2015).
    VortexSheet,
    /// Vortex particles on a mesh (Tao et al. 2024).
    VortexParticle,
    /// Mean curvature flow with volume constraints.
    GeometricFlow,
}

impl MethodName {
    /// Every known method.
    pub const ALL: [Self; 4] = [Self::Melp, Self::VortexSheet, Self::VortexParticle, Self::GeometricFlow];

    /// Name in a scene file.
    #[must_use]
    pub fn in_scene(self) -> &'static str {
        match self {
            Self::Melp => "Melp",
            Self::VortexSheet => "VortexSheet",
            Self::VortexParticle => "VortexParticle",
            Self::GeometricFlow => "GeometricFlow",
        }
    }

    /// Name on the command line.
    #[must_use]
    pub fn on_command_line(self) -> &'static str {
        match self {
            Self::Melp => "melp",
            Self::VortexSheet => "vortex-sheet",
            Self::VortexParticle => "vortex-particle",
            Self::GeometricFlow => "geometric-flow",
        }
    }

    /// Whether [`MethodChoice`] has it.
    #[must_use]
    pub fn is_available(self) -> bool {
        self == Self::Melp
    }

    /// The method of a name as scene files write it.
    #[must_use]
    pub fn from_scene(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|method| method.in_scene() == name)
    }
}

/// Settings of [`MethodChoice::Melp`].
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

/// Air that moves with the film's normal motion, as mass per area of film.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
pub enum AirInertia {
    /// The film moves its own mass alone. Demands substeps of a millisecond or less; a wobble then fades within some tens of its
    /// periods by the implicit flow.
    None,
    /// `0.4 ρ_air R` with the size `R` of the film: an estimate, the same for all modes.
    #[default]
    Local,
    /// A mass per area of your own, kilograms per square metre.
    Fixed(#[serde(deserialize_with = "range::not_negative")] MassPerArea),
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
