//! Finds the single films of a mesh, their smooth normals, and the lines where they end.
//!
//! ```text
//!        film 0  \     / film 1       An edge is SMOOTH if exactly two triangles share it and both lie between the same
//!                 \   /               two regions. Films are sets of triangles joined by smooth edges.
//!                  \ /                Every other edge is a LINE: a Plateau border where three films meet, the free rim of
//!                   o  border         a film, or a wire where both ends are pinned.
//!                   |
//!                   | film 2          A vertex on a line has one normal per film: normals belong to corners.
//! ```
//!
//! Equation: around an inner vertex the normal is `Σ eᵢ × eᵢ₊₁ / (|eᵢ|² |eᵢ₊₁|²)` over its triangles, exact for vertices on
//! a sphere. Where a film ends that sum would lean to the film's inside. There, the normals `n` at the inner neighbours,
//! at the other end of an edge `e`, are mirrored, `n - 2 (n·ê) ê`, and averaged: again exact on a sphere, whose arcs meet
//! a chord at equal angles. Source of the weights: Max 1999.
//! Limits: the mirrored normals know the curvature along the edge, not the twist of the film.

use super::triangles::FilmTriangles;
use glam::DVec3;

/// What runs along an edge where films end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum LineKind {
    /// A channel of liquid.
    Border,
    /// A wire that holds films.
    Wire,
}

/// An edge where films end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Line {
    pub ends: [u32; 2],
    pub kind: LineKind,
}

/// What the edges of a mesh tell.
#[derive(Clone, Debug)]
pub(super) struct FilmNetwork {
    /// Per triangle: unit normal at each corner, from the region with the larger number to the other.
    pub normals: Vec<[DVec3; 3]>,
    /// Per triangle: number of the film that it is part of, from 0 in order of first triangles.
    pub films: Vec<u32>,
    /// Edges where films end, ascending.
    pub lines: Vec<Line>,
}

/// Smooth normals of films: per triangle, a unit normal at each of its corners.
///
/// Normals are smooth within a film and differ between the films that meet on a line. They point from the region with the
/// larger number to the one with the smaller: outwards on a bubble. The input must pass [`FilmTriangles::check`].
#[must_use]
pub fn film_normals(mesh: &FilmTriangles) -> Vec<[DVec3; 3]> {
    FilmNetwork::new(mesh).normals
}

impl FilmNetwork {
    /// Looks at every edge of a mesh that passes [`FilmTriangles::check`].
    pub(super) fn new(mesh: &FilmTriangles) -> Self {
        let sides = sorted_sides(mesh);
        let mut triangles = Groups::new(mesh.triangles.len());
        let mut corners = Groups::new(3 * mesh.triangles.len());
        let mut lines = Vec::new();
        let edges = || sides.chunk_by(|a, b| a.ends == b.ends);
        for edge in edges() {
            if let Some([one, other]) = smooth(mesh, edge) {
                triangles.join(one.triangle, other.triangle);
                (0..2).for_each(|end| corners.join(one.corners[end], other.corners[end]));
            }
            lines.extend(line(mesh, edge));
        }
        let mut is_open = vec![false; 3 * mesh.triangles.len()];
        for side in edges().filter(|edge| smooth(mesh, edge).is_none()).flatten() {
            side.corners.iter().for_each(|&corner| is_open[corners.first(corner) as usize] = true);
        }
        Self { normals: corner_normals(mesh, &mut corners, &is_open), films: triangles.numbered(), lines }
    }
}

/// One triangle's side of an edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Side {
    /// Vertices of the edge, ascending.
    ends: [u32; 2],
    triangle: u32,
    /// The triangle's corners there, `3 triangle + 0, 1 or 2`.
    corners: [u32; 2],
}

fn sorted_sides(mesh: &FilmTriangles) -> Vec<Side> {
    let mut sides: Vec<Side> = (0_u32..)
        .zip(mesh.triangles)
        .flat_map(|(triangle, vertices)| {
            [(0, 1), (1, 2), (2, 0)].map(|(i, j)| {
                let (i, j) = if vertices[i] <= vertices[j] { (i, j) } else { (j, i) };
                let corners = [i, j].map(|corner| 3 * triangle + corner as u32);
                Side { ends: [vertices[i], vertices[j]], triangle, corners }
            })
        })
        .collect();
    sides.sort_unstable();
    sides
}

