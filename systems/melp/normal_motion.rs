//! Motion of the film along its normal: tension, gas pressure, weight.
//!
//! # Equation
//! `(rho eta + m_air) ds/dt = q - 2 sigma kappa + P_ext + rho eta (f . n + u . S u)`, `q = p_in - p_out`.
//!
//! # Discretisation
//! Symplectic Euler in substeps `d <= 0.8 dx / c`, `c = sqrt(2 sigma / (rho eta + m_air))`, each on its own geometry. The
//! flux through the middle of the move, `a (1 + kappa zeta/2)`, changes the volume.
//!
//! Gas and contacts are implicit ([`NormalSystem`]): stable at 1 atm, where the breathing mode of a 5 cm bubble would demand
//! steps of 1e-5 s, and for films pressed together. The gas's volume is a state, advanced by the film's own flux.
//!
//! Forces within a cluster of films that touch (tension, its gradient, gas, contact) must not move its centre of mass, but the
//! projection of the pair forces on the normals leaves a remainder; it is returned as a rigid translation of the normal speeds,
//! mass-weighted, of the cluster as a whole: closing every sheet by itself would shift the angles at borders by 3 degrees. External
//! forces enter outside that balance and move the films freely.
//!
//! # Source
//! Deng 2022, Algorithm 3, Eq. 12 (sign of the curvature and factor 2 corrected).
//!
//! DEVIATION: a substep of 0.8 dx/c, on its own geometry; prototypes took several of 0.4 dx/c on a frozen one.
//!
//! # Limits
//! In the film's [frame](super::frames), `-2 u . grad s` (the film's own advection of its normal momentum) is left out: relative error `u/c`, a few per cent
//! of the film's share of the inertia.

use super::contact::Contacts;
use super::frames::FilmFrames;
use super::normal_system::{GasSpring, NormalSystem};
use super::settings::Melp;
use super::state::{FilmStencil, Solvers};
use crate::clock::StepLimits;
use crate::observe::{Fault, Faults, Observables};
use crate::operators::conjugate_gradient::{self, NotConverged, SolveInfo, StopRule, Workspace};
use crate::operators::stencil::Stencil;
use crate::operators::tangent::{outer, tangential};
use crate::rows::reduce::{ordered_max, ordered_sum};
use crate::rows::{columns, columns_mut};
use crate::stage::Stage;
use bevy_ecs::query::{With, Without};
use bevy_ecs::resource::Resource;
use bevy_ecs::system::{Query, Res, ResMut};
use froth_components::clock::Clock;
use froth_components::film::{MeanCurvature, ShapeOperator, SurfaceTension, Thickness};
use froth_components::gas::IdealGas;
use froth_components::gas::{GasExponent, GasVolume, ReferencePressure, ReferenceVolume};
use froth_components::identity::InRegion;
use froth_components::kind::{BoundaryParticle, EulerianParticle, Region};
use froth_components::lamella::{Lamella, Lamellae, Rim};
use froth_components::material::{Atmosphere, Liquid};
use froth_components::motion::{ExternalAcceleration, ExternalPressure, NormalSpeed, Velocity};
use froth_components::motion::{Normal, Position};
use glam::{DMat3, DVec3};
use rayon::prelude::*;

/// Longest substep, in units of `dx / c`. The fastest modes have 1.67 c/dx on even carriers and 1.93 c/dx on noisy ones;
/// symplectic Euler is stable below 2, so the explicit limit is 1.0 to 1.2.
///
/// Several moves on one frozen geometry do not pay: what is held over them feeds modes that turn by half a period or more
/// (four moves of 0.4 dx/c: 3 % per step, every bubble without drag rang by itself), and slow modes grow or fade with the
/// square of the step (three: shape mode 2 of 500 carriers grew by 0.5 per second).
pub const SUBSTEP: f64 = 0.8;

