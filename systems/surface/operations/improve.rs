//! Improvement of faces with a small angle, where lengths alone give no reason to touch them.
//!
//! A short junction curve is part of the shape: it cannot be collapsed, and every face between it and a vertex at the usual distance is
//! thin. So a face whose smallest angle is below [`Policy::GOOD_ANGLE`] is given, in this order, a flip of one of its edges, a move of one of
//! its vertices (`relax`), a collapse of one of its edges, or the best of an insertion (`insert`) and of a split of one of its two longest edges,
//! together with the flip of the other where that is better:
//!
//! ```text
//!      tip                 tip                The thin face (tip, a, b) has its long edge (tip, b) split at m, and its other long
//!     / |\ \              / \ \               edge (tip, a), from the face (tip, a, d), flipped to (m, d): now (a, b, m) is
//!    d  | | c     ->     d---m-c              wider, and the tip has one face less.
//!     \ |  \/             \ / \/
//!       a---b              a---b
//! ```
//!
//! A vertex with few neighbours inside a film, as snaps leave them, is collapsed onto the best of them, however far.
//!
//! Each of them is refused unless the smallest angle of all faces that it changes grows, and collapses elsewhere never make an angle below
//! the good one smaller; so the angles of a mesh at rest only grow, and the pass ends.
//! Corners that are a film's own ([`corners`](crate::corners)) are counted apart: they may not become narrower, and do not hide what is wrong
//! around them. Narrow films get shorter edges (`refine`), and another round.

use glam::DVec3;
use smallvec::SmallVec;

use super::Session;
use super::collapse::{Rank, rank};
use super::plan::{Added, Plan};
use super::split::plan_split;
use crate::corners::{self, LeastAngles};
use crate::mesh::Face;
use crate::policy::Policy;
use crate::rows::{FaceRow, VertexRow};

/// Angles that differ by less are taken as equal, radians: rounding must not decide.
const TIE: f64 = 1e-9;

/// Sorts plans by the least angle that they leave, largest first; ties stay in their order.
fn sort_by_angle<T>(plans: &mut SmallVec<[(f64, T); 4]>) {
    let mut order: SmallVec<[(usize, (f64, T)); 4]> = plans.drain(..).enumerate().collect();
    order.sort_by(|x, y| y.1.0.total_cmp(&x.1.0));
    order.chunk_by_mut(|x, y| x.1.0 - y.1.0 < TIE).for_each(|tied| tied.sort_by_key(|(place, _)| *place));
    plans.extend(order.into_iter().map(|(_, plan)| plan));
}

/// Whether no film's own corner becomes narrower, or comes to be below the good angle.
fn keeps_own(before: &LeastAngles, after: &LeastAngles) -> bool {
    after.own >= before.own.min(Policy::GOOD_ANGLE) - TIE
}

/// By what part the smallest angle has to grow for a vertex to come, go or move: less would be lost in the next step, and tried again.
const GROWTH: f64 = 1.1;

