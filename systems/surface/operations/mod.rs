//! Operations on films, each as plan, check, commit.
//!
//! A `plan_...` function works out a [`Plan`] without touching the mesh; the checks of [`Session`] refuse it or let it pass; then
//! [`Session::commit`] edits the mesh, the grid and the data. A refused operation leaves no trace.
//!
//! | operation | file | changes topology |
//! |---|---|---|
//! | split of an edge or a face | `split`, `butterfly` | never |
//! | collapse of an edge | `collapse` | closes necks, makes films meet |
//! | separation of a vertex (T1, pinch) | `separate` | pulls apart what meets without a film |
//! | contact of two sectors (T1 from an edge to a film) | `contact` | gives two regions a film |
//! | snap of two vertices | `snap` | joins films that come near |
//! | flip of an edge | `flip` | never |
//! | move of a vertex within its film | `relax` | never |
//! | refinement of narrow films | `refine` | never |
//! | insertion of a vertex into a film | `insert` | never |
//! | improvement of thin faces | `improve` | never |
//! | burst of a film | `burst` | joins two regions |

mod burst;
mod butterfly;
mod checks;
mod collapse;
mod contact;
mod flip;
mod improve;
mod insert;
mod plan;
mod refine;
mod relax;
mod separate;
mod snap;
mod split;
mod verify;

use glam::DVec3;
use serde::{Deserialize, Serialize};
use smallvec::SmallVec;

pub use burst::BurstRefused;
pub use contact::{Contact, contact_candidates};
pub use plan::{Added, Plan, Sweep, Trimmed, trim};
pub use separate::separation_candidates;
pub use snap::Pair;

use crate::event::{Event, EventKind};
use crate::grid::{Aabb, FaceGrid};
use crate::mesh::Face;
use crate::policy::Policy;
use crate::rows::{FaceRow, PerVertex, Region, VertexRow};
use crate::sectors::Sectors;
use crate::surface::Surface;
use crate::transfer::{AreaChange, Change, Transfer};

/// What the tracker remembers of a vertex from step to step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Mark {
    /// Step of its last separation; 0 for none.
    pub separated: u64,
    /// Step in which films were last joined at it; 0 for none.
    pub snapped: u64,
    /// Step in which an edge of three films last shrank to it; 0 for none.
    pub squeezed: u64,
    /// Whether its sectors have not been looked at since its faces changed.
    pub dirty: bool,
}

/// Operations that were carried out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Counts {
    /// Edges split.
    pub splits: u64,
    /// Faces split.
    pub face_splits: u64,
    /// Edges collapsed.
    pub collapses: u64,
    /// Vertices separated.
    pub separations: u64,
    /// Vertices snapped.
    pub snaps: u64,
    /// Edges flipped.
    pub flips: u64,
    /// Vertices moved within their films.
    pub moves: u64,
    /// Films burst.
    pub bursts: u64,
    /// Plans refused because films were in the way.
    pub blocked: u64,
}

impl std::ops::AddAssign for Counts {
    fn add_assign(&mut self, other: Self) {
        self.splits += other.splits;
        self.face_splits += other.face_splits;
        self.collapses += other.collapses;
        self.separations += other.separations;
        self.snaps += other.snaps;
        self.flips += other.flips;
        self.moves += other.moves;
        self.bursts += other.bursts;
        self.blocked += other.blocked;
    }
}

/// The mesh, open for operations.
pub struct Session<'a> {
    /// The films.
    pub surface: &'a mut Surface,
    /// Thresholds.
    pub policy: &'a Policy,
    /// Data on vertices.
    pub data: &'a mut dyn Transfer,
    /// What is remembered of vertices.
    pub marks: &'a mut PerVertex<Mark>,
    /// The present step, from 1.
    pub step: u64,
    /// What was done.
    pub counts: Counts,
    /// What happened to the topology.
    pub events: Vec<Event>,
    /// Built when an operation first asks what is near: most passes over a mesh at rest never do.
    grid: Option<FaceGrid>,
    found: Vec<FaceRow>,
}

impl<'a> Session<'a> {
    /// Opens a surface for operations in a step, counted from 1.
    pub fn new(
        surface: &'a mut Surface,
        policy: &'a Policy,
        data: &'a mut dyn Transfer,
        marks: &'a mut PerVertex<Mark>,
        step: u64,
    ) -> Self {
        marks.resize(surface.mesh.vertex_rows(), Mark { dirty: true, ..Mark::default() });
        let (counts, events, found) = (Counts::default(), Vec::new(), Vec::new());
        Self { surface, policy, data, marks, step, counts, events, grid: None, found }
    }

    /// Target edge length, metres.
    #[must_use]
    pub fn edge(&self) -> f64 {
        self.policy.edge
    }

