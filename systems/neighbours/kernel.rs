//! The smoothing kernel: two-dimensional Wendland C2 on chord lengths.
//!
//! # Equation
//! `W(r) = 7/(pi h^2) (1 - r/h)^4 (1 + 4 r/h)` for `r < h`.
//!
//! # Discretisation
//! The argument is the straight (chord) distance in space. On a sphere the area within chord `r` is exactly
//! `pi r^2`, so the chord brings no curvature bias into a density.
//!
//! # Source
//! Wendland 1995; DEVIATION from Deng 2022, §4.8 (quintic spline): Wendland kernels do not pair particles.

use std::f64::consts::PI;

/// A kernel of support radius `h`, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Kernel {
    /// Support radius `h`, m.
    pub support: f64,
    inverse: f64,
    scale: f64,
}

impl Kernel {
    /// The kernel that vanishes beyond `support` metres.
    #[must_use]
    pub fn new(support: f64) -> Self {
        Self { support, inverse: 1.0 / support, scale: 7.0 / (PI * support * support) }
    }

    /// `W(r)` in 1/m^2, for the squared distance `r^2`.
    #[must_use]
    #[inline]
    pub fn value(&self, distance_squared: f64) -> f64 {
        self.value_at(distance_squared.sqrt())
    }

    /// `W(r)` in 1/m^2.
    #[must_use]
    #[inline]
    pub fn value_at(&self, distance: f64) -> f64 {
        let q = distance * self.inverse;
        let t = (1.0 - q).max(0.0);
        self.scale * (t * t) * (t * t) * (1.0 + 4.0 * q)
    }

    /// `g(r) = -W'(r)/r` in 1/m^4, for the squared distance `r^2`. Finite at `r = 0`.
    #[must_use]
    #[inline]
    pub fn slope_over_distance(&self, distance_squared: f64) -> f64 {
        self.slope_over_distance_at(distance_squared.sqrt())
    }

    /// `g(r) = -W'(r)/r` in 1/m^4. Finite at `r = 0`.
    #[must_use]
    #[inline]
    pub fn slope_over_distance_at(&self, distance: f64) -> f64 {
        let t = (1.0 - distance * self.inverse).max(0.0);
        20.0 * self.scale * self.inverse * self.inverse * t * t * t
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_kernel_integrates_to_one_over_the_plane() {
        let kernel = Kernel::new(0.3);
        let n = 20_000;
        let dr = 0.3 / f64::from(n);
        let integral: f64 =
            (0..n).map(|i| (f64::from(i) + 0.5) * dr).map(|r| 2.0 * PI * r * kernel.value(r * r) * dr).sum();
        assert!((integral - 1.0).abs() < 1e-7, "{integral}");
    }

    #[test]
    fn the_slope_is_the_derivative_of_the_value() {
        let kernel = Kernel::new(2.0);
        let (r, d) = (0.7_f64, 1e-6);
        let numeric = (kernel.value((r + d).powi(2)) - kernel.value((r - d).powi(2))) / (2.0 * d);
        assert!((kernel.slope_over_distance(r * r) + numeric / r).abs() < 1e-8);
    }
}
