//! Separation of a vertex: T1 and pinching as one operation.
//!
//! Where two sectors of a vertex share no film, or films touch in the vertex alone, the vertex becomes two, `a` and `b`, pulled apart.
//! Faces of the one side go with `a`; along every edge `(v, w)` that this opens, a new film `(a, b, w)` closes the gap.
//!
//! ```text
//!     C | D           C | D          A and B meet at v (or along a line) alone, and C and D are apart.
//!   A --v-- B   ->   A  a  B         Pulling A's faces to a and the rest to b makes the film (a, b, w) between C and D ... or,
//!     E | F          ----b----       where nothing lies between, two vertices without a film between them: a pinch.
//! ```
//!
//! Equation: for the faces that go, `n = sum of s_f (e_back - e_front)` around edge `(v, w)`, `s_f = +1` if the face contains `v -> w`.
//! `n = 0` needs no film; `n = e_P - e_Q` is closed by `(a, b, w)` with back `P` and front `Q`; anything else refuses the candidate.
//! A separation is accepted if the films around shrink by more than a threshold (Da 2015, section 5.2, by area);
//! [`Policy`] says by how much.
//! A second way on from some vertices, a film between `A` and `B`, is [`contact`](super::contact). The way with the larger gain is taken first,
//! except where an edge has just shrunk to the vertex: pulled apart, it would come back and shrink again, so there the film is first.
//! Limits: vertices on wires are not separated.

use glam::DVec3;
use smallvec::{SmallVec, smallvec};

use super::Session;
use super::contact::{Contact, contact_candidates};
use super::plan::{Added, Plan, add_labels, as_film};
use crate::event::EventKind;
use crate::mesh::{Face, FaceList};
use crate::policy::Policy;
use crate::rows::{FaceRow, Region, VertexRow};
use crate::sectors::Candidate;
use crate::surface::Surface;
use crate::transfer::Blend;

/// Relative gains that differ by less are taken as equal.
const TIE: f64 = 1e-9;

/// What can be separated at a vertex. See [`Sectors::candidates`](crate::sectors::Sectors::candidates).
#[must_use]
pub fn separation_candidates(surface: &Surface, vertex: VertexRow) -> Vec<Candidate> {
    let faces: SmallVec<[Face; 16]> = surface.mesh.faces_of(vertex).iter().map(|row| surface.mesh.face(*row)).collect();
    crate::sectors::Sectors::of(vertex, &faces, &|v| surface.positions[v]).candidates()
}

/// Whether some film separates two regions.
pub(super) fn share_film(surface: &Surface, a: Region, b: Region) -> bool {
    surface.mesh.faces().any(|(_, face)| face.borders(a) && face.borders(b))
}

/// Regions of the films that a separation makes, ascending.
fn labels_made(plan: &Plan) -> SmallVec<[Region; 4]> {
    let films = plan.added.iter().filter(|added| added.origin.is_none()).flat_map(|added| added.face.labels());
    let mut made: SmallVec<[Region; 4]> = films.collect();
    made.sort_unstable();
    made.dedup();
    made
}

/// A way on from a vertex at which sectors meet without a film.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Way {
    /// Pull them apart.
    Apart(Candidate),
    /// Give them a film.
    Contact(Box<Contact>),
}

