//! The liquid of the films and the air around them, one for the whole scene.

use bevy_ecs::resource::Resource;
use serde::Deserialize;

use crate::quantity::{Density, Pressure, SurfaceTension, Temperature, Viscosity, range};

/// The liquid of all films.
#[derive(Resource, Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Liquid {
    /// Density `ρ`, kilograms per cubic metre. Default 1000.
    #[serde(deserialize_with = "range::positive")]
    pub density: Density,
    /// Tension `σ` of ONE interface of the film at rest, newtons per metre. Default 30 mN/m.
    #[serde(deserialize_with = "range::interface_tension")]
    pub surface_tension: SurfaceTension,
    /// Elasticity `E = R T Γ0` of one interface, newtons per metre; 0 is a film without surfactant. Default 40 mN/m.
    #[serde(deserialize_with = "range::not_negative")]
    pub elasticity: SurfaceTension,
    /// Kinematic viscosity `ν` of the flow along the film, square metres per second. Default 0.
    #[serde(deserialize_with = "range::not_negative")]
    pub viscosity: Viscosity,
    /// Temperature, kelvins. Default 298.15.
    #[serde(deserialize_with = "range::positive")]
    pub temperature: Temperature,
}

impl Default for Liquid {
    fn default() -> Self {
        Self {
            density: Density::from_si(1000.0),
            surface_tension: SurfaceTension::from_si(0.03),
            elasticity: SurfaceTension::from_si(0.04),
            viscosity: Viscosity::from_si(0.0),
            temperature: Temperature::from_si(298.15),
        }
    }
}

/// The air around the films, and inside bubbles at rest.
#[derive(Resource, Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Atmosphere {
    /// Pressure, pascals. Default 1 atm.
    #[serde(deserialize_with = "range::positive")]
    pub pressure: Pressure,
    /// Density, kilograms per cubic metre; 0 is a vacuum to the motion. Default 1.2.
    #[serde(deserialize_with = "range::not_negative")]
    pub density: Density,
}

impl Default for Atmosphere {
    fn default() -> Self {
        Self { pressure: Pressure::from_si(101_325.0), density: Density::from_si(1.2) }
    }
}
