//! Smoothed kernels that keep a sheet's long waves: which function of distance stands for `1/r`.
//!
//! With `s = r² + α²`, the plain kernel `s^-1/2` damps a wave `k` on a flat sheet by `exp(-kα)`, an error of first order in the
//! smoothing length α. Adding multiples of `α² s^-3/2` and `α⁴ s^-5/2` multiplies that by `1 + kα` or `1 + kα + (kα)²/2`
//! (from the plane's Fourier transforms, `x = kα`: `s^-1/2 → 2π e^-x/k`, `s^-3/2 → 2π e^-x/α`, `s^-5/2 → 2π e^-x (1 + x)/(3α³)`).
//! Every symbol is positive: short waves are slowed, never driven.

use crate::error::PairSumError;

/// Order in α of the error that smoothing makes on long waves.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum KernelOrder {
    /// `s^-1/2`, symbol `exp(-x)`: the usual "vortex blob", for comparison with published work.
    First,
    /// `s^-1/2 + α² s^-3/2`, symbol `exp(-x) (1 + x)`.
    Second,
    /// `s^-1/2 + α²/2 s^-3/2 + 3/2 α⁴ s^-5/2`, symbol `exp(-x) (1 + x + x²/2)`.
    #[default]
    Third,
}

/// A smoothed `1/r` (potential) and with it a smoothed `1/r³` (velocity): `-∇` of the potential is the velocity kernel times the
/// distance vector.
///
/// Which α to take. Short ones let the lattice of panels show, an error of first order in the edge length whose factor falls as
/// `exp(-7.3 α/h)`; long ones smooth, an error of third order. Relative error of the normal velocity of waves of degree l on
/// spheres of 642, 2562, 10 242 and 40 962 vertices, third-order kernel, fluxes from potentials at centroids:
///
/// | α/h | l = 2 | l = 6 |
/// |---|---|---|
/// | 0.5 | +.025 +.015 +.0080 +.0041 | +.003 +.024 +.017 +.010 |
/// | 0.75 | -.0032 +.0016 +.0015 +.0009 | -.086 -.014 -.0002 +.0014 |
/// | 1 | -.013 -.0020 -.0001 +.0001 | -.138 -.029 -.0054 -.0008 |
/// | 1.25 | -.020 -.0036 -.0006 -.0001 | -.189 -.042 -.0081 -.0015 |
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SheetKernel {
    /// Order of the error.
    pub order: KernelOrder,
    /// Smoothing length `α`, metres; positive.
    pub smoothing_length: f64,
}

impl SheetKernel {
    /// The kernel of third order with smoothing length α (metres).
    #[must_use]
    pub fn third_order(smoothing_length: f64) -> Self {
        Self { order: KernelOrder::Third, smoothing_length }
    }

    /// Potential at the square of a distance (m²), 1/m.
    #[must_use]
    pub fn potential(&self, distance_squared: f64) -> f64 {
        let (root, t) = self.inverse_root(distance_squared);
        let [p1, p2] = self.order.series().potential;
        root * (1.0 + t * (p1 + t * p2))
    }

    /// Velocity kernel at the square of a distance (m²), 1/m³.
    #[must_use]
    pub fn velocity(&self, distance_squared: f64) -> f64 {
        let (root, t) = self.inverse_root(distance_squared);
        let [q1, q2] = self.order.series().velocity;
        root.powi(3) * (1.0 + t * (q1 + t * q2))
    }

    /// What is left of a wave of number `k` (1/m) on a flat sheet, dimensionless: 1 for long waves.
    #[must_use]
    pub fn symbol(&self, wave_number: f64) -> f64 {
        let x = wave_number * self.smoothing_length;
        let series = match self.order {
            KernelOrder::First => 1.0,
            KernelOrder::Second => 1.0 + x,
            KernelOrder::Third => 1.0 + x + 0.5 * x * x,
        };
        series * (-x).exp()
    }

    /// `s^-1/2` and `α²/s`.
    fn inverse_root(&self, distance_squared: f64) -> (f64, f64) {
        let a = self.smoothing_length.powi(2);
        let s = distance_squared + a;
        (1.0 / s.sqrt(), a / s)
    }

    pub(crate) fn check(&self) -> Result<(), PairSumError> {
        let given = self.smoothing_length;
        if given > 0.0 && given.is_finite() { Ok(()) } else { Err(PairSumError::SmoothingLength { given }) }
    }
}

/// Coefficients of powers of `t = α²/s`: potential `s^-1/2 (1 + p₁ t + p₂ t²)`, velocity `s^-3/2 (1 + q₁ t + q₂ t²)`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Series {
    pub(crate) potential: [f64; 2],
    pub(crate) velocity: [f64; 2],
}

