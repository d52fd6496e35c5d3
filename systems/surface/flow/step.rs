//! A step of the geometric flow: propose positions, let the tracker move the mesh, finish.
//!
//! ```
//! # use froth_surface::{Surface, flow::{Flow, FlowError, FlowState, Forcing, Settings}};
//! # fn example(surface: &mut Surface) -> Result<(), FlowError> {
//! let (mut flow, mut state) = (Flow::default(), FlowState::at_rest(surface));
//! flow.rebuild(surface); // after every change of connectivity
//! let dt = 1e-4;
//! flow.propose(surface, &state, &Forcing::uniform(0.06, 4e-4), &Settings::default(), dt)?;
//! surface.positions = flow.proposal().positions.clone(); // or what the tracker achieves
//! flow.finish(&surface.positions, dt, &mut state);
//! # Ok(())
//! # }
//! ```

use glam::DVec3;

use super::conjugate_gradient::{SolveInfo, Workspace};
use super::error::FlowError;
use super::forces::{add_external_forces, remove_tangential, tension_forces};
use super::forcing::{Acceleration, Forcing, Mass};
use super::prediction::{self, Start};
use super::pressure_system::PressureSystem;
use super::projection::{Constraint, Multipliers, ProjectionInfo, project};
use super::rigid::FreeClusters;
use super::settings::{Motion, Scheme, Settings, Tangential};
use super::stable_step::{gershgorin_bound, stable_step};
use super::state::FlowState;
use crate::calculus::area::vertex_integrals;
use crate::calculus::stiffness::Stiffness;
use crate::calculus::volume::{add_pressure_forces, volume_gradients};
use crate::calculus::{Incidence, Weights};
use crate::rows::PerVertex;
use crate::surface::Surface;

/// Where a step wants the films to be.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Proposal {
    /// Place of each vertex at the end of the step, m.
    pub positions: PerVertex<DVec3>,
    /// Velocity of each vertex there, m/s.
    pub velocities: PerVertex<DVec3>,
    /// Pressure of each closed region, in the order of [`Incidence::closed`], Pa above the outside.
    pub pressures: Vec<f64>,
}

/// What a step took.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StepInfo {
    /// Substeps taken; 1 in the implicit scheme.
    pub substeps: u32,
    /// Iterations of the volume projection, all substeps together.
    pub projection_iterations: u32,
    /// Largest relative error of a volume at the end.
    pub volume_error: f64,
    /// Iterations of the linear solve, all sweeps together; 0 in the explicit scheme.
    pub solve_iterations: u32,
    /// Residual of the last linear solve, relative.
    pub solve_residual: f64,
}

/// The flow's work space for one connectivity: everything is sized once, steps allocate nothing.
#[derive(Clone, Debug, Default)]
pub struct Flow {
    incidence: Incidence,
    system: PressureSystem,
    stiffness: Stiffness,
    knows_stiffness: bool,
    solver: Workspace,
    multipliers: Multipliers,
    clusters: FreeClusters,
    knows_clusters: bool,
    proposal: Proposal,
    targets: Vec<f64>,
    gradients: Vec<DVec3>,
    masses: Vec<f64>,
    metric: Vec<f64>,
    inverse: Vec<f64>,
    sums: Vec<f64>,
    forces: Vec<DVec3>,
    pushed: Vec<DVec3>,
    origins: Vec<DVec3>,
    displacements: Vec<DVec3>,
    scratch: Vec<DVec3>,
    normals: Vec<[DVec3; 2]>,
}

/// What all substeps of a step share.
#[derive(Clone, Copy)]
struct Plan<'a> {
    pinned: &'a [bool],
    forcing: &'a Forcing<'a>,
    settings: &'a Settings,
}

impl Flow {
    /// Work space for a surface.
    #[must_use]
    pub fn new(surface: &Surface) -> Self {
        let mut flow = Self::default();
        flow.rebuild(surface);
        flow
    }

    /// Follows a change of connectivity, labels, ghosts, held vertices or open regions.
    pub fn rebuild(&mut self, surface: &Surface) {
        self.incidence.rebuild(surface);
        self.system.lay_out(&self.incidence);
        // Clusters are found, and the rows of the stiffness laid out, when a step asks for them.
        self.knows_clusters = false;
        self.knows_stiffness = false;
        let rows = self.incidence.vertex_rows();
        for list in [&mut self.masses, &mut self.metric, &mut self.inverse, &mut self.sums] {
            list.resize(rows, 0.0);
        }
        for list in [&mut self.forces, &mut self.pushed, &mut self.displacements, &mut self.scratch] {
            list.resize(rows, DVec3::ZERO);
        }
        self.normals.resize(rows, [DVec3::ZERO; 2]);
    }

