//! Plateau borders: edges where three films meet, and the vertices where such curves meet.

use std::collections::BTreeMap;

use glam::DVec3;
use smallvec::SmallVec;

use crate::rows::{FaceRow, VertexRow};
use crate::surface::Surface;

/// The curves along which three films meet.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Borders {
    /// Per vertex on a border, its neighbours along borders, ascending.
    around: BTreeMap<VertexRow, SmallVec<[VertexRow; 4]>>,
    /// Edges of more than three films, ascending: they occur in the middle of topology changes only.
    pub crowded: Vec<[VertexRow; 2]>,
}

impl Borders {
    /// Finds the borders of a surface; ghosts are no films.
    #[must_use]
    pub fn new(surface: &Surface) -> Self {
        let mut borders = Self::default();
        for [a, b] in surface.mesh.edges() {
            let faces = surface.mesh.faces_of_edge(a, b);
            match faces.iter().filter(|face| !surface.mesh.face(**face).is_ghost()).count() {
                3 => {
                    borders.around.entry(a).or_default().push(b);
                    borders.around.entry(b).or_default().push(a);
                }
                4.. => borders.crowded.push([a, b]),
                _ => {}
            }
        }
        borders.around.values_mut().for_each(|list| list.sort_unstable());
        borders
    }

    /// Neighbours of a vertex along borders; none if it lies on no border.
    #[must_use]
    pub fn neighbours(&self, vertex: VertexRow) -> &[VertexRow] {
        self.around.get(&vertex).map_or(&[], |list| list)
    }

    /// Vertices on borders, ascending.
    pub fn vertices(&self) -> impl Iterator<Item = VertexRow> + '_ {
        self.around.keys().copied()
    }

    /// Vertices where four borders meet, ascending.
    pub fn quadruple_points(&self) -> impl Iterator<Item = VertexRow> + '_ {
        self.around.iter().filter(|(_, list)| list.len() == 4).map(|(vertex, _)| *vertex)
    }

    /// Whether an edge is a border.
    #[must_use]
    pub fn has_edge(&self, a: VertexRow, b: VertexRow) -> bool {
        self.neighbours(a).contains(&b)
    }

    /// Length of all borders, m.
    #[must_use]
    pub fn length(&self, surface: &Surface) -> f64 {
        let length = |a: VertexRow, b: VertexRow| surface.positions[a].distance(surface.positions[b]);
        self.around.iter().map(|(a, list)| 0.5 * list.iter().map(|b| length(*a, *b)).sum::<f64>()).sum()
    }

    /// Films of a vertex in groups that do not cross a border: one per sheet, each in ascending order.
    #[must_use]
    pub fn sheets_of(&self, surface: &Surface, vertex: VertexRow) -> Vec<Vec<FaceRow>> {
        let mut left: Vec<FaceRow> = films_of(surface, vertex).collect();
        let mut sheets = Vec::new();
        while let Some(first) = left.first().copied() {
            let mut sheet = self.grown(surface, vec![first], |face| surface.mesh.face(face).has(vertex));
            sheet.sort_unstable();
            left.retain(|face| !sheet.contains(face));
            sheets.push(sheet);
        }
        sheets
    }

    /// The faces and those around their vertices that are reached without crossing a border.
    #[must_use]
    pub fn with_next_ring(&self, surface: &Surface, sheet: &[FaceRow]) -> Vec<FaceRow> {
        let ring: Vec<VertexRow> = sheet.iter().flat_map(|face| surface.mesh.face(*face).vertices()).collect();
        self.grown(surface, sheet.to_vec(), |face| surface.mesh.face(face).vertices().iter().any(|v| ring.contains(v)))
    }

    /// The faces, and those with a corner within `reach` metres of a place that are reached from them without crossing a border or leaving
    /// that distance.
    #[must_use]
    pub fn within(&self, surface: &Surface, sheet: &[FaceRow], place: DVec3, reach: f64) -> Vec<FaceRow> {
        let is_near = |face: FaceRow| surface.corners(face).iter().any(|x| x.distance(place) < reach);
        self.grown(surface, sheet.to_vec(), is_near)
    }

    /// Grows a set of faces over edges of two films, as long as `accepts` holds.
    fn grown(&self, surface: &Surface, mut set: Vec<FaceRow>, accepts: impl Fn(FaceRow) -> bool) -> Vec<FaceRow> {
        let mut next = 0;
        while next < set.len() {
            let [a, b, c] = surface.mesh.face(set[next]).vertices();
            next += 1;
            for (a, b) in [(a, b), (b, c), (c, a)].into_iter().filter(|(a, b)| !self.has_edge(*a, *b)) {
                for face in surface.mesh.faces_of_edge(a, b) {
                    if !surface.mesh.face(face).is_ghost() && !set.contains(&face) && accepts(face) {
                        set.push(face);
                    }
                }
            }
        }
        set
    }
}

fn films_of(surface: &Surface, vertex: VertexRow) -> impl Iterator<Item = FaceRow> + '_ {
    surface.mesh.faces_of(vertex).iter().copied().filter(|face| !surface.mesh.face(*face).is_ghost())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::calculus::test_shapes::double_bubble;

    #[test]
    fn a_double_bubble_has_one_ring_of_three_sheets() {
        let surface = double_bubble(1.0, 0.7, 4);
        let borders = Borders::new(&surface);
        assert_eq!(borders.vertices().count(), 24);
        assert_eq!(borders.quadruple_points().count(), 0);
        assert!(borders.crowded.is_empty());
        for vertex in borders.vertices() {
            assert_eq!(borders.neighbours(vertex).len(), 2);
            assert_eq!(borders.sheets_of(&surface, vertex).len(), 3);
        }
    }
}
