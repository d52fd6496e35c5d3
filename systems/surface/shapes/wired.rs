//! Blocks of triangles with wires, and two ways to refine them: by a frequency, and by halving the longest edges.
//!
//! A generator writes a coarse complex by hand and refines it here. Both ways keep labels on their sides and leave no vertex
//! in the middle of an edge. Which edges are wires is said explicitly: a new vertex is held only where it lies on a wire, or
//! among ghosts only, so that a film with all its corners on a wire stays a film.

use std::collections::{BTreeMap, BTreeSet, BinaryHeap};

use glam::DVec3;
use smallvec::SmallVec;

use super::fairing::{Snap, freely};
use crate::surface::LabelledTriangles;

/// Triangles, and which of their edges are wires.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WiredFilms {
    /// The triangles.
    pub set: LabelledTriangles,
    /// Edges that lie on a wire, `[a, b]` with `a < b`.
    pub wires: BTreeSet<[u32; 2]>,
}

/// Labels around an edge, ascending.
type Regions = SmallVec<[u32; 4]>;

/// Where a point of a subdivided triangle goes: corners, barycentric weights, and the regions that meet there, ascending.
///
/// For a point on an edge only the two ends have a weight; the place must not depend on the third corner then.
pub trait Place: Fn([DVec3; 3], [f64; 3], &[u32]) -> DVec3 {}
impl<F: Fn([DVec3; 3], [f64; 3], &[u32]) -> DVec3> Place for F {}

/// The point itself: films stay flat.
#[must_use]
pub fn flat(corners: [DVec3; 3], weights: [f64; 3], _regions: &[u32]) -> DVec3 {
    corners[0] * weights[0] + corners[1] * weights[1] + corners[2] * weights[2]
}

/// An edge with its rows in ascending order.
#[must_use]
pub const fn sorted(a: u32, b: u32) -> [u32; 2] {
    if a < b { [a, b] } else { [b, a] }
}

/// The three edges of a triangle.
fn edges_of([a, b, c]: [u32; 3]) -> [[u32; 2]; 3] {
    [sorted(a, b), sorted(b, c), sorted(c, a)]
}

/// What a subdivision needs to know of an edge.
#[derive(Default)]
struct EdgePoints {
    regions: Regions,
    only_ghosts: bool,
    first: u32,
}

impl WiredFilms {
    /// Triangles without wires.
    #[must_use]
    pub const fn new(set: LabelledTriangles) -> Self {
        Self { set, wires: BTreeSet::new() }
    }

    /// Adds a wire.
    pub fn add_wire(&mut self, a: u32, b: u32) {
        self.wires.insert(sorted(a, b));
    }

    /// Frequency that makes the average edge `edge` (metres): that of equilateral triangles of the same average area.
    #[must_use]
    pub fn frequency_for(&self, edge: f64) -> u32 {
        let area: f64 = self.set.triangles.iter().map(|t| triangle_area(&self.set.positions, *t)).sum();
        let side = (area / self.set.triangles.len().max(1) as f64 * 4.0 / 3f64.sqrt()).sqrt();
        ((side / edge).round() as u32).max(1)
    }

    /// Splits every triangle into `frequency^2`, and puts each new vertex where `place` says.
    #[must_use]
    pub fn subdivide(&self, frequency: u32, place: impl Place) -> Self {
        let mut fine = Self::default();
        fine.set.positions.clone_from(&self.set.positions);
        fine.set.pinned.clone_from(&self.set.pinned);
        fine.set.open.clone_from(&self.set.open);
        let edges = self.add_edge_points(&mut fine, frequency, &place);
        for face in 0..self.set.triangles.len() {
            let rows = self.rows_of_face(&mut fine.set, face, frequency, &edges, &place);
            self.add_pieces(&mut fine.set, face, frequency, &rows);
        }
        fine
    }

    fn edge_table(&self) -> BTreeMap<[u32; 2], EdgePoints> {
        let mut edges: BTreeMap<[u32; 2], EdgePoints> = BTreeMap::new();
        for (face, triangle) in self.set.triangles.iter().enumerate() {
            for edge in edges_of(*triangle) {
                let points =
                    edges.entry(edge).or_insert_with(|| EdgePoints { only_ghosts: true, ..Default::default() });
                points.only_ghosts &= self.set.ghosts[face];
                points.regions.extend(self.set.labels[face]);
            }
        }
        for points in edges.values_mut() {
            points.regions.sort_unstable();
            points.regions.dedup();
        }
        edges
    }

