//! Geometric flow on a multi-region mesh (Ishida et al. 2017): the method as a table of contents.

use bevy_ecs::world::World;
use froth_components::authored::burst::Burst;
use froth_components::authored::field::Gravity;
use froth_components::authored::method::{GeometricFlowSettings, MethodChoice};
use froth_components::authored::wire::Moves;
use froth_components::kind::MeshVertex;
use froth_components::material::Atmosphere;
use froth_systems::bubbles::gas;
use froth_systems::bubbles::observe::observe_bubbles;
use froth_systems::forces;
use froth_systems::geometric_flow::measure::{self, FlowWork};
use froth_systems::geometric_flow::motion::{self, FlowStep};
use froth_systems::geometric_flow::settings::FlowRules;
use froth_systems::geometric_flow::step_length::AskedLength;
use froth_systems::geometric_flow::{observe, step_length};
use froth_systems::plan::{Requires, SchedulePlan};
use froth_systems::rows::state::StateRegistry;
use froth_systems::stage::Stage;
use froth_systems::tracker::films::MeshRules;
use froth_systems::tracker::observe::observe_mesh;
use froth_systems::tracker::{bursting, feeding, remeshing, wires};

use super::{DiscretiseError, Method, on_mesh};
use crate::scene::SceneHeader;

/// Geometric flow on a multi-region mesh.
pub const METHOD: Method = Method {
    name: "geometric-flow",
    summary: "mean curvature flow of a multi-region mesh with exact volumes (Ishida et al. 2017)",
    register,
    discretise,
    assemble,
};

/// Adds one step of geometric flow to a plan.
pub fn assemble(plan: &mut SchedulePlan) {
    let always = Requires::nothing;
    let left = on_mesh::requires_films;
    let remeshing = on_mesh::requires_remeshing;
    plan.add(Stage::Clock, "forget the events of the last step", on_mesh::forget_step, always());
    plan.add(Stage::Clock, "limit the step by speed (CFL)", step_length::limit_step, always());
    let bursting = || Requires::component::<Burst>("bursts");
    plan.add(Stage::Clock, "end a step at every burst", bursting::stop_at_bursts, bursting());
    plan.add(Stage::Geometry, "measure areas, normals, curvature, thickness", measure::measure_films, always());
    plan.add(Stage::Forces, "clear external forces", forces::clear::<MeshVertex>, left());
    let gravity = Requires::component::<Gravity>("gravity").and(left());
    plan.add(Stage::Forces, "gravity", forces::pull_evenly_by_gravity::<MeshVertex>, gravity);
    let smoothing = Requires::that("a mesh that is smoothed (`smoothing`)", smooths_mesh);
    plan.add(Stage::Dynamics, "slide vertices along their films", remeshing::slide_mesh, smoothing);
    let moving = Requires::component::<Moves>("a wire or a rim that moves");
    plan.add(Stage::Dynamics, "note what holds which vertex", wires::note_pins, moving);
    let propose = "let gas in and out, propose the films' motion (tension, volumes, wires), end the step where faces would go flat";
    plan.add(Stage::Dynamics, propose, motion::propose_motion, always());
    plan.add(Stage::Deform, "move the films, as far as none touches another", motion::move_films, always());
    let feed = "wires feed the films that they hold";
    plan.add(Stage::Topology, feed, feeding::feed_films, on_mesh::requires_feeding());
    plan.add(Stage::Topology, "burst films", bursting::burst_films, bursting());
    plan.add(Stage::Topology, "snap, split, collapse, flip, separate", remeshing::remesh, remeshing());
    plan.add(Stage::Topology, "gas follows the bubbles", gas::follow_bubbles, always());
    plan.add(Stage::Topology, "give the bubbles their volumes back", motion::restore_volumes, remeshing());
    plan.add(Stage::Observe, "measure the films as they are", measure::measure_films, always());
    plan.add(Stage::Observe, "write the regions", gas::write_regions, always());
    plan.add(Stage::Observe, "record the films", observe::observe_films, always());
    plan.add(Stage::Observe, "record the bubbles", observe_bubbles, always());
    plan.add(Stage::Observe, "record the mesh", observe_mesh, always());
}

fn smooths_mesh(world: &World) -> bool {
    world.get_resource::<MeshRules>().is_some_and(|rules| rules.smoothing > 0.0)
}

/// Registers what every method on a mesh has, and the flow's own rules and work space.
pub fn register(world: &mut World) {
    let authored = settings(world);
    let scale = on_mesh::register(world, &authored.remesh);
    let air = *world.resource::<Atmosphere>();
    world.insert_resource(FlowRules::new(&authored, air, scale.size));
    world.init_resource::<FlowWork>();
    world.init_resource::<FlowStep>();
    StateRegistry::register::<AskedLength>(world, "asked_length");
    world.init_resource::<AskedLength>();
}

/// The scene's settings; the defaults where it is written for another method.
fn settings(world: &World) -> GeometricFlowSettings {
    match world.resource::<SceneHeader>().method {
        MethodChoice::GeometricFlow(settings) => settings,
        _ => GeometricFlowSettings::default(),
    }
}

/// Turns the authored films into one mesh.
///
/// # Errors
/// A [`FilmFault`](froth_systems::tracker::discretise::FilmFault): a mesh from a file that is at fault, films that cross, wires that
/// hold nothing.
pub fn discretise(world: &mut World) -> Result<(), DiscretiseError> {
    on_mesh::discretise(world)?;
    measure::measure_films(world);
    gas::write_regions(world);
    Ok(())
}
