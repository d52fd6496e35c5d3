//! A flat film on a ring swings in air as a drum whose only mass is the air's.
//!
//! # Equation
//! First axisymmetric mode `omega^2 = 5.8598 (2 sigma)/(rho a^3)`: the film's height `h` obeys `rho d(phi)/dt = 2 sigma Laplace(h)` on both
//! sides, with the potential jump of a disc in unbounded air. The number is the least eigenvalue of that pair of operators in a Bessel basis.
//!
//! # Discretisation
//! The film starts close to the shape of the mode, 1e-3 of the radius high, air at rest; the ring is held. The error changes its sign
//! under refinement, so that it has no order to speak of: the bar is held at every size instead.

use std::f64::consts::TAU;

use froth_components::film::Area;
use froth_components::kind::MeshVertex;
use froth_components::motion::Position;
use glam::DVec3;

use super::finding::Finding;
use super::oscillation::Oscillation;
use super::scene_run::series;
use super::sheet_run::{AS_IT_IS, DENSITY, TENSION, free_film};
use super::{Effort, LawError};
use crate::simulation::Simulation;

const RADIUS: f64 = 0.05;
/// Eigenvalue of the first mode, dimensionless.
const EIGENVALUE: f64 = 5.8598;
/// Largest height over the radius.
const HEIGHT: f64 = 1e-3;
/// Periods that are fitted.
const PERIODS: f64 = 2.0;
/// Samples in a period.
const SAMPLES: f64 = 48.0;

pub(super) fn measure(effort: Effort) -> Result<Vec<Finding>, LawError> {
    let exact = (EIGENVALUE * 2.0 * TENSION / (DENSITY * RADIUS.powi(3))).sqrt();
    // Edges over the radius; the middle one of the full sizes is that of the bar.
    let edges: &[f64] = effort.choose(&[0.13, 0.092], &[0.13, 0.092, 0.065]);
    let mut findings = Vec::new();
    for edge in edges {
        let (vertices, fit) = ring(*edge, exact)?;
        let what = format!("first mode with {vertices} vertices, Hz");
        findings.push(Finding::relative(what, exact / TAU, fit.frequency / TAU, 5e-3));
        let what = format!("damping with {vertices} vertices, relative to omega");
        findings.push(Finding::vanishing(what, fit.damping / fit.frequency, 1e-3));
    }
    Ok(findings)
}

/// Number of vertices, and the oscillation of the mean height.
fn ring(edge: f64, exact: f64) -> Result<(usize, Oscillation), LawError> {
    let shape = format!("Disc(radius: {RADIUS}, normal: (0, 0, 1))");
    let settings = format!("courant: 0.2, summation: Direct, {AS_IT_IS}");
    let mut simulation = free_film(&shape, &format!("Spacing({})", edge * RADIUS), &settings).begin()?;
    let mut positions = simulation.column::<MeshVertex, Position>();
    positions.iter_mut().for_each(|x| x.0.z = bulge(x.0));
    simulation.set_column::<MeshVertex, _>(&positions);
    let period = TAU / exact;
    let samples = series(&mut simulation, period / SAMPLES, PERIODS * period, height)?;
    Ok((positions.len(), Oscillation::fit(&samples, exact)))
}

/// Height that is close to the first mode, metres.
fn bulge(x: DVec3) -> f64 {
    let r = x.truncate().length_squared() / (RADIUS * RADIUS);
    HEIGHT * RADIUS * (1.0 - r) * (1.0 - 0.25 * r)
}

/// Mean height by area, metres.
fn height(simulation: &mut Simulation) -> f64 {
    let positions = simulation.column::<MeshVertex, Position>();
    let areas = simulation.column::<MeshVertex, Area>();
    let terms = positions.iter().zip(&areas).map(|(x, area)| (area.0 * x.0.z, area.0));
    let (moment, area) = terms.fold((0.0, 0.0), |(p, q), (a, b)| (p + a, q + b));
    moment / area
}
