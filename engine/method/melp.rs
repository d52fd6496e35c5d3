//! Moving Eulerian-Lagrangian particles (Deng et al. 2022): the method as a table of contents.

use bevy_ecs::world::World;
use froth_components::authored::PlaceInScene;
use froth_components::authored::field::{AirDrag, Gravity, HeatSource, Hover, Sweep, Wind};
use froth_components::authored::film::Film;
use froth_components::authored::method::{AirInertia, Gas, MelpSettings, MethodChoice};
use froth_components::authored::motion::{Drift, Spin, Swirl};
use froth_components::authored::perturbation::{Bumps, HarmonicMode};
use froth_components::authored::shape::{Disc, Ellipsoid, HalfSphere, Hexagon, Rectangle, Shape, Sphere};
use froth_components::clock::Seed;
use froth_components::column::Column;
use froth_components::film::{
    Area, LiquidVolume, MeanCurvature, ShapeOperator, SurfaceTension, Surfactant, SurfactantAmount, Thickness, Warmth,
};
use froth_components::gas::{GasExponent, GasPressure, GasVolume, ReferencePressure, ReferenceVolume};
use froth_components::identity::{InRegion, RegionId, StableId};
use froth_components::kind::{BoundaryParticle, EulerianParticle, Kind, LagrangianParticle, Region};
use froth_components::lamella::{Lamella, Lamellae, Rim};
use froth_components::material::{Atmosphere, Liquid};
use froth_components::motion::{
    ExternalAcceleration, ExternalPressure, Normal, NormalSpeed, Position, Velocity, VelocityGradient,
};
use froth_systems::forces;
use froth_systems::melp::contact::{self, Contacts};
use froth_systems::melp::discretise::{AuthoredFilm, DiscreteFilm, Sampling};
use froth_systems::melp::frames::{self, FilmFrames};
use froth_systems::melp::normal_motion::NormalMotion;
use froth_systems::melp::settings::Melp;
use froth_systems::melp::state::{FilmStencil, Solvers, TangentialFlow, Transfers};
use froth_systems::melp::{carriers, gather, inertia, links, marangoni, material, measure, normal_motion, observe};
use froth_systems::melp::{scatter, sorting, step_length};
use froth_systems::plan::{Requires, SchedulePlan};
use froth_systems::rows::registry::ColumnRegistry;
use froth_systems::rows::state::StateRegistry;
use froth_systems::rows::{fill_column, spawn_rows};
use froth_systems::sampling::random::{self, Use};
use froth_systems::sampling::surface::Perturbation;
use froth_systems::stage::Stage;

use super::{DiscretiseError, Method};
use crate::scene::SceneHeader;

/// Moving Eulerian-Lagrangian particles.
pub const METHOD: Method = Method {
    name: "melp",
    summary: "moving Eulerian-Lagrangian particles (Deng et al. 2022)",
    register,
    discretise,
    assemble,
};

