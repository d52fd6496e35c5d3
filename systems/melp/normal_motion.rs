//! Motion of the film along its normal: tension, gas pressure, weight.
//!
//! # Equation
//! `(rho eta + m_air) ds/dt = q - 2 sigma kappa + P_ext + rho eta (f . n + u . S u)`, `q = p_in - p_out`.
//!
//! # Discretisation
//! Symplectic Euler in substeps `d <= 0.4 dx / c`, `c = sqrt(2 sigma / (rho eta + m_air))`, on the pair weights and
//! normals of the step's start. With displacement `zeta` along the normal the frozen pair force is linear,
//! `f = f0 + K zeta`; two terms mend what freezing loses:
//!
//! * `+4 sigma a |S|^2 zeta`: freezing gives `lap - |S|^2`, the second variation of area is `lap + |S|^2`;
//! * flux area `a (1 + kappa zeta)` in the volume and in the work of the gas.
//!
//! The gas is implicit in closed form (a rank-one system): stable at 1 atm, where the breathing mode of a 5 cm bubble
//! would demand steps of 1e-5 s. Its volume is a state, advanced by the film's own flux.
//!
//! Forces within a closed film (tension, its gradient, gas) must not move its centre of mass, but the projection of
//! the pair forces on the normals leaves a remainder; it is returned as a rigid translation of the normal speeds,
//! mass-weighted. External forces enter outside that balance and move the film freely.
//!
//! # Source
//! Deng 2022, Algorithm 3, Eq. 12 (sign of the curvature and factor 2 corrected).
//!
//! # Limits
//! `-2 u . grad s` (the film's own advection of its normal momentum) is left out: relative error `u/c`, a few per cent
//! of the film's share of the inertia.

use super::state::FilmStencil;
use crate::clock::StepLimits;
use crate::operators::stencil::Stencil;
use crate::rows::reduce::{ordered_max, ordered_sum};
use crate::rows::{columns, columns_mut};
use bevy_ecs::query::{With, Without};
use bevy_ecs::resource::Resource;
use bevy_ecs::system::{Query, Res, ResMut};
use froth_components::clock::Clock;
use froth_components::film::{MeanCurvature, ShapeOperator, SurfaceTension, Thickness};
use froth_components::gas::IdealGas;
use froth_components::gas::{GasExponent, GasVolume, ReferencePressure, ReferenceVolume};
use froth_components::kind::{BoundaryParticle, EulerianParticle, Region};
use froth_components::lamella::Lamellae;
use froth_components::material::{Atmosphere, Liquid};
use froth_components::motion::{ExternalAcceleration, ExternalPressure, NormalSpeed, Velocity};
use froth_components::motion::{Normal, Position};
use glam::{DMat3, DVec3};
use rayon::prelude::*;
use std::ops::Range;

/// Longest substep, in units of `dx / c`. The explicit limit is 1.0 to 1.2.
pub const SUBSTEP: f64 = 0.4;

/// Most substeps on one frozen geometry: the fastest mode (1.67 c/dx) then turns by less than half a period in a step,
/// so that what is held over a step cannot feed it.
pub const SUBSTEPS_PER_GEOMETRY: f64 = 4.0;
/// Factor on the stiffness `K` within a step, dimensionless.
///
/// The next step's geometry answers a displacement by a stiffness that differs from the frozen `K` by a relative `e`
/// (irregular neighbours turn the normals). Over a step a mode then grows by `1 + e/2 (1 - cos w dt)`: a bubble at rest
/// rings by itself after half a second where `e > 0`. A `K` stiffer than any real response makes `e < 0`: those modes
/// are damped instead, slow ones (`w dt << 1`) by `(1/8) w^2 dt` per second, and steps of one substep not at all.
const STIFFENING: f64 = 1.5;

