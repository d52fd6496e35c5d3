//! Moments about a cell's middle, local coefficients, and the ways between them.
//!
//! With the middles `c` of a target cell and `z` of a source cell, `u = x - c`, `v = y - z`, and the kernel's derivatives `D` at
//! `c - z`:
//!
//! ```text
//! k(x - y) ≈ Σ D_{β+γ} u^β/β! (-v)^γ/γ!                  over |β| + |γ| ≤ p
//! moments  M_γ = Σ G (-v)^γ/γ!        local  L_β = Σ M_γ D_{β+γ}        potential  Σ L_β u^β/β!
//! ```
//!
//! The same sum serves both ways, so the matrix from strengths to potentials stays symmetric, and the gradient of the local
//! polynomial is the gradient of the approximate energy. Coefficients stand power by power, three components each.

use std::ops::Range;

use glam::DVec3;
use pulp::{Simd, WithSimd};

use super::taylor::Taylor;
use super::tree::Cell;
use crate::blocks::{Block, BlockSums};
use crate::inner_loops::{self as lanes, Coefficients, Vectors};
use crate::sheet_kernel::Series;

/// Moments of a leaf's panels.
pub(super) struct LeafMoments<'a> {
    pub(super) taylor: &'a Taylor,
    pub(super) centre: DVec3,
    pub(super) blocks: &'a [Block],
    pub(super) moments: &'a mut [f64],
}

impl WithSimd for LeafMoments<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let mut powers = vec![simd.splat_f64s(0.0); self.taylor.count];
        let mut sums = vec![simd.splat_f64s(0.0); self.moments.len()];
        let centre = lanes::splat(simd, self.centre.to_array());
        for block in self.blocks {
            for part in lanes::parts::<S>() {
                let v = lanes::minus(simd, centre, lanes::load::<S>(&block.centres, part));
                monomials(simd, self.taylor, v, &mut powers);
                let strength = lanes::load::<S>(&block.strengths, part);
                for (sum, power) in sums.as_chunks_mut::<3>().0.iter_mut().zip(&powers) {
                    *sum = lanes::plus(simd, *power, strength, *sum);
                }
            }
        }
        for (moment, sum) in self.moments.iter_mut().zip(sums) {
            *moment = simd.reduce_sum_f64s(sum);
        }
    }
}

/// `v^β/β!` in every lane.
#[inline(always)]
fn monomials<S: Simd>(simd: S, taylor: &Taylor, v: Vectors<S>, out: &mut [S::f64s]) {
    out[0] = simd.splat_f64s(1.0);
    for (i, growth) in taylor.growth.iter().enumerate() {
        let scaled = simd.mul_f64s(v[growth.axis as usize], simd.splat_f64s(growth.scale));
        out[i + 1] = simd.mul_f64s(out[growth.parent as usize], scaled);
    }
}

/// What is read off a local expansion beside the potential.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Slope {
    /// Nothing.
    None,
    /// `Σ (G·G_g) ∇k`.
    Gradient,
    /// The curl: `Σ G_g × d k_u`.
    Curl,
}

/// Adds a leaf's local expansion to the sums at its points.
pub(super) struct Evaluate<'a> {
    pub(super) taylor: &'a Taylor,
    pub(super) slope: Slope,
    pub(super) centre: DVec3,
    pub(super) locals: &'a [f64],
    pub(super) blocks: &'a [Block],
    pub(super) sums: &'a mut [BlockSums],
}

