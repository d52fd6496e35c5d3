//! Finds the pairs of a vertex and a face, and of two edges, that a motion could bring together.
//!
//! A pair is kept only if its swept boxes overlap, and if no slab normal to the line between its centres, as wide as the gap,
//! parts all places that its vertices can reach with any fractions of their ways. What is dropped need never be looked at again.

use glam::DVec3;

use super::faces::{Guard, can_fold};
use super::{MotionSettings, in_chunks};
use crate::grid::{Aabb, BoxGrid};
use crate::kernel::collision::{edge_edge_impact, point_triangle_impact};
use crate::rows::VertexRow;
use crate::surface::Surface;

/// Four vertices that may meet: a vertex and a face, or two edges.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Stencil {
    pub(super) vertices: [VertexRow; 4],
    is_edges: bool,
}

impl Stencil {
    /// When it meets: see [`crate::kernel::collision`].
    pub(super) fn impact(&self, x: [DVec3; 4], shift: [DVec3; 4], gap: f64) -> Option<f64> {
        if self.is_edges { edge_edge_impact(x, shift, gap) } else { point_triangle_impact(x, shift, gap) }
    }
}

/// The elements that collide, and how they move.
struct Sweep<'a> {
    positions: &'a [DVec3],
    shift: &'a [DVec3],
    gap: f64,
    /// Per vertex: box of its way.
    swept: Vec<Aabb>,
    /// Vertices with faces.
    vertices: Vec<VertexRow>,
    edges: Vec<[VertexRow; 2]>,
    faces: Vec<[VertexRow; 3]>,
}

/// All stencils that some fractions of the shifts (per vertex, metres) could bring together.
pub(super) fn gather(surface: &Surface, shift: &[DVec3], settings: &MotionSettings) -> Vec<Stencil> {
    let sweep = Sweep::new(surface, shift, settings);
    let mut stencils = sweep.vertices_and_faces();
    stencils.extend(sweep.pairs_of_edges());
    stencils
}

/// All faces that some fractions of the shifts (per vertex, metres) could fold.
pub(super) fn guards(surface: &Surface, shift: &[DVec3], settings: &MotionSettings) -> Vec<Guard> {
    in_chunks(&colliding(surface, settings), |vertices| {
        let [x, u] = [&surface.positions.0, shift].map(|per_vertex| vertices.map(|v| per_vertex[v.index()]));
        can_fold(x, u).then_some(Guard { vertices: *vertices })
    })
}

/// Vertices of the faces that collide.
fn colliding(surface: &Surface, settings: &MotionSettings) -> Vec<[VertexRow; 3]> {
    let colliding = surface.mesh.faces().filter(|(_, face)| settings.ghosts_collide || !face.is_ghost());
    colliding.map(|(_, face)| face.vertices()).collect()
}

impl<'a> Sweep<'a> {
    fn new(surface: &'a Surface, shift: &'a [DVec3], settings: &MotionSettings) -> Self {
        let positions = &surface.positions.0;
        let swept = positions.iter().zip(shift).map(|(x, u)| Aabb::of(&[*x, *x + *u])).collect();
        let faces = colliding(surface, settings);
        let mut has_faces = vec![false; positions.len()];
        faces.iter().flatten().for_each(|v| has_faces[v.index()] = true);
        let vertices = (0..positions.len() as u32).map(VertexRow).filter(|v| has_faces[v.index()]).collect();
        let edges = edges_of(&faces, positions.len());
        Self { positions, shift, gap: settings.gap, swept, vertices, edges, faces }
    }

    fn box_of(&self, vertices: &[VertexRow]) -> Aabb {
        vertices.iter().fold(Aabb::EMPTY, |all, v| all.union(self.swept[v.index()]))
    }

    fn vertices_and_faces(&self) -> Vec<Stencil> {
        let grid = BoxGrid::fitted(self.faces.iter().map(|face| self.box_of(face)).collect());
        let ways = self.vertices.iter().map(|v| self.swept[v.index()].padded(self.gap)).collect();
        grid.pairs_with(ways, |i, j| {
            let (v, [a, b, c]) = (self.vertices[i as usize], self.faces[j as usize]);
            let is_apart = v != a && v != b && v != c;
            (is_apart && self.can_meet::<1>([v, a, b, c]))
                .then_some(Stencil { vertices: [v, a, b, c], is_edges: false })
        })
    }

    fn pairs_of_edges(&self) -> Vec<Stencil> {
        let half = |edge: &[VertexRow; 2]| self.box_of(edge).padded(0.5 * self.gap);
        let grid = BoxGrid::fitted(self.edges.iter().map(half).collect());
        grid.pairs(|i, j| {
            let ([a, b], [c, d]) = (self.edges[i as usize], self.edges[j as usize]);
            let is_apart = a != c && a != d && b != c && b != d;
            (is_apart && self.can_meet::<2>([a, b, c, d])).then_some(Stencil { vertices: [a, b, c, d], is_edges: true })
        })
    }

    /// Whether no slab between the centres parts the ways of the first `SPLIT` vertices and of the others.
    fn can_meet<const SPLIT: usize>(&self, vertices: [VertexRow; 4]) -> bool {
        let origin = self.positions[vertices[0].index()];
        let x = vertices.map(|v| self.positions[v.index()] - origin);
        let sum = |part: &[DVec3]| part.iter().sum::<DVec3>();
        let normal = sum(&x[..SPLIT]) * (4 - SPLIT) as f64 - sum(&x[SPLIT..]) * SPLIT as f64;
        let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
        for i in 0..4 {
            let (from, by) = (x[i].dot(normal), self.shift[vertices[i].index()].dot(normal));
            if i < SPLIT {
                least = least.min(from + by.min(0.0));
            } else {
                most = most.max(from + by.max(0.0));
            }
        }
        let width = least - most;
        !(width > 0.0 && width * width > self.gap * self.gap * normal.length_squared())
    }
}

/// Edges of faces with ascending vertices, ascending.
fn edges_of(faces: &[[VertexRow; 3]], vertices: usize) -> Vec<[VertexRow; 2]> {
    // A counting sort by the first vertex; each has a handful of seconds.
    let pairs = || faces.iter().flat_map(|[a, b, c]| [[*a, *b], [*a, *c], [*b, *c]]);
    let mut starts = vec![0u32; vertices + 1];
    pairs().for_each(|[a, _]| starts[a.index() + 1] += 1);
    for v in 0..vertices {
        starts[v + 1] += starts[v];
    }
    let mut next = starts.clone();
    let mut seconds = vec![VertexRow(0); faces.len() * 3];
    for [a, b] in pairs() {
        seconds[next[a.index()] as usize] = b;
        next[a.index()] += 1;
    }
    let mut edges = Vec::with_capacity(faces.len() * 3 / 2);
    for v in 0..vertices {
        let list = &mut seconds[starts[v] as usize..starts[v + 1] as usize];
        list.sort_unstable();
        let from = edges.len();
        for b in list.iter() {
            if edges[from..].last() != Some(&[VertexRow(v as u32), *b]) {
                edges.push([VertexRow(v as u32), *b]);
            }
        }
    }
    edges
}
