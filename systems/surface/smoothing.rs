//! Tangential smoothing: vertices move along their films towards the middle of their neighbours, which keeps triangles even.
//!
//! It is a motion of the mesh, not of the film: displacements are tangential, so shape and volumes change at second order only.
//! Vertices on a curve where films meet move along the curve; points where such curves meet, and held vertices, stay.

use glam::DVec3;
use smallvec::SmallVec;

use crate::policy::Policy;
use crate::rows::{FaceRow, PerVertex, VertexRow};
use crate::surface::Surface;

/// Displacements, metres: `strength` (0 to 1) times the way to the middle, at most `longest` metres.
#[must_use]
pub fn tangential_displacements(surface: &Surface, strength: f64, longest: f64) -> PerVertex<DVec3> {
    let rows = (0..surface.mesh.vertex_rows() as u32).map(VertexRow);
    let of = |v| {
        let way = (towards_middle(surface, v) * strength).clamp_length_max(longest);
        if narrows(surface, v, way) { DVec3::ZERO } else { way }
    };
    PerVertex(rows.map(of).collect())
}

/// Whether a displacement makes an angle around a vertex smaller than all were, below [`Policy::GOOD_ANGLE`].
fn narrows(surface: &Surface, vertex: VertexRow, way: DVec3) -> bool {
    if way == DVec3::ZERO {
        return false;
    }
    let after = largest_cosine(surface, vertex, surface.positions[vertex] + way);
    after > Policy::GOOD_ANGLE.cos() && after > largest_cosine(surface, vertex, surface.positions[vertex])
}

/// Cosine of the least angle of all faces of a vertex, if it were at a place.
fn largest_cosine(surface: &Surface, vertex: VertexRow, place: DVec3) -> f64 {
    let of_face = |row: &FaceRow| {
        let [p, q] = surface.mesh.face(*row).around(vertex).map(|v| surface.positions[v]);
        let [along_p, along_q, across] = [p - place, q - place, q - p].map(DVec3::normalize_or_zero);
        along_p.dot(along_q).max(-along_p.dot(across)).max(along_q.dot(across))
    };
    surface.mesh.faces_of(vertex).iter().map(of_face).fold(-1.0, f64::max)
}

fn towards_middle(surface: &Surface, vertex: VertexRow) -> DVec3 {
    if surface.pinned[vertex] {
        return DVec3::ZERO;
    }
    let junction = junction_neighbours(surface, vertex);
    match junction.as_slice() {
        [] => within_film(surface, vertex),
        [a, b] => along_curve(surface.positions[vertex], surface.positions[*a], surface.positions[*b]),
        _ => DVec3::ZERO,
    }
}

/// Ends of the vertex's edges that have not two faces.
pub(crate) fn junction_neighbours(surface: &Surface, vertex: VertexRow) -> SmallVec<[VertexRow; 4]> {
    let faces = surface.mesh.faces_of(vertex);
    let mut ends: SmallVec<[VertexRow; 32]> =
        faces.iter().flat_map(|row| surface.mesh.face(*row).around(vertex)).collect();
    ends.sort_unstable();
    ends.chunk_by(|a, b| a == b).filter(|faces| faces.len() != 2).map(|faces| faces[0]).collect()
}

fn along_curve(x: DVec3, a: DVec3, b: DVec3) -> DVec3 {
    let tangent = (b - a).normalize_or_zero();
    tangent * (a.midpoint(b) - x).dot(tangent)
}

/// From a vertex to the mean of its neighbours, less its part along the normal; equal weights, so that small faces beside large ones stay.
fn within_film(surface: &Surface, vertex: VertexRow) -> DVec3 {
    let x = surface.positions[vertex];
    let (mut middle, mut normal, mut whole) = (DVec3::ZERO, DVec3::ZERO, 0.0);
    let mut side = None;
    for row in surface.mesh.faces_of(vertex) {
        let [a, b, c] = surface.corners(*row);
        let along = (b - a).cross(c - a);
        // The vertex itself adds nothing; each neighbour is in two faces.
        middle += ((a - x) + (b - x) + (c - x)) / 2.0;
        // One film: its faces have the same two regions, in one order or the other.
        let front = surface.mesh.face(*row).labels()[1];
        normal += if front == *side.get_or_insert(front) { along } else { -along };
        whole += 1.0;
    }
    let Some(normal) = normal.try_normalize().filter(|_| whole > 0.0) else { return DVec3::ZERO };
    (middle / whole).reject_from_normalized(normal)
}
