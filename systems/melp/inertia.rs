//! The liquid's own tangential acceleration before tension answers it.
//!
//! # Equation
//! `u* = u + dt [ f_t + grad(s^2/2) - s S u + nu lap u ]`
//!
//! The second and third terms come from the film's own motion: seen along a particle, `D(u + s n)/Dt` has the
//! tangential part `Du/Dt + s (S u - grad s)`.
//!
//! # Source
//! Derived; Deng 2022, Eq. 15 has the external force only.

use super::normal_motion::NormalMotion;
use super::settings::Melp;
use super::state::{FilmStencil, TangentialFlow};
use crate::operators::stencil::Stencil;
use crate::operators::tangent::{MinimalRotation, tangential};
use crate::rows::{columns, columns_mut};
use bevy_ecs::query::With;
use bevy_ecs::system::{Query, Res, ResMut};
use froth_components::clock::Clock;
use froth_components::film::ShapeOperator;
use froth_components::kind::EulerianParticle;
use froth_components::material::Liquid;
use froth_components::motion::Normal;
use froth_components::motion::{ExternalAcceleration, NormalSpeed, Position, Velocity};
use glam::DVec3;
use rayon::prelude::*;

/// Largest part of a particle's velocity that viscosity may exchange in one explicit sweep.
const LARGEST_EXCHANGE: f64 = 0.5;

/// Smooths tangential velocities by viscosity `nu` (m^2/s) over `step` seconds, in as many explicit sweeps as are
/// stable; vectors pass between tangent planes by the minimal rotation, so rigid rotation of a sphere feels only the
/// stencil's error. Returns the number of sweeps.
pub fn diffuse(stencil: &Stencil, normals: &[Normal], velocities: &mut [DVec3], viscosity: f64, step: f64) -> u32 {
    let exchange = |i: usize| stencil.pairs(i).map(|(_, w)| w).sum::<f64>() / stencil.areas[i];
    let fastest = crate::rows::reduce::ordered_max(stencil.len(), 0.0, exchange);
    let sweeps = (viscosity * step * fastest / LARGEST_EXCHANGE).ceil() as u32;
    for _ in 0..sweeps {
        let rate = viscosity * step / f64::from(sweeps);
        mix(stencil, normals, velocities, |i, w| rate * w / stencil.areas[i]);
    }
    sweeps
}

/// XSPH: moves each velocity toward the weighted mean of its neighbours by `share` (0 to 1).
pub fn smooth(stencil: &Stencil, normals: &[Normal], velocities: &mut [DVec3], share: f64) {
    let sums: Vec<f64> = (0..stencil.len()).map(|i| stencil.pairs(i).map(|(_, w)| w).sum()).collect();
    mix(stencil, normals, velocities, |i, w| share * w / sums[i]);
}

fn mix(stencil: &Stencil, normals: &[Normal], velocities: &mut [DVec3], weight: impl Fn(usize, f64) -> f64 + Sync) {
    let old = velocities.to_vec();
    velocities.par_iter_mut().enumerate().with_min_len(128).for_each(|(i, u)| {
        let n = normals[i].0;
        for (j, w) in stencil.pairs(i) {
            let there = MinimalRotation::between(normals[j].0, n).apply(old[j]);
            *u += (there - old[i]) * weight(i, w);
        }
        *u = tangential(*u, n);
    });
}

/// Columns of the carriers that the liquid's acceleration reads.
type InertiaColumns<'w, 's> = Query<
    'w,
    's,
    (&'static Position, &'static Normal, &'static ShapeOperator, &'static ExternalAcceleration),
    With<EulerianParticle>,
>;

/// Accelerates the liquid by external forces, the film's own motion, viscosity and smoothing.
pub fn accelerate_liquid(
    carriers: InertiaColumns,
    stencil: Res<FilmStencil>,
    liquid: Res<Liquid>,
    melp: Res<Melp>,
    clock: Res<Clock>,
    motion: Res<NormalMotion>,
    mut flow: ResMut<TangentialFlow>,
) {
    let (positions, normals, shapes, pushes) = columns(&carriers);
    let (stencil, step) = (&stencil.0, clock.substep_length());
    let speed = |i: usize| motion.displacement[i] / step;
    let accelerated = |i: usize| {
        let (n, u) = (normals[i].0, flow.present[i]);
        let own = stencil.gradient(positions, normals, i, |j| 0.5 * speed(j) * speed(j)) - shapes[i].0 * u * speed(i);
        u + (tangential(pushes[i].0, n) + own) * step
    };
    let mut velocities: Vec<DVec3> = (0..stencil.len()).into_par_iter().with_min_len(128).map(accelerated).collect();
    if liquid.viscosity > 0.0 {
        diffuse(stencil, normals, &mut velocities, liquid.viscosity, step);
    }
    if melp.xsph > 0.0 {
        smooth(stencil, normals, &mut velocities, melp.xsph);
    }
    flow.solved = velocities;
}

/// Writes the whole velocity of the carriers, tangential and normal, for forces and observers.
pub fn write_velocity(
    mut carriers: Query<(&Normal, &NormalSpeed, &mut Velocity), With<EulerianParticle>>,
    flow: Res<TangentialFlow>,
) {
    let (normals, speeds, mut velocities) = columns_mut(&mut carriers);
    for (i, velocity) in velocities.bypass_change_detection().iter_mut().enumerate() {
        velocity.0 = flow.solved.get(i).copied().unwrap_or_default() + normals[i].0 * speeds[i].0;
    }
}
