//! Conjugate gradients for the implicit step: three right-hand sides at once, preconditioned by the diagonal.
//!
//! # Equation
//! `(D + κ K) x = b` with a diagonal `D > 0` and the stiffness `K`. Vertices whose `free` weight is 0 keep the `x` they
//! come with.
//!
//! # Discretisation
//! x, y and z have the same matrix and iterate each with numbers of its own; they share the product with the matrix.
//! Sums run in the order of rows: the same bits every time.
//!
//! # Source
//! Hestenes and Stiefel 1952.

use glam::DVec3;

use super::error::FlowError;
use crate::calculus::stiffness::Stiffness;

/// When to stop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StopRule {
    /// Largest `|r| / |b|` per component, dimensionless, in the norm `sqrt(r · r / diagonal)`.
    pub tolerance: f64,
    /// Most iterations.
    pub max_iterations: u32,
}

/// What a solve took.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SolveInfo {
    /// Iterations done.
    pub iterations: u32,
    /// Largest final `|r| / |b|` of the components, dimensionless.
    pub residual: f64,
}

/// The matrix `D + κ K`.
#[derive(Clone, Copy, Debug)]
pub struct ShiftedStiffness<'a> {
    /// `D`, per vertex.
    pub diagonal: &'a [f64],
    /// `κ`.
    pub factor: f64,
    /// `K`.
    pub stiffness: &'a Stiffness,
    /// Per vertex: zero if it is held.
    pub free: &'a [f64],
}

impl ShiftedStiffness<'_> {
    #[inline]
    fn row_times(&self, v: usize, x: &[DVec3]) -> DVec3 {
        x[v] * self.diagonal[v] + self.stiffness.row_times(v, x) * self.factor
    }

    #[inline]
    fn inverse_diagonal(&self, v: usize) -> f64 {
        if self.free[v] > 0.0 { 1.0 / (self.diagonal[v] + self.factor * self.stiffness.diagonal()[v]) } else { 0.0 }
    }
}

/// Work space of the solver, sized once.
#[derive(Clone, Debug, Default)]
pub struct Workspace {
    residual: Vec<DVec3>,
    direction: Vec<DVec3>,
    image: Vec<DVec3>,
    inverse: Vec<f64>,
}

impl Workspace {
    fn resize(&mut self, rows: usize) {
        [&mut self.residual, &mut self.direction, &mut self.image]
            .into_iter()
            .for_each(|v| v.resize(rows, DVec3::ZERO));
        self.inverse.resize(rows, 0.0);
    }
}

/// Solves the system, starting from `x`.
///
/// # Errors
/// [`FlowError::NotConverged`] with the residual reached.
pub fn solve(
    matrix: &ShiftedStiffness<'_>,
    b: &[DVec3],
    x: &mut [DVec3],
    stop: StopRule,
    work: &mut Workspace,
) -> Result<SolveInfo, FlowError> {
    work.resize(b.len());
    let Workspace { residual, direction, image, inverse } = work;
    let (mut whole, mut rho) = (DVec3::ZERO, DVec3::ZERO);
    for v in 0..b.len() {
        inverse[v] = matrix.inverse_diagonal(v);
        residual[v] = if inverse[v] > 0.0 { b[v] - matrix.row_times(v, x) } else { DVec3::ZERO };
        direction[v] = residual[v] * inverse[v];
        whole += b[v] * b[v] * inverse[v];
        rho += residual[v] * direction[v];
    }
    // Where held vertices move, b may be zero and x not: the first residual is the measure then.
    let whole = whole.max(rho);
    let mut info = SolveInfo { iterations: 0, residual: relative(rho, whole) };
    while info.residual > stop.tolerance {
        if info.iterations == stop.max_iterations {
            let SolveInfo { iterations, residual } = info;
            return Err(FlowError::NotConverged { iterations, residual, tolerance: stop.tolerance });
        }
        let mut curvature = DVec3::ZERO;
        for v in 0..b.len() {
            image[v] = if inverse[v] > 0.0 { matrix.row_times(v, direction) } else { DVec3::ZERO };
            curvature += direction[v] * image[v];
        }
        let alpha = ratio(rho, curvature);
        let mut next = DVec3::ZERO;
        for v in 0..b.len() {
            x[v] += alpha * direction[v];
            residual[v] -= alpha * image[v];
            next += residual[v] * residual[v] * inverse[v];
        }
        let beta = ratio(next, rho);
        for v in 0..b.len() {
            direction[v] = residual[v] * inverse[v] + beta * direction[v];
        }
        rho = next;
        info = SolveInfo { iterations: info.iterations + 1, residual: relative(rho, whole) };
    }
    Ok(info)
}

/// Componentwise quotient; 0 where there is nothing to divide by: that component is solved.
fn ratio(a: DVec3, b: DVec3) -> DVec3 {
    let divide = |a: f64, b: f64| if b > 0.0 { a / b } else { 0.0 };
    DVec3::new(divide(a.x, b.x), divide(a.y, b.y), divide(a.z, b.z))
}

fn relative(square: DVec3, whole: DVec3) -> f64 {
    let parts = ratio(square, whole);
    if parts.is_finite() { parts.max_element().sqrt() } else { f64::INFINITY }
}
