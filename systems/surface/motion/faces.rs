//! Keeps a face from folding over or losing its area while its vertices move.
//!
//! # Equation
//! With `n(t) = (b - a) x (c - a)`, `n(0) . n(t) >= FLATTEN |n(0)|^2` on the way: then the face has turned by less than 90 degrees
//! and has kept that part of its area. The left side is a quadratic in `t`.
//!
//! # Limits
//! A face without area has nothing to lose and is not guarded.

use glam::DVec3;

use crate::rows::VertexRow;

/// Part of its area, seen along its first normal, that a face keeps; dimensionless.
pub(super) const FLATTEN: f64 = 0.1;

/// A face that some choice of fractions could fold.
pub(super) struct Guard {
    pub(super) vertices: [VertexRow; 3],
}

/// Whether some fractions of the shifts (metres) could fold a face with corners `x`.
pub(super) fn can_fold([a, b, c]: [DVec3; 3], shift: [DVec3; 3]) -> bool {
    let (ab, ac) = (b - a, c - a);
    // Each side changes by `m` at most: |n(0) . (n(t) - n(0))| <= |n(0)| m (|ab| + |ac| + m).
    let longest = shift.map(|u| u.length_squared()).into_iter().fold(0.0, f64::max).sqrt();
    let change = 2.0 * longest;
    let loss = change * (ab.length() + ac.length() + change);
    let most = 1.0 - FLATTEN;
    loss * loss >= most * most * ab.cross(ac).length_squared()
}

/// First time at which a face folds or flattens, if it does within the unit of time.
pub(super) fn folding_time([a, b, c]: [DVec3; 3], shift: [DVec3; 3]) -> Option<f64> {
    let (ab, ac) = (b - a, c - a);
    let (du, dv) = (shift[1] - shift[0], shift[2] - shift[0]);
    let normal = ab.cross(ac);
    let area = normal.length_squared();
    let linear = normal.dot(du.cross(ac) + ab.cross(dv));
    let square = normal.dot(du.cross(dv));
    if !(area > 0.0) {
        return None;
    }
    first_root((1.0 - FLATTEN) * area, linear, square).filter(|t| *t < 1.0)
}

/// Least positive root of `c + b t + a t^2` with `c > 0`.
fn first_root(c: f64, b: f64, a: f64) -> Option<f64> {
    let discriminant = b * b - 4.0 * a * c;
    if discriminant < 0.0 {
        return None;
    }
    // With c > 0, 2c / (sqrt - b) is the least positive root of either sign of a, and loses no digits where b < 0.
    let divisor = discriminant.sqrt() - b;
    (divisor > 0.0).then(|| 2.0 * c / divisor)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn points() -> impl Strategy<Value = [DVec3; 3]> {
        prop::array::uniform3(prop::array::uniform3(-1.0..1.0f64).prop_map(DVec3::from_array))
    }

    proptest! {
        #[test]
        fn the_folding_time_is_the_first_sample_that_is_flat(x in points(), u in points()) {
            let normal = |t: f64| {
                let [a, b, c] = [0, 1, 2].map(|i| x[i] + u[i] * t);
                (b - a).cross(c - a)
            };
            let kept = |t: f64| normal(0.0).dot(normal(t)) / normal(0.0).length_squared();
            prop_assume!(normal(0.0).length() > 1e-3);
            let time = folding_time(x, u);
            for k in 0..=100 {
                let t = time.unwrap_or(1.0) * f64::from(k) / 100.0;
                prop_assert!(kept(t) >= FLATTEN - 1e-9);
            }
            if let Some(time) = time {
                prop_assert!((kept(time) - FLATTEN).abs() < 1e-6 && can_fold(x, u));
            }
        }

        #[test]
        fn what_cannot_fold_does_not_with_any_fractions(x in points(), u in points(), k in prop::array::uniform3(0.0..1.0f64), small in 0.0..0.2f64) {
            let u = u.map(|u| u * small);
            if !can_fold(x, u) {
                prop_assert_eq!(folding_time(x, [0, 1, 2].map(|i| u[i] * k[i])), None);
            }
        }
    }
}
