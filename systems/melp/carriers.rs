//! E advance: carriers move with the film's normal motion and refit their frames in every substep, and spread out evenly
//! after the last.
//!
//! # Equation
//! `x += U d + zeta n` with the velocity `U` of the film's [frame](super::frames); at last tangential displacements by [`redistribution`](super::redistribution).
//!
//! # Source
//! Deng 2022, Algorithm 6, Eq. 19. DEVIATION: no persistent tangential velocity of carriers; redistribution places
//! them, so nothing needs XSPH to stay stable.

use super::frames::{FilmFrames, mean_motion};
use super::normal_motion::NormalMotion;
use super::redistribution::{EVEN_ENOUGH, Spread, lift, unevenness};
use super::settings::Melp;
use super::state::{FilmStencil, Solvers, TangentialFlow, Transfers};
use crate::observe::{Fault, Faults, Observables};
use crate::operators::quadratic::refit_all;
use crate::operators::stencil::{FIT_SUPPORT, Points, Stencil};
use crate::operators::tangent::{outer, tangential};
use crate::rows::reduce::ordered_sum;
use crate::rows::{columns, columns_mut};
use crate::stage::Stage;
use bevy_ecs::query::{With, Without};
use bevy_ecs::system::{Query, Res, ResMut};
use froth_components::clock::Clock;
use froth_components::film::{ShapeOperator, SurfaceTension, Surfactant, Thickness};
use froth_components::identity::InRegion;
use froth_components::kind::{BoundaryParticle, EulerianParticle};
use froth_components::lamella::{Lamella, Lamellae};
use froth_components::material::Liquid;
use froth_components::motion::{Normal, NormalSpeed, Position, Velocity};
use glam::{DMat3, DVec3};
use rayon::prelude::*;
use std::ops::Range;

/// Columns that place a carrier.
type Places<'w, 's> = Query<
    'w,
    's,
    (&'static InRegion, &'static mut Position, &'static mut Normal, &'static mut ShapeOperator),
    (With<EulerianParticle>, Without<BoundaryParticle>),
>;

/// Columns of what a carrier moves with.
type Moving<'w, 's> =
    Query<'w, 's, (&'static Thickness, &'static mut NormalSpeed, &'static mut Velocity), With<EulerianParticle>>;

/// Moves the carriers with their films' frames and along their normals, rebuilds the stencil there and refits normals and
/// shape operators. The flow turns with the normals; what that does to the momentum of a free film is given back to it.
pub fn deform_film(
    mut carriers: Places,
    mut moving: Moving,
    walls: Query<(&Position, &InRegion), With<BoundaryParticle>>,
    lamellae: Res<Lamellae>,
    liquid: Res<Liquid>,
    clock: Res<Clock>,
    frames: Res<FilmFrames>,
    transfers: Res<Transfers>,
    mut motion: ResMut<NormalMotion>,
    mut observables: ResMut<Observables>,
    mut stencil: ResMut<FilmStencil>,
    mut flow: ResMut<TangentialFlow>,
) {
    let (regions, mut positions, mut normals, mut shapes) = columns_mut(&mut carriers);
    let positions = positions.bypass_change_detection();
    let normals = normals.bypass_change_detection();
    let (thickness, mut speeds, mut velocities) = columns_mut(&mut moving);
    let step = clock.substep_length();
    flow.follow(&transfers.normals, normals, step);
    let before = normals.to_vec();
    let mut relative: Vec<f64> = (0..before.len()).map(|i| motion.displacement[i] / step).collect();
    let density = liquid.density;
    let was = Carried {
        lamellae: &lamellae,
        density,
        normals: &before,
        areas: &stencil.0.areas,
        thickness,
        flow: &flow.solved,
        speeds: &relative,
    }
    .momenta();
    for (i, (x, n)) in positions.iter_mut().zip(&before).enumerate() {
        x.0 += frames.of(regions[i]) * step + n.0 * motion.displacement[i];
    }
    let (wall, wall_regions) = if walls.is_empty() { (&[][..], &[][..]) } else { columns(&walls) };
    let spacing = lamellae.spacing;
    stencil.build_in_passing(Points { positions, normals, regions, wall, wall_regions, spacing });
    refit(&stencil.0, spacing, positions, normals, shapes.bypass_change_detection());
    flow.turn(&before, normals);
    let is = Carried {
        lamellae: &lamellae,
        density,
        normals,
        areas: &stencil.0.areas,
        thickness,
        flow: &flow.present,
        speeds: &relative,
    }
    .momenta();
    for (is, was) in is.iter().zip(&was) {
        let frame = frames.of(regions[is.rows.start]);
        let shift = is.seen_from(-frame).shift_back_to(&was.seen_from(-frame));
        motion.momentum_correction = motion.momentum_correction.max(shift.length());
        for i in is.rows.clone() {
            let n = normals[i].0;
            relative[i] += shift.dot(n);
            if let Some(u) = flow.present.get_mut(i) {
                *u += tangential(shift, n);
            }
        }
    }
    observables.raise("momentum_correction", "m/s", motion.momentum_correction);
    let velocities = velocities.bypass_change_detection();
    for (i, speed) in speeds.bypass_change_detection().iter_mut().enumerate() {
        let (n, frame) = (normals[i].0, frames.of(regions[i]));
        speed.0 = relative[i] + frame.dot(n);
        velocities[i].0 = flow.whole_velocity(i, frame, n, speed.0);
    }
}

/// What carriers carry as they stand; all slices are per carrier.
#[derive(Clone, Copy)]
struct Carried<'a> {
    lamellae: &'a Lamellae,
    /// Density of the liquid, kg/m^3.
    density: f64,
    normals: &'a [Normal],
    /// m^2.
    areas: &'a [f64],
    thickness: &'a [Thickness],
    /// Tangential velocities, m/s; empty where their momentum is not asked for.
    flow: &'a [DVec3],
    /// Speeds along the normals, m/s.
    speeds: &'a [f64],
}

