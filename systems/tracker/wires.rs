//! Wires: which vertices they hold, and where those go.
//!
//! A held vertex carries the number of its wire in [`Pinned`]; 0 is free. What holds it moves each point by the same way
//! ([`Moves::way`]), so a step of a held vertex is the way of its wire in that step.

use bevy_ecs::resource::Resource;
use bevy_ecs::world::World;
use froth_components::authored::wire::Moves;
use froth_components::kind::MeshVertex;
use froth_components::motion::{Pinned, Position};
use glam::DVec3;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::discretise::{AuthoredFilm, AuthoredWire};
use crate::rows::read_column;

/// Steps in a row for which a wire may be held up by a film.
pub const MOST_STOPS: u32 = 20;

/// What holds vertices, at rest (`None`) or moving. Constant in a run.
///
/// Holder `n` is the number `n + 1` in [`Pinned`]: first the films, in the order of the scene, each for its own rim, then the wires.
#[derive(Resource, Clone, Debug, Default)]
pub struct Holders(Vec<Option<Moves>>);

impl Holders {
    /// The holders of a scene.
    #[must_use]
    pub fn of(films: &[AuthoredFilm], wires: &[AuthoredWire]) -> Self {
        let (rims, wires) = (films.iter().map(|film| &film.moves), wires.iter().map(|wire| &wire.moves));
        Self(rims.chain(wires).cloned().collect())
    }

    /// What a vertex on the rim of a film carries; the film's number counts from 0.
    #[must_use]
    pub fn pin_of_rim(film: usize) -> u64 {
        film as u64 + 1
    }

    /// What a vertex on a wire carries; the wire's number counts from 0.
    #[must_use]
    pub fn pin_of_wire(films: usize, wire: usize) -> u64 {
        (films + wire) as u64 + 1
    }

    /// Whether it is a film's own rim that holds a vertex.
    #[must_use]
    pub fn is_rim(pin: u64, films: usize) -> bool {
        (1..=films as u64).contains(&pin)
    }

    /// Whether any moves.
    #[must_use]
    pub fn move_at_all(&self) -> bool {
        self.0.iter().any(Option::is_some)
    }

    /// Way of a holder from a time to a later one, metres. `from` and `to` in seconds.
    #[must_use]
    pub fn way(&self, pin: Pinned, from: f64, to: f64) -> DVec3 {
        let number = (pin.0 as usize).checked_sub(1);
        let moves = number.and_then(|number| self.0.get(number)?.as_ref());
        moves.map_or(DVec3::ZERO, |moves| moves.way(to) - moves.way(from))
    }

    /// Where held vertices are at the end of a step; free ones where they are.
    #[must_use]
    pub fn targets(&self, positions: &[Position], pins: &[Pinned], from: f64, to: f64) -> Vec<DVec3> {
        let ways: Vec<DVec3> = (0..=self.0.len() as u64).map(|pin| self.way(Pinned(pin), from, to)).collect();
        let way = |pin: &Pinned| ways.get(pin.0 as usize).copied().unwrap_or_default();
        positions.iter().zip(pins).map(|(x, pin)| x.0 + way(pin)).collect()
    }
}

/// How far the films and the wires that hold them are behind the clock, s: a wire that meets a film waits until the tracker has joined
/// the two. State of a run.
#[derive(Resource, Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct WireLag {
    /// Time that the wires are behind, s.
    pub behind: f64,
    /// Steps in a row in which they were.
    pub steps: u32,
}

impl WireLag {
    /// Times between which wires go in the piece of a step that begins `from` seconds after it and lasts `length`; the step begins at
    /// `time` and lasts `whole`. Seconds.
    #[must_use]
    pub fn window(&self, time: f64, whole: f64, from: f64, length: f64) -> (f64, f64) {
        let (start, pace) = (time - self.behind, self.pace(whole));
        (start + pace * from, start + pace * (from + length))
    }

    /// A film stopped the wires `done` seconds into a step of `whole`; `patience`: how many of these the tracker may take to join the two.
    ///
    /// # Errors
    /// [`WireStuck`] when that has happened more often in a row.
    pub fn stopped(&mut self, whole: f64, done: f64, patience: u32) -> Result<(), WireStuck> {
        self.steps += 1;
        self.behind += whole - done * self.pace(whole);
        if self.steps > patience { Err(WireStuck { left: self.behind }) } else { Ok(()) }
    }

    /// The wires went all their way in a step of `whole` seconds.
    pub fn went_on(&mut self, whole: f64) {
        let behind = self.behind - (self.pace(whole) - 1.0) * whole;
        *self = Self { behind: behind.max(0.0), steps: 0 };
    }

    /// How fast wires go in a step of `whole` seconds, in their own speeds: at most twice, to catch up with the clock.
    fn pace(&self, whole: f64) -> f64 {
        if whole > 0.0 { 1.0 + (self.behind / whole).min(1.0) } else { 1.0 }
    }
}

/// A wire meets a film and cannot go on without going through it.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[error(
    "a wire meets a film or another wire and cannot go on without going through it; it is {left:.3e} s behind: lead it another way, or join films sooner (`snap`)"
)]
pub struct WireStuck {
    /// Time that it is behind, s.
    pub left: f64,
}

/// Which wire holds each vertex in this step: the column, for functions that see the world as it is.
#[derive(Resource, Clone, Debug, Default)]
pub struct Pins(pub Vec<Pinned>);

/// Copies the column of pins.
pub fn note_pins(world: &mut World) {
    let pins = Pins(read_column::<MeshVertex, Pinned>(world));
    world.insert_resource(pins);
}

/// A wire as a scene writes it.
#[cfg(test)]
pub(super) fn read_path(text: &str) -> froth_components::authored::wire::WirePath {
    let newtypes = ron::extensions::Extensions::UNWRAP_VARIANT_NEWTYPES;
    ron::Options::default().with_default_extension(newtypes).from_str(text).expect("a wire")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn steady() -> Moves {
        ron::from_str("(velocity: (2, 0, 0))").unwrap()
    }

    #[test]
    fn held_vertices_go_along_with_what_holds_them() {
        let holders = Holders(vec![None, Some(steady())]);
        let positions = [Position(DVec3::ZERO); 3];
        let targets = holders.targets(&positions, &[Pinned(0), Pinned(1), Pinned(2)], 1.0, 1.5);
        assert_eq!(targets, [DVec3::ZERO, DVec3::ZERO, DVec3::X]);
        assert!(holders.move_at_all());
    }
}
