//! Films of revolution as stacks of rings: caps, walls between rings, and lids that close a region.
//!
//! ```text
//!      upper   o-----o-----o        Every ring has as many vertices as its length asks for; two rings are joined by always
//!             / \   / \   /         taking the shorter of the two diagonals. Seen from outside, with the ring running to
//!      lower o---o-+---o-+          the right, (lower, next lower, upper) turns left: its normal points to the viewer.
//! ```

use glam::DVec3;
use std::f64::consts::{PI, TAU};

use crate::surface::LabelledTriangles;

/// Height of an equilateral triangle of side 1.
const ROW: f64 = 0.866_025_403_784_438_6;

/// A circle in space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Circle {
    /// Its centre, metres.
    pub centre: DVec3,
    /// Unit vector about which it runs counter-clockwise.
    pub axis: DVec3,
    /// Its radius, metres.
    pub radius: f64,
}

impl Circle {
    /// A circle about `axis`, of any length; about `z` where it has none.
    #[must_use]
    pub fn new(centre: DVec3, axis: DVec3, radius: f64) -> Self {
        Self { centre, axis: axis.normalize_or(DVec3::Z), radius }
    }

    /// The circle moved along its axis by `height`, with another radius, metres.
    #[must_use]
    pub fn moved(&self, height: f64, radius: f64) -> Self {
        Self { centre: self.centre + height * self.axis, radius, ..*self }
    }

    /// Point at an angle, radians.
    #[must_use]
    pub fn point(&self, angle: f64) -> DVec3 {
        let (u, v) = self.axis.any_orthonormal_pair();
        // `any_orthonormal_pair` does not say which way round it is.
        let v = if u.cross(v).dot(self.axis) < 0.0 { -v } else { v };
        self.centre + self.radius * (angle.cos() * u + angle.sin() * v)
    }

    /// Vertices that edges of a length call for; at least six.
    #[must_use]
    pub fn vertices_for(&self, edge: f64) -> usize {
        ((TAU * self.radius / edge).round() as usize).max(6)
    }
}

/// Adds the vertices of a circle, counter-clockwise about its axis, the first at `phase` steps from angle zero.
pub fn add_ring(set: &mut LabelledTriangles, circle: &Circle, count: usize, phase: f64, pinned: bool) -> Vec<u32> {
    let angle = |k: usize| TAU * (k as f64 + phase) / count as f64;
    (0..count).map(|k| set.add_vertex(circle.point(angle(k)), pinned)).collect()
}

/// Joins two closed rings that run the same way.
pub fn join_rings(set: &mut LabelledTriangles, lower: &[u32], upper: &[u32], labels: [u32; 2]) {
    let at = |set: &LabelledTriangles, v: u32| set.positions[v as usize];
    let start = at(set, lower[0]);
    let distance = |set: &LabelledTriangles, v: u32| at(set, v).distance_squared(start);
    let nearest =
        (0..upper.len()).min_by(|i, j| distance(set, upper[*i]).total_cmp(&distance(set, upper[*j]))).unwrap_or(0);
    let closed =
        |ring: &[u32], first: usize| -> Vec<u32> { (0..=ring.len()).map(|k| ring[(first + k) % ring.len()]).collect() };
    join_rows(set, &closed(lower, 0), &closed(upper, nearest), labels);
}

/// Joins two open rows that run the same way, end to end.
pub fn join_rows(set: &mut LabelledTriangles, lower: &[u32], upper: &[u32], labels: [u32; 2]) {
    let (mut i, mut j) = (0, 0);
    while i + 1 < lower.len() || j + 1 < upper.len() {
        let diagonal = |set: &LabelledTriangles, a: u32, b: u32| {
            set.positions[a as usize].distance_squared(set.positions[b as usize])
        };
        let is_lower = match (lower.get(i + 1), upper.get(j + 1)) {
            (Some(next), Some(other)) => diagonal(set, *next, upper[j]) <= diagonal(set, lower[i], *other),
            (next, _) => next.is_some(),
        };
        if is_lower {
            set.add_film([lower[i], lower[i + 1], upper[j]], labels);
            i += 1;
        } else {
            set.add_film([lower[i], upper[j + 1], upper[j]], labels);
            j += 1;
        }
    }
}

