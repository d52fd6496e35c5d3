//! Films as a mesh in the ECS: vertices are rows, connectivity is the resource [`SurfaceMesh`], and the tracker of
//! [`froth_surface`] keeps it fine, even and free of intersections.
//!
//! | stage | system | file |
//! |---|---|---|
//! | `Topology` | burst films that are due | `bursting` |
//! | `Topology` | join, split, collapse, separate | `remeshing` |
//! | `Geometry` | areas, normals, curvature, thickness | `shape` |
//! | `Observe` | counts, quality, events | `observe` |
//!
//! What a method's own columns become where vertices are split and joined follows from their
//! [`Nature`](crate::rows::registry::Nature); the columns of a user are carried along like the built-in ones. Data that is no column,
//! such as one number per vertex and region, is registered as a [follower](followers).

pub mod bursting;
pub mod columns;
pub mod discretise;
pub mod events;
pub mod feeding;
pub mod films;
pub mod followers;
pub mod observe;
pub mod remeshing;
pub mod shape;
pub mod tension;
pub mod wire_edges;
pub mod wire_piercing;
pub mod wires;

pub use froth_surface::{Policy, SurfaceMesh};
