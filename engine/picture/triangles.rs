//! Films as meshes see them: triangles between regions, any number of them on an edge.
//!
//! What is drawn of them besides the triangles, smooth normals and lines, is found in [`film_network`](super::film_network).

use super::error::PictureError;
use glam::DVec3;

/// Triangles of films, with the regions on their two sides. Triangles that are no film (ghosts) are left out.
#[derive(Clone, Copy, Debug)]
pub struct FilmTriangles<'a> {
    /// Place of each vertex, metres. Rows that no triangle names are ignored.
    pub positions: &'a [DVec3],
    /// Thickness at each vertex, metres; or any quantity for a colour map.
    pub values: &'a [f64],
    /// Vertices of each triangle, as rows of `positions`.
    pub triangles: &'a [[u32; 3]],
    /// Per triangle: the regions behind and before it; its right-hand normal points from back to front.
    pub labels: &'a [[u32; 2]],
    /// Per vertex: whether a wire holds it. Empty if there are no wires.
    pub pinned: &'a [bool],
}

impl FilmTriangles<'_> {
    /// Refuses ragged or non-finite input. No triangles at all are fine: all films may have burst.
    ///
    /// # Errors
    /// [`PictureError`] that names the column and row at fault.
    pub fn check(&self) -> Result<(), PictureError> {
        let points = self.positions.len();
        let pinned = if self.pinned.is_empty() { points } else { self.pinned.len() };
        for (column, found) in [("values", self.values.len()), ("marks of pinned vertices", pinned)] {
            if found != points {
                return Err(PictureError::ColumnLength { column, points, found });
            }
        }
        if self.labels.len() != self.triangles.len() {
            let (triangles, found) = (self.triangles.len(), self.labels.len());
            return Err(PictureError::TriangleLabels { triangles, found });
        }
        self.triangles.iter().enumerate().try_for_each(|(row, triangle)| self.check_corners(row, triangle))
    }

    fn check_corners(&self, triangle: usize, corners: &[u32; 3]) -> Result<(), PictureError> {
        for &vertex in corners {
            let row = vertex as usize;
            let vertices = self.positions.len();
            let place = self.positions.get(row).ok_or(PictureError::TriangleVertex { triangle, vertex, vertices })?;
            for (column, value) in [("position", place.element_sum()), ("value", self.values[row])] {
                if !value.is_finite() {
                    return Err(PictureError::NotFinite { column, row, value });
                }
            }
        }
        Ok(())
    }

    /// Rows of the corners of all triangles.
    fn corners(&self) -> impl Iterator<Item = usize> {
        self.triangles.iter().flatten().map(|&vertex| vertex as usize)
    }

    /// Smallest and largest value on a film.
    #[must_use]
    pub fn value_range(&self) -> (f64, f64) {
        let start = (f64::INFINITY, f64::NEG_INFINITY);
        self.corners().map(|row| self.values[row]).fold(start, |(low, high), value| (low.min(value), high.max(value)))
    }

    /// Places of the corners of all triangles, metres.
    pub(super) fn places(&self) -> Vec<DVec3> {
        self.corners().map(|row| self.positions[row]).collect()
    }

    /// Whether a wire holds the vertex.
    pub(super) fn is_pinned(&self, vertex: u32) -> bool {
        self.pinned.get(vertex as usize).copied().unwrap_or(false)
    }
}

#[cfg(test)]
mod tests {
    use super::FilmTriangles;
    use crate::picture::error::PictureError;
    use glam::DVec3;

    const CORNERS: [DVec3; 3] = [DVec3::ZERO, DVec3::X, DVec3::Y];

    fn one_triangle<'a>(triangle: &'a [[u32; 3]], values: &'a [f64]) -> FilmTriangles<'a> {
        FilmTriangles { positions: &CORNERS, values, triangles: triangle, labels: &[[1, 0]], pinned: &[] }
    }

    #[test]
    fn a_corner_beyond_the_vertices_is_named() {
        let error = one_triangle(&[[0, 1, 3]], &[1.0; 3]).check();
        assert!(matches!(error, Err(PictureError::TriangleVertex { triangle: 0, vertex: 3, vertices: 3 })));
    }

    #[test]
    fn a_value_that_is_not_a_number_is_named_by_its_row() {
        let error = one_triangle(&[[0, 1, 2]], &[1.0, 2.0, f64::NAN]).check();
        assert!(matches!(error, Err(PictureError::NotFinite { column: "value", row: 2, .. })));
    }

    #[test]
    fn ragged_columns_are_refused() {
        let short = one_triangle(&[[0, 1, 2]], &[1.0; 2]).check();
        assert!(matches!(short, Err(PictureError::ColumnLength { column: "values", points: 3, found: 2 })));
        let unlabelled = FilmTriangles { labels: &[], ..one_triangle(&[[0, 1, 2]], &[1.0; 3]) }.check();
        assert!(matches!(unlabelled, Err(PictureError::TriangleLabels { triangles: 1, found: 0 })));
    }
}
