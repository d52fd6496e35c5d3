//! Where the films go in a step, and how far they get.
//!
//! Vertices first slide along their films ([`Slides`]), which is a motion of the mesh and no velocity. From there the flow proposes
//! positions ([`froth_surface::flow`]), with exact volumes; then every vertex goes as far as no film touches another
//! ([`froth_surface::motion`]). A proposal that would carry a vertex farther than half an edge length is taken in pieces.

use bevy_ecs::resource::Resource;
use bevy_ecs::world::World;
use froth_components::clock::Clock;
use froth_components::film::{Area, LiquidVolume};
use froth_components::kind::MeshVertex;
use froth_components::material::Liquid;
use froth_components::motion::{ExternalAcceleration, ExternalPressure, Normal, Position, Velocity};
use froth_surface::calculus::Weights;
use froth_surface::flow::{Acceleration, Flow, FlowError, FlowState, Forcing, Mass};
use froth_surface::motion::{MotionSettings, advance};
use froth_surface::{PerVertex, Surface};
use glam::DVec3;
use thiserror::Error;

use super::measure::{FlowWork, lay_out, mass_of};
use super::settings::FlowRules;
use crate::bubbles::gas::BubbleGas;
use crate::observe::{Fault, Faults};
use crate::rows::{fill_column, read_column};
use crate::stage::Stage;
use crate::tracker::films::{self, MeshRules, TopologyChanged};
use crate::tracker::remeshing::Slides;
use crate::tracker::wires::{Holders, MOST_STOPS, Pins, WireLag, WireStuck};

/// Part of an edge length that a vertex may move in one piece of a step.
const LONGEST_WAY: f64 = 0.5;
/// Pieces that a step may take: beyond, the films are running away.
const MOST_PIECES: u32 = 64;
/// Part of a step that is nothing but rounding.
const ROUNDING: f64 = 1e-9;

/// The step as the flow proposes it, and what became of it. Not part of the state of a run.
#[derive(Resource, Clone, Debug, Default)]
pub struct FlowStep {
    /// Pieces that the step is taken in.
    pub pieces: u32,
    /// Length of one, s.
    pub length: f64,
    /// Free vertices that could not go all their way.
    pub limited: usize,
    /// Least fraction of its way that one went, dimensionless.
    pub least_fraction: f64,
    /// Iterations of the linear solver: all that the step took, also for proposals that went too far and were cut into pieces.
    pub solve_iterations: u32,
    /// Substeps of the explicit scheme, counted in the same way.
    pub substeps: u32,
    masses: Vec<f64>,
    pushes: Vec<DVec3>,
}

/// Why the films could not be moved.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
enum MotionFault {
    /// The flow found no proposal.
    #[error(transparent)]
    Flow(#[from] FlowError),
    /// A vertex would go too far, however short the pieces of the step.
    #[error(
        "a vertex would move {ways:.1} edge lengths in a {pieces}th of the step: the films run away; shorten `time_step`"
    )]
    RunsAway {
        /// Way, in edge lengths.
        ways: f64,
        /// Pieces that the step was cut into.
        pieces: u32,
    },
    /// A wire cannot go on.
    #[error(transparent)]
    Wire(#[from] WireStuck),
}

/// A part of the step, s since its start.
#[derive(Clone, Copy, Debug)]
struct Piece {
    from: f64,
    length: f64,
}

/// Works out where tension, pressure, external forces and wires take the films.
pub fn propose_motion(world: &mut World) {
    let length = world.resource::<Clock>().step_length;
    let edge = world.resource::<MeshRules>().policy.edge;
    let (masses, pushes) = loads(world);
    let mut step = FlowStep { pieces: 1, length, least_fraction: 1.0, masses, pushes, ..FlowStep::default() };
    let proposed = with_flow(world, |world, surface, flow, state| {
        loop {
            let piece = Piece { from: 0.0, length: step.length };
            propose(world, &mut step, piece, surface, flow, state)?;
            let ways = longest_way(surface, flow) / edge;
            let wanted = (ways / LONGEST_WAY).ceil();
            if wanted <= 1.0 {
                return Ok(());
            }
            if step.pieces >= MOST_PIECES {
                return Err(MotionFault::RunsAway { ways, pieces: step.pieces });
            }
            step.pieces = ((f64::from(step.pieces) * wanted) as u32).min(MOST_PIECES);
            step.length = length / f64::from(step.pieces);
        }
    });
    report(world, Stage::Dynamics, proposed);
    world.insert_resource(step);
}

