//! Conjugate gradients preconditioned by a diagonal, for matrices that are known as a product.
//!
//! # Equation
//! `A x = b` with `A` symmetric and positive definite, and `D` an approximation of its diagonal.
//!
//! # Stop rule
//! Done when `r . D^-1 r <= tolerance^2 whole`, where the caller says what the whole is: `b . D^-1 b`, or what `x` itself weighs. After as
//! many iterations as the caller allows, or when the residual is no finite number, the caller's own error says so.
//! Sums run in the order of rows: the same bits every time.
//!
//! # Source
//! Hestenes and Stiefel 1952.

use crate::SheetError;

/// When to stop.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StopRule {
    /// Residual over the whole at which the solve ends, dimensionless, both as square roots.
    pub(crate) tolerance: f64,
    /// Iterations after which something else is wrong.
    pub(crate) max_iterations: u32,
    /// The error of a solve that does not converge, from iterations done and the residual over the whole.
    pub(crate) refusal: fn(u32, f64) -> SheetError,
}

/// What a solve took.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SolveInfo {
    /// Iterations of conjugate gradients.
    pub iterations: u32,
    /// Residual over the whole, dimensionless.
    pub residual: f64,
}

/// A matrix, and what residuals are measured by.
pub(crate) struct System<'a, P> {
    /// Writes `A x` into its second argument, which comes with what the last product left in it.
    pub(crate) product: P,
    /// `1 / D` per row.
    pub(crate) inverse: &'a [f64],
    /// Square of what a residual is small against.
    pub(crate) whole: f64,
}

/// Work space of the solver.
#[derive(Clone, Debug, Default)]
pub(crate) struct Workspace {
    /// `b - A x` per row: what a solve starts from, and what it leaves.
    pub(crate) residual: Vec<f64>,
    direction: Vec<f64>,
    image: Vec<f64>,
}

impl Workspace {
    /// Work space for one solve, which starts from a residual.
    pub(crate) fn of(residual: Vec<f64>) -> Self {
        Self { residual, ..Self::default() }
    }
}

/// Takes `x` and its residual, which `work` comes with, to the solution.
///
/// # Errors
/// [`StopRule::refusal`]; those of the product.
pub(crate) fn solve<P>(
    mut system: System<'_, P>,
    stop: StopRule,
    x: &mut [f64],
    work: &mut Workspace,
) -> Result<SolveInfo, SheetError>
where
    P: FnMut(&[f64], &mut Vec<f64>) -> Result<(), SheetError>,
{
    let Workspace { residual, direction, image } = work;
    let System { inverse, whole, .. } = system;
    let square = |r: &[f64]| r.iter().zip(inverse).map(|(r, inverse)| r * r * inverse).sum::<f64>();
    direction.clear();
    direction.extend(residual.iter().zip(inverse).map(|(r, inverse)| r * inverse));
    let mut rho = square(residual);
    let mut iterations = 0;
    while !(rho <= stop.tolerance * stop.tolerance * whole) {
        if iterations == stop.max_iterations || !rho.is_finite() {
            return Err((stop.refusal)(iterations, (rho / whole).sqrt()));
        }
        (system.product)(direction, image)?;
        let alpha = rho / direction.iter().zip(image.iter()).map(|(d, image)| d * image).sum::<f64>();
        x.iter_mut().zip(direction.iter()).for_each(|(x, d)| *x += alpha * d);
        residual.iter_mut().zip(image.iter()).for_each(|(r, image)| *r -= alpha * image);
        let next = square(residual);
        for ((d, r), inverse) in direction.iter_mut().zip(residual.iter()).zip(inverse) {
            *d = r * inverse + next / rho * *d;
        }
        rho = next;
        iterations += 1;
    }
    Ok(SolveInfo { iterations, residual: if whole > 0.0 { (rho / whole).sqrt() } else { 0.0 } })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `-x'' + x / 100` on a line of ten points.
    fn times(x: &[f64], image: &mut Vec<f64>) -> Result<(), SheetError> {
        let at = |i: usize| x.get(i).copied().unwrap_or(0.0);
        image.clear();
        image.extend((0..x.len()).map(|i| 2.01 * at(i) - at(i + 1) - at(i.wrapping_sub(1))));
        Ok(())
    }

    fn stop(max_iterations: u32) -> StopRule {
        let refusal = |iterations, residual| SheetError::WireNotSolved { iterations, residual };
        StopRule { tolerance: 1e-12, max_iterations, refusal }
    }

    fn solved(b: Vec<f64>, stop: StopRule) -> Result<(Vec<f64>, SolveInfo), SheetError> {
        let inverse = vec![1.0 / 2.01; b.len()];
        let whole = b.iter().map(|b| b * b / 2.01).sum();
        let mut x = vec![0.0; b.len()];
        let mut work = Workspace::of(b);
        let info = solve(System { product: times, inverse: &inverse, whole }, stop, &mut x, &mut work)?;
        Ok((x, info))
    }

    #[test]
    fn ten_unknowns_take_at_most_ten_iterations() {
        let wanted: Vec<f64> = (0..10).map(|i| f64::from(i * i).sin()).collect();
        let mut b = Vec::new();
        times(&wanted, &mut b).unwrap();
        let (x, info) = solved(b, stop(20)).unwrap();
        assert!(info.iterations <= 10 && info.residual <= 1e-12, "{info:?}");
        // The tolerance times the matrix's condition of about 40.
        assert!(x.iter().zip(&wanted).all(|(x, wanted)| (x - wanted).abs() < 1e-10));
    }

    #[test]
    fn nothing_to_solve_takes_no_iteration() {
        let (x, info) = solved(vec![0.0; 4], stop(20)).unwrap();
        assert_eq!((x, info), (vec![0.0; 4], SolveInfo::default()));
    }

    #[test]
    fn too_few_iterations_and_numbers_that_are_none_are_refused() {
        let few = solved((0..10).map(f64::from).collect(), stop(3)).unwrap_err();
        assert!(matches!(few, SheetError::WireNotSolved { iterations: 3, residual } if residual > 1e-12), "{few:?}");
        let none = solved(vec![f64::NAN; 4], stop(20)).unwrap_err();
        assert!(matches!(none, SheetError::WireNotSolved { iterations: 0, .. }), "{none:?}");
    }
}
