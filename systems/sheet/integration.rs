//! Integrators: how rates at a few trial states become a step.
//!
//! | integrator | evaluations | what it is for |
//! |---|---|---|
//! | [`Integrator::Leapfrog`] | 1 | pictures, and most else: half a kick by tension, a move with what that gives, half a kick |
//! | [`Integrator::SymplecticEuler`] | 1 | the paper's: a whole kick, then the move; the same orbit, half a step out of phase |
//! | [`Integrator::RungeKutta4`] | 4 | accuracy; damps waves as short as the mesh a little |
//! | [`Integrator::ImplicitMidpoint`] | until the midpoint is found, about ten | symplectic and second order: keeps energy over many periods |
//!
//! An integrator is handed the rates of the present trial state and says where to evaluate next: every evaluation is one pass over the same
//! stages, whatever the integrator.

use glam::DVec3;

use crate::SheetError;

/// Part of the largest change of a step below which the midpoint counts as found.
const MIDPOINT_TOLERANCE: f64 = 1e-9;
/// Evaluations after which a midpoint counts as not to be found.
const MOST_PASSES: u32 = 60;

/// How a step is made of evaluations.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Integrator {
    /// One evaluation; second order in waves of small amplitude, between first and second where convection matters, which lags by a step.
    #[default]
    Leapfrog,
    /// One evaluation; first order.
    SymplecticEuler,
    /// Four evaluations.
    RungeKutta4,
    /// Fixed-point iteration on the midpoint.
    ImplicitMidpoint,
}

impl Integrator {
    /// Parts of the step for which tension and convection act on the potentials before and after the move; `None` where rates are
    /// taken at trial states.
    #[must_use]
    pub fn kicks(self) -> Option<[f64; 2]> {
        match self {
            Self::Leapfrog => Some([0.5, 0.5]),
            Self::SymplecticEuler => Some([1.0, 0.0]),
            Self::RungeKutta4 | Self::ImplicitMidpoint => None,
        }
    }
}

/// What a step changes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SheetState {
    /// Per vertex, metres.
    pub positions: Vec<DVec3>,
    /// Per side, m^2/s.
    pub potentials: Vec<f64>,
}

/// Rates at a trial state.
#[derive(Clone, Copy, Debug)]
pub struct Rates<'a> {
    /// Velocities of the vertices, m/s.
    pub velocities: &'a [DVec3],
    /// Rates of the potentials, m^2/s^2; not read where the integrator [kicks](Integrator::kicks).
    pub potentials: &'a [f64],
}

/// What an integrator wants next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Next {
    /// Rates at the state as it is now.
    Evaluate,
    /// Nothing: the state is that of the end of the step.
    Finish,
}

/// A step under way.
#[derive(Clone, Debug, Default)]
pub struct Integration {
    /// Evaluations taken.
    passes: u32,
    start: SheetState,
    /// Weighted sums of rates.
    velocity_sum: Vec<DVec3>,
    potential_sum: Vec<f64>,
}

impl Integration {
    /// Begins a step at a state.
    pub fn begin(&mut self, state: &SheetState) {
        self.passes = 0;
        self.start.clone_from(state);
        self.velocity_sum.clear();
        self.velocity_sum.resize(state.positions.len(), DVec3::ZERO);
        self.potential_sum.clear();
        self.potential_sum.resize(state.potentials.len(), 0.0);
    }

    /// Where the step began.
    #[must_use]
    pub fn start(&self) -> &SheetState {
        &self.start
    }

    /// Evaluations taken in this step.
    #[must_use]
    pub fn passes(&self) -> u32 {
        self.passes
    }

    /// Takes the rates of a state, and puts the next trial state or the end of the step into it.
    ///
    /// # Errors
    /// [`SheetError::MidpointNotFound`] when the iteration of the implicit midpoint rule does not converge: the step is too long.
    pub fn take(
        &mut self,
        integrator: Integrator,
        dt: f64,
        rates: Rates<'_>,
        state: &mut SheetState,
    ) -> Result<Next, SheetError> {
        self.passes += 1;
        match integrator {
            Integrator::Leapfrog | Integrator::SymplecticEuler => {
                self.move_from_start(dt, rates.velocities, None, state);
                Ok(Next::Finish)
            }
            Integrator::RungeKutta4 => Ok(self.runge_kutta(dt, rates, state)),
            Integrator::ImplicitMidpoint => self.midpoint(dt, rates, state),
        }
    }

    fn runge_kutta(&mut self, dt: f64, rates: Rates<'_>, state: &mut SheetState) -> Next {
        let weight = [1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0][self.passes as usize - 1];
        self.velocity_sum.iter_mut().zip(rates.velocities).for_each(|(sum, w)| *sum += *w * weight);
        self.potential_sum.iter_mut().zip(rates.potentials).for_each(|(sum, rate)| *sum += rate * weight);
        if self.passes == 4 {
            let (velocities, potentials) =
                (std::mem::take(&mut self.velocity_sum), std::mem::take(&mut self.potential_sum));
            self.move_from_start(dt, &velocities, Some(&potentials), state);
            return Next::Finish;
        }
        let part = if self.passes == 3 { dt } else { 0.5 * dt };
        self.move_from_start(part, rates.velocities, Some(rates.potentials), state);
        Next::Evaluate
    }

