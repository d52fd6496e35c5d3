//! The films of a world as one [`Surface`]: the mesh with the positions of its rows.

use bevy_ecs::resource::Resource;
use bevy_ecs::world::World;
use froth_components::kind::MeshVertex;
use froth_components::motion::{Pinned, Position};
use froth_surface::{PerVertex, Policy, Region, Surface, SurfaceMesh, Tracker};
use serde::{Deserialize, Serialize};

use crate::rows::{fill_column, read_column};

/// Regions without a volume of their own: pockets of outside air that ghosts close. State of a run.
#[derive(Resource, Clone, Debug, Default, Serialize, Deserialize)]
#[serde(transparent)]
pub struct OpenRegions(pub Vec<Region>);

/// What the tracker remembers between steps. State of a run.
#[derive(Resource, Clone, Debug, Default, Serialize, Deserialize)]
#[serde(transparent)]
pub struct TrackerState(pub Tracker);

/// How the mesh is kept: what the scene asks for.
#[derive(Resource, Clone, Copy, Debug)]
pub struct MeshRules {
    /// Thresholds of the tracker.
    pub policy: Policy,
    /// Whether the mesh is kept at all; without, it is moved as it is.
    pub remesh: bool,
    /// Part of the way to the middle of its faces that a vertex slides along its film per step, 0 to 1.
    pub smoothing: f64,
}

/// The connectivity changed since the method last looked: incidence lists are to be rebuilt.
#[derive(Resource, Clone, Copy, Debug, PartialEq, Eq)]
pub struct TopologyChanged(pub bool);

impl TopologyChanged {
    /// Whether it changed; from then on the method has looked.
    pub fn taken(&mut self) -> bool {
        std::mem::take(&mut self.0)
    }
}

/// Takes the films out of the world as a surface; the resource is empty until [`put_back`].
pub fn take(world: &mut World) -> Surface {
    let positions = read_column::<MeshVertex, Position>(world);
    let pinned = read_column::<MeshVertex, Pinned>(world);
    let open = world.resource::<OpenRegions>().0.clone();
    let mesh = std::mem::take(&mut *world.resource_mut::<SurfaceMesh>());
    surface_of(mesh, &positions, &pinned, open)
}

/// A surface of columns.
#[must_use]
pub fn surface_of(mesh: SurfaceMesh, positions: &[Position], pinned: &[Pinned], open: Vec<Region>) -> Surface {
    Surface {
        mesh,
        positions: PerVertex(positions.iter().map(|x| x.0).collect()),
        pinned: PerVertex(pinned.iter().map(|wire| wire.0 > 0).collect()),
        open,
    }
}

/// Puts a surface of as many vertices as there are rows back into the world.
pub fn put_back(world: &mut World, surface: Surface) {
    let positions: Vec<Position> = surface.positions.iter().map(|x| Position(*x)).collect();
    fill_column::<MeshVertex, _>(world, &positions);
    world.resource_mut::<OpenRegions>().0 = surface.open;
    *world.resource_mut::<SurfaceMesh>() = surface.mesh;
}
