//! The step length MELP itself asks for.
//!
//! # Equation
//! No particle crosses more than `cfl` spacings: `u dt + a dt^2/2 <= cfl dx`, with the fastest particle `u` and the
//! largest external acceleration `a` of the step before.
//!
//! # Source
//! Deng 2022, §6.3 (CFL 0.99).

use super::settings::Melp;
use crate::clock::StepLimits;
use crate::observe::Observables;
use crate::rows::columns;
use crate::rows::reduce::ordered_max;
use bevy_ecs::query::With;
use bevy_ecs::system::{Query, Res, ResMut};
use froth_components::clock::Clock;
use froth_components::kind::{EulerianParticle, LagrangianParticle};
use froth_components::lamella::Lamellae;
use froth_components::motion::{ExternalAcceleration, NormalSpeed, Velocity};

/// Acceleration assumed before the first step has measured one, m/s^2: twice gravity.
const FIRST_ACCELERATION: f64 = 20.0;

/// Proposes the step length by the fastest particle.
pub fn limit_step_by_speed(
    carriers: Query<(&NormalSpeed, &Velocity, &ExternalAcceleration), With<EulerianParticle>>,
    liquid: Query<&Velocity, With<LagrangianParticle>>,
    melp: Res<Melp>,
    lamellae: Res<Lamellae>,
    clock: Res<Clock>,
    mut limits: ResMut<StepLimits>,
    mut observables: ResMut<Observables>,
) {
    let (normal_speeds, velocities, accelerations) = columns(&carriers);
    let mut fastest = ordered_max(velocities.len(), 0.0, |i| velocities[i].0.length().max(normal_speeds[i].0.abs()));
    if !liquid.is_empty() {
        let liquid = columns(&liquid);
        fastest = ordered_max(liquid.len(), fastest, |l| liquid[l].0.length());
    }
    let pushed = ordered_max(accelerations.len(), 0.0, |i| accelerations[i].0.length());
    let pushed = if clock.steps == 0 { pushed.max(FIRST_ACCELERATION) } else { pushed };
    limits.propose("cfl", time_to_cross(melp.cfl * lamellae.spacing, fastest, pushed));
    observables.record("max_speed", "m/s", fastest);
}

/// Time in which a particle at `speed` under `acceleration` covers `distance`, s.
fn time_to_cross(distance: f64, speed: f64, acceleration: f64) -> f64 {
    // The stable root of a t^2/2 + u t = d, also for a = 0 and u = 0.
    2.0 * distance / (speed + (speed * speed + 2.0 * acceleration * distance).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn crossing_times_follow_newton() {
        assert_eq!(time_to_cross(1.0, 2.0, 0.0), 0.5);
        assert_eq!(time_to_cross(1.0, 0.0, 2.0), 1.0);
        assert_eq!(time_to_cross(1.0, 0.0, 0.0), f64::INFINITY);
    }
}
