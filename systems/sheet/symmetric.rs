//! Pseudo-inverse of a symmetric 3x3 matrix that is positive semidefinite: what a vertex's volume gradients can say.
//!
//! Discretisation: cyclic Jacobi rotations, which give small eigenvalues to high relative accuracy (Golub and Van Loan, §8.5).

use glam::{DMat3, DVec3};

/// Sweeps after which the off-diagonal has long vanished: convergence is quadratic.
const MOST_SWEEPS: u32 = 12;

/// Inverse on the range of a matrix, and the projector onto that range.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RangeInverse {
    /// `M+`.
    pub inverse: DMat3,
    /// `P = M M+`, dimensionless.
    pub projector: DMat3,
}

impl RangeInverse {
    /// Of `n n^T + n n^T`: a vertex in the middle of a film, with volume gradients `n` and `-n`. The inverse is no larger than that of gradients of
    /// length `least`.
    #[must_use]
    pub fn of_film(n: DVec3, least: f64) -> Self {
        let square = n.length_squared();
        if !(square > 0.0) {
            return Self { inverse: DMat3::ZERO, projector: DMat3::ZERO };
        }
        let projector = outer(n, n) * square.recip();
        Self { inverse: projector * (0.5 / square.max(least * least)), projector }
    }

    /// Of a symmetric matrix; eigenvalues below `cut` times the largest, or below `least`, are dropped.
    #[must_use]
    pub fn of(matrix: DMat3, cut: f64, least: f64) -> Self {
        let (values, vectors) = eigen(matrix);
        let least = least.max(cut * values.max_element());
        let mut range = Self { inverse: DMat3::ZERO, projector: DMat3::ZERO };
        for (value, vector) in values.to_array().into_iter().zip([vectors.x_axis, vectors.y_axis, vectors.z_axis]) {
            if value > least && value > 0.0 {
                let along = outer(vector, vector);
                range.inverse += along * value.recip();
                range.projector += along;
            }
        }
        range
    }
}

/// `a b^T`.
#[must_use]
#[inline]
pub fn outer(a: DVec3, b: DVec3) -> DMat3 {
    DMat3::from_cols(a * b.x, a * b.y, a * b.z)
}

/// Eigenvalues and eigenvectors (as columns) of a symmetric matrix.
#[must_use]
pub fn eigen(matrix: DMat3) -> (DVec3, DMat3) {
    let mut a = matrix.to_cols_array_2d();
    let mut vectors = DMat3::IDENTITY.to_cols_array_2d();
    for _ in 0..MOST_SWEEPS {
        let off = a[1][0].abs() + a[2][0].abs() + a[2][1].abs();
        if off <= f64::MIN_POSITIVE {
            break;
        }
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            rotate(&mut a, &mut vectors, p, q);
        }
    }
    (DVec3::new(a[0][0], a[1][1], a[2][2]), DMat3::from_cols_array_2d(&vectors))
}

/// One Jacobi rotation that makes `a[p][q]` zero.
fn rotate(a: &mut [[f64; 3]; 3], vectors: &mut [[f64; 3]; 3], p: usize, q: usize) {
    if a[p][q] == 0.0 {
        return;
    }
    let theta = 0.5 * (a[q][q] - a[p][p]) / a[p][q];
    let t = if theta.is_finite() { theta.signum() / (theta.abs() + theta.hypot(1.0)) } else { 0.0 };
    let c = t.hypot(1.0).recip();
    let s = t * c;
    let r = 3 - p - q;
    let (app, aqq, apq, arp, arq) = (a[p][p], a[q][q], a[p][q], a[r][p], a[r][q]);
    a[p][p] = app - t * apq;
    a[q][q] = aqq + t * apq;
    (a[p][q], a[q][p]) = (0.0, 0.0);
    (a[r][p], a[r][q]) = (c * arp - s * arq, s * arp + c * arq);
    (a[p][r], a[q][r]) = (a[r][p], a[r][q]);
    let (x, y) = (DVec3::from(vectors[p]), DVec3::from(vectors[q]));
    (vectors[p], vectors[q]) = ((c * x - s * y).to_array(), (s * x + c * y).to_array());
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(a: DMat3, b: DMat3, tolerance: f64) -> bool {
        (a - b).to_cols_array().iter().all(|x| x.abs() <= tolerance)
    }

    #[test]
    fn eigenvectors_rebuild_the_matrix() {
        let a = DMat3::from_cols_array(&[4.0, 1.0, -2.0, 1.0, 3.0, 0.5, -2.0, 0.5, 1.5]);
        let (values, vectors) = eigen(a);
        let rebuilt = vectors * DMat3::from_diagonal(values) * vectors.transpose();
        assert!(close(rebuilt, a, 1e-14));
        assert!(close(vectors.transpose() * vectors, DMat3::IDENTITY, 1e-15));
    }

    #[test]
    fn the_inverse_of_a_film_is_that_of_its_matrix() {
        let n = DVec3::new(0.3e-6, -1.2e-6, 0.7e-6);
        let (closed, general) = (RangeInverse::of_film(n, 0.0), RangeInverse::of(outer(n, n) * 2.0, 1e-3, 0.0));
        assert!(close(closed.projector, general.projector, 1e-14));
        assert!(close(closed.inverse * n.length_squared(), general.inverse * n.length_squared(), 1e-14));
    }

    #[test]
    fn two_films_at_an_angle_leave_one_direction_out() {
        let (a, b) = (DVec3::X, DVec3::new(-0.5, 0.75f64.sqrt(), 0.0));
        let m = outer(a, a) + outer(b, b);
        let range = RangeInverse::of(m, 1e-3, 0.0);
        assert!(close(m * range.inverse, range.projector, 1e-14));
        assert!((range.projector * DVec3::Z).length() < 1e-15);
        assert!(close(range.projector * DMat3::from_diagonal(DVec3::new(1.0, 1.0, 0.0)), range.projector, 1e-14));
    }

    #[test]
    fn a_matrix_of_rank_three_is_inverted() {
        let a = DMat3::from_cols_array(&[4.0, 1.0, -1.0, 1.0, 3.0, 0.5, -1.0, 0.5, 1.5]);
        assert!(close(RangeInverse::of(a, 1e-3, 0.0).inverse * a, DMat3::IDENTITY, 1e-14));
    }
}