    /// Length of an edge, metres.
    #[must_use]
    pub fn length(&self, a: VertexRow, b: VertexRow) -> f64 {
        self.surface.positions[a].distance(self.surface.positions[b])
    }

    /// Sectors of a vertex once a plan is carried out.
    #[must_use]
    pub fn sectors_after(&self, plan: &Plan, vertex: VertexRow) -> Sectors {
        Sectors::of(vertex, &plan.star(self.surface, vertex), &|v| plan.at(self.surface, v))
    }

    /// Sectors of a vertex.
    #[must_use]
    pub fn sectors(&self, vertex: VertexRow) -> Sectors {
        let faces: SmallVec<[Face; 16]> =
            self.surface.mesh.faces_of(vertex).iter().map(|row| self.surface.mesh.face(*row)).collect();
        Sectors::of(vertex, &faces, &|v| self.surface.positions[v])
    }

    /// Notes a change of topology.
    pub fn note(&mut self, kind: EventKind, place: DVec3, regions: impl IntoIterator<Item = Region>) {
        self.events.push(Event { kind, place, regions: regions.into_iter().collect() });
    }

    /// Faces whose boxes overlap a box, ascending.
    pub(crate) fn near(&mut self, reach: Aabb) -> &[FaceRow] {
        let (surface, edge) = (&*self.surface, self.policy.edge);
        self.grid.get_or_insert_with(|| film_grid(surface, edge)).query(reach, &mut self.found);
        &self.found
    }

    /// Carries out a plan. Gives the rows of the vertices it creates.
    pub fn commit(&mut self, plan: &Plan) -> SmallVec<[VertexRow; 1]> {
        let touched = plan.touched(self.surface);
        let before: SmallVec<[f64; 24]> = touched.iter().map(|v| self.star_area(*v)).collect();
        for row in plan.removed.iter().chain(&plan.reshaped) {
            self.take_from_grid(*row);
        }
        let created = plan.created.iter().map(|(place, pinned)| self.create(*place, *pinned)).collect();
        for row in &plan.removed {
            self.surface.mesh.remove_face(*row);
        }
        plan.moved.iter().for_each(|(vertex, place)| self.surface.positions[*vertex] = *place);
        let added: SmallVec<[FaceRow; 16]> =
            plan.added.iter().map(|added| self.surface.mesh.add_face(added.face)).collect();
        for row in added.iter().chain(&plan.reshaped) {
            self.give_to_grid(*row);
        }
        let areas = touched.iter().zip(before);
        let areas = areas.map(|(v, before)| AreaChange { vertex: *v, before, after: self.star_area(*v) }).collect();
        touched.iter().for_each(|v| self.marks[*v].dirty = true);
        let (blends, fused) = (plan.blends.clone(), plan.fused.clone());
        let meets = plan.meets || !plan.fused.is_empty() || !plan.windows.is_empty();
        self.data.transfer(self.surface, &Change { blends, areas, fused, joined: plan.joined, meets });
        debug_assert_eq!(
            crate::invariants::check_combinatorial_around(self.surface, &touched),
            Ok(()),
            "after {plan:?}"
        );
        created
    }

    fn create(&mut self, place: DVec3, pinned: bool) -> VertexRow {
        self.surface.positions.push(place);
        self.surface.pinned.push(pinned);
        self.marks.push(Mark { dirty: true, ..Mark::default() });
        self.surface.mesh.add_vertex()
    }

    /// A third of the film area around a vertex, m^2; 0 for one that does not exist yet.
    fn star_area(&self, vertex: VertexRow) -> f64 {
        if vertex.index() >= self.surface.mesh.vertex_rows() {
            return 0.0;
        }
        let films = self.surface.mesh.faces_of(vertex).iter().filter(|row| !self.surface.mesh.face(**row).is_ghost());
        films.map(|row| self.surface.area(*row)).sum::<f64>() / 3.0
    }

    fn take_from_grid(&mut self, row: FaceRow) {
        let Some(grid) = &mut self.grid else { return };
        if !self.surface.mesh.face(row).is_ghost() {
            grid.remove(row, Aabb::of(&self.surface.corners(row)));
        }
    }

    fn give_to_grid(&mut self, row: FaceRow) {
        let Some(grid) = &mut self.grid else { return };
        if !self.surface.mesh.face(row).is_ghost() {
            grid.insert(row, Aabb::of(&self.surface.corners(row)));
        }
    }
}

/// All films in a grid that follows them.
fn film_grid(surface: &Surface, edge: f64) -> FaceGrid {
    let mut grid = FaceGrid::new(1.5 * edge, surface.mesh.face_count());
    for (row, _) in surface.mesh.faces().filter(|(_, face)| !face.is_ghost()) {
        grid.insert(row, Aabb::of(&surface.corners(row)));
    }
    grid
}
