//! Vortex sheets on a multi-region mesh (Da et al. 2015): the method as a table of contents.

use bevy_ecs::world::World;
use froth_components::authored::burst::Burst;
use froth_components::authored::field::{Gravity, Wind};
use froth_components::authored::method::{MethodChoice, VortexSheetSettings};
use froth_components::authored::volumes::Volumes;
use froth_components::kind::MeshVertex;
use froth_components::material::Atmosphere;
use froth_sheet::{Layout, Potentials};
use froth_systems::bubbles::gas;
use froth_systems::bubbles::observe::observe_bubbles;
use froth_systems::forces;
use froth_systems::plan::{AnotherPass, Requires, SchedulePlan};
use froth_systems::rows::state::StateRegistry;
use froth_systems::stage::Stage;
use froth_systems::tracker::films::{self, MeshRules};
use froth_systems::tracker::followers::Followers;
use froth_systems::tracker::observe::observe_mesh;
use froth_systems::tracker::{bursting, feeding, remeshing};
use froth_systems::vortex_sheet::settings::SheetRules;
use froth_systems::vortex_sheet::work::{self, SheetWork};
use froth_systems::vortex_sheet::{
    arrival, contacts, dynamics, geometry, motion, observe, remeshed, step_length, velocity,
};

use super::{DiscretiseError, Method, on_mesh};
use crate::scene::SceneHeader;

/// How far from Delaunay pairs of faces are flipped, radians: every flip takes some energy from waves as short as the mesh.
const FLIP_EXCESS: f64 = 20.0 * std::f64::consts::PI / 180.0;

/// Vortex sheets on a multi-region mesh.
pub const METHOD: Method = Method {
    name: "vortex-sheet",
    summary: "films that the air around them moves: circulation on a multi-region mesh (Da et al. 2015)",
    register,
    discretise,
    assemble,
};

/// Adds one step of vortex sheets to a plan.
pub fn assemble(plan: &mut SchedulePlan) {
    let always = Requires::nothing;
    let left = on_mesh::requires_films;
    let remeshing = on_mesh::requires_remeshing;
    plan.add(Stage::Clock, "forget the events of the last step", on_mesh::forget_step, always());
    plan.add(Stage::Clock, "forget what the last step took", work::begin_step, always());
    plan.add(Stage::Clock, "limit step and substeps by speed and capillary waves", step_length::limit_step, always());
    let bursting = || Requires::component::<Burst>("bursts");
    plan.add(Stage::Clock, "end a step at every burst", bursting::stop_at_bursts, bursting());
    plan.add(Stage::Geometry, "measure area vectors and volume gradients", geometry::measure_films, always());
    plan.add(Stage::Forces, "clear external forces", forces::clear::<MeshVertex>, left());
    let gravity = Requires::component::<Gravity>("gravity").and(left());
    plan.add(Stage::Forces, "gravity", forces::pull_evenly_by_gravity::<MeshVertex>, gravity);
    plan.add(Stage::Forces, "the wind blows", dynamics::let_wind_blow, Requires::component::<Wind>("a wind"));
    let filling = || Requires::component::<Volumes>("volumes that change");
    let push = "gas that comes into bubbles pushes the air away";
    plan.add(Stage::Forces, push, dynamics::push_by_gas, filling().and(left()));
    plan.add(Stage::Dynamics, "tension and forces change the potentials", dynamics::press_by_tension, left());
    let wires = Requires::that("films held by wires", has_wires).and(left());
    plan.add(Stage::Dynamics, "circulation on wires carries films along", dynamics::carry_by_wires, wires);
    plan.add(Stage::Velocity, "Biot-Savart: from circulation to velocity", velocity::flow_by_biot_savart, left());
    let shorten = "take the substep again, shorter, where films outrun it";
    plan.add(Stage::Velocity, shorten, step_length::shorten_substep, left());
    plan.add(Stage::Deform, "the integrator takes the rates", motion::integrate, left());
    plan.add(Stage::Deform, "let gas in and out of the bubbles", motion::fill_bubbles, filling());
    plan.add(Stage::Deform, "move the films, as far as none touches another", motion::move_films, left());
    plan.add(Stage::Deform, "tension and forces change the potentials again", arrival::kick_again, left());
    plan.add(Stage::Deform, "films in the way of others come to rest", contacts::rest_contacts, left());
    plan.add(Stage::Deform, "keep the impulse of free clusters", arrival::keep_impulse, left());
    let damping = Requires::that("damping or diffusivity above 0", is_damped).and(left());
    plan.add(Stage::Deform, "circulation diffuses and fades", arrival::damp, damping);
    plan.add(Stage::Deform, "write the potentials", arrival::write_potentials, left());
    plan.add(Stage::Advance, "fit pressures of bubbles", arrival::fit_pressures, left());
    plan.add(Stage::Advance, "note impulses of clusters", remeshed::note_impulses, remeshing());
    let feed = "wires feed the films that they hold";
    plan.add(Stage::Topology, feed, feeding::feed_films, on_mesh::requires_feeding());
    plan.add(Stage::Topology, "burst films", bursting::burst_films, bursting());
    plan.add(Stage::Topology, "snap, split, collapse, flip, separate", remeshing::remesh, remeshing());
    plan.add(Stage::Topology, "gas follows the bubbles", gas::follow_bubbles, always());
    plan.add(Stage::Topology, "recall the air's energy before films met", contacts::recall_energy, remeshing());
    plan.add(Stage::Topology, "give the bubbles their volumes back", remeshed::restore_volumes, remeshing());
    plan.add(Stage::Topology, "films that met slow down", contacts::calm_contacts, remeshing());
    plan.add(Stage::Topology, "give clusters their impulse back", remeshed::restore_impulses, remeshing());
    plan.add(Stage::Observe, "measure the films as they are", geometry::write_shape, always());
    plan.add(Stage::Observe, "write the regions", gas::write_regions, always());
    plan.add(Stage::Observe, "record the films", observe::observe_films, always());
    plan.add(Stage::Observe, "record the bubbles", observe_bubbles, always());
    plan.add(Stage::Observe, "record the mesh", observe_mesh, always());
}

