//! From potentials to how fast the films move: strengths, fluxes, velocities, energy.
//!
//! # Equation
//! Sheet strength `n x grad Gamma`; its vector potential `A`; the velocity `curl A` crosses a vertex's share of a film with
//! the flux `int hat_v u.n dA = 1/2 e_v . A` per face (Stokes). `rho F = dK/dphi` for `K = rho/2 sum_f G_f . A_f`: strengths and
//! fluxes are each other's transpose, which makes the scheme Hamiltonian.
//!
//! # Discretisation
//! Fluxes out of the closed surface of a region add up to zero to round-off. Velocities are the least ones that have the
//! fluxes: `w_v = M+ sum_i N_iv F_iv`, normal on a film, across the line on a Plateau border, any where borders meet.
//!
//! # Source
//! Da 2015, eqs 8 and 12, in weak form.

use glam::DVec3;

use crate::geometry::{Geometry, circulations, corners, edges};
use crate::layout::Layout;

/// Area-integrated sheet strengths `G_f = -1/2 sum_k e_k Gamma_k` per panel, m^3/s.
pub fn strengths(layout: &Layout, positions: &[DVec3], potentials: &[f64], strengths: &mut Vec<DVec3>) {
    strengths.clear();
    strengths.extend(layout.panels().iter().map(|panel| {
        let (e, gamma) = (edges(corners(panel, positions)), circulations(panel, potentials));
        -0.5 * (e[0] * gamma[0] + e[1] * gamma[1] + e[2] * gamma[2])
    }));
}

/// Fluxes `F` out of each region through its share of every vertex, m^3/s per side; `vector_potentials` per panel, m^2/s.
pub fn fluxes(layout: &Layout, positions: &[DVec3], vector_potentials: &[DVec3], fluxes: &mut Vec<f64>) {
    fluxes.clear();
    fluxes.resize(layout.side_count(), 0.0);
    for (panel, a) in layout.panels().iter().zip(vector_potentials) {
        let e = edges(corners(panel, positions));
        for k in 0..3 {
            let flux = 0.5 * e[k].dot(*a);
            fluxes[panel.back[k] as usize] += flux;
            fluxes[panel.front[k] as usize] -= flux;
        }
    }
}

/// The least velocities that carry the films with the fluxes, m/s per vertex.
pub fn velocities(layout: &Layout, geometry: &Geometry, fluxes: &[f64], velocities: &mut Vec<DVec3>) {
    velocities.clear();
    velocities.extend((0..layout.vertex_rows()).map(|v| {
        let sum: DVec3 = layout.sides_of(v).map(|side| geometry.gradients[side] * fluxes[side]).sum();
        geometry.ranges[v].inverse * sum
    }));
}

/// Kinetic energy of the air per density, `1/2 sum_f G_f . A_f`, m^5/s^2.
#[must_use]
pub fn kinetic_energy(strengths: &[DVec3], vector_potentials: &[DVec3]) -> f64 {
    0.5 * strengths.iter().zip(vector_potentials).map(|(g, a)| g.dot(*a)).sum::<f64>()
}
