//! The sum by expansions: distant groups of panels act on each other as polynomials, near ones pair by pair.
//!
//! One balanced [`tree`] over the panels; a walk finds the [`encounters`] of its cells; distant cells exchange [`expansions`] of
//! the same smoothed kernel that [`near`] leaves use, so that the sum of both is the direct sum up to truncation. Symmetric in
//! both parts (Dehnen 2002), and the same for any number of threads. How far to trust it is in [`accuracy`].

pub(crate) mod accuracy;
mod encounters;
mod expansions;
mod near;
mod taylor;
mod tree;

use glam::DVec3;
use rayon::prelude::*;

use crate::blocks::{self, Block, BlockSums, Frame};
use crate::instructions::{Instructions, dispatch};
use crate::sheet_kernel::Series;
use crate::targets::Quantity;
use accuracy::Accuracy;
use encounters::{Encounters, SourceLists};
use expansions::{Evaluate, LeafMoments, Slope, Sources, Translate, lower_locals, raise_moments};
use near::{Chunks, GatherNear, LEAF_BLOCKS};
use taylor::Taylor;
use tree::Tree;

/// Cells whose local coefficients one task works out.
const CELLS: usize = 16;

/// What tells how finely to expand.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Fineness {
    /// A bound on the relative error of normal velocities.
    Bound(f64),
    /// The order and opening angle themselves.
    Set(Accuracy),
}

/// Panels in their places, with all that follows from the places.
#[derive(Debug)]
pub(crate) struct Fast {
    taylor: Taylor,
    accuracy: Accuracy,
    tree: Tree,
    /// Cells far from each cell.
    far: SourceLists,
    /// Later leaves near each leaf.
    near: SourceLists,
    chunks: Chunks,
    moments: Vec<f64>,
    locals: Vec<f64>,
}

impl Fast {
    pub(crate) fn place(centres: &[DVec3], frame: &Frame, fineness: Fineness) -> Self {
        let tree = Tree::new(centres.iter().map(|x| frame.scaled(*x)));
        let accuracy = match fineness {
            Fineness::Bound(tolerance) => Accuracy::for_tolerance(tolerance, tree.resolution()),
            Fineness::Set(accuracy) => accuracy,
        };
        let taylor = Taylor::new(accuracy.order);
        let mut found = Encounters::within(&tree, accuracy.opening);
        found.near.par_sort_unstable();
        let coefficients = vec![0.0; tree.cells.len() * 3 * taylor.count];
        Self {
            far: SourceLists::new(tree.cells.len(), &found.far),
            near: SourceLists::new(tree.leaf_count(), &found.near),
            chunks: Chunks::new(&tree),
            moments: coefficients.clone(),
            locals: coefficients,
            taylor,
            accuracy,
            tree,
        }
    }

    pub(crate) fn accuracy(&self) -> Accuracy {
        self.accuracy
    }

    pub(crate) fn set_strengths(&mut self, strengths: &[DVec3]) {
        self.chunks.set_strengths(&self.tree, strengths);
    }

    /// Sums at the panels: potentials, and gradients if asked for.
    pub(crate) fn sum<const GRADIENT: bool>(&mut self, series: &Series, instructions: Instructions) {
        self.gather_moments(instructions);
        let sources = Sources { taylor: &self.taylor, series, cells: &self.tree.cells, moments: &self.moments };
        local_expansions(&sources, &self.tree, &self.far, instructions, &mut self.locals);
        self.chunks.sum_near::<GRADIENT>(&self.near, series, instructions);
        self.evaluate(if GRADIENT { Slope::Gradient } else { Slope::None }, instructions);
    }