impl WithSimd for Evaluate<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let mut powers = vec![simd.splat_f64s(0.0); self.taylor.count];
        let mut along = powers.clone();
        let (centre, locals) = (lanes::splat(simd, self.centre.to_array()), self.locals.as_chunks::<3>().0);
        for (block, sums) in self.blocks.iter().zip(self.sums) {
            for part in lanes::parts::<S>() {
                let u = lanes::minus(simd, lanes::load::<S>(&block.centres, part), centre);
                monomials(simd, self.taylor, u, &mut powers);
                let mut potential = lanes::load::<S>(&sums.potentials, part);
                for (local, power) in locals.iter().zip(&powers) {
                    potential = lanes::plus(simd, *power, lanes::splat(simd, *local), potential);
                }
                lanes::store::<S>(&mut sums.potentials, part, potential);
                let slope = match self.slope {
                    Slope::None => continue,
                    Slope::Gradient => {
                        let strength = lanes::load::<S>(&block.strengths, part);
                        for (along, local) in along.iter_mut().zip(locals) {
                            *along = lanes::dot(simd, strength, lanes::splat(simd, *local));
                        }
                        gradient(simd, self.taylor, &along, &powers)
                    }
                    Slope::Curl => curl(simd, self.taylor, locals, &powers),
                };
                let sum = lanes::load::<S>(&sums.gradients, part);
                lanes::store::<S>(&mut sums.gradients, part, lanes::plus(simd, powers[0], slope, sum));
            }
        }
    }
}

/// Gradient of `Σ a_β u^β/β!`.
#[inline(always)]
fn gradient<S: Simd>(simd: S, taylor: &Taylor, along: &[S::f64s], powers: &[S::f64s]) -> Vectors<S> {
    let mut sum = [simd.splat_f64s(0.0); 3];
    for (raised, power) in taylor.raised.iter().zip(powers) {
        sum = lanes::plus(
            simd,
            *power,
            [along[raised[0] as usize], along[raised[1] as usize], along[raised[2] as usize]],
            sum,
        );
    }
    sum
}

/// Curl of `Σ L_β u^β/β!`.
#[inline(always)]
fn curl<S: Simd>(simd: S, taylor: &Taylor, locals: &[[f64; 3]], powers: &[S::f64s]) -> Vectors<S> {
    let mut sum = [simd.splat_f64s(0.0); 3];
    for (raised, power) in taylor.raised.iter().zip(powers) {
        let [x, y, z] = [locals[raised[0] as usize], locals[raised[1] as usize], locals[raised[2] as usize]];
        let curl = [y[2] - z[1], z[0] - x[2], x[1] - y[0]];
        sum = lanes::plus(simd, *power, lanes::splat(simd, curl), sum);
    }
    sum
}

/// Adds a child's moments to its parent's; `offset` leads from the child's middle to the parent's.
pub(super) fn raise_moments(taylor: &Taylor, offset: DVec3, child: &[f64], parent: &mut [f64], powers: &mut Vec<f64>) {
    taylor.monomials(offset.to_array(), powers);
    let (child, parent) = (child.as_chunks::<3>().0, parent.as_chunks_mut::<3>().0);
    for (a, moment) in child.iter().enumerate() {
        for (product, power) in taylor.products(a).iter().zip(&*powers) {
            (0..3).for_each(|axis| parent[*product as usize][axis] += moment[axis] * power);
        }
    }
}

/// Adds a parent's local coefficients to a child's; `offset` leads from the parent's middle to the child's.
pub(super) fn lower_locals(taylor: &Taylor, offset: DVec3, parent: &[f64], child: &mut [f64], powers: &mut Vec<f64>) {
    taylor.monomials(offset.to_array(), powers);
    let (child, parent) = (child.as_chunks_mut::<3>().0, parent.as_chunks::<3>().0);
    for (a, local) in child.iter_mut().enumerate() {
        for (product, power) in taylor.products(a).iter().zip(&*powers) {
            (0..3).for_each(|axis| local[axis] += parent[*product as usize][axis] * power);
        }
    }
}

/// Cells whose moments act on others.
pub(super) struct Sources<'a> {
    pub(super) taylor: &'a Taylor,
    pub(super) series: &'a Series,
    pub(super) cells: &'a [Cell],
    pub(super) moments: &'a [f64],
}

