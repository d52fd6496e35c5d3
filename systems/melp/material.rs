//! Moves the liquid with the flow and lays it back onto the film.
//!
//! # Equation
//! `x += dt (u_mean + dt/2 A u_mean)`, then twice `x -= phi n` with the film blended from its carriers' quadratics,
//! `phi = sum W h_E / sum W`, `h_E` the height above carrier E's quadratic. `u` and `A` turn with the normal.
//!
//! # Source
//! Deng 2022, Algorithm 7, §4.8 (moving least squares). DEVIATION: blended quadratics are smooth between particles and
//! need no solve per particle.

use super::frames::FilmFrames;
use super::links::Carriers;
use super::state::{FilmStencil, Transfers};
use super::tiles::{PIECE, Rows, Tile};
use crate::observe::{Fault, Faults};
use crate::operators::quadratic::height_above;
use crate::operators::tangent::{MinimalRotation, tangential};
use crate::rows::{columns, columns_mut};
use crate::stage::Stage;
use bevy_ecs::query::{With, Without};
use bevy_ecs::system::{Query, Res, ResMut};
use froth_components::clock::Clock;
use froth_components::film::ShapeOperator;
use froth_components::identity::InRegion;
use froth_components::kind::{EulerianParticle, LagrangianParticle};
use froth_components::lamella::Lamellae;
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
    /// Velocities to move by.
    pub drift: &'a [DVec3],
    /// Tangential velocities.
    pub velocities: &'a mut [Velocity],
    /// Velocity gradients.
    pub gradients: &'a mut [VelocityGradient],
    /// Regions.
    pub regions: &'a [InRegion],
}

/// Moves all material particles by `step` seconds, with their films' frames, onto the film given by `carriers` and their `shapes`; `rim(region)`
/// is the rim of a region's film. Returns how many found no carrier in reach.
pub fn advance_all(
    material: MovingMaterial,
    carriers: Carriers,
    shapes: &[ShapeOperator],
    step: f64,
    frames: &FilmFrames,
    rim: impl Fn(InRegion) -> Option<Rim> + Sync,
) -> usize {
    let MovingMaterial { positions, normals, drift, velocities, gradients, regions } = material;
    let places = positions.par_chunks_mut(PIECE).zip(normals.par_chunks_mut(PIECE)).zip(drift.par_chunks(PIECE));
    let flow = velocities.par_chunks_mut(PIECE).zip(gradients.par_chunks_mut(PIECE));
    let pieces = places.zip(flow).zip(regions.par_chunks(PIECE));
    let advance = |projector: &mut Projector, ((((positions, normals), drift), (velocities, gradients)), regions)| {
        let piece = MovingMaterial { positions, normals, drift, velocities, gradients, regions };
        projector.advance(piece, carriers, shapes, step, frames, &rim)
    };
    pieces.map_init(Projector::default, advance).sum()
}

fn confined(rim: Option<Rim>, place: DVec3) -> DVec3 {
    rim.map_or(place, |rim| rim.confine(place))
}

/// Work space to move and project one piece of rows after another.
#[derive(Default)]
struct Projector {
    tile: Tile,
    places: Vec<Position>,
    normals: Vec<Normal>,
}

impl Projector {
    /// Moves one piece of rows; how many found no carrier in reach. Those stay.
    fn advance(
        &mut self,
        material: MovingMaterial,
        carriers: Carriers,
        shapes: &[ShapeOperator],
        step: f64,
        frames: &FilmFrames,
        rim: impl Fn(InRegion) -> Option<Rim>,
    ) -> usize {
        let MovingMaterial { positions, normals, drift, velocities, gradients, regions } = material;
        let moved = |l: usize| {
            let carried = positions[l].0 + frames.of(regions[l]) * step;
            confined(rim(regions[l]), drifted(carried, drift[l], gradients[l].0, step))
        };
        self.places.clear();
        self.places.extend((0..positions.len()).map(|l| Position(moved(l))));
        self.normals.clear();
        self.normals.extend_from_slice(normals);
        for _ in 0..PROJECTIONS {
            self.project(carriers, shapes, regions);
        }
        let mut lost = 0;
        for l in 0..positions.len() {
            let (before, after) = (normals[l].0, self.normals[l].0);
            if after == DVec3::ZERO {
                lost += 1;
                continue;
            }
            let turn = MinimalRotation::between(before, after);
            velocities[l].0 = tangential(turn.apply(velocities[l].0), after);
            let rotation = turn.matrix();
            gradients[l].0 = rotation * gradients[l].0 * rotation.transpose();
            positions[l].0 = confined(rim(regions[l]), self.places[l].0);
            normals[l].0 = after;
        }
        lost
    }

    /// Moves every row once along the blended normal onto the blended film; the normal of a row that finds no carrier
    /// becomes zero, and it finds none from then on.
    fn project(&mut self, carriers: Carriers, shapes: &[ShapeOperator], regions: &[InRegion]) {
        let kernel = carriers.kernel();
        let mut projected = Vec::with_capacity(regions.len());
        let rows = Rows { positions: &self.places, normals: &self.normals, regions };
        self.tile.for_each(carriers, rows, |tile, range| {
            for l in range {
                let (place, normal) = (rows.positions[l].0, rows.normals[l].0);
                let (mut sum, mut height, mut direction) = (0.0, 0.0, DVec3::ZERO);
                tile.for_each_near(&kernel, place, normal, |e, r, w| {
                    let (h, d) = height_above(-r, carriers.normals[e].0, &shapes[e].0);
                    sum += w;
                    height += w * h;
                    direction += d * w;
                });
                let normal = direction.normalize_or_zero();
                let step = if normal == DVec3::ZERO { 0.0 } else { height / sum };
                projected.push((Position(place - normal * step), Normal(normal)));
            }
        });
        for (l, (place, normal)) in projected.into_iter().enumerate() {
            (self.places[l], self.normals[l]) = (place, normal);
        }
    }
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
    transfers: Res<Transfers>,
    frames: Res<FilmFrames>,
    clock: Res<Clock>,
    mut faults: ResMut<Faults>,
) {
    let (positions, normals, regions, shapes) = columns(&carriers);
    let carriers = Carriers { positions, normals, regions, cells: &stencil.0.cells, spacing: lamellae.spacing };
    let (regions, mut positions, mut normals, mut velocities, mut gradients) = columns_mut(&mut material);
    let moving = MovingMaterial {
        positions: positions.bypass_change_detection(),
        normals: normals.bypass_change_detection(),
        drift: &transfers.drift,
        velocities: velocities.bypass_change_detection(),
        gradients: gradients.bypass_change_detection(),
        regions,
    };
    let rim = |region: InRegion| lamellae.films.iter().find(|film| film.region == region.0).and_then(|film| film.rim);
    let lost = advance_all(moving, carriers, shapes, clock.step_length, &frames, rim);
    if lost > 0 {
        let detail = format!("of {lost} material particles is farther from the film than any carrier reaches");
        faults.report(Fault::new(Stage::Advance, "position", detail));
    }
}
