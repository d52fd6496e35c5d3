//! The frames in which free films are solved: each moves along with its film's mean motion.
//!
//! # Equation
//! With `v = U + u' + s' n` and a constant `U`, carriers that move by `U + s' n` see the equations of a film at rest for
//! `u'` and `s'` (Galilean invariance). `U` is the mean motion over the film's inertia,
//! `sum m (u + s n) + m_air s n = [sum m + m_air n n^T] U`, at the start of the step. Films that a rim holds have `U = 0`.
//!
//! Carriers that moved along their normals only would have to be brought back by the redistribution as far as the film
//! travels, a sphere would grow by `(U dt/R)^2` in every move, and `u . grad s`, which is left out of the normal motion,
//! would be as large as the motion itself.
//!
//! # Discretisation
//! Columns hold velocities at rest. Within a step, from [`enter_frames`] to [`leave_frames`], the material particles' are
//! those relative to the frame, `u'`; transfers and their velocity gradients know no others.

use crate::operators::tangent::{outer, tangential};
use crate::rows::reduce::ordered_sum;
use crate::rows::{columns, columns_mut};
use bevy_ecs::query::{With, Without};
use bevy_ecs::resource::Resource;
use bevy_ecs::system::{Query, Res, ResMut};
use froth_components::film::{Area, LiquidVolume, Thickness};
use froth_components::identity::InRegion;
use froth_components::kind::{EulerianParticle, LagrangianParticle};
use froth_components::lamella::Lamellae;
use froth_components::material::Liquid;
use froth_components::motion::{Normal, NormalSpeed, Velocity};
use glam::{DMat3, DVec3};

/// Velocity of every film's frame, m/s. Constant over a step and derived at its start, so no checkpoint holds it.
#[derive(Resource, Clone, Debug, Default)]
pub struct FilmFrames(Vec<DVec3>);

impl FilmFrames {
    /// Velocity of the frame in which the film of a region is solved, m/s.
    #[must_use]
    #[inline]
    pub fn of(&self, region: InRegion) -> DVec3 {
        self.0.get(region.0.0 as usize).copied().unwrap_or(DVec3::ZERO)
    }
}

/// Measures the mean motion of every free film.
pub fn follow_films(
    carriers: Query<(&Normal, &NormalSpeed, &Area, &Thickness), With<EulerianParticle>>,
    material: Query<(&Normal, &Velocity, &LiquidVolume), With<LagrangianParticle>>,
    lamellae: Res<Lamellae>,
    liquid: Res<Liquid>,
    mut frames: ResMut<FilmFrames>,
) {
    let (normals, speeds, areas, thickness) = columns(&carriers);
    let highest = lamellae.films.iter().map(|film| film.region.0 as usize).max().unwrap_or(0);
    frames.0.clear();
    frames.0.resize(highest + 1, DVec3::ZERO);
    for film in lamellae.films.iter().filter(|film| film.rim.is_none()) {
        let normal_mass = |i: usize| (liquid.density * thickness[i].0 + film.air_mass) * areas[i].0;
        let (mut momentum, mut mass) = sums(film.carriers.clone(), |i| {
            let n = normals[i].0;
            (n * (normal_mass(i) * speeds[i].0), outer(normal_mass(i), n, n))
        });
        if !material.is_empty() {
            let (normals, velocities, volumes) = columns(&material);
            let along = sums(film.material.clone(), |l| {
                let (n, m) = (normals[l].0, liquid.density * volumes[l].0);
                (velocities[l].0 * m, DMat3::from_diagonal(DVec3::splat(m)) - outer(m, n, n))
            });
            momentum += along.0;
            mass += along.1;
        }
        frames.0[film.region.0 as usize] = mean_motion(momentum, mass);
    }
}

/// Sums of momentum and inertia over rows.
fn sums(rows: std::ops::Range<usize>, of: impl Fn(usize) -> (DVec3, DMat3) + Sync) -> (DVec3, DMat3) {
    let start = rows.start;
    let momentum = ordered_sum(rows.len(), DVec3::ZERO, |k| of(start + k).0);
    (momentum, ordered_sum(rows.len(), DMat3::ZERO, |k| of(start + k).1))
}

/// `mass^-1 momentum`; zero for a film whose inertia is not known yet.
pub(super) fn mean_motion(momentum: DVec3, mass: DMat3) -> DVec3 {
    let inverse = mass.inverse();
    if mass.determinant() > 0.0 && inverse.is_finite() { inverse * momentum } else { DVec3::ZERO }
}

type Moving<'w, 's> = Query<
    'w,
    's,
    (&'static InRegion, &'static Normal, &'static mut Velocity),
    (With<LagrangianParticle>, Without<EulerianParticle>),
>;

/// Makes the material particles' velocities relative to their films' frames.
pub fn enter_frames(material: Moving, frames: Res<FilmFrames>) {
    shift(material, |region| -frames.of(region));
}

/// Makes the material particles' velocities those at rest again.
pub fn leave_frames(material: Moving, frames: Res<FilmFrames>) {
    shift(material, |region| frames.of(region));
}

fn shift(mut material: Moving, by: impl Fn(InRegion) -> DVec3) {
    let (regions, normals, mut velocities) = columns_mut(&mut material);
    for ((u, n), region) in velocities.bypass_change_detection().iter_mut().zip(normals).zip(regions) {
        u.0 += tangential(by(*region), n.0);
    }
}
