//! Refinement of narrow films: grading towards the place where a film is about to close, or has a tip.
//!
//! A film between two junction curves that come near each other has room for thin faces only, as long as the junction edges are longer than
//! the film is wide. And where two curves leave a point, the corner of the one face between them is the film's own
//! ([`corners`](crate::corners)): no other triangulation widens it. But tension does: at a point curves part at 109 degrees, and what
//! looks like a narrow tip is one that edges are too long to show. So both get shorter junction edges:
//!
//! ```text
//!        P                      P
//!       / \                    /_\             The tip's junction edges are halved; the point is pulled in, and the
//!      /   \         ->       m   n             corner widens within a few steps.
//!     /     \                / \ / \
//!    a-------b              a---+---b
//! ```
//!
//! Such edges are not collapsed again for being short until the film is wider there; below 0.2 `L` they are, as all are.
//! Discretisation: halves are longer than 0.22 `L`. A split that would leave an angle below 12 degrees is put off.
//! Limits: a film lower than about 0.1 `L` is not resolved: it closes.

use smallvec::SmallVec;

use super::Session;
use super::collapse::{Rank, rank};
use crate::corners::{angles, is_own};
use crate::mesh::Face;
use crate::policy::Policy;
use crate::rows::VertexRow;

/// Least angle that a split may leave for the sweeps after it to mend, radians: 12 degrees.
const LEAST_LEFT: f64 = 12.0 / 180.0 * std::f64::consts::PI;

/// Where an edge is divided: off its middle. Exact halves make vertices that lie on the line or in the plane of a face beside them. A collapse
/// onto them leaves a face without area, of which rounding decides where it looks (`turns_over`, `tangles`), and a snap along such a
/// plane is blocked or not by rounding.
const PART: f64 = 0.48;

impl Session<'_> {
    /// Halves junction edges of films that are narrow beside them; gives the number of splits.
    pub(super) fn refine_narrow_films(&mut self) -> usize {
        let thin = self.films_with_angle_below(Policy::GOOD_ANGLE);
        let sides = thin.into_iter().flat_map(|row| self.narrow_sides(&self.surface.mesh.face(row)));
        let mut sides: Vec<[VertexRow; 2]> = sides.collect();
        let mut refined = 0;
        sides.sort_unstable();
        sides.dedup();
        for side in sides {
            if !self.surface.mesh.has_edge(side[0], side[1]) {
                continue;
            }
            if let Some(plan) = self.plan_division(side, PART)
                && self.least_angles_after(&plan).rest > LEAST_LEFT
            {
                refined += usize::from(self.commit_split(&plan).is_some());
            }
        }
        refined
    }

    /// Junction edges of a thin face that are too long for its film: the sides of a narrow corner that is the film's own, and the longest
    /// edge of a face from curve to curve. Ends ascending.
    fn narrow_sides(&self, face: &Face) -> SmallVec<[[VertexRow; 2]; 3]> {
        let mesh = &self.surface.mesh;
        let angles = angles(face.vertices().map(|v| self.surface.positions[v]));
        let mut sides = SmallVec::new();
        if angles.iter().all(|angle| *angle >= Policy::GOOD_ANGLE) {
            return sides;
        }
        let sorted = |[a, b]: [VertexRow; 2]| [a.min(b), a.max(b)];
        for (v, angle) in face.vertices().into_iter().zip(angles) {
            if angle < Policy::GOOD_ANGLE && is_own(mesh, face, v) {
                sides.extend(face.around(v).map(|end| sorted([v, end])));
            }
        }
        let widest = (0..3).fold(0, |i, j| if angles[j] > angles[i] { j } else { i });
        let longest = sorted(face.around(face.vertices()[widest]));
        if face.vertices().into_iter().all(|v| rank(self.surface, v) != Rank::Film)
            && mesh.faces_of_edge(longest[0], longest[1]).len() != 2
        {
            sides.push(longest);
        }
        sides
    }

    /// Whether an edge is a junction with a narrow film, as [`Self::narrow_sides`] has it.
    pub(super) fn borders_narrow_film(&self, a: VertexRow, b: VertexRow) -> bool {
        let rows = self.surface.mesh.faces_of_edge(a, b);
        rows.len() != 2
            && rows.iter().any(|row| self.narrow_sides(&self.surface.mesh.face(*row)).contains(&[a.min(b), a.max(b)]))
    }
}
