//! Brings every closed region to its volume by the smallest displacement in the metric of mass.
//!
//! # Equation
//! `x = x* + W⁻¹ Σ_i λ_i G_i`, with `G_i = ∂V_i/∂x` at the *start* of the step, and `λ` such that `V_i(x)` is the target.
//!
//! # Discretisation
//! Newton's iteration with the matrix `G W⁻¹ Gᵀ` of the start: it converges like a geometric series whose ratio is
//! displacement over radius, and needs one factorisation. It goes on until round-off.
//!
//! The gradients of the start make rest exact (tension and pressure balance at one and the same place), and keep both
//! momentum and angular momentum: `Σ_v G_v = 0` and `Σ_v x_v x G_v = 0` there.
//!
//! # Source
//! The constrained form of Müller 2009 and Ishida 2017, §volume correction, with exact gradients.

use glam::DVec3;

use super::error::FlowError;
use super::pressure_system::PressureSystem;
use crate::calculus::Incidence;
use crate::calculus::volume::{pressure_force, volumes};

/// Where the iteration stalls it has met round-off, if the relative error is below this.
const ROUND_OFF: f64 = 1e-10;

/// The constraint: which volumes, along which directions.
#[derive(Clone, Copy, Debug)]
pub struct Constraint<'a> {
    /// Connectivity.
    pub incidence: &'a Incidence,
    /// `G`, per entry, m^2.
    pub gradients: &'a [DVec3],
    /// `1/W`, per vertex; zero for held vertices.
    pub inverse: &'a [f64],
    /// Volume wanted of each closed region, m^3.
    pub targets: &'a [f64],
    /// Largest relative error.
    pub tolerance: f64,
    /// Most iterations.
    pub max_iterations: u32,
}

/// Work space and result.
#[derive(Clone, Debug, Default)]
pub struct Multipliers {
    /// `λ` of each closed region.
    pub total: Vec<f64>,
    volumes: Vec<f64>,
    change: Vec<f64>,
}

/// What a projection took.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ProjectionInfo {
    /// Iterations done.
    pub iterations: u32,
    /// Largest relative error of a volume left.
    pub error: f64,
}

/// Moves `positions` to the wanted volumes; the system has to be filled.
///
/// # Errors
/// [`FlowError::VolumeNotReached`] with the region that is farthest off.
pub fn project(
    constraint: &Constraint<'_>,
    system: &mut PressureSystem,
    positions: &mut [DVec3],
    multipliers: &mut Multipliers,
) -> Result<ProjectionInfo, FlowError> {
    multipliers.total.clear();
    multipliers.total.resize(constraint.targets.len(), 0.0);
    let mut info = ProjectionInfo::default();
    let mut before = f64::INFINITY;
    loop {
        let (worst, error) = multipliers.measure(constraint, positions);
        info.error = error;
        let has_stalled = error <= ROUND_OFF && error > 0.5 * before;
        if error <= constraint.tolerance || has_stalled {
            return Ok(info);
        }
        if info.iterations == constraint.max_iterations || !error.is_finite() {
            let region = constraint.incidence.closed()[worst];
            return Err(FlowError::VolumeNotReached { region, error, iterations: info.iterations });
        }
        system.solve(constraint.incidence, &mut multipliers.change)?;
        multipliers.total.iter_mut().zip(&multipliers.change).for_each(|(total, change)| *total += change);
        displace(constraint, &multipliers.change, positions);
        info.iterations += 1;
        before = error;
    }
}

impl Multipliers {
    /// Puts what volumes lack into `change`; the region that is farthest off and its relative error.
    fn measure(&mut self, constraint: &Constraint<'_>, positions: &[DVec3]) -> (usize, f64) {
        volumes(constraint.incidence, positions, &mut self.volumes);
        self.change.clear();
        let mut worst = (0, 0.0);
        for (region, (volume, target)) in self.volumes.iter().zip(constraint.targets).enumerate() {
            let lack = target - volume;
            self.change.push(lack);
            let error = lack.abs() / target.abs().max(volume.abs()).max(f64::MIN_POSITIVE);
            if !(error <= worst.1) {
                worst = (region, error);
            }
        }
        worst
    }
}

fn displace(constraint: &Constraint<'_>, change: &[f64], positions: &mut [DVec3]) {
    for (v, (x, inverse)) in positions.iter_mut().zip(constraint.inverse).enumerate() {
        *x += pressure_force(constraint.incidence, constraint.gradients, change, v) * *inverse;
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::calculus::test_shapes::{double_bubble, shaken};
    use crate::calculus::volume::volume_gradients;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        #[test]
        fn every_volume_within_reach_is_met_and_the_centre_of_mass_stays(
            grown in proptest::array::uniform2(0.8..1.3),
            amount in 0.0..0.05,
            heaviest in 0.0..3.0,
            unit in -6..6,
        ) {
            let unit = 10f64.powi(unit);
            let mut surface = shaken(&double_bubble(1.0, 0.7, 4), amount);
            surface.positions.iter_mut().for_each(|x| *x *= unit);
            let incidence = Incidence::new(&surface);
            let (mut gradients, mut targets) = (Vec::new(), Vec::new());
            volume_gradients(&incidence, &surface.positions, &mut gradients);
            volumes(&incidence, &surface.positions, &mut targets);
            targets.iter_mut().zip(grown).for_each(|(target, factor)| *target *= factor);
            // Masses like areas, with a factor that varies over the bubble.
            let mut inverse = vec![0.0; surface.positions.len()];
            crate::calculus::area::vertex_integrals(
                &incidence, &surface.positions, crate::calculus::Weights::Uniform(1.0), &mut inverse);
            let masses: Vec<f64> =
                inverse.iter().zip(surface.positions.iter()).map(|(a, x)| a * (1.0 + heaviest * (x.z / unit).abs())).collect();
            inverse.iter_mut().zip(&masses).for_each(|(inverse, mass)| *inverse = 1.0 / mass);
            let mut system = PressureSystem::default();
            system.lay_out(&incidence);
            system.fill(&incidence, &gradients, &inverse).unwrap();
            let constraint = Constraint {
                incidence: &incidence,
                gradients: &gradients,
                inverse: &inverse,
                targets: &targets,
                tolerance: 1e-13,
                max_iterations: 100,
            };
            let mut moved = surface.positions.0.clone();
            let info = project(&constraint, &mut system, &mut moved, &mut Multipliers::default()).unwrap();
            prop_assert!(info.error < 1e-10);
            let whole: f64 = masses.iter().sum();
            let paths = moved.iter().zip(surface.positions.iter()).zip(&masses);
            let shift: DVec3 = paths.map(|((a, b), m)| (*a - *b) * (m / whole)).sum();
            prop_assert!(shift.length() < 1e-12 * unit, "{shift}");
        }
    }
}
