//! What can be wrong with a picture, and what to do about it.

use thiserror::Error;

/// Why no picture was drawn.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum PictureError {
    /// There is nothing to draw.
    #[error("the film has no points: a picture needs at least one particle")]
    NoPoints,
    /// Two columns that belong together differ in length.
    #[error("{points} points but {found} {column}: every point needs one of each")]
    ColumnLength {
        /// The column: `normals` or `values`.
        column: &'static str,
        /// Number of points.
        points: usize,
        /// Number of rows in the column.
        found: usize,
    },
    /// A point holds a value that is not finite.
    #[error("point {row} has {column} {value}, which is not finite: the simulation went wrong before the picture")]
    NotFinite {
        /// The column: `position`, `normal` or `value`.
        column: &'static str,
        /// Row of the first such point.
        row: usize,
        /// What was found there.
        value: f64,
    },
    /// A triangle names a vertex that does not exist.
    #[error("triangle {triangle} has vertex {vertex}, but there are only {vertices} vertices")]
    TriangleVertex {
        /// Row of the first such triangle.
        triangle: usize,
        /// The row it names.
        vertex: u32,
        /// Number of vertices.
        vertices: usize,
    },
    /// Triangles and their labels differ in number.
    #[error("{triangles} triangles but {found} pairs of regions: every triangle needs one")]
    TriangleLabels {
        /// Number of triangles.
        triangles: usize,
        /// Number of pairs of regions.
        found: usize,
    },
    /// A number of the settings, the camera or the film lies outside its range.
    #[error("{name} is {value}, but must be {allowed}")]
    OutOfRange {
        /// Which number.
        name: &'static str,
        /// What it was.
        value: f64,
        /// What it may be.
        allowed: &'static str,
    },
    /// A camera that looks along its own up vector, or at its own place.
    #[error("the camera has no direction: its target must differ from its position, and its up vector from the view")]
    CameraWithoutDirection,
    /// A frame of an animation differs in size from the first.
    #[error("an animation frame is {found:?} pixels, but the first was {expected:?}")]
    FrameSize {
        /// Width and height of the first frame, pixels.
        expected: (u32, u32),
        /// Width and height of this frame, pixels.
        found: (u32, u32),
    },
    /// An animation was closed before its first frame.
    #[error("the animation has no frames")]
    NoFrames,
    /// The PNG encoder refused.
    #[error("the picture could not be encoded")]
    Encode(#[from] image::ImageError),
    /// The file could not be written.
    #[error("the picture could not be written")]
    Write(#[from] std::io::Error),
}