/// What the normal motion reads; all slices are per carrier.
#[derive(Clone, Copy)]
pub struct NormalForces<'a> {
    /// Pair weights and areas.
    pub stencil: &'a Stencil,
    /// Places at the step's start.
    pub positions: &'a [Position],
    /// Boundary particles.
    pub wall: &'a [Position],
    /// Unit normals.
    pub normals: &'a [Normal],
    /// Surface tension of one interface, N/m.
    pub tension: &'a [f64],
    /// `|S|^2`, the sum of squared principal curvatures, 1/m^2.
    pub squared_curvature: &'a [f64],
    /// Sum of principal curvatures, 1/m.
    pub curvature: &'a [f64],
    /// External force per area along the normal: pressures, weight, centrifugal force, Pa.
    pub load: &'a [f64],
    /// Tangential force per area by the tension's gradient, Pa, for the balance of momentum.
    pub tangential: &'a [DVec3],
    /// Inertia per area, film and air, kg/m^2.
    pub inertia: &'a [f64],
    /// Spacing, m.
    pub spacing: f64,
}

/// The gas inside a closed film.
#[derive(Clone, Copy, Debug)]
pub struct EnclosedGas {
    /// Its law.
    pub law: IdealGas,
    /// Its present volume, m^3.
    pub volume: f64,
    /// Pressure outside, Pa.
    pub outside: f64,
}

/// What the normal motion did over a step.
#[derive(Resource, Clone, Debug, Default)]
pub struct NormalMotion {
    /// Displacement `zeta` along the normal, m, per carrier.
    pub displacement: Vec<f64>,
    /// Mean of `s^2/2` over the step, m^2/s^2, per carrier.
    pub kinetic: Vec<f64>,
    /// Substeps taken by the film that needed most.
    pub substeps: u32,
    /// Largest rigid correction of the normal speed by the balance of momentum, m/s.
    pub momentum_correction: f64,
}

impl NormalMotion {
    /// Zero motion of `count` carriers.
    pub fn reset(&mut self, count: usize) {
        for column in [&mut self.displacement, &mut self.kinetic] {
            column.clear();
            column.resize(count, 0.0);
        }
        self.substeps = 0;
        self.momentum_correction = 0.0;
    }
}

impl NormalForces<'_> {
    /// Longest substep for the rows of one film, s.
    #[must_use]
    pub fn longest_substep(&self, rows: Range<usize>) -> f64 {
        let start = rows.start;
        let stiffest = |i: usize| 2.0 * self.tension[start + i] / self.inertia[start + i];
        let squared_speed = ordered_max(rows.len(), 0.0, stiffest);
        if squared_speed > 0.0 { SUBSTEP * self.spacing / squared_speed.sqrt() } else { f64::INFINITY }
    }

    /// Advances the film in `rows` by `step` seconds; `speeds` is per carrier, `gas` is `None` for a film that
    /// encloses none; `is_free`: no rim holds it, so forces within it balance.
    pub fn advance(
        &self,
        rows: Range<usize>,
        step: f64,
        speeds: &mut [f64],
        gas: Option<&mut EnclosedGas>,
        is_free: bool,
        motion: &mut NormalMotion,
    ) {
        let count = (step / self.longest_substep(rows.clone())).ceil().clamp(1.0, 1e6) as u32;
        let film = FrozenFilm::new(self, rows.clone(), step / f64::from(count), is_free);
        let mut speeds = FilmState {
            speed: &mut speeds[rows.clone()],
            displacement: &mut motion.displacement[rows.clone()],
            kinetic: &mut motion.kinetic[rows],
        };
        let mut gas = gas;
        for _ in 0..count {
            let correction = film.substep(&mut speeds, gas.as_deref_mut());
            motion.momentum_correction = motion.momentum_correction.max(correction);
        }
        speeds.kinetic.iter_mut().for_each(|k| *k /= f64::from(count));
        motion.substeps = motion.substeps.max(count);
    }
}

/// The part of the state that belongs to one film.
struct FilmState<'a> {
    speed: &'a mut [f64],
    displacement: &'a mut [f64],
    kinetic: &'a mut [f64],
}

/// One film's forces, linear in the displacement.
struct FrozenFilm<'a> {
    forces: &'a NormalForces<'a>,
    rows: Range<usize>,
    substep: f64,
    /// `f0`, N, without the load.
    rest_force: Vec<f64>,
    /// Diagonal of `K`, N/m.
    diagonal: Vec<f64>,
    /// Off-diagonal entries of `K` beside the stencil's neighbours of `rows`, N/m.
    coupling: Vec<f64>,
    /// Mass per carrier, kg.
    mass: Vec<f64>,
    /// Balance of momentum, for closed films.
    balance: Option<Balance>,
}

