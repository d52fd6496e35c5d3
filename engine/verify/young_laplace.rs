//! The pressure in a bubble.
//!
//! # Equation
//! `p - p_out = 4 sigma/R`. A bubble filled to `p` at the radius `R0` grows to the `R` at which
//! `p (R0/R)^3 = p_out + 4 sigma(R)/R`; liquid and surfactant stay on it, so `sigma(R) = sigma + E (1 - (R0/R)^2)`
//! where the film carries them, and `sigma(R) = sigma` in a film without material particles.

use froth_components::gas::{GasExponent, GasVolume, IdealGas, ReferencePressure, ReferenceVolume};
use froth_components::kind::Region;
use froth_components::material::Atmosphere;

use super::finding::{Finding, Refinement};
use super::scene_run::SceneRun;
use super::{Effort, LawError};
use crate::simulation::Simulation;

const RADIUS: f64 = 0.05;
const TENSION: f64 = 0.03;
const OUTSIDE: f64 = 101_325.0;

/// How a bubble begins.
struct Case {
    what: &'static str,
    /// Of the gas, relative to that at rest.
    pressure: f64,
    /// Of one interface, N/m; 0 without material particles.
    elasticity: f64,
}

const CASES: [Case; 3] = [
    Case { what: "at rest", pressure: 1.0, elasticity: 0.04 },
    Case { what: "filled 1 % too full, uniform tension", pressure: 1.01, elasticity: 0.0 },
    Case { what: "filled 1 % too full, stretched surfactant", pressure: 1.01, elasticity: 0.04 },
];

pub(super) fn measure(effort: Effort) -> Result<Vec<Finding>, LawError> {
    let counts: &[u32] = effort.choose(&[300, 600, 1200], &[1000, 2000, 4000]);
    let finding = |case: &Case| {
        let expected = case.excess_pressure();
        let mut measured = f64::NAN;
        let mut refinement = Refinement::default();
        for count in counts {
            measured = case.relaxed(*count)?;
            refinement.add(1.0 / f64::from(*count).sqrt(), measured / expected - 1.0);
        }
        let finding = Finding::relative(format!("excess pressure, {}, Pa", case.what), expected, measured, 2e-3);
        Ok(finding.converging(&refinement, 0.0))
    };
    CASES.iter().map(finding).collect()
}

impl Case {
    fn tension(&self, radius: f64) -> f64 {
        TENSION + self.elasticity * (1.0 - (RADIUS / radius).powi(2))
    }

    /// `4 sigma/R` at the radius where film and gas are in balance, by bisection.
    fn excess_pressure(&self) -> f64 {
        let filled = self.pressure * (OUTSIDE + 4.0 * TENSION / RADIUS);
        let film = |radius: f64| 4.0 * self.tension(radius) / radius;
        let surplus = |radius: f64| filled * (RADIUS / radius).powi(3) - OUTSIDE - film(radius);
        let (mut small, mut large) = (0.9 * RADIUS, 1.1 * RADIUS);
        for _ in 0..200 {
            let middle = 0.5 * (small + large);
            if surplus(middle) > 0.0 { small = middle } else { large = middle }
        }
        film(small)
    }

    /// Excess pressure after relaxing, Pa.
    fn relaxed(&self, count: u32) -> Result<f64, LawError> {
        let per_carrier = if self.elasticity > 0.0 { 8 } else { 0 };
        let scene = SceneRun::of("resting_bubble").with("Particles(1000)", &format!("Particles({count})"));
        let scene = scene.with("liquid_per_carrier: 8", &format!("liquid_per_carrier: {per_carrier}"));
        let mut simulation = scene.with("normal: \"2 1/s\"", "normal: \"200 1/s\"").begin()?;
        let references = simulation.column::<Region, ReferencePressure>();
        let filled: Vec<_> = references.iter().map(|p| ReferencePressure(p.0 * self.pressure)).collect();
        simulation.set_column::<Region, _>(&filled);
        let mut pressures = Vec::new();
        while !simulation.has_reached(0.1) {
            let next = (simulation.time() + 2e-3).min(0.1);
            simulation.step_within(next)?;
            if simulation.time() > 0.07 {
                pressures.push(excess_pressure(&mut simulation));
            }
        }
        Ok(pressures.iter().sum::<f64>() / pressures.len() as f64)
    }
}

/// Pressure of the gas at its volume at the end of the step, less that outside, Pa.
fn excess_pressure(simulation: &mut Simulation) -> f64 {
    let law = IdealGas {
        reference_pressure: simulation.column::<Region, ReferencePressure>()[0].0,
        reference_volume: simulation.column::<Region, ReferenceVolume>()[0].0,
        exponent: simulation.column::<Region, GasExponent>()[0].0,
    };
    let outside = simulation.world().resource::<Atmosphere>().pressure;
    law.pressure(simulation.column::<Region, GasVolume>()[0].0) - outside
}
