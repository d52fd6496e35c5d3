//! The components a scene file can name: the one place where they are registered.

use froth_components::authored::Name;
use froth_components::authored::burst::Burst;
use froth_components::authored::field::{AirDrag, Gravity, HeatSource, Hover, Sweep, Wind};
use froth_components::authored::film::Film;
use froth_components::authored::mesh_shape::{
    Catenoid, Cube, DoubleBubble, KelvinCells, Lattice, MeshFile, Packing, QuadrupleBubble, SphereLattice,
    TripleBubble, WireFrame,
};
use froth_components::authored::motion::{Drift, Spin, Swirl};
use froth_components::authored::perturbation::{Bumps, HarmonicMode, Stretch};
use froth_components::authored::shape::{Disc, Ellipsoid, HalfSphere, Hexagon, Rectangle, Sphere};
use froth_components::authored::tension::Tension;
use froth_components::authored::volumes::Volumes;
use froth_components::authored::wire::{Moves, Wire};

use super::registry::AuthoredRegistry;

pub(super) fn register(registry: &mut AuthoredRegistry) {
    registry.register::<Name>("Name", "what messages and tables call the entity");

    registry.register::<Sphere>("Sphere", "shape: a closed sphere");
    registry.register::<Ellipsoid>("Ellipsoid", "shape: a closed ellipsoid along the axes");
    registry.register::<HalfSphere>("HalfSphere", "shape: half a sphere, its rim pinned to a plane");
    registry.register::<Disc>("Disc", "shape: a flat disc, its rim pinned");
    registry.register::<Rectangle>("Rectangle", "shape: a flat rectangle, its rim pinned");
    registry.register::<Hexagon>("Hexagon", "shape: a flat regular hexagon, its rim pinned");

    registry.register::<Cube>("Cube", "shape: a closed cube");
    registry.register::<DoubleBubble>("DoubleBubble", "shape: two bubbles that share a wall");
    registry.register::<TripleBubble>("TripleBubble", "shape: three equal bubbles around a line");
    registry.register::<QuadrupleBubble>("QuadrupleBubble", "shape: four equal bubbles around a point");
    registry.register::<KelvinCells>("KelvinCells", "shape: a block of Kelvin's foam");
    registry.register::<Lattice>("Lattice", "shape: a block of cubes that share their walls");
    registry.register::<SphereLattice>("SphereLattice", "shape: spheres on a lattice, apart from each other");
    registry.register::<Packing>("Packing", "shape: a random foam");
    registry.register::<Catenoid>("Catenoid", "shape: a film between two rings, its rims pinned");
    registry.register::<WireFrame>("WireFrame", "shape: the films in a tetrahedron, cube or octahedron of wire");
    registry.register::<MeshFile>("MeshFile", "shape: a mesh from an OBJ or PLY file");

    registry.register::<Film>("Film", "makes a shape a soap film: thickness, surfactant, warmth");
    registry.register::<Bumps>("Bumps", "displaces a film by noise along its normal");
    registry.register::<Stretch>("Stretch", "stretches films on a mesh along x, y and z");
    registry.register::<HarmonicMode>("HarmonicMode", "displaces a round film by one spherical harmonic");

    registry.register::<Drift>("Drift", "velocity of a film at the start");
    registry.register::<Spin>("Spin", "rigid rotation of the liquid within a film at the start");
    registry.register::<Swirl>("Swirl", "eddies of the liquid within a film at the start");

    registry.register::<Tension>("Tension", "films of other soap than the scene's liquid");
    registry.register::<Volumes>("Volumes", "blows bubbles up to volumes of their own, or lets them shrink");
    registry.register::<Wire>("Wire", "a ring or line of wire that holds films");
    registry.register::<Moves>("Moves", "moves a wire, or the pinned rims of a film, may be keyframed");

    registry.register::<Gravity>("Gravity", "field: gravity, may be keyframed");
    registry.register::<Wind>("Wind", "field: air that drags films along, may be keyframed");
    registry.register::<HeatSource>("HeatSource", "field: a warm place, above which films rise");
    registry.register::<Sweep>("Sweep", "field: a pulse of pressure that travels over the film");
    registry.register::<Hover>("Hover", "field: holds bubbles up against gravity");
    registry.register::<AirDrag>("AirDrag", "field: still air that brakes the flow along films");
    registry.register::<Burst>("Burst", "field: bursts films, one at a time");
}
