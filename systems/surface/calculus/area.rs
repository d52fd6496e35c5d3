//! Areas of films and the exact gradient of their energy.
//!
//! # Equation
//! Energy `E = Σ_f T_f A_f`. With corners `(a, b, c)` and unit normal `n` of a face, `∂A/∂a = (b - c) x n / 2`, which is
//! the cotangent formula `Σ_w (cot α + cot β)(x_v - x_w) / 2` written face by face.
//!
//! # Limits
//! A face without area has no normal and adds no gradient.

use std::collections::BTreeMap;

use glam::DVec3;

use super::incidence::Incidence;
use super::weights::Weights;
use crate::rows::Region;
use crate::surface::Surface;

#[inline]
pub(crate) fn corners_of(corners: [u32; 3], positions: &[DVec3]) -> [DVec3; 3] {
    corners.map(|v| positions[v as usize])
}

/// Twice the area along the right-hand normal, m^2.
#[inline]
pub(crate) fn double_area_normal([a, b, c]: [DVec3; 3]) -> DVec3 {
    (b - a).cross(c - a)
}

fn area(corners: [u32; 3], positions: &[DVec3]) -> f64 {
    0.5 * double_area_normal(corners_of(corners, positions)).length()
}

/// Per vertex one third of `Σ weight x area` over its films: with mass per area a mass (kg), with 1 an area (m^2).
pub fn vertex_integrals(incidence: &Incidence, positions: &[DVec3], weights: Weights<'_>, integrals: &mut [f64]) {
    integrals.fill(0.0);
    for film in incidence.films() {
        let third = weights.of(film.row) * area(film.corners, positions) / 3.0;
        film.corners.iter().for_each(|v| integrals[*v as usize] += third);
    }
}

/// Energy `Σ T_f A_f` (J, with tensions in N/m) and its gradient per vertex (N).
pub fn area_gradient(incidence: &Incidence, positions: &[DVec3], tension: Weights<'_>, gradient: &mut [DVec3]) -> f64 {
    gradient.fill(DVec3::ZERO);
    let mut energy = 0.0;
    for film in incidence.films() {
        let [a, b, c] = corners_of(film.corners, positions);
        let double = double_area_normal([a, b, c]);
        let length = double.length();
        if !(length > 0.0) {
            continue;
        }
        let half = 0.5 * tension.of(film.row);
        energy += half * length;
        let scaled = double * (half / length);
        let (at_a, at_b) = ((b - c).cross(scaled), (c - a).cross(scaled));
        let [i, j, k] = film.corners.map(|v| v as usize);
        gradient[i] += at_a;
        gradient[j] += at_b;
        gradient[k] -= at_a + at_b;
    }
    energy
}

/// Per vertex, for each of the two smallest labels of its films ([`Incidence::sides`]), one third of the area normals of the
/// films around that region, out of it, m^2.
///
/// In the middle of a film the first is along its normal, from the smaller label to the larger. On a border both together
/// span the plane across it.
pub fn vertex_normals(incidence: &Incidence, positions: &[DVec3], normals: &mut [[DVec3; 2]]) {
    normals.fill([DVec3::ZERO; 2]);
    for film in incidence.films() {
        let sixth = double_area_normal(corners_of(film.corners, positions)) / 6.0;
        let [back, front] = film.labels;
        for v in film.corners.map(|v| v as usize) {
            for (normal, label) in normals[v].iter_mut().zip(incidence.sides(v).labels) {
                let sign = f64::from(i8::from(label == back) - i8::from(label == front));
                *normal += sixth * sign;
            }
        }
    }
}

/// Area of the films between each pair of regions (smaller label first), m^2.
#[must_use]
pub fn areas_between(surface: &Surface) -> BTreeMap<[Region; 2], f64> {
    let mut areas = BTreeMap::new();
    for (row, face) in surface.mesh.faces().filter(|(_, face)| !face.is_ghost()) {
        let mut labels = face.labels();
        labels.sort_unstable();
        *areas.entry(labels).or_insert(0.0) += surface.area(row);
    }
    areas
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::calculus::test_shapes::{double_bubble, icosphere, shaken};

    #[test]
    fn the_gradient_is_that_of_the_energy_with_a_tension_per_face() {
        let surface = shaken(&double_bubble(1.0, 0.7, 3), 0.05);
        let tension: Vec<f64> = (0..surface.mesh.face_rows()).map(|f| 1.0 + 0.3 * (f as f64).sin()).collect();
        let weights = Weights::PerFace(&tension);
        let incidence = Incidence::new(&surface);
        let mut x = surface.positions.0.clone();
        let mut gradient = vec![DVec3::ZERO; x.len()];
        let mut ignored = gradient.clone();
        area_gradient(&incidence, &x, weights, &mut gradient);
        let step = 1e-5;
        for v in 0..x.len() {
            for axis in 0..3 {
                let centre = x[v][axis];
                x[v][axis] = centre + step;
                let above = area_gradient(&incidence, &x, weights, &mut ignored);
                x[v][axis] = centre - step;
                let below = area_gradient(&incidence, &x, weights, &mut ignored);
                x[v][axis] = centre;
                // Round-off of the difference: 1e-16 * 10 / 1e-5, and its own error of order step^2.
                assert!(((above - below) / (2.0 * step) - gradient[v][axis]).abs() < 1e-8);
            }
        }
    }

    #[test]
    fn forces_and_torques_of_tension_add_up_to_zero() {
        let surface = shaken(&double_bubble(1.0, 0.7, 4), 0.1);
        let incidence = Incidence::new(&surface);
        let mut gradient = vec![DVec3::ZERO; surface.positions.len()];
        area_gradient(&incidence, &surface.positions, Weights::Uniform(2.0), &mut gradient);
        let force: DVec3 = gradient.iter().sum();
        let torque: DVec3 = surface.positions.iter().zip(&gradient).map(|(x, g)| x.cross(*g)).sum();
        assert!(force.length() < 1e-12 && torque.length() < 1e-12, "{force} {torque}");
    }

    #[test]
    fn moving_the_origin_changes_no_gradient() {
        let surface = icosphere(1.0, 2);
        let incidence = Incidence::new(&surface);
        let moved: Vec<DVec3> = surface.positions.iter().map(|x| *x + DVec3::new(3.0, -5.0, 7.0)).collect();
        let mut gradients = [vec![DVec3::ZERO; moved.len()], vec![DVec3::ZERO; moved.len()]];
        area_gradient(&incidence, &surface.positions, Weights::Uniform(1.0), &mut gradients[0]);
        area_gradient(&incidence, &moved, Weights::Uniform(1.0), &mut gradients[1]);
        assert!(gradients[0].iter().zip(&gradients[1]).all(|(a, b)| a.distance(*b) < 1e-14));
    }

    #[test]
    fn areas_between_regions_add_up_to_the_film_area() {
        let surface = double_bubble(1.0, 0.7, 6);
        let areas = areas_between(&surface);
        assert_eq!(areas.len(), 3);
        assert!((areas.values().sum::<f64>() - surface.film_area()).abs() < 1e-12);
        let mut thirds = vec![0.0; surface.positions.len()];
        vertex_integrals(&Incidence::new(&surface), &surface.positions, Weights::Uniform(1.0), &mut thirds);
        assert!((thirds.iter().sum::<f64>() - surface.film_area()).abs() < 1e-12);
    }
}
