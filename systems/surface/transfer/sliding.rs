//! What becomes of data when the mesh slides along the films, which themselves stay: values are looked up where vertices arrive,
//! amounts flow between their cells.
//!
//! Equation: with the displacement `d` of a vertex within face `(v, a, b)`, `d = s (a - v) + t (b - v)`, its value becomes
//! `(1 - s - t) q_v + s q_a + t q_b`. Around a vertex lies its share of every face, bounded by the way from the middle of an edge
//! to the middle of the face; where that way moves by `e` to the side of the other vertex, it sweeps the area `e . nu` and brings
//! the amount per area found there.
//! Limits: first order in displacements per step; amounts keep their sum to round-off.

use glam::DVec3;
use smallvec::SmallVec;

use crate::mesh::Face;
use crate::rows::{PerVertex, VertexRow};
use crate::surface::Surface;

/// Vertices and weights, adding up to 1, whose mean is the value where a vertex arrives; `None` where it stays.
pub(crate) fn weights_at(
    surface: &Surface,
    vertex: VertexRow,
    slide: DVec3,
) -> Option<SmallVec<[(VertexRow, f64); 3]>> {
    if slide == DVec3::ZERO {
        return None;
    }
    let of_face = |face: Face| {
        let [a, b] = face.around(vertex);
        let (p, q) =
            (surface.positions[a] - surface.positions[vertex], surface.positions[b] - surface.positions[vertex]);
        let (pp, pq, qq) = (p.length_squared(), p.dot(q), q.length_squared());
        let determinant = pp * qq - pq * pq;
        if !(determinant > 0.0) {
            return None;
        }
        let (along_p, along_q) = (slide.dot(p), slide.dot(q));
        let (s, t) = ((along_p * qq - along_q * pq) / determinant, (along_q * pp - along_p * pq) / determinant);
        Some((s.min(t), [(a, s.max(0.0)), (b, t.max(0.0))]))
    };
    let films = surface.mesh.faces_of(vertex).iter().map(|row| surface.mesh.face(*row)).filter(|face| !face.is_ghost());
    // The face into which the vertex goes is the one with both parts positive, or nearest to it.
    let best = films.filter_map(of_face).reduce(|best, next| if next.0 > best.0 { next } else { best });
    let (_, [(a, s), (b, t)]) = best?;
    let scale = if s + t > 1.0 { (s + t).recip() } else { 1.0 };
    let (s, t) = (s * scale, t * scale);
    Some(SmallVec::from_slice(&[(vertex, 1.0 - s - t), (a, s), (b, t)]))
}

/// Calls `flow(a, b, area)` for every pair of vertices of a film: `a` gains that area from `b` (loses it where negative), m^2.
pub(super) fn exchange_areas(
    surface: &Surface,
    slides: &PerVertex<DVec3>,
    mut flow: impl FnMut(VertexRow, VertexRow, f64),
) {
    for (row, face) in surface.mesh.faces().filter(|(_, face)| !face.is_ghost()) {
        let vertices = face.vertices();
        let moved = vertices.map(|v| slides[v]);
        if moved == [DVec3::ZERO; 3] {
            continue;
        }
        let Some(normal) = surface.double_area_normal(row).try_normalize() else { continue };
        let corners = surface.corners(row);
        let (middle, middle_moves) = (corners.iter().sum::<DVec3>() / 3.0, moved.iter().sum::<DVec3>() / 3.0);
        for (i, j) in [(0, 1), (1, 2), (2, 0)] {
            let way = middle - corners[i].midpoint(corners[j]);
            let side = way.cross(normal);
            let side = if side.dot(corners[j] - corners[i]) > 0.0 { side } else { -side };
            let moves = 0.5 * (0.5 * (moved[i] + moved[j]) + middle_moves);
            flow(vertices[i], vertices[j], moves.dot(side));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes::{disc, icosphere};
    use crate::smoothing::tangential_displacements;
    use crate::transfer::{Amounts, Columns, Transfer};

    fn areas(surface: &Surface) -> Vec<f64> {
        let mut areas = vec![0.0; surface.positions.len()];
        for (row, face) in surface.mesh.faces().filter(|(_, face)| !face.is_ghost()) {
            face.vertices().iter().for_each(|v| areas[v.index()] += surface.area(row) / 3.0);
        }
        areas
    }

    #[test]
    fn a_linear_field_on_a_flat_film_is_looked_up_exactly() {
        let surface = Surface::from_triangles(&disc(DVec3::ZERO, 1.0, DVec3::Z, 0.2));
        let field = |x: DVec3| 3.0 * x.x - 2.0 * x.y + 1.0;
        let mut columns = Columns::new(1, surface.positions.iter().map(|x| field(*x)).collect());
        let slides = tangential_displacements(&surface, 0.5, 0.02);
        columns.slide(&surface, &slides);
        for v in surface.mesh.vertices().filter(|v| !surface.pinned[*v]) {
            let expected = field(surface.positions[v] + slides[v]);
            assert!((columns.of(v)[0] - expected).abs() < 1e-12, "{v}");
        }
    }

    #[test]
    fn amounts_keep_their_sum_and_an_even_film_stays_even() {
        let mut surface = Surface::from_triangles(&icosphere(DVec3::ZERO, 1.0, 0.2));
        // An uneven mesh of a sphere, so that there is something to smooth.
        surface.positions.0.iter_mut().for_each(|x| *x = (*x + 0.2 * x.x * x.y * DVec3::Z).normalize());
        let mut amounts = Amounts::new(areas(&surface));
        let (whole, before) = (amounts.values().iter().sum::<f64>(), areas(&surface));
        let slides = tangential_displacements(&surface, 0.2, 0.02);
        amounts.slide(&surface, &slides);
        assert!((amounts.values().iter().sum::<f64>() / whole - 1.0).abs() < 1e-14);
        surface.positions.0.iter_mut().zip(slides.iter()).for_each(|(x, d)| *x += *d);
        let after = areas(&surface);
        let spread = |areas: &[f64]| {
            let off = amounts.values().iter().zip(areas).map(|(m, a)| (m / a - 1.0).abs());
            off.fold(0.0, f64::max)
        };
        // With the areas of before, the amounts are uneven by what the cells changed; with those of after, by second order alone.
        assert!(spread(&after) < 0.1 * spread(&before), "{} {}", spread(&after), spread(&before));
    }
}
