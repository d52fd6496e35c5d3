//! Vectors between tangent planes.

use glam::{DMat2, DMat3, DVec2, DVec3};

/// The part of `v` perpendicular to the unit normal `n`.
#[must_use]
#[inline]
pub fn tangential(v: DVec3, n: DVec3) -> DVec3 {
    v - n * n.dot(v)
}

/// The smallest rotation that takes one unit normal into another, applied to vectors.
///
/// # Equation
/// `R v = v - s (s.v)/(1 + a.b) + 2 b (a.v)` with `s = a + b`.
///
/// # Source
/// Rodrigues' formula, for unit vectors `a` and `b`, as two reflections. DEVIATION from Deng 2022, table 1 (projection): over one round trip between the particle sets
/// on a sphere of 1000 Eulerian particles, projection loses 40 to 200 times more kinetic energy.
#[derive(Clone, Copy, Debug)]
pub struct MinimalRotation {
    from: DVec3,
    to: DVec3,
    scale: f64,
}

impl MinimalRotation {
    /// The rotation that takes unit vector `a` into unit vector `b`; they must not be opposite.
    #[must_use]
    #[inline]
    pub fn between(a: DVec3, b: DVec3) -> Self {
        Self { from: a, to: b, scale: 1.0 / (1.0 + a.dot(b)).max(f64::EPSILON) }
    }

    /// `R v`.
    #[must_use]
    #[inline]
    pub fn apply(&self, v: DVec3) -> DVec3 {
        let (own, other) = (self.from.dot(v), self.to.dot(v));
        let along = (own + other) * self.scale;
        v - self.from * along + self.to * (2.0 * own - along)
    }

    /// `R` as a matrix.
    #[must_use]
    pub fn matrix(&self) -> DMat3 {
        DMat3::from_cols(self.apply(DVec3::X), self.apply(DVec3::Y), self.apply(DVec3::Z))
    }
}

/// `v v^T` weighted by `weight`.
#[must_use]
#[inline]
pub fn outer(weight: f64, a: DVec3, b: DVec3) -> DMat3 {
    DMat3::from_cols(a * (weight * b.x), a * (weight * b.y), a * (weight * b.z))
}

/// Inverse, within the plane perpendicular to `n`, of a symmetric tangential matrix; zero if its determinant in the
/// plane is below `1e-6` of its squared trace (points on a line, or none), where no inverse can be trusted.
#[must_use]
pub fn tangential_inverse(m: DMat3, n: DVec3) -> DMat3 {
    let trace = m.x_axis.x + m.y_axis.y + m.z_axis.z;
    let filled = m + outer(trace, n, n);
    // The filled matrix has the plane's determinant times `trace`.
    if filled.determinant() <= 1e-6 * trace * trace * trace {
        return DMat3::ZERO;
    }
    filled.inverse() - outer(1.0 / trace, n, n)
}

/// `v v^T` in a plane, weighted by `weight`.
#[must_use]
#[inline]
pub fn plane_outer(weight: f64, v: DVec2) -> DMat2 {
    DMat2::from_cols(v * (weight * v.x), v * (weight * v.y))
}

/// As [`tangential_inverse`], in coordinates of the plane.
#[must_use]
#[inline]
pub fn plane_inverse(m: DMat2) -> DMat2 {
    let trace = m.x_axis.x + m.y_axis.y;
    if m.determinant() <= 1e-6 * trace * trace { DMat2::ZERO } else { m.inverse() }
}

/// A matrix given in coordinates along two tangents, as one in space.
#[must_use]
#[inline]
pub fn in_space(m: DMat2, [t1, t2]: [DVec3; 2]) -> DMat3 {
    let column = |c: DVec2| t1 * c.x + t2 * c.y;
    outer(1.0, column(m.x_axis), t1) + outer(1.0, column(m.y_axis), t2)
}

/// The minimal rotation of `v` from the plane of `a` into that of `b`, but for a part along `b`, which the caller
/// removes: `v - a ((a + b).v) / (1 + a.b)`.
///
/// Sums of rotated vectors can be made [`tangential`] once, after the sum.
#[must_use]
#[inline]
pub fn nearly_rotated(v: DVec3, a: DVec3, b: DVec3) -> DVec3 {
    v - a * ((a + b).dot(v) / (1.0 + a.dot(b)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_short_rotation_is_the_minimal_one_in_the_plane() {
        let (a, b) = (DVec3::new(0.0, 0.6, 0.8), DVec3::new(1.0, 2.0, 2.0) / 3.0);
        let v = DVec3::new(0.3, -1.0, 2.0);
        let whole = MinimalRotation::between(a, b).apply(v);
        assert!(tangential(nearly_rotated(v, a, b), b).distance(tangential(whole, b)) < 1e-15);
    }

    #[test]
    fn the_plane_inverse_agrees_with_the_tangential_one() {
        let n = DVec3::new(1.0, 2.0, 2.0) / 3.0;
        let tangents: [DVec3; 2] = n.any_orthonormal_pair().into();
        let v = DVec2::new(2.0, -0.5);
        let m = plane_outer(2.0, v) + plane_outer(1.0, DVec2::Y);
        let difference = tangential_inverse(in_space(m, tangents), n) - in_space(plane_inverse(m), tangents);
        assert!(difference.to_cols_array().iter().all(|d| d.abs() < 1e-13));
        assert_eq!(plane_inverse(plane_outer(2.0, v)), DMat2::ZERO);
    }

    #[test]
    fn the_minimal_rotation_takes_one_normal_into_the_other_and_keeps_lengths() {
        let (a, b) = (DVec3::new(0.0, 0.6, 0.8), DVec3::new(1.0, 2.0, 2.0) / 3.0);
        let rotation = MinimalRotation::between(a, b);
        let v = DVec3::new(0.3, -1.0, 2.0);
        assert!(rotation.apply(a).distance(b) < 1e-15);
        assert!((rotation.apply(v).length() - v.length()).abs() < 1e-15);
        assert!((rotation.matrix() * v).distance(rotation.apply(v)) < 1e-15);
    }

    #[test]
    fn the_tangential_inverse_undoes_the_matrix_in_the_plane() {
        let n = DVec3::new(1.0, 2.0, 2.0) / 3.0;
        let (t1, t2) = n.any_orthonormal_pair();
        let m = outer(2.0, t1, t1) + outer(0.5, t2, t2);
        let v = t1 * 3.0 - t2;
        assert!((tangential_inverse(m, n) * (m * v)).distance(v) < 1e-12);
        assert_eq!(tangential_inverse(outer(2.0, t1, t1), n), DMat3::ZERO);
    }
}