/// Adds one step of MELP to a plan. The step length itself is chosen after the stage's limits, for every method alike.
pub fn assemble(plan: &mut SchedulePlan) {
    let always = Requires::nothing;
    let liquid = Requires::kind::<LagrangianParticle>;
    let several = || Requires::that("several films", has_several_films);
    let elastic = || liquid().and(Requires::that("surfactant elasticity above 0", is_elastic));
    plan.add(Stage::Clock, "follow free films", frames::follow_films, always());
    plan.add(Stage::Clock, "limit the step by speed (CFL)", step_length::limit_step_by_speed, always());
    plan.add(Stage::Clock, "limit substeps by tension", normal_motion::limit_step_by_tension, always());
    plan.add(Stage::Clock, "limit substeps by the approach of films", contact::limit_step_by_approach, several());
    plan.add(Stage::Gather, "build the stencil", links::build_stencil, always());
    plan.add(Stage::Gather, "enter the films' frames", frames::enter_frames, liquid());
    plan.add(Stage::Gather, "link the particle sets and gather liquid (L2E)", gather::gather_liquid, liquid());
    plan.add(Stage::Gather, "measure concentration", measure::measure_concentration, liquid());
    plan.add(Stage::Geometry, "measure areas and curvature", measure::measure_geometry, always());
    plan.add(Stage::Geometry, "find where films touch", contact::find_contacts, always());
    plan.add(Stage::Geometry, "measure thickness", measure::measure_thickness, liquid());
    plan.add(Stage::Geometry, "measure gas pressure", measure::measure_pressure, always());
    plan.add(Stage::Forces, "clear external forces", forces::clear::<EulerianParticle>, always());
    plan.add(Stage::Forces, "gravity", forces::pull_by_gravity, Requires::component::<Gravity>("gravity"));
    plan.add(Stage::Forces, "hold closed films up", forces::hold_up, Requires::component::<Hover>("hover"));
    plan.add(Stage::Forces, "wind", forces::drag_by_wind, Requires::component::<Wind>("a wind"));
    plan.add(Stage::Forces, "air drag", forces::brake_in_air, Requires::component::<AirDrag>("air drag"));
    plan.add(Stage::Forces, "sweep", forces::sweep, Requires::component::<Sweep>("a sweep"));
    plan.add(Stage::Dynamics, "advance normal motion", normal_motion::advance_normal_motion, always());
    plan.add(Stage::Dynamics, "accelerate the liquid", inertia::accelerate_liquid, liquid());
    plan.add(Stage::Dynamics, "solve for concentration and flow (Marangoni)", marangoni::solve_marangoni, elastic());
    plan.add(Stage::Velocity, "write velocities", inertia::write_velocity, always());
    plan.add(Stage::Deform, "move carriers with the film", carriers::deform_film, always());
    plan.add(Stage::Scatter, "scatter the flow (E2L)", scatter::scatter_flow, liquid());
    let heated = liquid().and(Requires::component::<HeatSource>("a heat source"));
    plan.add(Stage::Advance, "warm the liquid", forces::heat::warm_liquid, heated);
    plan.add(Stage::Advance, "redistribute carriers", carriers::redistribute_carriers, always());
    plan.add(Stage::Advance, "move liquid and project it", material::advance_material, liquid());
    plan.add(Stage::Advance, "leave the films' frames", frames::leave_frames, liquid());
    plan.add(Stage::Topology, "sort the liquid's rows", sorting::sort_material, liquid());
    plan.add(Stage::Observe, "measure films", observe::observe_films, always());
    plan.add(Stage::Observe, "measure the liquid", observe::observe_liquid, liquid());
}

fn has_several_films(world: &World) -> bool {
    world.get_resource::<Lamellae>().is_some_and(|lamellae| lamellae.films.len() > 1)
}

fn is_elastic(world: &World) -> bool {
    world.get_resource::<Liquid>().is_some_and(|liquid| liquid.elasticity > 0.0)
}

/// Registers the columns that MELP's particles carry and the state of the films, and inserts the settings.
pub fn register(world: &mut World) {
    fn both<C: Column + Default>(world: &mut World) {
        ColumnRegistry::register::<EulerianParticle, C>(world);
        ColumnRegistry::register::<LagrangianParticle, C>(world);
    }
    both::<StableId>(world);
    both::<InRegion>(world);
    both::<Position>(world);
    both::<Normal>(world);
    both::<Velocity>(world);
    both::<LiquidVolume>(world);
    both::<SurfactantAmount>(world);
    both::<Thickness>(world);
    both::<Warmth>(world);
    carrier::<NormalSpeed>(world);
    carrier::<Area>(world);
    carrier::<Surfactant>(world);
    carrier::<SurfaceTension>(world);
    carrier::<MeanCurvature>(world);
    carrier::<ShapeOperator>(world);
    carrier::<ExternalAcceleration>(world);
    carrier::<ExternalPressure>(world);
    ColumnRegistry::register::<LagrangianParticle, VelocityGradient>(world);
    ColumnRegistry::register::<BoundaryParticle, Position>(world);
    ColumnRegistry::register::<BoundaryParticle, InRegion>(world);
    ColumnRegistry::register::<Region, InRegion>(world);
    ColumnRegistry::register::<Region, GasVolume>(world);
    ColumnRegistry::register::<Region, GasPressure>(world);
    ColumnRegistry::register::<Region, ReferenceVolume>(world);
    ColumnRegistry::register::<Region, ReferencePressure>(world);
    ColumnRegistry::register::<Region, GasExponent>(world);
    StateRegistry::register::<Lamellae>(world, "lamellae");
    world.insert_resource(Melp::new(&settings(world)));
    world.init_resource::<FilmStencil>();
    world.init_resource::<FilmFrames>();
    world.init_resource::<Transfers>();
    world.init_resource::<TangentialFlow>();
    world.init_resource::<Contacts>();
    world.init_resource::<NormalMotion>();
    world.init_resource::<Solvers>();
}

