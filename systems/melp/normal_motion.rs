//! Motion of the film along its normal: tension, gas pressure, weight.
//!
//! # Equation
//! `(rho eta + m_air) ds/dt = q - 2 sigma kappa + P_ext + rho eta (f . n + u . S u)`, `q = p_in - p_out`.
//!
//! # Discretisation
//! Symplectic Euler in substeps `d <= 0.8 dx / c`, `c = sqrt(2 sigma / (rho eta + m_air))`, each on its own geometry. The
//! flux through the middle of the move, `a (1 + kappa zeta/2)`, changes the volume.
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
//! DEVIATION: a substep of 0.8 dx/c, on its own geometry; prototypes took several of 0.4 dx/c on a frozen one.
//!
//! # Limits
//! In the film's [frame](super::frames), `-2 u . grad s` (the film's own advection of its normal momentum) is left out: relative error `u/c`, a few per cent
//! of the film's share of the inertia.

use super::frames::FilmFrames;
use super::settings::Melp;
use super::state::FilmStencil;
use crate::clock::StepLimits;
use crate::operators::stencil::Stencil;
use crate::operators::tangent::{outer, tangential};
use crate::rows::reduce::{ordered_max, ordered_sum};
use crate::rows::{columns, columns_mut};
use bevy_ecs::query::{With, Without};
use bevy_ecs::resource::Resource;
use bevy_ecs::system::{Query, Res, ResMut};
use froth_components::clock::Clock;
use froth_components::film::{MeanCurvature, ShapeOperator, SurfaceTension, Thickness};
use froth_components::gas::IdealGas;
use froth_components::gas::{GasExponent, GasVolume, ReferencePressure, ReferenceVolume};
use froth_components::identity::InRegion;
use froth_components::kind::{BoundaryParticle, EulerianParticle, Region};
use froth_components::lamella::{Lamellae, Rim};
use froth_components::material::{Atmosphere, Liquid};
use froth_components::motion::{ExternalAcceleration, ExternalPressure, NormalSpeed, Velocity};
use froth_components::motion::{Normal, Position};
use glam::{DMat3, DVec3};
use rayon::prelude::*;
use std::ops::Range;

/// Longest substep, in units of `dx / c`. The fastest modes have 1.67 c/dx on even carriers and 1.93 c/dx on noisy ones;
/// symplectic Euler is stable below 2, so the explicit limit is 1.0 to 1.2.
///
/// Several moves on one frozen geometry do not pay: what is held over them feeds modes that turn by half a period or more
/// (four moves of 0.4 dx/c: 3 % per step, every bubble without drag rang by itself), and slow modes grow or fade with the
/// square of the step (three: shape mode 2 of 500 carriers grew by 0.5 per second).
pub const SUBSTEP: f64 = 0.8;

/// How far beyond its rim a film goes on, in distances of a carrier inside it (Morris 1997: 0.5 to 1.5).
const FARTHEST: f64 = 2.0;

/// What the normal motion reads; all slices are per carrier.
#[derive(Clone, Copy)]
pub struct NormalForces<'a> {
    /// Pair weights and areas.
    pub stencil: &'a Stencil,
    /// Places at the substep's start.
    pub positions: &'a [Position],
    /// Boundary particles.
    pub wall: &'a [Position],
    /// Unit normals.
    pub normals: &'a [Normal],
    /// Surface tension of one interface, N/m.
    pub tension: &'a [f64],
    /// Sum of principal curvatures, 1/m.
    pub curvature: &'a [f64],
    /// External force per area along the normal: pressures, weight, centrifugal force, Pa.
    pub load: &'a [f64],
    /// Tangential force per area by the tension's gradient, Pa, for the balance of momentum.
    pub tangential: &'a [DVec3],
    /// Inertia per area, film and air, kg/m^2.
    pub inertia: &'a [f64],
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

/// What the normal motion did over a substep.
#[derive(Resource, Clone, Debug, Default)]
pub struct NormalMotion {
    /// Displacement `zeta` along the normal, relative to the film's frame, m, per carrier.
    pub displacement: Vec<f64>,
    /// Largest rigid correction of the normal speed by the balance of momentum, m/s.
    pub momentum_correction: f64,
}

impl NormalMotion {
    /// Zero motion of `count` carriers.
    pub fn reset(&mut self, count: usize) {
        self.displacement.clear();
        self.displacement.resize(count, 0.0);
        self.momentum_correction = 0.0;
    }
}

