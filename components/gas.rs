//! The gas that a closed film encloses, carried by its [`Region`](crate::kind::Region).
//!
//! A region without gas of its own (the air on one side of an open film) has reference volume 0.

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
    /// Exponent `gamma` of the gas law, dimensionless: 1 isothermal, 1.4 adiabatic air.
    pub struct GasExponent(f64), "gas_exponent", "1";
}

/// An ideal gas in a closed region: `p V^gamma` is constant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IdealGas {
    /// Pressure at the reference volume, Pa.
    pub reference_pressure: f64,
    /// Reference volume, m^3.
    pub reference_volume: f64,
    /// Exponent `gamma`, dimensionless.
    pub exponent: f64,
}

impl IdealGas {
    /// The law of a region.
    #[must_use]
    pub fn of(volume: &ReferenceVolume, pressure: &ReferencePressure, exponent: &GasExponent) -> Self {
        Self { reference_pressure: pressure.0, reference_volume: volume.0, exponent: exponent.0 }
    }

    /// Pressure at `volume`, Pa.
    #[must_use]
    pub fn pressure(&self, volume: f64) -> f64 {
        self.reference_pressure * (self.reference_volume / volume).powf(self.exponent)
    }

    /// Stiffness `-dp/dV` at `volume`, Pa/m^3.
    #[must_use]
    pub fn stiffness(&self, volume: f64) -> f64 {
        self.exponent * self.pressure(volume) / volume
    }
}
