//! The step length MELP itself asks for.
//!
//! # Equation
//! No particle crosses more than `cfl` spacings of its film: `u dt + a dt^2/2 <= cfl dx`, with the fastest particle `u`
//! relative to its film's frame and the largest external acceleration `a` of the step before.
//!
//! # Source
//! Deng 2022, §6.3 (CFL 0.99).

use super::frames::FilmFrames;
use super::settings::Melp;
use crate::clock::StepLimits;
use crate::operators::tangent::tangential;
use crate::rows::columns;
use crate::rows::reduce::ordered_max;
use bevy_ecs::query::With;
use bevy_ecs::system::{Query, Res, ResMut};
use froth_components::clock::Clock;
use froth_components::identity::InRegion;
use froth_components::kind::{EulerianParticle, LagrangianParticle};
use froth_components::lamella::Lamellae;
use froth_components::motion::{ExternalAcceleration, Normal, NormalSpeed, Velocity};

/// Acceleration assumed before the first step has measured one, m/s^2: twice gravity.
const FIRST_ACCELERATION: f64 = 20.0;

/// Proposes the step length by the fastest particle.
pub fn limit_step_by_speed(
    carriers: Query<(&InRegion, &Normal, &NormalSpeed, &ExternalAcceleration), With<EulerianParticle>>,
    liquid: Query<(&InRegion, &Normal, &Velocity), With<LagrangianParticle>>,
    frames: Res<FilmFrames>,
    melp: Res<Melp>,
    lamellae: Res<Lamellae>,
    clock: Res<Clock>,
    mut limits: ResMut<StepLimits>,
) {
    let (regions, normals, speeds, accelerations) = columns(&carriers);
    let across = |i: usize| (speeds[i].0 - frames.of(regions[i]).dot(normals[i].0)).abs();
    let mut fastest = ordered_max(speeds.len(), 0.0, across);
    if !liquid.is_empty() {
        let (regions, normals, velocities) = columns(&liquid);
        let along = |l: usize| velocities[l].0 - tangential(frames.of(regions[l]), normals[l].0);
        fastest = ordered_max(velocities.len(), fastest, |l| along(l).length());
    }
    let pushed = ordered_max(accelerations.len(), 0.0, |i| accelerations[i].0.length());
    let pushed = if clock.steps == 0 { pushed.max(FIRST_ACCELERATION) } else { pushed };
    limits.propose("cfl", time_to_cross(melp.cfl * lamellae.spacing, fastest, pushed));
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