/// Local coefficients of some cells from the moments of all cells far from them.
pub(super) struct Translate<'a, F> {
    pub(super) from: &'a Sources<'a>,
    /// Target cells that are worked on, and their middles.
    pub(super) targets: Range<usize>,
    pub(super) cells: &'a [Cell],
    /// Sources of a target.
    pub(super) sources_of: F,
    /// Coefficients of the targets; written.
    pub(super) locals: &'a mut [f64],
}

/// Numbers in vector registers, reused from cell to cell.
struct Scratch<S: Simd> {
    derivatives: Vec<S::f64s>,
    moments: Vec<S::f64s>,
    locals: Vec<S::f64s>,
}

impl<'a, F: Fn(usize) -> &'a [u32]> WithSimd for Translate<'a, F> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let zero = simd.splat_f64s(0.0);
        let (kernel, size) = (Coefficients::new(simd, self.from.series), 3 * self.from.taylor.count);
        let mut scratch = Scratch::<S> {
            derivatives: vec![zero; self.from.taylor.scratch],
            moments: vec![zero; size],
            locals: vec![zero; size],
        };
        for (target, locals) in self.targets.zip(self.locals.chunks_exact_mut(size)) {
            scratch.locals.fill(zero);
            for sources in (self.sources_of)(target).chunks(S::F64_LANES) {
                self.from.act_on(simd, &kernel, self.cells[target].centre, sources, &mut scratch);
            }
            for (local, sum) in locals.iter_mut().zip(&scratch.locals) {
                *local = simd.reduce_sum_f64s(*sum);
            }
        }
    }
}

impl Sources<'_> {
    /// A vector of sources, one per lane, on one target; missing ones have no moments.
    #[inline(always)]
    fn act_on<S: Simd>(
        &self,
        simd: S,
        kernel: &Coefficients<S>,
        target: DVec3,
        sources: &[u32],
        scratch: &mut Scratch<S>,
    ) {
        let mut d = [simd.splat_f64s(1.0); 3];
        let size = 3 * self.taylor.count;
        if sources.len() < S::F64_LANES {
            scratch.moments.fill(simd.splat_f64s(0.0));
        }
        let gathered: &mut [f64] = pulp::bytemuck::cast_slice_mut(&mut scratch.moments);
        for (lane, source) in sources.iter().enumerate() {
            let source = *source as usize;
            let offset = (target - self.cells[source].centre).to_array();
            for axis in 0..3 {
                pulp::bytemuck::cast_slice_mut::<S::f64s, f64>(&mut d[axis..=axis])[lane] = offset[axis];
            }
            let moments = &self.moments[source * size..(source + 1) * size];
            for (row, moment) in gathered.chunks_exact_mut(S::F64_LANES).zip(moments) {
                row[lane] = *moment;
            }
        }
        self.derivatives(simd, kernel, d, &mut scratch.derivatives);
        self.contract(simd, scratch);
    }

    /// All derivatives of the kernel up to the order, at the front of `out`.
    #[inline(always)]
    fn derivatives<S: Simd>(&self, simd: S, kernel: &Coefficients<S>, d: Vectors<S>, out: &mut [S::f64s]) {
        kernel.radial_derivatives(simd, kernel.roots(simd, d), &self.taylor.levels, out);
        for step in &self.taylor.derivations {
            let lower = simd.mul_f64s(simd.splat_f64s(step.factor), out[step.lower as usize]);
            out[step.to as usize] = simd.mul_add_e_f64s(d[step.axis as usize], out[step.from as usize], lower);
        }
    }

    /// `L_β += Σ M_γ D_{β+γ}`.
    #[inline(always)]
    fn contract<S: Simd>(&self, simd: S, scratch: &mut Scratch<S>) {
        let (moments, derivatives) = (scratch.moments.as_chunks::<3>().0, &scratch.derivatives);
        for (b, local) in scratch.locals.as_chunks_mut::<3>().0.iter_mut().enumerate() {
            for (moment, product) in moments.iter().zip(self.taylor.products(b)) {
                *local = lanes::plus(simd, derivatives[*product as usize], *moment, *local);
            }
        }
    }
}
