//! Area and mean curvature (the sum of the principal curvatures) of closed films.
//!
//! # Equation
//! Sphere: `A = 4 pi R^2`, `kappa = 2/R`. Ellipsoid `sum x_i^2/r_i^2 = 1`: with `g = x_i/r_i^2`,
//! `kappa = (sum 1/r_i^2 - (sum g_i^2/r_i^2)/g^2)/|g|`, `dA = r_1 r_2 r_3 |n/r| dOmega`.
//!
//! # Limits
//! The pair weights know how far their neighbours are, not in which directions. Where the arrangement of the carriers
//! is not the same in all directions and neither is the film's curvature, 1e-3 of the curvature is left that
//! refinement removes slowly.

use froth_components::authored::shape::{Ellipsoid, Place, Radii, Shape};
use froth_systems::operators::stencil::Stencil;
use glam::DVec3;
use std::f64::consts::{PI, TAU};

use super::finding::{Finding, Refinement};
use super::operators::spheres;
use super::sampled::{Sampled, root_mean_square};
use super::{Effort, LawError};

const RADIUS: f64 = 0.05;
const RADII: DVec3 = DVec3::new(0.06, 0.05, 0.04);

pub(super) fn measure(effort: Effort) -> Result<Vec<Finding>, LawError> {
    let spheres = spheres(effort)?;
    let counts: &[usize] = effort.choose(&[500, 1000, 2000], &[1000, 2000, 4000, 8000]);
    let shape = Shape::Ellipsoid(Ellipsoid { centre: Place::ZERO, radii: Radii::from_si(RADII) });
    let ellipsoids: Vec<Sampled> = counts.iter().map(|count| Sampled::new(shape, *count)).collect::<Result<_, _>>()?;
    let mut findings = film("sphere", &spheres, 4.0 * PI * RADIUS * RADIUS, |_| 2.0 / RADIUS);
    findings.extend(film("ellipsoid", &ellipsoids, ellipsoid_area(RADII), |x| ellipsoid_curvature(RADII, x)));
    Ok(findings)
}

/// Area, total curvature and the curvature of single carriers of one shape.
fn film(name: &str, films: &[Sampled], area: f64, curvature: impl Fn(DVec3) -> f64) -> Vec<Finding> {
    let whole_area = |film: &Sampled| film.stencil.areas.iter().sum::<f64>();
    let kappa = |film: &Sampled, i: usize| -film.pull(i).dot(film.film.normals[i].0) / film.stencil.areas[i];
    let mean = |film: &Sampled, kappa: &dyn Fn(usize) -> f64| {
        let Stencil { areas, .. } = &film.stencil;
        areas.iter().enumerate().map(|(i, a)| a * kappa(i)).sum::<f64>() / whole_area(film)
    };
    let exact = |film: &Sampled, i: usize| curvature(film.positions()[i].0);
    let spread = |film: &Sampled| root_mean_square((0..film.count()).map(|i| kappa(film, i) / exact(film, i) - 1.0));
    let fitted = |film: &Sampled| {
        let trace = |i: usize| {
            let s = film.film.shapes[i].0;
            s.x_axis.x + s.y_axis.y + s.z_axis.z
        };
        root_mean_square((0..film.count()).map(|i| trace(i) / exact(film, i) - 1.0))
    };
    let Some(finest) = films.last() else { return Vec::new() };
    let refinement =
        |f: &dyn Fn(&Sampled) -> f64| films.iter().map(|film| (film.spacing, f(film))).collect::<Refinement>();
    vec![
        Finding::relative(format!("{name}: area, m^2"), area, whole_area(finest), 2e-3),
        Finding::relative(
            format!("{name}: mean of the mean curvature, 1/m"),
            mean(finest, &|i| exact(finest, i)),
            mean(finest, &|i| kappa(finest, i)),
            1e-3,
        ),
        Finding::vanishing(format!("{name}: mean curvature, rms relative error"), spread(finest), 5e-3)
            .converging(&refinement(&spread), 0.5),
        Finding::vanishing(format!("{name}: fitted curvature, rms relative error"), fitted(finest), 0.02)
            .converging(&refinement(&fitted), 1.7),
    ]
}

fn ellipsoid_curvature(radii: DVec3, x: DVec3) -> f64 {
    let inverse = (radii * radii).recip();
    let g = x * inverse;
    (inverse.element_sum() - (g * g * inverse).element_sum() / g.length_squared()) / g.length()
}

/// By the midpoint rule in longitude and height, which converges fast for smooth periodic integrands.
fn ellipsoid_area(radii: DVec3) -> f64 {
    const STEPS: u32 = 600;
    let middle = |k: u32| (f64::from(k) + 0.5) / f64::from(STEPS);
    let element = |i: u32, k: u32| {
        let z = 2.0 * middle(i) - 1.0;
        let (sin, cos) = (TAU * middle(k)).sin_cos();
        let ring = (1.0 - z * z).sqrt();
        (DVec3::new(ring * cos, ring * sin, z) / radii).length()
    };
    let sum: f64 = (0..STEPS).flat_map(|i| (0..STEPS).map(move |k| element(i, k))).sum();
    radii.element_product() * sum * 4.0 * PI / f64::from(STEPS * STEPS)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_closed_forms_agree_with_those_of_a_sphere_and_a_spheroid() {
        let sphere = DVec3::splat(0.3);
        // Round-off of a sum over a million elements.
        assert!((ellipsoid_area(sphere) / (4.0 * PI * 0.09) - 1.0).abs() < 1e-9);
        assert!((ellipsoid_curvature(sphere, DVec3::new(0.0, 0.3, 0.0)) - 2.0 / 0.3).abs() < 1e-12);
        let eccentricity = 0.75_f64.sqrt();
        let prolate = TAU * (1.0 + 2.0 / eccentricity * eccentricity.asin());
        assert!((ellipsoid_area(DVec3::new(1.0, 1.0, 2.0)) / prolate - 1.0).abs() < 1e-6);
        // At the tip of a prolate spheroid both principal curvatures are c/a^2.
        assert!((ellipsoid_curvature(DVec3::new(1.0, 1.0, 2.0), DVec3::new(0.0, 0.0, 2.0)) - 4.0).abs() < 1e-12);
    }
}