/// Moves the films to where they are proposed to be, as far as none touches another, piece by piece.
///
/// Where a wire would carry a film through another, all motion stops short of that; the wire catches up once the tracker has joined what
/// met, and one that cannot go on for many steps is a fault.
pub fn move_films(world: &mut World) {
    let whole = world.resource::<Clock>().step_length;
    let mut step = std::mem::take(&mut *world.resource_mut::<FlowStep>());
    let settings = MotionSettings::new(world.resource::<MeshRules>().policy.edge);
    let moved = with_flow(world, |world, surface, flow, state| {
        let mut piece = Piece { from: 0.0, length: step.length };
        let mut lag = *world.resource::<WireLag>();
        loop {
            let wanted = flow.proposal().positions.clone();
            let from = surface.positions.clone();
            let report = advance(surface, &wanted.0, &settings);
            step.limited = step.limited.max(report.limited_vertices);
            step.least_fraction = step.least_fraction.min(report.least_fraction).min(report.pinned_fraction);
            flow.finish(&as_if_whole(&from, &wanted, surface, report.pinned_fraction), piece.length, state);
            if report.pinned_fraction < 1.0 {
                let done = piece.from + report.pinned_fraction * piece.length;
                let stopped = lag.stopped(whole, done, MOST_STOPS);
                *world.resource_mut::<WireLag>() = lag;
                return Ok(stopped?);
            }
            let left = whole - piece.from - piece.length;
            if left <= ROUNDING * whole {
                lag.went_on(whole);
                *world.resource_mut::<WireLag>() = lag;
                return Ok(());
            }
            piece = Piece { from: piece.from + piece.length, length: step.length.min(left) };
            propose(world, &mut step, piece, surface, flow, state)?;
        }
    });
    report(world, Stage::Deform, moved);
    world.insert_resource(step);
}

/// Gives the bubbles back what remeshing took of their volumes, or takes what it gave: joining vertices and flipping edges cut corners
/// off curved films. It is no motion in time: velocities stay.
///
/// A bubble that is too small or too thin for it is left to the next step.
pub fn restore_volumes(world: &mut World) {
    if !world.resource::<TopologyChanged>().0 || !world.resource::<FlowRules>().keeps_volumes {
        return;
    }
    let (settings, edge) = (world.resource::<FlowRules>().settings, world.resource::<MeshRules>().policy.edge);
    // Errors are the next step's to report, which has the time to go far: here nothing has moved yet.
    let _ = with_flow(world, |world, surface, flow, state| {
        lay_out(world, flow, surface);
        flow.restore_volumes(surface, state, &settings)?;
        let wanted = &flow.proposal().positions.0;
        if longest_way(surface, flow) < LONGEST_WAY * edge {
            // A vertex that is held up here is settled by the next step.
            let _ = advance(surface, wanted, &MotionSettings::new(edge));
        }
        Ok(())
    });
}

/// Where the films would have got in the whole time if motion had not been cut at a fraction of it: their velocities are those of the
/// proposal, but for what held single vertices up.
fn as_if_whole(
    from: &PerVertex<DVec3>,
    wanted: &PerVertex<DVec3>,
    surface: &Surface,
    fraction: f64,
) -> PerVertex<DVec3> {
    if fraction >= 1.0 {
        return surface.positions.clone();
    }
    let off = |v: usize| surface.positions.0[v] - from.0[v].lerp(wanted.0[v], fraction);
    let detour = |v: usize| if fraction > 0.0 { off(v) / fraction } else { DVec3::ZERO };
    PerVertex((0..wanted.len()).map(|v| wanted.0[v] + detour(v)).collect())
}

