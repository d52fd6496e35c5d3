//! Work space of a sheet between the systems of a substep. Everything in it follows from the state of the run.

use bevy_ecs::resource::Resource;
use bevy_ecs::world::World;
use froth_components::clock::Clock;
use froth_components::film::{Area, LiquidVolume};
use froth_components::kind::MeshVertex;
use froth_components::material::Liquid;
use froth_components::motion::{ExternalAcceleration, ExternalPressure, Normal};
use froth_sheet::{Forcing, Integration, Sheet, SheetError, SheetState};
use froth_surface::{Region, SurfaceMesh};
use glam::DVec3;

use super::settings::SheetRules;
use crate::observe::{Fault, Faults};
use crate::rows::read_column;
use crate::stage::Stage;
use crate::tracker::tension::FilmTensions;

/// A sheet under way.
#[derive(Resource, Debug)]
pub struct SheetWork {
    /// The sheet with its own work space.
    pub sheet: Sheet,
    /// Positions and potentials of the present evaluation.
    pub state: SheetState,
    /// Rates of potentials by convection that kicks use, per side, m^2/s^2.
    pub heads: Vec<f64>,
    /// The step under way.
    pub integration: Integration,
    /// Whether a substep is under way: its first evaluation has begun.
    pub is_under_way: bool,
    /// Whether the integrator has said where the substep ends: what is left is to go there.
    pub has_arrived: bool,
    /// Velocities of held vertices, m/s; zero elsewhere.
    pub wire_velocities: Vec<DVec3>,
    /// External forces per vertex, N.
    pub forces: Vec<DVec3>,
    /// Impulse per density of the free clusters at the start of the substep, m^4/s.
    pub impulses: Vec<DVec3>,
    /// Name and impulse per density of each free cluster where the step's motion left it, m^4/s.
    pub kept_impulses: Vec<(Region, DVec3)>,
    /// Vertices that went less far in the substep than the motion as a whole: something is in their way.
    pub touching: Vec<bool>,
    /// Whether the tracker changed the mesh in this step.
    pub was_mended: bool,
    /// Kinetic energy of the air before films met in this step, J.
    pub energy_before: Option<f64>,
    /// What the step measured so far.
    pub report: StepReport,
}

/// What a step took, over all its substeps.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StepReport {
    /// Substeps begun.
    pub substeps: u32,
    /// Evaluations of the flow.
    pub evaluations: u32,
    /// Most iterations of a solve on wires.
    pub wire_iterations: u32,
    /// Farthest that a vertex went to keep volumes, metres.
    pub volume_correction: f64,
    /// Largest uniform velocity that kept the impulse of a cluster, m/s.
    pub impulse_correction: f64,
    /// Most free vertices of a substep that could not go all their way.
    pub limited: usize,
    /// Least fraction of its way that one went, dimensionless.
    pub least_fraction: f64,
    /// Kinetic energy that was lost where films met, J.
    pub contact_loss: f64,
}

impl SheetWork {
    /// A sheet without a mesh.
    ///
    /// # Errors
    /// As [`Sheet::discretised`].
    pub fn new(rules: &SheetRules) -> Result<Self, SheetError> {
        Ok(Self {
            sheet: Sheet::discretised(rules.discretisation, rules.kernel, rules.summation)?,
            state: SheetState::default(),
            heads: Vec::new(),
            integration: Integration::default(),
            is_under_way: false,
            has_arrived: false,
            wire_velocities: Vec::new(),
            forces: Vec::new(),
            impulses: Vec::new(),
            kept_impulses: Vec::new(),
            touching: Vec::new(),
            was_mended: false,
            energy_before: None,
            report: StepReport::default(),
        })
    }
}

/// Where a substep is in time.
#[derive(Clone, Copy, Debug)]
pub struct Substep {
    /// Its start, s.
    pub time: f64,
    /// Its length, s.
    pub length: f64,
}

/// Lets `work` do its part of a substep; what goes wrong is the run's fault.
pub(super) fn with_work(
    world: &mut World,
    stage: Stage,
    work: impl FnOnce(&mut World, &mut SheetWork, Substep) -> Result<(), SheetFault>,
) {
    let Some(mut sheet) = world.remove_resource::<SheetWork>() else { return };
    let clock = *world.resource::<Clock>();
    let length = clock.substep_length();
    let begun = f64::from(sheet.report.substeps.saturating_sub(1));
    let done = work(world, &mut sheet, Substep { time: clock.time + begun * length, length });
    world.insert_resource(sheet);
    if let Err(error) = done {
        world.resource_mut::<Faults>().report(Fault::new(stage, "vortex sheet", error.to_string()));
    }
}

/// Lets `work` do its part of the end of a substep, if the integrator has come to that.
pub(super) fn on_arrival(
    world: &mut World,
    work: impl FnOnce(&mut World, &mut SheetWork, Substep) -> Result<(), SheetFault>,
) {
    if world.get_resource::<SheetWork>().is_some_and(|work| work.has_arrived) {
        with_work(world, Stage::Deform, work);
    }
}

/// Forgets what the step before took.
pub fn begin_step(world: &mut World) {
    if let Some(mut work) = world.get_resource_mut::<SheetWork>() {
        work.report = StepReport { least_fraction: 1.0, ..StepReport::default() };
        (work.is_under_way, work.has_arrived) = (false, false);
    }
}

/// Why a sheet could not go on.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub(super) enum SheetFault {
    /// The mathematics refused.
    #[error(transparent)]
    Sheet(#[from] SheetError),
    /// A wire cannot go on.
    #[error(transparent)]
    Wire(#[from] crate::tracker::wires::WireStuck),
}

/// Works out the pressures that hold the films where they were last measured against tension and external forces.
pub(super) fn load(world: &World, work: &mut SheetWork) {
    let tensions = FilmTensions::of(world, world.resource::<SurfaceMesh>());
    let density = world.resource::<SheetRules>().density;
    let forcing = Forcing { tension: tensions.weights(), density, forces: &work.forces };
    work.sheet.load(&work.state.positions, &forcing);
}

/// External forces per vertex, N: accelerations of the liquid, and pressures along the normal.
pub(super) fn external_forces(world: &mut World) -> Vec<DVec3> {
    let density = world.resource::<Liquid>().density;
    let accelerations = read_column::<MeshVertex, ExternalAcceleration>(world);
    let pressures = read_column::<MeshVertex, ExternalPressure>(world);
    let normals = read_column::<MeshVertex, Normal>(world);
    let areas = read_column::<MeshVertex, Area>(world);
    let liquid = read_column::<MeshVertex, LiquidVolume>(world);
    let force = |v: usize| accelerations[v].0 * (density * liquid[v].0) + normals[v].0 * (pressures[v].0 * areas[v].0);
    (0..areas.len()).map(force).collect()
}
