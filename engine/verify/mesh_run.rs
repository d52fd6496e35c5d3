//! Runs a built-in scene of films on a mesh for a law, and watches what every step does.

use froth_components::kind::MeshVertex;
use froth_components::motion::{Pinned, Position};
use froth_surface::invariants::{Violation, check_all};
use froth_surface::links::free_clusters;
use froth_surface::{EventKind, Face, Region, Surface, SurfaceMesh};
use froth_systems::tracker::events::{StepEvents, TopologyEvent};
use froth_systems::tracker::films::{OpenRegions, surface_of};

use super::LawError;
use super::finding::Finding;
use super::scene_run::SceneRun;
use crate::simulation::Simulation;

/// A run of a scene, with what the law needs to know of all its steps.
pub(super) struct MeshRun {
    /// The run.
    pub(super) simulation: Simulation,
    /// Changes of topology so far.
    pub(super) events: Vec<TopologyEvent>,
    /// Largest relative difference of a bubble's volume from what it shall be, at the end of any step.
    pub(super) volume_error: f64,
    /// Steps so far.
    pub(super) steps: u64,
    /// Splits, collapses and flips so far.
    pub(super) operations: f64,
}

impl MeshRun {
    /// Makes the films.
    pub(super) fn begin(scene: &SceneRun) -> Result<Self, LawError> {
        let simulation = scene.begin()?;
        Ok(Self { simulation, events: Vec::new(), volume_error: 0.0, steps: 0, operations: 0.0 })
    }

    /// The films of a scene at a time, s.
    pub(super) fn at(scene: &SceneRun, time: f64) -> Result<Self, LawError> {
        let mut run = Self::begin(scene)?;
        run.advance_to(time)?;
        Ok(run)
    }

    /// Steps until `time`, s.
    pub(super) fn advance_to(&mut self, time: f64) -> Result<(), LawError> {
        while !self.simulation.has_reached(time) {
            self.step_within(time)?;
        }
        Ok(())
    }

    /// One step that does not pass `limit`, s.
    pub(super) fn step_within(&mut self, limit: f64) -> Result<(), LawError> {
        self.simulation.step_within(limit)?;
        self.steps += 1;
        self.volume_error = self.volume_error.max(self.observed("volume_error"));
        self.operations += ["splits", "collapses", "flips"].map(|name| self.observed(name)).iter().sum::<f64>();
        self.events.extend_from_slice(&self.simulation.world().resource::<StepEvents>().0);
        Ok(())
    }

    /// What the last step measured; not a number where it measured no such thing.
    pub(super) fn observed(&self, name: &str) -> f64 {
        self.simulation.observables().get(name).unwrap_or(f64::NAN)
    }

    /// Number of events of a kind so far.
    pub(super) fn count(&self, kind: EventKind) -> usize {
        self.events.iter().filter(|event| event.kind == kind).count()
    }

    /// The films as they are.
    pub(super) fn surface(&mut self) -> Surface {
        let positions = self.simulation.column::<MeshVertex, Position>();
        let pinned = self.simulation.column::<MeshVertex, Pinned>();
        let world = self.simulation.world();
        surface_of(
            world.resource::<SurfaceMesh>().clone(),
            &positions,
            &pinned,
            world.resource::<OpenRegions>().0.clone(),
        )
    }

    /// Volumes of regions 1, 2, ... `N`, m^3.
    pub(super) fn volumes<const N: usize>(&mut self) -> [f64; N] {
        let volumes = self.surface().volumes();
        std::array::from_fn(|k| volumes.get(k + 1).copied().unwrap_or(f64::NAN))
    }

    /// Area of the films, m^2.
    pub(super) fn area(&mut self) -> f64 {
        self.surface().film_area()
    }

    /// Area of the film between two regions, m^2.
    pub(super) fn area_between(&mut self, one: Region, other: Region) -> f64 {
        let surface = self.surface();
        let parts = |face: &Face| !face.is_ghost() && face.borders(one) && face.borders(other);
        surface.mesh.faces().filter(|(_, face)| parts(face)).map(|(row, _)| surface.area(row)).sum()
    }

    /// Number of films, or clusters of films, that are apart from each other.
    pub(super) fn films(&mut self) -> usize {
        let surface = self.surface();
        let films = surface.mesh.faces().map(|(_, face)| face).filter(|face| !face.is_ghost());
        let corners: Vec<[u32; 3]> = films.map(|face| face.vertices().map(|v| v.0)).collect();
        free_clusters(surface.positions.len(), corners.into_iter(), |_| false).count
    }

    /// The first invariant of the tracker that does not hold.
    pub(super) fn violation(&mut self) -> Option<Violation> {
        check_all(&self.surface()).err()
    }
}

/// That no invariant was found broken; it tells the first that was.
pub(super) fn unbroken(found: impl IntoIterator<Item = Option<Violation>>) -> Finding {
    let broken: Vec<Violation> = found.into_iter().flatten().collect();
    let first = broken.first().map(|violation| format!(": {violation}")).unwrap_or_default();
    Finding::vanishing(format!("broken invariants{first}"), broken.len() as f64, 0.0)
}