impl Session<'_> {
    /// Improves faces with small angles, worst first, in at most six sweeps.
    pub fn improve_faces(&mut self) {
        self.sweep_thin_faces();
        if self.refine_narrow_films() > 0 {
            self.sweep_thin_faces();
        }
    }

    fn sweep_thin_faces(&mut self) {
        const MOST_SWEEPS: usize = 6;
        for sweep in 0..MOST_SWEEPS {
            let mut thin = self.thin_faces();
            // What could not be improved before can only be where something changed since.
            thin.retain(|(_, row)| {
                sweep == 0 || self.surface.mesh.face(*row).vertices().iter().any(|v| self.marks[*v].dirty)
            });
            thin.sort_by(|x, y| x.0.total_cmp(&y.0).then(x.1.cmp(&y.1)));
            // Halved triangles are similar to whole ones: rounding must not decide.
            thin.chunk_by_mut(|x, y| y.0 - x.0 < TIE).for_each(|tied| tied.sort_by_key(|(_, row)| *row));
            let improved = thin.into_iter().filter(|(_, row)| self.improve_face(*row)).count();
            if improved == 0 {
                break;
            }
        }
    }

    fn thin_faces(&self) -> Vec<(f64, FaceRow)> {
        let rows = self.films_with_angle_below(Policy::GOOD_ANGLE).into_iter();
        let angles = rows.map(|row| (LeastAngles::NONE.with_face_of(self.surface, row).rest, row));
        angles.filter(|(angle, _)| *angle < Policy::GOOD_ANGLE).collect()
    }

    /// Rows, ascending, of films with an angle below an acute one (radians).
    pub(super) fn films_with_angle_below(&self, angle: f64) -> Vec<FaceRow> {
        let square = angle.tan().powi(2);
        let films = self.surface.mesh.faces().filter(|(_, face)| !face.is_ghost()).map(|(row, _)| row);
        films.filter(|row| corners::has_angle_below(self.surface.corners(*row), square)).collect()
    }

    /// Improves a face, if it still exists, by the first operation that helps; whether any did.
    pub fn improve_face(&mut self, row: FaceRow) -> bool {
        let Some(face) = self.surface.mesh.get(row).copied().filter(|face| !face.is_ghost()) else { return false };
        let [a, b, c] = face.vertices();
        let mut edges = [[a, b], [b, c], [a, c]];
        edges.sort_by(|x, y| self.length(x[0], x[1]).total_cmp(&self.length(y[0], y[1])));
        let [_, middle, longest] = edges;
        let flips =
            self.policy.flips && [longest, middle].into_iter().any(|[a, b]| self.flip_for_shape(a, b).is_some());
        flips
            || [a, b, c].into_iter().any(|v| self.relax(v, GROWTH))
            || edges.into_iter().any(|[a, b]| self.collapse_for_shape(a, b).is_some())
            || self.split_thin(row, middle, longest)
    }

    /// Splits one of the two long edges, as it is best.
    fn split_thin(&mut self, row: FaceRow, middle: [VertexRow; 2], longest: [VertexRow; 2]) -> bool {
        let mut plans: SmallVec<[(f64, Plan); 4]> = SmallVec::new();
        for (split, other) in [(longest, middle), (middle, longest)] {
            let Some(plain) = self.plan_middle(split) else { continue };
            let flipped = if self.policy.flips { self.with_flip(&plain, row, split, other) } else { None };
            plans.extend(
                [Some(plain), flipped].into_iter().flatten().map(|plan| (self.least_angles_after(&plan).rest, plan)),
            );
        }
        plans.extend([longest, middle].into_iter().filter_map(|edge| self.plan_insertion(row, edge)));
        sort_by_angle(&mut plans);
        for (_, plan) in plans {
            if !self.improves(&plan, GROWTH) {
                return false;
            }
            if !self.loses_volume(&plan) && !self.turns_over(&plan) && !self.is_blocked(&plan) && !self.tangles(&plan) {
                self.commit_split(&plan);
                return true;
            }
        }
        false
    }

    /// The split of an edge in the middle, if its halves are not too short.
    fn plan_middle(&self, edge: [VertexRow; 2]) -> Option<Plan> {
        self.plan_division(edge, 0.5)
    }

    /// The split of an edge at a parameter, 0 to 1, if its parts are not too short.
    pub(super) fn plan_division(&self, [a, b]: [VertexRow; 2], t: f64) -> Option<Plan> {
        let is_long = self.length(a, b) > 2.2 * Policy::UNGATED_COLLAPSE * self.edge();
        (is_long && !self.is_chord_of_wire(a, b)).then(|| {
            let place = self.surface.positions[a].lerp(self.surface.positions[b], t);
            plan_split(self.surface, a, b, t, place)
        })
    }

    /// A split of `split`, an edge of the face, with the flip of the face's edge `other` added to it.
    fn with_flip(&self, plan: &Plan, row: FaceRow, split: [VertexRow; 2], other: [VertexRow; 2]) -> Option<Plan> {
        let mesh = &self.surface.mesh;
        let rows = mesh.faces_of_edge(other[0], other[1]);
        let [one, two] = rows.as_slice() else { return None };
        let beyond = if *one == row { *two } else { *one };
        let (face, across) = (mesh.face(row), mesh.face(beyond));
        let far = across.opposite(other[0], other[1]);
        if across.is_ghost()
            || plan.removed.contains(&beyond)
            // Its half would be the twin of a flipped face.
            || mesh.face_with([split[0], split[1], far]).is_some()
            || self.surface.pinned[other[0]] && self.surface.pinned[other[1]]
        {
            return None;
        }
        let tip = other.into_iter().find(|v| split.contains(v))?;
        let near = face.opposite(split[0], split[1]);
        let new = VertexRow(mesh.vertex_rows() as u32);
        // (tip, near, new) and (tip, near, far) become (new, near, far) and (tip, new, far), with far the last corner of the face across.
        let half = Face::new([tip, near, new], across.labels()).vertices();
        let mut flipped = plan.clone();
        flipped.added.retain(|added| added.face.vertices() != half);
        flipped.removed.push(beyond);
        flipped.added.push(Added { face: across.with_replaced(tip, new), origin: Some(beyond) });
        flipped.added.push(Added { face: across.with_replaced(near, new), origin: Some(beyond) });
        // At a tip with three faces the split itself makes one of them.
        let has_twins = (0..flipped.added.len())
            .any(|i| flipped.added[..i].iter().any(|other| other.face.vertices() == flipped.added[i].face.vertices()));
        (!has_twins).then_some(flipped)
    }

    fn least_angles_before(&self, plan: &Plan) -> LeastAngles {
        let rows = plan.removed.iter().chain(&plan.reshaped);
        rows.fold(LeastAngles::NONE, |least, row| least.with_face_of(self.surface, *row))
    }

    pub(super) fn least_angles_after(&self, plan: &Plan) -> LeastAngles {
        plan.shaped(self.surface).fold(LeastAngles::NONE, |least, (face, _)| {
            let is_own = |v| face.around(v).into_iter().all(|end| plan.is_junction(self.surface, v, end));
            least.with(&face, plan.corners(self.surface, &face), is_own)
        })
    }

    /// Whether the smallest angle of all faces that a plan changes grows by a factor, and no film's own corner becomes narrower.
    pub(super) fn improves(&self, plan: &Plan, factor: f64) -> bool {
        let (before, after) = (self.least_angles_before(plan), self.least_angles_after(plan));
        after.rest > factor * before.rest + TIE && keeps_own(&before, &after)
    }

    /// Whether no face comes to have an angle below the good one that is smaller than those before.
    pub(super) fn keeps_angles(&self, plan: &Plan) -> bool {
        let (before, after) = (self.least_angles_before(plan), self.least_angles_after(plan));
        after.rest >= before.rest.min(Policy::GOOD_ANGLE) - TIE && keeps_own(&before, &after)
    }

    /// Collapses an edge for the sake of the angles around, to the best of a few places.
    fn collapse_for_shape(&mut self, a: VertexRow, b: VertexRow) -> Option<VertexRow> {
        if self.rests(a, b) {
            return None;
        }
        let mut plans: SmallVec<[(f64, ([VertexRow; 2], Plan)); 4]> = SmallVec::new();
        for (ends, place) in self.collapses(a, b) {
            let plan = self.plan_collapse(ends[0], ends[1], place);
            let fit = plan.filter(|plan| self.improves(plan, GROWTH) && !self.stretches(plan, ends[0]));
            plans.extend(fit.map(|plan| (self.least_angles_after(&plan).rest, (ends, plan))));
        }
        sort_by_angle(&mut plans);
        plans.into_iter().find_map(|(_, (ends, plan))| self.collapse_as_planned(ends, false, &plan))
    }

    /// Ways to collapse an edge, `[kept, gone]` and place: a short one as always, and any by which a vertex with few neighbours
    /// leaves the inside of a film.
    fn collapses(&self, a: VertexRow, b: VertexRow) -> SmallVec<[([VertexRow; 2], DVec3); 3]> {
        const FEW: usize = 5;
        let mut ways = SmallVec::new();
        if self.length(a, b) <= Policy::COLLAPSE_FOR_SHAPE * self.edge() {
            let [kept, gone] = self.by_rank(a, b);
            ways.push(([kept, gone], self.usual_place(kept, gone)));
        }
        for [kept, gone] in [[a, b], [b, a]] {
            if rank(self.surface, gone) == Rank::Film && self.surface.mesh.faces_of(gone).len() <= FEW {
                ways.push(([kept, gone], self.surface.positions[kept]));
            }
        }
        ways
    }

    /// Whether a new edge of a vertex would be split again.
    fn stretches(&self, plan: &Plan, kept: VertexRow) -> bool {
        let longest = self.policy.longest * self.edge();
        let ends = plan.added.iter().filter(|added| added.face.has(kept)).flat_map(|added| added.face.around(kept));
        ends.into_iter().any(|end| plan.at(self.surface, kept).distance(plan.at(self.surface, end)) > longest)
    }
}
