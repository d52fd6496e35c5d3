//! What a scene file can say: components of authored entities, and the settings of a run.
//!
//! An authored entity (a film, a field) is turned into discrete ones (particles, vertices) by a method. Every field here states its
//! unit and its default; values are checked where they are read, so that an error points at them.
//!
//! - films: [`shape`], [`mesh_shape`], both together [`film_shape`]; [`perturbation`], [`film`], [`motion`];
//! - what acts on them: [`field`], [`wire`], [`burst`], [`volumes`];
//! - the run: [`method`], [`resolution`], [`liquid`].

pub mod burst;
pub mod field;
pub mod film;
pub mod film_shape;
pub mod liquid;
pub mod mesh_shape;
pub mod method;
pub mod motion;
pub mod perturbation;
pub mod resolution;
pub mod shape;
pub mod tension;
pub mod volumes;
pub mod wire;

use bevy_ecs::component::Component;
use serde::Deserialize;

/// What a user calls an entity, in messages and tables.
#[derive(Component, Clone, Debug, PartialEq, Eq, Deserialize)]
pub struct Name(pub String);

/// Which entity of its scene file this is, counted from 0. With the scene's seed it seeds the entity's noise.
#[derive(Component, Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct PlaceInScene(pub u32);