impl KernelOrder {
    /// `-∇ s^-q/2 = q d s^-(q+2)/2`, hence `q₁ = 3 p₁`, `q₂ = 5 p₂`.
    pub(crate) fn series(self) -> Series {
        let [p1, p2] = match self {
            Self::First => [0.0, 0.0],
            Self::Second => [1.0, 0.0],
            Self::Third => [0.5, 1.5],
        };
        Series { potential: [p1, p2], velocity: [3.0 * p1, 5.0 * p2] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ORDERS: [KernelOrder; 3] = [KernelOrder::First, KernelOrder::Second, KernelOrder::Third];

    fn kernels() -> impl Iterator<Item = SheetKernel> {
        ORDERS.into_iter().map(|order| SheetKernel { order, smoothing_length: 0.7 })
    }

    #[test]
    fn the_velocity_kernel_is_the_potentials_slope() {
        for kernel in kernels() {
            for r in [0.05, 0.3, 0.7, 1.5, 6.0] {
                let h = 1e-4;
                let slope = (kernel.potential((r + h) * (r + h)) - kernel.potential((r - h) * (r - h))) / (2.0 * h);
                let expected = -r * kernel.velocity(r * r);
                // Central differences: error h²/6 times a third derivative of some hundred.
                assert!((slope - expected).abs() < 1e-6, "{kernel:?} at {r}: {slope} {expected}");
            }
        }
    }

    #[test]
    fn the_kernels_are_the_published_formulas() {
        let (alpha, r2): (f64, f64) = (0.7, 0.83);
        let (a, s) = (alpha * alpha, r2 + alpha * alpha);
        let close = |x: f64, y: f64| assert!((x - y).abs() < 1e-14 * y.abs(), "{x} {y}");
        let [first, second, third] = ORDERS.map(|order| SheetKernel { order, smoothing_length: alpha });
        close(first.potential(r2), s.powf(-0.5));
        close(first.velocity(r2), s.powf(-1.5));
        close(second.potential(r2), s.powf(-0.5) + a * s.powf(-1.5));
        close(second.velocity(r2), (r2 + 4.0 * a) * s.powf(-2.5));
        close(third.potential(r2), s.powf(-0.5) + 0.5 * a * s.powf(-1.5) + 1.5 * a * a * s.powf(-2.5));
        close(third.velocity(r2), s.powf(-1.5) + 1.5 * a * s.powf(-2.5) + 7.5 * a * a * s.powf(-3.5));
    }

    /// Fourier transform of the potential in the plane. The integral along the crests is in closed form; the one across them is
    /// summed by the trapezoidal rule, of a second difference that falls off fast enough and multiplies it by `2 - 2 cos κh`.
    fn plane_transform(kernel: &SheetKernel, wave_number: f64) -> f64 {
        let (h, step, reach) = (1.0 / wave_number, 0.05, 60.0);
        let line = |x: f64| line_integral(kernel, x);
        let count = (reach / step) as i32;
        let sum: f64 = (-count..=count)
            .map(|i| {
                let x = f64::from(i) * step;
                (2.0 * line(x) - line(x - h) - line(x + h)) * (wave_number * x).cos()
            })
            .sum();
        sum * step / (2.0 - 2.0 * (wave_number * h).cos())
    }

    /// `∫ k(x² + y²) dy`, up to a constant: `-ln s + p₁ 2 a/s + p₂ (4/3) a²/s²`.
    fn line_integral(kernel: &SheetKernel, x: f64) -> f64 {
        let (a, [p1, p2]) = (kernel.smoothing_length.powi(2), kernel.order.series().potential);
        let s = x * x + a;
        -s.ln() + 2.0 * p1 * a / s + 4.0 / 3.0 * p2 * (a / s).powi(2)
    }

    #[test]
    fn waves_on_a_flat_sheet_see_the_symbol() {
        for kernel in kernels() {
            for wave_number in [0.3, 1.0, 2.0] {
                let found = plane_transform(&kernel, wave_number) * wave_number / std::f64::consts::TAU;
                let expected = kernel.symbol(wave_number);
                // The truncated tail of the second difference is of order 1/reach² and oscillates.
                assert!((found - expected).abs() < 2e-3, "{kernel:?} at {wave_number}: {found} {expected}");
            }
        }
    }

    #[test]
    fn a_smoothing_length_must_be_positive() {
        for length in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(SheetKernel::third_order(length).check().is_err());
        }
    }
}
