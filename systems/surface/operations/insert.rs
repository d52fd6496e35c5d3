//! Insertion of a vertex into a film, with the flips that follow from it in one plan.
//!
//! A thin face and the one across one of its edges are the first hole; the new vertex is joined to all edges around it. Then the hole
//! grows over an edge `(p, q)` to the face `(p, q, r)` beyond, as long as that makes the smallest angle there larger:
//!
//! ```text
//!       p                    p
//!      /|\                  / \           (w, p, q) and (p, q, r) become (w, p, r) and (w, r, q).
//!     w | r       ->       w---r
//!      \|/                  \ /
//!       q                    q
//! ```
//!
//! Equation: the volumes of the two regions are linear in the place `w` of the new vertex, with gradient `N/3`, `N` the area normal of the
//! rim; so `w` is shifted along `N` to where both stay as they are.
//!
//! Without [`Policy::flips`] the hole does not grow.
//! Discretisation: the best of a grid of places on the face across. Junctions, ghosts and edges on wires bound the hole.

use glam::DVec3;
use smallvec::{SmallVec, smallvec};

use super::plan::{Added, Plan};
use super::{Session, checks};
use crate::policy::Policy;
use crate::rows::{FaceRow, VertexRow};
use crate::transfer::Blend;

/// Angles that differ by less are taken as equal, radians: rounding must not decide.
const TIE: f64 = 1e-9;

/// The faces that a new vertex takes the place of, and their rim: edges with the face inside.
#[derive(Clone)]
struct Hole {
    faces: SmallVec<[FaceRow; 8]>,
    rim: SmallVec<[([VertexRow; 2], FaceRow); 8]>,
}

