//! A film between two rings: the catenoid, `r(z) = c cosh(z / c)`, where there is one.
//!
//! With `u = h / c`, `h` half the gap and `R` the radius of the rings: `u / cosh(u) = h / R`. Up to `h / R = 0.6627434` there
//! are two solutions; the one with the smaller `u` is stable. Beyond, the film begins as a cylinder and pinches off.

use glam::DVec3;

use super::rings::{Circle, add_lid, add_ring, join_rings};
use crate::surface::LabelledTriangles;

/// `u tanh(u) = 1`: the catenoid of the widest gap.
const WIDEST: f64 = 1.199_678_640_257_734;

/// A film between two held rings, `gap` apart along `axis` (metres): an exact catenoid, or a cylinder where there is none.
///
/// The air inside is region 1, which is open. Ghosts close it, from each ring to a held vertex one radius beyond it, so that
/// the discs of a film that has pinched off do not touch them.
#[must_use]
pub fn catenoid(centre: DVec3, axis: DVec3, ring_radius: f64, gap: f64, edge: f64) -> LabelledTriangles {
    let middle = Circle::new(centre, axis, ring_radius);
    let profile = Profile::new(ring_radius, 0.5 * gap);
    let rows = ((profile.arc() / (0.75f64.sqrt() * edge)).round() as usize).max(2);
    let mut set = LabelledTriangles { open: vec![1], ..Default::default() };
    let rings: Vec<Vec<u32>> = (0..=rows)
        .map(|row| {
            let [height, radius] = profile.point(2.0 * row as f64 / rows as f64 - 1.0);
            let ring = middle.moved(height, radius);
            add_ring(&mut set, &ring, ring.vertices_for(edge), 0.5 * (row % 2) as f64, row == 0 || row == rows)
        })
        .collect();
    rings.windows(2).for_each(|pair| join_rings(&mut set, &pair[0], &pair[1], [1, 0]));
    let beyond = (0.5 * gap + ring_radius) * middle.axis;
    add_lid(&mut set, &rings[rows], centre + beyond, [1, 0]);
    add_lid(&mut set, &rings[0], centre - beyond, [0, 1]);
    set
}

/// Radius of the neck of the stable catenoid between rings of a radius, half a gap `half_gap` from the middle (metres).
#[must_use]
pub fn neck_radius(ring_radius: f64, half_gap: f64) -> Option<f64> {
    let ratio = half_gap / ring_radius;
    if !(ratio > 0.0 && ratio <= WIDEST / WIDEST.cosh()) {
        return None;
    }
    let (mut low, mut high) = (0.0, WIDEST);
    for _ in 0..80 {
        let u = 0.5 * (low + high);
        if u / u.cosh() < ratio { low = u } else { high = u }
    }
    Some(ring_radius / (0.5 * (low + high)).cosh())
}

/// Half a profile, from the middle to a ring.
struct Profile {
    neck: Option<f64>,
    ring_radius: f64,
    half_gap: f64,
}

impl Profile {
    fn new(ring_radius: f64, half_gap: f64) -> Self {
        Self { neck: neck_radius(ring_radius, half_gap), ring_radius, half_gap }
    }

    /// Length from ring to ring, metres.
    fn arc(&self) -> f64 {
        2.0 * self.neck.map_or(self.half_gap, |c| c * (self.half_gap / c).sinh())
    }

    /// Height over the middle and radius, after a part of the arc from the middle to a ring; both rings are exact.
    fn point(&self, part: f64) -> [f64; 2] {
        match self.neck {
            Some(c) if part.abs() < 1.0 => {
                let along = (part * (self.half_gap / c).sinh()).asinh();
                [c * along, c * along.cosh()]
            }
            _ => [part * self.half_gap, self.ring_radius],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes::measure::{assert_second_order, checked, smallest_angle};

    #[test]
    fn the_neck_has_the_published_width() {
        for (half_gap, neck) in [(0.25, 0.967_521), (0.5, 0.848_338), (0.6, 0.745_071), (0.662_743_4, 0.552_4)] {
            let found = neck_radius(1.0, half_gap).expect("below the widest gap");
            assert!((found - neck).abs() < if half_gap > 0.65 { 3e-4 } else { 6e-7 }, "{half_gap}: {found}");
        }
        assert_eq!(neck_radius(1.0, 0.663), None);
    }

    #[test]
    fn the_area_converges_at_second_order() {
        for (half_gap, area) in [(0.25, 3.108_112), (0.5, 5.991_797), (0.6, 6.999_643)] {
            let errors = [0.2, 0.1, 0.05].map(|edge| {
                let set = catenoid(DVec3::X, DVec3::new(1.0, 1.0, 0.0), 1.0, 2.0 * half_gap, edge);
                assert!(smallest_angle(&set) > 30.0, "{half_gap} {edge}: {}", smallest_angle(&set));
                checked(&set).film_area() / area - 1.0
            });
            assert!(errors[2].abs() < 1.5e-3, "{errors:?}");
            // Two opposite curvatures: the error is small, and rows and columns share it differently at each size.
            assert!((errors[0] / errors[2]).abs() > 6.0, "{errors:?}");
        }
    }

    #[test]
    fn rings_too_far_apart_hold_a_cylinder() {
        let errors = [0.2, 0.1, 0.05].map(|edge| {
            let set = catenoid(DVec3::ZERO, DVec3::Z, 1.0, 1.5, edge);
            checked(&set).film_area() / (3.0 * std::f64::consts::PI) - 1.0
        });
        assert_second_order(errors);
    }
}
