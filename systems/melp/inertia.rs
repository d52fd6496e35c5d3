//! The liquid's own tangential acceleration before tension answers it.
//!
//! # Equation
//! `u* = u + dt [ f_t + grad(s^2/2) - s S u + nu (lap u + K u) ]`, `K = det S` (Gaussian curvature)
//!
//! The second and third terms come from the film's own motion: seen along a particle, `D(u + s n)/Dt` has the
//! tangential part `Du/Dt + s (S u - grad s)`.
//!
//! # Source
//! Derived; Deng 2022, Eq. 15 has the external force only.

use super::frames::FilmFrames;
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
use froth_components::identity::InRegion;
use froth_components::kind::EulerianParticle;
use froth_components::material::Liquid;
use froth_components::motion::Normal;
use froth_components::motion::{ExternalAcceleration, NormalSpeed, Position, Velocity};
use glam::{DMat3, DVec3};
use rayon::prelude::*;

/// Largest part of a particle's velocity that viscosity may exchange in one explicit sweep.
const LARGEST_EXCHANGE: f64 = 0.5;

/// Smooths tangential velocities by viscosity `nu` (m^2/s) over `step` seconds, in as many explicit sweeps as are stable.
///
/// Vectors pass between tangent planes by the minimal rotation, which makes `lap` the connection's Laplacian. `K u` makes
/// it the divergence of the rate of strain: a sphere that rotates as a whole is not braked.
///
/// # Limits
/// The viscosity per area is that of a film of even thickness; a rim is slippery.
pub fn diffuse(
    stencil: &Stencil,
    normals: &[Normal],
    shapes: &[ShapeOperator],
    velocities: &mut [DVec3],
    viscosity: f64,
    step: f64,
) -> u32 {
    let exchange = |i: usize| stencil.pairs(i).map(|(_, w)| w).sum::<f64>() / stencil.areas[i];
    let fastest = crate::rows::reduce::ordered_max(stencil.len(), 0.0, exchange);
    let sweeps = (viscosity * step * fastest / LARGEST_EXCHANGE).ceil() as u32;
    for _ in 0..sweeps {
        let rate = viscosity * step / f64::from(sweeps);
        let bent: Vec<DVec3> =
            velocities.iter().zip(shapes).map(|(u, shape)| *u * (rate * gaussian_curvature(&shape.0))).collect();
        mix(stencil, normals, velocities, |i, w| rate * w / stencil.areas[i]);
        velocities.iter_mut().zip(&bent).for_each(|(u, bent)| *u += *bent);
    }
    sweeps
}

/// Product of the principal curvatures of a shape operator, which has no part along the normal, 1/m^2.
fn gaussian_curvature(shape: &DMat3) -> f64 {
    let trace = shape.x_axis.x + shape.y_axis.y + shape.z_axis.z;
    let squares: f64 = shape.to_cols_array().iter().map(|v| v * v).sum();
    0.5 * (trace * trace - squares)
}

/// XSPH: moves each velocity toward the weighted mean of its neighbours by `share` (0 to 1).
pub fn smooth(stencil: &Stencil, normals: &[Normal], velocities: &mut [DVec3], share: f64) {
    let sums: Vec<f64> = (0..stencil.len()).map(|i| stencil.pairs(i).map(|(_, w)| w).sum()).collect();
    mix(stencil, normals, velocities, |i, w| share * w / sums[i]);
}

/// The share that, applied in each of `substeps`, leaves of a difference what `share` once per step leaves.
fn share_per_substep(share: f64, substeps: u32) -> f64 {
    1.0 - (1.0 - share).powf(1.0 / f64::from(substeps.max(1)))
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
        diffuse(stencil, normals, shapes, &mut velocities, liquid.viscosity, step);
    }
    if melp.xsph > 0.0 {
        smooth(stencil, normals, &mut velocities, share_per_substep(melp.xsph, clock.substeps));
    }
    flow.solved = velocities;
}