/// Adds a spherical cap of a signed `height` over a rim (metres; above along the circle's axis), flat where it is zero.
///
/// `labels` are those under and over it, along the axis. `rim` holds the vertices of the circle, counter-clockwise about it.
/// Rows are at equal steps of arc; the sphere has the radius `(a^2 + h^2) / (2 h)`.
pub fn add_cap(set: &mut LabelledTriangles, rim: &[u32], circle: &Circle, height: f64, labels: [u32; 2], edge: f64) {
    let half_angle = 2.0 * (height / circle.radius).atan();
    let arc = if half_angle == 0.0 { circle.radius } else { circle.radius * half_angle / half_angle.sin() };
    let rows = ((arc / (ROW * edge)).round() as usize).max(1);
    let mut lower = rim.to_vec();
    for row in 1..rows {
        let [radius, rise] = cap_point(circle.radius, half_angle, row as f64 / rows as f64);
        let ring = circle.moved(rise, radius);
        let upper = add_ring(set, &ring, ring.vertices_for(edge), 0.5 * (row % 2) as f64, false);
        join_rings(set, &lower, &upper, labels);
        lower = upper;
    }
    let pole = set.add_vertex(circle.centre + height * circle.axis, false);
    fan(&lower, pole).for_each(|triangle| set.add_film(triangle, labels));
}

/// Distance from the axis and height over the rim of a cap, after a part of the arc from rim to pole.
fn cap_point(rim_radius: f64, half_angle: f64, part: f64) -> [f64; 2] {
    if half_angle == 0.0 {
        return [rim_radius * (1.0 - part), 0.0];
    }
    // cos(b) - cos(a) as a product: no digits are lost where the cap is nearly flat.
    let polar = half_angle * (1.0 - part);
    let radius = rim_radius / half_angle.sin();
    let rise = 2.0 * radius * (0.5 * (half_angle + polar)).sin() * (0.5 * (half_angle - polar)).sin();
    [radius * polar.sin(), rise]
}

/// Closes a loop of edges with ghosts to a new held vertex.
///
/// `labels` are those under and over the lid where the loop runs counter-clockwise seen from over it.
pub fn add_lid(set: &mut LabelledTriangles, rim: &[u32], apex: DVec3, labels: [u32; 2]) {
    let apex = set.add_vertex(apex, true);
    fan(rim, apex).for_each(|triangle| set.add_face(triangle, labels, true));
}

fn fan(ring: &[u32], apex: u32) -> impl Iterator<Item = [u32; 3]> {
    (0..ring.len()).map(move |k| [ring[k], ring[(k + 1) % ring.len()], apex])
}

/// Area and volume under a spherical cap of height `h` on a ring `a`: `pi (a^2 + h^2)`, `pi h (3 a^2 + h^2) / 6`.
#[must_use]
pub fn cap_measures(radius: f64, height: f64) -> [f64; 2] {
    let squares = radius.mul_add(radius, height * height);
    [PI * squares, PI * height * (2.0f64.mul_add(radius * radius, squares)) / 6.0]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn caps_from_flat_to_nearly_a_sphere_have_the_right_area_and_no_slivers() {
        use crate::shapes::measure::{edge_lengths, smallest_angle};
        for height in [0.0, 1e-9, 0.3, 1.0, 2.5, 6.0] {
            for edge in [0.3, 0.1, 0.07] {
                let mut set = LabelledTriangles::default();
                let circle = Circle::new(DVec3::new(0.2, -0.1, 3.0), DVec3::new(1.0, -2.0, 0.5), 1.0);
                let rim = add_ring(&mut set, &circle, circle.vertices_for(edge), 0.0, true);
                add_cap(&mut set, &rim, &circle, height, [1, 0], edge);
                let area = crate::Surface::from_triangles(&set).film_area();
                let exact = cap_measures(1.0, height)[0];
                let curvature = 2.0 * height / height.mul_add(height, 1.0);
                let bound = 0.3 * (edge * curvature).powi(2) + (edge * edge);
                assert!((area / exact - 1.0).abs() < bound, "height {height}, edge {edge}: {area} {exact}");
                let [shortest, mean, longest] = edge_lengths(&set);
                assert!((mean / edge - 1.0).abs() < 0.1, "height {height}, edge {edge}: {mean}");
                assert!(shortest > 0.6 * edge && longest < 1.5 * edge, "{shortest} {longest} {edge}");
                assert!(smallest_angle(&set) > 30.0, "height {height}, edge {edge}: {}", smallest_angle(&set));
            }
        }
    }
}
