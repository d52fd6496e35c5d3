//! Snapping: films that come nearer than a tenth of `L` are joined, vertex to vertex.
//!
//! The nearest points of two elements become vertices (an element's own vertex if it is near, else a split), and the two vertices
//! become one. One snap makes a contact in a point; a second beside it one along a line; a third makes two faces lie on each other,
//! which trimming turns into a shared film, or into a window where the same region is on both outer sides.
//! Which regions meet needs no test: what lies between two near elements is one region, so their labels agree.
//! Limits: under [`Contact::Bounce`] nothing is snapped.

use glam::DVec3;
use smallvec::{SmallVec, smallvec};

use super::plan::{Plan, replace_vertex};
use super::{Session, collapse};
use crate::grid::{Aabb, BoxGrid};
use crate::kernel::closest::{point_triangle, segment_segment};
use crate::mesh::Face;
use crate::policy::Contact;
use crate::rows::{FaceRow, VertexRow};
use crate::surface::Surface;
use crate::transfer::Blend;

/// Two elements of different faces that are near each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Pair {
    /// A vertex and a face.
    VertexFace(VertexRow, FaceRow),
    /// Two edges.
    EdgeEdge([VertexRow; 2], [VertexRow; 2]),
}

/// Barycentric coordinate below which the nearest point of a face counts as on its edge or corner.
const FACE_DROP: f64 = 0.025;
/// Parameter below which the nearest point of an edge counts as its end.
const EDGE_DROP: f64 = 0.03;
/// Distances that differ by less than this many `L` are taken as equal.
const TIE: f64 = 1e-9;
/// Cosine between two faces at a shared vertex below which they are too far apart to be near anywhere else.
const WEDGE: f64 = 0.6;

