//! Small oscillations of a bubble whose only inertia is that of its film.
//!
//! # Equation
//! `rho eta d2zeta/dt2 = -(2 sigma (n - 1)(n + 2)/R^2) zeta`: the second variation of the area of a sphere in degree
//! `n`, both interfaces, volume kept.
//!
//! # Discretisation
//! The scene has no material particles, hence uniform tension. Steps shorten with the spacing, so that one order is
//! seen for both.

use froth_components::kind::EulerianParticle;
use froth_systems::sampling::harmonic::Harmonic;

use super::finding::{Finding, Refinement};
use super::oscillation::Oscillation;
use super::scene_run::{SceneRun, series, shape_amplitude};
use super::{Effort, LawError};

const RADIUS: f64 = 0.05;
const TENSION: f64 = 0.03;
const MASS: f64 = 1000.0 * 400e-9;
/// Periods that are fitted.
const PERIODS: f64 = 1.25;
/// Degree, and the relative error allowed to its frequency.
const MODES: [(u32, f64); 3] = [(2, 0.01), (3, 0.015), (4, 0.025)];

pub(super) fn measure(effort: Effort) -> Result<Vec<Finding>, LawError> {
    let counts: &[u32] = effort.choose(&[500, 1000, 2000], &[1000, 2000, 4000]);
    let modes = MODES.into_iter().map(|(degree, tolerance)| mode(degree, tolerance, counts));
    let findings: Result<Vec<_>, LawError> = modes.collect();
    Ok(findings?.into_iter().flatten().collect())
}

/// Frequency and damping of one mode.
fn mode(degree: u32, tolerance: f64, counts: &[u32]) -> Result<[Finding; 2], LawError> {
    let exact = exact_frequency(degree);
    let mut refinement = Refinement::default();
    let (mut measured, mut damping) = (f64::NAN, f64::NAN);
    for count in counts {
        let fit = ring(degree, *count)?;
        refinement.add(1.0 / f64::from(*count).sqrt(), fit.frequency / exact - 1.0);
        (measured, damping) = (fit.frequency, fit.damping);
    }
    // Errors fall with the square of the spacing: the bar is for 4000 carriers.
    let tolerance = tolerance * 4000.0 / f64::from(counts[counts.len() - 1]);
    let tau = std::f64::consts::TAU;
    Ok([
        Finding::relative(format!("frequency n = {degree}, Hz"), exact / tau, measured / tau, tolerance)
            .converging(&refinement, 1.7),
        Finding::vanishing(format!("damping n = {degree}, relative to omega"), damping / measured, 2e-3),
    ])
}

fn exact_frequency(degree: u32) -> f64 {
    let n = f64::from(degree);
    (2.0 * TENSION * (n - 1.0) * (n + 2.0) / (MASS * RADIUS * RADIUS)).sqrt()
}

/// The oscillation of one mode with `count` carriers.
fn ring(degree: u32, count: u32) -> Result<Oscillation, LawError> {
    let scene = SceneRun::of("shape_mode").with("degree: 2", &format!("degree: {degree}"));
    let mut simulation = scene.with("Particles(4000)", &format!("Particles({count})")).begin()?;
    let spacing = (4.0 * std::f64::consts::PI * RADIUS * RADIUS / f64::from(count)).sqrt();
    let step = 0.2 * spacing / (2.0 * TENSION / MASS).sqrt();
    let harmonic = Harmonic::new(degree, 0);
    let exact = exact_frequency(degree);
    let end = PERIODS * std::f64::consts::TAU / exact;
    let samples =
        series(&mut simulation, step, end, |sim| shape_amplitude::<EulerianParticle>(sim, RADIUS, |x| harmonic.at(x)))?;
    Ok(Oscillation::fit(&samples, exact))
}
