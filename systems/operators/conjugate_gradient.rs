//! Conjugate gradients, with the same bits for any number of threads: for systems of pairs, preconditioned by
//! [`multigrid`](super::multigrid), and for whatever is a [`SymmetricSystem`].
//!
//! # Source
//! Hestenes and Stiefel 1952. The relaxed Jacobi iteration of Deng 2022, §4.4.2 needs 20 to 500 times more sweeps at
//! physical stiffness.

use super::multigrid::Multigrid;
use super::pair_system::PairSystem;
use crate::rows::reduce::ordered_sum;
use glam::DVec3;
use rayon::prelude::*;

/// When to stop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StopRule {
    /// Largest allowed `|r| / |b|`, dimensionless, in the norm `sqrt(r . r/diag)`.
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
    corrected: Vec<f64>,
    direction: Vec<f64>,
    image: Vec<f64>,
}

/// A symmetric, positive (semi)definite system.
pub trait SymmetricSystem {
    /// Writes `A x`.
    fn multiply(&self, x: &[f64], image: &mut [f64]);
    /// Diagonal of `A`, or an approximation of it, by which residuals are measured.
    fn diagonal(&self) -> &[f64];
    /// Writes an approximation of `A^-1 r`, itself symmetric and positive definite.
    fn precondition(&mut self, r: &[f64], corrected: &mut [f64]);
    /// Whether constants are `A`'s kernel: the right-hand side must sum to zero then.
    fn is_singular(&self) -> bool {
        false
    }
}

/// A system of pairs with its multigrid, which is made when it is first needed.
struct Preconditioned<'a, P> {
    system: &'a PairSystem<'a>,
    places: Option<P>,
    multigrid: Option<Multigrid>,
    is_singular: bool,
}

impl<P: Iterator<Item = DVec3>> SymmetricSystem for Preconditioned<'_, P> {
    fn multiply(&self, x: &[f64], image: &mut [f64]) {
        let system = self.system;
        image.par_iter_mut().enumerate().with_min_len(512).for_each(|(i, q)| *q = system.row(x, i));
    }

    fn diagonal(&self) -> &[f64] {
        &self.system.diagonal
    }

    fn precondition(&mut self, r: &[f64], corrected: &mut [f64]) {
        let (system, places) = (self.system, &mut self.places);
        let made = || Multigrid::new(system, places.take().into_iter().flatten());
        self.multigrid.get_or_insert_with(made).apply(system, r, corrected);
    }

    fn is_singular(&self) -> bool {
        self.is_singular
    }
}

/// Solves a system of pairs, starting from `x`. `places` are where the unknowns stand; the preconditioner uses them.
///
/// If there is no reaction, constants are `A`'s kernel: `b` must sum to zero, and the part of the residual along
/// constants is removed in every iteration.
///
/// # Errors
/// [`NotConverged`] with the residual reached.
pub fn solve(
    system: &PairSystem,
    places: impl Iterator<Item = DVec3>,
    b: &[f64],
    x: &mut [f64],
    stop: StopRule,
    work: &mut Workspace,
) -> Result<SolveInfo, NotConverged> {
    let is_singular = system.reaction.iter().all(|m| *m == 0.0);
    let system = Preconditioned { system, places: Some(places), multigrid: None, is_singular };
    solve_system(system, b, x, stop, work)
}

/// Solves `A x = b`, starting from `x`.
///
/// # Errors
/// [`NotConverged`] with the residual reached.
pub fn solve_system(
    mut system: impl SymmetricSystem,
    b: &[f64],
    x: &mut [f64],
    stop: StopRule,
    work: &mut Workspace,
) -> Result<SolveInfo, NotConverged> {
    work.begin(&system, b, x);
    let whole = size(system.diagonal(), b);
    let failed = |iterations, residual| NotConverged { iterations, residual, tolerance: stop.tolerance };
    let ratio = |square: f64| if square > 0.0 { (square / whole).sqrt() } else { square };
    let mut info = SolveInfo { iterations: 0, residual: ratio(size(system.diagonal(), &work.residual)) };
    let mut rho = 0.0;
    while info.residual > stop.tolerance {
        if info.iterations == stop.max_iterations {
            return Err(failed(info.iterations, info.residual));
        }
        system.precondition(&work.residual, &mut work.corrected);
        rho = work.turn(rho);
        let curvature = work.curvature(&system);
        if !(rho > 0.0 && curvature > 0.0 && (rho / curvature).is_finite()) {
            return Err(failed(info.iterations, f64::NAN));
        }
        work.step(rho / curvature, x, system.is_singular());
        let residual = ratio(size(system.diagonal(), &work.residual));
        info = SolveInfo { iterations: info.iterations + 1, residual };
    }
    if info.residual.is_finite() { Ok(info) } else { Err(failed(info.iterations, f64::NAN)) }
}

impl Workspace {
    /// The residual of `x`; no direction yet.
    fn begin(&mut self, system: &impl SymmetricSystem, b: &[f64], x: &[f64]) {
        for vector in [&mut self.residual, &mut self.corrected, &mut self.direction, &mut self.image] {
            vector.clear();
            vector.resize(b.len(), 0.0);
        }
        system.multiply(x, &mut self.residual);
        self.residual.iter_mut().zip(b).for_each(|(r, b)| *r = b - *r);
        if system.is_singular() {
            remove_mean(&mut self.residual);
        }
    }

    /// The next direction, given `r . z` of the iteration before, 0 for none; gives the new one.
    fn turn(&mut self, rho: f64) -> f64 {
        let Self { residual, corrected, direction, .. } = self;
        let next = ordered_sum(residual.len(), 0.0, |i| residual[i] * corrected[i]);
        let turn = if rho > 0.0 { next / rho } else { 0.0 };
        direction.par_iter_mut().zip(&*corrected).with_min_len(4096).for_each(|(p, z)| *p = z + turn * *p);
        next
    }

