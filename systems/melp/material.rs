//! Moves the liquid with the flow and lays it back onto the film.
//!
//! # Equation
//! `x += dt (u + dt/2 A u)`, then twice `x -= phi n` with the film blended from its carriers' quadratics,
//! `phi = sum W h_E / sum W`, `h_E` the height above carrier E's quadratic. `u` and `A` turn with the normal.
//!
//! # Source
//! Deng 2022, Algorithm 7, §4.8 (moving least squares). DEVIATION: blended quadratics are smooth between particles and
//! need no solve per particle.

use super::state::FilmStencil;
use crate::observe::{Fault, Faults};
use crate::rows::{columns, columns_mut};
use crate::stage::Stage;
use bevy_ecs::query::{With, Without};
use bevy_ecs::system::{Query, Res, ResMut};
use froth_components::clock::Clock;
use froth_components::kind::{EulerianParticle, LagrangianParticle};
use froth_components::lamella::Lamellae;
use super::links::Carriers;
use crate::neighbours::kernel::Kernel;
use crate::operators::quadratic::height_above;
use crate::operators::tangent::{MinimalRotation, tangential};
use froth_components::film::ShapeOperator;
use froth_components::identity::InRegion;
use froth_components::lamella::Rim;
use froth_components::motion::{Normal, Position, Velocity, VelocityGradient};
use glam::DVec3;
use rayon::prelude::*;

/// Projections after each move.
const PROJECTIONS: usize = 2;

/// Advances one particle's place in its tangent plane by `step` seconds, second order along the affine flow.
#[must_use]
pub fn drifted(place: DVec3, velocity: DVec3, gradient: glam::DMat3, step: f64) -> DVec3 {
    place + (velocity + gradient * velocity * (0.5 * step)) * step
}

/// The columns of the material particles that a move changes.
pub struct MovingMaterial<'a> {
    /// Places.
    pub positions: &'a mut [Position],
    /// Unit normals.
    pub normals: &'a mut [Normal],
    /// Tangential velocities.
    pub velocities: &'a mut [Velocity],
    /// Velocity gradients.
    pub gradients: &'a mut [VelocityGradient],
    /// Regions.
    pub regions: &'a [InRegion],
}

/// Moves all material particles by `step` seconds onto the film given by `carriers` and their `shapes`; `rim(region)`
/// is the rim of a region's film. Returns how many found no carrier in reach.
pub fn advance_all(
    material: MovingMaterial,
    carriers: Carriers,
    shapes: &[ShapeOperator],
    step: f64,
    rim: impl Fn(InRegion) -> Option<Rim> + Sync,
) -> usize {
    let kernel = carriers.kernel();
    let MovingMaterial { positions, normals, velocities, gradients, regions } = material;
    let moving = positions.par_iter_mut().zip(normals).zip(velocities).zip(gradients).zip(regions);
    moving
        .with_min_len(256)
        .map(|((((position, normal), velocity), gradient), region)| {
            let place = drifted(position.0, velocity.0, gradient.0, step);
            let rim = rim(*region);
            let Some((place, new_normal)) = project(carriers, &kernel, shapes, confined(rim, place), normal.0, *region)
            else {
                return 1;
            };
            let turn = MinimalRotation::between(normal.0, new_normal);
            velocity.0 = tangential(turn.apply(velocity.0), new_normal);
            let rotation = turn.matrix();
            gradient.0 = rotation * gradient.0 * rotation.transpose();
            position.0 = confined(rim, place);
            normal.0 = new_normal;
            0
        })
        .sum()
}

fn confined(rim: Option<Rim>, place: DVec3) -> DVec3 {
    rim.map_or(place, |rim| rim.confine(place))
}

/// The point of the film nearest to `place` along the blended normal, and that normal; `None` if no carrier is in
/// reach.
#[must_use]
pub fn project(
    carriers: Carriers,
    kernel: &Kernel,
    shapes: &[ShapeOperator],
    place: DVec3,
    normal: DVec3,
    region: InRegion,
) -> Option<(DVec3, DVec3)> {
    let (mut place, mut normal) = (place, normal);
    for _ in 0..PROJECTIONS {
        let (mut sum, mut height, mut direction) = (0.0, 0.0, DVec3::ZERO);
        carriers.for_each_near(kernel, place, normal, region, |e, r, w| {
            let (h, d) = height_above(-r, carriers.normals[e].0, &shapes[e].0);
            sum += w;
            height += w * h;
            direction += d * w;
        });
        normal = direction.try_normalize()?;
        place -= normal * (height / sum);
    }
    Some((place, normal))
}

/// Moves the material particles and projects them onto the film.
pub fn advance_material(
    carriers: Query<(&Position, &Normal, &InRegion, &ShapeOperator), With<EulerianParticle>>,
    mut material: Query<
        (&InRegion, &mut Position, &mut Normal, &mut Velocity, &mut VelocityGradient),
        (With<LagrangianParticle>, Without<EulerianParticle>),
    >,
    lamellae: Res<Lamellae>,
    stencil: Res<FilmStencil>,
    clock: Res<Clock>,
    mut faults: ResMut<Faults>,
) {
    let (positions, normals, regions, shapes) = columns(&carriers);
    let carriers = Carriers { positions, normals, regions, stencil: &stencil.0, spacing: lamellae.spacing };
    let (regions, mut positions, mut normals, mut velocities, mut gradients) = columns_mut(&mut material);
    let moving = MovingMaterial {
        positions: positions.bypass_change_detection(),
        normals: normals.bypass_change_detection(),
        velocities: velocities.bypass_change_detection(),
        gradients: gradients.bypass_change_detection(),
        regions,
    };
    let rim = |region: InRegion| lamellae.films.iter().find(|film| film.region == region.0).and_then(|film| film.rim);
    let lost = advance_all(moving, carriers, shapes, clock.step_length, rim);
    if lost > 0 {
        let detail = format!("of {lost} material particles is farther from the film than any carrier reaches");
        faults.report(Fault::new(Stage::Advance, "position", detail));
    }
}
