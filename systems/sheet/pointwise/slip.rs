//! What becomes of potentials at vertices that slide beside the air, to keep triangles even.
//!
//! # Equation
//! `d phi_i/dt = (w - u).grad phi_i` for a vertex that moves with `w` where the air, in the mean of both sides, moves with `u`: with `w = u`
//! there is no convection at all.
//!
//! # Discretisation
//! Upwind: panels towards which the vertex slides count, by how fast the slip leaves the corner.
//!
//! # Limits
//! First order. Along Plateau borders see [the error of the paper](super).

use glam::DVec3;

use crate::discretisation::Films;
use crate::geometry::{corners, edges};

/// Rates of the potentials, m^2/s^2 per side; `slips` are `w - u` per vertex, m/s.
pub(super) fn heads(films: Films<'_>, potentials: &[f64], slips: &[DVec3], heads: &mut Vec<f64>) {
    let Films { layout, geometry, positions, .. } = films;
    heads.clear();
    heads.resize(layout.side_count(), 0.0);
    if slips.iter().all(|slip| *slip == DVec3::ZERO) {
        return;
    }
    let mut weights = vec![0.0; layout.side_count()];
    for (panel, area) in layout.panels().iter().zip(&geometry.area_vectors) {
        let gradients = hat_gradients(corners(panel, positions), *area);
        for k in 0..3 {
            let slip = slips[panel.corners[k] as usize];
            let weight = area.length() * (-slip.dot(gradients[k])).max(0.0);
            for sides in [panel.back, panel.front] {
                let rate: f64 = (0..3).map(|m| potentials[sides[m] as usize] * slip.dot(gradients[m])).sum();
                heads[sides[k] as usize] += weight * rate;
                weights[sides[k] as usize] += weight;
            }
        }
    }
    heads.iter_mut().zip(weights).for_each(|(head, weight)| *head = if weight > 0.0 { *head / weight } else { 0.0 });
}

/// Gradients of the linear functions that are 1 at one corner and 0 at the others, 1/m.
fn hat_gradients(x: [DVec3; 3], area: DVec3) -> [DVec3; 3] {
    let square = area.length_squared();
    let over = if square > 0.0 { area * (0.5 / square) } else { DVec3::ZERO };
    edges(x).map(|e| over.cross(e))
}
