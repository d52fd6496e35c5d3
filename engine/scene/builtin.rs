//! The components a scene file can name: the one place where they are registered.

use froth_components::authored::Name;
use froth_components::authored::field::{AirDrag, Gravity, HeatSource, Hover, Sweep, Wind};
use froth_components::authored::film::Film;
use froth_components::authored::motion::{Drift, Spin, Swirl};
use froth_components::authored::perturbation::{Bumps, HarmonicMode};
use froth_components::authored::shape::{Disc, Ellipsoid, HalfSphere, Hexagon, Rectangle, Sphere};

use super::registry::AuthoredRegistry;

pub(super) fn register(registry: &mut AuthoredRegistry) {
    registry.register::<Name>("Name", "what messages and tables call the entity");

    registry.register::<Sphere>("Sphere", "shape: a closed sphere");
    registry.register::<Ellipsoid>("Ellipsoid", "shape: a closed ellipsoid along the axes");
    registry.register::<HalfSphere>("HalfSphere", "shape: half a sphere, its rim pinned to a plane");
    registry.register::<Disc>("Disc", "shape: a flat disc, its rim pinned");
    registry.register::<Rectangle>("Rectangle", "shape: a flat rectangle, its rim pinned");
    registry.register::<Hexagon>("Hexagon", "shape: a flat regular hexagon, its rim pinned");

    registry.register::<Film>("Film", "makes a shape a soap film: thickness, surfactant, warmth");
    registry.register::<Bumps>("Bumps", "displaces a film by noise along its normal");
    registry.register::<HarmonicMode>("HarmonicMode", "displaces a round film by one spherical harmonic");

    registry.register::<Drift>("Drift", "velocity of a film at the start");
    registry.register::<Spin>("Spin", "rigid rotation of the liquid within a film at the start");
    registry.register::<Swirl>("Swirl", "eddies of the liquid within a film at the start");

    registry.register::<Gravity>("Gravity", "field: gravity, may be keyframed");
    registry.register::<Wind>("Wind", "field: air that drags films along, may be keyframed");
    registry.register::<HeatSource>("HeatSource", "field: a warm place, above which films rise");
    registry.register::<Sweep>("Sweep", "field: a pulse of pressure that travels over the film");
    registry.register::<Hover>("Hover", "field: holds bubbles up against gravity");
    registry.register::<AirDrag>("AirDrag", "field: still air that brakes the flow along films");
}
