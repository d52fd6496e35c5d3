//! Corners of films: which of them a triangulation can widen, and which are the film's own.
//!
//! Where two junction curves leave a point, the film between them has an angle there, and so has the one face that fills it:
//!
//! ```text
//!        P              The corner of (P, a, b) at P is the film's own: (P, a) and (P, b) are junction edges, of three or
//!       / \             more films. Every other corner is the mesh's.
//!      a---b
//!     / \ / \
//! ```
//!
//! It is like an angle of the input in Delaunay refinement (Shewchuk 2002): no flip, insertion or move within the film makes it wider. It
//! must not hide the rest either: the least angle of some faces is counted for own corners and for all others apart. Edges between the
//! point and the curves can be made shorter, so that the flow widens the tip (`improve`).

use glam::DVec3;

use crate::mesh::{Face, SurfaceMesh};
use crate::policy::Policy;
use crate::rows::{FaceRow, VertexRow};
use crate::surface::Surface;

/// Least angles of some faces, radians; infinite where there are none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LeastAngles {
    /// Of corners between two junction edges.
    pub own: f64,
    /// Of all others.
    pub rest: f64,
}

impl LeastAngles {
    /// Of no face.
    pub const NONE: Self = Self { own: f64::INFINITY, rest: f64::INFINITY };

    /// The smaller of each.
    #[must_use]
    pub fn min(self, other: Self) -> Self {
        Self { own: self.own.min(other.own), rest: self.rest.min(other.rest) }
    }

    /// With one more face of a surface.
    #[must_use]
    pub fn with_face_of(self, surface: &Surface, row: FaceRow) -> Self {
        let face = surface.mesh.face(row);
        self.with(&face, surface.corners(row), |v| is_own(&surface.mesh, &face, v))
    }

    /// With one more face; `is_own` tells of a corner whether it is the film's own, and is asked where that may matter.
    #[must_use]
    pub(crate) fn with(self, face: &Face, corners: [DVec3; 3], is_own: impl Fn(VertexRow) -> bool) -> Self {
        let mut least = self;
        for (vertex, angle) in face.vertices().into_iter().zip(angles(corners)) {
            // Angles above the good one are as good as each other where an own corner is the least.
            match angle < Policy::GOOD_ANGLE && is_own(vertex) {
                true => least.own = least.own.min(angle),
                false => least.rest = least.rest.min(angle),
            }
        }
        least
    }
}

/// Whether the corner of a face at a vertex is the film's own: both its edges there are junctions, with any number of faces but two.
#[must_use]
pub fn is_own(mesh: &SurfaceMesh, face: &Face, vertex: VertexRow) -> bool {
    face.around(vertex).iter().all(|end| mesh.faces_of_edge(vertex, *end).len() != 2)
}

/// Whether a triangle has an angle below an acute one, whose squared tangent this is: without taking angles.
#[must_use]
pub(crate) fn has_angle_below([a, b, c]: [DVec3; 3], tangent_square: f64) -> bool {
    let double = (b - a).cross(c - a).length_squared();
    [(a, b, c), (b, c, a), (c, a, b)].into_iter().any(|(at, p, q)| {
        let along = (p - at).dot(q - at);
        along > 0.0 && double < tangent_square * along * along
    })
}

/// Angles of a triangle at its corners, radians.
#[must_use]
pub fn angles([a, b, c]: [DVec3; 3]) -> [f64; 3] {
    let angle = |at: DVec3, p: DVec3, q: DVec3| (p - at).cross(q - at).length().atan2((p - at).dot(q - at));
    [angle(a, b, c), angle(b, c, a), angle(c, a, b)]
}
