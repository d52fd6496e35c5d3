//! The film as the pictures see it: points spread over a surface, each with a normal and a value.

use super::error::PictureError;
use glam::DVec3;
use rayon::iter::{IndexedParallelIterator, IntoParallelRefIterator};

/// What a set of points tells about its film.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Part {
    /// Both where the film is and what it shows.
    #[default]
    Whole,
    /// What the film shows. Points that drift apart leave no holes, since a [`Part::Ground`] tells where the film is.
    Detail,
    /// Where the film is; what it shows only where there is no detail. Painted after its detail.
    Ground,
}

/// Points spread evenly over a film, one row per point.
#[derive(Clone, Copy, Debug)]
pub struct FilmPoints<'a> {
    /// Place of each point, metres.
    pub positions: &'a [DVec3],
    /// Normal at each point, any length but zero; neighbours must agree on the side it points to.
    pub normals: &'a [DVec3],
    /// Thickness at each point, metres; or any quantity for a colour map.
    pub values: &'a [f64],
    /// Distance between neighbours, metres: `√(film area / number of points)`.
    pub spacing: f64,
    /// What these points tell about the film.
    pub part: Part,
}

impl FilmPoints<'_> {
    /// Refuses empty, ragged or non-finite input.
    ///
    /// # Errors
    /// [`PictureError`] that names the column and row at fault.
    pub fn check(&self) -> Result<(), PictureError> {
        let points = self.positions.len();
        if points == 0 {
            return Err(PictureError::NoPoints);
        }
        for (column, found) in [("normals", self.normals.len()), ("values", self.values.len())] {
            if found != points {
                return Err(PictureError::ColumnLength { column, points, found });
            }
        }
        if !(self.spacing.is_finite() && self.spacing > 0.0) {
            let allowed = "a positive length in metres";
            return Err(PictureError::OutOfRange { name: "the spacing of the film", value: self.spacing, allowed });
        }
        first_not_finite("position", self.positions, |p| p.element_sum())?;
        first_not_finite("normal", self.normals, |n| n.length_squared().recip())?;
        first_not_finite("value", self.values, |&value| value)
    }

    /// Smallest and largest value.
    #[must_use]
    pub fn value_range(&self) -> (f64, f64) {
        let start = (f64::INFINITY, f64::NEG_INFINITY);
        self.values.iter().fold(start, |(low, high), &value| (low.min(value), high.max(value)))
    }
}

/// Error for the first row whose `measure` is not finite.
fn first_not_finite<T: Sync>(
    column: &'static str,
    rows: &[T],
    measure: impl Fn(&T) -> f64 + Sync,
) -> Result<(), PictureError> {
    match rows.par_iter().position_first(|row| !measure(row).is_finite()) {
        Some(row) => Err(PictureError::NotFinite { column, row, value: measure(&rows[row]) }),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::{FilmPoints, Part};
    use crate::picture::error::PictureError;
    use glam::DVec3;

    fn two_points<'a>(normals: &'a [DVec3], values: &'a [f64]) -> FilmPoints<'a> {
        FilmPoints { positions: &[DVec3::ZERO, DVec3::X], normals, values, spacing: 1.0, part: Part::Whole }
    }

    #[test]
    fn a_missing_row_is_named() {
        let error = two_points(&[DVec3::Z], &[1.0, 2.0]).check();
        assert!(matches!(error, Err(PictureError::ColumnLength { column: "normals", points: 2, found: 1 })));
    }

    #[test]
    fn a_value_that_is_not_a_number_is_named_by_its_row() {
        let error = two_points(&[DVec3::Z; 2], &[1.0, f64::NAN]).check();
        assert!(matches!(error, Err(PictureError::NotFinite { column: "value", row: 1, .. })));
    }

    #[test]
    fn a_normal_of_no_length_is_refused() {
        let error = two_points(&[DVec3::Z, DVec3::ZERO], &[1.0, 2.0]).check();
        assert!(matches!(error, Err(PictureError::NotFinite { column: "normal", row: 1, .. })));
    }
}
