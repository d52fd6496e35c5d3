//! Laws of the stencil on a sphere and on a walled square.

use super::*;
use froth_components::identity::RegionId;
use std::f64::consts::PI;

struct Cloud {
    positions: Vec<Position>,
    normals: Vec<Normal>,
    regions: Vec<InRegion>,
    wall: Vec<Position>,
    wall_regions: Vec<InRegion>,
    spacing: f64,
}

impl Cloud {
    fn new(points: Vec<(DVec3, DVec3)>, wall: Vec<DVec3>, spacing: f64) -> Self {
        Self {
            regions: vec![InRegion(RegionId(1)); points.len()],
            wall_regions: vec![InRegion(RegionId(1)); wall.len()],
            positions: points.iter().map(|p| Position(p.0)).collect(),
            normals: points.iter().map(|p| Normal(p.1)).collect(),
            wall: wall.into_iter().map(Position).collect(),
            spacing,
        }
    }

    fn sphere(count: usize) -> Self {
        let golden = PI * (3.0 - 5.0_f64.sqrt());
        let direction = |i: usize| {
            let z = 1.0 - (2.0 * i as f64 + 1.0) / count as f64;
            let (sin, cos) = (golden * i as f64).sin_cos();
            let r = (1.0 - z * z).sqrt();
            DVec3::new(r * cos, r * sin, z)
        };
        let points = (0..count).map(direction).map(|n| (n, n)).collect();
        Self::new(points, Vec::new(), (4.0 * PI / count as f64).sqrt())
    }

    /// A square of `side` x `side` particles with five layers of wall around.
    fn square(side: i32) -> Self {
        let h = 1.0 / f64::from(side);
        let place = |i: i32, j: i32| {
            let jitter = 0.15 * f64::from((i * 7 + j * 13).rem_euclid(11)) / 11.0;
            DVec3::new(f64::from(i) + 0.5 + jitter, f64::from(j) + 0.5 - jitter, 0.0) * h
        };
        let (mut points, mut wall) = (Vec::new(), Vec::new());
        for i in -5..side + 5 {
            for j in -5..side + 5 {
                let inside = (0..side).contains(&i) && (0..side).contains(&j);
                if inside {
                    points.push((place(i, j), DVec3::Z));
                } else {
                    wall.push(place(i, j));
                }
            }
        }
        Self::new(points, wall, h)
    }

    fn points(&self) -> Points<'_> {
        Points {
            positions: &self.positions,
            normals: &self.normals,
            regions: &self.regions,
            wall: &self.wall,
            wall_regions: &self.wall_regions,
            spacing: self.spacing,
        }
    }
}

#[test]
fn the_areas_of_a_sphere_sum_to_its_area() {
    for count in [500, 2000] {
        let cloud = Cloud::sphere(count);
        let total: f64 = Stencil::build(cloud.points()).areas.iter().sum();
        assert!((total / (4.0 * PI) - 1.0).abs() < 5e-4, "{count}: {}", total / (4.0 * PI));
    }
}

#[test]
fn the_curvature_force_of_a_sphere_is_two_over_radius_and_sums_to_zero() {
    let cloud = Cloud::sphere(2000);
    let stencil = Stencil::build(cloud.points());
    let force = |i: usize| stencil.weighted_offsets(&cloud.positions, i).map(|(_, w, d)| d * w).sum::<DVec3>();
    let total: DVec3 = (0..2000).map(force).sum();
    let curvature: f64 =
        (0..2000).map(|i| -force(i).dot(cloud.normals[i].0)).sum::<f64>() / stencil.areas.iter().sum::<f64>();
    assert!(total.length() < 1e-12);
    assert!((curvature - 2.0).abs() < 2e-3, "{curvature}");
}

#[test]
fn operators_are_exact_for_constants_and_linear_fields_also_at_walls() {
    let cloud = Cloud::square(16);
    let stencil = Stencil::build(cloud.points());
    let slope = DVec3::new(0.7, -1.3, 0.0);
    for i in 0..stencil.len() {
        assert!(stencil.laplacian(i, |_| 4.2).abs() < 1e-13);
        let gradient = stencil.gradient(&cloud.positions, &cloud.normals, i, |j| 3.0 + slope.dot(cloud.positions[j].0));
        assert!(gradient.distance(slope) < 1e-11, "{i}: {gradient}");
    }
}

#[test]
fn the_flux_divergence_sums_to_zero_and_the_gradient_is_its_adjoint() {
    let cloud = Cloud::square(12);
    let stencil = Stencil::build(cloud.points());
    let u = |i: usize| DVec3::new((i as f64).sin(), (2.0 * i as f64).cos(), 0.0);
    let q = |i: usize| (0.7 * i as f64).sin();
    let divergence = |i: usize| stencil.flux_divergence(&cloud.positions, i, u);
    let total: f64 = (0..stencil.len()).map(divergence).sum();
    let work: f64 = (0..stencil.len()).map(|i| q(i) * divergence(i)).sum();
    let gradient = |i: usize| stencil.adjoint_gradient(&cloud.positions, &cloud.normals, i, q);
    let adjoint: f64 = (0..stencil.len()).map(|i| u(i).dot(gradient(i))).sum();
    assert!(total.abs() < 1e-13 && (work + adjoint).abs() < 1e-13, "{total} {work} {adjoint}");
}

#[test]
fn facing_sheets_are_not_neighbours() {
    let mut cloud = Cloud::square(6);
    let back: Vec<Position> = cloud.positions.iter().map(|p| Position(p.0 + DVec3::Z * 0.01)).collect();
    cloud.normals.extend(vec![Normal(-DVec3::Z); back.len()]);
    cloud.regions.extend(vec![InRegion(RegionId(1)); back.len()]);
    cloud.positions.extend(back);
    let stencil = Stencil::build(cloud.points());
    assert!((0..36).all(|i| stencil.lists.of(i).iter().all(|&j| j < 36)));
}