    /// Adds the vertices inside edges, from the lower row to the higher.
    fn add_edge_points(&self, fine: &mut Self, frequency: u32, place: &impl Place) -> BTreeMap<[u32; 2], EdgePoints> {
        let mut edges = self.edge_table();
        for ([a, b], points) in &mut edges {
            let is_wire = self.wires.contains(&[*a, *b]);
            points.first = fine.set.positions.len() as u32;
            let ends = [*a, *b, *a].map(|v| self.set.positions[v as usize]);
            for step in 1..frequency {
                let t = f64::from(step) / f64::from(frequency);
                fine.set.add_vertex(place(ends, [1.0 - t, t, 0.0], &points.regions), is_wire || points.only_ghosts);
            }
            if is_wire {
                let rows: Vec<u32> = (0..=frequency).map(|k| edge_row([*a, *b], points.first, frequency, k)).collect();
                rows.windows(2).for_each(|pair| fine.add_wire(pair[0], pair[1]));
            }
        }
        edges
    }

    /// Rows of the points of a face, `(b, c)` steps from its first corner, `c` fastest; adds those inside it.
    fn rows_of_face(
        &self,
        fine: &mut LabelledTriangles,
        face: usize,
        frequency: u32,
        edges: &BTreeMap<[u32; 2], EdgePoints>,
        place: &impl Place,
    ) -> Vec<u32> {
        let [a, b, c] = self.set.triangles[face];
        let corners = [a, b, c].map(|v| self.set.positions[v as usize]);
        let mut regions = self.set.labels[face];
        regions.sort_unstable();
        let on = |from: u32, to: u32, step: u32| {
            let edge = sorted(from, to);
            let step = if edge[0] == from { step } else { frequency - step };
            edge_row(edge, edges[&edge].first, frequency, step)
        };
        let mut rows = Vec::new();
        for i in 0..=frequency {
            for j in 0..=frequency - i {
                rows.push(match (i, j, frequency - i - j) {
                    (i, 0, _) => on(a, b, i),
                    (0, j, _) => on(a, c, j),
                    (_, j, 0) => on(b, c, j),
                    (i, j, k) => {
                        let weights = [k, i, j].map(|w| f64::from(w) / f64::from(frequency));
                        fine.add_vertex(place(corners, weights, &regions), self.set.ghosts[face])
                    }
                });
            }
        }
        rows
    }

    fn add_pieces(&self, fine: &mut LabelledTriangles, face: usize, frequency: u32, rows: &[u32]) {
        let (labels, ghost) = (self.set.labels[face], self.set.ghosts[face]);
        let at = |i: u32, j: u32| rows[(i * (frequency + 1) - i * i.saturating_sub(1) / 2 + j) as usize];
        for i in 0..frequency {
            for j in 0..frequency - i {
                fine.add_face([at(i, j), at(i + 1, j), at(i, j + 1)], labels, ghost);
                if i + j + 1 < frequency {
                    fine.add_face([at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)], labels, ghost);
                }
            }
        }
    }

    /// Halves the longest edge of all, again and again, until no edge of a film is longer than `1.3 edge` (metres).
    ///
    /// Edges between ghosts only stay as they are. Always taking the longest edge keeps angles above half of those at the
    /// start. Source: Rivara 1984, bisection by the longest edge.
    pub fn refine(&mut self, edge: f64) {
        self.refine_onto(edge, freely);
    }

    /// The same, with every new vertex put where `snap` says from the middle of its edge and the regions around it.
    pub fn refine_onto(&mut self, edge: f64, snap: impl Snap) {
        let limit = (1.3 * edge).powi(2);
        let mut faces_of = self.faces_of_edges();
        let mut longest: BinaryHeap<(u64, [u32; 2])> = BinaryHeap::new();
        let queue = |films: &Self, edge: [u32; 2], faces: &[u32], longest: &mut BinaryHeap<(u64, [u32; 2])>| {
            let [a, b] = edge.map(|v| films.set.positions[v as usize]);
            let length = a.distance_squared(b);
            if length > limit && faces.iter().any(|face| !films.set.ghosts[*face as usize]) {
                // The bits of positive numbers are in the order of the numbers.
                longest.push((length.to_bits(), edge));
            }
        };
        faces_of.iter().for_each(|(edge, faces)| queue(self, *edge, faces, &mut longest));
        while let Some((_, edge)) = longest.pop() {
            for edge in self.split(edge, &mut faces_of, &snap) {
                queue(self, edge, &faces_of[&edge], &mut longest);
            }
        }
    }

    /// Splits one edge in the middle, with every face that has it; gives the new vertex.
    pub fn halve(&mut self, a: u32, b: u32) -> u32 {
        let mut faces_of = self.faces_of_edges();
        self.split(sorted(a, b), &mut faces_of, &freely);
        self.set.positions.len() as u32 - 1
    }

    fn faces_of_edges(&self) -> BTreeMap<[u32; 2], Vec<u32>> {
        let mut faces_of: BTreeMap<[u32; 2], Vec<u32>> = BTreeMap::new();
        for (face, triangle) in (0..).zip(&self.set.triangles) {
            edges_of(*triangle).iter().for_each(|edge| faces_of.entry(*edge).or_default().push(face));
        }
        faces_of
    }

    /// Splits an edge in the middle, with every face that has it; gives the new edges.
    fn split(
        &mut self,
        [a, b]: [u32; 2],
        faces_of: &mut BTreeMap<[u32; 2], Vec<u32>>,
        snap: &impl Snap,
    ) -> BTreeSet<[u32; 2]> {
        let faces = faces_of.remove(&[a, b]).unwrap_or_default();
        let is_wire = self.wires.remove(&[a, b]);
        let [from, to] = [a, b].map(|v| self.set.positions[v as usize]);
        let mut regions: Regions = faces.iter().flat_map(|face| self.set.labels[*face as usize]).collect();
        regions.sort_unstable();
        regions.dedup();
        let middle = self.set.add_vertex(snap(from.midpoint(to), &regions), is_wire);
        if is_wire {
            self.add_wire(a, middle);
            self.add_wire(middle, b);
        }
        let mut new_edges = BTreeSet::new();
        for face in faces {
            let far = self.set.triangles.len() as u32;
            let (triangle, place) = (self.set.triangles[face as usize], face as usize);
            self.set.add_face(
                triangle.map(|v| if v == a { middle } else { v }),
                self.set.labels[place],
                self.set.ghosts[place],
            );
            self.set.triangles[place] = triangle.map(|v| if v == b { middle } else { v });
            for vertex in triangle.into_iter().filter(|v| *v != a && *v != b) {
                faces_of.entry(sorted(vertex, middle)).or_default().extend([face, far]);
                let moved = faces_of.entry(sorted(vertex, b)).or_default();
                moved.iter_mut().filter(|other| **other == face).for_each(|other| *other = far);
                new_edges.insert(sorted(vertex, middle));
            }
            faces_of.entry(sorted(a, middle)).or_default().push(face);
            faces_of.entry(sorted(middle, b)).or_default().push(far);
            new_edges.extend([sorted(a, middle), sorted(middle, b)]);
        }
        new_edges
    }
}

