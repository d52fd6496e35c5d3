//! Where a smooth film has the middle of an edge: modified butterfly inside films, cubic interpolation along junction curves.
//!
//! ```text
//!         e1---c---f1
//!          \  / \  /       a and b with six neighbours:  (a + b)/2 + (c + d)/8 - (e1 + e2 + f1 + f2)/16
//!           a-----b        otherwise, from the ring r0 = b, r1, ... of a:  3/4 a + sum of s_j r_j
//!          /  \ /  \
//!         e2---d---f2
//! ```
//!
//! Equation: `s_j = (1/4 + cos(2 pi j/K) + cos(4 pi j/K)/2)/K` for a ring of `K >= 5`; `5/12, -1/12, -1/12` for three and
//! `3/8, 0, -1/8, 0` for four. Where both ends count and neither has six neighbours, it is the mean of the two. A junction curve goes on
//! as the cubic through four vertices of it, by chord lengths; with even edges `9/16 (a + b) - 1/16 (before + after)`.
//! Source: Zorin, Schröder, Sweldens 1996; Dyn, Levin, Gregory 1987.
//! `DEVIATION`: an end on a junction or a wire has no say, and an edge between two such has its middle; the paper mirrors the ring of
//! such a vertex, but a film does not go on smoothly beyond a junction.
//! Limits: rings are taken as even, so where edges of a film differ much, a part of the bulge is missed.

use glam::DVec3;
use smallvec::SmallVec;

use super::Session;
use super::collapse::{Rank, rank};
use super::plan::Plan;
use crate::policy::Policy;
use crate::rows::VertexRow;
use crate::smoothing::junction_neighbours;
use crate::surface::Surface;

/// The neighbours of a vertex inside a film, in order around it.
type Ring = SmallVec<[VertexRow; 8]>;

/// Where the smooth film or curve has the middle of an edge, metres; `None` where that cannot be told, or a wire holds an end.
pub(super) fn smooth_middle(surface: &Surface, a: VertexRow, b: VertexRow) -> Option<DVec3> {
    if surface.pinned[a] || surface.pinned[b] {
        return None;
    }
    match surface.mesh.faces_of_edge(a, b).len() {
        2 => within_film(surface, a, b),
        _ => along_curve(surface, a, b),
    }
}

fn within_film(surface: &Surface, a: VertexRow, b: VertexRow) -> Option<DVec3> {
    let x = |v: VertexRow| surface.positions[v];
    let sum = |weights: &[(VertexRow, f64)]| weights.iter().map(|(v, weight)| x(*v) * *weight).sum::<DVec3>();
    match (ring(surface, a, b), ring(surface, b, a)) {
        (Some(p), Some(q)) if p.len() == 6 && q.len() == 6 => {
            let wings = x(p[2]) + x(p[4]) + x(q[2]) + x(q[4]);
            Some(0.5 * (x(a) + x(b)) + (x(p[1]) + x(p[5])) / 8.0 - wings / 16.0)
        }
        (Some(p), Some(q)) if p.len() != 6 && q.len() != 6 => {
            Some(sum(&from_ring(a, &p)).midpoint(sum(&from_ring(b, &q))))
        }
        (Some(p), q) if p.len() != 6 || q.is_none() => Some(sum(&from_ring(a, &p))),
        (_, Some(q)) => Some(sum(&from_ring(b, &q))),
        _ => None,
    }
}

/// Weights of a vertex and its ring for the middle of the edge to the first of the ring; they add up to 1.
fn from_ring(vertex: VertexRow, ring: &Ring) -> SmallVec<[(VertexRow, f64); 9]> {
    let count = ring.len() as f64;
    let part = |j: usize| match (ring.len(), j) {
        (3, 0) => 5.0 / 12.0,
        (3, _) => -1.0 / 12.0,
        (4, 0) => 3.0 / 8.0,
        (4, 2) => -1.0 / 8.0,
        (4, _) => 0.0,
        _ => {
            let angle = std::f64::consts::TAU * j as f64 / count;
            (0.25 + angle.cos() + 0.5 * (2.0 * angle).cos()) / count
        }
    };
    std::iter::once((vertex, 0.75)).chain(ring.iter().enumerate().map(|(j, v)| (*v, part(j)))).collect()
}

/// The neighbours of a vertex in order around it, from `first`; `None` unless it lies inside one film. Of the two directions, the one
/// that comes to the lower row first.
fn ring(surface: &Surface, vertex: VertexRow, first: VertexRow) -> Option<Ring> {
    let mesh = &surface.mesh;
    let faces = mesh.faces_of(vertex);
    if rank(surface, vertex) != Rank::Film || faces.iter().any(|row| mesh.face(*row).is_ghost()) || faces.len() < 3 {
        return None;
    }
    let beyond = |from: VertexRow| {
        mesh.faces_of_edge(vertex, from).into_iter().map(move |row| mesh.face(row).opposite(vertex, from))
    };
    let mut ring: Ring = SmallVec::from_slice(&[first, beyond(first).min()?]);
    while ring.len() <= faces.len() {
        let [.., before, last] = ring[..] else { return None };
        let next = beyond(last).find(|v| *v != before)?;
        if next == first {
            break;
        }
        ring.push(next);
    }
    // Where two films touch in a point, the way around one of them is shorter.
    (ring.len() == faces.len()).then_some(ring)
}

