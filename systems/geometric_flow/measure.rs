//! Geometry of the films: areas, normals, curvature and thickness of every vertex.

use bevy_ecs::query::With;
use bevy_ecs::resource::Resource;
use bevy_ecs::system::Query;
use bevy_ecs::world::World;
use froth_components::film::{Area, LiquidVolume, MeanCurvature, Thickness};
use froth_components::kind::MeshVertex;
use froth_components::material::Liquid;
use froth_components::motion::Normal;
use froth_surface::Surface;
use froth_surface::calculus::Weights;
use froth_surface::calculus::area::{area_gradient, vertex_integrals, vertex_normals};
use froth_surface::flow::Flow;
use glam::DVec3;

use super::settings::{FilmMass, FlowRules};
use crate::rows::{columns, columns_mut};
use crate::tracker::films::{self, TopologyChanged};

/// The flow's work space. Everything in it follows from the films.
#[derive(Resource, Default)]
pub struct FlowWork {
    /// Incidence lists, matrices, the proposal of the step.
    pub flow: Flow,
    areas: Vec<f64>,
    normals: Vec<[DVec3; 2]>,
    gradient: Vec<DVec3>,
}

/// Mass that a vertex moves, kg: liquid (or the scene's own mass per area) and air.
#[must_use]
pub fn mass_of(rules: &FlowRules, liquid: &Liquid, area: Area, volume: LiquidVolume) -> f64 {
    let film = match rules.mass {
        FilmMass::Liquid => liquid.density * volume.0,
        FilmMass::PerArea(mass) => mass * area.0,
    };
    film + rules.air_mass * area.0
}

/// Measures areas, normals, mean curvature and thickness. Mean curvature is the area gradient along the normal per area: the sum of
/// principal curvatures. Normals point from the region of the larger label to that of the smaller, out of a bubble.
pub fn measure_films(world: &mut World) {
    let mut surface = films::take(world);
    let mut work = std::mem::take(&mut *world.resource_mut::<FlowWork>());
    if std::mem::replace(&mut world.resource_mut::<TopologyChanged>().0, false) {
        rebuild(&mut work.flow, &mut surface, world.resource::<FlowRules>().keeps_volumes);
    }
    let rows = surface.positions.len();
    let (incidence, x) = (work.flow.incidence(), &surface.positions.0);
    work.areas.resize(rows, 0.0);
    work.normals.resize(rows, [DVec3::ZERO; 2]);
    work.gradient.resize(rows, DVec3::ZERO);
    vertex_integrals(incidence, x, Weights::Uniform(1.0), &mut work.areas);
    vertex_normals(incidence, x, &mut work.normals);
    area_gradient(incidence, x, Weights::Uniform(1.0), &mut work.gradient);
    films::put_back(world, surface);
    write(world, &work);
    *world.resource_mut::<FlowWork>() = work;
}

/// Lists for the films as they are; where volumes are free, as if every region were open.
pub(super) fn rebuild(flow: &mut Flow, surface: &mut Surface, keeps_volumes: bool) {
    if keeps_volumes {
        flow.rebuild(surface);
        return;
    }
    let regions = surface.mesh.regions();
    let open = std::mem::replace(&mut surface.open, regions);
    flow.rebuild(surface);
    surface.open = open;
}

type Measured<'a> = (&'a mut Area, &'a mut Normal, &'a mut MeanCurvature, &'a mut Thickness);

fn write(world: &mut World, work: &FlowWork) {
    let mut state = bevy_ecs::system::SystemState::<(
        Query<Measured<'_>, With<MeshVertex>>,
        Query<&LiquidVolume, With<MeshVertex>>,
    )>::new(world);
    let (mut vertices, liquid) = state.get_mut(world).expect("invariant: queries are always to be had");
    if liquid.is_empty() {
        return; // The last film has burst.
    }
    let liquid = columns(&liquid);
    let (mut areas, mut normals, mut curvatures, mut thickness) = columns_mut(&mut vertices);
    let (areas, normals) = (areas.bypass_change_detection(), normals.bypass_change_detection());
    let (curvatures, thickness) = (curvatures.bypass_change_detection(), thickness.bypass_change_detection());
    for v in 0..areas.len() {
        // The first of the two points from the smaller label inwards: out of a bubble is against it.
        let (area, normal) = (work.areas[v], -work.normals[v][0].normalize_or_zero());
        (areas[v].0, normals[v].0) = (area, normal);
        curvatures[v].0 = if area > 0.0 { work.gradient[v].dot(normal) / area } else { 0.0 };
        thickness[v].0 = if area > 0.0 { liquid[v].0 / area } else { 0.0 };
    }
}
