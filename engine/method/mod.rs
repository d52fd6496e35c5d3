//! The methods: each a short file that lists its systems per stage.
//!
//! | step of a run | function | sees |
//! |---|---|---|
//! | names its columns, state and constants | [`Method::register`] | the [`SceneHeader`](crate::scene::SceneHeader), [`Clock`](froth_components::clock::Clock), [`Seed`](froth_components::clock::Seed), `Liquid` and `Atmosphere` as resources; the authored entities |
//! | turns authored entities into rows | [`Method::discretise`] | the same; only when a run begins |
//! | lists its systems | [`Method::assemble`] | an empty plan |
//!
//! A resumed run is registered and assembled alike, but its rows and state come from a checkpoint: what `discretise` makes must be
//! registered columns and registered state, and constants of the scene belong into `register`.

pub mod geometric_flow;
pub mod melp;
mod on_mesh;
pub mod vortex_sheet;

use std::error::Error;

use bevy_ecs::world::World;
use froth_components::authored::method::MethodName;
use froth_systems::plan::SchedulePlan;

/// Why authored entities cannot be turned into rows: the method's own typed error.
pub type DiscretiseError = Box<dyn Error + Send + Sync>;

/// A method: how it prepares a world, and the systems of a step.
#[derive(Clone, Copy, Debug)]
pub struct Method {
    /// Name on the command line and in messages.
    pub name: &'static str,
    /// What it is, in one line.
    pub summary: &'static str,
    /// Registers columns and state, inserts what follows from the scene alone.
    pub register: fn(&mut World),
    /// Turns the authored entities into rows.
    pub discretise: fn(&mut World) -> Result<(), DiscretiseError>,
    /// Adds the systems of a step.
    pub assemble: fn(&mut SchedulePlan),
}

/// Every method that can run, in the order of listings.
pub const METHODS: &[Method] = &[melp::METHOD, geometric_flow::METHOD, vortex_sheet::METHOD];

/// The method that scene files and the command line call `name`, if it can run.
#[must_use]
pub fn method(name: MethodName) -> Option<&'static Method> {
    METHODS.iter().find(|method| method.name == name.on_command_line())
}