impl Session<'_> {
    /// Separates whatever meets without a film; then collapses what edges that left short, and separates what that left.
    pub fn separate_films(&mut self) {
        if self.separate_vertices() == 0 {
            return;
        }
        let separated = self.surface.mesh.vertices().filter(|v| self.marks[*v].separated == self.step).collect();
        self.collapse_short_edges_of(separated);
        self.separate_vertices();
    }

    /// Separates whatever meets without a film, the largest gain first, until nothing more can be; gives the number of separations.
    ///
    /// Only vertices whose faces changed are looked at, and those that were postponed.
    pub fn separate_vertices(&mut self) -> u64 {
        const MOST_PASSES: usize = 10;
        let before = self.counts.separations;
        for _ in 0..MOST_PASSES {
            let mut work = self.irregular_vertices();
            work.sort_by(|x, y| y.0.total_cmp(&x.0).then(x.1.cmp(&y.1)));
            let separated = work.into_iter().filter(|(_, v)| self.separate(*v)).count();
            if separated == 0 {
                break;
            }
        }
        self.counts.separations - before
    }

    /// Dirty vertices with something to separate, with the best relative gain. Regular ones are marked clean.
    fn irregular_vertices(&mut self) -> Vec<(f64, VertexRow)> {
        let dirty: Vec<VertexRow> = self.surface.mesh.vertices().filter(|v| self.marks[*v].dirty).collect();
        let mut found = Vec::new();
        for vertex in dirty {
            if self.surface.pinned[vertex] || self.is_plain(vertex) {
                self.marks[vertex].dirty = false;
                continue;
            }
            let ways = self.ways(vertex);
            self.marks[vertex].dirty = !ways.is_empty();
            found.extend(ways.first().map(|(best, _)| (*best, vertex)));
        }
        found
    }

    /// Whether a vertex is inside one film: every edge has two faces, and they form one fan.
    fn is_plain(&self, vertex: VertexRow) -> bool {
        let mesh = &self.surface.mesh;
        let faces = mesh.faces_of(vertex);
        let Some(first) = faces.first().map(|row| mesh.face(*row)) else { return true };
        let [start, mut at] = first.around(vertex);
        let mut previous = *faces.first().expect("invariant: the first face exists");
        for walked in 1..=faces.len() {
            if at == start {
                return walked == faces.len();
            }
            let mut others = faces.iter().filter(|row| **row != previous && mesh.face(**row).has(at));
            let (Some(next), None) = (others.next(), others.next()) else { return false };
            at = mesh.face(*next).opposite(vertex, at);
            previous = *next;
        }
        false
    }

    /// Ways on from a vertex with what each gains at its largest, best first.
    fn ways(&self, vertex: VertexRow) -> Vec<(f64, Way)> {
        let apart = separation_candidates(self.surface, vertex).into_iter().map(Way::Apart);
        let contacts =
            contact_candidates(self.surface, vertex).into_iter().map(|contact| Way::Contact(Box::new(contact)));
        let ways = apart.chain(contacts).filter_map(|way| Some((self.best_gain(vertex, &way)?, way)));
        let mut ways: Vec<(usize, (f64, Way))> = ways.enumerate().collect();
        // The edge that pulling apart would open again has just shrunk to this vertex.
        let is_squeezed = self.marks[vertex].squeezed > self.marks[vertex].separated;
        let is_preferred = |way: &Way| is_squeezed && matches!(way, Way::Contact(_));
        ways.sort_by(|(_, x), (_, y)| is_preferred(&y.1).cmp(&is_preferred(&x.1)).then(y.0.total_cmp(&x.0)));
        // Which of two sectors goes is often the same but for rounding, which must not decide.
        let is_tied = |(_, x): &(usize, (f64, Way)), (_, y): &(usize, (f64, Way))| {
            is_preferred(&x.1) == is_preferred(&y.1) && x.0 - y.0 < TIE
        };
        ways.chunk_by_mut(is_tied).for_each(|tied| tied.sort_by_key(|(place, _)| *place));
        ways.into_iter().map(|(_, way)| way).collect()
    }

    /// Relative gain in area at the largest separation along the first direction.
    fn best_gain(&self, vertex: VertexRow, way: &Way) -> Option<f64> {
        let direction = self.directions(vertex, way).into_iter().next()?;
        let plan = self.plan_way(vertex, way, direction, Policy::SEPARATIONS[0] * self.edge())?;
        Some(self.relative_gain(vertex, &plan))
    }

    /// Separates a vertex by its best way that nothing speaks against.
    pub fn separate(&mut self, vertex: VertexRow) -> bool {
        if !self.surface.mesh.has_vertex(vertex)
            || self.surface.pinned[vertex]
            || self.marks[vertex].separated == self.step
        {
            return false;
        }
        self.ways(vertex).into_iter().any(|(_, way)| self.try_way(vertex, &way))
    }

    fn try_way(&mut self, vertex: VertexRow, way: &Way) -> bool {
        let threshold = self.threshold(vertex);
        for direction in self.directions(vertex, way) {
            for distance in Policy::SEPARATIONS {
                let Some(plan) = self.plan_way(vertex, way, direction, distance * self.edge()) else {
                    return false;
                };
                // The gain is of first order in the distance: a smaller one would not help.
                if !(self.relative_gain(vertex, &plan) > threshold) {
                    break;
                }
                if self.tangles(&plan) || self.is_blocked(&plan) {
                    continue;
                }
                self.carry_out(vertex, way, &plan);
                return true;
            }
        }
        false
    }

    /// The plan that puts two new neighbours twice a distance apart.
    fn plan_way(&self, vertex: VertexRow, way: &Way, direction: DVec3, distance: f64) -> Option<Plan> {
        match way {
            Way::Apart(candidate) => self.plan_separation(vertex, candidate, direction, distance),
            Way::Contact(contact) => self.plan_contact(vertex, contact, 2.0 * distance),
        }
    }

    /// What a separation has to gain: more at a vertex that films were joined at, where it would undo the contact.
    fn threshold(&self, vertex: VertexRow) -> f64 {
        let snapped = self.marks[vertex].snapped;
        if snapped == 0 {
            return -Policy::SEPARATION_ALLOWANCE;
        }
        if self.step <= snapped + Policy::REST_AFTER_SNAP { f64::INFINITY } else { Policy::SEPARATION_GAIN }
    }

    fn carry_out(&mut self, vertex: VertexRow, way: &Way, plan: &Plan) {
        let place = self.surface.positions[vertex];
        self.counts.separations += 1;
        let new = self.commit(plan);
        for v in new.into_iter().chain([vertex]) {
            self.marks[v].separated = self.step;
        }
        match way {
            Way::Apart(candidate) => {
                let made = labels_made(plan);
                let is_pinch = candidate.is_component || made.is_empty();
                let kind = if is_pinch { EventKind::Pinch } else { EventKind::T1 };
                self.note(kind, place, candidate.regions.into_iter().chain(made));
            }
            Way::Contact(contact) => {
                self.note(EventKind::T1, place, contact.around.iter().copied().chain(contact.poles));
            }
        }
    }

    fn star(&self, vertex: VertexRow) -> FaceList {
        FaceList::from_slice(self.surface.mesh.faces_of(vertex))
    }

    /// Part of the star's area that a separation saves.
    fn relative_gain(&self, vertex: VertexRow, plan: &Plan) -> f64 {
        let before: f64 = self.star(vertex).iter().map(|row| self.surface.area(*row)).sum();
        let faces = plan.shaped(self.surface);
        let after: f64 = faces.map(|(face, _)| super::checks::area(plan.corners(self.surface, &face))).sum();
        (before - after) / before
    }

    /// The separation along a direction: `v + d` takes the faces that go, `v - d` keeps the rest and the row.
    fn plan_separation(
        &self,
        vertex: VertexRow,
        candidate: &Candidate,
        direction: DVec3,
        distance: f64,
    ) -> Option<Plan> {
        let surface = &*self.surface;
        let star = self.star(vertex);
        let new = VertexRow(surface.mesh.vertex_rows() as u32);
        let (going, staying): (Vec<_>, Vec<_>) =
            star.iter().copied().zip(&candidate.goes).partition(|(_, goes)| **goes);
        if going.is_empty() || staying.is_empty() {
            return None;
        }
        let place = surface.positions[vertex];
        let (away, back) = (place + direction * distance, place - direction * distance);
        let mut plan = Plan {
            created: smallvec![(away, false)],
            moved: smallvec![(vertex, back)],
            blends: smallvec![Blend { vertex: new, parents: smallvec![(vertex, 1.0)] }],
            meets: true,
            ..Plan::default()
        };
        for (row, _) in &going {
            plan.removed.push(*row);
            let face = surface.mesh.face(*row).with_replaced(vertex, new);
            plan.added.push(Added { face, origin: Some(*row) });
        }
        let rows = |faces: &[(FaceRow, &bool)]| faces.iter().map(|(row, _)| *row).collect::<FaceList>();
        plan.sweep(surface, vertex, &rows(&going), away);
        plan.sweep(surface, vertex, &rows(&staying), back);
        self.close_gaps(&mut plan, vertex, new, &rows(&going))?;
        plan.note_reshaped(surface);
        Some(plan)
    }

    /// Adds the films that close what opens along the edges of the faces that go; `None` where no single film would.
    fn close_gaps(&self, plan: &mut Plan, vertex: VertexRow, new: VertexRow, going: &[FaceRow]) -> Option<()> {
        let mesh = &self.surface.mesh;
        let mut ends: SmallVec<[VertexRow; 32]> = going.iter().flat_map(|row| mesh.face(*row).around(vertex)).collect();
        ends.sort_unstable();
        ends.dedup();
        for end in ends {
            let mut balance = SmallVec::new();
            for face in going.iter().map(|row| mesh.face(*row)).filter(|face| face.has(end)) {
                add_labels(&mut balance, face.labels(), face.direction(vertex, end));
            }
            if let Some(labels) = as_film(&balance).ok()? {
                plan.added.push(Added { face: Face::new([new, vertex, end], labels), origin: None });
            }
        }
        Some(())
    }

    /// Directions to try, unit vectors from `b` to `a`: between the centroids of the far ends; then the one of steepest descent of area.
    ///
    /// A contact knows its own, so that any stands for it.
    fn directions(&self, vertex: VertexRow, way: &Way) -> SmallVec<[DVec3; 2]> {
        let Way::Apart(candidate) = way else { return smallvec![DVec3::ZERO] };
        let star = self.star(vertex);
        let place = self.surface.positions[vertex];
        let centroid = |wanted: bool| {
            let rows = star.iter().zip(&candidate.goes).filter(|(_, goes)| **goes == wanted).map(|(row, _)| *row);
            let ends: SmallVec<[DVec3; 32]> = rows
                .flat_map(|row| self.surface.mesh.face(row).around(vertex))
                .map(|v| self.surface.positions[v] - place)
                .collect();
            ends.iter().sum::<DVec3>() / ends.len().max(1) as f64
        };
        let between = centroid(true) - centroid(false);
        let mut directions = SmallVec::new();
        if between.length() > 1e-6 * self.edge() {
            directions.push(between.normalize());
        }
        let pull = self.area_pull(vertex, candidate);
        if pull.length() > 1e-6 * self.edge() {
            directions.push(pull.normalize());
        }
        if directions.is_empty() {
            // A perfectly symmetric star: along the normal of the first face that goes, whichever side.
            let first = star.iter().zip(&candidate.goes).find(|(_, goes)| **goes).map(|(row, _)| *row);
            directions.extend(first.and_then(|row| self.surface.double_area_normal(row).try_normalize()));
        }
        directions
    }

    /// Force of the faces that go on the vertex less that of the rest: minus the gradient of area with respect to `d`.
    fn area_pull(&self, vertex: VertexRow, candidate: &Candidate) -> DVec3 {
        let star = self.star(vertex);
        let signed = |(row, goes): (&FaceRow, &bool)| self.pull(vertex, *row) * if *goes { 1.0 } else { -1.0 };
        star.iter().zip(&candidate.goes).map(signed).sum()
    }

    /// Force of a face on one of its vertices: minus the gradient of its area, m.
    pub(super) fn pull(&self, vertex: VertexRow, row: FaceRow) -> DVec3 {
        // The gradient of a triangle (v, p, q) with unit normal n is n x (q - p) / 2.
        let [p, q] = self.surface.mesh.face(row).around(vertex).map(|v| self.surface.positions[v]);
        let normal = self.surface.double_area_normal(row).normalize_or_zero();
        -0.5 * normal.cross(q - p)
    }
}
