//! A quadratic height field through a point, fitted to points around it: slopes that are right to second order.
//!
//! # Equation
//! `z(s, w) = a s + b w + c s^2 + d s w + e w^2`, least squares with weights `1 / (s^2 + w^2)`. A smooth film differs from
//! it by cubic terms, so the slopes `(a, b)` at the point err by the square of the spacing.
//!
//! A film at rest between two bubbles is often a sphere or a plane: `z = o + a s + b w + c (s^2 + w^2 + z^2)`, of every radius. Fitted
//! to all points within a fixed distance, it evens out what is wrong with the places of single vertices.

/// Slopes `[∂z/∂s, ∂z/∂w]` at the origin, dimensionless, of the quadric through the origin nearest to `points`
/// `[s, w, z]`.
///
/// With too few points for a quadric a plane is fitted; `None` where even that is undetermined.
#[must_use]
pub fn slopes(points: &[[f64; 3]]) -> Option<[f64; 2]> {
    let size = points.iter().map(|[s, w, _]| s.hypot(*w)).fold(0.0, f64::max);
    if !(size > 0.0) {
        return None;
    }
    let near = |s: f64, w: f64| 1.0 / (s * s + w * w).max(1e-12);
    fit::<5>(points, size, near, |[s, w, _]| [s, w, s * s, s * w, w * w])
        .map(|c| [c[0], c[1]])
        .or_else(|| fit::<2>(points, size, near, |[s, w, _]| [s, w]).map(|c| [c[0], c[1]]))
}

/// Slopes `[∂z/∂s, ∂z/∂w]` at the origin, dimensionless, of the sphere or plane nearest to `points` `[s, w, z]` and the origin, all of
/// equal weight; it need not pass through any of them. `None` where it is undetermined.
#[must_use]
pub fn sphere_slopes(points: &[[f64; 3]]) -> Option<[f64; 2]> {
    let size = points.iter().map(|[s, w, _]| s.hypot(*w)).fold(0.0, f64::max);
    if !(size > 0.0) {
        return None;
    }
    let points: Vec<[f64; 3]> = points.iter().copied().chain([[0.0; 3]]).collect();
    fit::<4>(&points, size, |_, _| 1.0, |[s, w, z]| [1.0, s, w, s * s + w * w + z * z]).map(|c| [c[1], c[2]])
}

/// Coefficients of the basis, in units of `size`; `None` if the normal equations are singular.
fn fit<const N: usize>(
    points: &[[f64; 3]],
    size: f64,
    weight: impl Fn(f64, f64) -> f64,
    basis: impl Fn([f64; 3]) -> [f64; N],
) -> Option<[f64; N]> {
    if points.len() < N {
        return None;
    }
    let mut matrix = [[0.0; N]; N];
    let mut right = [0.0; N];
    for [s, w, z] in points.iter().map(|point| point.map(|x| x / size)) {
        let (weight, row) = (weight(s, w), basis([s, w, z]));
        for i in 0..N {
            right[i] += weight * row[i] * z;
            (0..N).for_each(|j| matrix[i][j] += weight * row[i] * row[j]);
        }
    }
    solve(matrix, right)
}

/// Gaussian elimination of a symmetric positive definite system; `None` where a pivot falls under 1e-9 of its diagonal.
fn solve<const N: usize>(mut matrix: [[f64; N]; N], mut right: [f64; N]) -> Option<[f64; N]> {
    let diagonal: [f64; N] = std::array::from_fn(|i| matrix[i][i]);
    for k in 0..N {
        if !(matrix[k][k] > 1e-9 * diagonal[k]) {
            return None;
        }
        for i in k + 1..N {
            let factor = matrix[i][k] / matrix[k][k];
            (k..N).for_each(|j| matrix[i][j] -= factor * matrix[k][j]);
            right[i] -= factor * right[k];
        }
    }
    for k in (0..N).rev() {
        right[k] -= (k + 1..N).map(|j| matrix[k][j] * right[j]).sum::<f64>();
        right[k] /= matrix[k][k];
    }
    Some(right)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quadric_is_found_exactly() {
        let points: Vec<[f64; 3]> = (0..8)
            .map(|i| {
                let (s, w) = (1e-6 * f64::from(i).sin(), 1e-6 * (1.0 + f64::from(i * i).cos()));
                [s, w, 0.3 * s - 0.2 * w + 1e5 * (s * s - 3.0 * s * w + 0.5 * w * w)]
            })
            .collect();
        let [a, b] = slopes(&points).unwrap();
        assert!((a - 0.3).abs() < 1e-9 && (b + 0.2).abs() < 1e-9, "{a} {b}");
    }

    #[test]
    fn the_slopes_of_spheres_and_planes_are_found_exactly() {
        let (a, b) = (0.3, -0.2);
        let normal = glam::DVec3::new(-a, -b, 1.0).normalize();
        let (along, across) = normal.any_orthonormal_pair();
        for curvature in [0.0, 1e-3, 0.5, -1.0] {
            // A chord of length d from the origin rises above the tangent plane by the angle whose sine is d / 2R.
            let points: Vec<[f64; 3]> = (0..9)
                .map(|i| {
                    let (angle, chord) = (f64::from(i), 0.2 + 0.08 * f64::from(i));
                    let rise = (0.5 * curvature * chord).asin();
                    let way = along * angle.cos() + across * angle.sin();
                    ((way * rise.cos() + normal * rise.sin()) * chord).to_array()
                })
                .collect();
            let [s, w] = sphere_slopes(&points).unwrap();
            assert!((s - a).abs() < 1e-9 && (w - b).abs() < 1e-9, "{curvature}: {s} {w}");
        }
        assert_eq!(sphere_slopes(&[]), None);
    }

    #[test]
    fn three_points_give_a_plane_and_points_in_a_line_nothing() {
        let plane = slopes(&[[1.0, 0.0, 0.5], [0.0, 1.0, 0.25], [1.0, 1.0, 0.75]]).unwrap();
        assert!((plane[0] - 0.5).abs() < 1e-12 && (plane[1] - 0.25).abs() < 1e-12);
        assert_eq!(slopes(&[[1.0, 0.0, 0.5], [2.0, 0.0, 1.0], [3.0, 0.0, 1.5]]), None);
        assert_eq!(slopes(&[]), None);
    }
}
