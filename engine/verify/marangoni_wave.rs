//! Standing waves of liquid and surfactant in a flat film between walls.
//!
//! # Equation
//! `d2Gamma/dt2 = c^2 lap Gamma`, `c^2 = 2 E/(rho eta)`; on a film of length `L` mode 1 swings at `c/(2 L)`.
//!
//! # Discretisation
//! The solve is implicit (backward Euler): the frequency is low by `(omega dt)^2/3`, the damping `omega^2 dt/2`. Steps
//! shorten with the spacing.

use froth_components::film::SurfactantAmount;
use froth_components::kind::LagrangianParticle;
use froth_components::motion::Position;
use std::f64::consts::PI;

use super::finding::{Finding, Refinement};
use super::oscillation::Oscillation;
use super::scene_run::{SceneRun, series};
use super::{Effort, LawError};
use crate::simulation::Simulation;

const LENGTH: f64 = 0.1;
const ELASTICITY: f64 = 1.8e-3;
const MASS: f64 = 1000.0 * 400e-9;
/// Part of a spacing that the wave runs in a step.
const COURANT: f64 = 0.4;
const PERIODS: f64 = 1.25;

pub(super) fn measure(effort: Effort) -> Result<Vec<Finding>, LawError> {
    let spacings: [f64; 3] = effort.choose([7e-3, 5e-3, 3.5e-3], [3.5e-3, 2.5e-3, 1.75e-3]);
    let speed = (2.0 * ELASTICITY / MASS).sqrt();
    let exact = PI * speed / LENGTH;
    let mut refinement = Refinement::default();
    let (mut measured, mut damping, mut implicit) = (f64::NAN, f64::NAN, f64::NAN);
    for spacing in spacings {
        let step = COURANT * spacing / speed;
        let fit = slosh(spacing, step, exact)?;
        refinement.add(spacing, fit.frequency / exact - 1.0);
        (measured, damping, implicit) = (fit.frequency, fit.damping, 0.5 * exact * exact * step);
    }
    let tau = std::f64::consts::TAU;
    Ok(vec![
        Finding::relative("frequency of mode 1, Hz", exact / tau, measured / tau, 0.02).converging(&refinement, 1.7),
        Finding::relative("speed of the wave, m/s", speed, measured * LENGTH / PI, 0.02),
        Finding::relative("damping of the implicit solve, omega^2 dt/2, 1/s", implicit, damping, 0.3),
    ])
}

fn slosh(spacing: f64, step: f64, exact: f64) -> Result<Oscillation, LawError> {
    let scene = SceneRun::of("marangoni_wave").with("Spacing(\"2.5 mm\")", &format!("Spacing({spacing})"));
    let mut simulation = scene.begin()?;
    let end = PERIODS * std::f64::consts::TAU / exact;
    let samples = series(&mut simulation, step, end, first_mode)?;
    Ok(Oscillation::fit(&samples, exact))
}

/// Part of the surfactant that is in the first mode, from what the material particles carry.
fn first_mode(simulation: &mut Simulation) -> f64 {
    let places = simulation.column::<LagrangianParticle, Position>();
    let amounts = simulation.column::<LagrangianParticle, SurfactantAmount>();
    let mode = |x: &Position| (PI * (x.0.x / LENGTH + 0.5)).cos();
    let along: f64 = places.iter().zip(&amounts).map(|(x, s)| s.0 * mode(x)).sum();
    2.0 * along / amounts.iter().map(|s| s.0).sum::<f64>()
}
