//! Mean curvature of films.
//!
//! # Equation
//! Where the film is at rest, tension and pressure balance: `T ∂A/∂x = p ∂V/∂x`, and `p = 2 T H`. So `2H` is estimated
//! as `∂A/∂x · n / |∂V/∂x|` with the gradient of the volume on one side of the film in place of the vertex area.
//!
//! # Limits
//! At a single vertex with irregular neighbours the estimate does not converge, as is known for cotangent curvature;
//! means over a film do, at second order.

use std::collections::BTreeMap;

use glam::DVec3;

use super::area::{area_gradient, vertex_normals};
use super::incidence::Incidence;
use super::weights::Weights;
use crate::rows::{PerVertex, Region, VertexRow};
use crate::surface::Surface;

/// Mean curvature `H` of each manifold vertex, 1/m: positive where the region with the *larger* label bulges out (a bubble
/// in the outside has `1/R`). `None` on junctions, on rims and at ghosts.
#[must_use]
pub fn mean_curvatures(surface: &Surface) -> PerVertex<Option<f64>> {
    let (gradient, normals) = gradient_and_normals(surface);
    let incidence = Incidence::new(surface);
    let measured = gradient.iter().zip(&normals).enumerate().map(|(v, (gradient, [normal, _]))| {
        let area = normal.length();
        let is_measured = is_inside(surface, &incidence, VertexRow(v as u32)) && area > 0.0;
        is_measured.then(|| -gradient.dot(*normal) / (2.0 * area * area))
    });
    PerVertex(measured.collect())
}

/// Mean of `H` over the manifold vertices of the films between each pair of regions, 1/m; signs as in [`mean_curvatures`].
#[must_use]
pub fn curvatures_between(surface: &Surface) -> BTreeMap<[Region; 2], f64> {
    let (gradient, normals) = gradient_and_normals(surface);
    let incidence = Incidence::new(surface);
    let mut sums: BTreeMap<[Region; 2], [f64; 2]> = BTreeMap::new();
    for vertex in surface.mesh.vertices().filter(|v| is_inside(surface, &incidence, *v)) {
        let mut labels = surface.mesh.face(surface.mesh.faces_of(vertex)[0]).labels();
        labels.sort_unstable();
        let [normal, _] = normals[vertex.index()];
        let sum = sums.entry(labels).or_default();
        sum[0] -= gradient[vertex.index()].dot(normal.normalize_or_zero());
        sum[1] += 2.0 * normal.length();
    }
    sums.into_iter().filter(|(_, [_, area])| *area > 0.0).map(|(pair, [sum, area])| (pair, sum / area)).collect()
}

/// Whether a vertex is free, in the middle of a film and on no ghost.
fn is_inside(surface: &Surface, incidence: &Incidence, vertex: VertexRow) -> bool {
    let has_ghost = || surface.mesh.faces_of(vertex).iter().any(|face| surface.mesh.face(*face).is_ghost());
    incidence.sides(vertex.index()).count == 2 && !surface.pinned[vertex] && !has_ghost()
}

fn gradient_and_normals(surface: &Surface) -> (Vec<DVec3>, Vec<[DVec3; 2]>) {
    let incidence = Incidence::new(surface);
    let mut gradient = vec![DVec3::ZERO; surface.positions.len()];
    let mut normals = vec![[DVec3::ZERO; 2]; gradient.len()];
    area_gradient(&incidence, &surface.positions, Weights::Uniform(1.0), &mut gradient);
    vertex_normals(&incidence, &surface.positions, &mut normals);
    (gradient, normals)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::calculus::test_shapes::{double_bubble, icosphere};

    #[test]
    fn a_sphere_has_curvature_one_over_radius_to_second_order() {
        let errors: Vec<f64> = [2, 3, 4]
            .map(|level| (curvatures_between(&icosphere(2.0, level))[&[Region(0), Region(1)]] * 2.0 - 1.0).abs())
            .to_vec();
        assert!(errors[2] < 1e-3, "{errors:?}");
        assert!(errors[0] / errors[1] > 3.6 && errors[1] / errors[2] > 3.6, "{errors:?}");
    }

    #[test]
    fn the_wall_of_a_double_bubble_bulges_into_the_larger() {
        let curvatures = curvatures_between(&double_bubble(1.0, 0.7, 12));
        let wall = curvatures[&[Region(1), Region(2)]];
        // 1/R_p = 1/R_2 - 1/R_1, positive: the smaller bubble, region 2, bulges out.
        assert!((wall - (1.0 / 0.7 - 1.0)).abs() < 0.01, "{wall}");
        assert!((curvatures[&[Region(0), Region(1)]] - 1.0).abs() < 0.02, "{curvatures:?}");
    }
}