impl NormalForces<'_> {
    /// Advances the film in `rows` by `step` seconds; `speeds` is per carrier, `gas` is `None` for a film that
    /// encloses none; without a rim that holds it, forces within it balance.
    pub fn advance(
        &self,
        rows: Range<usize>,
        step: f64,
        speeds: &mut [f64],
        gas: Option<&mut EnclosedGas>,
        rim: Option<Rim>,
        motion: &mut NormalMotion,
    ) {
        let areas = &self.stencil.areas[rows.clone()];
        let mass: Vec<f64> = areas.iter().zip(&self.inertia[rows.clone()]).map(|(a, m)| a * m).collect();
        let tension: Vec<f64> =
            rows.clone().into_par_iter().with_min_len(256).map(|i| self.tension_on(rim, i)).collect();
        let speeds = &mut speeds[rows.clone()];
        for (k, s) in speeds.iter_mut().enumerate() {
            *s += step * (tension[k] + self.load[rows.start + k] * areas[k]) / mass[k];
        }
        let pressure = gas.as_deref().map_or(0.0, |gas| gas.excess_pressure_after(step, areas, &mass, speeds));
        speeds.iter_mut().zip(areas).zip(&mass).for_each(|((s, a), m)| *s += step * pressure * a / m);
        if rim.is_none() {
            let shift = self.balance(rows.clone(), &tension, &mass, pressure) * -step;
            speeds.iter_mut().zip(&self.normals[rows.clone()]).for_each(|(s, n)| *s += n.0.dot(shift));
            motion.momentum_correction = motion.momentum_correction.max(shift.length());
        }
        let displacement = &mut motion.displacement[rows.clone()];
        displacement.iter_mut().zip(&*speeds).for_each(|(zeta, s)| *zeta = step * s);
        if let Some(gas) = gas {
            // The flux through the middle of the move: exact to second order in the displacement.
            let swept = |k: usize| areas[k] * (1.0 + 0.5 * self.curvature[rows.start + k] * displacement[k]);
            gas.volume += ordered_sum(areas.len(), 0.0, |k| swept(k) * displacement[k]);
        }
    }

    /// The acceleration of a free film's centre by forces within it, which ought to be zero, m/s^2.
    fn balance(&self, rows: Range<usize>, tension: &[f64], mass: &[f64], pressure: f64) -> DVec3 {
        let (start, areas) = (rows.start, &self.stencil.areas);
        let tensor = ordered_sum(mass.len(), DMat3::ZERO, |k| {
            let n = self.normals[start + k].0;
            outer(mass[k], n, n)
        });
        let force = ordered_sum(mass.len(), DVec3::ZERO, |k| {
            let i = start + k;
            self.normals[i].0 * (tension[k] + pressure * areas[i]) + self.tangential[i] * areas[i]
        });
        tensor.inverse() * force
    }
}

impl EnclosedGas {
    /// Pressure above the outside at the end of a step in which it pushes a film of the given areas, masses and speeds:
    /// implicit in closed form, for the volume's answer is the film's own flux.
    fn excess_pressure_after(&self, step: f64, areas: &[f64], mass: &[f64], speeds: &[f64]) -> f64 {
        let rate = ordered_sum(areas.len(), 0.0, |k| areas[k] * speeds[k]);
        let answer = ordered_sum(areas.len(), 0.0, |k| areas[k].powi(2) / mass[k]);
        let stiffness = self.law.stiffness(self.volume);
        let excess = self.law.pressure(self.volume) - self.outside;
        (excess - stiffness * step * rate) / (1.0 + stiffness * step * step * answer)
    }
}

impl NormalForces<'_> {
    /// Tension on carrier `i` of a film with this rim along its normal, N.
    fn tension_on(&self, rim: Option<Rim>, i: usize) -> f64 {
        let n = self.normals[i].0;
        let film: f64 = self
            .stencil
            .weighted_offsets(self.positions, i)
            .map(|(j, w, d)| w * (self.tension[i] + self.tension[j]) * d.dot(n))
            .sum();
        let mut wall = self.stencil.wall_pairs(self.positions, self.wall, i).peekable();
        if wall.peek().is_none() {
            return film;
        }
        let sag = self.sag(rim, i);
        film + wall.map(|(w, d)| 2.0 * self.tension[i] * w * (d + sag.at(self.positions[i].0 + d)).dot(n)).sum::<f64>()
    }

    /// How the film near carrier `i` goes on beyond a flat rim.
    fn sag(&self, rim: Option<Rim>, i: usize) -> Sag {
        let Some((rim, (centre, axis))) = rim.and_then(|rim| Some((rim, rim.plane()?))) else { return Sag::default() };
        let x = self.positions[i].0;
        let inside = (-rim.beyond(x).0).max(0.5 * self.stencil.areas[i].sqrt());
        Sag { rim: Some(rim), slope: axis * (-(x - centre).dot(axis) / inside), farthest: FARTHEST * inside }
    }
}

