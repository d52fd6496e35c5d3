//! The registry of resources that are state: what a run needs, besides the columns, to go on where it stopped.
//!
//! ```
//! use bevy_ecs::prelude::{Resource, World};
//! use froth_systems::rows::state::StateRegistry;
//!
//! #[derive(Resource, Default, serde::Serialize, serde::Deserialize)]
//! struct Burst { next_id: u64 }
//!
//! let mut world = World::new();
//! StateRegistry::register::<Burst>(&mut world, "burst"); // checkpoints now save and load it
//! world.init_resource::<Burst>();
//! ```

use bevy_ecs::resource::Resource;
use bevy_ecs::world::World;
use serde::Serialize;
use serde::de::DeserializeOwned;

/// Every resource that is state, in the order of registration.
#[derive(Resource, Default)]
pub struct StateRegistry {
    entries: Vec<StateEntry>,
}

/// What the registry knows of one resource. It has no format of its own: checkpoints choose that.
#[derive(Clone, Copy)]
pub struct StateEntry {
    /// Stable name, unique in a run.
    pub name: &'static str,
    save: for<'w> fn(&'w World) -> Option<&'w dyn erased_serde::Serialize>,
    load: fn(&mut World, &mut dyn erased_serde::Deserializer<'_>) -> Result<(), erased_serde::Error>,
    remove: fn(&mut World),
}

impl StateEntry {
    /// The resource, to be written by any serialiser; `None` where the world does not have it.
    #[must_use]
    pub fn get<'w>(&self, world: &'w World) -> Option<&'w dyn erased_serde::Serialize> {
        (self.save)(world)
    }

    /// Inserts the resource as a deserialiser reads it.
    ///
    /// # Errors
    /// Those of the deserialiser.
    pub fn load(
        &self,
        world: &mut World,
        deserializer: &mut dyn erased_serde::Deserializer<'_>,
    ) -> Result<(), erased_serde::Error> {
        (self.load)(world, deserializer)
    }

    /// Removes the resource: the saved world did not have it.
    pub fn remove(&self, world: &mut World) {
        (self.remove)(world);
    }
}

impl StateRegistry {
    /// Notes that `R` is state. A second registration of the same name changes nothing.
    pub fn register<R: Resource + Serialize + DeserializeOwned>(world: &mut World, name: &'static str) {
        let mut registry = world.get_resource_or_init::<Self>();
        if registry.entries.iter().all(|entry| entry.name != name) {
            let entry = StateEntry {
                name,
                save: get::<R>,
                load: insert::<R>,
                remove: |world| drop(world.remove_resource::<R>()),
            };
            registry.entries.push(entry);
        }
    }

    /// All resources that are state.
    #[must_use]
    pub fn entries(&self) -> &[StateEntry] {
        &self.entries
    }
}

fn get<R: Resource + Serialize>(world: &World) -> Option<&dyn erased_serde::Serialize> {
    world.get_resource::<R>().map(|resource| resource as &dyn erased_serde::Serialize)
}

fn insert<R: Resource + DeserializeOwned>(
    world: &mut World,
    deserializer: &mut dyn erased_serde::Deserializer<'_>,
) -> Result<(), erased_serde::Error> {
    world.insert_resource(erased_serde::deserialize::<R>(deserializer)?);
    Ok(())
}
