//! A non-manifold multi-region surface tracker: films between gas regions that split, merge, pinch and burst, and never intersect.
//!
//! | question | module |
//! |---|---|
//! | what is a film, what is a region | [`rows`], [`mesh`], [`surface`] |
//! | what can films be at the start | [`shapes`], [`files`] |
//! | which angles are the film's own | [`corners`] |
//! | what must hold | [`invariants`], [`fault`] |
//! | what is near, what crosses, when do two things meet | [`kernel`], [`grid`] |
//! | what meets at a vertex, what hangs together | [`sectors`], [`bodies`], [`links`] |
//! | how does the mesh change | [`operations`], [`remesh`], [`policy`], [`event`] |
//! | what becomes of data on vertices | [`transfer`] |
//! | how does it move | [`motion`], [`calculus`], [`flow`] |

pub mod bodies;
pub mod calculus;
pub mod corners;
pub mod event;
pub mod fault;
pub mod files;
pub mod flow;
pub mod grid;
pub mod invariants;
pub mod kernel;
pub mod links;
pub mod mesh;
pub mod motion;
pub mod operations;
pub mod policy;
pub mod remesh;
pub mod rows;
pub mod sectors;
pub mod shapes;
pub mod smoothing;
pub mod surface;
pub mod transfer;

pub use event::{Event, EventKind};
pub use mesh::{Face, Remap, SurfaceMesh};
pub use policy::{Contact, Placement, Policy};
pub use remesh::{Remeshed, Tracker};
pub use rows::{FaceRow, PerVertex, Region, VertexRow};
pub use surface::{LabelledTriangles, Surface};
