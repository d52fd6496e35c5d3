//! One panel against blocks of panels: the inner loops of every sum, in vector instructions chosen at run time.
//!
//! `1/√s` is a guess from the exponent's bits, mended by two polynomial steps, relative error below 2e-15: a sum of potentials
//! takes half the time it would with a square root and a division. With `y = s^-1/2` and `t = y²` (lengths in α) the kernels are `y (1 + p₁ t + p₂ t²)` and
//! `y t (1 + q₁ t + q₂ t²)`.
//!
//! Components are written out: a closure is a function of its own, compiled without the vector instructions, and costs a call
//! wherever it is not inlined (`array::map` is one such place).

use glam::DVec3;
use pulp::Simd;

use crate::blocks::{Block, BlockSums, LANES, Triple};
use crate::sheet_kernel::Series;

/// A vector in each lane.
pub(crate) type Vectors<S> = [<S as Simd>::f64s; 3];

/// The kernel's coefficients in every lane.
pub(crate) struct Coefficients<S: Simd> {
    one: S::f64s,
    potential: [S::f64s; 2],
    velocity: [S::f64s; 2],
    mend: [S::f64s; 3],
}

/// Taylor coefficients of `(1 - h)^-1/2` beyond 1.
const MEND: [f64; 3] = [0.5, 0.375, 0.3125];

/// Upper half of the bits of the number from which half of `s`'s are subtracted for a first guess of `1/√s`.
const GUESS: u32 = 0x5fe6_eb50;

impl<S: Simd> Coefficients<S> {
    #[inline(always)]
    pub(crate) fn new(simd: S, series: &Series) -> Self {
        Self {
            one: simd.splat_f64s(1.0),
            potential: [simd.splat_f64s(series.potential[0]), simd.splat_f64s(series.potential[1])],
            velocity: [simd.splat_f64s(series.velocity[0]), simd.splat_f64s(series.velocity[1])],
            mend: [simd.splat_f64s(MEND[0]), simd.splat_f64s(MEND[1]), simd.splat_f64s(MEND[2])],
        }
    }

    /// `s^-1/2` in every lane, `s` positive and normal.
    #[inline(always)]
    fn inverse_root(&self, simd: S, s: S::f64s) -> S::f64s {
        if S::F64_LANES == 1 {
            return simd.div_f64s(self.one, simd.sqrt_f64s(s));
        }
        let y = guess_inverse_root(simd, s);
        // The guess is within 3.5 %, the first step within 6e-6, the second within 1e-15.
        let h = simd.negate_mul_add_e_f64s(simd.mul_f64s(s, y), y, self.one);
        let c = simd.mul_add_e_f64s(simd.mul_add_e_f64s(self.mend[2], h, self.mend[1]), h, self.mend[0]);
        let y = simd.mul_add_e_f64s(simd.mul_f64s(y, h), c, y);
        let h = simd.negate_mul_add_e_f64s(simd.mul_f64s(s, y), y, self.one);
        let c = simd.mul_add_e_f64s(self.mend[1], h, self.mend[0]);
        simd.mul_add_e_f64s(simd.mul_f64s(y, h), c, y)
    }

    /// Inverse root `y` of `|d|² + 1`, and its square.
    #[inline(always)]
    pub(crate) fn roots(&self, simd: S, d: Vectors<S>) -> (S::f64s, S::f64s) {
        let s = simd.mul_add_e_f64s(d[0], d[0], self.one);
        let s = simd.mul_add_e_f64s(d[2], d[2], simd.mul_add_e_f64s(d[1], d[1], s));
        let y = self.inverse_root(simd, s);
        (y, simd.mul_f64s(y, y))
    }

    /// `(2 d/ds)ⁿ` of the potential kernel, for each n at its place.
    #[inline(always)]
    pub(crate) fn radial_derivatives(
        &self,
        simd: S,
        (y, t): (S::f64s, S::f64s),
        places: &[usize],
        out: &mut [S::f64s],
    ) {
        let mut series = [self.one, self.potential[0], self.potential[1]];
        let mut power = y;
        for (n, place) in places.iter().enumerate() {
            let [c0, c1, c2] = series;
            let sum = simd.mul_add_e_f64s(simd.mul_add_e_f64s(c2, t, c1), t, c0);
            out[*place] = simd.mul_f64s(power, sum);
            power = simd.mul_f64s(power, t);
            for (q, c) in series.iter_mut().enumerate() {
                // 2 d/ds s^-(1 + 2q + 2n)/2 = -(1 + 2q + 2n) s^-(3 + 2q + 2n)/2.
                *c = simd.mul_f64s(*c, simd.splat_f64s(-((1 + 2 * q + 2 * n) as f64)));
            }
        }
    }

