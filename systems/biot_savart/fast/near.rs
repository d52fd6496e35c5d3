//! Leaves that are too close for expansions: pair by pair, each pair once.
//!
//! Leaves stand in chunks, a few dozen for any number of panels. Chunks meet in a [`tournament`](crate::tournament), so that both
//! sides of a pair can be written without two threads at one chunk and in the same order for any number of threads.

use glam::DVec3;
use pulp::{Simd, WithSimd};
use rayon::prelude::*;

use super::encounters::SourceLists;
use super::tree::{LEAF, Tree};
use crate::blocks::{self, Block, BlockSums, LANES};
use crate::inner_loops::{Coefficients, Row};
use crate::instructions::{Instructions, dispatch};
use crate::sheet_kernel::Series;
use crate::tournament;

/// Blocks in a leaf.
pub(super) const LEAF_BLOCKS: usize = LEAF / LANES;

/// Most chunks that leaves stand in.
const MOST_CHUNKS: usize = 64;

/// Fewest leaves that make a chunk worth a meeting.
const LEAST_LEAVES: usize = 8;

/// Neighbouring leaves with their sums.
#[derive(Debug, Default)]
pub(super) struct Chunk {
    first_leaf: usize,
    pub(super) blocks: Vec<Block>,
    pub(super) sums: Vec<BlockSums>,
    /// Number of points.
    points: usize,
}

/// All leaves, in chunks of equal length (the last may be shorter).
#[derive(Debug, Default)]
pub(super) struct Chunks {
    pub(super) chunks: Vec<Chunk>,
    leaves_per_chunk: usize,
}

impl Chunks {
    pub(super) fn new(tree: &Tree) -> Self {
        let leaves_per_chunk = tree.leaf_count().div_ceil(MOST_CHUNKS).max(LEAST_LEAVES);
        let lengths = tree.points.chunks(leaves_per_chunk * LEAF).enumerate();
        let mut chunks: Vec<Chunk> = lengths.map(|(i, points)| Chunk::new(i * leaves_per_chunk, points)).collect();
        if chunks.len() > 1 && chunks.len() % 2 == 1 {
            chunks.push(Chunk { first_leaf: tree.leaf_count(), ..Chunk::default() });
        }
        Self { chunks, leaves_per_chunk }
    }

    /// Blocks of a leaf.
    pub(super) fn blocks_of(&self, leaf: usize) -> &[Block] {
        self.chunks[leaf / self.leaves_per_chunk].blocks_of(leaf)
    }

    /// Sets the strengths, which come in the caller's order.
    pub(super) fn set_strengths(&mut self, tree: &Tree, strengths: &[DVec3]) {
        let chunks = self.chunks.par_iter_mut().zip(tree.rows.par_chunks(self.leaves_per_chunk * LEAF));
        chunks.for_each(|(chunk, rows)| {
            for (i, row) in rows.iter().enumerate() {
                blocks::set(&mut chunk.blocks[i / LANES].strengths, i % LANES, strengths[*row as usize]);
            }
        });
    }

    /// Sums over near pairs, from nothing. A leaf's sources must be later leaves, in ascending order.
    pub(super) fn sum_near<const GRADIENT: bool>(
        &mut self,
        near: &SourceLists,
        series: &Series,
        instructions: Instructions,
    ) {
        self.chunks.par_iter_mut().for_each(|chunk| {
            dispatch(instructions, Alone::<GRADIENT> { near, series, chunk });
        });
        tournament::meet_all(&mut self.chunks, |a, b| {
            let (chunk, later) = if a.first_leaf < b.first_leaf { (a, b) } else { (b, a) };
            dispatch(instructions, Meeting::<GRADIENT> { near, series, chunk, later });
        });
    }

    /// Potential and gradient sums in the tree's order, without their factors.
    pub(super) fn sums(&self) -> impl Iterator<Item = [DVec3; 2]> + '_ {
        self.chunks.iter().flat_map(Chunk::sums)
    }
}

impl Chunk {
    fn new(first_leaf: usize, points: &[DVec3]) -> Self {
        let blocks = blocks::blocks_at(points.iter().copied());
        let sums = vec![BlockSums::default(); blocks.len()];
        Self { first_leaf, blocks, sums, points: points.len() }
    }

    /// Leaves of the chunk.
    pub(super) fn leaves(&self) -> std::ops::Range<usize> {
        self.first_leaf..self.first_leaf + self.blocks.len().div_ceil(LEAF_BLOCKS)
    }

    /// Where a leaf's blocks stand in the chunk.
    pub(super) fn place_of(&self, leaf: usize) -> std::ops::Range<usize> {
        let start = (leaf - self.first_leaf) * LEAF_BLOCKS;
        start..(start + LEAF_BLOCKS).min(self.blocks.len())
    }

