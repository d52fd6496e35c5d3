//! A bubble in air rings at the frequencies of two inviscid fluids under the tension of the film.
//!
//! # Equation
//! See [`sheet_run`](super::sheet_run): the film has no mass, the air on both sides has.
//!
//! # Discretisation
//! Icospheres, amplitude 1e-3 of the radius. At the usual smoothing of 0.75 edge lengths the kernel leaves a rest of about 0.2 % that the
//! lattice of vertices makes and that falls with the first power of the spacing; it changes sign with the smoothing. At 1.0 it is gone
//! below the error of second order: the order is measured there, the frequencies at the usual one.

use std::f64::consts::TAU;

use froth_components::kind::MeshVertex;
use froth_systems::sampling::harmonic::Harmonic;

use super::finding::{Finding, Refinement};
use super::oscillation::Oscillation;
use super::scene_run::{series, shape_amplitude};
use super::sheet_run::{AS_IT_IS, air_frequency, free_film};
use super::{Effort, LawError};

const RADIUS: f64 = 0.05;
/// Periods that are fitted.
const PERIODS: f64 = 1.25;
/// Samples in a period.
const SAMPLES: f64 = 48.0;
/// Smoothing in edge lengths at which the order is seen.
const SMOOTH: f64 = 1.0;
/// Degrees whose order is measured.
const ORDERS: [u32; 3] = [2, 3, 4];

pub(super) fn measure(effort: Effort) -> Result<Vec<Finding>, LawError> {
    let (vertices, bars): (u32, &[(u32, f64)]) = effort.choose(
        (642, &[(2, 0.01), (3, 0.02), (4, 0.04)]),
        (2562, &[(2, 0.01), (3, 0.01), (4, 0.015), (5, 0.02), (6, 0.03)]),
    );
    let mut findings = Vec::new();
    for (degree, tolerance) in bars {
        let (exact, fit) = (air_frequency(*degree, RADIUS), ring(*degree, vertices, 0.75)?);
        findings.extend([
            Finding::relative(format!("frequency n = {degree}, Hz"), exact / TAU, fit.frequency / TAU, *tolerance),
            Finding::vanishing(format!("damping n = {degree}, relative to omega"), fit.damping / fit.frequency, 1e-3),
        ]);
    }
    for degree in ORDERS {
        findings.push(order(degree, effort)?);
    }
    Ok(findings)
}

/// Order of the error of one frequency at a smoothing of [`SMOOTH`].
fn order(degree: u32, effort: Effort) -> Result<Finding, LawError> {
    let counts: &[u32] = effort.choose(&[162, 642], &[162, 642, 2562]);
    let exact = air_frequency(degree, RADIUS);
    let mut refinement = Refinement::default();
    let mut measured = f64::NAN;
    for count in counts {
        measured = ring(degree, *count, SMOOTH)?.frequency;
        refinement.add(1.0 / f64::from(*count).sqrt(), measured / exact - 1.0);
    }
    let what = format!("frequency n = {degree} at smoothing {SMOOTH}, Hz");
    Ok(Finding::relative(what, exact / TAU, measured / TAU, 0.06).converging(&refinement, 1.8))
}

/// The oscillation of one mode on an icosphere of `vertices`, 10 n^2 + 2.
fn ring(degree: u32, vertices: u32, smoothing: f64) -> Result<Oscillation, LawError> {
    let shape = format!("Sphere(radius: {RADIUS}), HarmonicMode(degree: {degree}, amplitude: 0.001)");
    let settings = format!("courant: 0.2, smoothing: {smoothing}, summation: Direct, {AS_IT_IS}");
    let mut simulation = free_film(&shape, &format!("Vertices({vertices})"), &settings).begin()?;
    let (harmonic, exact) = (Harmonic::new(degree, 0), air_frequency(degree, RADIUS));
    let period = TAU / exact;
    let samples = series(&mut simulation, period / SAMPLES, PERIODS * period, |sim| {
        shape_amplitude::<MeshVertex>(sim, RADIUS, |x| harmonic.at(x))
    })?;
    Ok(Oscillation::fit(&samples, exact))
}
