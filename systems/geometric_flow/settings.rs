//! How the flow runs: the scene's settings in SI units.

use bevy_ecs::resource::Resource;
use froth_components::authored::method::{
    AirInertia, FilmMotion, GeometricFlowSettings, Mass, TensionScheme, VolumeRule,
};
use froth_components::material::Atmosphere;
use froth_surface::flow::{Motion, Scheme, Settings, Tangential};

/// Mass of the films.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FilmMass {
    /// That of their liquid.
    Liquid,
    /// The same per area everywhere, kg/m^2.
    PerArea(f64),
}

/// Settings of the flow. Constant in a run.
#[derive(Resource, Clone, Copy, Debug)]
pub struct FlowRules {
    /// Knobs of a step.
    pub settings: Settings,
    /// Part of an edge length that a vertex may move in one step.
    pub cfl: f64,
    /// Length of every step, s; infinite for as long as `cfl` allows.
    pub step: f64,
    /// Mass of the films.
    pub mass: FilmMass,
    /// Air that moves along with the film, kg/m^2.
    pub air_mass: f64,
    /// Whether bubbles keep their volumes.
    pub keeps_volumes: bool,
}

impl FlowRules {
    /// The rules of a scene. `size`: that of its films, metres; the air that moves along grows with it.
    #[must_use]
    pub fn new(authored: &GeometricFlowSettings, air: Atmosphere, size: f64) -> Self {
        let mut settings = Settings {
            tangential: Tangential::Remove,
            scheme: match authored.tension {
                TensionScheme::Implicit => Scheme::Implicit,
                TensionScheme::Explicit => Scheme::Explicit,
            },
            ..Settings::default()
        };
        let (mut mass, mut air_mass) = (FilmMass::Liquid, 0.0);
        match authored.motion {
            FilmMotion::Overdamped(creep) => settings.motion = Motion::Overdamped { mobility: creep.mobility.si() },
            FilmMotion::Inertial(swing) => {
                settings.motion = Motion::Inertial;
                settings.damping_rate = swing.damping.si();
                mass = match swing.mass {
                    Mass::FromThickness => FilmMass::Liquid,
                    Mass::PerArea(mass) => FilmMass::PerArea(mass.si()),
                };
                air_mass = match swing.air {
                    AirInertia::None => 0.0,
                    AirInertia::Local => 0.4 * air.density * size,
                    AirInertia::Fixed(mass) => mass.si(),
                };
            }
        }
        Self {
            settings,
            cfl: authored.cfl.si(),
            step: authored.time_step.map_or(f64::INFINITY, |step| step.si()),
            mass,
            air_mass,
            keeps_volumes: authored.volume == VolumeRule::Constrained,
        }
    }

    /// Whether films have inertia.
    #[must_use]
    pub fn is_inertial(&self) -> bool {
        self.settings.motion == Motion::Inertial
    }
}
