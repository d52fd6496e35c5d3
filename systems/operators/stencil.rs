//! Areas, symmetric pair weights, and the surface operators made from them.
//!
//! # Equation
//! Area: `a_i = C / sum_j W(r_ij)` over `4 dx`, self and boundary particles included.
//! Pair weights: `w_ij = a_i a_j g(r_ij) (c_i + c_j)/2`, `g = -W'/r` over `3 dx`, `c_i = 4 / sum_j a_j g r^2`.
//!
//! ```text
//! a_i (lap q)_i      = sum_j w_ij (q_j - q_i)                        symmetric, exact balance
//! a_i (div u)_i      = sum_j w_ij (u_i + u_j)/2 . (x_j - x_i)        flux form: sums to zero over the film
//! a_i (grad q)_i     = 1/2 sum_j w_ij (q_j - q_i) (x_j - x_i)        minus the adjoint of div
//! least squares grad = M_i^-1 sum_j w_ij (q_j - q_i) (x_j - x_i)_t   exact for linear fields, also at walls
//! ```
//!
//! # Source
//! Replaces Deng 2022, Eqs 9, 10 and 21. DEVIATION: the paper's kernel sums are neither symmetric nor exact for
//! linear fields; with these weights the curvature force of a closed film sums to zero to round-off, and the mean
//! curvature of a sphere is exact to 1e-4 for any point noise.
//!
//! # Limits
//! Without boundary particles in the sums (`lap`, `div`) a rim is a natural wall: no flux crosses it.

use super::tangent::{in_space, plane_inverse, plane_outer, tangential};
use crate::neighbours::cells::CellList;
use crate::neighbours::kernel::Kernel;
use crate::neighbours::lists::NeighbourLists;
use froth_components::identity::InRegion;
use froth_components::motion::{Normal, Position};
use glam::{DMat2, DMat3, DVec2, DVec3};
use rayon::prelude::*;

/// Support of the density kernel, in particle spacings.
pub const DENSITY_SUPPORT: f64 = 4.0;
/// Support of pair weights, in particle spacings.
pub const PAIR_SUPPORT: f64 = 3.0;
/// Support of quadratic fits, in particle spacings.
pub const FIT_SUPPORT: f64 = 2.5;
/// Width of cells, in particle spacings; half the widest search or less.
const CELL: f64 = 2.0;
/// `C`: what the density kernel's sum over a uniform triangular lattice, times the area per point, amounts to.
const LATTICE_CONSTANT: f64 = 1.001_25;
/// Particles whose normals differ by more than about 78 degrees belong to different sheets (Deng's program: 0.2).
pub const SAME_SHEET: f64 = 0.2;

/// The carriers of all films and the fixed particles beyond their rims.
#[derive(Clone, Copy)]
pub struct Points<'a> {
    /// Places of the carriers.
    pub positions: &'a [Position],
    /// Unit normals of the carriers.
    pub normals: &'a [Normal],
    /// Region of each carrier; only particles of one region are neighbours.
    pub regions: &'a [InRegion],
    /// Places of the boundary particles.
    pub wall: &'a [Position],
    /// Region of each boundary particle.
    pub wall_regions: &'a [InRegion],
    /// Particle spacing `dx`, m.
    pub spacing: f64,
}

/// Neighbours, areas and pair weights of all carriers; a pure function of [`Points`].
#[derive(Clone, Debug, Default)]
pub struct Stencil {
    /// Neighbours within `3 dx`.
    pub lists: NeighbourLists,
    /// `w_ij` beside `lists.indices`, dimensionless.
    pub weights: Vec<f64>,
    /// Area of each particle, m^2.
    pub areas: Vec<f64>,
    /// Boundary particles within `3 dx`; empty rows away from rims.
    pub wall_lists: NeighbourLists,
    /// `w` toward boundary particles, beside `wall_lists.indices`.
    pub wall_weights: Vec<f64>,
    /// `M_i^-1`: inverse of the tangential moment `sum_j w_ij t t^T`, 1/m^2.
    pub inverse_moments: Vec<DMat3>,
    /// Cells of the carriers, `2 dx` wide, for whoever looks them up by place.
    pub cells: CellList,
}

impl Stencil {
    /// Builds everything from the points.
    #[must_use]
    pub fn build(points: Points) -> Self {
        let mut stencil = Self::default();
        stencil.rebuild(points);
        stencil
    }

