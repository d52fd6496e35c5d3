//! What a scene says besides its entities.

use bevy_ecs::resource::Resource;
use froth_components::authored::liquid::{Atmosphere, Liquid};
use froth_components::authored::method::MethodChoice;
use froth_components::authored::resolution::Resolution;
use froth_components::quantity::{Rate, Time};

/// What a scene says besides its entities. A resource of every simulated world.
#[derive(Resource, Clone, Debug, PartialEq)]
pub struct SceneHeader {
    /// One line for people.
    pub title: String,
    /// The method and its settings.
    pub method: MethodChoice,
    /// How finely films are sampled.
    pub resolution: Resolution,
    /// Time that passes in the scene, seconds.
    pub duration: Time,
    /// Pictures and exports per second of scene time. Default 50.
    pub frames_per_second: Rate,
    /// Seed of everything random. Default 0.
    pub seed: u64,
    /// The liquid of all films.
    pub liquid: Liquid,
    /// The air around them.
    pub atmosphere: Atmosphere,
    /// Longest step the method may take, seconds. Default: as the method likes.
    pub maximum_step: Option<Time>,
}
