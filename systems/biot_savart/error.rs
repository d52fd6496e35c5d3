//! What can be wrong with a pair sum's input.

use thiserror::Error;

use crate::fast::accuracy::Accuracy;

/// Input that [`PairSum`](crate::PairSum) refuses.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum PairSumError {
    /// The smoothing length is zero, negative or not finite: a panel's own potential would be infinite.
    #[error("the smoothing length must be positive and finite, not {given} m: take about 0.75 of the edge length")]
    SmoothingLength {
        /// The length given, metres.
        given: f64,
    },
    /// The error bound of the fast sum lies outside the range that it was measured in.
    #[error(
        "the fast sum's error bound must lie between {tightest:e} and {loosest}, not {given}: for less error, sum directly"
    )]
    Tolerance {
        /// The bound given, dimensionless.
        given: f64,
        /// Smallest bound that the fast sum keeps.
        tightest: f64,
        /// Largest bound that makes sense.
        loosest: f64,
    },
    /// Expansions of this order or opening angle do not exist or do not converge.
    #[error("expansions need an order from 1 to {highest} and an opening angle between 0 and 1, not {} and {}", given.order, given.opening)]
    Accuracy {
        /// What was given.
        given: Accuracy,
        /// Highest order that there is.
        highest: usize,
    },
    /// There is not one strength per panel.
    #[error("{strengths} strengths for {panels} panels: place the panels again after a change of the mesh")]
    StrengthCount {
        /// Panels placed.
        panels: usize,
        /// Strengths given.
        strengths: usize,
    },
}
