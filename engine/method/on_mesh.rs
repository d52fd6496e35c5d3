//! What every method on a mesh has in common: columns, state, rules of the tracker, and films turned into one mesh.

use bevy_ecs::world::World;
use froth_components::authored::film::Film;
use froth_components::authored::film_shape::FilmShape;
use froth_components::authored::method::{Contact, Placement, Remesh};
use froth_components::authored::motion::Drift;
use froth_components::authored::perturbation::{Bumps, HarmonicMode, Stretch};
use froth_components::authored::tension::Tension;
use froth_components::authored::volumes::Volumes;
use froth_components::authored::wire::{Moves, Wire};
use froth_components::authored::{Name, PlaceInScene};
use froth_components::clock::Seed;
use froth_components::film::{Area, LiquidVolume, MeanCurvature, Thickness};
use froth_components::gas::{GasPressure, GasVolume, ReferencePressure, ReferenceVolume};
use froth_components::identity::{InRegion, StableId};
use froth_components::kind::{MeshVertex, Region};
use froth_components::motion::{ExternalAcceleration, ExternalPressure, Normal, Pinned, Position, Velocity};
use froth_surface::{PerVertex, Policy, Surface, SurfaceMesh};
use froth_systems::bubbles::gas::BubbleGas;
use froth_systems::plan::Requires;
use froth_systems::rows::registry::ColumnRegistry;
use froth_systems::rows::state::StateRegistry;
use froth_systems::rows::{fill_column, spawn_rows};
use froth_systems::sampling::random::{self, Use};
use froth_systems::sampling::surface::Perturbation;
use froth_systems::tracker::bursting::{self, BurstsDone, UnknownBubble};
use froth_systems::tracker::discretise::{AuthoredFilm, AuthoredWire, DiscreteFilms, FilmFault};
use froth_systems::tracker::events::{self, StepEvents};
use froth_systems::tracker::feeding::{Feeds, LiquidFed};
use froth_systems::tracker::films::{MeshRules, OpenRegions, TopologyChanged, TrackerState};
use froth_systems::tracker::remeshing::{GasChanges, LiquidLost, NextVertexId, StepCounts};
use froth_systems::tracker::tension::BubbleTensions;
use froth_systems::tracker::wires::{Holders, Pins, WireLag};
use glam::DVec3;

use super::DiscretiseError;
use crate::scene::{MeshFaultKind, SceneHeader};

/// Part of the way to the middle of its faces that a vertex slides per step.
const SMOOTHING: f64 = 0.2;

/// How large the films of a scene are, metres.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scale {
    /// Edge length that the scene's resolution asks for.
    pub(super) edge: f64,
    /// Size of the largest film.
    pub(super) size: f64,
}

/// The tracker keeps the mesh.
pub(super) fn requires_remeshing() -> Requires {
    Requires::that("a mesh that is kept (`remesh`)", |world| {
        world.get_resource::<MeshRules>().is_some_and(|rules| rules.remesh)
    })
}

/// There are films.
pub(super) fn requires_films() -> Requires {
    Requires::that("films that have not all burst", |world| world.resource::<SurfaceMesh>().vertex_rows() > 0)
}

/// Wires feed the films that they hold.
pub(super) fn requires_feeding() -> Requires {
    Requires::that("wires that feed their films", |world| !world.resource::<Feeds>().is_empty()).and(requires_films())
}

/// Counts and events are those of one step.
pub(super) fn forget_step(world: &mut World) {
    world.insert_resource(StepCounts::default());
    events::forget(world);
}