    /// As [`Stencil::build`], in place.
    pub fn rebuild(&mut self, points: Points) {
        let wall = CellList::build(points.wall, DENSITY_SUPPORT * points.spacing);
        self.find_cells(points.positions, points.spacing);
        self.find_neighbours(points, &wall);
        self.weigh(points);
    }

    /// Sorts the carriers into cells where they stand; for carriers that moved since the stencil was built.
    pub fn find_cells(&mut self, positions: &[Position], spacing: f64) {
        self.cells.rebuild(positions, CELL * spacing);
    }

    /// Finds pairs, their slopes, which stand in `weights` until [`Stencil::weigh`], and areas, in one search.
    fn find_neighbours(&mut self, points: Points, wall: &CellList) {
        let radius = PAIR_SUPPORT * points.spacing;
        let (pair, density) = (Kernel::new(radius), Kernel::new(DENSITY_SUPPORT * points.spacing));
        let Points { positions, normals, regions, .. } = points;
        let cells = &self.cells;
        (self.lists, self.weights, self.areas) =
            NeighbourLists::collect_beside(positions.len(), |i, found, slopes: &mut Vec<f64>| {
                let (place, normal, region) = (positions[i].0, normals[i].0, regions[i]);
                let mut sum = 0.0;
                cells.for_each_near(place, density.support, |j| {
                    let square = place.distance_squared(positions[j].0);
                    let is_near = square < density.support * density.support;
                    if !is_near || regions[j] != region || normal.dot(normals[j].0) <= SAME_SHEET {
                        return;
                    }
                    let distance = square.sqrt();
                    sum += density.value_at(distance);
                    if distance < radius && i != j {
                        found.push(j as u32);
                        slopes.push(pair.slope_over_distance_at(distance));
                    }
                });
                wall.for_each_near(place, density.support, |j| {
                    if points.wall_regions[j] == region {
                        sum += density.value(place.distance_squared(points.wall[j].0));
                    }
                });
                LATTICE_CONSTANT / sum
            });
        self.wall_lists =
            NeighbourLists::within(positions, points.wall, wall, radius, |i, j| regions[i] == points.wall_regions[j]);
    }

    fn weigh(&mut self, points: Points) {
        let wall_area = points.spacing * points.spacing;
        let kernel = Kernel::new(PAIR_SUPPORT * points.spacing);
        let slope = |d: DVec3| kernel.slope_over_distance(d.length_squared());
        let scales: Vec<f64> = (0..self.areas.len())
            .into_par_iter()
            .with_min_len(256)
            .map(|i| {
                let pairs = self.weighted_offsets(points.positions, i);
                let inner = pairs.map(|(j, slope, d)| self.areas[j] * slope * d.length_squared());
                let outer = self.wall_offsets(points, i).map(|(_, d)| wall_area * slope(d) * d.length_squared());
                4.0 / (inner.sum::<f64>() + outer.sum::<f64>())
            })
            .collect();
        let Self { lists, areas, weights, .. } = self;
        lists.pieces_mut(weights).into_par_iter().for_each(|(rows, weights)| {
            let start = lists.offsets[rows.start];
            for i in rows {
                let range = lists.range(i);
                for (weight, &j) in weights[range.start - start..range.end - start].iter_mut().zip(lists.of(i)) {
                    let j = j as usize;
                    *weight *= 0.5 * areas[i] * areas[j] * (scales[i] + scales[j]);
                }
            }
        });
        let wall_weight = |i: usize, d: DVec3| self.areas[i] * wall_area * slope(d) * scales[i];
        self.wall_weights =
            flat_rows(&self.wall_lists, |i| self.wall_offsets(points, i).map(move |(_, d)| wall_weight(i, d)));
        self.inverse_moments = self.invert_moments(points);
    }

    fn invert_moments(&self, points: Points) -> Vec<DMat3> {
        let inverse = |i: usize| {
            let tangents = points.normals[i].0.any_orthonormal_pair();
            let mut moment = DMat2::ZERO;
            for (_, w, d) in self.weighted_offsets(points.positions, i) {
                moment += plane_outer(w, DVec2::new(d.dot(tangents.0), d.dot(tangents.1)));
            }
            in_space(plane_inverse(moment), tangents.into())
        };
        (0..self.areas.len()).into_par_iter().with_min_len(256).map(inverse).collect()
    }