impl Carried<'_> {
    /// The momentum of every film that no rim holds.
    fn momenta(&self) -> Vec<Momentum> {
        self.lamellae.films.iter().filter(|film| film.rim.is_none()).map(|film| self.momentum(film)).collect()
    }

    /// `sum m u + (m + m_air) s n` and `sum m (1 - n n^T) + (m + m_air) n n^T`; without a flow, its normal parts alone.
    fn momentum(&self, film: &Lamella) -> Momentum {
        let Self { density, normals, areas, thickness, flow, speeds, .. } = *self;
        let (rows, start) = (film.carriers.clone(), film.carriers.start);
        let normal_part = |i: usize| (density * thickness[i].0 + film.air_mass) * areas[i];
        let flowing_part = |i: usize| if flow.is_empty() { 0.0 } else { density * thickness[i].0 * areas[i] };
        let momentum = ordered_sum(rows.len(), DVec3::ZERO, |k| {
            let i = start + k;
            let along = flow.get(i).copied().unwrap_or_default() * flowing_part(i);
            along + normals[i].0 * (normal_part(i) * speeds[i])
        });
        let mass = ordered_sum(rows.len(), DMat3::ZERO, |k| {
            let (i, n) = (start + k, normals[start + k].0);
            DMat3::from_diagonal(DVec3::splat(flowing_part(i))) + outer(normal_part(i) - flowing_part(i), n, n)
        });
        Momentum { rows, momentum, mass }
    }
}

/// Momentum and inertia of one free film.
struct Momentum {
    rows: Range<usize>,
    momentum: DVec3,
    mass: DMat3,
}

impl Momentum {
    /// The same film's from a frame that moves at a velocity relative to this one, m/s.
    fn seen_from(&self, frame: DVec3) -> Self {
        Self { rows: self.rows.clone(), momentum: self.momentum - self.mass * frame, mass: self.mass }
    }

    /// The velocity that, given to the film as a whole, makes its momentum what it was.
    fn shift_back_to(&self, was: &Self) -> DVec3 {
        mean_motion(was.momentum - self.momentum, self.mass)
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
    mut carried: Query<
        (&mut NormalSpeed, &mut Surfactant, &mut SurfaceTension, &mut Thickness),
        With<EulerianParticle>,
    >,
    walls: Query<(&Position, &InRegion), With<BoundaryParticle>>,
    lamellae: Res<Lamellae>,
    liquid: Res<Liquid>,
    melp: Res<Melp>,
    mut stencil: ResMut<FilmStencil>,
    mut solvers: ResMut<Solvers>,
    mut observables: ResMut<Observables>,
    mut faults: ResMut<Faults>,
) {
    let (wall, wall_regions) = if walls.is_empty() { (&[][..], &[][..]) } else { columns(&walls) };
    let (regions, mut positions, mut normals, mut shapes) = columns_mut(&mut carriers);
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
    let (mut speeds, mut surfactant, mut tension, mut thickness) = columns_mut(&mut carried);
    let (speeds, surfactant) = (speeds.bypass_change_detection(), surfactant.bypass_change_detection());
    let (tension, thickness) = (tension.bypass_change_detection(), thickness.bypass_change_detection());
    let density = liquid.density;
    let momentum = |normals: &[Normal], areas: &[f64], thickness: &[Thickness], speeds: &[NormalSpeed]| {
        let speeds: Vec<f64> = speeds.iter().map(|s| s.0).collect();
        Carried { lamellae: &lamellae, density, normals, areas, thickness, flow: &[], speeds: &speeds }.momenta()
    };
    let was = momentum(normals, &stencil.0.areas, thickness, speeds);
    let there = |values: Vec<f64>| moved_values(&stencil.0, positions, normals, &moves.displacement, &values);
    let moved_speed = there(speeds.iter().map(|s| s.0).collect());
    let moved_surfactant = there(surfactant.iter().map(|s| s.0).collect());
    let moved_tension = there(tension.iter().map(|s| s.0).collect());
    let moved_thickness = there(thickness.iter().map(|s| s.0).collect());
    for i in 0..speeds.len() {
        speeds[i].0 = moved_speed[i];
        surfactant[i].0 = moved_surfactant[i];
        tension[i].0 = moved_tension[i];
        thickness[i].0 = moved_thickness[i];
    }
    lift(&stencil.0, lamellae.spacing, positions, normals, shapes, &moves.displacement);
    refit(&stencil.0, lamellae.spacing, positions, normals, shapes);
    let spacing = lamellae.spacing;
    stencil.build_for(Points { positions, normals, regions, wall, wall_regions, spacing });
    // Speeds were read off a smooth field, for other areas: what that does to a film's momentum is given back.
    for (is, was) in momentum(normals, &stencil.0.areas, thickness, speeds).iter().zip(&was) {
        let shift = is.shift_back_to(was);
        observables.raise("momentum_correction", "m/s", shift.length());
        is.rows.clone().for_each(|i| speeds[i].0 += shift.dot(normals[i].0));
    }
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
