//! Wires that feed the films they hold: liquid that clings to a wire goes along with the film that is drawn out of it.
//!
//! # Discretisation
//! Film that a wire draws out is that of the faces on the wire. Their vertices have at least the thickness that the wire feeds,
//! `V_v >= h A_v`; what that takes is counted in [`LiquidFed`].
//!
//! # Limits
//! A constant thickness: that it grows with the speed of drawing (Frankel's law) is not modelled.

use bevy_ecs::resource::Resource;
use bevy_ecs::world::World;
use froth_components::film::LiquidVolume;
use froth_components::kind::MeshVertex;
use froth_components::motion::Pinned;
use froth_surface::Surface;
use serde::{Deserialize, Serialize};

use super::discretise::{AuthoredFilm, AuthoredWire};
use super::films;
use super::wires::Holders;
use crate::rows::{fill_column, read_column};

/// Thickness that each wire feeds, metres, by the number that vertices carry in [`Pinned`]. Constant in a run.
#[derive(Resource, Clone, Debug, Default)]
pub struct Feeds(Vec<(Pinned, f64)>);

impl Feeds {
    /// The wires of a scene that feed their films.
    #[must_use]
    pub fn of(films: &[AuthoredFilm], wires: &[AuthoredWire]) -> Self {
        let feeds = wires.iter().enumerate().filter_map(|(number, wire)| {
            let thickness = wire.wire.feeds?.si();
            Some((Pinned(Holders::pin_of_wire(films.len(), number)), thickness))
        });
        Self(feeds.collect())
    }

    /// Whether no wire feeds its films.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    fn thickness(&self, pin: Pinned) -> Option<f64> {
        self.0.iter().find(|(wire, _)| *wire == pin).map(|(_, thickness)| *thickness)
    }
}

/// Liquid that wires have given to films, m^3. State of a run.
#[derive(Resource, Clone, Copy, Debug, Default, Serialize, Deserialize)]
#[serde(transparent)]
pub struct LiquidFed(pub f64);

/// Gives the films on wires the liquid that they draw out of these.
pub fn feed_films(world: &mut World) {
    let pins = read_column::<MeshVertex, Pinned>(world);
    let mut volumes = read_column::<MeshVertex, LiquidVolume>(world);
    let surface = films::take(world);
    let wanted = wanted(&surface, &pins, world.resource::<Feeds>());
    films::put_back(world, surface);
    let mut fed = 0.0;
    for (volume, wanted) in volumes.iter_mut().zip(wanted) {
        fed += (wanted - volume.0).max(0.0);
        volume.0 = volume.0.max(wanted);
    }
    fill_column::<MeshVertex, _>(world, &volumes);
    world.resource_mut::<LiquidFed>().0 += fed;
}

/// Least volume of liquid per vertex, m^3.
fn wanted(surface: &Surface, pins: &[Pinned], feeds: &Feeds) -> Vec<f64> {
    let mut thickness = vec![0.0f64; pins.len()];
    let mut areas = vec![0.0; pins.len()];
    for (row, face) in surface.mesh.faces().filter(|(_, face)| !face.is_ghost()) {
        let vertices = face.vertices().map(|v| v.index());
        let fed = vertices.iter().filter_map(|v| feeds.thickness(pins[*v])).fold(0.0, f64::max);
        for v in vertices {
            thickness[v] = thickness[v].max(fed);
            areas[v] += surface.area(row) / 3.0;
        }
    }
    thickness.into_iter().zip(areas).map(|(h, area)| h * area).collect()
}
