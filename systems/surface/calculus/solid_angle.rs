//! Solid angles of triangles: what winds around a point, and what a film of sources does there.

use glam::DVec3;

/// Solid angle of a triangle seen from the origin, positive from behind (van Oosterom and Strackee 1983); 0 where it is seen edge-on.
#[must_use]
pub fn solid_angle([a, b, c]: [DVec3; 3]) -> f64 {
    let [x, y, z] = [a, b, c].map(DVec3::length);
    let along = x * y * z + a.dot(b) * z + b.dot(c) * x + c.dot(a) * y;
    2.0 * a.dot(b.cross(c)).atan2(along)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn an_octant_is_an_eighth_of_the_whole_whatever_its_size() {
        for scale in [1e-6, 1.0, 1e6] {
            let corners = [DVec3::X, DVec3::Y * 2.0, DVec3::Z].map(|x| x * scale);
            assert!((solid_angle(corners) - 0.5 * PI).abs() < 1e-14);
            assert!((solid_angle([corners[1], corners[0], corners[2]]) + 0.5 * PI).abs() < 1e-14);
        }
    }
}
