//! E advance: carriers move with the film's normal motion and refit their frames in every substep, and spread out evenly
//! after the last.
//!
//! # Equation
//! `x += zeta n`; at last tangential displacements by [`redistribution`](super::redistribution).
//!
//! # Source
//! Deng 2022, Algorithm 6, Eq. 19. DEVIATION: no persistent tangential velocity of carriers; redistribution places
//! them, so nothing needs XSPH to stay stable.

use super::normal_motion::NormalMotion;
use super::redistribution::{EVEN_ENOUGH, Spread, lift, unevenness};
use super::settings::Melp;
use super::state::{FilmStencil, Solvers, TangentialFlow, Transfers};
use crate::observe::{Fault, Faults, Observables};
use crate::operators::quadratic::refit_all;
use crate::operators::stencil::{FIT_SUPPORT, Points, Stencil};
use crate::rows::{columns, columns_mut};
use crate::stage::Stage;
use bevy_ecs::query::{With, Without};
use bevy_ecs::system::{Query, Res, ResMut};
use froth_components::clock::Clock;
use froth_components::film::{ShapeOperator, SurfaceTension, Surfactant};
use froth_components::identity::InRegion;
use froth_components::kind::{BoundaryParticle, EulerianParticle};
use froth_components::lamella::Lamellae;
use froth_components::motion::{Normal, NormalSpeed, Position, Velocity};
use glam::DVec3;
use rayon::prelude::*;
use std::ops::Range;

/// Columns that place a carrier.
type Places<'w, 's> = Query<
    'w,
    's,
    (&'static InRegion, &'static mut Position, &'static mut Normal, &'static mut ShapeOperator),
    (With<EulerianParticle>, Without<BoundaryParticle>),
>;

/// Moves the carriers along their normals, rebuilds the stencil there and refits normals and shape operators; the flow
/// turns with the normals.
pub fn deform_film(
    mut carriers: Places,
    mut moving: Query<(&NormalSpeed, &mut Velocity), With<EulerianParticle>>,
    walls: Query<(&Position, &InRegion), With<BoundaryParticle>>,
    lamellae: Res<Lamellae>,
    motion: Res<NormalMotion>,
    clock: Res<Clock>,
    transfers: Res<Transfers>,
    mut stencil: ResMut<FilmStencil>,
    mut flow: ResMut<TangentialFlow>,
) {
    let (regions, mut positions, mut normals, mut shapes) = columns_mut(&mut carriers);
    let positions = positions.bypass_change_detection();
    let normals = normals.bypass_change_detection();
    flow.follow(&transfers.normals, normals, clock.substep_length());
    let before = normals.to_vec();
    for ((x, n), zeta) in positions.iter_mut().zip(&*normals).zip(&motion.displacement) {
        x.0 += n.0 * *zeta;
    }
    let (wall, wall_regions) = if walls.is_empty() { (&[][..], &[][..]) } else { columns(&walls) };
    let spacing = lamellae.spacing;
    stencil.0.rebuild(Points { positions, normals, regions, wall, wall_regions, spacing });
    refit(&stencil.0, spacing, positions, normals, shapes.bypass_change_detection());
    flow.turn(&before, normals);
    let (speeds, mut velocities) = columns_mut(&mut moving);
    for (i, velocity) in velocities.bypass_change_detection().iter_mut().enumerate() {
        velocity.0 = flow.present.get(i).copied().unwrap_or_default() + normals[i].0 * speeds[i].0;
    }
}

/// Refits every normal and shape operator from the carriers' places.
pub fn refit(
    stencil: &Stencil,
    spacing: f64,
    positions: &[Position],
    normals: &mut [Normal],
    shapes: &mut [ShapeOperator],
) {
    refit_all(positions, &stencil.lists, FIT_SUPPORT * spacing, normals, shapes);
}

/// Spreads the carriers evenly; what they carry moves along by its gradient.
pub fn redistribute_carriers(
    mut carriers: Places,
    mut carried: Query<(&mut NormalSpeed, &mut Surfactant, &mut SurfaceTension), With<EulerianParticle>>,
    walls: Query<&Position, With<BoundaryParticle>>,
    lamellae: Res<Lamellae>,
    melp: Res<Melp>,
    mut stencil: ResMut<FilmStencil>,
    mut solvers: ResMut<Solvers>,
    mut observables: ResMut<Observables>,
    mut faults: ResMut<Faults>,
) {
    let wall = if walls.is_empty() { &[][..] } else { columns(&walls) };
    let (_, mut positions, mut normals, mut shapes) = columns_mut(&mut carriers);
    let (positions, normals) = (positions.bypass_change_detection(), normals.bypass_change_detection());
    let shapes = shapes.bypass_change_detection();
    let films: Vec<Range<usize>> = lamellae.films.iter().map(|film| film.carriers.clone()).collect();
    let spread = Spread { stencil: &stencil.0, positions, wall, normals, films: &films, spacing: lamellae.spacing };
    let excess = spread.excess();
    let uneven = unevenness(&excess);
    observables.record("carrier_unevenness", "1", uneven);
    observables.record("carriers_limited", "1", 0.0);
    if uneven < EVEN_ENOUGH {
        return;
    }
    let moves = match spread.moves(&excess, melp.redistribution, &mut solvers.redistribution) {
        Ok(moves) => moves,
        Err(failed) => {
            faults.report(Fault::new(Stage::Advance, "redistribution", failed.to_string()));
            return;
        }
    };
    observables.record("redistribution_iterations", "1", f64::from(moves.solve.iterations));
    observables.record("carriers_limited", "1", moves.limited as f64);
    let (mut speeds, mut surfactant, mut tension) = columns_mut(&mut carried);
    let (speeds, surfactant) = (speeds.bypass_change_detection(), surfactant.bypass_change_detection());
    let tension = tension.bypass_change_detection();
    let there = |values: Vec<f64>| moved_values(&stencil.0, positions, normals, &moves.displacement, &values);
    let moved_speed = there(speeds.iter().map(|s| s.0).collect());
    let moved_surfactant = there(surfactant.iter().map(|s| s.0).collect());
    let moved_tension = there(tension.iter().map(|s| s.0).collect());
    for i in 0..speeds.len() {
        speeds[i].0 = moved_speed[i];
        surfactant[i].0 = moved_surfactant[i];
        tension[i].0 = moved_tension[i];
    }
    lift(&stencil.0, lamellae.spacing, positions, normals, shapes, &moves.displacement);
    refit(&stencil.0, lamellae.spacing, positions, normals, shapes);
    stencil.0.find_cells(positions, lamellae.spacing);
}

/// `q + d . grad q` on every carrier.
#[must_use]
pub fn moved_values(stencil: &Stencil, x: &[Position], n: &[Normal], moves: &[DVec3], values: &[f64]) -> Vec<f64> {
    (0..values.len())
        .into_par_iter()
        .with_min_len(256)
        .map(|i| values[i] + moves[i].dot(stencil.gradient(x, n, i, |j| values[j])))
        .collect()
}
