//! The surfactant resists being spread or crowded: one implicit solve gives concentration and flow together.
//!
//! # Equation
//! `u' = u* - dt (2 R T / (rho eta)) grad Gamma'`,  `Gamma' = Gamma* (1 - dt div u')`, with the full surface
//! divergence `div u + kappa s`. Multiplied by area and cleared of `u'`:
//!
//! `a Gamma'/Gamma* + dt^2 sum_j w_ij k_ij (Gamma'_i - Gamma'_j) = a - dt D`,
//! `k_ij = (2 R T / rho) (1/eta_i + 1/eta_j)/2`, `D = a (div u* + kappa s)` in flux form.
//!
//! # Discretisation
//! Symmetric positive definite and an M-matrix: `Gamma'` is positive while `dt div u < 1`. Without boundary particles
//! in the sums a rim is a wall that nothing crosses. Conjugate gradients from the last concentration, after the
//! constant mode has been set from the sum of all rows, which the iteration would find last.
//!
//! # Source
//! Deng 2022, Eqs 13 to 15, with the factor 2 that Eq. 14 lost. DEVIATION: conjugate gradients instead of relaxed
//! Jacobi; full divergence instead of its tangential part.

use super::contact::Contacts;
use super::normal_motion::NormalMotion;
use super::settings::Melp;
use super::state::{FilmStencil, Solvers, TangentialFlow, Transfers};
use crate::observe::{Fault, Faults, Observables};
use crate::operators::conjugate_gradient::{self, NotConverged, SolveInfo, StopRule, Workspace};
use crate::operators::pair_system::PairSystem;
use crate::operators::stencil::Stencil;
use crate::rows::columns_mut;
use crate::rows::reduce::ordered_sum;
use crate::stage::Stage;
use bevy_ecs::query::With;
use bevy_ecs::system::{Query, Res, ResMut};
use froth_components::clock::Clock;
use froth_components::film::{MeanCurvature, SurfaceTension, Surfactant, Thickness};
use froth_components::identity::StableId;
use froth_components::kind::EulerianParticle;
use froth_components::lamella::Lamellae;
use froth_components::material::Liquid;
use froth_components::motion::{Normal, Position};
use glam::DVec3;
use rayon::prelude::*;
use std::ops::Range;

/// What the solve reads; all slices are per carrier.
#[derive(Clone, Copy)]
pub struct MarangoniProblem<'a> {
    /// Pair weights and areas.
    pub stencil: &'a Stencil,
    /// Places.
    pub positions: &'a [Position],
    /// Unit normals.
    pub normals: &'a [Normal],
    /// Gathered concentration `Gamma*`, mol/m^2.
    pub gathered: &'a [f64],
    /// Thickness, m.
    pub thickness: &'a [f64],
    /// Tangential velocity `u*` before the solve, m/s.
    pub velocity: &'a [DVec3],
    /// Area rate by normal motion, `a kappa s`, m^2/s.
    pub stretching: &'a [f64],
    /// `2 R T / rho`, m^5/(s^2 mol).
    pub mobility: f64,
    /// Part of the two interfaces that the sheet has, 0.5 to 1: a sheet that shares its film with another bubble's has one.
    pub interfaces: &'a [f64],
    /// Step, s.
    pub step: f64,
}

impl MarangoniProblem<'_> {
    /// Solves for the concentration, starting from `concentration`, film by film for the constant mode.
    ///
    /// # Errors
    /// [`NotConverged`] with the residual reached.
    pub fn solve(
        &self,
        films: &[Range<usize>],
        stop: StopRule,
        concentration: &mut [f64],
        work: &mut Workspace,
    ) -> Result<SolveInfo, NotConverged> {
        let Self { stencil, step, .. } = *self;
        let resistance: Vec<f64> = (0..stencil.len()).map(|i| 0.5 * step * step * self.mobility_on(i)).collect();
        let reaction: Vec<f64> = stencil.areas.iter().zip(self.gathered).map(|(a, g)| a / g).collect();
        let b = self.right_hand_side();
        let coupling = |i: usize, j: usize, k: usize| stencil.weights[k] * (resistance[i] + resistance[j]);
        let system = PairSystem::new(&stencil.lists, reaction, coupling);
        for film in films {
            set_constant_mode(film.clone(), &system.reaction, &b, concentration);
        }
        let places = self.positions.iter().map(|x| x.0);
        conjugate_gradient::solve(&system, places, &b, concentration, stop, work)
    }

    /// `2 R T / (rho eta)` on carrier `i`, by the interfaces that it has.
    fn mobility_on(&self, i: usize) -> f64 {
        self.mobility * self.interfaces[i] / self.thickness[i]
    }

    fn right_hand_side(&self) -> Vec<f64> {
        (0..self.stencil.len())
            .into_par_iter()
            .with_min_len(256)
            .map(|i| {
                let flux = self.stencil.flux_divergence(self.positions, i, |j| self.velocity[j]);
                self.stencil.areas[i] - self.step * (flux + self.stretching[i])
            })
            .collect()
    }

    /// `u' = u* - dt (2RT/(rho eta)) grad Gamma'` for every carrier.
    #[must_use]
    pub fn corrected_velocity(&self, concentration: &[f64]) -> Vec<DVec3> {
        (0..self.stencil.len())
            .into_par_iter()
            .with_min_len(256)
            .map(|i| {
                let slope = self.stencil.gradient(self.positions, self.normals, i, |j| concentration[j]);
                self.velocity[i] - slope * (self.step * self.mobility_on(i))
            })
            .collect()
    }
}

