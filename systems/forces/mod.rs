//! External forces: everything that pushes the film from outside.
//!
//! Each is a system in [`Stage::Forces`](crate::stage::Stage::Forces) that adds to `ExternalAcceleration` (per mass of
//! liquid) or `ExternalPressure` (per area of film), whatever the method. [`clear`] goes first.

use crate::rows::columns_mut;
use bevy_ecs::entity::Entity;
use bevy_ecs::query::With;
use bevy_ecs::system::{Query, Res};
use froth_components::authored::field::{AirDrag, Gravity, HeatSource, Hover, Sweep, Wind};
use froth_components::clock::Clock;
use froth_components::film::{Area, Thickness, Warmth};
use froth_components::kind::{EulerianParticle, Kind};
use froth_components::lamella::Lamellae;
use froth_components::material::Liquid;
use froth_components::motion::{ExternalAcceleration, ExternalPressure, Normal, NormalSpeed, Position, Velocity};
use glam::{DMat3, DVec3};

pub mod heat;

/// Forgets the forces of the step before.
pub fn clear<K: Kind>(mut carriers: Query<(&mut ExternalAcceleration, &mut ExternalPressure), With<K>>) {
    let (mut pushes, mut pressures) = columns_mut(&mut carriers);
    pushes.bypass_change_detection().fill(ExternalAcceleration::default());
    pressures.bypass_change_detection().fill(ExternalPressure::default());
}

/// Adds gravity, lessened where the film is warm: `g (1 - beta T)` with the strongest heat source's `beta`.
pub fn pull_by_gravity(
    fields: Query<&Gravity>,
    heat: Query<&HeatSource>,
    mut carriers: Query<(&Warmth, &mut ExternalAcceleration), With<EulerianParticle>>,
    clock: Res<Clock>,
) {
    let gravity: DVec3 = fields.iter().map(|field| field.0.at(clock.time).si()).sum();
    let expansion = heat.iter().map(|source| source.expansion.si()).fold(0.0, f64::max);
    let (warmth, mut pushes) = columns_mut(&mut carriers);
    for (push, warmth) in pushes.bypass_change_detection().iter_mut().zip(warmth) {
        push.0 += gravity * (1.0 - expansion * warmth.0);
    }
}

/// Adds gravity to films without warmth.
pub fn pull_evenly_by_gravity<K: Kind>(
    fields: Query<&Gravity>,
    mut carriers: Query<&mut ExternalAcceleration, With<K>>,
    clock: Res<Clock>,
) {
    let gravity: DVec3 = fields.iter().map(|field| field.0.at(clock.time).si()).sum();
    columns_mut(&mut carriers).bypass_change_detection().iter_mut().for_each(|push| push.0 += gravity);
}

/// Drags the film along with the wind: `drag (velocity - u)`.
pub fn drag_by_wind(
    winds: Query<&Wind>,
    mut carriers: Query<(&Velocity, &mut ExternalAcceleration), With<EulerianParticle>>,
    clock: Res<Clock>,
) {
    let (velocities, mut pushes) = columns_mut(&mut carriers);
    let pushes = pushes.bypass_change_detection();
    for wind in &winds {
        let (air, rate) = (wind.velocity.at(clock.time).si(), relaxation(wind.drag.si(), clock.substep_length()));
        pushes.iter_mut().zip(velocities).for_each(|(push, u)| push.0 += (air - u.0) * rate);
    }
}

/// Brakes the film in still air: its liquid's flow at `rate`, its motion along the normal, air included, at `normal`.
pub fn brake_in_air(
    drags: Query<&AirDrag>,
    mut carriers: Query<
        (&Velocity, &Normal, &NormalSpeed, &Thickness, &mut ExternalAcceleration, &mut ExternalPressure),
        With<EulerianParticle>,
    >,
    lamellae: Res<Lamellae>,
    liquid: Res<Liquid>,
    clock: Res<Clock>,
) {
    let (velocities, normals, speeds, thickness, mut pushes, mut pressures) = columns_mut(&mut carriers);
    let along = relaxation(drags.iter().map(|drag| drag.rate.si()).sum(), clock.substep_length());
    for ((push, u), n) in pushes.bypass_change_detection().iter_mut().zip(velocities).zip(normals) {
        push.0 -= (u.0 - n.0 * n.0.dot(u.0)) * along;
    }
    let across = relaxation(drags.iter().map(|drag| drag.normal.si()).sum(), clock.substep_length());
    let pressures = pressures.bypass_change_detection();
    for film in &lamellae.films {
        for i in film.carriers.clone() {
            pressures[i].0 -= across * (liquid.density * thickness[i].0 + film.air_mass) * speeds[i].0;
        }
    }
}

/// The constant rate that over `step` does what the exponential decay at `rate` does: stable for any step.
fn relaxation(rate: f64, step: f64) -> f64 {
    if step > 0.0 { -(-rate * step).exp_m1() / step } else { rate }
}

/// Pushes the film along its normal by a pulse of pressure that travels over it: `p exp(-(s/width)^2)`.
pub fn sweep(
    sweeps: Query<&Sweep>,
    mut carriers: Query<(&Position, &mut ExternalPressure), With<EulerianParticle>>,
    clock: Res<Clock>,
) {
    let (positions, mut pressures) = columns_mut(&mut carriers);
    let pressures = pressures.bypass_change_detection();
    for sweep in &sweeps {
        let strength = sweep.pressure.at(clock.time).si();
        let front = sweep.start.si() + sweep.speed.si() * clock.time;
        for (pressure, x) in pressures.iter_mut().zip(positions) {
            let s = (x.0.dot(sweep.direction.unit()) - front) / sweep.width.si();
            pressure.0 += strength * (-s * s).exp();
        }
    }
}

/// Holds closed films up: a pressure difference linear in space, `p = -b . (x - centre)`, that carries each film's
/// weight exactly in the sum over its particles. Tangential gravity stays whole, so films drain and swirl. Runs right after
/// gravity: what is pushed so far is the weight, and no other force is held against.
pub fn hold_up(
    hovering: Query<Entity, With<Hover>>,
    mut carriers: Query<
        (&Position, &Normal, &Area, &Thickness, &ExternalAcceleration, &mut ExternalPressure),
        With<EulerianParticle>,
    >,
    lamellae: Res<Lamellae>,
    liquid: Res<Liquid>,
) {
    if hovering.is_empty() {
        return;
    }
    let (positions, normals, areas, thickness, pushes, mut pressures) = columns_mut(&mut carriers);
    let pressures = pressures.bypass_change_detection();
    for film in lamellae.films.iter().filter(|film| film.rim.is_none()) {
        let rows = film.carriers.clone();
        let area: f64 = rows.clone().map(|i| areas[i].0).sum();
        let centre = rows.clone().map(|i| positions[i].0 * areas[i].0).sum::<DVec3>() / area;
        let weight: DVec3 = rows.clone().map(|i| pushes[i].0 * (liquid.density * thickness[i].0 * areas[i].0)).sum();
        // sum a n (x - c)^T is the enclosed volume times the identity, up to sampling; using it makes the sum exact.
        let moment = rows.clone().fold(DMat3::ZERO, |m, i| {
            m + crate::operators::tangent::outer(areas[i].0, normals[i].0, positions[i].0 - centre)
        });
        let slope = moment.inverse() * weight;
        rows.for_each(|i| pressures[i].0 -= slope.dot(positions[i].0 - centre));
    }
}
