//! The standard double bubble: three spherical caps that meet at 120 degrees on a ring.
//!
//! ```text
//!        ring o            1/r_wall = 1/r2 - 1/r1, the wall bulges into the larger bubble
//!        .-'' | ''-.       c^2 = r1^2 + r2^2 - r1 r2   distance of the centres
//!      /      )     \      a = sqrt(3)/2 r1 r2 / c     radius of the ring
//!     |   1   )  2   | --> axis
//! ```
//!
//! Source: Plateau 1873; that it is the least area is Hutchings, Morgan, Ritore, Ros 2002.

use glam::DVec3;

use super::rings::{Circle, add_cap, add_ring, cap_measures};
use crate::surface::LabelledTriangles;

/// A double bubble, exact: `centre` is that of the ring, region 1 of outer radius `r1` lies against `axis`, 2 along it (metres).
#[must_use]
pub fn double_bubble(centre: DVec3, axis: DVec3, r1: f64, r2: f64, edge: f64) -> LabelledTriangles {
    let form = DoubleBubble::new(r1, r2);
    let ring = Circle::new(centre, axis, form.ring);
    let mut set = LabelledTriangles::default();
    let rim = add_ring(&mut set, &ring, ring.vertices_for(edge), 0.0, false);
    add_cap(&mut set, &rim, &ring, -form.heights[0], [0, 1], edge);
    add_cap(&mut set, &rim, &ring, form.heights[1], [2, 0], edge);
    add_cap(&mut set, &rim, &ring, -form.sag, [1, 2], edge);
    set
}

/// Closed form of a double bubble, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DoubleBubble {
    /// Radius of the ring.
    pub ring: f64,
    /// How high each outer cap rises over the plane of the ring.
    pub heights: [f64; 2],
    /// How far the wall bulges into bubble 1; negative where it bulges into bubble 2.
    pub sag: f64,
}

impl DoubleBubble {
    /// The form for two outer radii, metres.
    #[must_use]
    pub fn new(r1: f64, r2: f64) -> Self {
        let distance = (r1 * r1 + r2 * r2 - r1 * r2).sqrt();
        let ring = 0.75f64.sqrt() * r1 * r2 / distance;
        let plane = (distance * distance + r1 * r1 - r2 * r2) / (2.0 * distance);
        // a k, with the curvature k of the wall; R - sqrt(R^2 - a^2) without a difference, and without R where the wall is flat.
        let bend = ring * (r1 - r2) / (r1 * r2);
        let sag = ring * bend / (1.0 + (1.0 - bend * bend).max(0.0).sqrt());
        Self { ring, heights: [r1 + plane, r2 + distance - plane], sag }
    }

    /// Volumes of the two bubbles, m^3.
    #[must_use]
    pub fn volumes(&self) -> [f64; 2] {
        let under = |height: f64| cap_measures(self.ring, height)[1];
        let [first, second] = self.heights.map(under);
        [first - under(self.sag), second + under(self.sag)]
    }

    /// Area of the three films, m^2.
    #[must_use]
    pub fn area(&self) -> f64 {
        [self.heights[0], self.heights[1], self.sag].map(|height| cap_measures(self.ring, height)[0]).iter().sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes::measure::{assert_second_order, checked, edges_with, smallest_angle};
    use std::f64::consts::PI;

    #[test]
    fn the_closed_form_has_the_published_numbers() {
        for (radii, volumes, area) in [
            ([0.05, 0.03], [5.00614e-4, 7.49744e-5], 0.037_534_31),
            ([0.05, 0.04], [4.74044e-4, 2.05615e-4], 0.043_863_78),
        ] {
            let form = DoubleBubble::new(radii[0], radii[1]);
            let found = form.volumes();
            assert!((found[0] / volumes[0] - 1.0).abs() < 3e-6, "{found:?}");
            assert!((found[1] / volumes[1] - 1.0).abs() < 3e-6, "{found:?}");
            assert!((form.area() / area - 1.0).abs() < 2e-7, "{}", form.area());
        }
        let equal = DoubleBubble::new(1.0, 1.0);
        assert!((equal.area() - 27.0 * PI / 4.0).abs() < 1e-13);
        assert!((equal.volumes()[0] - 9.0 * PI / 8.0).abs() < 1e-14);
        assert_eq!(equal.sag, 0.0);
    }

    #[test]
    fn volumes_and_area_converge_at_second_order_for_all_ratios() {
        for r2 in [1.0, 0.999_999, 0.6, 0.25, 1.7] {
            let form = DoubleBubble::new(1.0, r2);
            let errors = [0.16, 0.08, 0.04].map(|edge| {
                let set =
                    double_bubble(DVec3::new(1.0, 0.0, 4.0), DVec3::new(0.2, 1.0, 0.1), 1.0, r2, edge * r2.min(1.0));
                assert!(smallest_angle(&set) > 28.0, "{r2}: {}", smallest_angle(&set));
                let surface = checked(&set);
                let volumes = surface.volumes();
                let wanted = form.volumes();
                [volumes[1] / wanted[0] - 1.0, volumes[2] / wanted[1] - 1.0, surface.film_area() / form.area() - 1.0]
            });
            (0..3).for_each(|k| assert_second_order(errors.map(|e| e[k])));
            assert!(errors[2].iter().all(|e| e.abs() < 2e-3), "{errors:?}");
        }
    }

    #[test]
    fn the_ring_has_three_faces_everywhere_and_the_rest_two() {
        let surface = checked(&double_bubble(DVec3::ZERO, DVec3::X, 1.0, 0.6, 0.1));
        let ring = Circle::new(DVec3::ZERO, DVec3::X, DoubleBubble::new(1.0, 0.6).ring);
        assert_eq!(edges_with(&surface, 3), ring.vertices_for(0.1));
        assert_eq!(edges_with(&surface, 2) + edges_with(&surface, 3), surface.mesh.edges().len());
    }

    #[test]
    fn films_meet_at_120_degrees() {
        let form = DoubleBubble::new(1.0, 0.6);
        // Angle of a cap against the plane of the ring: 2 atan(h / a).
        let angle = |height: f64| 2.0 * (height / form.ring).atan().to_degrees();
        assert!((angle(form.heights[0]) - angle(form.sag) - 120.0).abs() < 1e-12);
        assert!((angle(form.heights[1]) + angle(form.sag) - 120.0).abs() < 1e-12);
    }
}
