//! Which vector instructions the inner loops are compiled for, chosen at run time.
//!
//! Sums differ in their last digits between instruction sets (other orders of addition, fused or separate roundings), and by
//! nothing at all between runs, thread counts or machines with the same one.

use pulp::{Scalar, Simd};

/// Which instructions the inner loops use.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Instructions {
    /// The widest vectors that this processor has (AVX-512, AVX2 with FMA, Neon), found at run time.
    #[default]
    Widest,
    /// One number at a time, with the processor's own square root and division: the reference.
    Scalar,
}

/// Runs an operation with the instructions asked for.
#[inline]
pub(crate) fn dispatch<Op: pulp::WithSimd>(instructions: Instructions, operation: Op) -> Op::Output {
    match instructions {
        Instructions::Widest => pulp::Arch::new().dispatch(operation),
        Instructions::Scalar => Scalar::new().vectorize(operation),
    }
}