/// What the balance of momentum of a closed film needs.
struct Balance {
    /// `(sum M n n^T)^-1`, 1/kg.
    inverse_mass: DMat3,
    /// Total tangential force by the tension's gradient, N.
    tangential: DVec3,
}

impl<'a> FrozenFilm<'a> {
    fn new(forces: &'a NormalForces<'a>, rows: Range<usize>, substep: f64, closed: bool) -> Self {
        let start = rows.start;
        let local = |f: &(dyn Fn(usize) -> f64 + Sync)| -> Vec<f64> {
            rows.clone().into_par_iter().with_min_len(256).map(f).collect()
        };
        let mass = local(&|i| forces.stencil.areas[i] * forces.inertia[i]);
        let balance = closed.then(|| {
            let tensor = |k: usize| {
                let n = forces.normals[start + k].0;
                crate::operators::tangent::outer(mass[k], n, n)
            };
            Balance {
                inverse_mass: ordered_sum(rows.len(), DMat3::ZERO, tensor).inverse(),
                tangential: ordered_sum(rows.len(), DVec3::ZERO, |k| {
                    forces.tangential[start + k] * forces.stencil.areas[start + k]
                }),
            }
        });
        let span = forces.stencil.lists.offsets[rows.start]..forces.stencil.lists.offsets[rows.end];
        let mut coupling = vec![0.0; span.len()];
        let mut rest = coupling.as_mut_slice();
        for i in rows.clone() {
            let (own, tail) = rest.split_at_mut(forces.stencil.lists.range(i).len());
            let n = forces.normals[i].0;
            for (slot, (j, w)) in own.iter_mut().zip(forces.stencil.pairs(i)) {
                *slot = STIFFENING * w * (forces.tension[i] + forces.tension[j]) * n.dot(forces.normals[j].0);
            }
            rest = tail;
        }
        Self {
            rest_force: local(&|i| forces.rest_force(i)),
            diagonal: local(&|i| forces.diagonal(i)),
            coupling,
            mass,
            balance,
            forces,
            rows,
            substep,
        }
    }

    /// One symplectic substep; returns the rigid correction of the speed, m/s.
    fn substep(&self, state: &mut FilmState, gas: Option<&mut EnclosedGas>) -> f64 {
        let d = self.substep;
        let start = self.rows.start;
        let before = self.kick(state);
        let mut pressure_impulse = 0.0;
        let mut volume = None;
        if let Some(gas) = gas {
            let rate = ordered_sum(self.rows.len(), 0.0, |k| self.flux_area(state, k) * state.speed[k]);
            let answer = ordered_sum(self.rows.len(), 0.0, |k| self.flux_area(state, k).powi(2) / self.mass[k]);
            let stiffness = gas.law.stiffness(gas.volume);
            let excess = gas.law.pressure(gas.volume) - gas.outside;
            pressure_impulse = d * (excess - stiffness * d * rate) / (1.0 + stiffness * d * d * answer);
            volume = Some(gas);
        }
        let areas: Vec<f64> = (0..self.rows.len()).map(|k| self.flux_area(state, k)).collect();
        state.speed.iter_mut().zip(&areas).zip(&self.mass).for_each(|((s, a), m)| *s += pressure_impulse * a / m);
        let shift = self.balance.as_ref().map_or(DVec3::ZERO, |b| {
            let inner = ordered_sum(self.rows.len(), DVec3::ZERO, |k| {
                self.forces.normals[start + k].0 * (before[k] + pressure_impulse * areas[k])
            });
            b.inverse_mass * -(inner + b.tangential * d)
        });
        let mut gained = 0.0;
        for (k, area) in areas.iter().enumerate() {
            state.speed[k] += self.forces.normals[start + k].0.dot(shift);
            let move_by = d * state.speed[k];
            // The flux through the middle of the move: exact to second order in the displacement.
            gained += (area + 0.5 * self.forces.stencil.areas[start + k] * self.forces.curvature[start + k] * move_by)
                * move_by;
            state.displacement[k] += move_by;
            state.kinetic[k] += 0.5 * state.speed[k] * state.speed[k];
        }
        if let Some(gas) = volume {
            gas.volume += gained;
        }
        shift.length()
    }

