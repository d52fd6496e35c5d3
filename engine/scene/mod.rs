//! Scene files.

mod header;

pub use header::SceneHeader;