/// Shifts `x` on one film by the constant that makes the sum of its rows right; pair terms cancel in the sum.
fn set_constant_mode(film: Range<usize>, reaction: &[f64], b: &[f64], x: &mut [f64]) {
    let start = film.start;
    let missing = ordered_sum(film.len(), 0.0, |k| b[start + k] - reaction[start + k] * x[start + k]);
    let shift = missing / ordered_sum(film.len(), 0.0, |k| reaction[start + k]);
    x[film].iter_mut().for_each(|v| *v += shift);
}

/// Solves for concentration and flow on all films, and sets the surface tension.
pub fn solve_marangoni(
    mut carriers: Query<
        (&StableId, &Position, &Normal, &MeanCurvature, &Thickness, &mut Surfactant, &mut SurfaceTension),
        With<EulerianParticle>,
    >,
    stencil: Res<FilmStencil>,
    lamellae: Res<Lamellae>,
    liquid: Res<Liquid>,
    melp: Res<Melp>,
    clock: Res<Clock>,
    mut transfers: ResMut<Transfers>,
    motion: Res<NormalMotion>,
    contacts: Res<Contacts>,
    mut flow: ResMut<TangentialFlow>,
    mut solvers: ResMut<Solvers>,
    mut observables: ResMut<Observables>,
    mut faults: ResMut<Faults>,
) {
    let (ids, positions, normals, curvature, thickness, mut surfactant, mut tension) = columns_mut(&mut carriers);
    let surfactant = surfactant.bypass_change_detection();
    let tension = tension.bypass_change_detection();
    let step = clock.substep_length();
    let stretching: Vec<f64> =
        (0..positions.len()).map(|i| stencil.0.areas[i] * curvature[i].0 * motion.displacement[i] / step).collect();
    let problem = MarangoniProblem {
        stencil: &stencil.0,
        positions,
        normals,
        gathered: &transfers.concentration,
        thickness: &thickness.iter().map(|eta| eta.0).collect::<Vec<_>>(),
        velocity: &flow.solved,
        stretching: &stretching,
        mobility: 2.0 * liquid.thermal_energy() / liquid.density,
        interfaces: &(0..positions.len()).map(|i| contacts.interfaces(i)).collect::<Vec<_>>(),
        step,
    };
    let films: Vec<Range<usize>> = lamellae.films.iter().map(|film| film.carriers.clone()).collect();
    let mut concentration: Vec<f64> = surfactant.iter().map(|gamma| gamma.0).collect();
    match problem.solve(&films, melp.marangoni, &mut concentration, &mut solvers.marangoni) {
        Ok(info) => observables.add("marangoni_iterations", "1", f64::from(info.iterations)),
        Err(failed) => {
            faults.report(Fault::new(Stage::Dynamics, "Marangoni solve", failed.to_string()));
            return;
        }
    }
    flow.solved = problem.corrected_velocity(&concentration);
    for (i, gamma) in concentration.iter().enumerate() {
        surfactant[i].0 = *gamma;
        tension[i].0 = liquid.tension_at(*gamma);
    }
    transfers.concentration = concentration;
    if let Some(row) = tension.iter().position(|t| !(t.0 > 0.0)) {
        let detail = format!(
            "is {:.3e} N/m: so much surfactant is crowded here that the film would spread by itself; \
             lower the elasticity or the forces",
            tension[row].0
        );
        let fault = Fault::new(Stage::Dynamics, "surface_tension", detail);
        faults.report(fault.on_particle("eulerian", row, Some(ids[row].0)));
    }
}
