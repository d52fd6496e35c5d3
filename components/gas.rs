//! The gas that a closed film encloses, carried by its [`Region`](crate::kind::Region).

use bevy_ecs::component::Component;

columns! {
    /// Volume `V` of the enclosed gas as evolved by the film's own motion, m^3. It is a state, not a measurement:
    /// the volume measured from particles carries a sampling error of 1e-3, which at 1 atm would be 100 Pa.
    pub struct GasVolume(f64), "gas_volume", "m^3";
    /// Absolute pressure of the enclosed gas, Pa.
    pub struct GasPressure(f64), "gas_pressure", "Pa";
    /// Volume `V0` at which the gas has its reference pressure, m^3.
    pub struct ReferenceVolume(f64), "reference_volume", "m^3";
    /// Pressure `p0` of the gas at its reference volume, Pa.
    pub struct ReferencePressure(f64), "reference_pressure", "Pa";
}

/// How the enclosed gas answers compression: `p V^gamma` is constant.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
pub struct GasLaw {
    /// Ratio `gamma`, dimensionless: 1 isothermal, 1.4 adiabatic air.
    pub exponent: f64,
}

impl GasLaw {
    /// Pressure at volume `v`, given pressure `p0` at volume `v0`.
    #[must_use]
    pub fn pressure(self, p0: f64, v0: f64, v: f64) -> f64 {
        p0 * (v0 / v).powf(self.exponent)
    }

    /// Stiffness `-dp/dV` at pressure `p` and volume `v`, Pa/m^3.
    #[must_use]
    pub fn stiffness(self, p: f64, v: f64) -> f64 {
        self.exponent * p / v
    }
}