fn carrier<C: Column + Default>(world: &mut World) {
    ColumnRegistry::register::<EulerianParticle, C>(world);
}

/// The scene's settings of MELP; the defaults where the scene is written for another method.
fn settings(world: &World) -> MelpSettings {
    match world.resource::<SceneHeader>().method {
        MethodChoice::Melp(settings) => settings,
        _ => MelpSettings::default(),
    }
}

/// Turns the authored films of the world into particles.
///
/// # Errors
/// [`NotConverged`](froth_systems::operators::conjugate_gradient::NotConverged) if the carriers of a film could not be spread evenly.
pub fn discretise(world: &mut World) -> Result<(), DiscretiseError> {
    let (settings, resolution) = (&settings(world), world.resource::<SceneHeader>().resolution);
    let liquid = *world.resource::<Liquid>();
    let atmosphere = *world.resource::<Atmosphere>();
    let authored = authored_films(world);
    let area: f64 = authored.iter().map(|film| film.shape.area()).sum();
    let sampling = Sampling {
        spacing: resolution.spacing(area),
        liquid_per_carrier: settings.liquid_per_carrier as usize,
        reference_surfactant: liquid.reference_surfactant(),
    };
    let mut films = Vec::with_capacity(authored.len());
    for (film, region) in authored.iter().zip(1..) {
        films.push(DiscreteFilm::sample(film, RegionId(region), sampling)?);
    }
    spawn_all(world, &films);
    world.insert_resource(lamellae(&films, settings, atmosphere, sampling.spacing));
    fill_gas(world, &films, settings, liquid, atmosphere);
    fill_particles(world, &authored, &films, liquid);
    sorting::sort_rows::<EulerianParticle>(world);
    sorting::sort_rows::<LagrangianParticle>(world);
    Ok(())
}

/// The authored films in the order of the scene file.
fn authored_films(world: &mut World) -> Vec<AuthoredFilm> {
    let seed = world.get_resource::<Seed>().copied().unwrap_or_default().0;
    let mut films = world.query::<(
        &PlaceInScene,
        &Film,
        (Option<&Sphere>, Option<&Ellipsoid>, Option<&HalfSphere>),
        (Option<&Disc>, Option<&Rectangle>, Option<&Hexagon>),
        (Option<&Bumps>, Option<&HarmonicMode>),
        (Option<&Drift>, Option<&Spin>, Option<&Swirl>),
    )>();
    let mut found: Vec<(u32, AuthoredFilm)> = films
        .iter(world)
        .filter_map(|(place, film, (sphere, ellipsoid, half), (disc, rectangle, hexagon), (bumps, mode), motion)| {
            let curved = sphere.map(|s| Shape::Sphere(*s)).or(ellipsoid.map(|s| Shape::Ellipsoid(*s)));
            let curved = curved.or(half.map(|s| Shape::HalfSphere(*s)));
            let flat = disc.map(|s| Shape::Disc(*s)).or(rectangle.map(|s| Shape::Rectangle(*s)));
            let shape = curved.or(flat).or(hexagon.map(|s| Shape::Hexagon(*s)))?;
            let own_seed = random::bits(seed, u64::from(place.0), 0, Use::NoiseSeed) as u32;
            let bumps = bumps.map(|b| (*b, b.seed.map_or(own_seed.wrapping_add(1), |s| s as u32)));
            let perturbation = Perturbation { bumps, mode: mode.copied() };
            let (drift, spin, swirl): (Option<&Drift>, Option<&Spin>, Option<&Swirl>) = motion;
            let (drift, spin, swirl) = (drift.copied(), spin.copied(), swirl.copied());
            Some((place.0, AuthoredFilm { shape, film: *film, perturbation, seed: own_seed, drift, spin, swirl }))
        })
        .collect();
    found.sort_by_key(|(place, _)| *place);
    found.into_iter().map(|(_, film)| film).collect()
}

