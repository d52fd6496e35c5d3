//! Sorts ellipses, triangles and lines into square tiles, so that tiles can be drawn side by side.
//!
//! Rows are handled in chunks of fixed size; a tile visits the chunks in order, and in each its shapes in order.
//! The order of every sum is therefore fixed by the input, for any number of threads.

use super::camera::View;
use super::error::PictureError;
use super::film::FilmPoints;
use super::splat::{Splat, splat_of_point};
use glam::Vec2;
use rayon::iter::{IntoParallelIterator, ParallelIterator};

/// Rows per chunk. Part of the result: another size sums in another order.
const CHUNK: usize = 16_384;

/// Ellipses over one sample, on average, beyond which a film is refused: some 200 sheets behind each other.
const MOST_OVERLAPS: f64 = 4000.0;
/// Samples under all ellipses that are drawn however small the picture is.
const ALWAYS_DRAWN: f64 = 3e8;

/// A picture cut into square tiles.
#[derive(Clone, Copy, Debug)]
pub(super) struct TileGrid {
    /// Edge of a tile, samples.
    pub edge: usize,
    /// Tiles from left to right.
    pub columns: usize,
    /// Tiles from top to bottom.
    pub rows: usize,
}

impl TileGrid {
    /// Covers `width` by `height` samples.
    pub(super) fn new(width: usize, height: usize, edge: usize) -> Self {
        Self { edge, columns: width.div_ceil(edge), rows: height.div_ceil(edge) }
    }

    /// Number of tiles.
    pub(super) fn len(&self) -> usize {
        self.columns * self.rows
    }

    /// Upper left sample of a tile.
    pub(super) fn corner(&self, tile: usize) -> (usize, usize) {
        (tile % self.columns * self.edge, tile / self.columns * self.edge)
    }

    /// Calls `visit` for each tile that the box of a shape touches.
    fn touched(&self, shape: &impl Flat, mut visit: impl FnMut(usize)) {
        let cell =
            |position: f32, count: usize| ((position / self.edge as f32).floor().max(0.0) as usize).min(count - 1);
        let (low, high) = shape.bounds();
        for row in cell(low.y, self.rows)..=cell(high.y, self.rows) {
            for column in cell(low.x, self.columns)..=cell(high.x, self.columns) {
                visit(row * self.columns + column);
            }
        }
    }
}

/// A shape in the picture plane.
pub(super) trait Flat: Sync + Send {
    /// Lower and upper corner of a box around it, samples; the box meets the picture.
    fn bounds(&self) -> (Vec2, Vec2);
}

impl Flat for Splat {
    fn bounds(&self) -> (Vec2, Vec2) {
        (self.centre - self.reach, self.centre + self.reach)
    }
}

/// The shapes of one chunk of rows, listed by tile.
#[derive(Debug)]
struct Chunk<S> {
    shapes: Vec<S>,
    /// `tiles + 1` entries into `order`.
    offsets: Vec<u32>,
    order: Vec<u32>,
}

/// Shapes listed by tile.
#[derive(Debug)]
pub(super) struct Tiled<S> {
    chunks: Vec<Chunk<S>>,
}

impl<S: Flat> Tiled<S> {
    /// Projects rows `0..rows`, each to a shape or to nothing, and sorts the shapes.
    pub(super) fn new(rows: usize, grid: &TileGrid, project: impl Fn(usize) -> Option<S> + Sync) -> Self {
        Self::sort(projected(rows, project), grid)
    }

    fn sort(projected: Vec<Vec<S>>, grid: &TileGrid) -> Self {
        Self { chunks: projected.into_par_iter().map(|shapes| sort_by_tile(shapes, grid)).collect() }
    }

    /// The shapes that touch a tile, in the order of their rows.
    pub(super) fn of_tile(&self, tile: usize) -> impl Iterator<Item = &S> {
        self.chunks.iter().flat_map(move |chunk| {
            let rows = chunk.offsets[tile] as usize..chunk.offsets[tile + 1] as usize;
            chunk.order[rows].iter().map(|&row| &chunk.shapes[row as usize])
        })
    }
}

impl Tiled<Splat> {
    /// Projects and sorts all points of a film.
    ///
    /// # Errors
    /// [`PictureError::OutOfRange`] if the ellipses overlap so often that the spacing cannot be right.
    pub(super) fn splats(view: &View, film: &FilmPoints, grid: &TileGrid) -> Result<Self, PictureError> {
        let projected = projected(film.positions.len(), |row| splat_of_point(view, film, row));
        let covered: f64 = projected.iter().flatten().map(|splat| visible_box(splat, view)).sum();
        if covered > (MOST_OVERLAPS * view.width * view.height).max(ALWAYS_DRAWN) {
            let (name, allowed) = ("the spacing of the film", "about the square root of its area per point");
            return Err(PictureError::OutOfRange { name, value: film.spacing, allowed });
        }
        Ok(Self::sort(projected, grid))
    }
}

/// Shapes of rows `0..rows`, chunk after chunk.
fn projected<S: Send>(rows: usize, project: impl Fn(usize) -> Option<S> + Sync) -> Vec<Vec<S>> {
    (0..rows.div_ceil(CHUNK))
        .into_par_iter()
        .map(|chunk| (chunk * CHUNK..((chunk + 1) * CHUNK).min(rows)).filter_map(&project).collect())
        .collect()
}

/// Samples of the picture in the box around an ellipse.
fn visible_box(splat: &Splat, view: &View) -> f64 {
    let size = Vec2::new(view.width as f32, view.height as f32);
    let low = (splat.centre - splat.reach).clamp(Vec2::ZERO, size);
    let high = (splat.centre + splat.reach).clamp(Vec2::ZERO, size);
    f64::from((high - low).element_product())
}

/// Counting sort of (tile, shape) pairs.
fn sort_by_tile<S: Flat>(shapes: Vec<S>, grid: &TileGrid) -> Chunk<S> {
    let mut offsets = vec![0_u32; grid.len() + 1];
    for shape in &shapes {
        grid.touched(shape, |tile| offsets[tile + 1] += 1);
    }
    for tile in 0..grid.len() {
        offsets[tile + 1] += offsets[tile];
    }
    let mut next = offsets.clone();
    let mut order = vec![0; offsets[grid.len()] as usize];
    for (row, shape) in shapes.iter().enumerate() {
        grid.touched(shape, |tile| {
            order[next[tile] as usize] = row as u32;
            next[tile] += 1;
        });
    }
    Chunk { shapes, offsets, order }
}