    /// Connectivity that the last [`Self::rebuild`] found.
    #[must_use]
    pub fn incidence(&self) -> &Incidence {
        &self.incidence
    }

    /// What the last [`Self::propose`] found.
    #[must_use]
    pub fn proposal(&self) -> &Proposal {
        &self.proposal
    }

    /// Works out where the films are after `dt` seconds. Neither surface nor state change: see [`Self::proposal`].
    ///
    /// # Errors
    /// Every [`FlowError`].
    pub fn propose(
        &mut self,
        surface: &Surface,
        state: &FlowState,
        forcing: &Forcing<'_>,
        settings: &Settings,
        dt: f64,
    ) -> Result<StepInfo, FlowError> {
        check_lengths(surface, state.velocities.len(), forcing, self.incidence.vertex_rows())?;
        self.begin(surface, state)?;
        let plan = Plan { pinned: &surface.pinned, forcing, settings };
        match settings.scheme {
            Scheme::Explicit => self.explicit_substeps(&plan, dt),
            Scheme::Implicit => self.implicit_step(&plan, dt),
        }
    }

    /// Works out where the films are once every closed region has its volume again, after remeshing took or gave some: by the
    /// smallest displacement in the metric of area. See [`Self::proposal`], of which only the positions count.
    ///
    /// # Errors
    /// As [`Self::propose`].
    pub fn restore_volumes(
        &mut self,
        surface: &Surface,
        state: &FlowState,
        settings: &Settings,
    ) -> Result<ProjectionInfo, FlowError> {
        let rows = surface.mesh.vertex_rows();
        check_lengths(surface, rows, &Forcing::uniform(1.0, 1.0), self.incidence.vertex_rows())?;
        self.begin(surface, state)?;
        let Self { incidence, system, gradients, metric, inverse, proposal, .. } = self;
        let positions = &mut proposal.positions;
        vertex_integrals(incidence, positions, Weights::Uniform(1.0), metric);
        for ((inverse, area), held) in inverse.iter_mut().zip(metric.iter()).zip(surface.pinned.iter()) {
            *inverse = if *held || !(*area > 0.0) { 0.0 } else { 1.0 / area };
        }
        volume_gradients(incidence, positions, gradients);
        system.fill(incidence, gradients, inverse)?;
        let constraint = Constraint {
            incidence,
            gradients,
            inverse,
            targets: &self.targets,
            tolerance: settings.volume_tolerance,
            max_iterations: settings.max_projection_iterations,
        };
        project(&constraint, system, positions, &mut self.multipliers)
    }

    /// Longest explicit step that is stable at these positions, s: see [`stable_step`](super::stable_step).
    ///
    /// # Errors
    /// [`FlowError::WrongLength`].
    pub fn stable_step(
        &mut self,
        surface: &Surface,
        forcing: &Forcing<'_>,
        settings: &Settings,
    ) -> Result<f64, FlowError> {
        let rows = surface.mesh.vertex_rows();
        check_lengths(surface, rows, forcing, self.incidence.vertex_rows())?;
        self.proposal.positions.0.clone_from(&surface.positions.0);
        let plan = Plan { pinned: &surface.pinned, forcing, settings };
        self.weigh(&plan);
        Ok(self.stable_length(&plan))
    }

    /// Puts velocities and pressures into the state, after the tracker moved the vertices to `achieved`.
    ///
    /// The velocity is the proposed one plus what the tracker's detour adds, `(achieved - proposed) / dt`.
    pub fn finish(&self, achieved: &PerVertex<DVec3>, dt: f64, state: &mut FlowState) {
        let Proposal { positions, velocities, pressures } = &self.proposal;
        let ended = achieved.iter().zip(positions.iter()).zip(velocities.iter());
        state.velocities.0.clear();
        state.velocities.0.extend(ended.map(|((achieved, proposed), u)| *u + (*achieved - *proposed) / dt));
        for (region, pressure) in self.incidence.closed().iter().zip(pressures) {
            state.pressures.insert(*region, *pressure);
        }
    }

    fn begin(&mut self, surface: &Surface, state: &FlowState) -> Result<(), FlowError> {
        self.proposal.positions.0.clone_from(&surface.positions.0);
        self.proposal.velocities.0.clone_from(&state.velocities.0);
        self.proposal.pressures.clear();
        self.targets.clear();
        for region in self.incidence.closed() {
            let target = state.target_volumes.get(region).ok_or(FlowError::NoTarget { region: *region })?;
            self.targets.push(*target);
            self.proposal.pressures.push(state.pressures.get(region).copied().unwrap_or(0.0));
        }
        Ok(())
    }

