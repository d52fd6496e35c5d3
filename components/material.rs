//! What the liquid and the air around are made of: one value for the whole run.

use crate::authored::liquid as authored;
use bevy_ecs::resource::Resource;

/// The film's liquid and its surfactant.
#[derive(Resource, Clone, Copy, Debug, PartialEq)]
pub struct Liquid {
    /// Density `rho`, kg/m^3.
    pub density: f64,
    /// Surface tension `sigma` of one interface at the reference concentration, N/m.
    pub surface_tension: f64,
    /// Elasticity `E = R T Gamma0` of one interface, N/m.
    pub elasticity: f64,
    /// Kinematic viscosity `nu` of the film flow in its own plane, m^2/s.
    pub viscosity: f64,
    /// Temperature `T`, K.
    pub temperature: f64,
}

/// Molar gas constant `R`, J/(mol K) (CODATA 2018, exact).
pub const GAS_CONSTANT: f64 = 8.314_462_618_153_24;

impl Liquid {
    /// `R T`, J/mol.
    #[must_use]
    pub fn thermal_energy(&self) -> f64 {
        GAS_CONSTANT * self.temperature
    }

    /// Reference concentration `Gamma0 = E / (R T)` of one interface, mol/m^2.
    #[must_use]
    pub fn reference_surfactant(&self) -> f64 {
        self.elasticity / self.thermal_energy()
    }

    /// Surface tension at concentration `surfactant`: `sigma - R T (Gamma - Gamma0)`, N/m.
    #[must_use]
    pub fn tension_at(&self, surfactant: f64) -> f64 {
        self.surface_tension + self.elasticity - self.thermal_energy() * surfactant
    }
}

impl From<authored::Liquid> for Liquid {
    fn from(liquid: authored::Liquid) -> Self {
        Self {
            density: liquid.density.si(),
            surface_tension: liquid.surface_tension.si(),
            elasticity: liquid.elasticity.si(),
            viscosity: liquid.viscosity.si(),
            temperature: liquid.temperature.si(),
        }
    }
}

impl From<authored::Atmosphere> for Atmosphere {
    fn from(air: authored::Atmosphere) -> Self {
        Self { pressure: air.pressure.si(), density: air.density.si() }
    }
}

/// The air around the film.
#[derive(Resource, Clone, Copy, Debug, PartialEq)]
pub struct Atmosphere {
    /// Absolute pressure, Pa.
    pub pressure: f64,
    /// Density, kg/m^3.
    pub density: f64,
}
