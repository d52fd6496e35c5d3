//! Collapse of short edges: it keeps the mesh even, closes necks and brings junctions together.
//!
//! The end of higher rank keeps its place (film < junction curve < junction point < wire), so films collapse onto junctions and never
//! drag them. Ends of equal rank meet where the volumes of all regions change least:
//!
//! Equation: the volume that region `r` loses is `p . N_r - c_r` for the merged vertex at `p`, with `N_r = sum of (y x z)/6` over the
//! link of the two stars and `c_r` their present part of the volume. For a film (two regions) `p` can always be chosen on the plane
//! of no change.
//! Discretisation: `(sum of N_r N_r^T + eps I) (p - m) = sum of N_r (c_r - m . N_r)` from the midpoint `m`.
//! Limits: an edge above 0.2 `L` is not collapsed if that leaves a vertex to be separated: this hysteresis keeps collapse and
//! separation (which opens to 0.4 `L`) from undoing each other. Where a junction curve of one edge squeezes a face to below 21 degrees the
//! limit is 0.25 `L`. Junction edges beside a narrow film stay short (`refine`).

use glam::{DMat3, DVec3};
use smallvec::{SmallVec, smallvec};

use super::plan::{Plan, replace_vertex};
use super::split::sort_by_length;
use super::{Session, separate};
use crate::event::EventKind;
use crate::policy::Policy;
use crate::rows::{FaceRow, Region, VertexRow};
use crate::smoothing::junction_neighbours;
use crate::surface::Surface;
use crate::transfer::Blend;

/// How firmly a vertex holds its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Rank {
    /// Inside a film.
    Film,
    /// On a curve where films meet.
    Curve,
    /// Where such curves meet or end.
    Point,
    /// Held by a wire.
    Wire,
}

/// Rank of a vertex by the number of its edges that have not two faces.
pub(super) fn rank(surface: &Surface, vertex: VertexRow) -> Rank {
    if surface.pinned[vertex] {
        return Rank::Wire;
    }
    match junction_neighbours(surface, vertex).len() {
        0 => Rank::Film,
        2 => Rank::Curve,
        _ => Rank::Point,
    }
}