    #[inline(always)]
    fn potential(&self, simd: S, (y, t): (S::f64s, S::f64s)) -> S::f64s {
        let [p1, p2] = self.potential;
        simd.mul_f64s(y, simd.mul_add_e_f64s(simd.mul_add_e_f64s(p2, t, p1), t, self.one))
    }

    #[inline(always)]
    fn velocity(&self, simd: S, (y, t): (S::f64s, S::f64s)) -> S::f64s {
        let [q1, q2] = self.velocity;
        let series = simd.mul_add_e_f64s(simd.mul_add_e_f64s(q2, t, q1), t, self.one);
        simd.mul_f64s(simd.mul_f64s(y, t), series)
    }
}

/// Within 3.5 % of `1/√s`. The lower halves of the bits come out as noise, far below that.
#[inline(always)]
fn guess_inverse_root<S: Simd>(simd: S, s: S::f64s) -> S::f64s {
    let bits: S::u32s = pulp::bytemuck::cast(s);
    let half = simd.wrapping_dyn_shr_u32s(bits, simd.splat_u32s(1));
    pulp::bytemuck::cast(simd.sub_u32s(simd.splat_u32s(GUESS), half))
}

/// The numbers of a block that one vector register holds.
#[inline(always)]
pub(crate) fn load<S: Simd>(triple: &Triple, part: usize) -> Vectors<S> {
    [
        S::as_simd_f64s(&triple[0].0).0[part],
        S::as_simd_f64s(&triple[1].0).0[part],
        S::as_simd_f64s(&triple[2].0).0[part],
    ]
}

#[inline(always)]
pub(crate) fn store<S: Simd>(triple: &mut Triple, part: usize, vectors: Vectors<S>) {
    for (lanes, x) in triple.iter_mut().zip(vectors) {
        S::as_mut_simd_f64s(&mut lanes.0).0[part] = x;
    }
}

/// Vector registers per block.
#[inline(always)]
pub(crate) fn parts<S: Simd>() -> std::ops::Range<usize> {
    0..LANES / S::F64_LANES
}

#[inline(always)]
pub(crate) fn splat<S: Simd>(simd: S, v: [f64; 3]) -> Vectors<S> {
    [simd.splat_f64s(v[0]), simd.splat_f64s(v[1]), simd.splat_f64s(v[2])]
}

#[inline(always)]
pub(crate) fn minus<S: Simd>(simd: S, a: Vectors<S>, b: Vectors<S>) -> Vectors<S> {
    [simd.sub_f64s(a[0], b[0]), simd.sub_f64s(a[1], b[1]), simd.sub_f64s(a[2], b[2])]
}

#[inline(always)]
pub(crate) fn dot<S: Simd>(simd: S, a: Vectors<S>, b: Vectors<S>) -> S::f64s {
    let first = simd.mul_f64s(a[0], b[0]);
    simd.mul_add_e_f64s(a[2], b[2], simd.mul_add_e_f64s(a[1], b[1], first))
}

/// `sum + w v`.
#[inline(always)]
pub(crate) fn plus<S: Simd>(simd: S, w: S::f64s, v: Vectors<S>, sum: Vectors<S>) -> Vectors<S> {
    [simd.mul_add_e_f64s(w, v[0], sum[0]), simd.mul_add_e_f64s(w, v[1], sum[1]), simd.mul_add_e_f64s(w, v[2], sum[2])]
}

/// `sum - w v`.
#[inline(always)]
fn less<S: Simd>(simd: S, w: S::f64s, v: Vectors<S>, sum: Vectors<S>) -> Vectors<S> {
    [
        simd.negate_mul_add_e_f64s(w, v[0], sum[0]),
        simd.negate_mul_add_e_f64s(w, v[1], sum[1]),
        simd.negate_mul_add_e_f64s(w, v[2], sum[2]),
    ]
}

/// `a × b`.
#[inline(always)]
fn cross<S: Simd>(simd: S, a: Vectors<S>, b: Vectors<S>) -> Vectors<S> {
    [
        simd.negate_mul_add_e_f64s(a[2], b[1], simd.mul_f64s(a[1], b[2])),
        simd.negate_mul_add_e_f64s(a[0], b[2], simd.mul_f64s(a[2], b[0])),
        simd.negate_mul_add_e_f64s(a[1], b[0], simd.mul_f64s(a[0], b[1])),
    ]
}

/// Sum over lanes.
#[inline(always)]
fn reduce<S: Simd>(simd: S, v: Vectors<S>) -> DVec3 {
    DVec3::new(simd.reduce_sum_f64s(v[0]), simd.reduce_sum_f64s(v[1]), simd.reduce_sum_f64s(v[2]))
}

