//! Volumes of closed regions and their exact gradients.
//!
//! # Equation
//! `V_i = Σ_f ± a·(b x c) / 6` over the faces of region `i`, ghosts included, `+` where `i` lies in the back of the face.
//! `∂V_i/∂x_v = Σ_f ± N_f / 6` with `N_f` twice the area normal: one third of the area normals around `v`. That is exact
//! as long as the region is closed.
//!
//! # Discretisation
//! Gradients are stored sparse: one vector per entry of [`Incidence::entry_regions`].

use glam::DVec3;

use super::area::{corners_of, double_area_normal};
use super::incidence::{Incidence, NONE};

/// Volume of every closed region in the order of [`Incidence::closed`], m^3. Each is measured from a vertex of its own.
pub fn volumes(incidence: &Incidence, positions: &[DVec3], volumes: &mut Vec<f64>) {
    volumes.clear();
    volumes.resize(incidence.closed().len(), 0.0);
    for wall in incidence.walls() {
        let corners = corners_of(wall.corners, positions);
        for (region, sign) in wall.regions.into_iter().zip([1.0, -1.0]).filter(|(region, _)| *region != NONE) {
            let origin = positions[incidence.origins()[region as usize] as usize];
            let [a, b, c] = corners.map(|x| x - origin);
            volumes[region as usize] += sign * a.dot(b.cross(c)) / 6.0;
        }
    }
}

/// Gradient of volume per entry of a vertex, m^2.
pub fn volume_gradients(incidence: &Incidence, positions: &[DVec3], gradients: &mut Vec<DVec3>) {
    gradients.clear();
    gradients.resize(incidence.entry_regions().len(), DVec3::ZERO);
    for wall in incidence.walls() {
        let sixth = double_area_normal(corners_of(wall.corners, positions)) / 6.0;
        for (entries, signed) in wall.entries.iter().zip([sixth, -sixth]).filter(|(entries, _)| entries[0] != NONE) {
            entries.iter().for_each(|entry| gradients[*entry as usize] += signed);
        }
    }
}

/// Per vertex `Σ_i p_i ∂V_i/∂x`: with pressures (Pa) the force of the gas on it (N), added to `forces`.
pub fn add_pressure_forces(incidence: &Incidence, gradients: &[DVec3], pressures: &[f64], forces: &mut [DVec3]) {
    for (vertex, force) in forces.iter_mut().enumerate() {
        *force += pressure_force(incidence, gradients, pressures, vertex);
    }
}

#[inline]
pub(crate) fn pressure_force(incidence: &Incidence, gradients: &[DVec3], pressures: &[f64], vertex: usize) -> DVec3 {
    let entries = incidence.entries_of(vertex);
    let regions = &incidence.entry_regions()[entries.clone()];
    regions.iter().zip(&gradients[entries]).fold(DVec3::ZERO, |sum, (r, g)| sum + *g * pressures[*r as usize])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::calculus::test_shapes::{double_bubble, shaken};
    use crate::rows::Region;

    #[test]
    fn volumes_agree_with_those_of_the_surface() {
        let surface = shaken(&double_bubble(1.0, 0.7, 4), 0.1);
        let incidence = Incidence::new(&surface);
        let mut found = Vec::new();
        volumes(&incidence, &surface.positions, &mut found);
        let expected = surface.volumes();
        assert_eq!(incidence.closed(), [Region(1), Region(2)]);
        assert!((found[0] - expected[1]).abs() < 1e-13 && (found[1] - expected[2]).abs() < 1e-13);
    }

    #[test]
    fn open_regions_have_no_entries() {
        let mut surface = double_bubble(1.0, 0.7, 3);
        surface.open = vec![Region(2)];
        let incidence = Incidence::new(&surface);
        assert_eq!(incidence.closed(), [Region(1)]);
        assert!(incidence.entry_regions().iter().all(|entry| *entry == 0));
    }

    #[test]
    fn gradients_are_those_of_the_volumes_and_push_nothing_as_a_whole() {
        let surface = shaken(&double_bubble(1.0, 0.7, 3), 0.05);
        let incidence = Incidence::new(&surface);
        let mut x = surface.positions.0.clone();
        let (mut gradients, mut above, mut below) = (Vec::new(), Vec::new(), Vec::new());
        volume_gradients(&incidence, &x, &mut gradients);
        for v in 0..x.len() {
            for axis in 0..3 {
                let centre = x[v][axis];
                // A volume is linear in every single coordinate: differences are exact up to round-off.
                x[v][axis] = centre + 0.1;
                volumes(&incidence, &x, &mut above);
                x[v][axis] = centre - 0.1;
                volumes(&incidence, &x, &mut below);
                x[v][axis] = centre;
                let mut expected = [0.0; 2];
                for entry in incidence.entries_of(v) {
                    expected[incidence.entry_regions()[entry] as usize] = gradients[entry][axis];
                }
                for i in 0..2 {
                    assert!(((above[i] - below[i]) / 0.2 - expected[i]).abs() < 1e-12);
                }
            }
        }
        let mut forces = vec![DVec3::ZERO; x.len()];
        add_pressure_forces(&incidence, &gradients, &[2.0, 3.0], &mut forces);
        let torque: DVec3 = x.iter().zip(&forces).map(|(x, f)| x.cross(*f)).sum();
        assert!(forces.iter().sum::<DVec3>().length() < 1e-13 && torque.length() < 1e-13);
    }
}