    /// `p . A p`, leaving `A p` in the image.
    fn curvature(&mut self, system: &impl SymmetricSystem) -> f64 {
        let Self { direction, image, .. } = self;
        system.multiply(direction, image);
        ordered_sum(direction.len(), 0.0, |i| direction[i] * image[i])
    }

    /// Goes `length` along the direction.
    fn step(&mut self, length: f64, x: &mut [f64], is_singular: bool) {
        let Self { residual, direction, image, .. } = self;
        x.par_iter_mut().zip(&*direction).with_min_len(4096).for_each(|(x, p)| *x += length * p);
        residual.par_iter_mut().zip(&*image).with_min_len(4096).for_each(|(r, q)| *r -= length * q);
        if is_singular {
            remove_mean(residual);
        }
    }
}

/// `v . v/diag`.
fn size(diagonal: &[f64], v: &[f64]) -> f64 {
    ordered_sum(v.len(), 0.0, |i| v[i] * v[i] / diagonal[i])
}

fn remove_mean(values: &mut [f64]) {
    let mean = ordered_sum(values.len(), 0.0, |i| values[i]) / values.len() as f64;
    values.par_iter_mut().with_min_len(2048).for_each(|v| *v -= mean);
}

#[cfg(test)]
mod tests {
    use super::*;

    use crate::neighbours::lists::NeighbourLists;

    /// Rows on a line, each coupled to the next.
    fn path(count: usize) -> NeighbourLists {
        NeighbourLists::collect(count, |i, found| {
            found.extend(i.checked_sub(1).map(|j| j as u32));
            found.extend((i + 1 < count).then_some(i as u32 + 1));
        })
    }

    /// Solves for the image of `exact` under couplings 1 and the given reaction; the worst error but for a constant.
    fn error(lists: &NeighbourLists, places: &[DVec3], exact: &[f64], reaction: f64, stop: StopRule) -> (f64, u32) {
        let system = PairSystem::new(lists, vec![reaction; exact.len()], |_, _, _| 1.0);
        let b: Vec<f64> = (0..exact.len()).map(|i| system.row(exact, i)).collect();
        let mut x = vec![0.0; exact.len()];
        let work = &mut Workspace::default();
        let info = solve(&system, places.iter().copied(), &b, &mut x, stop, work).expect("converges");
        let shift = if reaction > 0.0 { 0.0 } else { x[0] - exact[0] };
        (x.iter().zip(exact).map(|(a, b)| (a - b - shift).abs()).fold(0.0, f64::max), info.iterations)
    }

    fn on_a_line(count: u32) -> Vec<DVec3> {
        (0..count).map(|i| DVec3::X * f64::from(i)).collect()
    }

    const TIGHT: StopRule = StopRule { tolerance: 1e-12, max_iterations: 200 };

    #[test]
    fn a_shifted_path_laplacian_is_solved() {
        let exact: Vec<f64> = (0..500).map(|i| f64::from(i * i % 17)).collect();
        let (error, iterations) = error(&path(500), &on_a_line(500), &exact, 0.1, TIGHT);
        assert!(error < 1e-9 && iterations < 40, "{error:e} {iterations}");
    }

    #[test]
    fn a_singular_system_is_solved_up_to_a_constant() {
        let exact: Vec<f64> = (0..500).map(|i| f64::from(i % 7)).collect();
        let (error, iterations) = error(&path(500), &on_a_line(500), &exact, 0.0, TIGHT);
        assert!(error < 1e-7 && iterations < 60, "{error:e} {iterations}");
    }

    /// A square of `side` by `side` rows, each coupled to all within three steps.
    fn square(side: i32) -> (NeighbourLists, Vec<DVec3>) {
        let place = |i: usize| (i as i32 % side, i as i32 / side);
        let lists = NeighbourLists::collect((side * side) as usize, |i, found| {
            let (x, y) = place(i);
            for (dx, dy) in (-3..=3).flat_map(|dy| (-3..=3).map(move |dx| (dx, dy))) {
                let inside = (0..side).contains(&(x + dx)) && (0..side).contains(&(y + dy));
                if inside && (1..=9).contains(&(dx * dx + dy * dy)) {
                    found.push(((y + dy) * side + x + dx) as u32);
                }
            }
        });
        let places = (0..(side * side) as usize).map(place).map(|(x, y)| DVec3::new(x.into(), y.into(), 0.0));
        (lists, places.collect())
    }

    #[test]
    fn four_times_the_unknowns_take_hardly_more_iterations() {
        let iterations = [32, 64, 128].map(|side| {
            let (lists, places) = square(side);
            let exact: Vec<f64> =
                places.iter().map(|p| (0.3 * p.x).sin() + p.y * p.x / f64::from(side * side)).collect();
            error(&lists, &places, &exact, 0.0, StopRule { tolerance: 1e-6, max_iterations: 200 }).1
        });
        assert!(iterations.iter().all(|&n| n < 25), "{iterations:?}");
    }

    #[test]
    fn an_unreachable_tolerance_is_an_error_with_numbers() {
        let lists = path(500);
        let system = PairSystem::new(&lists, vec![1e-6; 500], |_, _, _| 1.0);
        let mut b = [0.0; 500];
        b[0] = 1.0;
        let (places, stop) = (on_a_line(500), StopRule { tolerance: 1e-12, max_iterations: 3 });
        let failed = solve(&system, places.into_iter(), &b, &mut [0.0; 500], stop, &mut Workspace::default());
        assert_eq!(failed.expect_err("three iterations do not suffice").iterations, 3);
    }
}
