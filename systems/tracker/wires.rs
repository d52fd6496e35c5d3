//! Wires: which vertices they hold, and where those go.
//!
//! A held vertex carries the number of its wire in [`Pinned`]; 0 is free. What holds it moves each point by the same way
//! ([`Moves::way`]), so a step of a held vertex is the way of its wire in that step.

use bevy_ecs::resource::Resource;
use froth_components::authored::wire::Moves;
use froth_components::motion::{Pinned, Position};
use glam::DVec3;

/// What holds vertices, by number less one: wires and the rims of films, at rest (`None`) or moving. Constant in a run.
#[derive(Resource, Clone, Debug, Default)]
pub struct Holders(pub Vec<Option<Moves>>);

impl Holders {
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
