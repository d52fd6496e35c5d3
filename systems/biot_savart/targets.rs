//! Sums at places that are not panels: every place gathers from all panels.

use glam::DVec3;
use pulp::{Simd, WithSimd};
use rayon::prelude::*;

use crate::blocks::Block;
use crate::inner_loops::{Coefficients, Row};
use crate::instructions::{Instructions, dispatch};
use crate::sheet_kernel::Series;

/// Places that one task works on.
const TASK: usize = 32;

/// What is summed at a place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Quantity {
    /// `Σ G k`.
    Potential,
    /// `Σ G × d k_u`.
    Velocity,
}

/// Sums at places (in smoothing lengths), without their factors.
pub(crate) fn gather(
    quantity: Quantity,
    series: &Series,
    instructions: Instructions,
    blocks: &[&[Block]],
    places: &[DVec3],
) -> Vec<DVec3> {
    let mut sums = vec![DVec3::ZERO; places.len()];
    places.par_chunks(TASK).zip(sums.par_chunks_mut(TASK)).for_each(|(places, sums)| {
        dispatch(instructions, Gather { quantity, series, blocks, places, sums });
    });
    sums
}

/// All panels at a few places.
struct Gather<'a> {
    quantity: Quantity,
    series: &'a Series,
    blocks: &'a [&'a [Block]],
    places: &'a [DVec3],
    sums: &'a mut [DVec3],
}

impl WithSimd for Gather<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let kernel = Coefficients::new(simd, self.series);
        for (place, sum) in self.places.iter().zip(self.sums) {
            let mut row = Row::new(simd, *place, DVec3::ZERO);
            for blocks in self.blocks {
                match self.quantity {
                    Quantity::Potential => row.gather::<false>(simd, &kernel, blocks),
                    Quantity::Velocity => row.gather_velocity(simd, &kernel, blocks),
                }
            }
            let [potential, gathered] = row.sums(simd);
            *sum = if self.quantity == Quantity::Velocity { gathered } else { potential };
        }
    }
}
