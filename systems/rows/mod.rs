//! Particles as rows of contiguous columns.
//!
//! All entities of a kind live in one table, so a column is a slice and a particle is a row number. Rows stay sorted
//! by (region, Morton code); entity ids belong to rows, [`StableId`](froth_components::identity::StableId) to
//! particles.

mod access;
pub mod morton;
pub mod reduce;
pub mod registry;
pub mod state;

pub use access::{columns, columns_mut, fill_column, read_column, spawn_rows};