    /// Adds tension and load to the speeds; returns the impulse of the tension alone, N s.
    fn kick(&self, state: &mut FilmState) -> Vec<f64> {
        let d = self.substep;
        let start = self.rows.start;
        let displacement = &*state.displacement;
        let base = self.forces.stencil.lists.offsets[start];
        let tension: Vec<f64> = (0..self.rows.len())
            .into_par_iter()
            .with_min_len(256)
            .map(|k| {
                let range = self.forces.stencil.lists.range(start + k);
                let near = self.forces.stencil.lists.indices[range.clone()].iter();
                let pull: f64 = near
                    .zip(&self.coupling[range.start - base..range.end - base])
                    .map(|(&j, c)| c * displacement[j as usize - start])
                    .sum();
                d * (self.rest_force[k] + self.diagonal[k] * displacement[k] + pull)
            })
            .collect();
        for (k, s) in state.speed.iter_mut().enumerate() {
            let load = self.forces.load[start + k] * self.forces.stencil.areas[start + k];
            *s += (tension[k] + d * load) / self.mass[k];
        }
        tension
    }

    fn flux_area(&self, state: &FilmState, k: usize) -> f64 {
        let i = self.rows.start + k;
        self.forces.stencil.areas[i] * (1.0 + self.forces.curvature[i] * state.displacement[k])
    }
}

impl NormalForces<'_> {
    /// Tension on carrier `i` along its normal at zero displacement, N.
    fn rest_force(&self, i: usize) -> f64 {
        let n = self.normals[i].0;
        let film: f64 = self
            .stencil
            .weighted_offsets(self.positions, i)
            .map(|(j, w, d)| w * (self.tension[i] + self.tension[j]) * d.dot(n))
            .sum();
        let rim: f64 = self
            .stencil
            .wall_pairs(self.positions, self.wall, i)
            .map(|(w, d)| 2.0 * self.tension[i] * w * d.dot(n))
            .sum();
        film + rim
    }

    /// How the tension on carrier `i` changes with its own displacement, N/m.
    fn diagonal(&self, i: usize) -> f64 {
        let film: f64 = self.stencil.pairs(i).map(|(j, w)| w * (self.tension[i] + self.tension[j])).sum();
        let rim: f64 =
            self.stencil.wall_pairs(self.positions, self.wall, i).map(|(w, _)| 2.0 * self.tension[i] * w).sum();
        4.0 * self.tension[i] * self.stencil.areas[i] * self.squared_curvature[i] - STIFFENING * (film + rim)
    }
}

/// Columns of the carriers that the normal motion reads and writes.
type NormalColumns<'w, 's> = Query<
    'w,
    's,
    (
        &'static Position,
        &'static Normal,
        &'static ShapeOperator,
        &'static MeanCurvature,
        &'static SurfaceTension,
        &'static Thickness,
        &'static ExternalAcceleration,
        &'static ExternalPressure,
        &'static Velocity,
        &'static mut NormalSpeed,
    ),
    (With<EulerianParticle>, Without<BoundaryParticle>, Without<Region>),
>;