/// How far beyond its rim a film goes on, in distances of a carrier inside it (Morris 1997: 0.5 to 1.5).
const FARTHEST: f64 = 2.0;

/// Damping of gaps in contact, in `sqrt(k m)` of their stiffness and the sheet's inertia: 1 is critical for two equal sheets. The
/// liquid between two films is squeezed out; nothing else brakes them.
const CONTACT_DAMPING: f64 = 1.0;

/// When the solve for the speeds may stop.
const STOP: StopRule = StopRule { tolerance: 1e-9, max_iterations: 400 };

/// What the normal motion reads; all slices are per carrier.
#[derive(Clone, Copy)]
pub struct NormalForces<'a> {
    /// The films.
    pub lamellae: &'a Lamellae,
    /// Pair weights and areas.
    pub stencil: &'a Stencil,
    /// Where films touch.
    pub contacts: &'a Contacts,
    /// Places at the substep's start.
    pub positions: &'a [Position],
    /// Boundary particles.
    pub wall: &'a [Position],
    /// Unit normals.
    pub normals: &'a [Normal],
    /// Surface tension of one interface, N/m.
    pub tension: &'a [f64],
    /// Half the tension of the sheet: that of one interface where it is free, of half an interface where it is shared, N/m.
    pub shared: &'a [f64],
    /// Sum of principal curvatures, 1/m.
    pub curvature: &'a [f64],
    /// External force per area along the normal: pressures, weight, centrifugal force, Pa.
    pub load: &'a [f64],
    /// Tangential force per area by the tension's gradient, Pa, for the balance of momentum.
    pub tangential: &'a [DVec3],
    /// Inertia per area, film and air, kg/m^2.
    pub inertia: &'a [f64],
    /// Velocity of the frame that each carrier's film is solved in, m/s.
    pub frame: &'a (dyn Fn(usize) -> DVec3 + Sync),
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

/// Gap pressures of the contacts, per carrier: what they are at the substep's start, and how they yield.
struct Pressing {
    /// `a dE/dg`, N.
    pull: Vec<f64>,
    /// `Y`, kg.
    yielding: Vec<f64>,
}