/// Registers the columns of vertices and regions, the state of films and gas, and what follows from the scene alone.
pub(super) fn register(world: &mut World, keep: &Remesh) -> Scale {
    type V = MeshVertex;
    ColumnRegistry::register::<V, StableId>(world);
    ColumnRegistry::register::<V, Position>(world);
    ColumnRegistry::register::<V, Velocity>(world);
    ColumnRegistry::register::<V, Pinned>(world);
    ColumnRegistry::register::<V, Normal>(world);
    ColumnRegistry::register::<V, Area>(world);
    ColumnRegistry::register::<V, MeanCurvature>(world);
    ColumnRegistry::register::<V, Thickness>(world);
    ColumnRegistry::register_conserved::<V, LiquidVolume>(world);
    ColumnRegistry::register::<V, ExternalAcceleration>(world);
    ColumnRegistry::register::<V, ExternalPressure>(world);
    ColumnRegistry::register::<Region, InRegion>(world);
    ColumnRegistry::register::<Region, GasVolume>(world);
    ColumnRegistry::register::<Region, ReferenceVolume>(world);
    ColumnRegistry::register::<Region, GasPressure>(world);
    ColumnRegistry::register::<Region, ReferencePressure>(world);
    StateRegistry::register::<SurfaceMesh>(world, "surface_mesh");
    StateRegistry::register::<OpenRegions>(world, "open_regions");
    StateRegistry::register::<TrackerState>(world, "tracker");
    StateRegistry::register::<NextVertexId>(world, "next_vertex_id");
    StateRegistry::register::<BubbleGas>(world, "bubble_gas");
    StateRegistry::register::<BubbleTensions>(world, "bubble_tensions");
    StateRegistry::register::<BurstsDone>(world, "bursts_done");
    StateRegistry::register::<WireLag>(world, "wire_lag");
    StateRegistry::register::<LiquidLost>(world, "liquid_lost");
    StateRegistry::register::<LiquidFed>(world, "liquid_fed");
    world.init_resource::<SurfaceMesh>();
    world.init_resource::<OpenRegions>();
    world.init_resource::<TrackerState>();
    world.init_resource::<NextVertexId>();
    world.init_resource::<BubbleGas>();
    world.init_resource::<BubbleTensions>();
    world.init_resource::<BurstsDone>();
    world.init_resource::<WireLag>();
    world.init_resource::<LiquidLost>();
    world.init_resource::<LiquidFed>();
    world.init_resource::<Pins>();
    world.init_resource::<StepCounts>();
    world.init_resource::<StepEvents>();
    world.init_resource::<GasChanges>();
    world.insert_resource(TopologyChanged(true));
    insert_rules(world, keep)
}

/// What the scene alone decides: thresholds of the tracker, and how wires and rims move.
fn insert_rules(world: &mut World, keep: &Remesh) -> Scale {
    let films = authored_films(world);
    let area: f64 = films.iter().map(|film| film.shape.area()).sum();
    let edge = world.resource::<SceneHeader>().resolution.edge(area);
    let size = films.iter().map(|film| film.shape.size()).fold(0.0, f64::max);
    let policy = Policy {
        shortest: keep.shortest.si(),
        longest: keep.longest.si(),
        snap: keep.snap.si(),
        contact: match keep.contact {
            Contact::Merge => froth_surface::Contact::Merge,
            Contact::Bounce => froth_surface::Contact::Bounce,
        },
        flips: keep.flips,
        separation: keep.topology,
        placement: match keep.placement {
            Placement::Midpoint => froth_surface::Placement::Midpoint,
            Placement::Butterfly => froth_surface::Placement::Butterfly,
        },
        ..Policy::new(edge)
    };
    let smoothing = if keep.smoothing { SMOOTHING } else { 0.0 };
    world.insert_resource(MeshRules { policy, remesh: keep.enabled, smoothing });
    let wires = authored_wires(world);
    world.insert_resource(Holders::of(&films, &wires));
    world.insert_resource(Feeds::of(&films, &wires));
    Scale { edge, size }
}

/// Turns the authored films into one mesh.
///
/// # Errors
/// A [`FilmFault`]; bursts of bubbles that are not there.
pub(super) fn discretise(world: &mut World) -> Result<(), DiscretiseError> {
    let (films, wires) = (authored_films(world), authored_wires(world));
    let edge = world.resource::<MeshRules>().policy.edge;
    let discrete = DiscreteFilms::sample(&films, &wires, edge).map_err(|fault| in_scene(&fault))?;
    bursting::check_bursts(world, &discrete.surface).map_err(|unknown| burst_in_scene(&unknown))?;
    let areas = vertex_areas(&discrete.surface);
    let count = discrete.surface.positions.len();
    spawn_rows::<MeshVertex>(world, count);
    fill_column::<MeshVertex, _>(world, &(0..count as u64).map(StableId).collect::<Vec<_>>());
    world.insert_resource(NextVertexId(count as u64));
    let liquid: Vec<LiquidVolume> =
        areas.iter().zip(&discrete.thickness).map(|(area, eta)| LiquidVolume(area * eta)).collect();
    fill_column::<MeshVertex, _>(world, &liquid);
    fill_column::<MeshVertex, _>(world, &discrete.velocities.iter().map(|u| Velocity(*u)).collect::<Vec<_>>());
    fill_column::<MeshVertex, _>(world, &discrete.pins.iter().map(|pin| Pinned(*pin)).collect::<Vec<_>>());
    fill_column::<MeshVertex, _>(world, &discrete.surface.positions.iter().map(|x| Position(*x)).collect::<Vec<_>>());
    let ramps = discrete.ramps.into_iter().collect();
    world.insert_resource(BubbleGas { ramps, ..BubbleGas::of(&discrete.surface) });
    world.insert_resource(BubbleTensions(discrete.tensions.into_iter().collect()));
    world.insert_resource(OpenRegions(discrete.surface.open));
    world.insert_resource(discrete.surface.mesh);
    Ok(())
}

