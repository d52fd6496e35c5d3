//! Keeps the carriers evenly spread over the film without moving the film.
//!
//! # Equation
//! Excess density `e_i = (1/a_i) / mean(1/a) - 1`. Long waves: `lap C = e`, displacement `grad C`. Pairs (white noise):
//! Fick displacement `c h^2 sum_j a_j g_ij (x_i - x_j)`.
//!
//! # Discretisation
//! Poisson's equation on the pair weights, zero mean, conjugate gradients. The sum of both displacements is limited to
//! 0.2 dx and laid onto the film's local quadratic; what the carriers carry is moved along by its gradient.
//! Fick's law alone cannot remove long waves, Poisson's equation alone cannot separate pairs.
//!
//! # Source
//! Deng 2022, Algorithm 5, Eq. 20, made dimensionless (its threshold is per square metre and particle).
//!
//! # Limits
//! One pass per step; the number of carriers whose move was limited is reported.

use crate::neighbours::kernel::Kernel;
use crate::operators::conjugate_gradient::{self, NotConverged, SolveInfo, StopRule, Workspace};
use crate::operators::pair_system::PairSystem;
use crate::operators::quadratic::height_along;
use crate::operators::stencil::{PAIR_SUPPORT, Stencil};
use crate::operators::tangent::tangential;
use crate::rows::reduce::ordered_sum;
use froth_components::film::ShapeOperator;
use froth_components::motion::{Normal, Position};
use glam::DVec3;
use rayon::prelude::*;
use std::ops::Range;

/// Strength of the Fick displacement, dimensionless.
const FICK: f64 = 0.05;
/// Support of the quartics along which carriers slide, in spacings.
const LIFT_SUPPORT: f64 = PAIR_SUPPORT;
/// Longest displacement, in spacings.
const LONGEST_MOVE: f64 = 0.2;
/// Relative standard deviation of the areas below which carriers stay where they are.
pub const EVEN_ENOUGH: f64 = 0.004;

/// What redistribution reads.
#[derive(Clone, Copy)]
pub struct Spread<'a> {
    /// Pair weights and areas.
    pub stencil: &'a Stencil,
    /// Places.
    pub positions: &'a [Position],
    /// Boundary particles.
    pub wall: &'a [Position],
    /// Unit normals.
    pub normals: &'a [Normal],
    /// Rows of each film.
    pub films: &'a [Range<usize>],
    /// Spacing, m.
    pub spacing: f64,
}

/// What a pass did.
#[derive(Clone, Debug, Default)]
pub struct Moves {
    /// Tangential displacement of every carrier, m.
    pub displacement: Vec<DVec3>,
    /// Carriers whose displacement was limited.
    pub limited: usize,
    /// The Poisson solve.
    pub solve: SolveInfo,
}

impl Spread<'_> {
    /// Relative excess density of every carrier.
    #[must_use]
    pub fn excess(&self) -> Vec<f64> {
        let mut excess: Vec<f64> = self.stencil.areas.iter().map(|a| 1.0 / a).collect();
        for film in self.films {
            let start = film.start;
            let mean = ordered_sum(film.len(), 0.0, |k| excess[start + k]) / film.len() as f64;
            excess[film.clone()].iter_mut().for_each(|e| *e = *e / mean - 1.0);
        }
        excess
    }

    /// The displacements of one pass.
    ///
    /// # Errors
    /// [`NotConverged`] if Poisson's equation was not solved.
    pub fn moves(&self, excess: &[f64], stop: StopRule, work: &mut Workspace) -> Result<Moves, NotConverged> {
        let (potential, solve) = self.potential(excess, stop, work)?;
        let kernel = Kernel::new(PAIR_SUPPORT * self.spacing);
        let longest = LONGEST_MOVE * self.spacing;
        let moves: Vec<(DVec3, bool)> = (0..self.stencil.len())
            .into_par_iter()
            .with_min_len(128)
            .map(|i| {
                let slope = self.stencil.gradient(self.positions, self.normals, i, |j| potential[j]);
                let whole = slope + self.fick(&kernel, i);
                (whole.clamp_length_max(longest), whole.length() > longest)
            })
            .collect();
        let limited = moves.iter().filter(|(_, limited)| *limited).count();
        Ok(Moves { displacement: moves.into_iter().map(|(d, _)| d).collect(), limited, solve })
    }

    fn potential(
        &self,
        excess: &[f64],
        stop: StopRule,
        work: &mut Workspace,
    ) -> Result<(Vec<f64>, SolveInfo), NotConverged> {
        let stencil = self.stencil;
        let mut b: Vec<f64> = stencil.areas.iter().zip(excess).map(|(a, e)| -a * e).collect();
        for film in self.films {
            let start = film.start;
            let mean = ordered_sum(film.len(), 0.0, |k| b[start + k]) / film.len() as f64;
            b[film.clone()].iter_mut().for_each(|v| *v -= mean);
        }
        let system = PairSystem::new(&stencil.lists, vec![0.0; stencil.len()], |_, _, k| stencil.weights[k]);
        let mut potential = vec![0.0; stencil.len()];
        let places = self.positions.iter().map(|x| x.0);
        let solve = conjugate_gradient::solve(&system, places, &b, &mut potential, stop, work)?;
        Ok((potential, solve))
    }

    fn fick(&self, kernel: &Kernel, i: usize) -> DVec3 {
        let x = self.positions[i].0;
        let film =
            self.stencil.lists.of(i).iter().map(|&j| (self.stencil.areas[j as usize], self.positions[j as usize].0));
        let wall_area = self.spacing * self.spacing;
        let wall = self.stencil.wall_lists.of(i).iter().map(|&j| (wall_area, self.wall[j as usize].0));
        let push: DVec3 = film
            .chain(wall)
            .map(|(a, other)| (a, x - other))
            .map(|(a, d)| d * (a * kernel.slope_over_distance(d.length_squared())))
            .sum();
        tangential(push, self.normals[i].0) * (FICK * kernel.support * kernel.support)
    }
}

/// Moves every carrier by its displacement, along the film's own quartic; where there are too few neighbours for one
/// (at corners), along its quadratic.
pub fn lift(
    stencil: &Stencil,
    spacing: f64,
    positions: &mut [Position],
    normals: &[Normal],
    shapes: &[ShapeOperator],
    moves: &[DVec3],
) {
    let before: &[Position] = positions;
    let moved: Vec<Position> = (0..moves.len())
        .into_par_iter()
        .with_min_len(128)
        .map(|i| {
            let (x, n, d) = (before[i].0, normals[i].0, moves[i]);
            let offsets = || stencil.lists.of(i).iter().map(|&j| before[j as usize].0 - x);
            let height = height_along(n, LIFT_SUPPORT * spacing, offsets, d);
            Position(x + d + n * height.unwrap_or_else(|| -0.5 * (shapes[i].0 * d).dot(d)))
        })
        .collect();
    positions.copy_from_slice(&moved);
}

/// Relative standard deviation of the areas.
#[must_use]
pub fn unevenness(excess: &[f64]) -> f64 {
    (ordered_sum(excess.len(), 0.0, |i| excess[i] * excess[i]) / excess.len().max(1) as f64).sqrt()
}

#[cfg(test)]
#[path = "redistribution_tests.rs"]
mod tests;
