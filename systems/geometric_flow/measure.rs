//! What the flow measures: mass and shape of the films.

use bevy_ecs::resource::Resource;
use bevy_ecs::world::World;
use froth_components::film::{Area, LiquidVolume};
use froth_components::material::Liquid;
use froth_surface::Surface;
use froth_surface::flow::Flow;

use super::settings::{FilmMass, FlowRules};
use crate::tracker::films::{self, TopologyChanged};
use crate::tracker::shape;

/// The flow's work space. Everything in it follows from the films.
#[derive(Resource, Default)]
pub struct FlowWork {
    /// Incidence lists, matrices, the proposal of the step.
    pub flow: Flow,
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

/// Measures areas, normals, mean curvature and thickness.
pub fn measure_films(world: &mut World) {
    let mut surface = films::take(world);
    let mut work = std::mem::take(&mut *world.resource_mut::<FlowWork>());
    lay_out(world, &mut work.flow, &mut surface);
    let positions = surface.positions.0.clone();
    films::put_back(world, surface);
    shape::write(world, work.flow.incidence(), &positions);
    *world.resource_mut::<FlowWork>() = work;
}

/// Lists for the films as they are, if the mesh changed; where volumes are free, as if every region were open.
pub(super) fn lay_out(world: &mut World, flow: &mut Flow, surface: &mut Surface) {
    if !world.resource_mut::<TopologyChanged>().taken() {
        return;
    }
    if world.resource::<FlowRules>().keeps_volumes {
        flow.rebuild(surface);
        return;
    }
    let regions = surface.mesh.regions();
    let open = std::mem::replace(&mut surface.open, regions);
    flow.rebuild(surface);
    surface.open = open;
}