/// The cubic through four vertices of a junction curve, in the middle of the edge between the inner two.
fn along_curve(surface: &Surface, a: VertexRow, b: VertexRow) -> Option<DVec3> {
    let next = |end: VertexRow, other: VertexRow| {
        let on_curve = rank(surface, end) == Rank::Curve;
        junction_neighbours(surface, end).into_iter().find(|v| *v != other).filter(|_| on_curve)
    };
    let [p, a, b, q] = [next(a, b)?, a, b, next(b, a)?].map(|v| surface.positions[v]);
    let (before, middle, after) = (p.distance(a), 0.5 * a.distance(b), b.distance(q));
    // Chord lengths along the curve, from the middle of the edge.
    let at = [-middle - before, -middle, middle, middle + after];
    let weight = |i: usize| (0..4).filter(|j| *j != i).map(|j| -at[j] / (at[i] - at[j])).product::<f64>();
    let place = [p, a, b, q].into_iter().enumerate().map(|(i, x)| x * weight(i)).sum::<DVec3>();
    place.is_finite().then_some(place)
}

impl Session<'_> {
    /// Moves the vertex of a split from the middle of its edge, `length` metres long, to where the smooth film is, unless that is farther
    /// than [`Policy::LARGEST_BULGE`], films are in the way, or a face comes to be of bad shape.
    ///
    /// Each region gains or loses what lies between the edge and the film; whoever moves the films gives bubbles their volumes back.
    pub(super) fn bulge(&mut self, vertex: VertexRow, to: DVec3, length: f64) -> bool {
        if to.distance(self.surface.positions[vertex]) > Policy::LARGEST_BULGE * length {
            return false;
        }
        let mut plan = Plan::default();
        plan.move_vertex(self.surface, vertex, to);
        plan.note_reshaped(self.surface);
        if self.turns_over(&plan) || !self.is_well_shaped(&plan) || self.tangles(&plan) || self.is_blocked(&plan) {
            return false;
        }
        self.commit(&plan);
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes::{double_bubble, icosphere};

    /// Distances of the middles of all edges from a sphere of radius 1: largest of the chords, largest and mean of the smooth film.
    fn errors(edge: f64) -> [f64; 3] {
        let surface = Surface::from_triangles(&icosphere(DVec3::ZERO, 1.0, edge));
        let off = |x: DVec3| (x.length() - 1.0).abs();
        let edges = surface.mesh.edges();
        let share = 1.0 / edges.len() as f64;
        edges.into_iter().fold([0.0; 3], |[chord, largest, mean]: [f64; 3], [a, b]| {
            let middle = surface.positions[a].midpoint(surface.positions[b]);
            let smooth = off(smooth_middle(&surface, a, b).unwrap());
            [chord.max(off(middle)), largest.max(smooth), mean + share * smooth]
        })
    }

    #[test]
    fn weights_of_a_ring_add_up_to_one_and_keep_what_is_linear() {
        for count in 3..12 {
            let ring: Ring = (1..=count).map(VertexRow).collect();
            let weights = from_ring(VertexRow(0), &ring);
            let place = |v: VertexRow| match v.0 {
                0 => DVec3::ZERO,
                v => {
                    let (sin, cos) = (std::f64::consts::TAU * f64::from(v - 1) / f64::from(count)).sin_cos();
                    DVec3::new(cos, sin, 0.0)
                }
            };
            let sum: f64 = weights.iter().map(|(_, weight)| weight).sum();
            let middle: DVec3 = weights.iter().map(|(v, weight)| place(*v) * *weight).sum();
            assert!((sum - 1.0).abs() < 1e-15 && (middle - 0.5 * DVec3::X).length() < 1e-15, "{count}: {sum} {middle}");
        }
    }

    #[test]
    fn smooth_middles_of_a_sphere_converge_at_a_higher_order_than_those_of_chords() {
        let errors = [0.2, 0.1, 0.05].map(errors);
        for pair in errors.windows(2) {
            let [chord, largest, mean] = [0, 1, 2].map(|i| (pair[0][i] / pair[1][i]).log2());
            // The rule is of order 4 on an even mesh; edges of an icosphere vary, and twelve vertices have five neighbours.
            assert!((chord - 2.0).abs() < 0.1 && largest > 2.5 && mean > 2.9, "{errors:?}: {chord} {largest} {mean}");
        }
        assert!(errors.iter().all(|[chord, largest, _]| *largest < 0.15 * chord), "{errors:?}");
    }

    #[test]
    fn the_border_of_a_double_bubble_is_split_on_its_circle() {
        let surface = Surface::from_triangles(&double_bubble(DVec3::ZERO, DVec3::X, 1.0, 0.8, 0.2));
        let on_border = |[a, b]: &[VertexRow; 2]| surface.mesh.faces_of_edge(*a, *b).len() == 3;
        let border: Vec<[VertexRow; 2]> = surface.mesh.edges().into_iter().filter(on_border).collect();
        let off_axis = |x: DVec3| x.reject_from_normalized(DVec3::X).length();
        let [first, _] = border[0];
        let radius = off_axis(surface.positions[first]);
        for [a, b] in border {
            let chord = radius - off_axis(surface.positions[a].midpoint(surface.positions[b]));
            let smooth = (off_axis(smooth_middle(&surface, a, b).unwrap()) - radius).abs();
            assert!(smooth < 0.05 * chord, "{smooth:e} {chord:e}");
        }
    }
}