impl Session<'_> {
    /// The best insertion of a vertex near an edge of a thin face, with the smallest angle that it leaves.
    ///
    /// The new vertex keeps off the others by more than what is collapsed inside films.
    pub(super) fn plan_insertion(&self, row: FaceRow, [a, b]: [VertexRow; 2]) -> Option<(f64, Plan)> {
        const ALONG: [f64; 5] = [0.3, 0.4, 0.5, 0.6, 0.7];
        const BEYOND: [f64; 6] = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6];
        let mesh = &self.surface.mesh;
        let across = self.beyond(row, [a, b])?;
        let far = mesh.face(across).opposite(a, b);
        let corners = [a, b, far, mesh.face(row).opposite(a, b)].map(|v| self.surface.positions[v]);
        let nearest = 1.3 * Policy::SHORTEST_IN_FILM * self.edge();
        let weights = ALONG.into_iter().flat_map(|t| BEYOND.map(|u| [(1.0 - t) * (1.0 - u), t * (1.0 - u), u]));
        let places = weights.map(|w| (w, corners[0] * w[0] + corners[1] * w[1] + corners[2] * w[2]));
        let apart = places.filter(|(_, place)| corners.iter().all(|x| x.distance(*place) > nearest));
        let holes = apart.map(|(weights, place)| {
            let hole = self.hole(row, across, [a, b], place);
            (self.least_angle_around(&hole, place), weights, place, hole)
        });
        let (_, weights, place, hole) = holes.reduce(|x, y| if y.0 > x.0 + TIE { y } else { x })?;
        let parents = [a, b, far].into_iter().zip(weights).collect();
        let mut plan = self.plan_fill(&hole, place, parents);
        self.level(&mut plan);
        Some((self.least_angles_after(&plan).rest, plan))
    }

    fn plan_fill(&self, hole: &Hole, place: DVec3, parents: SmallVec<[(VertexRow, f64); 3]>) -> Plan {
        let mesh = &self.surface.mesh;
        let vertex = VertexRow(mesh.vertex_rows() as u32);
        let added = hole.rim.iter().map(|([p, q], row)| {
            let face = mesh.face(*row);
            Added { face: face.with_replaced(face.opposite(*p, *q), vertex), origin: Some(*row) }
        });
        Plan {
            created: smallvec![(place, false)],
            added: added.collect(),
            removed: hole.faces.iter().copied().collect(),
            blends: smallvec![Blend { vertex, parents }],
            ..Plan::default()
        }
    }

    /// Shifts the new vertex along the normal of the rim, so that no volume changes: a fill across a bend would cut it off.
    fn level(&self, plan: &mut Plan) {
        let surface = &*self.surface;
        let (vertex, place) = (VertexRow(surface.mesh.vertex_rows() as u32), plan.created[0].0);
        let Some((region, change)) = plan.volume_changes(surface).first().copied() else { return };
        let gradient = |added: &Added| {
            let [p, q] = added.face.around(vertex).map(|v| surface.positions[v] - place);
            let outwards = if added.face.labels()[0] == region { 1.0 } else { -1.0 };
            outwards * p.cross(q) / 6.0
        };
        let gradient: DVec3 = plan.added.iter().map(gradient).sum();
        if gradient.length_squared() > 0.0 {
            plan.created[0].0 -= gradient * (change / gradient.length_squared());
        }
    }

    /// The face on the other side of an edge inside a film that may be flipped.
    fn beyond(&self, row: FaceRow, [a, b]: [VertexRow; 2]) -> Option<FaceRow> {
        let mesh = &self.surface.mesh;
        let rows = mesh.faces_of_edge(a, b);
        let [one, two] = rows.as_slice() else { return None };
        let beyond = if *one == row { *two } else { *one };
        let is_fixed = mesh.face(beyond).is_ghost() || self.surface.pinned[a] && self.surface.pinned[b];
        (!is_fixed).then_some(beyond)
    }

    /// The hole around a place, grown from two faces with a common edge.
    fn hole(&self, row: FaceRow, across: FaceRow, [a, b]: [VertexRow; 2], place: DVec3) -> Hole {
        const MOST_FACES: usize = 8;
        let mesh = &self.surface.mesh;
        let mut hole = Hole { faces: smallvec![row, across], rim: SmallVec::new() };
        for row in [row, across] {
            let tip = mesh.face(row).opposite(a, b);
            hole.rim.extend([([a, tip], row), ([b, tip], row)]);
        }
        let mut next = 0;
        while next < hole.rim.len() && hole.faces.len() < MOST_FACES {
            let ([p, q], inside) = hole.rim[next];
            match self.beyond(inside, [p, q]).filter(|beyond| self.may_grow(&hole, *beyond, [p, q], place)) {
                Some(beyond) => {
                    let tip = mesh.face(beyond).opposite(p, q);
                    hole.faces.push(beyond);
                    hole.rim.swap_remove(next);
                    hole.rim.extend([([p, tip], beyond), ([q, tip], beyond)]);
                    next = 0;
                }
                None => next += 1,
            }
        }
        hole
    }

    /// Whether the hole is better with the face beyond an edge, which must bring a vertex that it has not.
    fn may_grow(&self, hole: &Hole, beyond: FaceRow, [p, q]: [VertexRow; 2], place: DVec3) -> bool {
        let tip = self.surface.mesh.face(beyond).opposite(p, q);
        let [x, y, z] = [p, q, tip].map(|v| self.surface.positions[v]);
        let least = |faces: [[DVec3; 3]; 2]| checks::Shape::of(faces).least_angle;
        self.policy.flips
            && !hole.rim.iter().any(|(edge, _)| edge.contains(&tip))
            && (y - x).cross(place - x).dot((z - x).cross(y - x)) > 0.0
            && least([[place, x, z], [place, z, y]]) > least([[place, x, y], [x, y, z]]) + TIE
    }

    fn least_angle_around(&self, hole: &Hole, place: DVec3) -> f64 {
        let corners = |[p, q]: [VertexRow; 2]| [place, self.surface.positions[p], self.surface.positions[q]];
        checks::Shape::of(hole.rim.iter().map(|(edge, _)| corners(*edge))).least_angle
    }
}
