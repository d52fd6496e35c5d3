//! Who is near whom: cell lists, compressed rows of neighbours, kernels.
//!
//! All-neighbours lists come from a [`cells::CellList`]; single nearest-point questions from kiddo, see
//! [`nearest`]. `cargo bench --bench neighbours` compares the two.

pub mod cells;
pub mod kernel;
pub mod lists;
pub mod nearest;
