//! Tension of the films: that of the scene's liquid, or of the bubbles on their two sides.

use std::collections::BTreeMap;

use bevy_ecs::resource::Resource;
use bevy_ecs::world::World;
use froth_components::material::Liquid;
use froth_surface::calculus::Weights;
use froth_surface::{Face, Region, SurfaceMesh, VertexRow};
use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::remeshing::{GasChange, GasChanges};

/// Tension `σ` of an interface of the bubbles that have one of their own, N/m. State of a run.
#[derive(Resource, Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct BubbleTensions(pub BTreeMap<Region, f64>);

impl BubbleTensions {
    /// Follows bubbles that were joined or have divided.
    pub fn follow(&mut self, changes: &GasChanges) {
        for change in &changes.0 {
            match change {
                GasChange::Joined(gone, _) => drop(self.0.remove(gone)),
                GasChange::Divided(division) => {
                    if let Some(tension) = self.0.get(&division.from).copied() {
                        self.0.insert(division.to, tension);
                    }
                }
            }
        }
    }

    /// Of an interface of the film between two regions, N/m; `usual` where neither has its own.
    #[must_use]
    pub fn between(&self, [i, j]: [Region; 2], usual: f64) -> f64 {
        match (self.0.get(&i), self.0.get(&j)) {
            (Some(a), Some(b)) => 0.5 * (a + b),
            (Some(own), None) | (None, Some(own)) => *own,
            (None, None) => usual,
        }
    }

    /// The largest that a film can have, N/m.
    #[must_use]
    pub fn largest(&self, usual: f64) -> f64 {
        self.0.values().copied().fold(usual, f64::max)
    }
}

/// Energy of the films, `sum 2 sigma A`, J, with vertices at `place` (metres) and the tension `usual` (N/m) where bubbles have none of their own.
#[must_use]
pub fn film_energy(
    mesh: &SurfaceMesh,
    tensions: &BubbleTensions,
    usual: f64,
    place: impl Fn(VertexRow) -> DVec3,
) -> f64 {
    let films = mesh.faces().filter(|(_, face)| !face.is_ghost());
    let energy = |face: &Face| {
        let [a, b, c] = face.vertices().map(&place);
        tensions.between(face.labels(), usual) * (b - a).cross(c - a).length()
    };
    films.map(|(_, face)| energy(face)).sum()
}

/// Tension `2 σ` of every film, N/m.
#[derive(Clone, Debug, PartialEq)]
pub struct FilmTensions {
    usual: f64,
    /// Per face row; empty where all are alike.
    list: Vec<f64>,
}

impl FilmTensions {
    /// Of the films of a mesh.
    #[must_use]
    pub fn of(world: &World, mesh: &SurfaceMesh) -> Self {
        let (usual, own) = (world.resource::<Liquid>().surface_tension, world.resource::<BubbleTensions>());
        let mut tensions = Self { usual: 2.0 * usual, list: Vec::new() };
        if !own.0.is_empty() {
            tensions.list = vec![2.0 * usual; mesh.face_rows()];
            mesh.faces().for_each(|(row, face)| tensions.list[row.index()] = 2.0 * own.between(face.labels(), usual));
        }
        tensions
    }

    /// As the calculus of films takes them.
    #[must_use]
    pub fn weights(&self) -> Weights<'_> {
        if self.list.is_empty() { Weights::Uniform(self.usual) } else { Weights::PerFace(&self.list) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use froth_surface::bodies::Division;

    #[test]
    fn a_film_has_the_mean_of_its_bubbles_and_the_outside_has_no_say() {
        let tensions = BubbleTensions([(Region(1), 0.02), (Region(2), 0.04)].into());
        let between = |i: u32, j: u32| tensions.between([Region(i), Region(j)], 0.03);
        assert_eq!([between(0, 1), between(2, 0), between(2, 1), between(0, 3)], [0.02, 0.04, 0.03, 0.03]);
        assert_eq!((tensions.largest(0.03), tensions.largest(0.1)), (0.04, 0.1));
    }

    #[test]
    fn parts_of_a_bubble_have_its_tension_and_one_that_is_gone_has_none() {
        let mut tensions = BubbleTensions([(Region(1), 0.02), (Region(2), 0.04)].into());
        let division = Division { from: Region(1), to: Region(5), volume: 1.0, rest: 2.0, place: DVec3::ZERO };
        tensions.follow(&GasChanges(vec![GasChange::Divided(division), GasChange::Joined(Region(2), Region(1))]));
        assert_eq!(tensions.0, [(Region(1), 0.02), (Region(5), 0.02)].into());
    }
}