/// A fault of the films as one that the scene can point at.
fn in_scene(fault: &FilmFault) -> crate::scene::MeshFault {
    use froth_surface::fault::MeshFault as Mesh;
    let kind = match fault {
        FilmFault::File { .. } => MeshFaultKind::NotAMesh,
        FilmFault::Mesh { fault: Mesh::SelfIntersection { .. }, .. } | FilmFault::Crossing { .. } => {
            MeshFaultKind::Crossing
        }
        FilmFault::Mesh { fault: Mesh::PiercedFilm { .. }, .. } | FilmFault::WirePierces { .. } => {
            MeshFaultKind::WirePierces
        }
        FilmFault::Mesh {
            fault:
                Mesh::OpenEdge { .. } | Mesh::InconsistentLabels { .. } | Mesh::NoVolume { .. } | Mesh::SameLabels { .. },
            ..
        } => MeshFaultKind::Labels,
        FilmFault::VolumeCount { .. } => MeshFaultKind::Volumes,
        FilmFault::NoFilmOnWire { .. } => MeshFaultKind::WireFar,
        _ => MeshFaultKind::Faces,
    };
    crate::scene::MeshFault { entity: PlaceInScene(fault.place()), kind, message: fault.to_string() }
}

fn burst_in_scene(unknown: &UnknownBubble) -> crate::scene::MeshFault {
    crate::scene::MeshFault { entity: unknown.place, kind: MeshFaultKind::Burst, message: unknown.to_string() }
}

/// A third of the film area around every vertex, m^2.
fn vertex_areas(surface: &Surface) -> Vec<f64> {
    let mut areas = PerVertex(vec![0.0; surface.positions.len()]);
    for (row, face) in surface.mesh.faces().filter(|(_, face)| !face.is_ghost()) {
        face.vertices().into_iter().for_each(|v| areas[v] += surface.area(row) / 3.0);
    }
    areas.0
}

/// The authored films in the order of the scene file.
fn authored_films(world: &mut World) -> Vec<AuthoredFilm> {
    let seed = world.get_resource::<Seed>().copied().unwrap_or_default().0;
    let mut films = Vec::new();
    for entity in world.iter_entities() {
        let part = |place: &PlaceInScene, film: &Film, shape: FilmShape| {
            let own_seed = random::bits(seed, u64::from(place.0), 0, Use::NoiseSeed) as u32;
            let bumps = entity.get::<Bumps>().map(|b| (*b, b.seed.map_or(own_seed.wrapping_add(1), |s| s as u32)));
            AuthoredFilm {
                place: place.0,
                name: entity.get::<Name>().map(|name| name.0.clone()),
                shape,
                film: *film,
                stretch: entity.get::<Stretch>().map_or(DVec3::ONE, |stretch| stretch.si()),
                perturbation: Perturbation { bumps, mode: entity.get::<HarmonicMode>().copied() },
                seed: own_seed,
                moves: entity.get::<Moves>().cloned(),
                drift: entity.get::<Drift>().map_or(DVec3::ZERO, |drift| drift.0.si()),
                volumes: entity.get::<Volumes>().cloned(),
                tension: entity.get::<Tension>().copied(),
            }
        };
        if let (Some(place), Some(film)) = (entity.get::<PlaceInScene>(), entity.get::<Film>()) {
            films.extend(FilmShape::of(&entity).map(|shape| part(place, film, shape)));
        }
    }
    films.sort_by_key(|film| film.place);
    films
}

/// The authored wires in the order of the scene file.
fn authored_wires(world: &mut World) -> Vec<AuthoredWire> {
    let mut query = world.query::<(&PlaceInScene, &Wire, Option<&Moves>)>();
    let wire = |(place, wire, moves): (&PlaceInScene, &Wire, Option<&Moves>)| AuthoredWire {
        place: place.0,
        wire: wire.clone(),
        moves: moves.cloned(),
    };
    let mut wires: Vec<AuthoredWire> = query.iter(world).map(wire).collect();
    wires.sort_by_key(|wire| wire.place);
    wires
}