impl Session<'_> {
    /// Joins whatever films are near each other, the nearest first; gives the number of snaps.
    pub fn snap_films(&mut self) -> u64 {
        if self.policy.contact == Contact::Bounce {
            return 0;
        }
        let before = self.counts.snaps;
        for (_, pair) in self.near_pairs() {
            self.snap(pair);
        }
        self.counts.snaps - before
    }

    /// Pairs of elements nearer than the snapping distance, nearest first.
    #[must_use]
    pub fn near_pairs(&self) -> Vec<(f64, Pair)> {
        let reach = self.policy.snap * self.edge();
        let mut pairs: Vec<(f64, Pair)> = Vec::new();
        for [one, two] in films_that_may_be_near(self.surface, reach) {
            self.push_near_elements(one, two, reach, &mut pairs);
        }
        pairs.sort_by(|x, y| x.0.total_cmp(&y.0).then(x.1.cmp(&y.1)));
        pairs.dedup();
        // Elements with a corner in common are as near as that corner but for rounding, which must not decide.
        let tie = TIE * self.edge();
        pairs.chunk_by_mut(|x, y| y.0 - x.0 < tie).for_each(|tied| tied.sort_by_key(|(_, pair)| *pair));
        pairs
    }

    fn push_near_elements(&self, one: FaceRow, two: FaceRow, reach: f64, pairs: &mut Vec<(f64, Pair)>) {
        let (a, b) = (self.surface.mesh.face(one), self.surface.mesh.face(two));
        for (face, row, other) in [(a, two, b), (b, one, a)] {
            for vertex in face.vertices().into_iter().filter(|v| !other.has(*v)) {
                pairs.extend(self.measured(Pair::VertexFace(vertex, row), reach));
            }
        }
        for e in a.edges() {
            for f in b.edges().into_iter().filter(|f| !f.contains(&e[0]) && !f.contains(&e[1])) {
                pairs.extend(self.measured(Pair::EdgeEdge(e.min(f), e.max(f)), reach));
            }
        }
    }

    /// Distance of a pair, if it is within reach and may be snapped at all.
    fn measured(&self, pair: Pair, reach: f64) -> Option<(f64, Pair)> {
        let x = |v: VertexRow| self.surface.positions[v];
        let distance = match pair {
            Pair::VertexFace(v, row) => {
                let [a, b, c] = self.surface.corners(row);
                point_triangle(x(v), [a, b, c]).distance_squared.sqrt()
            }
            Pair::EdgeEdge([a, b], [c, d]) => segment_segment([x(a), x(b)], [x(c), x(d)]).distance_squared.sqrt(),
        };
        (distance < reach).then_some((distance, pair))
    }

    /// Joins a pair, if it is still near and nothing speaks against it. Gives the vertex that is left.
    pub fn snap(&mut self, pair: Pair) -> Option<VertexRow> {
        let reach = self.policy.snap * self.edge();
        if !self.is_alive(pair) || self.measured(pair, reach).is_none() || self.is_hinge(pair) {
            return None;
        }
        let (p, q) = self.ends(pair)?;
        self.snap_vertices(p, q)
    }

    fn is_alive(&self, pair: Pair) -> bool {
        let mesh = &self.surface.mesh;
        match pair {
            Pair::VertexFace(v, row) => mesh.has_vertex(v) && mesh.get(row).is_some_and(|face| !face.has(v)),
            Pair::EdgeEdge([a, b], [c, d]) => {
                mesh.has_edge(a, b) && mesh.has_edge(c, d) && ![c, d].contains(&a) && ![c, d].contains(&b)
            }
        }
    }

    /// Whether two elements hang on a common edge and are not folded onto each other by more than a right angle.
    fn is_hinge(&self, pair: Pair) -> bool {
        let mesh = &self.surface.mesh;
        match pair {
            Pair::VertexFace(v, row) => {
                let face = mesh.face(row);
                face.edges().into_iter().any(|[a, b]| {
                    mesh.face_with([a, b, v]).is_some() && !self.is_folded([a, b], v, face.opposite(a, b))
                })
            }
            Pair::EdgeEdge(e, f) => {
                let bridges =
                    e.iter().flat_map(|a| f.iter().map(move |b| (*a, *b))).filter(|(a, b)| mesh.has_edge(*a, *b));
                let mut open = bridges.filter(|(a, b)| {
                    let (c, d) = (other_end(e, *a), other_end(f, *b));
                    mesh.face_with([*a, *b, c]).is_some()
                        && mesh.face_with([*a, *b, d]).is_some()
                        && !self.is_folded([*a, *b], c, d)
                });
                open.next().is_some()
            }
        }
    }

    /// Whether the faces `(hinge, c)` and `(hinge, d)` bend onto each other by more than a right angle.
    fn is_folded(&self, hinge: [VertexRow; 2], c: VertexRow, d: VertexRow) -> bool {
        let x = |v: VertexRow| self.surface.positions[v];
        let (origin, axis) = (x(hinge[0]), (x(hinge[1]) - x(hinge[0])).normalize_or_zero());
        let radial = |v: VertexRow| (x(v) - origin).reject_from_normalized(axis);
        axis != DVec3::ZERO && radial(c).dot(radial(d)) > 0.0
    }

    /// The two vertices at the nearest points of a pair, made by splits where there are none.
    fn ends(&mut self, pair: Pair) -> Option<(VertexRow, VertexRow)> {
        let x = |v: VertexRow| self.surface.positions[v];
        match pair {
            Pair::VertexFace(v, row) => {
                let [a, b, c] = self.surface.corners(row);
                let nearest = point_triangle(x(v), [a, b, c]);
                let q = self.vertex_in_face(row, nearest.barycentric, v)?;
                Some((v, q))
            }
            Pair::EdgeEdge([a, b], [c, d]) => {
                let nearest = segment_segment([x(a), x(b)], [x(c), x(d)]);
                let p = self.vertex_on_edge([a, b], nearest.s)?;
                let q = self.vertex_on_edge([c, d], nearest.t)?;
                Some((p, q))
            }
        }
    }

    fn vertex_in_face(&mut self, row: FaceRow, barycentric: [f64; 3], near: VertexRow) -> Option<VertexRow> {
        let vertices = self.surface.mesh.face(row).vertices();
        let small: SmallVec<[usize; 3]> = (0..3).filter(|i| barycentric[*i] < FACE_DROP).collect();
        match small.as_slice() {
            [] => self.split_face(row, barycentric),
            [i] => {
                let (j, k) = ((i + 1) % 3, (i + 2) % 3);
                self.vertex_on_edge([vertices[j], vertices[k]], barycentric[k] / (barycentric[j] + barycentric[k]))
            }
            _ => (0..3).find(|i| !small.contains(i)).map(|i| vertices[i]).filter(|v| *v != near),
        }
    }

    fn vertex_on_edge(&mut self, [a, b]: [VertexRow; 2], t: f64) -> Option<VertexRow> {
        match t {
            t if t < EDGE_DROP => Some(a),
            t if t > 1.0 - EDGE_DROP => Some(b),
            t => {
                let place = self.surface.positions[a].lerp(self.surface.positions[b], t);
                self.split(a, b, t, place)
            }
        }
    }

    /// Makes one vertex of two that share no edge.
    pub fn snap_vertices(&mut self, p: VertexRow, q: VertexRow) -> Option<VertexRow> {
        if p == q || self.surface.mesh.has_edge(p, q) || self.surface.pinned[p] && self.surface.pinned[q] {
            return None;
        }
        let (kept, gone) = match (self.surface.pinned[p], self.surface.pinned[q]) {
            (_, true) => (q, p),
            (true, false) => (p, q),
            (false, false) => (p.min(q), p.max(q)),
        };
        let plan = self.plan_snap(kept, gone)?;
        if self.turns_over(&plan)
            || !self.is_well_shaped(&plan)
            || self.ends_region(&plan)
            || self.tangles(&plan)
            || self.is_blocked(&plan)
        {
            return None;
        }
        self.note_snap(&plan, kept);
        self.counts.snaps += 1;
        self.commit(&plan);
        self.marks[kept].snapped = self.step;
        self.note_vanished(&plan, kept);
        Some(kept)
    }

    fn plan_snap(&self, kept: VertexRow, gone: VertexRow) -> Option<Plan> {
        let surface = &*self.surface;
        let mut plan = Plan { meets: true, ..Plan::default() };
        if !replace_vertex(&mut plan, surface, gone, kept) {
            return None;
        }
        let (x, y) = (surface.positions[kept], surface.positions[gone]);
        let place = if surface.pinned[kept] { x } else { x.midpoint(y) };
        plan.sweep(surface, gone, surface.mesh.faces_of(gone), place);
        if place != x {
            plan.move_vertex(surface, kept, place);
        }
        plan.note_reshaped(surface);
        let t = collapse::projection(x, y, place);
        plan.blends = smallvec![Blend { vertex: kept, parents: smallvec![(kept, 1.0 - t), (gone, t)] }];
        Some(plan)
    }

    fn note_snap(&mut self, plan: &Plan, kept: VertexRow) {
        let place = plan.at(self.surface, kept);
        self.note_coalescence(plan, place);
        self.note_windows(plan, place);
    }
}

