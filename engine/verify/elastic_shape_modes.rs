//! Small oscillations of a bubble whose liquid and surfactant move with it.
//!
//! # Equation
//! Normal displacement `zeta Y`, tangential displacement `R y grad Y`, `Y` of degree `n`, `N = n (n + 1)`. The flow crowds
//! the surfactant by `N y/R`, the swelling spreads it by `2 zeta/R`: `Gamma'/Gamma0 = (N y - 2 zeta)/R`,
//! `sigma' = -E Gamma'/Gamma0`. Then
//!
//! ```text
//! (rho eta + m_air) zeta'' = -2 sigma (n - 1)(n + 2)/R^2 zeta + 4 E/R^2 (N y - 2 zeta)
//!  rho eta          y''    =                                  - 2 E/R^2 (N y - 2 zeta)
//! ```
//!
//! In the limit of a stiff surfactant `y = 2 zeta/N`: the liquid runs from the troughs to the crests, and the inertia is
//! `rho eta (1 + 4/N) + m_air`.

use froth_components::film::Surfactant;
use froth_components::kind::EulerianParticle;
use froth_components::material::Liquid;
use froth_components::motion::Position;
use froth_systems::sampling::harmonic::Harmonic;
use std::f64::consts::{PI, TAU};

use super::finding::{Finding, Refinement};
use super::oscillation::Oscillation;
use super::scene_run::{SceneRun, series, shape_amplitude};
use super::{Effort, LawError};
use crate::simulation::Simulation;

const RADIUS: f64 = 0.05;
const TENSION: f64 = 0.03;
const ELASTICITY: f64 = 0.04;
const MASS: f64 = 1000.0 * 400e-9;
const AIR: f64 = 0.4 * 1.2 * RADIUS;
const PERIODS: f64 = 1.25;

pub(super) fn measure(effort: Effort) -> Result<Vec<Finding>, LawError> {
    let (air, bare) = (Inertia::air(), Inertia::bare());
    let mut findings = Vec::new();
    for degree in [2, 3, 4] {
        findings.push(air.finding(degree, effort.choose(&[400, 800, 1600], &[1000, 2000, 4000]))?);
    }
    for degree in effort.choose(&[2][..], &[2, 3, 4]) {
        findings.push(bare.finding(*degree, effort.choose(&[300, 600, 1200], &[1000, 2000, 4000]))?);
    }
    Ok(findings)
}

/// What moves with the film along its normal.
struct Inertia {
    what: &'static str,
    in_scene: &'static str,
    /// Of the air, kg/m^2.
    mass: f64,
    /// Longest step as a part of the spacing over the speed of waves in the bare film.
    courant: f64,
}

impl Inertia {
    const fn air() -> Self {
        Self { what: "with the air's inertia", in_scene: "Local", mass: AIR, courant: f64::INFINITY }
    }

    const fn bare() -> Self {
        Self { what: "of bare film mass", in_scene: "None", mass: 0.0, courant: 0.2 }
    }

    fn finding(&self, degree: u32, counts: &[u32]) -> Result<Finding, LawError> {
        let exact = slow_frequency(degree, self.mass);
        let mut refinement = Refinement::default();
        let mut measured = f64::NAN;
        for count in counts {
            measured = self.ring(degree, *count, exact)?.frequency;
            refinement.add(1.0 / f64::from(*count).sqrt(), measured / exact - 1.0);
        }
        let what = format!("frequency n = {degree} {}, Hz", self.what);
        Ok(Finding::relative(what, exact / TAU, measured / TAU, 0.02).converging(&refinement, 1.5))
    }

    fn ring(&self, degree: u32, count: u32, exact: f64) -> Result<Oscillation, LawError> {
        let scene = SceneRun::of("elastic_shape_mode").with("degree: 2", &format!("degree: {degree}"));
        let scene = scene.with("Particles(2000)", &format!("Particles({count})"));
        let mut simulation = scene.with("air: Local", &format!("air: {}", self.in_scene)).begin()?;
        let harmonic = Harmonic::new(degree, 0);
        let (period, root) = (TAU / exact, f64::from(count).sqrt());
        let spacing = (4.0 * PI).sqrt() * RADIUS / root;
        let step = (0.7 / root * period).min(self.courant * spacing / (2.0 * TENSION / MASS).sqrt());
        let [shape, crowding] = slow_part(degree, self.mass, exact);
        let samples = series(&mut simulation, step, PERIODS * period, |sim| {
            shape * shape_amplitude::<EulerianParticle>(sim, RADIUS, |x| harmonic.at(x))
                + crowding * surfactant_amplitude(sim, &harmonic)
        })?;
        Ok(Oscillation::fit(&samples, exact))
    }
}

/// The slower of the two frequencies of the equations above, rad/s.
fn slow_frequency(degree: u32, air: f64) -> f64 {
    let n = f64::from(degree);
    let big = n * (n + 1.0);
    let (normal, tangential) = (MASS + air, MASS);
    // Symmetric with y scaled by sqrt N, then by the square roots of the inertias.
    let a = (2.0 * TENSION * (n - 1.0) * (n + 2.0) + 8.0 * ELASTICITY) / normal;
    let b = -4.0 * ELASTICITY * big.sqrt() / (normal * tangential).sqrt();
    let d = 2.0 * ELASTICITY * big / tangential;
    let slow = (a * d - b * b) / (0.5 * (a + d) + (0.25 * (a - d).powi(2) + b * b).sqrt());
    slow.sqrt() / RADIUS
}

/// Factors of `zeta/R` and `Gamma'/Gamma0` in the amplitude of the slow mode, orthogonal to the fast one in the inertias:
/// the start excites both.
fn slow_part(degree: u32, air: f64, frequency: f64) -> [f64; 2] {
    let big = f64::from(degree * (degree + 1));
    let flow = 4.0 * ELASTICITY / (2.0 * ELASTICITY * big - (frequency * RADIUS).powi(2) * MASS);
    let share = flow * MASS / (MASS + air);
    [1.0 + 2.0 * share, share]
}

/// Component of `Gamma'/Gamma0` along a harmonic.
fn surfactant_amplitude(simulation: &mut Simulation, harmonic: &Harmonic) -> f64 {
    let rest = simulation.world().resource::<Liquid>().reference_surfactant();
    let places = simulation.column::<EulerianParticle, Position>();
    let surfactant = simulation.column::<EulerianParticle, Surfactant>();
    let terms = places.iter().zip(&surfactant).map(|(x, gamma)| (harmonic.at(x.0), gamma.0 / rest - 1.0));
    let (along, whole) = terms.fold((0.0, 0.0), |(p, q), (y, g)| (p + y * g, q + y * y));
    along / whole
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stiff_surfactant_adds_the_inertia_of_the_liquid_that_runs_along() {
        for (degree, air) in [(2, AIR), (3, 0.0), (4, AIR)] {
            let n = f64::from(degree);
            let inertia = MASS * (1.0 + 4.0 / (n * (n + 1.0))) + air;
            let stiff = (2.0 * TENSION * (n - 1.0) * (n + 2.0) / (inertia * RADIUS * RADIUS)).sqrt();
            let found = slow_frequency(degree, air);
            assert!(found < stiff && found > 0.8 * stiff, "{degree}: {found} {stiff}");
        }
    }
}
