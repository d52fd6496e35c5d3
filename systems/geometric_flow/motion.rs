//! Where the films go in a step, and how far they get.
//!
//! Vertices first slide along their films ([`Slides`]), which is a motion of the mesh and no velocity. From there the flow proposes
//! positions ([`froth_surface::flow`]), with exact volumes; then every vertex goes as far as no film touches another
//! ([`froth_surface::motion`]).
//!
//! # Limits
//! A proposal that would carry a vertex farther than half an edge length, or faces out of shape
//! ([`froth_surface::flow::shape_keeping`]), is made again for a shorter time. The step ends there: the mesh is mended, and the next
//! step goes on. Faces that lose their shapes for less than [`LEAST_PART`] of the step do lose them: time goes on.

use bevy_ecs::resource::Resource;
use bevy_ecs::world::World;
use froth_components::clock::Clock;
use froth_components::film::{Area, LiquidVolume};
use froth_components::kind::MeshVertex;
use froth_components::material::Liquid;
use froth_components::motion::{ExternalAcceleration, ExternalPressure, Normal, Position, Velocity};
use froth_surface::flow::shape_keeping::{LEAST_PART, even_part};
use froth_surface::flow::{Acceleration, Flow, FlowError, FlowState, Forcing, Mass};
use froth_surface::motion::{MotionSettings, advance};
use froth_surface::{PerVertex, Surface};
use glam::DVec3;
use thiserror::Error;

use super::measure::{FlowWork, lay_out, mass_of};
use super::settings::FlowRules;
use super::step_length::AskedLength;
use crate::bubbles::gas::BubbleGas;
use crate::clock::{StepLimits, end_of_step};
use crate::observe::{Fault, Faults};
use crate::rows::{fill_column, read_column};
use crate::stage::Stage;
use crate::tracker::films::{self, MeshRules, TopologyChanged};
use crate::tracker::remeshing::Slides;
use crate::tracker::tension::FilmTensions;
use crate::tracker::wires::{Holders, MOST_STOPS, Pins, WireLag, WireStuck};

/// Part of an edge length that a vertex may move in one step.
const LONGEST_WAY: f64 = 0.5;
/// Part of the step that was asked for below which films that still go too far are running away.
const SHORTEST_STEP: f64 = 1.0 / 64.0;
/// Proposals that may be made for the sake of shapes.
const MOST_PROPOSALS: u32 = 8;
/// Part of a step that is nothing but rounding.
const ROUNDING: f64 = 1e-9;

/// The step as the flow proposes it, and what became of it. Not part of the state of a run.
#[derive(Resource, Clone, Debug, Default)]
pub struct FlowStep {
    /// Proposals that were made: more than one where the step ended early.
    pub proposals: u32,
    /// Free vertices that could not go all their way.
    pub limited: usize,
    /// Least fraction of its way that one went, dimensionless.
    pub least_fraction: f64,
    /// Iterations of the linear solver in all proposals.
    pub solve_iterations: u32,
    /// Substeps of the explicit scheme in all proposals.
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
    /// A vertex would go too far, however short the step.
    #[error(
        "a vertex would move {ways:.1} edge lengths in {length:.3e} s, a {part:.0}th of the step: the films run away; shorten `time_step`"
    )]
    RunsAway {
        /// Way, in edge lengths.
        ways: f64,
        /// Time that it would take, s.
        length: f64,
        /// How many times as long the step was to be.
        part: f64,
    },
    /// A wire cannot go on.
    #[error(transparent)]
    Wire(#[from] WireStuck),
}

/// What a proposal does to the mesh.
#[derive(Clone, Copy, Debug)]
struct Reach {
    /// Longest way of a vertex, in edge lengths.
    ways: f64,
    /// Part of the way for which all faces keep their shapes, 0 to 1.
    even: f64,
}

impl Reach {
    /// Name and length of the step to be tried next, s; `None` where the mesh bears the one of `length`. `asked`: length of the step at
    /// first; `proposals`: how many there were.
    fn shorter(self, length: f64, asked: f64, proposals: u32) -> Result<Option<(&'static str, f64)>, MotionFault> {
        if self.ways > LONGEST_WAY {
            let shortest = SHORTEST_STEP * asked;
            if length <= shortest * (1.0 + ROUNDING) {
                return Err(MotionFault::RunsAway { ways: self.ways, length, part: asked / length });
            }
            return Ok(Some(("longest way", (length / (self.ways / LONGEST_WAY).ceil()).max(shortest))));
        }
        let shortest = LEAST_PART * asked;
        let is_borne = self.even >= 1.0 || length <= shortest || proposals >= MOST_PROPOSALS;
        Ok((!is_borne).then(|| ("shapes of faces", (self.even * length).max(shortest))))
    }
}

/// Works out where tension, pressure, gas that is let in, external forces and wires take the films, and ends the step where the mesh would
/// have to be mended.
pub fn propose_motion(world: &mut World) {
    let asked = world.resource::<Clock>().step_length;
    world.insert_resource(AskedLength(asked));
    let (masses, pushes) = loads(world);
    let mut step = FlowStep { least_fraction: 1.0, masses, pushes, ..FlowStep::default() };
    let gas = world.resource::<BubbleGas>().clone();
    let proposed = loop {
        let clock = *world.resource::<Clock>();
        let mut filled = gas.clone();
        filled.fill(clock.time, end_of_step(&clock));
        world.insert_resource(filled);
        step.proposals += 1;
        let reach = propose_step(world, &mut step);
        match reach.and_then(|reach| reach.shorter(clock.step_length, asked, step.proposals)) {
            Ok(Some((limit, length))) => end_step_after(world, limit, length),
            Ok(None) => break Ok(()),
            Err(fault) => break Err(fault),
        }
    };
    report(world, Stage::Dynamics, proposed);
    world.insert_resource(step);
}