impl NormalForces<'_> {
    /// Advances all films by `step` seconds. `speeds` is per carrier, relative to the films' frames; `gases` per film, `None` for
    /// one that encloses none. Forces within a cluster of films that no rim holds balance.
    ///
    /// # Errors
    /// [`NotConverged`] with the residual reached.
    pub fn advance(
        &self,
        step: f64,
        speeds: &mut [f64],
        gases: &mut [Option<EnclosedGas>],
        work: &mut Workspace,
        motion: &mut NormalMotion,
    ) -> Result<SolveInfo, NotConverged> {
        let areas = &self.stencil.areas;
        let mass: Vec<f64> = areas.iter().zip(self.inertia).map(|(a, m)| a * m).collect();
        let pressing = self.pressing(step);
        let mut impulse = self.impulse(step, &pressing);
        let mut springs = Vec::new();
        for (film, gas) in self.lamellae.films.iter().zip(&*gases) {
            let (rows, Some(gas)) = (film.carriers.clone(), gas) else { continue };
            let excess = gas.law.pressure(gas.volume) - gas.outside;
            rows.clone().for_each(|i| impulse[i] += step * excess * areas[i]);
            springs.push(GasSpring { rows, stiffness: gas.law.stiffness(gas.volume) * step * step });
        }
        let system = NormalSystem::new(self.contacts, &mass, areas, &pressing.yielding, &springs);
        let b: Vec<f64> = (0..mass.len()).map(|i| mass[i] * speeds[i] + impulse[i]).collect();
        let before = speeds.to_vec();
        let info = conjugate_gradient::solve_system(system, &b, speeds, STOP, work)?;
        for cluster in &self.contacts.clusters {
            let films = || cluster.iter().map(|&film| &self.lamellae.films[film]);
            if films().any(|film| film.rim.is_some()) {
                continue;
            }
            // What forces within the cluster did to each carrier: all but its load.
            let within = |i: usize| mass[i] * (speeds[i] - before[i]) - step * self.load[i] * areas[i];
            let shift = -self.imbalance(cluster, step, &mass, &within);
            for i in films().flat_map(|film| film.carriers.clone()) {
                speeds[i] += self.normals[i].0.dot(shift);
            }
            motion.momentum_correction = motion.momentum_correction.max(shift.length());
        }
        motion.displacement.iter_mut().zip(&*speeds).for_each(|(zeta, s)| *zeta = step * s);
        for (film, gas) in self.lamellae.films.iter().zip(gases) {
            let (rows, Some(gas)) = (film.carriers.clone(), gas) else { continue };
            // The flux through the middle of the move: exact to second order in the displacement.
            let zeta = &motion.displacement;
            let swept = |i: usize| areas[i] * (1.0 + 0.5 * self.curvature[i] * zeta[i]) * zeta[i];
            gas.volume += ordered_sum(rows.len(), 0.0, |k| swept(rows.start + k));
        }
        Ok(info)
    }

    fn pressing(&self, step: f64) -> Pressing {
        let areas = &self.stencil.areas;
        if self.contacts.is_empty() {
            return Pressing { pull: Vec::new(), yielding: Vec::new() };
        }
        let of = |i: usize| {
            let law = self.contacts.binding(i, self.tension[i]);
            let damping = CONTACT_DAMPING * (self.contacts.stiffness(self.tension[i]) * self.inertia[i]).sqrt();
            (areas[i] * law.pull, step * areas[i] * (law.share * damping + step * law.stiffness))
        };
        let (pull, yielding) = (0..areas.len()).into_par_iter().with_min_len(512).map(of).unzip();
        Pressing { pull, yielding }
    }

    /// Impulse of all but the gas along each carrier's normal over a step, N s: tension, load, contacts as they would be if films
    /// moved with their frames alone.
    fn impulse(&self, step: f64, pressing: &Pressing) -> Vec<f64> {
        let areas = &self.stencil.areas;
        let mut impulse = vec![0.0; areas.len()];
        for film in &self.lamellae.films {
            let start = film.carriers.start;
            impulse[film.carriers.clone()].par_iter_mut().with_min_len(256).enumerate().for_each(|(k, slot)| {
                let i = start + k;
                *slot = step * (self.tension_on(film.rim, i) + self.load[i] * areas[i]);
            });
        }
        if !self.contacts.is_empty() {
            let pressed = |i: usize| match (pressing.pull[i], pressing.yielding[i]) {
                (0.0, 0.0) => 0.0,
                (pull, y) => step * pull + y * self.contacts.opening_of(i, self.normals, self.frame),
            };
            let pressures: Vec<f64> = (0..areas.len()).into_par_iter().with_min_len(512).map(pressed).collect();
            let reaction = impulse.par_iter_mut().enumerate().with_min_len(512);
            reaction.for_each(|(i, slot)| *slot -= self.contacts.pressed(i, &pressures));
        }
        impulse
    }

    /// Velocity that forces within a cluster gave to its centre over a step, which ought to be zero, m/s; `within` is their impulse
    /// along each carrier's normal.
    fn imbalance(&self, cluster: &[usize], step: f64, mass: &[f64], within: &(dyn Fn(usize) -> f64 + Sync)) -> DVec3 {
        let areas = &self.stencil.areas;
        let (mut tensor, mut impulse) = (DMat3::ZERO, DVec3::ZERO);
        for film in cluster {
            let (start, count) = (self.lamellae.films[*film].carriers.start, self.lamellae.films[*film].carriers.len());
            tensor += ordered_sum(count, DMat3::ZERO, |k| {
                let n = self.normals[start + k].0;
                outer(mass[start + k], n, n)
            });
            impulse += ordered_sum(count, DVec3::ZERO, |k| {
                let i = start + k;
                self.normals[i].0 * within(i) + self.tangential[i] * (step * areas[i])
            });
        }
        tensor.inverse() * impulse
    }
}

