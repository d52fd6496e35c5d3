//! Draws films: shapes to sheets to light to pixels, tile by tile.
//!
//! | | points | triangles |
//! |---|---|---|
//! | 1. project to shapes | [`splat`](super::splat) | [`facet`](super::facet), [`tube`](super::tube) |
//! | 2. list them by tile | [`tiles`](super::tiles) | [`tiles`](super::tiles) |
//! | 3. gather the sheets at each sample | [`layers`](super::layers) | [`mesh_layers`](super::mesh_layers) |
//! | 4. composite them into light | [`shade`](super::shade) | [`shade`](super::shade) |
//!
//! Last, the samples of a pixel are averaged and coded as sRGB.
//! Tiles run in parallel and never share a sum, so the bytes do not depend on the number of threads.

use super::camera::{Camera, View};
use super::colour::to_bytes;
use super::error::PictureError;
use super::shade::Shader;
use super::studio::Backdrop;
use super::tiles::TileGrid;
use glam::{Vec2, Vec3};
use image::{Rgb, RgbImage};
use rayon::iter::{IntoParallelIterator, ParallelIterator};

/// Edge of a tile, samples, at most.
const TILE_SAMPLES: usize = 32;

/// Films that are projected and listed by tile.
pub(super) trait Content: Sync {
    /// The sheets of film at every sample of a tile.
    type Layers: TileLight;

    /// Room for a tile of `edge` by `edge` samples.
    fn layers(&self, edge: usize) -> Self::Layers;

    /// Empties the layers and fills them with what the tile shows; its upper left sample is `corner`.
    fn gather(&self, tile: usize, corner: (usize, usize), layers: &mut Self::Layers);
}

/// The sheets of one tile, as light.
pub(super) trait TileLight {
    /// Linear sRGB shown at a sample of the tile.
    fn light(&mut self, sample: (usize, usize), sight: &Sight, shader: &Shader) -> Vec3;
}

/// A line of sight.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sight {
    /// Linear sRGB behind all films.
    pub background: Vec3,
    /// Unit direction of view, camera axes.
    pub ray: Vec3,
}

/// What a drawing needs to know besides the films.
#[derive(Debug)]
pub(super) struct Drawing<'a> {
    /// Size of the picture, pixels.
    pub size: (u32, u32),
    /// Samples per pixel edge.
    pub samples: usize,
    pub camera: &'a Camera,
    pub background: Backdrop,
    pub shader: &'a Shader,
}

impl Drawing<'_> {
    /// Draws what `project` makes of the films.
    pub(super) fn draw<C: Content>(
        &self,
        project: impl FnOnce(&View, &TileGrid) -> Result<C, PictureError>,
    ) -> Result<RgbImage, PictureError> {
        let (width, height) = (self.size.0 as usize * self.samples, self.size.1 as usize * self.samples);
        let view = self.camera.view(width as f64, height as f64)?;
        let edge = TILE_SAMPLES / self.samples * self.samples;
        let grid = TileGrid::new(width, height, edge);
        let content = project(&view, &grid)?;
        let tiles: Vec<Vec<Rgb<u8>>> = (0..grid.len())
            .into_par_iter()
            .map_init(
                || content.layers(edge),
                |layers, tile| {
                    content.gather(tile, grid.corner(tile), layers);
                    self.draw_tile(&view, &grid, tile, layers)
                },
            )
            .collect();
        let tile_pixels = edge / self.samples;
        Ok(RgbImage::from_fn(self.size.0, self.size.1, |x, y| {
            let (x, y) = (x as usize, y as usize);
            let tile = y / tile_pixels * grid.columns + x / tile_pixels;
            tiles[tile][y % tile_pixels * tile_pixels + x % tile_pixels]
        }))
    }

    fn draw_tile(&self, view: &View, grid: &TileGrid, tile: usize, layers: &mut impl TileLight) -> Vec<Rgb<u8>> {
        let corner = grid.corner(tile);
        let pixels = grid.edge / self.samples;
        (0..pixels * pixels)
            .map(|pixel| Rgb(to_bytes(self.pixel(view, corner, layers, (pixel % pixels, pixel / pixels)))))
            .collect()
    }

    /// Mean of the samples of one pixel of a tile, linear sRGB.
    fn pixel(
        &self,
        view: &View,
        corner: (usize, usize),
        layers: &mut impl TileLight,
        (column, row): (usize, usize),
    ) -> Vec3 {
        let size = Vec2::new(view.width as f32, view.height as f32);
        let mut sum = Vec3::ZERO;
        for sample in 0..self.samples * self.samples {
            let (across, down) =
                (column * self.samples + sample % self.samples, row * self.samples + sample / self.samples);
            let place = Vec2::new((corner.0 + across) as f32 + 0.5, (corner.1 + down) as f32 + 0.5);
            let background = self.background.at(2.0 * place / size - 1.0);
            let sight = Sight { background, ray: view.ray(place.x, place.y) };
            sum += layers.light((across, down), &sight, self.shader);
        }
        sum / (self.samples * self.samples) as f32
    }
}