/// The two sides of an edge across which a film goes on.
fn smooth(mesh: &FilmTriangles, edge: &[Side]) -> Option<[Side; 2]> {
    let &[one, other] = edge else { return None };
    (regions(mesh, one.triangle) == regions(mesh, other.triangle)).then_some([one, other])
}

/// The regions on the two sides of a triangle, ascending.
fn regions(mesh: &FilmTriangles, triangle: u32) -> [u32; 2] {
    let [back, front] = mesh.labels[triangle as usize];
    [back.min(front), back.max(front)]
}

/// What runs along an edge.
///
/// A wire may hold a film in its middle. Then the film is smooth there and both ends are pinned, but so they are where a
/// corner of the wire is cut off by one triangle; that triangle has no corner that is free.
fn line(mesh: &FilmTriangles, edge: &[Side]) -> Option<Line> {
    let ends = edge[0].ends;
    let is_held = |side: &Side| mesh.triangles[side.triangle as usize].iter().all(|&vertex| mesh.is_pinned(vertex));
    let is_smooth = smooth(mesh, edge).is_some();
    match ends.iter().all(|&end| mesh.is_pinned(end)) {
        true if is_smooth && edge.iter().any(is_held) => None,
        true => Some(Line { ends, kind: LineKind::Wire }),
        false if is_smooth => None,
        false => Some(Line { ends, kind: LineKind::Border }),
    }
}

/// The normal at every corner; corners of one group share theirs, and open groups lie where a film ends.
fn corner_normals(mesh: &FilmTriangles, corners: &mut Groups, is_open: &[bool]) -> Vec<[DVec3; 3]> {
    let groups: Vec<usize> = (0..is_open.len()).map(|corner| corners.first(corner as u32) as usize).collect();
    let mut sums = vec![DVec3::ZERO; groups.len()];
    for corner in 0..groups.len() {
        sums[groups[corner]] += weighted_normal(mesh, corner);
    }
    let mut mirrored = vec![DVec3::ZERO; groups.len()];
    for (corner, &group) in groups.iter().enumerate().filter(|(_, group)| is_open[**group]) {
        let place = corner_place(mesh, corner);
        for inner in others(corner).into_iter().filter(|&other| !is_open[groups[other]]) {
            let along = (corner_place(mesh, inner) - place).normalize_or_zero();
            let normal = sums[groups[inner]].normalize_or_zero();
            mirrored[group] += normal - 2.0 * normal.dot(along) * along;
        }
    }
    let normal = |corner: usize| {
        let group = groups[corner];
        let known = if mirrored[group] == DVec3::ZERO { sums[group] } else { mirrored[group] };
        known.try_normalize().or_else(|| weighted_normal(mesh, corner).try_normalize()).unwrap_or(DVec3::Z)
    };
    (0..mesh.triangles.len()).map(|triangle| [0, 1, 2].map(|k| normal(3 * triangle + k))).collect()
}

/// The two other corners of a corner's triangle, in its winding.
fn others(corner: usize) -> [usize; 2] {
    let (triangle, k) = (corner / 3, corner % 3);
    [1, 2].map(|step| 3 * triangle + (k + step) % 3)
}

fn corner_place(mesh: &FilmTriangles, corner: usize) -> DVec3 {
    mesh.positions[mesh.triangles[corner / 3][corner % 3] as usize]
}

/// What a triangle adds to the normal at one of its corners; zero for one without area.
fn weighted_normal(mesh: &FilmTriangles, corner: usize) -> DVec3 {
    let [b, c] = others(corner).map(|other| corner_place(mesh, other) - corner_place(mesh, corner));
    let [back, front] = mesh.labels[corner / 3];
    let side = if back >= front { 1.0 } else { -1.0 };
    let normal = side * b.cross(c) / (b.length_squared() * c.length_squared());
    if normal.is_finite() { normal } else { DVec3::ZERO }
}

/// Disjoint groups of rows, each known by its first row.
struct Groups {
    parents: Vec<u32>,
}

impl Groups {
    fn new(rows: usize) -> Self {
        Self { parents: (0..rows as u32).collect() }
    }

    /// First row of the group that a row is in.
    fn first(&mut self, mut row: u32) -> u32 {
        while self.parents[row as usize] != row {
            let above = self.parents[self.parents[row as usize] as usize];
            self.parents[row as usize] = above;
            row = above;
        }
        row
    }

