//! The sum over all pairs, each taken once.
//!
//! Panels stand in tiles that fit the first cache. Within a tile every panel gathers from all; between tiles each pair is
//! computed once for both sides, in a [`tournament`](crate::tournament) of tiles, so that no two threads write to one tile and
//! every tile sees the others in the same order.

use glam::DVec3;
use pulp::{Simd, WithSimd};
use rayon::prelude::*;

use crate::blocks::{self, Block, BlockSums, Frame, LANES};
use crate::inner_loops::{Coefficients, Row};
use crate::instructions::{Instructions, dispatch};
use crate::sheet_kernel::Series;
use crate::tournament;

/// Panels in the largest tile: 36 KB with its sums.
const LARGEST_TILE: usize = 48 * LANES;

/// Tiles that a small sum is cut into, so that threads find work.
const LEAST_TILES: usize = 16;

/// Panels that act on each other, with their sums.
#[derive(Debug, Default)]
struct Tile {
    blocks: Vec<Block>,
    sums: Vec<BlockSums>,
    panels: usize,
}

/// Panels in their places.
#[derive(Debug, Default)]
pub(crate) struct Direct {
    tiles: Vec<Tile>,
    tile_length: usize,
}

impl Direct {
    pub(crate) fn place(centres: &[DVec3], frame: &Frame) -> Self {
        let tile_length = centres.len().div_ceil(LEAST_TILES).next_multiple_of(LANES).clamp(LANES, LARGEST_TILE);
        let mut tiles: Vec<Tile> = centres.chunks(tile_length).map(|chunk| Tile::at(chunk, frame)).collect();
        if tiles.len() > 1 && tiles.len() % 2 == 1 {
            tiles.push(Tile::default());
        }
        Self { tiles, tile_length }
    }

    pub(crate) fn set_strengths(&mut self, strengths: &[DVec3]) {
        for (tile, strengths) in self.tiles.iter_mut().zip(strengths.chunks(self.tile_length)) {
            for (i, strength) in strengths.iter().enumerate() {
                blocks::set(&mut tile.blocks[i / LANES].strengths, i % LANES, *strength);
            }
        }
    }

    /// Sums at the panels: potentials, and gradients if asked for.
    pub(crate) fn sum<const GRADIENT: bool>(&mut self, series: &Series, instructions: Instructions) {
        self.tiles.par_iter_mut().for_each(|tile| {
            dispatch(instructions, Alone::<GRADIENT> { series, tile });
        });
        tournament::meet_all(&mut self.tiles, |tile, other| {
            dispatch(instructions, Meeting::<GRADIENT> { series, tile, other });
        });
    }

    /// Potential and gradient sums in the panels' order, without their factors.
    pub(crate) fn sums(&self) -> impl Iterator<Item = [DVec3; 2]> + '_ {
        self.tiles.iter().flat_map(Tile::sums)
    }

    /// All panels, in blocks.
    pub(crate) fn blocks(&self) -> impl Iterator<Item = &[Block]> {
        self.tiles.iter().map(|tile| tile.blocks.as_slice())
    }
}

impl Tile {
    fn at(centres: &[DVec3], frame: &Frame) -> Self {
        let blocks = blocks::blocks_at(centres.iter().map(|x| frame.scaled(*x)));
        let sums = vec![BlockSums::default(); blocks.len()];
        Self { blocks, sums, panels: centres.len() }
    }

    fn sums(&self) -> impl Iterator<Item = [DVec3; 2]> + '_ {
        (0..self.panels).map(|i| {
            let sums = &self.sums[i / LANES];
            [&sums.potentials, &sums.gradients].map(|triple| blocks::get(triple, i % LANES))
        })
    }
}

/// A panel of some blocks, as a row.
#[inline(always)]
fn row<S: Simd>(simd: S, blocks: &[Block], panel: usize) -> Row<S> {
    let block = &blocks[panel / LANES];
    Row::new(simd, blocks::get(&block.centres, panel % LANES), blocks::get(&block.strengths, panel % LANES))
}

/// Sums within one tile; they start here.
struct Alone<'a, const GRADIENT: bool> {
    series: &'a Series,
    tile: &'a mut Tile,
}

impl<const GRADIENT: bool> WithSimd for Alone<'_, GRADIENT> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let kernel = Coefficients::new(simd, self.series);
        let Tile { blocks, sums, panels } = self.tile;
        for panel in 0..*panels {
            let mut row = row(simd, blocks, panel);
            row.gather::<GRADIENT>(simd, &kernel, blocks);
            let [potential, gradient] = row.sums(simd);
            let sums = &mut sums[panel / LANES];
            blocks::set(&mut sums.potentials, panel % LANES, potential);
            blocks::set(&mut sums.gradients, panel % LANES, gradient);
        }
    }
}

/// Sums between two tiles.
struct Meeting<'a, const GRADIENT: bool> {
    series: &'a Series,
    tile: &'a mut Tile,
    other: &'a mut Tile,
}

impl<const GRADIENT: bool> WithSimd for Meeting<'_, GRADIENT> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let kernel = Coefficients::new(simd, self.series);
        let Tile { blocks, sums, panels } = self.tile;
        for panel in 0..*panels {
            let mut row = row(simd, blocks, panel);
            row.exchange::<GRADIENT>(simd, &kernel, &self.other.blocks, &mut self.other.sums);
            sums[panel / LANES].add(panel % LANES, row.sums(simd));
        }
    }
}

#[cfg(all(test, target_arch = "x86_64"))]
mod tests {
    use super::*;
    use crate::sheet_kernel::KernelOrder;

    /// Two tiles that have met.
    fn meeting(meet: impl Fn(Meeting<'_, true>)) -> Vec<[DVec3; 2]> {
        let points: Vec<DVec3> =
            (0..60).map(|i| DVec3::new(f64::from(i).sin(), f64::from(i).cos(), f64::from(i))).collect();
        let frame = Frame::about(&points, 0.5);
        let mut tiles = [Tile::at(&points[..37], &frame), Tile::at(&points[37..], &frame)];
        for tile in &mut tiles {
            (0..tile.panels).for_each(|i| blocks::set(&mut tile.blocks[i / LANES].strengths, i % LANES, points[i]));
        }
        let [tile, other] = &mut tiles;
        meet(Meeting { series: &KernelOrder::Third.series(), tile, other });
        tiles.iter().flat_map(Tile::sums).collect()
    }

    #[test]
    fn narrower_vectors_give_the_scalar_result() {
        let Some(avx2) = pulp::x86::V3::try_new() else { return };
        let scalar = meeting(|tiles| dispatch(Instructions::Scalar, tiles));
        let narrow = meeting(|tiles| Simd::vectorize(avx2, tiles));
        for (found, expected) in narrow.as_flattened().iter().zip(scalar.as_flattened()) {
            assert!(found.distance(*expected) < 1e-12 * expected.length().max(1.0), "{found} {expected}");
        }
    }
}
