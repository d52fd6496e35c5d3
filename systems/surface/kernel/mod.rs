//! Geometry of points, segments and triangles, without a mesh: distances, exact predicates, times of impact.
//!
//! * [`closest`]: closest points, in rounded arithmetic, for input of any shape.
//! * [`orientation`]: on which side of a plane a point lies, exactly.
//! * [`crossing`]: whether triangles cross, exactly; touching is not crossing.
//! * [`collision`]: when moving points and edges come near triangles and edges, on the safe side.

pub mod closest;
pub mod collision;
pub mod crossing;
pub mod orientation;