fn spawn_all(world: &mut World, films: &[DiscreteFilm]) {
    let total = |count: fn(&DiscreteFilm) -> usize| films.iter().map(count).sum::<usize>();
    spawn_rows::<EulerianParticle>(world, total(|film| film.positions.len()));
    spawn_rows::<LagrangianParticle>(world, total(|film| film.liquid_positions.len()));
    spawn_rows::<BoundaryParticle>(world, total(|film| film.wall.len()));
    spawn_rows::<Region>(world, films.len());
}

fn lamellae(films: &[DiscreteFilm], settings: &MelpSettings, air: Atmosphere, spacing: f64) -> Lamellae {
    let (mut carriers, mut material) = (0, 0);
    let films = films.iter().zip(1..).map(|(film, region)| {
        let next = (carriers + film.positions.len(), material + film.liquid_positions.len());
        let lamella = Lamella {
            region: RegionId(region),
            carriers: carriers..next.0,
            material: material..next.1,
            rim: film.rim,
            size: film.size,
            centre: film.centre,
            air_mass: air_mass(settings.air, air, film.size),
        };
        (carriers, material) = next;
        lamella
    });
    Lamellae { films: films.collect(), spacing }
}

/// Air that moves with the film, kg/m^2.
fn air_mass(inertia: AirInertia, air: Atmosphere, size: f64) -> f64 {
    match inertia {
        AirInertia::None => 0.0,
        AirInertia::Local => 0.4 * air.density * size,
        AirInertia::Fixed(mass) => mass.si(),
    }
}

/// Gives every closed region its gas, at the pressure that holds the film's tension at rest.
fn fill_gas(world: &mut World, films: &[DiscreteFilm], settings: &MelpSettings, liquid: Liquid, air: Atmosphere) {
    let exponent = match settings.gas {
        Gas::Isothermal => 1.0,
        Gas::Adiabatic(ratio) => ratio.si(),
    };
    let volume = |film: &DiscreteFilm| if Rim::leaves_gas_enclosed(film.rim) { film.volume } else { 0.0 };
    let pressure = |film: &DiscreteFilm| {
        let excess = liquid.surface_tension * film.twice_curvature;
        air.pressure + if Rim::leaves_gas_enclosed(film.rim) { excess } else { 0.0 }
    };
    let regions = concat(films, |region, _| vec![InRegion(region)]);
    fill_column::<Region, _>(world, &regions);
    let gather = |f: &dyn Fn(&DiscreteFilm) -> f64| films.iter().map(f).collect::<Vec<f64>>();
    let (volumes, pressures) = (gather(&volume), gather(&pressure));
    fill_column::<Region, _>(world, &volumes.iter().map(|v| GasVolume(*v)).collect::<Vec<_>>());
    fill_column::<Region, _>(world, &volumes.iter().map(|v| ReferenceVolume(*v)).collect::<Vec<_>>());
    fill_column::<Region, _>(world, &pressures.iter().map(|p| GasPressure(*p)).collect::<Vec<_>>());
    fill_column::<Region, _>(world, &pressures.iter().map(|p| ReferencePressure(*p)).collect::<Vec<_>>());
    fill_column::<Region, _>(world, &vec![GasExponent(exponent); films.len()]);
}

