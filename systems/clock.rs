//! The length of a step: the shortest that CFL, the method and the scene ask for, such that the next frame is hit exactly.
//!
//! Systems of [`Stage::Clock`] propose limits to [`StepLimits`]; [`choose_step_length`] runs last in
//! that stage. The time left until the horizon is split into equal steps, so no sliver is left before a frame.
//!
//! A limit to the film's own motion alone is proposed for substeps: a step may then hold several, and is split into as few
//! equal ones as the limit allows.

use bevy_ecs::resource::Resource;
use bevy_ecs::system::{Res, ResMut};
use froth_components::clock::Clock;

use crate::observe::{Fault, Faults};
use crate::stage::Stage;

/// Part of a step by which a limit may be passed when that saves a step.
const TOLERANCE: f64 = 1e-6;

/// Upper limits to the length of the present step, by name.
#[derive(Resource, Clone, Debug)]
pub struct StepLimits {
    steps: Vec<(&'static str, f64)>,
    substep: f64,
}

impl Default for StepLimits {
    fn default() -> Self {
        Self { steps: Vec::new(), substep: f64::INFINITY }
    }
}

impl StepLimits {
    /// Asks that the step be no longer than `seconds`. Infinity is no limit.
    pub fn propose(&mut self, name: &'static str, seconds: f64) {
        self.steps.push((name, seconds));
    }

    /// Asks that substeps be no longer than `seconds`, of which a step may hold `most`.
    pub fn propose_for_substeps(&mut self, name: &'static str, seconds: f64, most: u32) {
        self.substep = self.substep.min(seconds);
        self.propose(name, seconds * f64::from(most.max(1)));
    }

    /// Asks that substeps be no longer than a `part` of what is allowed so far, and that a step hold at most `most` of them.
    pub fn shorten_substeps(&mut self, name: &'static str, part: f64, most: u32) {
        self.propose_for_substeps(name, part * self.substep, most);
    }

    /// The least number of equal substeps of a step of `length` seconds.
    fn substeps(&self, length: f64) -> u32 {
        (length / self.substep - TOLERANCE).ceil().max(1.0) as u32
    }

    /// The tightest limit, s; NaN counts as the tightest, and the first of equals wins.
    #[must_use]
    pub fn tightest(&self) -> Option<(&'static str, f64)> {
        let tighter = |a: f64, b: f64| b.is_nan() && !a.is_nan() || b < a;
        self.steps.iter().copied().reduce(|a, b| if tighter(a.1, b.1) { b } else { a })
    }

    /// Forgets the limits of the step before.
    pub fn begin_step(&mut self) {
        *self = Self::default();
    }
}

/// Writes [`Clock::step_length`] and [`Clock::substeps`] from the limits and the horizon.
pub fn choose_step_length(limits: Res<StepLimits>, mut clock: ResMut<Clock>, mut faults: ResMut<Faults>) {
    let (name, limit) = limits.tightest().unwrap_or(("horizon", f64::INFINITY));
    let length = step_length(limit, clock.horizon - clock.time);
    if limit > 0.0 && clock.time + length > clock.time {
        clock.step_length = length;
        clock.substeps = limits.substeps(length);
    } else {
        let detail = format!("cannot be chosen: `{name}` asks for at most {limit:e} s");
        faults.report(Fault::new(Stage::Clock, "step length", detail));
    }
}

/// Time at the end of the present step: the horizon itself where the step is the last before it.
#[must_use]
pub fn end_of_step(clock: &Clock) -> f64 {
    let end = clock.time + clock.step_length;
    if (clock.horizon - end).abs() <= TOLERANCE * clock.step_length { clock.horizon } else { end }
}

/// `remaining / n` with the least whole `n` for which that is within `limit`.
fn step_length(limit: f64, remaining: f64) -> f64 {
    remaining / (remaining / limit - TOLERANCE).ceil().max(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy_ecs::system::RunSystemOnce;
    use bevy_ecs::world::World;
    use proptest::prelude::*;

    fn limits(proposed: &[(&'static str, f64)]) -> StepLimits {
        let mut limits = StepLimits::default();
        proposed.iter().for_each(|(name, seconds)| limits.propose(name, *seconds));
        limits
    }

    #[test]
    fn a_step_holds_no_more_substeps_than_allowed() {
        let mut world = World::new();
        world.init_resource::<Faults>();
        for (cfl, expected) in [(0.02, (0.01, 4)), (0.004, (0.004, 2)), (1e-3, (1e-3, 1))] {
            let mut limits = limits(&[("cfl", cfl)]);
            limits.propose_for_substeps("tension", 0.0025, 4);
            world.insert_resource(Clock { horizon: 0.02, ..Clock::default() });
            world.insert_resource(limits);
            world.run_system_once(choose_step_length).unwrap();
            let clock = world.resource::<Clock>();
            assert_eq!((clock.step_length, clock.substeps), expected);
            assert!(clock.substep_length() <= 0.0025);
        }
    }

    #[test]
    fn steps_before_a_frame_are_equal() {
        assert_eq!(step_length(0.019, 0.02), 0.01);
        assert_eq!(step_length(0.02, 0.02), 0.02);
        assert_eq!(step_length(f64::INFINITY, 0.02), 0.02);
    }

    #[test]
    fn a_limit_that_leaves_no_time_is_a_fault() {
        for limit in [0.0, -1.0, f64::NAN, 1e-30] {
            let mut world = World::new();
            world.insert_resource(Clock { time: 1.0, horizon: 1.02, ..Clock::default() });
            world.insert_resource(limits(&[("cfl", limit)]));
            world.init_resource::<Faults>();
            world.run_system_once(choose_step_length).unwrap();
            assert!(!Faults::none(&world), "{limit}");
        }
    }

    #[test]
    fn the_tightest_limit_wins_and_nan_is_tightest() {
        let mut limits = StepLimits::default();
        assert_eq!(limits.tightest(), None);
        limits.propose("cfl", 2.0);
        limits.propose("capillary", 1.0);
        assert_eq!(limits.tightest(), Some(("capillary", 1.0)));
        limits.propose("broken", f64::NAN);
        assert_eq!(limits.tightest().unwrap().0, "broken");
    }

    proptest! {
        #[test]
        fn a_frame_is_hit_exactly_in_as_few_steps_as_the_limit_allows(limit in 1e-5..1.0_f64, from in 0.0..10.0_f64) {
            let horizon = from + 0.02;
            let mut clock = Clock { time: from, horizon, ..Clock::default() };
            let mut steps = 0;
            while clock.time < horizon {
                clock.step_length = step_length(limit, horizon - clock.time);
                prop_assert!(clock.step_length <= limit * (1.0 + 2.0 * TOLERANCE));
                clock.time = end_of_step(&clock);
                steps += 1;
            }
            prop_assert_eq!(clock.time, horizon);
            prop_assert!(f64::from(steps) <= (0.02 / limit).ceil() + 1.0);
        }
    }
}
