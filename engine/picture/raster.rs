//! Draws a film: ellipses to sheets to light to pixels, tile by tile.
//!
//! 1. [`splat`](super::splat): each point becomes an ellipse;
//! 2. [`tiles`](super::tiles): the ellipses are listed by tile;
//! 3. [`layers`](super::layers): per sample, they are gathered into sheets;
//! 4. [`shade`](super::shade): the sheets are composited into light;
//! 5. the samples of a pixel are averaged and coded as sRGB.
//!
//! Tiles run in parallel and never share a sum, so the bytes do not depend on the number of threads.

use super::camera::{Camera, View};
use super::colour::to_bytes;
use super::error::PictureError;
use super::film::FilmPoints;
use super::layers::{MAX_SHEETS, Surface, TileLayers};
use super::shade::Shader;
use super::studio::Backdrop;
use super::tiles::{TileGrid, TiledSplats};
use glam::{Vec2, Vec3};
use image::{Rgb, RgbImage};
use rayon::iter::{IntoParallelIterator, ParallelIterator};

/// Edge of a tile, samples, at most.
const TILE_SAMPLES: usize = 32;

/// What a drawing needs to know besides the film.
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
    /// Draws films into one picture.
    pub(super) fn draw(&self, films: &[FilmPoints]) -> Result<RgbImage, PictureError> {
        let (width, height) = (self.size.0 as usize * self.samples, self.size.1 as usize * self.samples);
        let view = self.camera.view(width as f64, height as f64)?;
        let edge = TILE_SAMPLES / self.samples * self.samples;
        let grid = TileGrid::new(width, height, edge);
        let splats = films.iter().map(|film| TiledSplats::new(&view, film, &grid)).collect::<Result<Vec<_>, _>>()?;
        let tiles: Vec<Vec<Rgb<u8>>> = (0..grid.len())
            .into_par_iter()
            .map_init(|| TileLayers::new(edge), |layers, tile| self.draw_tile(&view, &grid, &splats, tile, layers))
            .collect();
        let tile_pixels = edge / self.samples;
        Ok(RgbImage::from_fn(self.size.0, self.size.1, |x, y| {
            let (x, y) = (x as usize, y as usize);
            let tile = y / tile_pixels * grid.columns + x / tile_pixels;
            tiles[tile][y % tile_pixels * tile_pixels + x % tile_pixels]
        }))
    }

    fn draw_tile(
        &self,
        view: &View,
        grid: &TileGrid,
        films: &[TiledSplats],
        tile: usize,
        layers: &mut TileLayers,
    ) -> Vec<Rgb<u8>> {
        let corner = grid.corner(tile);
        layers.restart(corner);
        films.iter().flat_map(|film| film.of_tile(tile)).for_each(|splat| layers.add(splat));
        let pixels = grid.edge / self.samples;
        (0..pixels * pixels)
            .map(|pixel| Rgb(to_bytes(self.pixel(view, corner, layers, pixel % pixels, pixel / pixels))))
            .collect()
    }

    /// Mean of the samples of one pixel of a tile, linear sRGB.
    fn pixel(&self, view: &View, corner: (usize, usize), layers: &TileLayers, column: usize, row: usize) -> Vec3 {
        let mut sheets = [Surface::default(); MAX_SHEETS];
        let mut sum = Vec3::ZERO;
        for sample in 0..self.samples * self.samples {
            let (across, down) =
                (column * self.samples + sample % self.samples, row * self.samples + sample / self.samples);
            let found = layers.surfaces(across, down, &mut sheets);
            let place = Vec2::new((corner.0 + across) as f32 + 0.5, (corner.1 + down) as f32 + 0.5);
            let size = Vec2::new(view.width as f32, view.height as f32);
            let background = self.background.at(2.0 * place / size - 1.0);
            sum += if found == 0 {
                background
            } else {
                self.shader.shade(background, view.ray(place.x, place.y), &sheets[..found])
            };
        }
        sum / (self.samples * self.samples) as f32
    }
}
