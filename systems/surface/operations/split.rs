//! Splits of edges and faces. They never change topology, and at a midpoint not even the shape; where the vertices of a smooth film go is
//! in [`butterfly`](super::butterfly).

use glam::DVec3;
use smallvec::{SmallVec, smallvec};

use super::Session;
use super::butterfly::smooth_middle;
use super::plan::{Added, Plan};
use crate::mesh::Face;
use crate::policy::{Placement, Policy};
use crate::rows::{FaceRow, VertexRow};
use crate::surface::Surface;
use crate::transfer::Blend;

/// The split of edge `(a, b)` at `a + t (b - a)`, moved to `place`: each of its faces, however many, becomes two.
#[must_use]
pub(super) fn plan_split(surface: &Surface, a: VertexRow, b: VertexRow, t: f64, place: DVec3) -> Plan {
    let new = VertexRow(surface.mesh.vertex_rows() as u32);
    let faces = surface.mesh.faces_of_edge(a, b);
    let halves = faces.iter().flat_map(|row| {
        let face = surface.mesh.face(*row);
        [(b, *row), (a, *row)].map(|(end, row)| Added { face: face.with_replaced(end, new), origin: Some(row) })
    });
    Plan {
        created: smallvec![(place, splits_wire(surface, a, b))],
        added: halves.collect(),
        blends: smallvec![Blend { vertex: new, parents: smallvec![(a, 1.0 - t), (b, t)] }],
        removed: SmallVec::from_slice(&faces),
        ..Plan::default()
    }
}

/// Whether an edge lies on a wire for sure: both ends are held, and it borders a ghost, as the rim of an open film does.
fn splits_wire(surface: &Surface, a: VertexRow, b: VertexRow) -> bool {
    surface.pinned[a]
        && surface.pinned[b]
        && surface.mesh.faces_of_edge(a, b).iter().any(|row| surface.mesh.face(*row).is_ghost())
}