    fn wall_offsets<'a>(&'a self, points: Points<'a>, i: usize) -> impl Iterator<Item = (usize, DVec3)> + 'a {
        let x = points.positions[i].0;
        self.wall_lists.of(i).iter().map(move |&j| (j as usize, points.wall[j as usize].0 - x))
    }

    /// Number of carriers.
    #[must_use]
    pub fn len(&self) -> usize {
        self.areas.len()
    }

    /// Whether there are no carriers.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.areas.is_empty()
    }

    /// `(j, w_ij)` over the neighbours of `i`.
    #[inline]
    pub fn pairs(&self, i: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let range = self.lists.range(i);
        self.lists.indices[range.clone()].iter().map(|&j| j as usize).zip(self.weights[range].iter().copied())
    }

    /// `(j, w_ij, x_j - x_i)` over the neighbours of `i`.
    #[inline]
    pub fn weighted_offsets<'a>(
        &'a self,
        positions: &'a [Position],
        i: usize,
    ) -> impl Iterator<Item = (usize, f64, DVec3)> + 'a {
        let x = positions[i].0;
        self.pairs(i).map(move |(j, w)| (j, w, positions[j].0 - x))
    }

    /// `(w, x_wall - x_i)` over the boundary particles near `i`.
    #[inline]
    pub fn wall_pairs<'a>(
        &'a self,
        positions: &'a [Position],
        wall: &'a [Position],
        i: usize,
    ) -> impl Iterator<Item = (f64, DVec3)> + 'a {
        let range = self.wall_lists.range(i);
        let x = positions[i].0;
        let near = self.wall_lists.indices[range.clone()].iter();
        near.zip(&self.wall_weights[range]).map(move |(&j, &w)| (w, wall[j as usize].0 - x))
    }

    /// `a_i (lap q)_i`.
    #[must_use]
    #[inline]
    pub fn laplacian(&self, i: usize, q: impl Fn(usize) -> f64) -> f64 {
        let own = q(i);
        self.pairs(i).map(|(j, w)| w * (q(j) - own)).sum()
    }

    /// `a_i (div u)_i` of a tangential vector field, in flux form.
    #[must_use]
    #[inline]
    pub fn flux_divergence(&self, positions: &[Position], i: usize, u: impl Fn(usize) -> DVec3) -> f64 {
        let own = u(i);
        self.weighted_offsets(positions, i).map(|(j, w, d)| 0.5 * w * (own + u(j)).dot(d)).sum()
    }

    /// Least-squares tangential gradient of `q` at `i`; exact for linear fields, zero where the neighbours lie on a
    /// line.
    #[must_use]
    #[inline]
    pub fn gradient(&self, positions: &[Position], normals: &[Normal], i: usize, q: impl Fn(usize) -> f64) -> DVec3 {
        let own = q(i);
        let slope: DVec3 = self.weighted_offsets(positions, i).map(|(j, w, d)| d * (w * (q(j) - own))).sum();
        // The moments belong to the normals the stencil was built with, which may have turned since.
        tangential(self.inverse_moments[i] * slope, normals[i].0)
    }

    /// `a_i (grad q)_i` as minus the adjoint of [`Stencil::flux_divergence`]: with it, energy passes between flow and
    /// elasticity without loss.
    #[must_use]
    #[inline]
    pub fn adjoint_gradient(
        &self,
        positions: &[Position],
        normals: &[Normal],
        i: usize,
        q: impl Fn(usize) -> f64,
    ) -> DVec3 {
        let own = q(i);
        let slope: DVec3 = self.weighted_offsets(positions, i).map(|(j, w, d)| d * (0.5 * w * (q(j) - own))).sum();
        tangential(slope, normals[i].0)
    }
}

/// Concatenates, in order, what `row(i)` gives for every row of `lists`.
fn flat_rows<I>(lists: &NeighbourLists, row: impl Fn(usize) -> I + Sync) -> Vec<f64>
where
    I: Iterator<Item = f64>,
{
    let mut flat = vec![0.0; lists.indices.len()];
    lists.pieces_mut(&mut flat).into_par_iter().for_each(|(rows, piece)| {
        let values = rows.flat_map(&row);
        piece.iter_mut().zip(values).for_each(|(slot, value)| *slot = value);
    });
    flat
}

#[cfg(test)]
#[path = "stencil_tests.rs"]
mod tests;