impl Session<'_> {
    /// Collapses edges that are too short, and edges opposite to angles below 3 degrees, shortest first, until nothing more can be.
    pub fn collapse_short_edges(&mut self) {
        let shortest = self.policy.shortest * self.edge();
        let mut queue = self.edges_by_length(|length| length < shortest);
        queue.extend(self.edges_opposite_to_needles(shortest));
        self.collapse_rounds(queue);
    }

    /// Collapses edges that are too short at some vertices and their neighbours, until nothing more can be.
    pub(super) fn collapse_short_edges_of(&mut self, vertices: Vec<VertexRow>) {
        let neighbours = vertices.iter().flat_map(|v| self.surface.mesh.neighbours(*v));
        let mut around: Vec<VertexRow> = neighbours.chain(vertices.iter().copied()).collect();
        around.sort_unstable();
        around.dedup();
        let queue = self.short_edges_of(&around, self.policy.shortest * self.edge());
        self.collapse_rounds(queue);
    }

    fn collapse_rounds(&mut self, mut queue: Vec<(f64, [VertexRow; 2])>) {
        let shortest = self.policy.shortest * self.edge();
        // Every round collapses at least one edge, so rounds are bounded by the mesh itself.
        while !queue.is_empty() {
            let mut changed: Vec<VertexRow> = Vec::new();
            for (_, [a, b]) in queue {
                changed.extend(self.collapse(a, b));
            }
            changed.sort_unstable();
            changed.dedup();
            queue = self.short_edges_of(&changed, shortest);
        }
    }

    fn short_edges_of(&self, vertices: &[VertexRow], shortest: f64) -> Vec<(f64, [VertexRow; 2])> {
        let live = vertices.iter().copied().filter(|v| self.surface.mesh.has_vertex(*v));
        let mut edges: Vec<(f64, [VertexRow; 2])> = live
            .flat_map(|a| self.surface.mesh.neighbours(a).into_iter().map(move |b| if a < b { [a, b] } else { [b, a] }))
            .map(|[a, b]| (self.length(a, b), [a, b]))
            .filter(|(length, _)| *length < shortest)
            .collect();
        sort_by_length(&mut edges);
        edges
    }

    /// Edges opposite to an angle below 3 degrees that are not short already.
    fn edges_opposite_to_needles(&self, shortest: f64) -> Vec<(f64, [VertexRow; 2])> {
        let mut found = Vec::new();
        for (row, face) in self.surface.mesh.faces().filter(|(_, face)| !face.is_ghost()) {
            let narrow = super::checks::narrow_corners(self.surface.corners(row));
            for (vertex, _) in face.vertices().into_iter().zip(narrow).filter(|(_, is_narrow)| *is_narrow) {
                let [a, b] = face.around(vertex);
                let length = self.length(a, b);
                if length >= shortest {
                    found.push((length, if a < b { [a, b] } else { [b, a] }));
                }
            }
        }
        sort_by_length(&mut found);
        found
    }

    /// Collapses an edge if nothing speaks against it. Gives the vertex that is left.
    pub fn collapse(&mut self, a: VertexRow, b: VertexRow) -> Option<VertexRow> {
        if a == b || !self.surface.mesh.has_edge(a, b) {
            return None;
        }
        // Near a short junction curve short edges within the films are wanted, but not around a waist, which is to close.
        let in_film = rank(self.surface, a).min(rank(self.surface, b)) == Rank::Film && self.shares_only_faces(a, b);
        let most = match in_film {
            true => Policy::SHORTEST_IN_FILM,
            false if self.length(a, b) < Policy::SQUEEZED_STRUT * self.edge() && self.squeezes(a, b) => {
                Policy::SQUEEZED_STRUT
            }
            false => Policy::UNGATED_COLLAPSE,
        };
        let is_tiny = self.length(a, b) < most * self.edge();
        if self.rests(a, b) {
            return None;
        }
        let [kept, gone] = self.by_rank(a, b);
        let place = self.usual_place(kept, gone);
        let plan = self.plan_collapse(kept, gone, place)?;
        let is_fit = is_tiny
            || self.closes_narrow_film(&plan, [kept, gone])
            || self.is_well_shaped(&plan) && self.keeps_angles(&plan) && !self.borders_narrow_film(a, b);
        if is_fit { self.collapse_as_planned([kept, gone], is_tiny, &plan) } else { None }
    }

    /// Carries out a collapse of `[kept, gone]` if nothing speaks against it; `is_tiny` leaves out what is for the sake of volumes and
    /// junctions.
    pub(super) fn collapse_as_planned(
        &mut self,
        ends: [VertexRow; 2],
        is_tiny: bool,
        plan: &Plan,
    ) -> Option<VertexRow> {
        let kept = ends[0];
        let is_refused = |session: &Self| match session.closes_narrow_film(plan, ends) {
            true => session.changes_volume(plan, 2.0 * Policy::LARGEST_VOLUME_CHANGE),
            false => session.loses_volume(plan) || session.leaves_irregular(plan, ends, kept),
        };
        if self.turns_over(plan) || !is_tiny && is_refused(self) {
            return None;
        }
        if self.ends_region(plan) || self.tangles(plan) || self.is_blocked(plan) {
            return None;
        }
        self.note_collapse(plan, kept);
        let is_squeezed = self.is_strut(ends[0], ends[1]);
        self.counts.collapses += 1;
        self.commit(plan);
        self.note_vanished(plan, kept);
        if is_squeezed {
            self.marks[kept].squeezed = self.step;
        }
        Some(kept)
    }

    /// Whether an edge of three films is a whole junction curve between two points.
    fn is_strut(&self, a: VertexRow, b: VertexRow) -> bool {
        let is_point = |v| rank(self.surface, v) == Rank::Point;
        self.surface.mesh.faces_of_edge(a, b).len() == 3 && is_point(a) && is_point(b)
    }

    /// Whether an edge is a whole junction curve, opposite to an angle that is too narrow.
    fn squeezes(&self, a: VertexRow, b: VertexRow) -> bool {
        let opposite = |row: &FaceRow| {
            let face = self.surface.mesh.face(*row);
            let far = face.opposite(a, b);
            let [p, q] = [a, b].map(|v| self.surface.positions[v] - self.surface.positions[far]);
            p.cross(q).length().atan2(p.dot(q))
        };
        self.is_strut(a, b)
            && self.surface.mesh.faces_of_edge(a, b).iter().any(|row| opposite(row) < Policy::NARROW_ANGLE)
    }

    /// Whether both ends took part in a separation a moment ago.
    pub(super) fn rests(&self, a: VertexRow, b: VertexRow) -> bool {
        let is_recent = |v: VertexRow| {
            let separated = self.marks[v].separated;
            separated > 0 && self.step <= separated + Policy::REST_AFTER_SEPARATION
        };
        is_recent(a) && is_recent(b)
    }

    /// The two ends of an edge, the one that is kept first.
    pub(super) fn by_rank(&self, a: VertexRow, b: VertexRow) -> [VertexRow; 2] {
        if rank(self.surface, a) >= rank(self.surface, b) { [a, b] } else { [b, a] }
    }

    /// Where the vertex that is kept goes.
    pub(super) fn usual_place(&self, kept: VertexRow, gone: VertexRow) -> DVec3 {
        let is_equal = rank(self.surface, kept) == rank(self.surface, gone);
        if is_equal { self.meeting_place(kept, gone) } else { self.surface.positions[kept] }
    }

    /// What a collapse changes that leaves the vertex `kept`, of no lower rank than `gone`, at a place; `None` where wires or
    /// coincident films forbid it.
    pub(super) fn plan_collapse(&self, kept: VertexRow, gone: VertexRow, place: DVec3) -> Option<Plan> {
        let [highest, lowest] = [kept, gone].map(|v| rank(self.surface, v));
        if lowest == Rank::Wire || highest == Rank::Wire && !self.shares_only_faces(kept, gone) {
            return None;
        }
        let mut plan = Plan::default();
        if !replace_vertex(&mut plan, self.surface, gone, kept) {
            return None;
        }
        plan.sweep(self.surface, gone, self.surface.mesh.faces_of(gone), place);
        if place != self.surface.positions[kept] {
            plan.move_vertex(self.surface, kept, place);
        }
        plan.note_reshaped(self.surface);
        let t = projection(self.surface.positions[kept], self.surface.positions[gone], place);
        plan.blends = smallvec![Blend { vertex: kept, parents: smallvec![(kept, 1.0 - t), (gone, t)] }];
        Some(plan)
    }

    /// Whether the common neighbours of two vertices are those of their common faces.
    fn shares_only_faces(&self, a: VertexRow, b: VertexRow) -> bool {
        let of_a = self.surface.mesh.neighbours(a);
        let common = self.surface.mesh.neighbours(b).into_iter().filter(|v| of_a.contains(v)).count();
        common == self.surface.mesh.faces_of_edge(a, b).len()
    }

    /// Where two vertices of equal rank meet: near the midpoint, where volumes change least.
    fn meeting_place(&self, a: VertexRow, b: VertexRow) -> DVec3 {
        let (x, y) = (self.surface.positions[a], self.surface.positions[b]);
        let middle = x.midpoint(y);
        let links = self.link_volumes(a, b, middle);
        let (mut matrix, mut right) = (DMat3::ZERO, DVec3::ZERO);
        for (_, normal, rest) in &links {
            matrix += DMat3::from_cols(*normal * normal.x, *normal * normal.y, *normal * normal.z);
            right += *normal * *rest;
        }
        let trace = matrix.x_axis.x + matrix.y_axis.y + matrix.z_axis.z;
        if !(trace > 0.0) {
            return middle;
        }
        let solved = (matrix + DMat3::from_diagonal(DVec3::splat(1e-3 * trace))).inverse() * right;
        middle + solved.clamp_length_max(0.5 * x.distance(y))
    }

    /// Per region touched: `N` of the link of the two stars, and the volume `c` that the merged vertex has to make up for, both from `origin`.
    fn link_volumes(&self, a: VertexRow, b: VertexRow, origin: DVec3) -> SmallVec<[(Region, DVec3, f64); 4]> {
        let mut sums: SmallVec<[(Region, DVec3, f64); 4]> = SmallVec::new();
        let mesh = &self.surface.mesh;
        let star = mesh.faces_of(a).iter().chain(mesh.faces_of(b).iter().filter(|row| !mesh.face(**row).has(a)));
        for row in star {
            let face = mesh.face(*row);
            let [x, y, z] = self.surface.corners(*row).map(|x| x - origin);
            let part = x.dot(y.cross(z)) / 6.0;
            let vertex = if face.has(a) { a } else { b };
            let [p, q] = face.around(vertex).map(|v| self.surface.positions[v] - origin);
            let normal = if face.has(a) && face.has(b) { DVec3::ZERO } else { p.cross(q) / 6.0 };
            let [back, front] = face.labels();
            for (region, sign) in [(back, 1.0), (front, -1.0)] {
                match sums.iter_mut().find(|(other, ..)| *other == region) {
                    Some((_, n, c)) => (*n, *c) = (*n + sign * normal, *c + sign * part),
                    None => sums.push((region, sign * normal, sign * part)),
                }
            }
        }
        sums
    }

    /// Whether the vertex that is left would have something to separate while neither end had.
    fn leaves_irregular(&self, plan: &Plan, ends: [VertexRow; 2], kept: VertexRow) -> bool {
        !self.sectors_after(plan, kept).is_regular() && ends.iter().all(|v| self.sectors(*v).is_regular())
    }

    /// Whether a face goes that is lower than [`Policy::NARROW_FILM`] between two junction curves: as good as closed already.
    fn closes_narrow_film(&self, plan: &Plan, [a, b]: [VertexRow; 2]) -> bool {
        let mesh = &self.surface.mesh;
        let is_narrow = |row: &FaceRow| {
            let [x, y, z] = self.surface.corners(*row);
            let longest = x.distance(y).max(y.distance(z)).max(x.distance(z));
            self.surface.double_area_normal(*row).length() < Policy::NARROW_FILM * self.edge() * longest
        };
        let is_between_curves = |row: &FaceRow| {
            let tip = mesh.face(*row).opposite(a, b);
            [a, b].iter().all(|end| mesh.faces_of_edge(tip, *end).len() != 2)
        };
        mesh.faces_of_edge(a, b)
            .iter()
            .any(|row| plan.removed.contains(row) && is_narrow(row) && is_between_curves(row))
    }

    /// Whether a closed region that is more than a speck would lose its last film.
    pub(super) fn ends_region(&self, plan: &Plan) -> bool {
        let speck = Policy::LARGEST_VOLUME_CHANGE * self.edge().powi(3);
        self.ended_regions(plan).into_iter().any(|region| {
            let volume =
                plan.volume_changes(self.surface).iter().find(|(other, _)| *other == region).map_or(0.0, |c| -c.1);
            !self.surface.is_open(region) && volume > speck
        })
    }

    /// Regions that a plan leaves without any film.
    fn ended_regions(&self, plan: &Plan) -> SmallVec<[Region; 4]> {
        // The last films of a region are trimmed: they come to lie on each other.
        if plan.windows.is_empty() && plan.fused.is_empty() {
            return SmallVec::new();
        }
        let removed = plan.removed.iter().flat_map(|row| self.surface.mesh.face(*row).labels());
        let mut regions: SmallVec<[Region; 4]> = removed.collect();
        regions.sort_unstable();
        regions.dedup();
        let gains = |region: Region| plan.added.iter().any(|added| added.face.borders(region));
        regions.retain(|region| !gains(*region));
        // A region whose films the plan removes without adding any is gone only if it had no others.
        let removed = |row| plan.removed.contains(&row);
        let neighbours = |region: Region| {
            let touched = plan.touched(self.surface);
            let rows = touched.into_iter().filter(|v| v.index() < self.surface.mesh.vertex_rows());
            rows.flat_map(|v| self.surface.mesh.faces_of(v).iter().copied().collect::<SmallVec<[_; 8]>>())
                .any(|row| !removed(row) && self.surface.mesh.face(row).borders(region))
        };
        regions.retain(|region| !neighbours(*region));
        regions
    }

    /// Notes regions that come to share their first film; once, however many faces of it the plan makes.
    pub(super) fn note_coalescence(&mut self, plan: &Plan, place: DVec3) {
        let mut noted: SmallVec<[[Region; 2]; 2]> = SmallVec::new();
        for (back, between, front) in plan.fused.iter().copied() {
            let pair = [back.min(front), back.max(front)];
            if !noted.contains(&pair) && !separate::share_film(self.surface, back, front) {
                noted.push(pair);
                self.note(EventKind::Coalescence, place, [back, front, between]);
            }
        }
    }

    fn note_collapse(&mut self, plan: &Plan, kept: VertexRow) {
        let place = plan.at(self.surface, kept);
        self.note_coalescence(plan, place);
        self.note_windows(plan, place);
    }

    /// Notes what it means that films of the same two regions come to lie on each other: a window opens, or a neck closes. Once for every
    /// two regions; not for those whose gap is all there was of a region.
    ///
    /// Where a film folds flat onto itself, or a window grows, the Euler characteristic stays, and there is nothing to note.
    pub(super) fn note_windows(&mut self, plan: &Plan, place: DVec3) {
        if plan.windows.is_empty() {
            return;
        }
        let kind = match plan.euler_change(self.surface) {
            0 => return,
            ..0 => EventKind::Window,
            1.. => EventKind::Pinch,
        };
        let ended = self.ended_regions(plan);
        let mut opened = plan.windows.clone();
        opened.sort_unstable();
        opened.dedup();
        for (outer, between) in opened.into_iter().filter(|(_, between)| !ended.contains(between)) {
            self.note(kind, place, [outer, between]);
        }
    }

    /// Notes regions that have no film any more, after a plan was carried out.
    pub(super) fn note_vanished(&mut self, plan: &Plan, kept: VertexRow) {
        let mut regions: SmallVec<[Region; 4]> =
            plan.windows.iter().map(|(_, between)| *between).chain(plan.fused.iter().map(|f| f.1)).collect();
        regions.sort_unstable();
        regions.dedup();
        for region in regions {
            if !self.surface.mesh.faces().any(|(_, face)| face.borders(region)) {
                let place = self.surface.positions[kept];
                self.note(EventKind::Vanished, place, [region]);
            }
        }
    }
}

/// Parameter of the point of segment `(a, b)` nearest to `p`, 0 to 1.
pub(super) fn projection(a: DVec3, b: DVec3, p: DVec3) -> f64 {
    let along = b - a;
    let square = along.length_squared();
    if square > 0.0 { ((p - a).dot(along) / square).clamp(0.0, 1.0) } else { 0.5 }
}
