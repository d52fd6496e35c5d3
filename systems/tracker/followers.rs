//! Resources that follow the mesh: data on vertices that is no column, because it has one number per region there, say.
//!
//! A method registers such a resource once; every change of the mesh then takes it along as [`Transfer`] asks.

use bevy_ecs::resource::Resource;
use bevy_ecs::world::World;
use froth_surface::transfer::Transfer;

/// A resource while the mesh changes.
pub trait Follower: Transfer {
    /// Puts it back into the world that it was taken from.
    fn put_back(self: Box<Self>, world: &mut World);
}

impl<R: Resource + Transfer> Follower for R {
    fn put_back(self: Box<Self>, world: &mut World) {
        world.insert_resource(*self);
    }
}

type Take = fn(&mut World) -> Option<Box<dyn Follower>>;

/// Resources that follow the mesh. Constant in a run.
#[derive(Resource, Clone, Debug, Default)]
pub struct Followers(Vec<Take>);

impl Followers {
    /// Lets a resource follow the mesh.
    pub fn register<R: Resource + Transfer>(world: &mut World) {
        let take: Take = |world| Some(Box::new(world.remove_resource::<R>()?));
        world.get_resource_or_init::<Self>().0.push(take);
    }

    /// Takes all of them out of a world, in the order in which they were registered.
    pub(super) fn take(world: &mut World) -> Vec<Box<dyn Follower>> {
        let takes = world.get_resource::<Self>().map_or_else(Vec::new, |followers| followers.0.clone());
        takes.into_iter().filter_map(|take| take(world)).collect()
    }
}