fn is_damped(world: &World) -> bool {
    world.get_resource::<SheetRules>().is_some_and(|rules| rules.damping > 0.0 || rules.diffusivity > 0.0)
}

fn has_wires(world: &World) -> bool {
    world.get_resource::<SheetWork>().is_some_and(|work| work.sheet.wires.held().contains(&true))
}

/// Registers what every method on a mesh has, the potentials, and the sheet's rules and work space.
pub fn register(world: &mut World) {
    let authored = settings(world);
    let scale = on_mesh::register(world, &authored.remesh);
    world.resource_mut::<MeshRules>().policy.flip_excess = FLIP_EXCESS;
    let rules = SheetRules::new(&authored, *world.resource::<Atmosphere>(), scale.edge);
    world.insert_resource(rules);
    StateRegistry::register::<Potentials>(world, "potentials");
    Followers::register::<Potentials>(world);
    world.init_resource::<Potentials>();
    world.init_resource::<AnotherPass>();
    let work = SheetWork::new(&rules).expect("invariant: scenes refuse a smoothing length of zero");
    world.insert_resource(work);
}

/// The scene's settings; the defaults where it is written for another method.
fn settings(world: &World) -> VortexSheetSettings {
    match world.resource::<SceneHeader>().method {
        MethodChoice::VortexSheet(settings) => settings,
        _ => VortexSheetSettings::default(),
    }
}

/// Turns the authored films into one mesh with the air at rest.
///
/// # Errors
/// A [`FilmFault`](froth_systems::tracker::discretise::FilmFault): a mesh from a file that is at fault, films that cross, wires that
/// hold nothing.
pub fn discretise(world: &mut World) -> Result<(), DiscretiseError> {
    on_mesh::discretise(world)?;
    let surface = films::take(world);
    let potentials = Potentials::at_rest(&Layout::new(&surface));
    films::put_back(world, surface);
    world.insert_resource(potentials);
    geometry::write_shape(world);
    gas::write_regions(world);
    Ok(())
}
