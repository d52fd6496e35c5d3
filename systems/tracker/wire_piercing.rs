//! Wires that go through films instead of along them.
//!
//! A wire is cut into pieces of half an edge length at most. A piece that is farther than an edge from every vertex the wire holds,
//! and crosses a face (by exact predicates), pierces the film.

use std::f64::consts::TAU;

use froth_components::authored::wire::WirePath;
use froth_surface::grid::Aabb;
use froth_surface::kernel::crossing::segment_crosses_triangle;
use froth_surface::{Surface, VertexRow};
use glam::DVec3;

/// Most pieces that a wire is cut into.
const MOST_PIECES: usize = 100_000;

/// Whether a wire goes through a film somewhere away from the vertices that it holds. `edge`: edge length of the mesh, metres.
#[must_use]
pub fn pierces(surface: &Surface, held: &[VertexRow], wire: &WirePath, edge: f64) -> bool {
    let is_away = |x: DVec3| held.iter().all(|v| surface.positions[*v].distance(x) > edge);
    let films = || surface.mesh.faces().filter(|(_, face)| !face.is_ghost());
    let crosses = |[a, b]: [DVec3; 2]| {
        let middle = a.midpoint(b);
        is_away(middle)
            && films().any(|(row, _)| {
                let corners = surface.corners(row);
                Aabb::of(&corners).padded(edge).contains(middle) && segment_crosses_triangle(a, b, corners)
            })
    };
    pieces(wire, 0.5 * edge).into_iter().any(crosses)
}

/// The wire as straight pieces of at most `longest` metres.
fn pieces(wire: &WirePath, longest: f64) -> Vec<[DVec3; 2]> {
    let cut = |[a, b]: [DVec3; 2]| {
        let count = ((a.distance(b) / longest).ceil() as usize).clamp(1, MOST_PIECES);
        let at = move |k: usize| a.lerp(b, k as f64 / count as f64);
        (0..count).map(move |k| [at(k), at(k + 1)])
    };
    match wire {
        WirePath::Line(line) => line.segments().flat_map(cut).collect(),
        WirePath::Ring(ring) => {
            let (axis, radius) = (ring.axis.unit(), ring.radius.si());
            let first = axis.any_orthonormal_vector();
            let second = axis.cross(first);
            let count = ((TAU * radius / longest).ceil() as usize).clamp(12, MOST_PIECES);
            let at = |k: usize| {
                let (sin, cos) = (TAU * k as f64 / count as f64).sin_cos();
                ring.centre.si() + radius * (cos * first + sin * second)
            };
            (0..count).map(|k| [at(k), at(k + 1)]).collect()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tracker::wires::read_path;
    use froth_surface::shapes::icosphere;

    #[test]
    fn a_wire_through_a_bubble_pierces_it_and_one_beside_or_around_it_does_not() {
        let bubble = Surface::from_triangles(&icosphere(DVec3::ZERO, 1.0, 0.2));
        let through = read_path("Line(points: [(-2, 0.03, 0.01), (2, 0.03, 0.01)])");
        assert!(pierces(&bubble, &[], &through, 0.2));
        assert!(!pierces(&bubble, &[], &read_path("Line(points: [(-2, 1.2, 0), (2, 1.2, 0)])"), 0.2));
        let ring = read_path("Ring(axis: (0.1, 1, 0.2), radius: 1)");
        let held: Vec<VertexRow> = bubble
            .mesh
            .vertices()
            .filter(|v| ring.nearest(bubble.positions[*v]).distance(bubble.positions[*v]) < 0.1)
            .collect();
        assert!(!pierces(&bubble, &held, &ring, 0.2));
        assert!(pierces(
            &bubble,
            &[],
            &read_path("Ring(centre: (1, 0.013, 0.007), axis: (0.1, 1, 0.05), radius: 0.5)"),
            0.2
        ));
    }
}
