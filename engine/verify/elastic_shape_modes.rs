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

use froth_systems::sampling::harmonic::Harmonic;

use super::finding::{Finding, Refinement};
use super::oscillation::Oscillation;
use super::scene_run::{SceneRun, series, shape_amplitude};
use super::{Effort, LawError};

const RADIUS: f64 = 0.05;
const TENSION: f64 = 0.03;
const ELASTICITY: f64 = 0.04;
const MASS: f64 = 1000.0 * 400e-9;
const AIR: f64 = 0.4 * 1.2 * RADIUS;
const PERIODS: f64 = 1.25;

pub(super) fn measure(effort: Effort) -> Result<Vec<Finding>, LawError> {
    let counts: &[u32] = effort.choose(&[400, 800, 1600], &[1000, 2000, 4000]);
    let finding = |degree: u32| {
        let exact = slow_frequency(degree, AIR);
        let mut refinement = Refinement::default();
        let mut measured = f64::NAN;
        for count in counts {
            measured = ring(degree, *count, "Local", exact)?.frequency;
            refinement.add(1.0 / f64::from(*count).sqrt(), measured / exact - 1.0);
        }
        let (exact, measured) = (exact / std::f64::consts::TAU, measured / std::f64::consts::TAU);
        let what = format!("frequency n = {degree} with the air's inertia, Hz");
        Ok(Finding::relative(what, exact, measured, 0.02).converging(&refinement, 1.0))
    };
    [2, 3, 4].into_iter().map(finding).collect()
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

fn ring(degree: u32, count: u32, air: &str, exact: f64) -> Result<Oscillation, LawError> {
    let scene = SceneRun::of("elastic_shape_mode").with("degree: 2", &format!("degree: {degree}"));
    let scene = scene.with("Particles(2000)", &format!("Particles({count})"));
    let mut simulation = scene.with("air: Local", &format!("air: {air}")).begin()?;
    let harmonic = Harmonic::new(degree, 0);
    let period = std::f64::consts::TAU / exact;
    let step = 0.7 / f64::from(count).sqrt() * period;
    let samples =
        series(&mut simulation, step, PERIODS * period, |sim| shape_amplitude(sim, RADIUS, |x| harmonic.at(x)))?;
    Ok(Oscillation::fit(&samples, exact))
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
