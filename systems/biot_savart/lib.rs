//! Pair sums of vortex sheet panels: what every panel of a sheet does to every other.
//!
//! Given panels with centroids `c_f` and strengths `G_f` integrated over their areas (`n × ∇Γ` times area), with `d = x - c_g` and
//! kernels of `s = |d|² + α²` ([`SheetKernel`]):
//!
//! ```text
//! vector potential    A(x) = 1/(4π) Σ_g G_g k                 at panels or anywhere
//! velocity            u(x) = 1/(4π) Σ_g G_g × d k_u           anywhere: the curl of A
//! energy gradient     S_f  = 1/(4π) Σ_g (G_f·G_g) ∇k          at panels: the gradient of K/ρ = ½ Σ G_f·A_f
//! ```
//!
//! | question | where |
//! |---|---|
//! | which kernel | [`sheet_kernel`] |
//! | how do I sum | [`PairSum`], [`Summation`] |
//! | how far off is the fast sum | [`Accuracy`], [`PairSum::accuracy`] |
//! | which instructions, which bytes | [`Instructions`] |
//! | what can go wrong | [`PairSumError`] |
//!
//! The direct sum takes each pair once in vector instructions; the fast one lets distant groups exchange Taylor expansions of the
//! same kernel (a dual walk over one tree, after Dehnen 2002, J. Comput. Phys. 179) and near ones sum pair by pair. Both keep
//! what the method stands on: the matrix from strengths to potentials is symmetric, energy gradients add up to nothing, and
//! bytes are the same for any number of threads.
//!
//! Processor seconds of a sum on a sphere, error bound 1e-3, both potentials and gradients (in brackets potentials alone), on
//! 2.6 GHz cores with AVX-512, by `cargo run --release -p froth_biot_savart --example pair_sum_cost`:
//!
//! | panels | direct | place | fast | error of normal velocities |
//! |---|---|---|---|---|
//! | 1 280 | 0.0011 (0.0008) | 0.0002 | 0.0009 (0.0007) | 1.2e-4 |
//! | 5 120 | 0.016 (0.011) | 0.0009 | 0.0042 (0.0034) | 2.9e-4 |
//! | 20 480 | 0.24 (0.16) | 0.004 | 0.020 (0.015) | 4.4e-4 |
//! | 81 920 | 3.8 (2.5) | 0.019 | 0.098 (0.081) | 3.2e-4 |
//! | 327 680 | | 0.089 | 0.46 (0.38) | 3.0e-4 |
//! | 1 012 500 | | 0.4 | 1.8 (1.6) | 2.6e-4 |
//!
//! With AVX2 the direct sum over 20 480 panels takes 0.41 s, the fast one 0.028 s; without either, some six times as much.
//!
//! Limits: one smoothing length for all panels; an expansion's error bound is measured, not proven ([`Summation::Fast`]); places
//! far outside 1e100 smoothing lengths overflow.

mod blocks;
mod direct;
mod error;
mod fast;
mod inner_loops;
mod instructions;
mod pair_sum;
pub mod sheet_kernel;
mod targets;
mod tournament;

pub use error::PairSumError;
pub use fast::accuracy::Accuracy;
pub use instructions::Instructions;
pub use pair_sum::{PairSum, PanelSums, Summation};
pub use sheet_kernel::{KernelOrder, SheetKernel};
