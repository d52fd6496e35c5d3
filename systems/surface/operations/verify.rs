//! What an operation could have broken, looked at where it was: the checks of [`crate::invariants`] around a few vertices.

use smallvec::SmallVec;

use super::Session;
use crate::grid::Aabb;
use crate::invariants::{Violation, check_combinatorial_around};
use crate::kernel::crossing::triangles_cross;
use crate::rows::{FaceRow, VertexRow};

impl Session<'_> {
    /// Faces and edges of a few vertices, their sectors, and whether their faces cross any other.
    ///
    /// # Errors
    /// The first [`Violation`], in the order of `vertices`.
    pub fn check_around(&mut self, vertices: &[VertexRow]) -> Result<(), Violation> {
        check_combinatorial_around(self.surface, vertices)?;
        for vertex in vertices.iter().copied().filter(|v| self.surface.mesh.has_vertex(*v)) {
            if !self.surface.positions[vertex].is_finite() {
                return Err(Violation::NotFinite { vertex });
            }
            if self.sectors(vertex).is_tangled() {
                return Err(Violation::Tangled { vertex });
            }
        }
        let mut faces: Vec<FaceRow> = vertices.iter().flat_map(|v| self.surface.mesh.faces_of(*v)).copied().collect();
        faces.sort_unstable();
        faces.dedup();
        match faces.into_iter().find_map(|row| Some((row, self.crossed_by(row)?))) {
            Some((first, second)) => Err(Violation::Crossing { first, second }),
            None => Ok(()),
        }
    }

    /// A face that a film crosses.
    fn crossed_by(&mut self, row: FaceRow) -> Option<FaceRow> {
        let (face, corners) = (self.surface.mesh.face(row), self.surface.corners(row));
        if face.is_ghost() {
            return None;
        }
        let found: SmallVec<[FaceRow; 64]> = SmallVec::from_slice(self.near(Aabb::of(&corners)));
        found.into_iter().filter(|other| *other != row).find(|other| {
            let vertices = self.surface.mesh.face(*other).vertices();
            triangles_cross(face.vertices(), corners, vertices, self.surface.corners(*other))
        })
    }
}
