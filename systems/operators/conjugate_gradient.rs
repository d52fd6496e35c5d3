//! Conjugate gradients with a diagonal preconditioner, with the same bits for any number of threads.
//!
//! # Source
//! Hestenes and Stiefel 1952. The relaxed Jacobi iteration of Deng 2022, §4.4.2 needs 20 to 500 times more sweeps at
//! physical stiffness.

use crate::rows::reduce::ordered_sum;
use rayon::prelude::*;

/// When to stop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StopRule {
    /// Largest allowed `|r| / |b|`, dimensionless, in the preconditioned norm `sqrt(r . r/diag)`.
    pub tolerance: f64,
    /// Most iterations before giving up.
    pub max_iterations: u32,
}

/// What a solve took.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SolveInfo {
    /// Iterations done.
    pub iterations: u32,
    /// Final `|r| / |b|`, dimensionless.
    pub residual: f64,
}

/// A solve that did not reach its tolerance.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error(
    "no convergence after {iterations} iterations: residual {residual:.2e} of the right-hand side, {tolerance:.2e} wanted"
)]
pub struct NotConverged {
    /// Iterations done.
    pub iterations: u32,
    /// `|r| / |b|` at the end; NaN if the system itself was not finite or not positive definite.
    pub residual: f64,
    /// What was wanted.
    pub tolerance: f64,
}

/// Work space of the solver, sized once.
#[derive(Clone, Debug, Default)]
pub struct Workspace {
    residual: Vec<f64>,
    direction: Vec<f64>,
    image: Vec<f64>,
}

/// Solves `A x = b` for symmetric positive (semi)definite `A`, starting from `x`.
///
/// `row(x, i)` is the `i`-th entry of `A x`; `diagonal[i] > 0`. If `singular`, constants are `A`'s kernel: `b` must sum
/// to zero, and the part of the residual along constants is removed in every iteration.
///
/// # Errors
/// [`NotConverged`] with the residual reached.
pub fn solve(
    row: impl Fn(&[f64], usize) -> f64 + Sync,
    diagonal: &[f64],
    b: &[f64],
    x: &mut [f64],
    stop: StopRule,
    singular: bool,
    work: &mut Workspace,
) -> Result<SolveInfo, NotConverged> {
    let count = b.len();
    let Workspace { residual, direction, image } = work;
    for vector in [&mut *residual, &mut *direction, &mut *image] {
        vector.resize(count, 0.0);
    }
    residual.par_iter_mut().enumerate().with_min_len(512).for_each(|(i, r)| *r = b[i] - row(x, i));
    if singular {
        remove_mean(residual);
    }
    direction.par_iter_mut().enumerate().with_min_len(512).for_each(|(i, p)| *p = residual[i] / diagonal[i]);
    let whole = ordered_sum(count, 0.0, |i| b[i] * b[i] / diagonal[i]);
    let mut rho = ordered_sum(count, 0.0, |i| residual[i] * direction[i]);
    let mut iterations = 0;
    let ratio = |rho: f64| if rho > 0.0 { (rho / whole).sqrt() } else { rho };
    while ratio(rho) > stop.tolerance {
        if iterations == stop.max_iterations {
            return Err(NotConverged { iterations, residual: ratio(rho), tolerance: stop.tolerance });
        }
        iterations += 1;
        image.par_iter_mut().enumerate().with_min_len(256).for_each(|(i, q)| *q = row(direction, i));
        let curvature = ordered_sum(count, 0.0, |i| direction[i] * image[i]);
        let step = rho / curvature;
        if !(curvature > 0.0 && step.is_finite()) {
            return Err(NotConverged { iterations, residual: f64::NAN, tolerance: stop.tolerance });
        }
        x.par_iter_mut().zip(&*direction).with_min_len(2048).for_each(|(x, p)| *x += step * p);
        residual.par_iter_mut().zip(&*image).with_min_len(2048).for_each(|(r, q)| *r -= step * q);
        if singular {
            remove_mean(residual);
        }
        let next = ordered_sum(count, 0.0, |i| residual[i] * residual[i] / diagonal[i]);
        let turn = next / rho;
        rho = next;
        direction
            .par_iter_mut()
            .enumerate()
            .with_min_len(2048)
            .for_each(|(i, p)| *p = residual[i] / diagonal[i] + turn * *p);
    }
    if rho.is_finite() {
        Ok(SolveInfo { iterations, residual: ratio(rho) })
    } else {
        Err(NotConverged { iterations, residual: f64::NAN, tolerance: stop.tolerance })
    }
}

fn remove_mean(values: &mut [f64]) {
    let mean = ordered_sum(values.len(), 0.0, |i| values[i]) / values.len() as f64;
    values.par_iter_mut().with_min_len(2048).for_each(|v| *v -= mean);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn path_laplacian(x: &[f64], i: usize) -> f64 {
        let near = |j: Option<usize>| j.and_then(|j| x.get(j)).map_or(0.0, |xj| x[i] - xj);
        near(i.checked_sub(1)) + near(Some(i + 1))
    }

    #[test]
    fn a_shifted_path_laplacian_is_solved() {
        let exact: Vec<f64> = (0..50).map(|i| f64::from(i * i % 17)).collect();
        let row = |x: &[f64], i: usize| path_laplacian(x, i) + 0.1 * x[i];
        let b: Vec<f64> = (0..50).map(|i| row(&exact, i)).collect();
        let mut x = vec![0.0; 50];
        let stop = StopRule { tolerance: 1e-12, max_iterations: 200 };
        let info = solve(row, &[2.1; 50], &b, &mut x, stop, false, &mut Workspace::default()).expect("converges");
        assert!(info.iterations <= 60);
        assert!(x.iter().zip(&exact).all(|(a, b)| (a - b).abs() < 1e-9));
    }

    #[test]
    fn a_singular_system_is_solved_up_to_a_constant() {
        let exact: Vec<f64> = (0..50).map(|i| f64::from(i % 7)).collect();
        let b: Vec<f64> = (0..50).map(|i| path_laplacian(&exact, i)).collect();
        let mut x = vec![0.0; 50];
        let stop = StopRule { tolerance: 1e-12, max_iterations: 200 };
        solve(path_laplacian, &[2.0; 50], &b, &mut x, stop, true, &mut Workspace::default()).expect("converges");
        let shift = x[0] - exact[0];
        assert!(x.iter().zip(&exact).all(|(a, b)| (a - b - shift).abs() < 1e-9));
    }

    #[test]
    fn an_unreachable_tolerance_is_an_error_with_numbers() {
        let stop = StopRule { tolerance: 1e-12, max_iterations: 3 };
        let row = |x: &[f64], i: usize| path_laplacian(x, i) + 0.1 * x[i];
        let mut b = [0.0; 50];
        b[0] = 1.0;
        let failed = solve(row, &[2.1; 50], &b, &mut [0.0; 50], stop, false, &mut Workspace::default());
        assert_eq!(failed.expect_err("three iterations do not suffice").iterations, 3);
    }
}