/// Row of the point `step` of `frequency` along an edge whose inner points begin at `first`.
const fn edge_row([a, b]: [u32; 2], first: u32, frequency: u32, step: u32) -> u32 {
    match step {
        0 => a,
        _ if step == frequency => b,
        _ => first + step - 1,
    }
}

fn triangle_area(positions: &[DVec3], triangle: [u32; 3]) -> f64 {
    let [a, b, c] = triangle.map(|v| positions[v as usize]);
    0.5 * (b - a).cross(c - a).length()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::invariants::check_combinatorial;
    use crate::shapes::measure::smallest_angle;
    use crate::surface::Surface;

    fn right_triangle_on_a_wire() -> WiredFilms {
        let mut films = WiredFilms::default();
        for x in [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z] {
            films.set.add_vertex(x, false);
        }
        films.set.add_film([0, 1, 2], [1, 0]);
        films.set.add_face([0, 3, 1], [1, 0], true);
        films.set.add_face([1, 3, 2], [1, 0], true);
        films.set.add_face([2, 3, 0], [1, 0], true);
        films.add_wire(1, 0);
        films
    }

    #[test]
    fn a_frequency_splits_each_triangle_into_its_square() {
        let fine = right_triangle_on_a_wire().subdivide(5, flat);
        assert_eq!(fine.set.triangles.len(), 4 * 25);
        assert_eq!(fine.set.positions.len(), 2 + 2 * 25, "Euler: V = 2 + F / 2");
        assert_eq!(fine.wires.len(), 5);
        let surface = Surface::from_triangles(&fine.set);
        assert_eq!(check_combinatorial(&surface), Ok(()));
        assert!((surface.film_area() - 0.5).abs() < 1e-14);
        assert!((surface.volumes()[1].abs() - 1.0 / 6.0).abs() < 1e-14);
    }

    #[test]
    fn only_wires_and_ghosts_are_held_after_a_subdivision() {
        let fine = right_triangle_on_a_wire().subdivide(4, flat);
        for (x, pinned) in fine.set.positions.iter().zip(&fine.set.pinned) {
            let (on_wire, in_film) = (x.y == 0.0 && x.z == 0.0, x.z == 0.0);
            let is_corner = x.max_element() == 1.0 || *x == DVec3::ZERO;
            assert!(is_corner || *pinned == (on_wire || !in_film), "{x}");
        }
    }

    #[test]
    fn halving_the_longest_edges_keeps_angles_area_and_wires() {
        let mut films = right_triangle_on_a_wire();
        films.refine(0.08);
        let surface = Surface::from_triangles(&films.set);
        assert_eq!(check_combinatorial(&surface), Ok(()));
        assert!((surface.film_area() - 0.5).abs() < 1e-13);
        assert!(smallest_angle(&films.set) > 44.0, "halves of a right isosceles triangle are similar to it");
        let held = films.set.pinned.iter().filter(|pinned| **pinned).count();
        assert_eq!(held, films.wires.len() - 1, "midpoints of one wire");
    }
}
