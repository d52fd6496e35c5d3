//! Which order and opening angle keep a bound on the error.
//!
//! Measured, not derived. The error counts in normal velocities from fluxes (the differences of potentials round vertices, which
//! is where the jumps between cells show), root mean square over that of the velocities. On spheres, discs, cubes, double bubbles
//! and foams, with smooth and with random strengths, and on small bubbles beside large ones, it is below `c_p θ^(p + 3/2)` for
//! the order p and opening angle θ at a resolution of [`MEASURED_RESOLUTION`], and grows no faster than the resolution: jumps
//! stay, edges shorten. A foam's error is the largest, a sphere's half of that.
//!
//! Potentials are better by a factor of 3 to 20, energy gradients about as good as velocities.

use crate::error::PairSumError;

/// Highest order of expansions.
pub(super) const HIGHEST_ORDER: usize = 8;

/// Relative error over `θ^(p + 3/2)`, for orders from [`LOWEST_ORDER`] on, of a foam at [`MEASURED_RESOLUTION`].
const ERROR_FACTORS: [f64; 5] = [0.097, 0.049, 0.029, 0.0184, 0.0121];

/// First order that pays; beyond the last, expansions outgrow the first cache.
const LOWEST_ORDER: usize = 3;

/// Radius of the whole over that of small leaves that errors were measured with (a foam of 33 750 panels, rounded down).
const MEASURED_RESOLUTION: f64 = 12.0;

/// What errors are multiplied by before they are held against the bound.
const HEADROOM: f64 = 1.5;

/// Opening angle below which the next order is cheaper.
const SMALLEST_OPENING: f64 = 0.42;

/// Largest opening angle: beyond, errors follow no power.
const LARGEST_OPENING: f64 = 0.7;

/// Bounds that are kept.
const TIGHTEST: f64 = 1e-6;
const LOOSEST: f64 = 0.1;

/// How finely the fast sum expands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Accuracy {
    /// Order of the expansions, 1 to 8.
    pub order: usize,
    /// Opening angle θ: cells expand when the sum of their radii is below θ times their distance. Between 0 and 1.
    pub opening: f64,
}

impl Accuracy {
    /// The cheapest for a bound on the relative error of normal velocities, for a resolution (radius of the whole over that of
    /// small leaves, dimensionless).
    pub(super) fn for_tolerance(tolerance: f64, resolution: f64) -> Self {
        let growth = (resolution / MEASURED_RESOLUTION).clamp(0.5, 1e3);
        let error = tolerance / (HEADROOM * growth);
        let choices = ERROR_FACTORS.iter().zip(LOWEST_ORDER..).map(|(factor, order)| {
            let opening = (error / factor).powf(1.0 / (order as f64 + 1.5));
            Self { order, opening: opening.min(LARGEST_OPENING) }
        });
        let finest = choices.clone().last();
        let wide = choices.clone().find(|choice| choice.opening >= SMALLEST_OPENING);
        wide.or(finest).expect("invariant: there are orders to choose from")
    }

    pub(crate) fn check(self) -> Result<(), PairSumError> {
        let sound = (1..=HIGHEST_ORDER).contains(&self.order) && self.opening > 0.0 && self.opening < 1.0;
        if sound { Ok(()) } else { Err(PairSumError::Accuracy { given: self, highest: HIGHEST_ORDER }) }
    }
}

/// Panels from which on the fast sum is cheaper than the direct one, placing included: 1000 at 1e-2, 1600 at 1e-3, 6300 at 1e-6,
/// measured on spheres.
pub(crate) fn break_even(tolerance: f64) -> usize {
    (400.0 * tolerance.powf(-0.2)) as usize
}

/// Whether a bound is one that the fast sum keeps.
pub(crate) fn check_tolerance(given: f64) -> Result<(), PairSumError> {
    if (TIGHTEST..=LOOSEST).contains(&given) {
        Ok(())
    } else {
        Err(PairSumError::Tolerance { given, tightest: TIGHTEST, loosest: LOOSEST })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_chosen_keeps_the_bound_as_measured() {
        for exponent in 2..=12 {
            for resolution in [1.0, 12.0, 200.0] {
                let tolerance = 10f64.powf(-0.5 * f64::from(exponent));
                let choice = Accuracy::for_tolerance(tolerance, resolution);
                let factor =
                    ERROR_FACTORS[choice.order - LOWEST_ORDER] * choice.opening.powf(choice.order as f64 + 1.5);
                assert!(choice.check().is_ok() && factor * resolution / MEASURED_RESOLUTION < 0.7 * tolerance);
            }
        }
    }

    #[test]
    fn bounds_out_of_range_are_refused() {
        for tolerance in [0.0, -1.0, 1e-9, 0.5, f64::NAN] {
            assert!(matches!(check_tolerance(tolerance), Err(PairSumError::Tolerance { .. })));
        }
        for (order, opening) in [(0, 0.5), (9, 0.5), (4, 0.0), (4, 1.0), (4, f64::NAN)] {
            assert!(matches!(Accuracy { order, opening }.check(), Err(PairSumError::Accuracy { .. })));
        }
    }
}