/// One panel, and its sums so far lane by lane.
pub(crate) struct Row<S: Simd> {
    centre: Vectors<S>,
    strength: Vectors<S>,
    potential: Vectors<S>,
    gradient: Vectors<S>,
}

impl<S: Simd> Row<S> {
    /// A panel, or a place in space (which has no strength).
    #[inline(always)]
    pub(crate) fn new(simd: S, centre: DVec3, strength: DVec3) -> Self {
        let zero = splat(simd, [0.0; 3]);
        Self {
            centre: splat(simd, centre.to_array()),
            strength: splat(simd, strength.to_array()),
            potential: zero,
            gradient: zero,
        }
    }

    /// Sums over lanes: `Σ G k`, and `Σ (G·G_g) ∇k` or whatever was gathered in its place.
    #[inline(always)]
    pub(crate) fn sums(&self, simd: S) -> [DVec3; 2] {
        [reduce(simd, self.potential), reduce(simd, self.gradient)]
    }

    /// The panel and others act on each other. Blocks must not hold the panel itself.
    #[inline(always)]
    pub(crate) fn exchange<const GRADIENT: bool>(
        &mut self,
        simd: S,
        kernel: &Coefficients<S>,
        blocks: &[Block],
        sums: &mut [BlockSums],
    ) {
        for (block, sums) in blocks.iter().zip(sums) {
            for part in parts::<S>() {
                let strength = load::<S>(&block.strengths, part);
                let d = minus(simd, self.centre, load::<S>(&block.centres, part));
                let roots = kernel.roots(simd, d);
                let k = kernel.potential(simd, roots);
                self.potential = plus(simd, k, strength, self.potential);
                let theirs = plus(simd, k, self.strength, load::<S>(&sums.potentials, part));
                store::<S>(&mut sums.potentials, part, theirs);
                if GRADIENT {
                    let w = simd.mul_f64s(dot(simd, self.strength, strength), kernel.velocity(simd, roots));
                    self.gradient = less(simd, w, d, self.gradient);
                    let theirs = plus(simd, w, d, load::<S>(&sums.gradients, part));
                    store::<S>(&mut sums.gradients, part, theirs);
                }
            }
        }
    }

    /// Others act on the panel (which may be among them).
    #[inline(always)]
    pub(crate) fn gather<const GRADIENT: bool>(&mut self, simd: S, kernel: &Coefficients<S>, blocks: &[Block]) {
        for block in blocks {
            for part in parts::<S>() {
                let strength = load::<S>(&block.strengths, part);
                let d = minus(simd, self.centre, load::<S>(&block.centres, part));
                let roots = kernel.roots(simd, d);
                self.potential = plus(simd, kernel.potential(simd, roots), strength, self.potential);
                if GRADIENT {
                    let w = simd.mul_f64s(dot(simd, self.strength, strength), kernel.velocity(simd, roots));
                    self.gradient = less(simd, w, d, self.gradient);
                }
            }
        }
    }

    /// Velocity `Σ G × d k_u` that panels make at the row's place, gathered as its gradient.
    #[inline(always)]
    pub(crate) fn gather_velocity(&mut self, simd: S, kernel: &Coefficients<S>, blocks: &[Block]) {
        for block in blocks {
            for part in parts::<S>() {
                let strength = load::<S>(&block.strengths, part);
                let d = minus(simd, self.centre, load::<S>(&block.centres, part));
                let k = kernel.velocity(simd, kernel.roots(simd, d));
                self.gradient = plus(simd, k, cross(simd, strength, d), self.gradient);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::instructions::{Instructions, dispatch};
    use crate::sheet_kernel::KernelOrder;
    use pulp::WithSimd;

    /// Largest relative error of `1/√s` over numbers of every size.
    struct InverseRootError;

    impl WithSimd for InverseRootError {
        type Output = f64;

        fn with_simd<S: Simd>(self, simd: S) -> f64 {
            let kernel = Coefficients::new(simd, &KernelOrder::Third.series());
            let numbers =
                (0..400_000).map(|i| 1.0 + f64::from(i) * 1e-5).chain((0..900).map(|i| 1.37 * 1.5f64.powi(i)));
            numbers
                .map(|s| {
                    let found = simd.reduce_max_f64s(kernel.inverse_root(simd, simd.splat_f64s(s)));
                    (found * s.sqrt() - 1.0).abs()
                })
                .fold(0.0, f64::max)
        }
    }

    #[test]
    fn inverse_roots_are_good_to_the_last_digits() {
        for instructions in [Instructions::Widest, Instructions::Scalar] {
            let error = dispatch(instructions, InverseRootError);
            assert!(error < 2e-15, "{instructions:?}: {error}");
        }
    }
}