    fn explicit_substeps(&mut self, plan: &Plan<'_>, dt: f64) -> Result<StepInfo, FlowError> {
        let (mut info, mut left) = (StepInfo::default(), dt);
        loop {
            self.weigh(plan);
            let count = self.substeps_in(plan, left);
            let substeps = f64::from(info.substeps) + count;
            if !(substeps <= f64::from(plan.settings.max_substeps)) {
                return Err(FlowError::TooManySubsteps { dt, substeps, most: plan.settings.max_substeps });
            }
            let length = left / count;
            self.push(plan, length / left)?;
            self.apply_pressures();
            let (start, displacements) = self.start(plan, length);
            prediction::explicit(&start, displacements);
            let corrected = self.correct(plan, length)?;
            self.settle(plan, length);
            info.substeps += 1;
            info.projection_iterations += corrected.iterations;
            info.volume_error = corrected.error;
            if count <= 1.0 {
                return Ok(info);
            }
            left -= length;
        }
    }

    fn implicit_step(&mut self, plan: &Plan<'_>, dt: f64) -> Result<StepInfo, FlowError> {
        if !self.knows_stiffness {
            self.stiffness.lay_out(&self.incidence);
            self.knows_stiffness = true;
        }
        self.stiffness.fill(&self.incidence, &self.proposal.positions, plan.forcing.tension);
        self.weigh(plan);
        self.push(plan, 1.0)?;
        let mut info = StepInfo { substeps: 1, ..StepInfo::default() };
        for _ in 0..plan.settings.pressure_sweeps.max(1) {
            self.apply_pressures();
            let solved = self.solve_displacements(plan, dt)?;
            let corrected = self.correct(plan, dt)?;
            info.solve_iterations += solved.iterations;
            info.solve_residual = solved.residual;
            info.projection_iterations += corrected.iterations;
            info.volume_error = corrected.error;
        }
        self.settle(plan, dt);
        Ok(info)
    }

    /// Masses and the metric of the motion, at the place the step has come to.
    fn weigh(&mut self, plan: &Plan<'_>) {
        let positions = &self.proposal.positions;
        plan.forcing.mass.lump(&self.incidence, positions, &mut self.masses);
        match plan.settings.motion {
            Motion::Inertial => self.metric.copy_from_slice(&self.masses),
            Motion::Overdamped { mobility } => {
                let friction = Weights::Uniform(1.0 / mobility);
                vertex_integrals(&self.incidence, positions, friction, &mut self.metric);
            }
        }
        for ((inverse, weight), held) in self.inverse.iter_mut().zip(&self.metric).zip(plan.pinned) {
            *inverse = if *held || !(*weight > 0.0) { 0.0 } else { 1.0 / weight };
        }
    }

    fn stable_length(&mut self, plan: &Plan<'_>) -> f64 {
        let Self { incidence, inverse, sums, proposal, .. } = self;
        let bound = gershgorin_bound(incidence, &proposal.positions, plan.forcing.tension, inverse, sums);
        stable_step(bound, plan.settings.motion)
    }

    /// Substeps, at least one, that stability asks for in the time that is left.
    fn substeps_in(&mut self, plan: &Plan<'_>, left: f64) -> f64 {
        (left / (plan.settings.explicit_safety * self.stable_length(plan))).ceil().max(1.0)
    }

    /// Forces but for pressure, gradients of volume, and how far held vertices go: `part` of the way they have left.
    fn push(&mut self, plan: &Plan<'_>, part: f64) -> Result<(), FlowError> {
        let Self { incidence, gradients, forces, normals, origins, pushed, .. } = self;
        origins.clone_from(&self.proposal.positions.0);
        tension_forces(incidence, origins, plan.forcing.tension, forces);
        if plan.settings.tangential == Tangential::Remove {
            if !self.knows_clusters {
                self.clusters.rebuild(incidence, plan.pinned);
                self.knows_clusters = true;
            }
            remove_tangential(incidence, origins, forces, pushed, normals);
            self.clusters.give_back(origins, &self.metric, pushed, forces);
        }
        add_external_forces(plan.forcing, &self.masses, forces);
        volume_gradients(incidence, origins, gradients);
        self.displacements.fill(DVec3::ZERO);
        if let Some(targets) = plan.forcing.targets {
            for v in (0..origins.len()).filter(|v| plan.pinned[*v]) {
                self.displacements[v] = (targets[v] - origins[v]) * part;
            }
        }
        self.system.fill(incidence, gradients, &self.inverse)
    }

