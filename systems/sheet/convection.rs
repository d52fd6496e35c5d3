//! The part of the potentials' change that is quadratic in them: Bernoulli's `1/2 u^2` and convection by the mesh's motion in one.
//!
//! # Equation
//! `d phi_iv/dt += -N_iv . M+ R_v`, where `R` is the derivative of the discrete kinetic energy with the vertices, together with what
//! the moving volume gradients do. Per corner `k` of every panel
//! `R_vk += -1/2 (Gamma_{k+1} - Gamma_{k+2}) A_f + S_f / 3 - Gamma_k a'_f / 3 + q_f x e_k / 6`,
//! `q_f = sum_m Gamma_m w_m`, `a'_f` the rate of the area vector under the velocities `w`, `S_f = sum_g (G_f.G_g) grad k / 4 pi`.
//! The velocities are those of the mesh, tangential ones too: that is what carries potentials with a mesh that slides.
//!
//! # Source
//! Variation of the action `int [rho sum phi_iv N_iv . x'_v - K(x, phi) - E(x)] dt`. Contracted with the velocities it says that
//! `K + E` is constant when there is no tangential motion.

use glam::DVec3;

use crate::geometry::{Geometry, circulations, corners, edges, turning};
use crate::layout::Layout;

/// Sums over pairs that the convection needs, per panel.
#[derive(Clone, Copy, Debug)]
pub struct PairSums<'a> {
    /// Vector potential `A`, m^2/s.
    pub vector_potentials: &'a [DVec3],
    /// `S`, m^4/s^2.
    pub attractions: &'a [DVec3],
}

/// Rates of the potentials by convection, m^2/s^2 per side; `velocities` per vertex, m/s.
pub fn heads(
    layout: &Layout,
    geometry: &Geometry,
    positions: &[DVec3],
    potentials: &[f64],
    velocities: &[DVec3],
    sums: PairSums<'_>,
    heads: &mut Vec<f64>,
) {
    let mut reactions = vec![DVec3::ZERO; layout.vertex_rows()];
    for (row, panel) in layout.panels().iter().enumerate() {
        let x = corners(panel, positions);
        let w = corners(panel, velocities);
        let (e, gamma) = (edges(x), circulations(panel, potentials));
        let (a, s) = (sums.vector_potentials[row], sums.attractions[row]);
        let carried = w[0] * gamma[0] + w[1] * gamma[1] + w[2] * gamma[2];
        let turning = turning(x, w);
        for k in 0..3 {
            let across = gamma[(k + 1) % 3] - gamma[(k + 2) % 3];
            reactions[panel.corners[k] as usize] +=
                -0.5 * across * a + s / 3.0 - turning * (gamma[k] / 3.0) + carried.cross(e[k]) / 6.0;
        }
    }
    heads.clear();
    for (v, reaction) in reactions.iter().enumerate() {
        let along = geometry.ranges[v].inverse * *reaction;
        heads.extend(layout.sides_of(v).map(|side| -geometry.gradients[side].dot(along)));
    }
}
