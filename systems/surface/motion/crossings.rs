//! Finds all pairs of faces that cross, exactly.

use crate::grid::{Aabb, BoxGrid};
use crate::kernel::crossing::triangles_cross;
use crate::rows::FaceRow;
use crate::surface::Surface;

/// All pairs of faces that cross (see [`triangles_cross`]), the lower row first, ascending; ghosts count only `with_ghosts`.
#[must_use]
pub fn find_crossings(surface: &Surface, with_ghosts: bool) -> Vec<(FaceRow, FaceRow)> {
    let faces = surface.mesh.faces().filter(|(_, face)| with_ghosts || !face.is_ghost());
    let rows: Vec<FaceRow> = faces.map(|(row, _)| row).collect();
    let grid = BoxGrid::fitted(rows.iter().map(|row| Aabb::of(&surface.corners(*row))).collect());
    let mut crossings = grid.pairs(|a, b| {
        let (a, b) = (rows[a as usize], rows[b as usize]);
        let vertices = |row: FaceRow| surface.mesh.face(row).vertices();
        let is_crossing = triangles_cross(vertices(a), surface.corners(a), vertices(b), surface.corners(b));
        is_crossing.then_some((a, b))
    });
    crossings.sort_unstable();
    crossings
}