fn end_step_after(world: &mut World, limit: &'static str, length: f64) {
    world.resource_mut::<Clock>().step_length = length;
    world.resource_mut::<StepLimits>().propose(limit, length);
}

/// A proposal for the step as long as it is, and what it does to the mesh.
fn propose_step(world: &mut World, step: &mut FlowStep) -> Result<Reach, MotionFault> {
    let MeshRules { policy, remesh, .. } = *world.resource::<MeshRules>();
    with_flow(world, |world, surface, flow, state| {
        propose(world, step, surface, flow, state)?;
        // A mesh that nobody mends only gets later what it does not get now.
        let even = if remesh { even_part(surface, &flow.proposal().positions.0) } else { 1.0 };
        Ok(Reach { ways: longest_way(surface, flow) / policy.edge, even })
    })
}

/// Moves the films to where they are proposed to be, as far as none touches another.
///
/// Where a wire would carry a film through another, all motion stops short of that; the wire catches up once the tracker has joined what
/// met, and one that cannot go on for many steps is a fault.
pub fn move_films(world: &mut World) {
    let length = world.resource::<Clock>().step_length;
    let mut step = std::mem::take(&mut *world.resource_mut::<FlowStep>());
    let settings = MotionSettings::new(world.resource::<MeshRules>().policy.edge);
    let moved = with_flow(world, |world, surface, flow, state| {
        let wanted = flow.proposal().positions.clone();
        let from = surface.positions.clone();
        let report = advance(surface, &wanted.0, &settings);
        step.limited = report.limited_vertices;
        step.least_fraction = report.least_fraction.min(report.pinned_fraction);
        flow.finish(&as_if_whole(&from, &wanted, surface, report.pinned_fraction), length, state);
        let mut lag = world.resource_mut::<WireLag>();
        if report.pinned_fraction < 1.0 {
            return Ok(lag.stopped(length, report.pinned_fraction * length, MOST_STOPS)?);
        }
        lag.went_on(length);
        Ok(())
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
fn with_flow<T>(
    world: &mut World,
    work: impl FnOnce(&mut World, &mut Surface, &mut Flow, &mut FlowState) -> Result<T, MotionFault>,
) -> Result<T, MotionFault> {
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
    surface: &mut Surface,
    flow: &mut Flow,
    state: &FlowState,
) -> Result<(), FlowError> {
    let (rules, tensions) = (world.resource::<FlowRules>(), FilmTensions::of(world, &surface.mesh));
    let targets = targets(world, surface);
    let forcing = Forcing {
        tension: tensions.weights(),
        mass: Mass::PerVertex(&step.masses),
        acceleration: Acceleration::PerVertex(&step.pushes),
        targets: targets.as_deref(),
    };
    let slides = world.get_resource::<Slides>().filter(|slides| slides.0.len() == surface.positions.len());
    let unslid = slides.map(|slides| {
        let unslid = surface.positions.clone();
        surface.positions.0.iter_mut().zip(slides.0.iter()).for_each(|(x, d)| *x += *d);
        unslid
    });
    let info = flow.propose(surface, state, &forcing, &rules.settings, world.resource::<Clock>().step_length);
    if let Some(unslid) = unslid {
        surface.positions = unslid;
    }
    let info = info?;
    step.solve_iterations += info.solve_iterations;
    step.substeps += info.substeps;
    Ok(())
}

/// Where held vertices are at the end of the step; `None` where no wire moves.
fn targets(world: &World, surface: &Surface) -> Option<Vec<DVec3>> {
    let holders = world.resource::<Holders>();
    if !holders.move_at_all() {
        return None;
    }
    let Clock { time, step_length, .. } = *world.resource::<Clock>();
    let (from, to) = world.resource::<WireLag>().window(time, step_length, 0.0, step_length);
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

#[cfg(test)]
mod tests {
    use super::*;

    fn next(ways: f64, even: f64, length: f64, proposals: u32) -> Result<Option<(&'static str, f64)>, MotionFault> {
        Reach { ways, even }.shorter(length, 1.0, proposals)
    }

    #[test]
    fn a_step_that_the_mesh_bears_is_not_cut() {
        assert_eq!(next(LONGEST_WAY, 1.0, 1.0, 1), Ok(None));
    }

    #[test]
    fn a_step_ends_where_faces_lose_their_shapes_and_never_at_once() {
        assert_eq!(next(0.1, 0.75, 1.0, 1), Ok(Some(("shapes of faces", 0.75))));
        assert_eq!(next(0.1, 0.0, 0.75, 2), Ok(Some(("shapes of faces", LEAST_PART))));
        assert_eq!(next(0.1, 0.0, LEAST_PART, 3), Ok(None));
        assert_eq!(next(0.1, 0.9, 0.5, MOST_PROPOSALS), Ok(None));
    }

    #[test]
    fn films_that_go_too_far_in_the_shortest_step_run_away() {
        assert_eq!(next(1.2, 1.0, 1.0, 1), Ok(Some(("longest way", 1.0 / 3.0))));
        assert_eq!(next(1e3, 1.0, 1.0, 1), Ok(Some(("longest way", SHORTEST_STEP))));
        assert!(matches!(next(1.2, 1.0, SHORTEST_STEP, 9), Err(MotionFault::RunsAway { .. })));
    }
}
