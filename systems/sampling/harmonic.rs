//! Real spherical harmonics about the y axis, scaled to a largest value of 1.

use glam::DVec3;

/// Polar angles tried when looking for the largest value.
const SCAN: u32 = 720;

/// A real harmonic `P_l^|m|(cos theta) cos(m phi)` (sine for negative orders).
#[derive(Clone, Copy, Debug)]
pub struct Harmonic {
    degree: u32,
    order: i32,
    scale: f64,
}

impl Harmonic {
    /// The harmonic of `degree` and `order`, `|order| <= degree`.
    #[must_use]
    pub fn new(degree: u32, order: i32) -> Self {
        let m = order.unsigned_abs();
        let at = |k: u32| std::f64::consts::PI * f64::from(k) / f64::from(SCAN);
        let largest = (0..=SCAN).map(|k| legendre(degree, m, at(k).cos()).abs()).fold(0.0, f64::max);
        Self { degree, order, scale: 1.0 / largest }
    }

    /// Value in a direction (any length but zero).
    #[must_use]
    pub fn at(&self, direction: DVec3) -> f64 {
        let unit = direction.normalize_or_zero();
        let longitude = unit.x.atan2(unit.z);
        let m = self.order.unsigned_abs();
        let around = f64::from(m) * longitude;
        let wave = if self.order < 0 { around.sin() } else { around.cos() };
        self.scale * wave * legendre(self.degree, m, unit.y)
    }
}

/// Associated Legendre function `P_l^m(x)` up to a constant factor, by upward recurrence in the degree.
fn legendre(degree: u32, order: u32, x: f64) -> f64 {
    // Starting from sin^m alone, without the double factorial, keeps high orders in range.
    let mut last = 0.0;
    let mut value = (1.0 - x * x).max(0.0).powi(order as i32).sqrt();
    let m = f64::from(order);
    for l in order + 1..=degree {
        let l = f64::from(l);
        let next = ((2.0 * l - 1.0) * x * value - (l + m - 1.0) * last) / (l - m);
        last = value;
        value = next;
    }
    value
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn low_degrees_match_their_closed_forms() {
        let direction = DVec3::new(0.3, 0.5, -0.2).normalize();
        let y = direction.y;
        assert!((Harmonic::new(2, 0).at(direction) - (1.5 * y * y - 0.5)).abs() < 1e-12);
        assert!((Harmonic::new(1, 0).at(direction) - y).abs() < 1e-12);
        assert!((Harmonic::new(1, -1).at(direction) - direction.x).abs() < 1e-9);
        assert!((Harmonic::new(3, 0).at(direction) - 0.5 * (5.0 * y.powi(3) - 3.0 * y)).abs() < 1e-12);
    }
}
