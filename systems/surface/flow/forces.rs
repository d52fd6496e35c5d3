//! Forces on vertices: tension, external forces, pressure.

use glam::DVec3;

use super::forcing::Forcing;
use crate::calculus::area::{area_gradient, vertex_normals};
use crate::calculus::{Incidence, Weights};

/// Force of tension on every vertex, N: minus the gradient of `Σ T_f A_f`.
pub fn tension_forces(incidence: &Incidence, positions: &[DVec3], tension: Weights<'_>, forces: &mut [DVec3]) {
    area_gradient(incidence, positions, tension, forces);
    forces.iter_mut().for_each(|force| *force = -*force);
}

/// Removes from forces the part that changes no volume to first order: in the middle of a film what lies along the film, on
/// a border what lies along the border, at a quadruple point nothing. `removed` gets it, N. `normals` is scratch.
pub fn remove_tangential(
    incidence: &Incidence,
    positions: &[DVec3],
    forces: &mut [DVec3],
    removed: &mut [DVec3],
    normals: &mut [[DVec3; 2]],
) {
    vertex_normals(incidence, positions, normals);
    for (v, (force, removed)) in forces.iter_mut().zip(removed).enumerate() {
        *removed = tangential_part(*force, incidence.sides(v).count, normals[v]).unwrap_or(DVec3::ZERO);
        *force -= *removed;
    }
}

/// `None` where the normals do not tell what is tangential.
fn tangential_part(force: DVec3, sides: u8, [first, second]: [DVec3; 2]) -> Option<DVec3> {
    match sides {
        2 => Some(force.reject_from_normalized(first.try_normalize()?)),
        3 => {
            let (first, second) = (first.try_normalize()?, second.try_normalize()?);
            Some(force.project_onto_normalized(first.cross(second).try_normalize()?))
        }
        _ => None,
    }
}

/// Adds `m_v g_v`, N, for masses in kg.
pub fn add_external_forces(forcing: &Forcing<'_>, masses: &[f64], forces: &mut [DVec3]) {
    for (v, (force, mass)) in forces.iter_mut().zip(masses).enumerate() {
        *force += forcing.acceleration.of(v) * *mass;
    }
}
