//! What a law finds: expected and measured side by side, with the observed order of convergence.

/// One number held against what it should be.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// What is measured, with its unit.
    pub what: String,
    /// What the law says; 0 where it says that something vanishes.
    pub expected: f64,
    /// What the program gives.
    pub measured: f64,
    /// Relative error; where the law says 0, the measured size itself.
    pub error: f64,
    /// Largest allowed error.
    pub tolerance: f64,
    /// How fast the error falls under refinement, where that is part of the law.
    pub order: Option<Order>,
}

/// Order of convergence: the error is as `spacing^order`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Order {
    /// As measured.
    pub observed: f64,
    /// Least allowed.
    pub least: f64,
}

impl Finding {
    /// Holds `measured` against `expected`, which is not 0; `tolerance` is relative.
    #[must_use]
    pub fn relative(what: impl Into<String>, expected: f64, measured: f64, tolerance: f64) -> Self {
        let error = (measured / expected - 1.0).abs();
        Self { what: what.into(), expected, measured, error, tolerance, order: None }
    }

    /// Something that should vanish, and may be as large as `tolerance`.
    #[must_use]
    pub fn vanishing(what: impl Into<String>, measured: f64, tolerance: f64) -> Self {
        Self { what: what.into(), expected: 0.0, measured, error: measured.abs(), tolerance, order: None }
    }

    /// Demands at least the order `least` of the errors in `refinement`.
    #[must_use]
    pub fn converging(mut self, refinement: &Refinement, least: f64) -> Self {
        self.order = Some(Order { observed: refinement.order(), least });
        self
    }

    /// Whether error and order are as demanded; NaN never is.
    #[must_use]
    pub fn passes(&self) -> bool {
        self.error <= self.tolerance && self.order.is_none_or(|order| order.observed >= order.least)
    }
}

/// Errors of one quantity at several spacings (or step lengths).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Refinement {
    levels: Vec<(f64, f64)>,
}

impl Refinement {
    /// Adds the error at one spacing; its sign does not matter.
    pub fn add(&mut self, spacing: f64, error: f64) {
        self.levels.push((spacing, error.abs()));
    }

    /// Slope of `log error` over `log spacing`, by least squares through all levels.
    #[must_use]
    pub fn order(&self) -> f64 {
        let points = || self.levels.iter().map(|(h, e)| (h.ln(), e.ln()));
        let count = self.levels.len() as f64;
        let (x, y) = points().fold((0.0, 0.0), |(x, y), p| (x + p.0 / count, y + p.1 / count));
        let (slope, spread) =
            points().fold((0.0, 0.0), |(s, w), p| (s + (p.0 - x) * (p.1 - y), w + (p.0 - x) * (p.0 - x)));
        slope / spread
    }
}

impl FromIterator<(f64, f64)> for Refinement {
    fn from_iter<I: IntoIterator<Item = (f64, f64)>>(levels: I) -> Self {
        let mut refinement = Self::default();
        levels.into_iter().for_each(|(spacing, error)| refinement.add(spacing, error));
        refinement
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_that_falls_with_the_square_has_order_two() {
        let refinement: Refinement = [4.0, 2.0, 1.0].map(|h| (h, -3.0 * h * h)).into_iter().collect();
        assert!((refinement.order() - 2.0).abs() < 1e-12);
    }

    #[test]
    fn what_is_not_a_number_does_not_pass() {
        assert!(Finding::relative("x", 2.0, 2.01, 0.01).passes());
        assert!(!Finding::relative("x", 2.0, f64::NAN, 0.01).passes());
        assert!(!Finding::vanishing("x", 1e-3, 1e-2).converging(&Refinement::default(), 1.0).passes());
    }
}
