//! Local quadratic fits of the film through its own particles: normals, curvature, and the surface between particles.
//!
//! # Equation
//! In the frame `(t1, t2, n)` of a particle the film is `z(u, v) = a u + b v + c u^2/2 + d u v + e v^2/2`.
//!
//! # Discretisation
//! Weighted least squares over the neighbours within `2.5 dx`, weight `(1 - q^2)^2`, through the particle itself.
//! Repeated in the frame just found, so that the slopes vanish and `S = grad n = -Hess z`.
//!
//! # Limits
//! Use the fit for normals, for lifting tangential moves and for projection, not for forces: its mean curvature is
//! not symmetric between particles and reads 1 % high at 1000 particles on a sphere.

use super::tangent::outer;
use crate::neighbours::lists::NeighbourLists;
use froth_components::film::ShapeOperator;
use froth_components::motion::{Normal, Position};
use glam::{DMat3, DVec3};
use rayon::prelude::*;

/// Smallest pivot of a fit relative to its diagonal; below it the points lie on a conic, or there are too few.
const LEAST_PIVOT: f64 = 1e-6;
/// Times the fit is repeated in the frame found last.
const REFITS: usize = 2;

/// A fitted frame.
#[derive(Clone, Copy, Debug)]
pub struct Fit {
    /// Unit normal, on the side of the normal the fit began with.
    pub normal: DVec3,
    /// `grad n`, symmetric and tangential, 1/m.
    pub shape: DMat3,
}

/// Refits every particle's normal and shape operator. Particles with fewer than five usable neighbours keep theirs.
pub fn refit_all(
    positions: &[Position],
    lists: &NeighbourLists,
    support: f64,
    normals: &mut [Normal],
    shapes: &mut [ShapeOperator],
) {
    normals.par_iter_mut().zip(shapes).enumerate().with_min_len(128).for_each(|(i, (normal, shape))| {
        let offsets = || lists.of(i).iter().map(|&j| positions[j as usize].0 - positions[i].0);
        if let Some(fit) = fit(normal.0, support, offsets) {
            normal.0 = fit.normal;
            shape.0 = fit.shape;
        }
    });
}

/// Fits the film through the origin from the offsets of its neighbours; `None` if they do not determine it.
pub fn fit<I: Iterator<Item = DVec3>>(normal: DVec3, support: f64, offsets: impl Fn() -> I) -> Option<Fit> {
    let mut normal = normal;
    let mut shape = DMat3::ZERO;
    for _ in 0..REFITS {
        let (t1, t2) = normal.any_orthonormal_pair();
        let [a, b, c, d, e] = coefficients(normal, t1, t2, support, offsets())?;
        normal = (normal - t1 * a - t2 * b).normalize();
        shape = outer(-c, t1, t1) + outer(-d, t1, t2) + outer(-d, t2, t1) + outer(-e, t2, t2);
    }
    Some(Fit { normal, shape })
}

fn coefficients(
    n: DVec3,
    t1: DVec3,
    t2: DVec3,
    support: f64,
    offsets: impl Iterator<Item = DVec3>,
) -> Option<[f64; 5]> {
    let scale = 1.0 / support;
    let [a, b, c, d, e] = least_squares([t1, t2, n], support, offsets, quadratic_basis)?;
    Some([a, b, c * scale, d * scale, e * scale])
}

fn quadratic_basis(u: f64, v: f64) -> [f64; 5] {
    [u, v, 0.5 * u * u, u * v, 0.5 * v * v]
}

fn quartic_basis(u: f64, v: f64) -> [f64; 14] {
    let (uu, uv, vv) = (u * u, u * v, v * v);
    [u, v, uu, uv, vv, u * uu, u * uv, u * vv, v * vv, uu * uu, uu * uv, uu * vv, uv * vv, vv * vv]
}

/// Height of the film above the tangent plane at the tangential offset `move_by` from a particle, by a quartic through
/// the particle itself. `None` if the neighbours do not determine a quartic.
///
/// A quadratic reads the curvature of a 0.1 R bump 5 to 10 % wrong; as a carrier slides to and fro over it, that error
/// would not average out but deflate the film, in proportion to the square of each move.
#[must_use]
pub fn height_along<I: Iterator<Item = DVec3>>(
    normal: DVec3,
    support: f64,
    offsets: impl Fn() -> I,
    move_by: DVec3,
) -> Option<f64> {
    let (t1, t2) = normal.any_orthonormal_pair();
    let fitted = least_squares([t1, t2, normal], support, offsets(), quartic_basis)?;
    let basis = quartic_basis(move_by.dot(t1) / support, move_by.dot(t2) / support);
    Some(support * fitted.iter().zip(&basis).map(|(c, b)| c * b).sum::<f64>())
}

