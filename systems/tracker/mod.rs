//! Films as a mesh in the ECS: vertices are rows, connectivity is the resource [`SurfaceMesh`], and the tracker of
//! [`froth_surface`] keeps it fine, even and free of intersections.
//!
//! | stage | system | file |
//! |---|---|---|
//! | `Topology` | burst films that are due | `bursting` |
//! | `Topology` | join, split, collapse, separate | `remeshing` |
//! | `Observe` | counts, quality, events | `observe` |
//!
//! What a method's own columns become where vertices are split and joined follows from their
//! [`Nature`](crate::rows::registry::Nature); the columns of a user are carried along like the built-in ones.

pub mod bursting;
pub mod columns;
pub mod discretise;
pub mod events;
pub mod films;
pub mod observe;
pub mod remeshing;
pub mod wire_edges;
pub mod wire_piercing;
pub mod wires;

pub use froth_surface::{Policy, SurfaceMesh};
