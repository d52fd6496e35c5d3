//! Flips of edges towards the Delaunay triangulation: they raise the smallest angle, and with it the stable step.
//!
//! An edge with two faces is flipped if the angles opposite to it add up to more than 180 degrees
//! ([`Policy::flip_excess`](crate::Policy::flip_excess)), the two faces bend by less than 30 degrees, and nothing is in the way.
//! Junctions, ghosts and edges on wires are left alone.

use smallvec::SmallVec;

use super::plan::{Added, Plan, Sweep};
use super::{Session, checks};
use crate::mesh::Face;
use crate::policy::Policy;
use crate::rows::VertexRow;

impl Session<'_> {
    /// Flips edges until all are Delaunay, in at most five sweeps; gives the number of flips.
    pub fn flip_edges(&mut self) -> u64 {
        const MOST_SWEEPS: usize = 5;
        let before = self.counts.flips;
        let mut queue = self.edges_opposite_to_obtuse_angles();
        for _ in 0..MOST_SWEEPS {
            let mut changed: Vec<VertexRow> = Vec::new();
            for [a, b] in queue {
                changed.extend(self.flip(a, b).into_iter().flatten());
            }
            changed.sort_unstable();
            changed.dedup();
            if changed.is_empty() {
                break;
            }
            queue = self.edges_around(&changed);
        }
        self.counts.flips - before
    }

    /// Edges that may be wanted, ascending: of two angles that add up to more than 180 degrees one is obtuse.
    fn edges_opposite_to_obtuse_angles(&self) -> Vec<[VertexRow; 2]> {
        let mut edges = Vec::new();
        for (row, face) in self.surface.mesh.faces().filter(|(_, face)| !face.is_ghost()) {
            let [a, b, c] = self.surface.corners(row);
            let [u, v, w] = face.vertices();
            for (at, p, q, edge) in [(a, b, c, [v, w]), (b, c, a, [u, w]), (c, a, b, [u, v])] {
                if (p - at).dot(q - at) < 0.0 {
                    edges.push(edge);
                }
            }
        }
        edges.sort_unstable();
        edges.dedup();
        edges
    }

    fn edges_around(&self, vertices: &[VertexRow]) -> Vec<[VertexRow; 2]> {
        let neighbours = |a: VertexRow| self.surface.mesh.neighbours(a).into_iter().map(move |b| [a.min(b), a.max(b)]);
        let mut edges: Vec<[VertexRow; 2]> = vertices.iter().flat_map(|a| neighbours(*a)).collect();
        edges.sort_unstable();
        edges.dedup();
        edges
    }

    /// Flips an edge if it is not Delaunay and nothing speaks against it. Gives the four vertices around.
    pub fn flip(&mut self, a: VertexRow, b: VertexRow) -> Option<[VertexRow; 4]> {
        self.flip_where(a, b, Self::is_wanted)
    }

    /// Flips an edge if that makes the smallest angle larger and nothing speaks against it.
    pub(super) fn flip_for_shape(&mut self, a: VertexRow, b: VertexRow) -> Option<[VertexRow; 4]> {
        self.flip_where(a, b, |_, _| true)
    }

    fn flip_where(
        &mut self,
        a: VertexRow,
        b: VertexRow,
        is_wanted: impl Fn(&Self, [VertexRow; 4]) -> bool,
    ) -> Option<[VertexRow; 4]> {
        let mesh = &self.surface.mesh;
        let faces = mesh.faces_of_edge(a, b);
        let [first, second] = faces.as_slice() else { return None };
        let (one, two) = (mesh.face(*first), mesh.face(*second));
        let (c, d) = (one.opposite(a, b), two.opposite(a, b));
        if one.is_ghost() || two.is_ghost() || self.surface.pinned[a] && self.surface.pinned[b] {
            return None;
        }
        if !is_wanted(self, [a, b, c, d])
            || mesh.has_edge(c, d)
            || self.marks[a].separated.min(self.marks[b].separated) == self.step
        {
            return None;
        }
        let mut plan = Plan::default();
        plan.removed.extend([*first, *second]);
        // Each new face keeps the winding, and so the sides, of the old face that it shares a rim edge with.
        plan.added.push(Added { face: one.with_replaced(b, d), origin: Some(*first) });
        plan.added.push(Added { face: one.with_replaced(a, d), origin: Some(*second) });
        // What lies between the old and the new pair is swept.
        plan.sweeps.push(Sweep { vertex: a, to: self.surface.positions[b], base: [c, d] });
        if self.bends(&plan)
            || !self.improves(&plan, 1.0)
            || self.loses_volume(&plan)
            || self.tangles(&plan)
            || self.is_blocked(&plan)
        {
            return None;
        }
        self.counts.flips += 1;
        self.commit(&plan);
        Some([a, b, c, d])
    }

    fn is_wanted(&self, ends_and_apexes: [VertexRow; 4]) -> bool {
        let corners = ends_and_apexes.map(|v| self.surface.positions[v]);
        checks::add_up_to_more_than_half_a_turn(corners, self.policy.flip_excess)
    }

    /// Whether the old or the new pair of faces bends too much.
    fn bends(&self, plan: &Plan) -> bool {
        let surface = &*self.surface;
        let normal = |face: &Face| {
            let [a, b, c] = plan.corners(surface, face);
            (b - a).cross(c - a)
        };
        // All four towards the same region.
        let front = surface.mesh.face(plan.removed[0]).labels()[1];
        let towards = |face: &Face| if face.labels()[1] == front { normal(face) } else { -normal(face) };
        let old = plan.removed.iter().map(|row| towards(&surface.mesh.face(*row)));
        let new = plan.added.iter().map(|added| towards(&added.face));
        let normals: SmallVec<[glam::DVec3; 4]> = old.chain(new).collect();
        let least = Policy::LARGEST_FLIP_BEND.cos();
        let cosine = |x: glam::DVec3, y: glam::DVec3| x.normalize_or_zero().dot(y.normalize_or_zero());
        (0..4).any(|i| (0..i).any(|j| cosine(normals[i], normals[j]) < least))
    }
}