/// A film with what the search for near ones asks of it, side by side in memory.
struct Film {
    row: FaceRow,
    vertices: [VertexRow; 3],
    corners: [DVec3; 3],
    middle: DVec3,
}

impl Film {
    fn of(surface: &Surface, row: FaceRow, face: &Face) -> Self {
        let vertices = face.vertices();
        let corners = vertices.map(|v| surface.positions[v]);
        Self { row, vertices, corners, middle: (corners[0] + corners[1] + corners[2]) / 3.0 }
    }

    /// A cheap bound: films that share vertices must fold onto each other, others must overlap along the line between their middles.
    fn may_be_near(&self, other: &Self, reach: f64) -> bool {
        let (mut shared, mut origin) = (0, DVec3::ZERO);
        for (v, place) in self.vertices.iter().zip(self.corners) {
            if other.vertices.contains(v) {
                shared += 1;
                origin += place;
            }
        }
        if shared > 0 {
            let origin = origin / f64::from(shared);
            let (r, s) = (self.middle - origin, other.middle - origin);
            let along = r.dot(s);
            return along > 0.0 && along * along > WEDGE * WEDGE * r.length_squared() * s.length_squared();
        }
        let axis = other.middle - self.middle;
        let [x, y] = [self.corners, other.corners].map(|corners| corners.map(|p| (p - self.middle).dot(axis)));
        let gap = y[0].min(y[1]).min(y[2]) - x[0].max(x[1]).max(x[2]);
        gap <= 0.0 || gap * gap <= reach * reach * axis.length_squared()
    }
}

/// Pairs of films whose boxes are within reach and that pass a cheap bound, the lower row first.
fn films_that_may_be_near(surface: &Surface, reach: f64) -> Vec<[FaceRow; 2]> {
    let faces = surface.mesh.faces().filter(|(_, face)| !face.is_ghost());
    let films: Vec<Film> = faces.map(|(row, face)| Film::of(surface, row, face)).collect();
    let boxes = films.iter().map(|film| Aabb::of(&film.corners).padded(0.5 * reach)).collect();
    BoxGrid::fitted(boxes).pairs(|one, two| {
        let (one, two) = (&films[one as usize], &films[two as usize]);
        one.may_be_near(two, reach).then_some([one.row, two.row])
    })
}

fn other_end([a, b]: [VertexRow; 2], end: VertexRow) -> VertexRow {
    if end == a { b } else { a }
}