/// Coefficients, in units of `support`, of the heights over `frame = [t1, t2, n]` in a basis that vanishes at the
/// origin; weight `(1 - q^2)^2`. `None` if the offsets do not determine them.
fn least_squares<const N: usize>(
    frame: [DVec3; 3],
    support: f64,
    offsets: impl Iterator<Item = DVec3>,
    basis: impl Fn(f64, f64) -> [f64; N],
) -> Option<[f64; N]> {
    let scale = 1.0 / support;
    let mut matrix = [[0.0; N]; N];
    let mut rhs = [0.0; N];
    for offset in offsets {
        let r = offset * scale;
        let q = r.length_squared();
        if q >= 1.0 {
            continue;
        }
        let basis = basis(r.dot(frame[0]), r.dot(frame[1]));
        let (weight, z) = ((1.0 - q) * (1.0 - q), r.dot(frame[2]));
        for (i, bi) in basis.iter().enumerate() {
            let wb = weight * bi;
            for (m, bj) in matrix[i][..=i].iter_mut().zip(&basis) {
                *m += wb * bj;
            }
            rhs[i] += wb * z;
        }
    }
    cholesky_solve(matrix, rhs)
}

/// Solves a symmetric positive definite system given by its lower triangle; `None` if a pivot all but vanishes.
fn cholesky_solve<const N: usize>(mut m: [[f64; N]; N], mut x: [f64; N]) -> Option<[f64; N]> {
    for i in 0..N {
        let whole = m[i][i];
        for k in 0..i {
            let sum: f64 = (0..k).map(|l| m[i][l] * m[k][l]).sum();
            m[i][k] = (m[i][k] - sum) / m[k][k];
        }
        let pivot = whole - m[i][..i].iter().map(|v| v * v).sum::<f64>();
        if !(pivot > LEAST_PIVOT * whole) {
            return None;
        }
        m[i][i] = pivot.sqrt();
        let sum: f64 = (0..i).map(|k| m[i][k] * x[k]).sum();
        x[i] = (x[i] - sum) / m[i][i];
    }
    for i in (0..N).rev() {
        let sum: f64 = (i + 1..N).map(|k| m[k][i] * x[k]).sum();
        x[i] = (x[i] - sum) / m[i][i];
    }
    Some(x)
}

/// Signed distance of `offset` (from the particle) above the particle's own quadratic, and that quadratic's normal
/// direction there (not normalised): the building blocks of a blended surface.
#[must_use]
#[inline]
pub fn height_above(offset: DVec3, normal: DVec3, shape: &DMat3) -> (f64, DVec3) {
    let slope = *shape * offset;
    (normal.dot(offset) + 0.5 * slope.dot(offset), normal + slope)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ring_of_points(film: impl Fn(f64, f64) -> f64) -> Vec<DVec3> {
        (0..40)
            .map(|i| (0.1 * (f64::from(i) / 40.0).sqrt(), 2.4 * f64::from(i)))
            .map(|(r, phi)| (r * phi.cos(), r * phi.sin()))
            .map(|(u, v)| DVec3::new(u, v, film(u, v)))
            .collect()
    }

    #[test]
    fn a_tilted_plane_is_recovered_exactly() {
        let points = ring_of_points(|u, v| 0.2 * u - 0.1 * v);
        let fit = fit(DVec3::Z, 0.12, || points.iter().copied()).expect("enough points");
        assert!(fit.normal.distance(DVec3::new(-0.2, 0.1, 1.0).normalize()) < 1e-12);
        assert!(fit.shape.to_cols_array().iter().all(|v| v.abs() < 1e-9));
    }

    #[test]
    fn a_saddle_has_its_principal_curvatures_and_sign() {
        let points = ring_of_points(|u, v| -0.5 * u * u + v * v);
        let fit = fit(DVec3::Z, 0.12, || points.iter().copied()).expect("enough points");
        assert!((fit.shape.x_axis.x - 1.0).abs() < 1e-2 && (fit.shape.y_axis.y + 2.0).abs() < 1e-2);
    }

    #[test]
    fn four_points_determine_no_quadratic() {
        let points = &ring_of_points(|_, _| 0.0)[..4];
        assert!(fit(DVec3::Z, 0.12, || points.iter().copied()).is_none());
    }

    #[test]
    fn a_point_on_the_quadratic_has_height_zero() {
        let shape = outer(2.0, DVec3::X, DVec3::X);
        let (height, direction) = height_above(DVec3::new(0.1, 0.3, -0.01), DVec3::Z, &shape);
        assert!(height.abs() < 1e-15);
        assert!(direction.distance(DVec3::new(0.2, 0.0, 1.0)) < 1e-15);
    }
}
