//! A free bubble in air keeps its energy.
//!
//! # Equation
//! `K + 2 sigma A` is constant. Its largest deviation at the end of any step is measured against the largest `K`.
//!
//! # Discretisation
//! A bubble stretched by a fifth along a mode of degree 2. Runge and Kutta's integrator with a mesh that moves with the films alone; the
//! leapfrog, whose energy swings about a constant one, as scenes have it, sliding and remeshing included.

use super::finding::Finding;
use super::mesh_run::MeshRun;
use super::sheet_run::{AS_IT_IS, air_period, energies, free_film};
use super::{Effort, LawError};

const RADIUS: f64 = 0.05;

pub(super) fn measure(effort: Effort) -> Result<Vec<Finding>, LawError> {
    let vertices = effort.choose(162, 642);
    let accurate = format!("integrator: RungeKutta4, courant: 0.15, summation: Direct, {AS_IT_IS}");
    let cases = [
        ("RK4, three periods", accurate.as_str(), 3.0, 2e-3),
        ("leapfrog with sliding, ten periods", "courant: 0.4, summation: Direct", 10.0, 0.03),
        ("leapfrog, ten periods, sum to 1e-3", "courant: 0.4, summation: Fast(0.001)", 10.0, 0.03),
    ];
    let findings = cases.into_iter().map(|(what, settings, periods, tolerance)| {
        let [worst, end] = deviation(vertices, settings, periods)?;
        Ok([
            Finding::vanishing(
                format!("{what}: energy less that of the start, largest, in largest K"),
                worst,
                tolerance,
            ),
            Finding::vanishing(format!("{what}: the same in the end"), end, tolerance),
        ])
    });
    Ok(findings.collect::<Result<Vec<_>, LawError>>()?.into_iter().flatten().collect())
}

/// Largest and last deviation of the energy in units of the largest kinetic energy, over some periods of degree 2.
fn deviation(vertices: u32, settings: &str, periods: f64) -> Result<[f64; 2], LawError> {
    let shape = format!("Sphere(radius: {RADIUS}), HarmonicMode(degree: 2, amplitude: 0.2)");
    let mut run = MeshRun::begin(&free_film(&shape, &format!("Vertices({vertices})"), settings))?;
    let start = energies(&mut run)?.total();
    let (mut worst, mut last, mut largest) = (0.0_f64, 0.0, 0.0_f64);
    let end = periods * air_period(2, RADIUS);
    while !run.simulation.has_reached(end) {
        run.step_within(end)?;
        let now = energies(&mut run)?;
        largest = largest.max(now.kinetic);
        last = now.total() - start;
        worst = worst.max(last.abs());
    }
    Ok([worst / largest, last / largest])
}
