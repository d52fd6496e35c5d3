//! Areas that agree with the transfer, concentration, thickness, enclosed volume.
//!
//! # Equation
//! Dual area `a*_E = sum_E' w(E, E') a_E'`: the transfer applied to the area itself, so that uniform liquid gives
//! uniform thickness. Concentration `Gamma* = S_E / a*_E`. Thickness `eta = (V_E / S_E) Gamma`: liquid and surfactant
//! are gathered with the same sampling error, which their ratio does not have.
//! Volume `V = 1/3 sum a (x - o) . n`.
//!
//! # Source
//! Deng 2022, Algorithm 2, Eqs 9 and 11 (sign corrected). DEVIATION: thickness from the dual area (8 % off with the
//! paper's at walls, 0.3 % so) and from the ratio to the surfactant; no evolution of thickness on L (Eq. 8).

use super::links::{Carriers, Link, link_one};
use crate::neighbours::kernel::Kernel;
use crate::operators::stencil::Stencil;
use crate::rows::reduce::ordered_sum;
use froth_components::motion::{Normal, Position};
use glam::DVec3;
use rayon::prelude::*;
use std::ops::Range;

/// The dual area of every carrier, m^2.
#[must_use]
pub fn dual_areas(carriers: Carriers) -> Vec<f64> {
    let kernel = carriers.kernel();
    let count = carriers.positions.len();
    let link = |i: usize| link_one(carriers, &kernel, carriers.positions[i].0, carriers.normals[i].0, carriers.regions[i]);
    let links: Vec<Link> = (0..count).into_par_iter().with_min_len(128).map(link).collect();
    (0..count).into_par_iter().with_min_len(128).map(|i| dual_area(carriers, &kernel, &links, i)).collect()
}

fn dual_area(carriers: Carriers, kernel: &Kernel, links: &[Link], i: usize) -> f64 {
    let Stencil { lists, areas, .. } = carriers.stencil;
    let own = links[i].weight(kernel.value(0.0), DVec3::ZERO) * areas[i];
    let near = lists.of(i).iter().map(|&j| j as usize);
    own + near
        .map(|j| (j, carriers.positions[i].0 - carriers.positions[j].0))
        .map(|(j, r)| links[j].weight(kernel.value(r.length_squared()), r) * areas[j])
        .sum::<f64>()
}

/// Volume enclosed by the rows of a closed film, measured from its particles, m^3.
#[must_use]
pub fn enclosed_volume(positions: &[Position], normals: &[Normal], areas: &[f64], rows: Range<usize>) -> f64 {
    let origin = positions[rows.start].0;
    let start = rows.start;
    let term = |i: usize| areas[start + i] * (positions[start + i].0 - origin).dot(normals[start + i].0);
    ordered_sum(rows.len(), 0.0, term) / 3.0
}