/// Mass and acceleration of every vertex.
fn loads(world: &mut World) -> (Vec<f64>, Vec<DVec3>) {
    let (rules, liquid) = (*world.resource::<FlowRules>(), *world.resource::<Liquid>());
    let areas = read_column::<MeshVertex, Area>(world);
    let volumes = read_column::<MeshVertex, LiquidVolume>(world);
    let accelerations = read_column::<MeshVertex, ExternalAcceleration>(world);
    let pressures = read_column::<MeshVertex, ExternalPressure>(world);
    let normals = read_column::<MeshVertex, Normal>(world);
    let mass = |v: usize| mass_of(&rules, &liquid, areas[v], volumes[v]);
    let masses: Vec<f64> = (0..areas.len()).map(mass).collect();
    // Vertices of ghosts alone have no mass, and nothing pushes them.
    let per_mass = |v: usize| if masses[v] > 0.0 { pressures[v].0 * areas[v].0 / masses[v] } else { 0.0 };
    let push = |v: usize| accelerations[v].0 + normals[v].0 * per_mass(v);
    let pushes = (0..areas.len()).map(push).collect();
    (masses, pushes)
}

/// Films, work space and state of the flow out of the world, and back with what `work` makes of them.
fn with_flow(
    world: &mut World,
    work: impl FnOnce(&mut World, &mut Surface, &mut Flow, &mut FlowState) -> Result<(), MotionFault>,
) -> Result<(), MotionFault> {
    let mut surface = films::take(world);
    let mut scratch = std::mem::take(&mut *world.resource_mut::<FlowWork>());
    let gas = world.resource::<BubbleGas>().clone();
    let velocities = PerVertex(read_column::<MeshVertex, Velocity>(world).iter().map(|u| u.0).collect());
    let mut state = FlowState { velocities, pressures: gas.pressures, target_volumes: gas.targets };
    let done = work(world, &mut surface, &mut scratch.flow, &mut state);
    let velocities: Vec<Velocity> = state.velocities.iter().map(|u| Velocity(*u)).collect();
    fill_column::<MeshVertex, _>(world, &velocities);
    world.insert_resource(BubbleGas { targets: state.target_volumes, pressures: state.pressures, ramps: gas.ramps });
    world.insert_resource(scratch);
    films::put_back(world, surface);
    done
}

fn propose(
    world: &World,
    step: &mut FlowStep,
    piece: Piece,
    surface: &mut Surface,
    flow: &mut Flow,
    state: &FlowState,
) -> Result<(), FlowError> {
    let (rules, liquid) = (world.resource::<FlowRules>(), world.resource::<Liquid>());
    let targets = targets(world, surface, piece);
    let forcing = Forcing {
        tension: Weights::Uniform(2.0 * liquid.surface_tension),
        mass: Mass::PerVertex(&step.masses),
        acceleration: Acceleration::PerVertex(&step.pushes),
        targets: targets.as_deref(),
    };
    let slides =
        world.get_resource::<Slides>().filter(|slides| piece.from == 0.0 && slides.0.len() == surface.positions.len());
    let unslid = slides.map(|slides| {
        let unslid = surface.positions.clone();
        surface.positions.0.iter_mut().zip(slides.0.iter()).for_each(|(x, d)| *x += *d);
        unslid
    });
    let info = flow.propose(surface, state, &forcing, &rules.settings, piece.length);
    if let Some(unslid) = unslid {
        surface.positions = unslid;
    }
    let info = info?;
    step.solve_iterations += info.solve_iterations;
    step.substeps += info.substeps;
    Ok(())
}

/// Where held vertices are at the end of a piece; `None` where no wire moves.
fn targets(world: &World, surface: &Surface, piece: Piece) -> Option<Vec<DVec3>> {
    let holders = world.resource::<Holders>();
    if !holders.move_at_all() {
        return None;
    }
    let clock = world.resource::<Clock>();
    let (from, to) = world.resource::<WireLag>().window(clock.time, clock.step_length, piece.from, piece.length);
    let pins = world.resource::<Pins>();
    let positions: Vec<Position> = surface.positions.iter().map(|x| Position(*x)).collect();
    Some(holders.targets(&positions, &pins.0, from, to))
}

fn longest_way(surface: &Surface, flow: &Flow) -> f64 {
    let ways = flow.proposal().positions.iter().zip(surface.positions.iter()).map(|(to, from)| to.distance(*from));
    ways.fold(0.0, f64::max)
}

fn report(world: &mut World, stage: Stage, done: Result<(), MotionFault>) {
    if let Err(error) = done {
        world.resource_mut::<Faults>().report(Fault::new(stage, "geometric flow", error.to_string()));
    }
}