    pub(super) fn blocks_of(&self, leaf: usize) -> &[Block] {
        &self.blocks[self.place_of(leaf)]
    }

    /// Points of a leaf, by their places in the chunk.
    fn points_of(&self, leaf: usize) -> std::ops::Range<usize> {
        let start = (leaf - self.first_leaf) * LEAF;
        start..(start + LEAF).min(self.points)
    }

    /// The part of a leaf's (ascending) sources that stands in this chunk.
    fn part_of<'a>(&self, sources: &'a [u32]) -> &'a [u32] {
        let leaves = self.leaves();
        let before = |end: usize| sources.partition_point(|source| (*source as usize) < end);
        &sources[before(leaves.start)..before(leaves.end)]
    }

    #[inline(always)]
    fn row<S: Simd>(&self, simd: S, point: usize) -> Row<S> {
        let block = &self.blocks[point / LANES];
        Row::new(simd, blocks::get(&block.centres, point % LANES), blocks::get(&block.strengths, point % LANES))
    }

    #[inline(always)]
    fn exchange<const GRADIENT: bool, S: Simd>(
        &mut self,
        simd: S,
        kernel: &Coefficients<S>,
        row: &mut Row<S>,
        sources: &[u32],
    ) {
        for source in sources {
            let place = self.place_of(*source as usize);
            row.exchange::<GRADIENT>(simd, kernel, &self.blocks[place.clone()], &mut self.sums[place]);
        }
    }

    #[inline(always)]
    fn add<S: Simd>(&mut self, simd: S, point: usize, row: &Row<S>) {
        self.sums[point / LANES].add(point % LANES, row.sums(simd));
    }

    fn sums(&self) -> impl Iterator<Item = [DVec3; 2]> + '_ {
        (0..self.points).map(|i| {
            let sums = &self.sums[i / LANES];
            [&sums.potentials, &sums.gradients].map(|triple| blocks::get(triple, i % LANES))
        })
    }
}

/// Near pairs within a chunk; sums start here.
struct Alone<'a, const GRADIENT: bool> {
    near: &'a SourceLists,
    series: &'a Series,
    chunk: &'a mut Chunk,
}

impl<const GRADIENT: bool> WithSimd for Alone<'_, GRADIENT> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let (kernel, chunk) = (Coefficients::new(simd, self.series), self.chunk);
        chunk.sums.fill(BlockSums::default());
        for leaf in chunk.leaves() {
            let sources = chunk.part_of(self.near.of(leaf));
            for point in chunk.points_of(leaf) {
                let mut row = chunk.row(simd, point);
                row.gather::<GRADIENT>(simd, &kernel, chunk.blocks_of(leaf));
                chunk.exchange::<GRADIENT, S>(simd, &kernel, &mut row, sources);
                chunk.add(simd, point, &row);
            }
        }
    }
}

/// Near pairs between two chunks.
struct Meeting<'a, const GRADIENT: bool> {
    near: &'a SourceLists,
    series: &'a Series,
    chunk: &'a mut Chunk,
    later: &'a mut Chunk,
}

impl<const GRADIENT: bool> WithSimd for Meeting<'_, GRADIENT> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let kernel = Coefficients::new(simd, self.series);
        let (chunk, later) = (self.chunk, self.later);
        for leaf in chunk.leaves() {
            let sources = later.part_of(self.near.of(leaf));
            if sources.is_empty() {
                continue;
            }
            for point in chunk.points_of(leaf) {
                let mut row = chunk.row(simd, point);
                later.exchange::<GRADIENT, S>(simd, &kernel, &mut row, sources);
                chunk.add(simd, point, &row);
            }
        }
    }
}

/// Panels of near leaves at the places of one leaf that are not panels.
pub(super) struct GatherNear<'a> {
    pub(super) series: &'a Series,
    /// Velocities if so, potentials if not.
    pub(super) velocity: bool,
    pub(super) panels: &'a Chunks,
    pub(super) sources: &'a [u32],
    pub(super) places: &'a [DVec3],
    pub(super) sums: &'a mut [BlockSums],
}

impl WithSimd for GatherNear<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let kernel = Coefficients::new(simd, self.series);
        for (i, place) in self.places.iter().enumerate() {
            let mut row = Row::new(simd, *place, DVec3::ZERO);
            for source in self.sources {
                let blocks = self.panels.blocks_of(*source as usize);
                if self.velocity {
                    row.gather_velocity(simd, &kernel, blocks);
                } else {
                    row.gather::<false>(simd, &kernel, blocks);
                }
            }
            self.sums[i / LANES].add(i % LANES, row.sums(simd));
        }
    }
}