    /// All forces, with the pressures known so far.
    fn apply_pressures(&mut self) {
        self.pushed.copy_from_slice(&self.forces);
        add_pressure_forces(&self.incidence, &self.gradients, &self.proposal.pressures, &mut self.pushed);
    }

    fn start(&mut self, plan: &Plan<'_>, length: f64) -> (Start<'_>, &mut [DVec3]) {
        let coasts = plan.settings.motion == Motion::Inertial;
        let start = Start {
            metric: &self.metric,
            inverse: &self.inverse,
            factor: factor(plan.settings.motion, length),
            forces: &self.pushed,
            velocities: coasts.then_some(self.proposal.velocities.as_slice()),
            dt: length,
        };
        (start, &mut self.displacements)
    }

    fn solve_displacements(&mut self, plan: &Plan<'_>, dt: f64) -> Result<SolveInfo, FlowError> {
        let (mut solver, mut right) = (std::mem::take(&mut self.solver), std::mem::take(&mut self.scratch));
        let stiffness = std::mem::take(&mut self.stiffness);
        let (start, displacements) = self.start(plan, dt);
        let solved =
            prediction::implicit(&start, &stiffness, plan.settings.solve, displacements, &mut right, &mut solver);
        (self.solver, self.scratch, self.stiffness) = (solver, right, stiffness);
        solved
    }

    /// Moves by the displacements, then to the target volumes; pressures become what that takes.
    fn correct(&mut self, plan: &Plan<'_>, length: f64) -> Result<ProjectionInfo, FlowError> {
        let positions = &mut self.proposal.positions;
        for ((x, origin), d) in positions.iter_mut().zip(&self.origins).zip(&self.displacements) {
            *x = *origin + *d;
        }
        let constraint = Constraint {
            incidence: &self.incidence,
            gradients: &self.gradients,
            inverse: &self.inverse,
            targets: &self.targets,
            tolerance: plan.settings.volume_tolerance,
            max_iterations: plan.settings.max_projection_iterations,
        };
        let info = project(&constraint, &mut self.system, positions, &mut self.multipliers)?;
        let factor = factor(plan.settings.motion, length);
        for (pressure, multiplier) in self.proposal.pressures.iter_mut().zip(&self.multipliers.total) {
            *pressure += multiplier / factor;
        }
        Ok(info)
    }

    /// Velocities from what the substep achieved; mass carries them on, less what damping takes.
    fn settle(&mut self, plan: &Plan<'_>, length: f64) {
        let kept = match plan.settings.motion {
            Motion::Inertial => (-plan.settings.damping_rate * length).exp(),
            Motion::Overdamped { .. } => 1.0,
        };
        let Proposal { positions, velocities, .. } = &mut self.proposal;
        for ((u, x), origin) in velocities.iter_mut().zip(positions.iter()).zip(&self.origins) {
            *u = (*x - *origin) * (kept / length);
        }
    }
}

/// Displacement per force over metric: `Δt²` with masses, `Δt` with area over mobility.
fn factor(motion: Motion, length: f64) -> f64 {
    match motion {
        Motion::Inertial => length * length,
        Motion::Overdamped { .. } => length,
    }
}

fn check_lengths(
    surface: &Surface,
    velocities: usize,
    forcing: &Forcing<'_>,
    laid_out: usize,
) -> Result<(), FlowError> {
    let (vertices, faces) = (surface.mesh.vertex_rows(), surface.mesh.face_rows());
    let (masses, masses_per_area) = match forcing.mass {
        Mass::PerVertex(list) => (Some(list.len()), None),
        Mass::PerArea(weights) => (None, weights.listed()),
    };
    let accelerations = match forcing.acceleration {
        Acceleration::PerVertex(list) => Some(list.len()),
        Acceleration::Uniform(_) => None,
    };
    let lists = [
        ("work space of the flow (rebuild it)", vertices, Some(laid_out)),
        ("positions", vertices, Some(surface.positions.len())),
        ("pinned", vertices, Some(surface.pinned.len())),
        ("velocities", vertices, Some(velocities)),
        ("masses", vertices, masses),
        ("accelerations", vertices, accelerations),
        ("targets", vertices, forcing.targets.map(<[DVec3]>::len)),
        ("masses per area", faces, masses_per_area),
        ("tensions", faces, forcing.tension.listed()),
    ];
    let wrong = lists.into_iter().find(|(_, expected, found)| found.is_some_and(|found| found != *expected));
    wrong.map_or(Ok(()), |(what, expected, found)| {
        Err(FlowError::WrongLength { what, expected, found: found.unwrap_or_default() })
    })
}