    /// Writes sums in the panels' order, without their factors.
    pub(crate) fn sums(&self) -> impl Iterator<Item = (usize, [DVec3; 2])> + '_ {
        self.tree.rows.iter().map(|row| *row as usize).zip(self.chunks.sums())
    }

    /// Sums at places that are not panels (in smoothing lengths), without their factors.
    pub(crate) fn gather(
        &mut self,
        quantity: Quantity,
        series: &Series,
        instructions: Instructions,
        places: &[DVec3],
    ) -> Vec<DVec3> {
        self.gather_moments(instructions);
        let targets = Tree::new(places.iter().copied());
        let found = Encounters::between(&targets, &self.tree, self.accuracy.opening);
        let far = SourceLists::new(targets.cells.len(), &found.far);
        let near = SourceLists::new(targets.leaf_count(), &found.near);
        let mut locals = vec![0.0; targets.cells.len() * 3 * self.taylor.count];
        let sources = Sources { taylor: &self.taylor, series, cells: &self.tree.cells, moments: &self.moments };
        local_expansions(&sources, &targets, &far, instructions, &mut locals);
        self.evaluate_at(quantity, series, instructions, &targets, &near, &locals)
    }

    /// Moments of all cells, leaves first.
    fn gather_moments(&mut self, instructions: Instructions) {
        let Self { taylor, tree, chunks, moments, .. } = self;
        let size = 3 * taylor.count;
        moments.par_chunks_exact_mut(size).zip(&tree.cells).with_min_len(CELLS).for_each(|(moments, cell)| match cell
            .leaf()
        {
            Some(leaf) => {
                let blocks = chunks.blocks_of(leaf);
                dispatch(instructions, LeafMoments { taylor, centre: cell.centre, blocks, moments });
            }
            None => moments.fill(0.0),
        });
        let mut powers = vec![];
        for parent in (0..tree.cells.len()).rev().filter(|cell| tree.cells[*cell].leaf().is_none()) {
            let (above, below) = moments.split_at_mut((parent + 1) * size);
            for child in tree.children(parent) {
                let offset = tree.cells[parent].centre - tree.cells[child].centre;
                let child = &below[(child - parent - 1) * size..][..size];
                raise_moments(taylor, offset, child, &mut above[parent * size..], &mut powers);
            }
        }
    }

    /// Adds local expansions to the sums at the panels.
    fn evaluate(&mut self, slope: Slope, instructions: Instructions) {
        let Self { taylor, tree, chunks, locals, .. } = self;
        let (leaf_cells, size) = (leaf_cells(tree), 3 * taylor.count);
        chunks.chunks.par_iter_mut().for_each(|chunk| {
            for leaf in chunk.leaves() {
                let (cell, place) = (leaf_cells[leaf], chunk.place_of(leaf));
                let (blocks, sums) = (&chunk.blocks[place.clone()], &mut chunk.sums[place]);
                let (centre, locals) = (tree.cells[cell].centre, &locals[cell * size..][..size]);
                dispatch(instructions, Evaluate { taylor, slope, centre, locals, blocks, sums });
            }
        });
    }

    /// Sums at other places, leaf by leaf of their tree.
    fn evaluate_at(
        &self,
        quantity: Quantity,
        series: &Series,
        instructions: Instructions,
        targets: &Tree,
        near: &SourceLists,
        locals: &[f64],
    ) -> Vec<DVec3> {
        let (taylor, velocity) = (&self.taylor, quantity == Quantity::Velocity);
        let (leaf_cells, size) = (leaf_cells(targets), 3 * taylor.count);
        let leaf_sums = |leaf: usize| {
            let (cell, places) = (leaf_cells[leaf], &targets.points[targets.points_of(leaf)]);
            let blocks: Vec<Block> = blocks::blocks_at(places.iter().copied());
            let mut sums = [BlockSums::default(); LEAF_BLOCKS];
            let (centre, locals) = (targets.cells[cell].centre, &locals[cell * size..][..size]);
            let slope = if velocity { Slope::Curl } else { Slope::None };
            dispatch(instructions, Evaluate { taylor, slope, centre, locals, blocks: &blocks, sums: &mut sums });
            let (panels, sources) = (&self.chunks, near.of(leaf));
            dispatch(instructions, GatherNear { series, velocity, panels, sources, places, sums: &mut sums });
            sums
        };
        let sums: Vec<[BlockSums; LEAF_BLOCKS]> = (0..targets.leaf_count()).into_par_iter().map(leaf_sums).collect();
        let mut values = vec![DVec3::ZERO; targets.points.len()];
        for (i, row) in targets.rows.iter().enumerate() {
            let sums = &sums.as_flattened()[i / blocks::LANES];
            let triple = if velocity { &sums.gradients } else { &sums.potentials };
            values[*row as usize] = blocks::get(triple, i % blocks::LANES);
        }
        values
    }
}

/// The cell of each leaf.
fn leaf_cells(tree: &Tree) -> Vec<usize> {
    (0..tree.cells.len()).filter(|cell| tree.cells[*cell].leaf().is_some()).collect()
}

/// Local coefficients of all target cells: from far cells, then from parents to children.
fn local_expansions(
    sources: &Sources<'_>,
    targets: &Tree,
    far: &SourceLists,
    instructions: Instructions,
    locals: &mut [f64],
) {
    let (taylor, size, cells) = (sources.taylor, 3 * sources.taylor.count, targets.cells.len());
    locals.par_chunks_mut(CELLS * size).enumerate().for_each(|(task, locals)| {
        let range = task * CELLS..cells.min((task + 1) * CELLS);
        let sources_of = |cell| far.of(cell);
        dispatch(instructions, Translate { from: sources, targets: range, cells: &targets.cells, sources_of, locals });
    });
    let mut powers = vec![];
    for parent in (0..cells).filter(|cell| targets.cells[*cell].leaf().is_none()) {
        let (above, below) = locals.split_at_mut((parent + 1) * size);
        for child in targets.children(parent) {
            let offset = targets.cells[child].centre - targets.cells[parent].centre;
            let child = &mut below[(child - parent - 1) * size..][..size];
            lower_locals(taylor, offset, &above[parent * size..], child, &mut powers);
        }
    }
}
