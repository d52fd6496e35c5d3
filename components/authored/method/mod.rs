//! Which method runs a scene, and its settings: one file per method, [`melp`], [`geometric_flow`] and [`vortex_sheet`];
//! [`remesh`] is what those on a mesh share.

pub mod geometric_flow;
pub mod melp;
pub mod remesh;
pub mod vortex_sheet;

use serde::Deserialize;

pub use geometric_flow::{FilmMotion, GeometricFlowSettings, Inertial, Mass, Overdamped, TensionScheme, VolumeRule};
pub use melp::{Gas, MelpSettings, Transfer};
pub use remesh::{Contact, Placement, Remesh};
pub use vortex_sheet::{Discretisation, Integrator, Kernel, PairSummation, VortexSheetSettings};

use crate::quantity::{MassPerArea, Ratio, Time, range};

/// The method of a scene, with its settings. Written `Melp(cfl: 0.99)`; a bare name takes all defaults.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[non_exhaustive]
pub enum MethodChoice {
    /// Moving Eulerian-Lagrangian particles (Deng et al. 2022).
    Melp(MelpSettings),
    /// Film mesh under its own tension, with volume constraints.
    GeometricFlow(GeometricFlowSettings),
    /// Film mesh that carries circulation, moved by the air (Da et al. 2015).
    VortexSheet(VortexSheetSettings),
}

impl MethodChoice {
    /// Which method, without its settings.
    #[must_use]
    pub fn name(&self) -> MethodName {
        match self {
            Self::Melp(_) => MethodName::Melp,
            Self::GeometricFlow(_) => MethodName::GeometricFlow,
            Self::VortexSheet(_) => MethodName::VortexSheet,
        }
    }

    /// A method with all defaults; `None` if scene files cannot choose it.
    #[must_use]
    pub fn with_defaults(name: MethodName) -> Option<Self> {
        match name {
            MethodName::Melp => Some(Self::Melp(MelpSettings::default())),
            MethodName::GeometricFlow => Some(Self::GeometricFlow(GeometricFlowSettings::default())),
            MethodName::VortexSheet => Some(Self::VortexSheet(VortexSheetSettings::default())),
            MethodName::VortexParticle => None,
        }
    }

    /// How far films flow in one step, in edges or spacings.
    #[must_use]
    pub fn cfl(&self) -> Ratio {
        match self {
            Self::Melp(settings) => settings.cfl,
            Self::GeometricFlow(settings) => settings.cfl,
            Self::VortexSheet(settings) => settings.cfl,
        }
    }

    /// Longest step that the method's own settings allow, seconds.
    #[must_use]
    pub fn longest_step(&self) -> Option<Time> {
        match self {
            Self::GeometricFlow(settings) => settings.time_step,
            Self::Melp(_) | Self::VortexSheet(_) => None,
        }
    }

    /// How films creep where they have no inertia.
    #[must_use]
    pub fn creep(&self) -> Option<Overdamped> {
        match self {
            Self::GeometricFlow(GeometricFlowSettings { motion: FilmMotion::Overdamped(creep), .. }) => Some(*creep),
            _ => None,
        }
    }

    /// Whether films have liquid that flows within them.
    #[must_use]
    pub fn has_liquid(&self) -> bool {
        match self {
            Self::Melp(settings) => settings.liquid_per_carrier > 0,
            Self::GeometricFlow(_) | Self::VortexSheet(_) => false,
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

    /// Whether its carriers are the vertices of a mesh; those of the others are particles.
    #[must_use]
    pub fn is_on_mesh(self) -> bool {
        self != Self::Melp
    }

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
        MethodChoice::with_defaults(self).is_some()
    }

    /// The method of a name as scene files write it.
    #[must_use]
    pub fn from_scene(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|method| method.in_scene() == name)
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