impl NormalForces<'_> {
    /// Tension on carrier `i` of a film with this rim along its normal, N.
    fn tension_on(&self, rim: Option<Rim>, i: usize) -> f64 {
        let n = self.normals[i].0;
        let film: f64 = self
            .stencil
            .weighted_offsets(self.positions, i)
            .map(|(j, w, d)| w * (self.shared[i] + self.shared[j]) * d.dot(n))
            .sum();
        let mut wall = self.stencil.wall_pairs(self.positions, self.wall, i).peekable();
        if wall.peek().is_none() {
            return film;
        }
        let sag = self.sag(rim, i);
        film + wall.map(|(w, d)| 2.0 * self.shared[i] * w * (d + sag.at(self.positions[i].0 + d)).dot(n)).sum::<f64>()
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
    contacts: Res<Contacts>,
    mut motion: ResMut<NormalMotion>,
    mut solvers: ResMut<Solvers>,
    mut observables: ResMut<Observables>,
    mut faults: ResMut<Faults>,
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
    let shared = per_carrier(&|i| tension[i] * contacts.interfaces(i));
    let forces = NormalForces {
        lamellae: &lamellae,
        stencil,
        contacts: &contacts,
        positions,
        wall,
        normals,
        tension: &tension,
        shared: &shared,
        curvature: &per_carrier(&|i| curvature[i].0),
        load: &per_carrier(&load),
        tangential: &tension_gradients(stencil, positions, normals, &tension, &contacts),
        inertia: &inertia.per_area(thickness),
        frame: &|i| frames.of(regions[i]),
    };
    let along_frame = |i: usize| frames.of(regions[i]).dot(normals[i].0);
    let mut state: Vec<f64> = speeds.iter().enumerate().map(|(i, s)| s.0 - along_frame(i)).collect();
    motion.reset(count);
    let enclosed = |(film, (volume, reference_volume, reference_pressure, exponent)): (&Lamella, GasState)| {
        let law = IdealGas::of(reference_volume, reference_pressure, exponent);
        film.encloses_gas().then_some(EnclosedGas { law, volume: volume.0, outside: atmosphere.pressure })
    };
    let mut enclosed_gases: Vec<Option<EnclosedGas>> = lamellae.films.iter().zip(&gases).map(enclosed).collect();
    let work = &mut solvers.normal_motion;
    match forces.advance(clock.substep_length(), &mut state, &mut enclosed_gases, work, &mut motion) {
        Ok(info) => observables.add("normal_motion_iterations", "1", f64::from(info.iterations)),
        Err(failed) => {
            faults.report(Fault::new(Stage::Dynamics, "normal motion", failed.to_string()));
            return;
        }
    }
    for (gas, (mut volume, ..)) in enclosed_gases.iter().zip(&mut gases) {
        if let Some(gas) = gas {
            volume.0 = gas.volume;
        }
    }
    speeds.iter_mut().zip(&state).enumerate().for_each(|(i, (slot, s))| slot.0 = *s + along_frame(i));
}

/// A region's gas.
type GasState<'a> = (&'a GasVolume, &'a ReferenceVolume, &'a ReferencePressure, &'a GasExponent);

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

/// `(2 - chi) grad sigma` on every carrier, Pa: what the tension's gradient does to the liquid.
fn tension_gradients(
    stencil: &Stencil,
    positions: &[Position],
    normals: &[Normal],
    tension: &[f64],
    contacts: &Contacts,
) -> Vec<DVec3> {
    (0..stencil.len())
        .into_par_iter()
        .with_min_len(256)
        .map(|i| stencil.gradient(positions, normals, i, |j| tension[j]) * (2.0 * contacts.interfaces(i)))
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