/// Advances every film along its normal by one step; places move later, in the `Advance` stage.
pub fn advance_normal_motion(
    mut carriers: NormalColumns,
    walls: Query<&Position, With<BoundaryParticle>>,
    mut gases: Query<(&mut GasVolume, &ReferenceVolume, &ReferencePressure, &GasExponent), With<Region>>,
    stencil: Res<FilmStencil>,
    lamellae: Res<Lamellae>,
    liquid: Res<Liquid>,
    atmosphere: Res<Atmosphere>,
    clock: Res<Clock>,
    mut motion: ResMut<NormalMotion>,
) {
    let wall = if walls.is_empty() { &[][..] } else { columns(&walls) };
    let (positions, normals, shapes, curvature, tension, thickness, pushes, pressures, velocities, mut speeds) =
        columns_mut(&mut carriers);
    let speeds = speeds.bypass_change_detection();
    let inertia = Inertia { density: liquid.density, lamellae: &lamellae };
    let tension: Vec<f64> = tension.iter().map(|t| t.0).collect();
    let stencil = &stencil.0;
    let load = |i: usize| {
        let (n, u) = (normals[i].0, velocities[i].0);
        let u = u - n * n.dot(u);
        let film = liquid.density * thickness[i].0;
        pressures[i].0 + film * (pushes[i].0.dot(n) + u.dot(shapes[i].0 * u))
    };
    let count = stencil.len();
    let per_carrier = |f: &(dyn Fn(usize) -> f64 + Sync)| -> Vec<f64> {
        (0..count).into_par_iter().with_min_len(256).map(f).collect()
    };
    let forces = NormalForces {
        stencil,
        positions,
        wall,
        normals,
        tension: &tension,
        squared_curvature: &per_carrier(&|i| squared_norm(&shapes[i].0)),
        curvature: &per_carrier(&|i| curvature[i].0),
        load: &per_carrier(&load),
        tangential: &tension_gradients(stencil, positions, normals, &tension),
        inertia: &inertia.per_area(thickness),
        spacing: lamellae.spacing,
    };
    let mut state: Vec<f64> = speeds.iter().map(|s| s.0).collect();
    motion.reset(count);
    for (film, (mut volume, reference_volume, reference_pressure, exponent)) in lamellae.films.iter().zip(&mut gases) {
        let law = IdealGas {
            reference_pressure: reference_pressure.0,
            reference_volume: reference_volume.0,
            exponent: exponent.0,
        };
        let mut gas =
            film.encloses_gas().then_some(EnclosedGas { law, volume: volume.0, outside: atmosphere.pressure });
        forces.advance(
            film.carriers.clone(),
            clock.step_length,
            &mut state,
            gas.as_mut(),
            film.rim.is_none(),
            &mut motion,
        );
        if let Some(gas) = gas {
            volume.0 = gas.volume;
        }
    }
    speeds.iter_mut().zip(&state).for_each(|(slot, s)| slot.0 = *s);
}

/// Inertia of the film and of the air that moves with it.
struct Inertia<'a> {
    density: f64,
    lamellae: &'a Lamellae,
}

impl Inertia<'_> {
    fn per_area(&self, thickness: &[Thickness]) -> Vec<f64> {
        let mut inertia: Vec<f64> = thickness.iter().map(|eta| self.density * eta.0).collect();
        for film in &self.lamellae.films {
            inertia[film.carriers.clone()].iter_mut().for_each(|m| *m += film.air_mass);
        }
        inertia
    }
}

/// `2 grad sigma` on every carrier, Pa: what the tension's gradient does to the liquid.
fn tension_gradients(stencil: &Stencil, positions: &[Position], normals: &[Normal], tension: &[f64]) -> Vec<DVec3> {
    (0..stencil.len())
        .into_par_iter()
        .with_min_len(256)
        .map(|i| stencil.gradient(positions, normals, i, |j| tension[j]) * 2.0)
        .collect()
}

/// Sum of the squared entries: of a shape operator, the sum of squared principal curvatures.
fn squared_norm(m: &DMat3) -> f64 {
    m.to_cols_array().iter().map(|v| v * v).sum()
}

/// Proposes the longest step that one frozen geometry can serve.
pub fn limit_step_by_tension(
    carriers: Query<(&SurfaceTension, &Thickness), With<EulerianParticle>>,
    lamellae: Res<Lamellae>,
    liquid: Res<Liquid>,
    mut limits: ResMut<StepLimits>,
) {
    let (tension, thickness) = columns(&carriers);
    let inertia = Inertia { density: liquid.density, lamellae: &lamellae }.per_area(thickness);
    let squared_speed = ordered_max(inertia.len(), 0.0, |i| 2.0 * tension[i].0 / inertia[i]);
    let substep = SUBSTEP * lamellae.spacing / squared_speed.sqrt();
    limits.propose("tension", SUBSTEPS_PER_GEOMETRY * substep);
}