/// One column over all films, film after film.
fn concat<C>(films: &[DiscreteFilm], column: impl Fn(RegionId, &DiscreteFilm) -> Vec<C>) -> Vec<C> {
    films.iter().zip(1..).flat_map(|(film, region)| column(RegionId(region), film)).collect()
}

fn fill_particles(world: &mut World, authored: &[AuthoredFilm], films: &[DiscreteFilm], liquid: Liquid) {
    fill_carriers(world, films, liquid);
    let wall = concat(films, |_, film| film.wall.clone());
    fill_column::<BoundaryParticle, _>(world, &wall);
    let wall_regions = concat(films, |region, film| vec![InRegion(region); film.wall.len()]);
    fill_column::<BoundaryParticle, _>(world, &wall_regions);
    fill_liquid(world, authored, films);
}

fn fill_carriers(world: &mut World, films: &[DiscreteFilm], liquid: Liquid) {
    type E = EulerianParticle;
    fill_column::<E, _>(world, &concat(films, |_, film| film.positions.clone()));
    fill_column::<E, _>(world, &concat(films, |_, film| film.normals.clone()));
    fill_column::<E, _>(world, &concat(films, |_, film| film.shapes.clone()));
    fill_column::<E, _>(world, &concat(films, |_, film| film.speeds.iter().map(|s| NormalSpeed(*s)).collect()));
    let spacing = world.resource::<Lamellae>().spacing;
    fill_column::<E, _>(world, &concat(films, |_, film| vec![Area(spacing * spacing); film.positions.len()]));
    let concentration = concat(films, |_, film| film.concentration.clone());
    let tension = |gamma: &f64| SurfaceTension(liquid.tension_at(*gamma));
    fill_column::<E, _>(world, &concentration.iter().map(tension).collect::<Vec<_>>());
    fill_column::<E, _>(world, &concentration.iter().map(|gamma| Surfactant(*gamma)).collect::<Vec<_>>());
    fill_column::<E, _>(
        world,
        &concat(films, |_, film| film.carrier_thickness.iter().map(|e| Thickness(*e)).collect()),
    );
    fill_column::<E, _>(world, &concat(films, |region, film| vec![InRegion(region); film.positions.len()]));
    fill_ids::<E>(world);
}

fn fill_liquid(world: &mut World, authored: &[AuthoredFilm], films: &[DiscreteFilm]) {
    type L = LagrangianParticle;
    if films.iter().all(|film| film.liquid_positions.is_empty()) {
        return;
    }
    fill_column::<L, _>(world, &concat(films, |_, film| film.liquid_positions.clone()));
    fill_column::<L, _>(world, &concat(films, |_, film| film.liquid_normals.clone()));
    fill_column::<L, _>(world, &concat(films, |_, film| film.liquid_velocities.clone()));
    fill_column::<L, _>(world, &concat(films, |_, film| film.volumes.clone()));
    fill_column::<L, _>(world, &concat(films, |_, film| film.amounts.clone()));
    fill_column::<L, _>(world, &concat(films, |_, film| film.thickness.iter().map(|e| Thickness(*e)).collect()));
    fill_column::<L, _>(world, &concat(films, |region, film| vec![InRegion(region); film.liquid_positions.len()]));
    let warmth = |region: RegionId, film: &DiscreteFilm| {
        vec![Warmth(authored[region.0 as usize - 1].film.warmth.si()); film.liquid_positions.len()]
    };
    fill_column::<L, _>(world, &concat(films, warmth));
    fill_ids::<L>(world);
}

fn fill_ids<K: Kind>(world: &mut World) {
    let count = froth_systems::rows::read_column::<K, StableId>(world).len() as u64;
    fill_column::<K, _>(world, &(0..count).map(StableId).collect::<Vec<_>>());
}