impl Session<'_> {
    /// Splits edges that are too long, longest first, until there are none.
    pub fn split_long_edges(&mut self) {
        let longest = self.policy.longest * self.edge();
        let mut queue = self.edges_by_length(|length| length > longest);
        while !queue.is_empty() {
            let mut halves = Vec::new();
            // All from the mesh as it is: once edges beside are split, rings are no longer even.
            let placed: Vec<_> = queue.into_iter().rev().map(|(_, edge)| (edge, self.smooth_place(edge))).collect();
            for ([a, b], smooth) in placed {
                if let Some(new) = self.split_smoothly(a, b, smooth) {
                    halves.extend(self.surface.mesh.neighbours(new).into_iter().map(|end| sorted(new, end)));
                }
            }
            halves.sort_unstable();
            halves.dedup();
            queue = self.by_length(halves, |length| length > longest);
        }
    }

    /// Splits an edge in the middle, and moves the new vertex to where a smooth film has it.
    fn split_smoothly(&mut self, a: VertexRow, b: VertexRow, smooth: Option<DVec3>) -> Option<VertexRow> {
        let length = self.length(a, b);
        let new = self.split_at_midpoint(a, b)?;
        if let Some(place) = smooth {
            self.bulge(new, place, length);
        }
        Some(new)
    }

    /// Where the vertex of a split goes, if not to the middle of the edge.
    fn smooth_place(&self, [a, b]: [VertexRow; 2]) -> Option<DVec3> {
        match self.policy.placement {
            Placement::Midpoint => None,
            Placement::Butterfly => smooth_middle(self.surface, a, b),
        }
    }

    /// Splits an edge in the middle, if both halves are long enough and it is free to be split.
    pub fn split_at_midpoint(&mut self, a: VertexRow, b: VertexRow) -> Option<VertexRow> {
        if !self.surface.mesh.has_edge(a, b) || self.length(a, b) < self.policy.shortest * self.edge() {
            return None;
        }
        let middle = self.surface.positions[a].midpoint(self.surface.positions[b]);
        self.split(a, b, 0.5, middle)
    }

    /// Splits faces with an angle above 160 degrees, at the foot of the corner opposite to their longest edge.
    pub fn split_wide_angles(&mut self) {
        let rows: Vec<FaceRow> = self.surface.mesh.faces().map(|(row, _)| row).collect();
        for row in rows {
            let Some(face) = self.surface.mesh.get(row).copied().filter(|face| !face.is_ghost()) else { continue };
            let Some((apex, [a, b])) = self.wide_corner(row, &face) else { continue };
            let (x, from, to) = (self.surface.positions[apex], self.surface.positions[a], self.surface.positions[b]);
            let t = (x - from).dot(to - from) / (to - from).length_squared();
            self.split_for_shape(a, b, t, from.lerp(to, t));
        }
    }

    fn wide_corner(&self, row: FaceRow, face: &Face) -> Option<(VertexRow, [VertexRow; 2])> {
        let angles = crate::corners::angles(self.surface.corners(row));
        let wide = (0..3).find(|i| angles[*i] > Policy::SPLIT_ANGLE)?;
        let apex = face.vertices()[wide];
        Some((apex, face.around(apex)))
    }

    /// A split off the middle that improves the shape: refused where a half would be shorter than a quarter of `L`.
    fn split_for_shape(&mut self, a: VertexRow, b: VertexRow, t: f64, place: DVec3) -> Option<VertexRow> {
        let shortest = 0.5 * self.policy.shortest * self.edge();
        let length = self.length(a, b);
        if t * length < shortest || (1.0 - t) * length < shortest || self.is_chord_of_wire(a, b) {
            return None;
        }
        let plan = plan_split(self.surface, a, b, t, place);
        let largest = |plan: &Plan, session: &Self| {
            let shapes = plan.shaped(session.surface).map(|(face, _)| plan.corners(session.surface, &face));
            super::checks::Shape::of(shapes).largest_angle
        };
        let before = plan.removed.iter().map(|row| self.surface.corners(*row));
        if largest(&plan, self) >= super::checks::Shape::of(before).largest_angle {
            return None;
        }
        self.commit_split(&plan)
    }

    /// Splits an edge at a parameter, at a place on it (metres).
    ///
    /// `None` at an end or where there is no such edge, and where a wire's own edge between films may not be refined.
    pub fn split(&mut self, a: VertexRow, b: VertexRow, t: f64, place: DVec3) -> Option<VertexRow> {
        let is_inside = t > 0.0 && t < 1.0 && [a, b].iter().all(|end| self.surface.positions[*end] != place);
        if !is_inside || !self.surface.mesh.has_edge(a, b) || self.is_chord_of_wire(a, b) {
            return None;
        }
        let plan = plan_split(self.surface, a, b, t, place);
        self.commit_split(&plan)
    }

    pub(super) fn commit_split(&mut self, plan: &Plan) -> Option<VertexRow> {
        if self.rounds_badly(plan) {
            return None;
        }
        self.counts.splits += 1;
        Some(self.commit(plan)[0])
    }

    /// Whether rounding of the new place puts films through each other, or in another order around an edge: slivers are that thin.
    fn rounds_badly(&mut self, plan: &Plan) -> bool {
        self.tangles(plan) || self.is_blocked(plan)
    }

    /// Whether both ends are held and no ghost tells that the edge is a rim. It may be a wire's own or lead from wire to wire; it is
    /// not split, so that no wire loses its film.
    pub(super) fn is_chord_of_wire(&self, a: VertexRow, b: VertexRow) -> bool {
        self.surface.pinned[a] && self.surface.pinned[b] && !splits_wire(self.surface, a, b)
    }

    /// Splits a face at a point with these barycentric coordinates (dimensionless, they add up to 1) into three.
    ///
    /// `None` unless the point is inside the face.
    pub fn split_face(&mut self, row: FaceRow, barycentric: [f64; 3]) -> Option<VertexRow> {
        let face = *self.surface.mesh.get(row)?;
        if barycentric.iter().any(|weight| !(*weight > 0.0)) {
            return None;
        }
        let corners = self.surface.corners(row);
        let place = corners[0] * barycentric[0] + corners[1] * barycentric[1] + corners[2] * barycentric[2];
        let new = VertexRow(self.surface.mesh.vertex_rows() as u32);
        let vertices = face.vertices();
        let plan = Plan {
            created: smallvec![(place, false)],
            added: vertices
                .map(|v| Added { face: face.with_replaced(v, new), origin: Some(row) })
                .into_iter()
                .collect(),
            removed: smallvec![row],
            blends: smallvec![Blend { vertex: new, parents: vertices.into_iter().zip(barycentric).collect() }],
            ..Plan::default()
        };
        if self.rounds_badly(&plan) {
            return None;
        }
        self.counts.face_splits += 1;
        Some(self.commit(&plan)[0])
    }

    /// Film edges whose length a predicate picks, shortest first; ties by rows.
    pub(super) fn edges_by_length(&self, wanted: impl Fn(f64) -> bool) -> Vec<(f64, [VertexRow; 2])> {
        let mut found = Vec::new();
        for (_, face) in self.surface.mesh.faces().filter(|(_, face)| !face.is_ghost()) {
            let [a, b, c] = face.vertices();
            let edges = [[a, b], [b, c], [a, c]].map(|[a, b]| (self.length(a, b), [a, b]));
            found.extend(edges.into_iter().filter(|(length, _)| wanted(*length)));
        }
        sort_by_length(&mut found);
        found
    }

    fn by_length(&self, edges: Vec<[VertexRow; 2]>, wanted: impl Fn(f64) -> bool) -> Vec<(f64, [VertexRow; 2])> {
        let lengths = edges.into_iter().map(|[a, b]| (self.length(a, b), [a, b]));
        let mut found = lengths.filter(|(length, edge)| wanted(*length) && self.has_film(*edge)).collect();
        sort_by_length(&mut found);
        found
    }

    /// Whether an edge has a face that is no ghost.
    fn has_film(&self, [a, b]: [VertexRow; 2]) -> bool {
        self.surface.mesh.faces_of_edge(a, b).iter().any(|row| !self.surface.mesh.face(*row).is_ghost())
    }
}

/// Shortest first, ties by rows, each once.
pub(super) fn sort_by_length(edges: &mut Vec<(f64, [VertexRow; 2])>) {
    edges.sort_by(|x, y| x.0.total_cmp(&y.0).then(x.1.cmp(&y.1)));
    edges.dedup();
}

fn sorted(a: VertexRow, b: VertexRow) -> [VertexRow; 2] {
    if a < b { [a, b] } else { [b, a] }
}