    fn join(&mut self, one: u32, other: u32) {
        let (one, other) = (self.first(one), self.first(other));
        self.parents[one.max(other) as usize] = one.min(other);
    }

    /// Per row, the number of its group, counted in the order of first rows.
    fn numbered(&mut self) -> Vec<u32> {
        let mut numbers = vec![0; self.parents.len()];
        let mut count = 0;
        for row in 0..self.parents.len() {
            let first = self.first(row as u32) as usize;
            numbers[row] = if first == row { count } else { numbers[first] };
            count += u32::from(first == row);
        }
        numbers
    }
}

#[cfg(test)]
mod tests {
    use super::{FilmNetwork, Line, LineKind, film_normals};
    use crate::picture::test_meshes::{Mesh, double_bubble, grid, sphere};
    use glam::DVec3;

    fn worst_angle(mesh: &Mesh, exact: impl Fn(usize, DVec3) -> DVec3) -> f64 {
        let film = mesh.film();
        let corners = film_normals(&film).into_iter().zip(film.triangles).enumerate();
        corners
            .flat_map(|(row, (normals, triangle))| (0..3).map(move |k| (row, normals[k], triangle[k])))
            .map(|(row, normal, vertex)| normal.distance(exact(row, film.positions[vertex as usize])))
            .fold(0.0, f64::max)
    }

    #[test]
    fn the_normals_of_a_sphere_are_exact_and_point_outwards_whatever_the_winding() {
        let mut mesh = sphere(2);
        for row in (0..mesh.triangles.len()).step_by(3) {
            mesh.triangles[row].swap(0, 1);
            mesh.labels[row].swap(0, 1);
        }
        assert!(worst_angle(&mesh, |_, place| place.normalize()) < 1e-12);
        let network = FilmNetwork::new(&mesh.film());
        assert!(network.lines.is_empty() && network.films.iter().all(|&film| film == 0));
    }

    #[test]
    fn three_films_of_a_double_bubble_keep_their_own_normals_on_their_common_border() {
        let mesh = double_bubble(24);
        let exact = |row: usize, place: DVec3| match mesh.labels[row] {
            [1, 0] => (place - DVec3::new(-0.5, 0.0, 0.0)).normalize(),
            [2, 0] => (place - DVec3::new(0.5, 0.0, 0.0)).normalize(),
            _ => DVec3::NEG_X,
        };
        assert!(worst_angle(&mesh, exact) < 1e-9, "{}", worst_angle(&mesh, exact));
        let network = FilmNetwork::new(&mesh.film());
        assert_eq!(network.films.iter().max(), Some(&2));
        assert_eq!(network.lines.len(), 24);
        assert!(network.lines.iter().all(|line| line.kind == LineKind::Border));
    }

    #[test]
    fn the_rim_of_a_film_on_pinned_vertices_is_a_wire_and_corners_that_triangles_cut_off_are_not() {
        let mut mesh = grid(4);
        mesh.pinned = mesh.positions.iter().map(|p| p.x.abs().max(p.y.abs()) > 0.99).collect();
        let lines = FilmNetwork::new(&mesh.film()).lines;
        assert!(lines.len() == 16 && lines.iter().all(|line| line.kind == LineKind::Wire));
        mesh.pinned.clear();
        let free = FilmNetwork::new(&mesh.film()).lines;
        assert_eq!(free, lines.iter().map(|line| Line { kind: LineKind::Border, ..*line }).collect::<Vec<_>>());
    }

    #[test]
    fn a_wire_in_the_middle_of_a_film_is_seen() {
        let mut mesh = grid(4);
        mesh.pinned = mesh.positions.iter().map(|p| p.x.abs() < 1e-9).collect();
        let wires = FilmNetwork::new(&mesh.film()).lines.into_iter().filter(|line| line.kind == LineKind::Wire);
        assert_eq!(wires.count(), 4);
    }

    #[test]
    fn triangles_without_area_do_no_harm() {
        let mut mesh = sphere(1);
        mesh.triangles.push([0, 0, 5]);
        mesh.labels.push([1, 0]);
        mesh.triangles.push([3, 3, 3]);
        mesh.labels.push([1, 0]);
        assert!(film_normals(&mesh.film()).iter().flatten().all(|normal| normal.is_normalized()));
    }
}