/// Writes the whole velocity of the carriers, tangential and normal, for forces and observers.
pub fn write_velocity(
    mut carriers: Query<(&InRegion, &Normal, &NormalSpeed, &mut Velocity), With<EulerianParticle>>,
    frames: Res<FilmFrames>,
    flow: Res<TangentialFlow>,
) {
    let (regions, normals, speeds, mut velocities) = columns_mut(&mut carriers);
    for (i, velocity) in velocities.bypass_change_detection().iter_mut().enumerate() {
        let (n, relative) = (normals[i].0, flow.solved.get(i).copied().unwrap_or_default());
        velocity.0 = relative + tangential(frames.of(regions[i]), n) + n * speeds[i].0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::operators::stencil::Points;
    use crate::operators::tangent::outer;
    use crate::sampling::spread::sphere_cap;
    use froth_components::identity::InRegion;

    /// A unit sphere, its normals and shape operators.
    fn sphere(count: usize) -> (Stencil, Vec<Normal>, Vec<ShapeOperator>) {
        let normals: Vec<Normal> = sphere_cap(count, -1.0).map(Normal).collect();
        let positions: Vec<Position> = normals.iter().map(|n| Position(n.0)).collect();
        let regions = vec![InRegion::default(); count];
        let spacing = (4.0 * std::f64::consts::PI / count as f64).sqrt();
        let (positions, regions) = (&positions[..], &regions[..]);
        let points = Points { positions, normals: &normals, regions, wall: &[], wall_regions: &[], spacing };
        let stencil = Stencil::build(points);
        let shapes = normals.iter().map(|n| ShapeOperator(DMat3::IDENTITY - outer(1.0, n.0, n.0))).collect();
        (stencil, normals, shapes)
    }

    /// What is left of a flow, as its projection on itself.
    fn left(
        flow: impl Fn(DVec3) -> DVec3,
        change: impl Fn(&Stencil, &[Normal], &[ShapeOperator], &mut [DVec3]),
    ) -> f64 {
        let (stencil, normals, shapes) = sphere(2000);
        let before: Vec<DVec3> = normals.iter().map(|n| flow(n.0)).collect();
        let mut after = before.clone();
        change(&stencil, &normals, &shapes, &mut after);
        let dot = |a: &[DVec3], b: &[DVec3]| a.iter().zip(b).map(|(a, b)| a.dot(*b)).sum::<f64>();
        dot(&before, &after) / dot(&before, &before)
    }

    #[test]
    fn eddies_decay_by_viscosity_and_rigid_rotation_does_not() {
        let viscous = |stencil: &Stencil, normals: &[Normal], shapes: &[ShapeOperator], flow: &mut [DVec3]| {
            assert!(diffuse(stencil, normals, shapes, flow, 0.5, 0.02) >= 1);
        };
        let rigid = left(|x| DVec3::Z.cross(x), viscous);
        assert!((rigid - 1.0).abs() < 2e-4, "{rigid}");
        // Eddies of degree l decay at nu ((l - 1)(l + 2))/R^2: 4 for l = 2.
        let eddies = left(|x| DVec3::Z.cross(x) * x.z, viscous);
        assert!((eddies.ln() / (-4.0 * 0.5 * 0.02) - 1.0).abs() < 0.03, "{eddies}");
    }

    #[test]
    fn smoothing_does_not_depend_on_the_number_of_substeps() {
        let smoothed = |substeps: u32| {
            left(
                |x| DVec3::Z.cross(x) * x.z,
                |stencil, normals, _, flow| {
                    let share = share_per_substep(0.3, substeps);
                    (0..substeps).for_each(|_| smooth(stencil, normals, flow, share));
                },
            )
        };
        let (once, often) = (1.0 - smoothed(1), 1.0 - smoothed(8));
        assert!(once > 1e-3 && (often / once - 1.0).abs() < 0.25, "{once} {often}");
    }
}