/// Boundary particles lie in the plane of a flat rim, but the film, held at the rim itself, goes on beyond it as steeply as
/// it arrives, odd about the rim. Without this a film acts 1.2 spacings wider than it is.
#[derive(Default)]
struct Sag {
    rim: Option<Rim>,
    /// Displacement of the film per distance beyond the rim.
    slope: DVec3,
    /// Distance up to which it goes on, m: carriers at the very rim do not tell the slope well.
    farthest: f64,
}

impl Sag {
    /// From the boundary particle at `place` to the film there, m.
    fn at(&self, place: DVec3) -> DVec3 {
        self.rim.map_or(DVec3::ZERO, |rim| self.slope * rim.beyond(place).0.clamp(0.0, self.farthest))
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
        &'static InRegion,
        &'static mut NormalSpeed,
    ),
    (With<EulerianParticle>, Without<BoundaryParticle>, Without<Region>),
>;

/// Advances every film along its normal by one substep; places move later, in the `Deform` stage.
pub fn advance_normal_motion(
    mut carriers: NormalColumns,
    walls: Query<&Position, With<BoundaryParticle>>,
    mut gases: Query<(&mut GasVolume, &ReferenceVolume, &ReferencePressure, &GasExponent), With<Region>>,
    stencil: Res<FilmStencil>,
    lamellae: Res<Lamellae>,
    liquid: Res<Liquid>,
    atmosphere: Res<Atmosphere>,
    clock: Res<Clock>,
    frames: Res<FilmFrames>,
    mut motion: ResMut<NormalMotion>,
) {
    let wall = if walls.is_empty() { &[][..] } else { columns(&walls) };
    let (positions, normals, shapes, curvature, tension, thickness, pushes, pressures, velocities, regions, mut speeds) =
        columns_mut(&mut carriers);
    let speeds = speeds.bypass_change_detection();
    let inertia = Inertia { density: liquid.density, lamellae: &lamellae };
    let tension: Vec<f64> = tension.iter().map(|t| t.0).collect();
    let stencil = &stencil.0;
    let load = |i: usize| {
        let n = normals[i].0;
        let u = tangential(velocities[i].0 - frames.of(regions[i]), n);
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
        curvature: &per_carrier(&|i| curvature[i].0),
        load: &per_carrier(&load),
        tangential: &tension_gradients(stencil, positions, normals, &tension),
        inertia: &inertia.per_area(thickness),
    };
    let along_frame = |i: usize| frames.of(regions[i]).dot(normals[i].0);
    let mut state: Vec<f64> = speeds.iter().enumerate().map(|(i, s)| s.0 - along_frame(i)).collect();
    motion.reset(count);
    for (film, (mut volume, reference_volume, reference_pressure, exponent)) in lamellae.films.iter().zip(&mut gases) {
        let law = IdealGas::of(reference_volume, reference_pressure, exponent);
        let mut gas =
            film.encloses_gas().then_some(EnclosedGas { law, volume: volume.0, outside: atmosphere.pressure });
        forces.advance(film.carriers.clone(), clock.substep_length(), &mut state, gas.as_mut(), film.rim, &mut motion);
        if let Some(gas) = gas {
            volume.0 = gas.volume;
        }
    }
    speeds.iter_mut().zip(&state).enumerate().for_each(|(i, (slot, s))| slot.0 = *s + along_frame(i));
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

/// Proposes the longest substep that the stiffest wave on the film allows.
pub fn limit_step_by_tension(
    carriers: Query<(&SurfaceTension, &Thickness), With<EulerianParticle>>,
    lamellae: Res<Lamellae>,
    liquid: Res<Liquid>,
    melp: Res<Melp>,
    mut limits: ResMut<StepLimits>,
) {
    let (tension, thickness) = columns(&carriers);
    let inertia = Inertia { density: liquid.density, lamellae: &lamellae }.per_area(thickness);
    let squared_speed = ordered_max(inertia.len(), 0.0, |i| 2.0 * tension[i].0 / inertia[i]);
    let substep = SUBSTEP * lamellae.spacing / squared_speed.sqrt();
    limits.propose_for_substeps("tension", substep, melp.substeps);
}