    /// Rates belong to the last guess of the midpoint; the next guess, or the end of the step.
    fn midpoint(&mut self, dt: f64, rates: Rates<'_>, state: &mut SheetState) -> Result<Next, SheetError> {
        let before = state.clone();
        self.move_from_start(0.5 * dt, rates.velocities, Some(rates.potentials), state);
        let (moved, changed) = (distances(state, &self.start), distances(state, &before));
        let change = (0..2).map(|k| if moved[k] > 0.0 { changed[k] / moved[k] } else { 0.0 }).fold(0.0, f64::max);
        if change <= MIDPOINT_TOLERANCE {
            self.move_from_start(dt, rates.velocities, Some(rates.potentials), state);
            return Ok(Next::Finish);
        }
        if self.passes == MOST_PASSES || !change.is_finite() {
            return Err(SheetError::MidpointNotFound { dt, passes: self.passes, change });
        }
        Ok(Next::Evaluate)
    }

    /// `start + dt rates`; without rates of the potentials they stay as they are.
    fn move_from_start(&self, dt: f64, velocities: &[DVec3], potentials: Option<&[f64]>, state: &mut SheetState) {
        for ((x, start), w) in state.positions.iter_mut().zip(&self.start.positions).zip(velocities) {
            *x = *start + *w * dt;
        }
        if let Some(rates) = potentials {
            for ((phi, start), rate) in state.potentials.iter_mut().zip(&self.start.potentials).zip(rates) {
                *phi = start + rate * dt;
            }
        }
    }
}

/// Largest differences of positions, metres, and of potentials, m^2/s.
fn distances(a: &SheetState, b: &SheetState) -> [f64; 2] {
    let places = a.positions.iter().zip(&b.positions).map(|(a, b)| a.distance_squared(*b)).fold(0.0, f64::max);
    let potentials = a.potentials.iter().zip(&b.potentials).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    [places.sqrt(), potentials]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A harmonic oscillator as a state: `x'' = -x` with `w = phi`, `phi' = -x`.
    fn oscillate(integrator: Integrator, dt: f64, steps: usize) -> (f64, f64) {
        let mut state = SheetState { positions: vec![DVec3::X], potentials: vec![0.0] };
        let mut integration = Integration::default();
        for _ in 0..steps {
            let [before, after] = integrator.kicks().unwrap_or_default();
            state.potentials[0] -= before * dt * state.positions[0].x;
            integration.begin(&state);
            loop {
                let (velocities, rates) = ([DVec3::X * state.potentials[0]], [-state.positions[0].x]);
                let rates = Rates { velocities: &velocities, potentials: &rates };
                if integration.take(integrator, dt, rates, &mut state).unwrap() == Next::Finish {
                    break;
                }
            }
            state.potentials[0] -= after * dt * state.positions[0].x;
        }
        (state.positions[0].x, state.potentials[0])
    }

    fn error(integrator: Integrator, steps: usize) -> f64 {
        let (x, phi) = oscillate(integrator, 2.0 / steps as f64, steps);
        (x - 2f64.cos()).hypot(phi + 2f64.sin())
    }

    #[test]
    fn integrators_have_the_order_that_they_claim() {
        use Integrator::{ImplicitMidpoint, Leapfrog, RungeKutta4, SymplecticEuler};
        for (integrator, order) in
            [(Leapfrog, 2.0), (SymplecticEuler, 1.0), (RungeKutta4, 4.0), (ImplicitMidpoint, 2.0)]
        {
            let observed = (error(integrator, 40) / error(integrator, 80)).log2();
            assert!((observed - order).abs() < 0.1, "{integrator:?}: {observed}");
        }
    }

    #[test]
    fn the_midpoint_rule_keeps_a_quadratic_energy() {
        let (x, phi) = oscillate(Integrator::ImplicitMidpoint, 0.3, 1000);
        assert!((x.hypot(phi) - 1.0).abs() < 1e-6, "{x} {phi}");
    }

    #[test]
    fn a_step_too_long_for_the_midpoint_is_refused() {
        let mut integration = Integration::default();
        let mut state = SheetState { positions: vec![DVec3::X], potentials: vec![0.0] };
        integration.begin(&state);
        let refused = (0..100).find_map(|_| {
            let (velocities, rates) = ([DVec3::X * state.potentials[0]], [-state.positions[0].x]);
            let rates = Rates { velocities: &velocities, potentials: &rates };
            integration.take(Integrator::ImplicitMidpoint, 10.0, rates, &mut state).err()
        });
        assert!(matches!(refused, Some(SheetError::MidpointNotFound { .. })));
    }
}
